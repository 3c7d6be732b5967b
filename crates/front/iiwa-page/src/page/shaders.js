// Shaders of the 3D view. Light is summed up linearly, and encoded for screens at the end.

const SOLID_VERTEX = `#version 300 es
in vec3 position, normal, colour;
in float link;
uniform mat4 camera, links[LINKS];
uniform float swell;
out vec3 vNormal, vPlace, vColour;
void main() {
  mat4 model = links[int(link)];
  vec4 place = model * vec4(position + swell * normal, 1.0);
  vPlace = place.xyz;
  vNormal = mat3(model) * normal;
  vColour = colour;
  gl_Position = camera * place;
}`;

// Studio lighting: a key light over the viewer's shoulder that casts shadows, a bright ceiling, a
// dim floor, and a strip light behind for bright edges. The gloss is that of plastic (Fresnel term
// by Schlick 1994, GGX for the key light).
const SOLID_FRAGMENT = `#version 300 es
precision highp float;
precision highp sampler2DShadow;
uniform vec3 eye, tint, key;
uniform float tinted, alpha, ghost;
uniform mat4 sun;
uniform sampler2DShadow shadows;
in vec3 vNormal, vPlace, vColour;
out vec4 pixel;
const float ROUGH = 0.38;

float lit(vec3 n) {
  // A little off the surface, so that it does not shade itself.
  vec3 at = (sun * vec4(vPlace + 0.01 * n, 1.0)).xyz * 0.5 + 0.5;
  float sum = 0.0;
  for (int i = 0; i < 5; i++) {
    float angle = 2.4 * float(i);
    vec2 off = sqrt(float(i) + 0.5) * vec2(cos(angle), sin(angle)) * 0.0028;
    sum += texture(shadows, vec3(at.xy + off, at.z));
  }
  return sum / 5.0;
}

vec3 studio(vec3 d) {
  float up = smoothstep(-0.5, 0.9, d.z);
  float ceiling = smoothstep(0.55, 0.95, d.z);
  float strip = smoothstep(0.75, 0.97, dot(d, normalize(vec3(-0.75, 0.55, 0.35))));
  return vec3(0.28, 0.28, 0.29) + up * vec3(0.42, 0.44, 0.47) + ceiling * 0.9 + strip * 1.6;
}

// Bright light fades to white, instead of being cut off.
vec3 film(vec3 light) {
  float peak = max(light.r, max(light.g, light.b));
  const float KNEE = 0.72;
  if (peak <= KNEE) return light;
  float soft = 1.0 - (1.0 - KNEE) * (1.0 - KNEE) / (peak + 1.0 - 2.0 * KNEE);
  return mix(light * soft / peak, vec3(soft), 0.35 * (1.0 - 1.0 / (1.0 + peak - soft)));
}

void main() {
  vec3 colour = mix(vColour, pow(tint, vec3(2.2)), tinted);
  vec3 n = normalize(vNormal);
  vec3 toEye = normalize(eye - vPlace);
  // At the outline, a smooth normal may look away: no further than across.
  if (!gl_FrontFacing) n = -n;
  n = normalize(n - min(dot(n, toEye), 0.0) * toEye);
  float facing = max(dot(n, toEye), 0.0);
  float graze = pow(1.0 - facing, 5.0);
  if (ghost > 0.0) {
    // Of what is seen through, edges stand out.
    float edge = pow(1.0 - facing, 2.0);
    vec3 shaded = colour * (0.62 + 0.38 * n.z) + 0.25 * edge;
    float share = mix(0.3, 0.8, edge) * ghost;
    pixel = vec4(pow(min(shaded, 1.0), vec3(1.0 / 2.2)) * share, share);
    return;
  }
  float towards = max(dot(n, key), 0.0);
  float seen = towards > 0.0 ? lit(n) : 0.0;
  vec3 sky = mix(vec3(0.17, 0.165, 0.16), vec3(0.42, 0.435, 0.46), 0.5 + 0.5 * n.z);
  // Close to the floor, less light comes from below.
  sky *= mix(0.72, 1.0, clamp(vPlace.z / 0.12 + 0.5 * max(n.z, 0.0), 0.0, 1.0));
  float fill = max(dot(n, normalize(vec3(-0.6, -0.75, 0.25))), 0.0);
  vec3 light = sky + 0.78 * towards * seen * vec3(1.0, 0.985, 0.96) + 0.13 * fill;
  vec3 half_ = normalize(key + toEye);
  float nh = max(dot(n, half_), 0.0), a2 = ROUGH * ROUGH * ROUGH * ROUGH;
  float spread = nh * nh * (a2 - 1.0) + 1.0;
  float glint = a2 / (3.14 * spread * spread) * 0.02 * towards * seen / max(0.12, facing + towards);
  float gloss = 0.04 + 0.5 * graze;
  vec3 shine = gloss * studio(reflect(-toEye, n)) + 1.6 * glint;
  pixel = vec4(pow(film(colour * light * (1.0 - gloss) + shine), vec3(1.0 / 2.2)) * alpha, alpha);
}`;

