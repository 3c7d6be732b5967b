// The 3D view: WebGL, one program for solids and one for lines.

const SOLID_VERTEX = `
attribute vec3 position, normal, colour;
uniform mat4 camera, model;
varying vec3 vNormal, vPlace, vColour;
void main() {
  vec4 place = model * vec4(position, 1.0);
  vPlace = place.xyz;
  vNormal = mat3(model) * normal;
  vColour = colour;
  gl_Position = camera * place;
}`;

// A key light over the shoulder, light from the sky and the ground, and a highlight.
const SOLID_FRAGMENT = `
precision mediump float;
uniform vec3 eye, tint;
uniform float tinted, alpha, flat_;
varying vec3 vNormal, vPlace, vColour;
void main() {
  vec3 colour = mix(vColour, tint, tinted);
  if (flat_ > 0.5) { gl_FragColor = vec4(colour * alpha, alpha); return; }
  vec3 n = normalize(vNormal);
  vec3 toEye = normalize(eye - vPlace);
  if (dot(n, toEye) < 0.0) n = -n;
  vec3 key = normalize(vec3(0.55, -0.45, 0.9));
  float light = 0.34 + 0.2 * n.z + 0.62 * max(dot(n, key), 0.0);
  float shine = 0.22 * pow(max(dot(n, normalize(key + toEye)), 0.0), 36.0);
  float rim = 0.1 * pow(1.0 - max(dot(n, toEye), 0.0), 3.0);
  gl_FragColor = vec4(min(colour * light + shine + rim, 1.0) * alpha, alpha);
}`;

