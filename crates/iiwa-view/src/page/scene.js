// The 3D view: WebGL, one program for solids and one for lines.

const SOLID_VERTEX = `
attribute vec3 position, normal, colour;
attribute float link;
uniform mat4 camera, links[LINKS];
varying vec3 vNormal, vPlace, vColour;
void main() {
  mat4 model = links[int(link)];
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
uniform float tinted, alpha;
varying vec3 vNormal, vPlace, vColour;
void main() {
  vec3 colour = mix(vColour, tint, tinted);
  vec3 n = normalize(vNormal);
  vec3 toEye = normalize(eye - vPlace);
  if (dot(n, toEye) < 0.0) n = -n;
  vec3 key = normalize(vec3(0.55, -0.45, 0.9));
  float light = 0.34 + 0.2 * n.z + 0.62 * max(dot(n, key), 0.0);
  float shine = 0.22 * pow(max(dot(n, normalize(key + toEye)), 0.0), 36.0);
  float rim = 0.1 * pow(1.0 - max(dot(n, toEye), 0.0), 3.0);
  gl_FragColor = vec4(min(colour * light + shine + rim, 1.0) * alpha, alpha);
}`;

// Shadows, obstacles and spheres have one colour: that is far cheaper without a graphics card.
const FLAT_VERTEX = `
attribute vec3 position;
attribute float link;
uniform mat4 camera, links[LINKS];
void main() { gl_Position = camera * links[int(link)] * vec4(position, 1.0); }`;

const FLAT_FRAGMENT = `
precision mediump float;
uniform vec4 colour;
void main() { gl_FragColor = vec4(colour.rgb * colour.a, colour.a); }`;

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

// Of frames: x, y, z.
const AXES = [
  [0.85, 0.16, 0.16],
  [0.13, 0.6, 0.2],
  [0.16, 0.4, 0.9],
];