// Obstacles, and depth passes without colour: far cheaper without a graphics card.
const FLAT_VERTEX = `#version 300 es
in vec3 position, normal;
in float link;
uniform mat4 camera, links[LINKS];
uniform float swell;
void main() { gl_Position = camera * links[int(link)] * vec4(position + swell * normal, 1.0); }`;

const FLAT_FRAGMENT = `#version 300 es
precision mediump float;
uniform vec4 colour;
out vec4 pixel;
void main() { pixel = vec4(colour.rgb * colour.a, colour.a); }`;

// Occluders of the key light above the floor: red, and green by their closeness to the floor.
const MASK_VERTEX = `#version 300 es
in vec3 position;
in float link;
uniform mat4 links[LINKS];
uniform vec3 key, patch_;
out float vHeight;
void main() {
  vec4 place = links[int(link)] * vec4(position, 1.0);
  vHeight = place.z;
  vec2 at = place.xy - key.xy / key.z * place.z;
  gl_Position = vec4((at - patch_.xy) / patch_.z, 0.0, 1.0);
}`;

const MASK_FRAGMENT = `#version 300 es
precision mediump float;
in float vHeight;
out vec4 pixel;
void main() { pixel = vec4(1.0, exp(-max(vHeight, 0.0) / 0.16), 0.0, 1.0); }`;

// One direction of a Gaussian blur.
const BLUR_VERTEX = `#version 300 es
in vec2 corner;
out vec2 vAt;
void main() {
  vAt = corner * 0.5 + 0.5;
  gl_Position = vec4(corner, 0.0, 1.0);
}`;

const BLUR_FRAGMENT = `#version 300 es
precision highp float;
uniform sampler2D image;
uniform vec2 step_;
in vec2 vAt;
out vec4 pixel;
void main() {
  vec4 sum = vec4(0.0);
  float whole = 0.0;
  for (int i = -4; i <= 4; i++) {
    float weight = exp(-float(i * i) / 5.0);
    sum += weight * texture(image, vAt + float(i) * step_);
    whole += weight;
  }
  pixel = sum / whole;
}`;

// The floor: a grid that fades out, and soft shadows, sharper near the robot.
const FLOOR_VERTEX = `#version 300 es
in vec2 corner;
uniform mat4 camera;
uniform float extent;
out vec2 vAt;
void main() {
  vAt = corner * extent;
  gl_Position = camera * vec4(vAt, 0.0, 1.0);
}`;

const FLOOR_FRAGMENT = `#version 300 es
precision highp float;
uniform vec3 patch_, rule;
uniform float shadow, extent;
uniform sampler2D near, far;
in vec2 vAt;
out vec4 pixel;

float grid(float cell) {
  vec2 at = vAt / cell;
  vec2 wide = fwidth(at);
  vec2 off = abs(fract(at - 0.5) - 0.5) / max(wide, vec2(1e-6));
  float line = 1.0 - min(min(off.x, off.y), 1.0);
  // Lines that come too close to each other are left out.
  return line * (1.0 - smoothstep(0.15, 0.4, max(wide.x, wide.y)));
}

void main() {
  float fade = 1.0 - smoothstep(0.35 * extent, extent, length(vAt));
  float line = max(0.5 * grid(0.1), grid(0.5)) * fade;
  vec2 at = (vAt - patch_.xy) / patch_.z * 0.5 + 0.5;
  float dark = 0.0;
  if (all(greaterThan(at, vec2(0.0))) && all(lessThan(at, vec2(1.0)))) {
    vec4 sharp = texture(near, at), soft = texture(far, at);
    float close = clamp(sharp.g / max(sharp.r, 1e-3), 0.0, 1.0);
    dark = mix(0.75 * soft.r, sharp.r, close * close);
    // And what the foot keeps from the light of the sky.
    dark = max(dark, 0.9 * soft.g);
  }
  float share = dark * shadow;
  pixel = vec4(rule * line * (1.0 - share), share + line * (1.0 - share));
}`;

// Lines keep their width on the screen: each segment is a strip that faces the viewer.
const LINE_VERTEX = `#version 300 es
in vec3 from, to;
in vec2 corner;
in vec4 colour;
uniform mat4 camera;
uniform vec2 pixels;
uniform float width;
out vec4 vColour;
void main() {
  vec4 a = camera * vec4(from, 1.0), b = camera * vec4(to, 1.0);
  vec2 along = (b.xy / b.w - a.xy / a.w) * pixels;
  along = length(along) > 1e-3 ? normalize(along) : vec2(1.0, 0.0);
  vec4 at = corner.x < 0.5 ? a : b;
  // A little longer than the segment, so that bends have no gaps.
  vec2 off = along * (corner.x - 0.5) * 0.6 + vec2(-along.y, along.x) * corner.y;
  at.xy += off * width / pixels * at.w;
  gl_Position = at;
  vColour = colour;
}`;

const LINE_FRAGMENT = `#version 300 es
precision mediump float;
in vec4 vColour;
out vec4 pixel;
void main() { pixel = vec4(vColour.rgb * vColour.a, vColour.a); }`;