// Lines keep their width on the screen: each segment is a strip that faces the viewer.
const LINE_VERTEX = `
attribute vec3 from, to;
attribute vec2 corner;
attribute vec4 colour;
uniform mat4 camera;
uniform vec2 pixels;
uniform float width;
varying vec4 vColour;
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

const LINE_FRAGMENT = `
precision mediump float;
varying vec4 vColour;
void main() { gl_FragColor = vec4(vColour.rgb * vColour.a, vColour.a); }`;

/** The view in a canvas; none without WebGL. `paths` is what is drawn of the way of the flange. */
function makeScene(canvas, paths, corners) {
  const gl = canvas.getContext("webgl", { antialias: true, stencil: true, preserveDrawingBuffer: true });
  if (!gl) return null;

  const compiled = (vertex, fragment) => {
    const program = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
    return program;
  };
  const solids = compiled(SOLID_VERTEX, SOLID_FRAGMENT);
  const lines = compiled(LINE_VERTEX, LINE_FRAGMENT);
  const uniform = (program, name) => gl.getUniformLocation(program, name);
  const at = Object.fromEntries(["camera", "model", "eye", "tint", "tinted", "alpha", "flat_"]
    .map((name) => [name, uniform(solids, name)]));
  const lineAt = Object.fromEntries(["camera", "pixels", "width"].map((name) => [name, uniform(lines, name)]));

  /** Numbers of a vertex, one after the other, and how many each attribute has. */
  const buffer = (program, layout, floats) => {
    const stride = layout.reduce((sum, [, size]) => sum + size, 0);
    const mesh = { program, layout, stride, count: floats.length / stride, buffer: gl.createBuffer() };
    gl.bindBuffer(gl.ARRAY_BUFFER, mesh.buffer);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(floats), gl.STATIC_DRAW);
    return mesh;
  };
  const SOLID = [["position", 3], ["normal", 3], ["colour", 3]];
  const solid = (parts) => {
    const floats = [];
    for (const { shape, origin, colour } of parts) {
      shape.positions.forEach((position, i) => {
        floats.push(...transformed(origin, position), ...transformed(origin, shape.normals[i], 0), ...colour);
      });
    }
    return buffer(solids, SOLID, floats);
  };
  const draw = (mesh) => {
    gl.bindBuffer(gl.ARRAY_BUFFER, mesh.buffer);
    let offset = 0;
    for (const [name, size] of mesh.layout) {
      const place = gl.getAttribLocation(mesh.program, name);
      gl.enableVertexAttribArray(place);
      gl.vertexAttribPointer(place, size, gl.FLOAT, false, 4 * mesh.stride, 4 * offset);
      offset += size;
    }
    gl.drawArrays(gl.TRIANGLES, 0, mesh.count);
  };
  const LINE = [["from", 3], ["to", 3], ["corner", 2], ["colour", 4]];
  const CORNERS = [[0, -1], [1, -1], [1, 1], [0, -1], [1, 1], [0, 1]];
  /** Segments: from, to, colour. */
  const strip = (segments) => {
    const floats = [];
    for (const [from, to, colour] of segments) {
      for (const corner of CORNERS) floats.push(...from, ...to, ...corner, ...colour);
    }
    return buffer(lines, LINE, floats);
  };

  const still = placed([0, 0, 0], [0, 0, 0]);
  const links = model.links.map((shapes) => solid(shapes.map((shape) => ({
    shape: shape.round ? sphere(shape.radius) : cylinder(shape.radius, shape.length),
    origin: shape.origin,
    colour: shape.colour,
  }))));
  const ball = solid([{ shape: sphere(1), origin: still, colour: [1, 1, 1] }]);

  // The view takes in the foot, the arm's height and all of the way.
  const box = [[-0.2, -0.2, 0], [0.2, 0.2, 0.75]];
  for (const { places } of paths) {
    for (const place of places) {
      for (let i = 0; i < 3; i++) {
        box[0][i] = Math.min(box[0][i], place[i]);
        box[1][i] = Math.max(box[1][i], place[i]);
      }
    }
  }
  const middle = [0, 1, 2].map((i) => (box[0][i] + box[1][i]) / 2);
  const reach = Math.hypot(...box[1].map((v, i) => v - box[0][i])) / 2;
  const beginning = { azimuth: -0.9, height: 0.42, distance: 1 };
  const view = { ...beginning };

  let theme = {};
  let ground;
  let ways = [];

  /** Takes the colours of the page: arrays of three. */
  function paint(colours) {
    theme = colours;
    const grid = [];
    const half = 1;
    for (let i = -10; i <= 10; i++) {
      const rule = [...theme.rule, i % 5 === 0 ? 1 : 0.55];
      grid.push([[i / 10, -half, 0], [i / 10, half, 0], rule], [[-half, i / 10, 0], [half, i / 10, 0], rule]);
    }
    ground = strip(grid);
    ways = paths.map(({ places, kinds, width }) => ({
      width,
      mesh: strip(places.slice(1).map((to, i) => [places[i], to, [...theme[kinds[i + 1]], 1]])),
    }));
  }

  function camera() {
    const aspect = canvas.width / canvas.height;
    const field = 0.56;
    // As far as it takes for all to be in, across, too.
    const far = (reach / Math.sin(field / 2) / Math.min(1, aspect)) * 0.94 * view.distance;
    const [sa, ca] = [Math.sin(view.azimuth), Math.cos(view.azimuth)];
    const [sh, ch] = [Math.sin(view.height), Math.cos(view.height)];
    const back = [ca * ch, sa * ch, sh];
    const right = [-sa, ca, 0];
    const up = [-ca * sh, -sa * sh, ch];
    const eye = middle.map((v, i) => v + far * back[i]);
    const look = new Float32Array(16);
    [right, up, back].forEach((axis, row) => {
      axis.forEach((v, column) => { look[4 * column + row] = v; });
      look[12 + row] = -axis.reduce((sum, v, i) => sum + v * eye[i], 0);
    });
    look[15] = 1;
    const f = 1 / Math.tan(field / 2);
    const [near, end] = [0.02 * far, far + 6];
    const lens = new Float32Array([
      f / aspect, 0, 0, 0, 0, f, 0, 0,
      0, 0, (near + end) / (near - end), -1, 0, 0, (2 * near * end) / (near - end), 0,
    ]);
    return { matrix: product(lens, look), eye };
  }

  const WHITE = [1, 1, 1];
  const look = (tint, tinted, alpha, flat = 0) => {
    gl.uniform3fv(at.tint, tint || WHITE);
    gl.uniform1f(at.tinted, tinted);
    gl.uniform1f(at.alpha, alpha);
    gl.uniform1f(at.flat_, flat);
  };
  const place = (matrix) => gl.uniformMatrix4fv(at.model, false, matrix);
  const drawArm = (poses, flatten) => links.forEach((link, i) => {
    place(flatten ? product(flatten, poses[i]) : poses[i]);
    draw(link);
  });
  const beadAt = (p, radius) => {
    place(new Float32Array([radius, 0, 0, 0, 0, radius, 0, 0, 0, 0, radius, 0, ...p, 1]));
    draw(ball);
  };
  // Along the key light on to the ground.
  const SHADOW = new Float32Array([1, 0, 0, 0, 0, 1, 0, 0, -0.55 / 0.9, 0.45 / 0.9, 0, 0, 0, 0, 0.0005, 1]);

  /** Draws arms, a list of joint positions and whether each is a ghost. */
  function show(arms) {
    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    const width = Math.max(1, Math.round(canvas.clientWidth * ratio));
    const height = Math.max(1, Math.round(canvas.clientHeight * ratio));
    if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
    const { matrix, eye } = camera();
    const all = arms.map(({ q, ghost }) => ({ poses: linkPoses(q), ghost }));

    gl.viewport(0, 0, width, height);
    gl.clearColor(...theme.ground, 1);
    gl.clearStencil(0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT | gl.STENCIL_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);

    const drawLines = (mesh, px) => {
      gl.useProgram(lines);
      gl.uniformMatrix4fv(lineAt.camera, false, matrix);
      gl.uniform2f(lineAt.pixels, width / 2, height / 2);
      gl.uniform1f(lineAt.width, (px * ratio) / 2);
      draw(mesh);
    };
    gl.depthMask(false);
    drawLines(ground, 1);

    gl.useProgram(solids);
    gl.uniformMatrix4fv(at.camera, false, matrix);
    gl.uniform3fv(at.eye, eye);
    // The shadow darkens each place once.
    gl.enable(gl.STENCIL_TEST);
    gl.stencilFunc(gl.EQUAL, 0, 255);
    gl.stencilOp(gl.KEEP, gl.KEEP, gl.INCR);
    look([0, 0, 0], 1, theme.shadow, 1);
    for (const { poses, ghost } of all) if (!ghost) drawArm(poses, SHADOW);
    gl.disable(gl.STENCIL_TEST);
    gl.depthMask(true);

    look(null, 0, 1);
    for (const { poses, ghost } of all) if (!ghost) drawArm(poses);
    // Where two ways are in one place, the later one is seen, on the broader one before it.
    gl.enable(gl.POLYGON_OFFSET_FILL);
    ways.forEach((way, i) => {
      gl.polygonOffset(0, -200 * i);
      drawLines(way.mesh, way.width);
    });
    gl.disable(gl.POLYGON_OFFSET_FILL);

    gl.useProgram(solids);
    for (const corner of corners) {
      look(theme.blend, 1, 1);
      beadAt(corner.target_m, 0.008);
    }
    look(theme.ink, 1, 1);
    for (const { poses, ghost } of all) if (!ghost) beadAt(poses[poses.length - 1].slice(12, 15), 0.012);

    // What is seen through comes last: spheres, and of a ghost only what is nearest.
    gl.depthMask(false);
    look(theme.blend, 1, 0.2);
    for (const corner of corners) if (corner.radius_m) beadAt(corner.target_m, corner.radius_m);
    gl.depthMask(true);
    // Where both arms are in one place, the solid one is seen.
    gl.enable(gl.POLYGON_OFFSET_FILL);
    gl.polygonOffset(1, 8);
    for (const { poses, ghost } of all) {
      if (!ghost) continue;
      gl.colorMask(false, false, false, false);
      look(theme.accent, 1, 1);
      drawArm(poses);
      gl.colorMask(true, true, true, true);
      look(theme.accent, 0.75, 0.38);
      drawArm(poses);
    }
    gl.disable(gl.POLYGON_OFFSET_FILL);
  }

  /** Turns the view, in rad, and takes it nearer by a factor. */
  function turn(azimuth, height, nearer = 1) {
    view.azimuth += azimuth;
    view.height = Math.min(Math.max(view.height + height, -0.15), 1.5);
    view.distance = Math.min(Math.max(view.distance / nearer, 0.25), 3);
  }
  const reset = () => Object.assign(view, beginning);
  return { show, paint, turn, reset };
}