/** The view in a canvas; none without WebGL. */
function makeScene(canvas) {
  const gl = canvas.getContext("webgl", { antialias: true, stencil: true });
  if (!gl) return null;

  const compiled = (vertex, fragment) => {
    const program = gl.createProgram();
    for (const [kind, text] of [
      [gl.VERTEX_SHADER, vertex],
      [gl.FRAGMENT_SHADER, fragment],
    ]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text.replace("[LINKS]", `[${model.links.length}]`));
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
    program.uniforms = {};
    for (let i = 0; i < gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); i++) {
      const { name } = gl.getActiveUniform(program, i);
      program.uniforms[name] = gl.getUniformLocation(program, name);
    }
    program.places = {};
    for (let i = 0; i < gl.getProgramParameter(program, gl.ACTIVE_ATTRIBUTES); i++) {
      const { name } = gl.getActiveAttrib(program, i);
      program.places[name] = gl.getAttribLocation(program, name);
    }
    return program;
  };
  const solids = compiled(SOLID_VERTEX, SOLID_FRAGMENT);
  const flats = compiled(FLAT_VERTEX, FLAT_FRAGMENT);
  const lines = compiled(LINE_VERTEX, LINE_FRAGMENT);

  /** Numbers of a corner, one after the other, and how many each attribute has; triangles by the corners'
      numbers, if not by their order. */
  const upload = (layout, floats, triangles) => {
    const stride = layout.reduce((sum, [, size]) => sum + size, 0);
    const mesh = { layout, stride, count: triangles ? triangles.length : floats.length / stride };
    const put = (kind, values) => {
      const made = gl.createBuffer();
      gl.bindBuffer(kind, made);
      gl.bufferData(kind, values, gl.STATIC_DRAW);
      return made;
    };
    mesh.corners = put(gl.ARRAY_BUFFER, new Float32Array(floats));
    if (triangles) mesh.triangles = put(gl.ELEMENT_ARRAY_BUFFER, new Uint16Array(triangles));
    return mesh;
  };
  const discard = ({ corners, triangles }) => {
    gl.deleteBuffer(corners);
    if (triangles) gl.deleteBuffer(triangles);
  };
  const SOLID = [
    ["position", 3],
    ["normal", 3],
    ["colour", 3],
    ["link", 1],
  ];
  const solid = (parts) => {
    const floats = [];
    const triangles = [];
    for (const { shape, origin, colour, link = 0 } of parts) {
      const first = floats.length / 10;
      shape.positions.forEach((position, i) => {
        floats.push(...transformed(origin, position), ...transformed(origin, shape.normals[i], 0), ...colour, link);
      });
      for (const corner of shape.triangles) triangles.push(first + corner);
    }
    return upload(SOLID, floats, triangles);
  };
  let program = null;
  const use = (other) => {
    program = other;
    gl.useProgram(program);
  };
  /** Draws a mesh with the program in use, which takes of it what it needs. */
  const draw = (mesh) => {
    gl.bindBuffer(gl.ARRAY_BUFFER, mesh.corners);
    let offset = 0;
    for (const [name, size] of mesh.layout) {
      const place = program.places[name];
      if (place !== undefined) {
        gl.enableVertexAttribArray(place);
        gl.vertexAttribPointer(place, size, gl.FLOAT, false, 4 * mesh.stride, 4 * offset);
      }
      offset += size;
    }
    if (mesh.triangles) {
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, mesh.triangles);
      gl.drawElements(gl.TRIANGLES, mesh.count, gl.UNSIGNED_SHORT, 0);
    } else {
      gl.drawArrays(gl.TRIANGLES, 0, mesh.count);
    }
    // Its buffers may be gone when something else is drawn.
    for (const place of Object.values(program.places)) gl.disableVertexAttribArray(place);
  };
  const LINE = [
    ["from", 3],
    ["to", 3],
    ["corner", 2],
    ["colour", 4],
  ];
  const CORNERS = [
    [0, -1],
    [1, -1],
    [1, 1],
    [0, -1],
    [1, 1],
    [0, 1],
  ];
  /** Segments: from, to, colour. */
  const strip = (segments) => {
    const floats = [];
    for (const [from, to, colour] of segments) {
      for (const corner of CORNERS) floats.push(...from, ...to, ...corner, ...colour);
    }
    return upload(LINE, floats);
  };

  const still = placed([0, 0, 0], [0, 0, 0]);
  // All links at once: what is asked of a graphics card takes time, too.
  const arm = solid(
    model.links.flatMap((shapes, link) =>
      shapes.map((shape) => ({
        shape: shape.round ? sphere(shape.radius) : cylinder(shape.radius, shape.length),
        origin: shape.origin,
        colour: shape.colour,
        link,
      })),
    ),
  );
  const ball = solid([{ shape: sphere(1), origin: still, colour: [1, 1, 1] }]);

  /** What stands beside the arm: ways of the TCP, blended targets, frames, obstacles; and the shapes of its tool. */
  let contents = { ways: [], corners: [], frames: [], obstacles: [], tool: [] };
  let middle = [0, 0, 0];
  let reach = 1;

  /** The view takes in the foot, the arm's height, all of the way, and what is near of the obstacles. */
  function aim() {
    const NEAR_M = 1;
    const box = [
      [-0.2, -0.2, 0],
      [0.2, 0.2, 0.75],
    ];
    const take = (place) => {
      for (let i = 0; i < 3; i++) {
        box[0][i] = Math.min(box[0][i], place[i]);
        box[1][i] = Math.max(box[1][i], place[i]);
      }
    };
    for (const { places } of contents.ways) places.forEach(take);
    for (const { shape, origin } of contents.obstacles) {
      if (shape.endless) continue;
      for (const corner of shape.positions)
        take(transformed(origin, corner).map((v) => Math.min(Math.max(v, -NEAR_M), NEAR_M)));
    }
    middle = [0, 1, 2].map((i) => (box[0][i] + box[1][i]) / 2);
    reach = Math.hypot(...box[1].map((v, i) => v - box[0][i])) / 2;
  }

  const beginning = { azimuth: -0.9, height: 0.42, distance: 1 };
  const view = { ...beginning };
  let sharpness = 1;

  let theme = null;
  let ground;
  let ways = [];
  let frames = null;
  let obstacles = [];
  /** Meshes of the tool: one for each shape, since a mesh has no more corners than 16 bits count. */
  let carried = [];

  /** Takes the colours of the page: arrays of three. */
  function paint(colours) {
    theme = colours;
    const grid = [];
    const half = 1;
    for (let i = -10; i <= 10; i++) {
      const rule = [...theme.rule, i % 5 === 0 ? 1 : 0.55];
      grid.push([[i / 10, -half, 0], [i / 10, half, 0], rule], [[-half, i / 10, 0], [half, i / 10, 0], rule]);
    }
    if (ground) discard(ground);
    ground = strip(grid);
    build();
  }

  /** Takes other contents. */
  function fill(changed) {
    contents = { ...contents, ...changed };
    aim();
    if (theme) build();
  }

  function build() {
    for (const { mesh } of ways) discard(mesh);
    for (const { mesh, edges } of obstacles) [mesh, edges].forEach(discard);
    carried.forEach(discard);
    if (frames) discard(frames);
    // A cross of axes each: x red, y green, z blue.
    const AXIS_M = 0.05;
    const crosses = contents.frames.flatMap(({ position_m: at, rotation }) =>
      AXES.map((colour, axis) => [at, at.map((v, i) => v + AXIS_M * rotation[i][axis]), [...colour, 1]]),
    );
    frames = crosses.length ? strip(crosses) : null;
    ways = contents.ways.map(({ places, kinds, width }) => ({
      width,
      mesh: strip(
        places.slice(1).flatMap((to, i) => (kinds[i + 1] ? [[places[i], to, [...theme[kinds[i + 1]], 1]]] : [])),
      ),
    }));
    obstacles = contents.obstacles.map(({ shape, origin }) => ({
      mesh: solid([{ shape, origin, colour: theme.soft }]),
      edges: strip(shape.edges.map((ends) => [...ends.map((end) => transformed(origin, end)), [...theme.soft, 0.9]])),
      alpha: shape.endless ? 0.07 : 0.24,
    }));
    const flange = model.links.length - 1;
    carried = contents.tool.map(({ shape, origin }) => solid([{ shape, origin, colour: theme.settle, link: flange }]));
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
      axis.forEach((v, column) => {
        look[4 * column + row] = v;
      });
      look[12 + row] = -axis.reduce((sum, v, i) => sum + v * eye[i], 0);
    });
    look[15] = 1;
    const f = 1 / Math.tan(field / 2);
    const [near, end] = [0.02 * far, far + 6];
    const lens = new Float32Array([
      f / aspect,
      0,
      0,
      0,
      0,
      f,
      0,
      0,
      0,
      0,
      (near + end) / (near - end),
      -1,
      0,
      0,
      (2 * near * end) / (near - end),
      0,
    ]);
    return { matrix: product(lens, look), eye };
  }

  /** Solids from now on: in their own colours, or partly in another one. */
  const shade = (tint, tinted, alpha) => {
    use(solids);
    gl.uniform3fv(program.uniforms.tint, tint || [1, 1, 1]);
    gl.uniform1f(program.uniforms.tinted, tinted);
    gl.uniform1f(program.uniforms.alpha, alpha);
  };
  /** One colour from now on. */
  const fillWith = (colour, alpha) => {
    use(flats);
    gl.uniform4f(program.uniforms.colour, ...colour, alpha);
  };
  const place = (matrix) => gl.uniformMatrix4fv(program.uniforms["links[0]"], false, matrix);
  const drawArm = (poses) => {
    const all = new Float32Array(16 * model.links.length);
    for (let link = 0; link < model.links.length; link++) all.set(poses[link], 16 * link);
    place(all);
    draw(arm);
    for (const mesh of carried) draw(mesh);
  };
  const beadAt = (p, radius) => {
    place(new Float32Array([radius, 0, 0, 0, 0, radius, 0, 0, 0, 0, radius, 0, ...p, 1]));
    draw(ball);
  };
  // Along the key light on to the ground.
  const SHADOW = new Float32Array([1, 0, 0, 0, 0, 1, 0, 0, -0.55 / 0.9, 0.45 / 0.9, 0, 0, 0, 0, 0.0005, 1]);

  /** Draws arms: joint positions, the TCP in the flange's frame if there is a tool, and the colour of those that are ghosts. `gap` is a line from the arm to
      what is nearest. */
  function show(arms, gap) {
    const ratio = Math.min(window.devicePixelRatio || 1, 2) * sharpness;
    const width = Math.max(1, Math.round(canvas.clientWidth * ratio));
    const height = Math.max(1, Math.round(canvas.clientHeight * ratio));
    if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
    const { matrix, eye } = camera();
    const all = arms.map(({ q, ghost, tool }) => ({ poses: linkPoses(q), ghost, tool }));

    gl.viewport(0, 0, width, height);
    gl.clearColor(...theme.ground, 1);
    gl.clearStencil(0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT | gl.STENCIL_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);

    for (const each of [solids, flats, lines]) {
      use(each);
      gl.uniformMatrix4fv(program.uniforms.camera, false, matrix);
    }
    gl.uniform2f(program.uniforms.pixels, width / 2, height / 2);
    const drawLines = (mesh, px) => {
      use(lines);
      gl.uniform1f(program.uniforms.width, (px * ratio) / 2);
      draw(mesh);
    };
    gl.depthMask(false);
    drawLines(ground, 1);

    // Of closed solids only what faces the viewer: without a graphics card triangles are what takes time.
    gl.enable(gl.CULL_FACE);
    // The shadow darkens each place once.
    gl.enable(gl.STENCIL_TEST);
    gl.stencilFunc(gl.EQUAL, 0, 255);
    gl.stencilOp(gl.KEEP, gl.KEEP, gl.INCR);
    fillWith([0, 0, 0], theme.shadow);
    gl.uniformMatrix4fv(program.uniforms.camera, false, product(matrix, SHADOW));
    for (const { poses, ghost } of all) if (!ghost) drawArm(poses);
    gl.uniformMatrix4fv(program.uniforms.camera, false, matrix);
    gl.disable(gl.STENCIL_TEST);
    gl.depthMask(true);

    shade(null, 0, 1);
    gl.uniform3fv(program.uniforms.eye, eye);
    for (const { poses, ghost } of all) if (!ghost) drawArm(poses);
    gl.disable(gl.CULL_FACE);
    // Where two ways are in one place, the later one is seen, on the broader one before it.
    gl.enable(gl.POLYGON_OFFSET_FILL);
    ways.forEach((way, i) => {
      gl.polygonOffset(0, -200 * i);
      drawLines(way.mesh, way.width);
    });
    gl.disable(gl.POLYGON_OFFSET_FILL);
    if (frames) drawLines(frames, 2.5);

    shade(theme.blend, 1, 1);
    for (const corner of contents.corners) beadAt(corner.target_m, 0.008);
    shade(theme.ink, 1, 1);
    for (const { poses, ghost } of all) if (!ghost) beadAt(poses[poses.length - 1].slice(12, 15), 0.012);
    for (const { poses, ghost, tool } of all) {
      if (ghost || !tool) continue;
      const [flange, tcp] = [[0, 0, 0], tool].map((place) => transformed(poses[poses.length - 1], place));
      const mesh = strip([[flange, tcp, [...theme.ink, 1]]]);
      drawLines(mesh, 3);
      discard(mesh);
      shade(theme.ink, 1, 1);
      beadAt(tcp, 0.008);
    }
    if (gap) {
      const mesh = strip([[...gap, [...theme.blend, 1]]]);
      drawLines(mesh, 3);
      discard(mesh);
      shade(theme.blend, 1, 1);
      for (const end of gap) beadAt(end, 0.01);
    }

    // What is seen through comes last: obstacles, spheres, and of a ghost only what is nearest.
    gl.depthMask(false);
    for (const { mesh, alpha } of obstacles) {
      fillWith(theme.soft, alpha);
      place(still);
      draw(mesh);
    }
    for (const { edges } of obstacles) drawLines(edges, 1.5);
    shade(theme.blend, 1, 0.2);
    for (const corner of contents.corners) if (corner.radius_m) beadAt(corner.target_m, corner.radius_m);
    gl.depthMask(true);
    // Where both arms are in one place, the solid one is seen.
    gl.enable(gl.POLYGON_OFFSET_FILL);
    gl.polygonOffset(1, 8);
    gl.enable(gl.CULL_FACE);
    for (const { poses, ghost } of all) {
      if (!ghost) continue;
      gl.colorMask(false, false, false, false);
      fillWith(theme[ghost], 1);
      drawArm(poses);
      gl.colorMask(true, true, true, true);
      shade(theme[ghost], 0.75, 0.38);
      drawArm(poses);
    }
    gl.disable(gl.CULL_FACE);
    gl.disable(gl.POLYGON_OFFSET_FILL);
  }

  /** Turns the view, in rad, and takes it nearer by a factor. */
  function turn(azimuth, height, nearer = 1) {
    view.azimuth += azimuth;
    view.height = Math.min(Math.max(view.height + height, -0.15), 1.5);
    view.distance = Math.min(Math.max(view.distance / nearer, 0.25), 3);
  }
  const reset = () => Object.assign(view, beginning);
  /** Draws fewer pixels than the screen has, for machines that are slow at it. */
  const sharpen = (share) => {
    sharpness = share;
  };
  aim();
  return { show, paint, fill, turn, reset, sharpen };
}
