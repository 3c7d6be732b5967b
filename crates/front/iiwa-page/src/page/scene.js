// The 3D view: the robot, its surroundings and the camera.

// Axes of frames: x, y, z.
const AXES = [
  [0.85, 0.16, 0.16],
  [0.13, 0.6, 0.2],
  [0.16, 0.4, 0.9],
];

const SOLID = [
  ["position", 3],
  ["normal", 3],
  ["colour", 3],
  ["link", 1],
];
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

/** The view in a canvas; null without WebGL 2. */
function makeScene(canvas) {
  const painter = makePainter(canvas);
  if (!painter) return null;
  const { gl, compiled, upload, discard, use, draw, take } = painter;
  const solids = compiled(SOLID_VERTEX, SOLID_FRAGMENT);
  const flats = compiled(FLAT_VERTEX, FLAT_FRAGMENT);
  const lines = compiled(LINE_VERTEX, LINE_FRAGMENT);
  const floors = compiled(FLOOR_VERTEX, FLOOR_FRAGMENT);

  const solid = (parts) => {
    const floats = [];
    const triangles = [];
    for (const { shape, origin, colour, link = 0 } of parts) {
      const first = floats.length / 10;
      shape.positions.forEach((position, i) => {
        floats.push(
          ...transformed(origin, position),
          ...transformed(origin, shape.normals[i], 0),
          ...colour.map(lightOf),
          link,
        );
      });
      for (const corner of shape.triangles) triangles.push(first + corner);
    }
    return upload(SOLID, floats, triangles);
  };
  /** A mesh of line segments: from, to, colour. */
  const strip = (segments) => {
    const floats = [];
    for (const [from, to, colour] of segments) {
      for (const corner of CORNERS) floats.push(...from, ...to, ...corner, ...colour);
    }
    return upload(LINE, floats);
  };

  const still = placed([0, 0, 0], [0, 0, 0]);
  // One draw call for all links, as each call takes time.
  const look = unpackLook(robot.look);
  const arm = upload(SOLID, look.floats, look.triangles);
  const [bead, ball] = [
    [8, 16],
    [24, 44],
  ].map((steps) => solid([{ shape: sphere(1, ...steps), origin: still, colour: [1, 1, 1] }]));
  const floor = upload([["corner", 2]], QUAD);

  /** Contents besides the robot: TCP paths, blended targets, frames, obstacles, tool shapes, and
      the shapes of carried bodies. */
  let contents = { ways: [], corners: [], frames: [], obstacles: [], tool: [], bodies: [] };
  let standing = [];
  const sight = makeSight(canvas);

  let sharpness = 1;
  /** Number of changes of contents and colours. */
  let changes = 0;
  let theme = null;
  let ways = [];
  let frames = null;
  let obstacles = [];
  let carried = [];
  let bodies = [];

  /** Sets the colours of the page: arrays of three. */
  function paint(colours) {
    theme = colours;
    changes += 1;
    build();
  }

  /** Replaces the contents. */
  function fill(changed) {
    contents = { ...contents, ...changed };
    changes += 1;
    sight.aim(contents, standing);
    if (theme) build();
  }

  function build() {
    for (const { mesh } of ways) discard(mesh);
    for (const { mesh, edges } of obstacles) [mesh, edges].forEach(discard);
    [...carried, ...bodies.flat()].forEach(discard);
    if (frames) discard(frames);
    // One axis cross per frame: x red, y green, z blue.
    const AXIS_M = 0.05;
    const crosses = contents.frames.flatMap(({ position_m: at, rotation }) =>
      AXES.map((colour, axis) => [
        at,
        at.map((v, i) => v + AXIS_M * rotation[i][axis]),
        [...colour, 1],
      ]),
    );
    frames = crosses.length ? strip(crosses) : null;
    ways = contents.ways.map(({ places, kinds, width }) => ({
      width,
      mesh: strip(
        places
          .slice(1)
          .flatMap((to, i) => (kinds[i + 1] ? [[places[i], to, [...theme[kinds[i + 1]], 1]]] : [])),
      ),
    }));
    obstacles = contents.obstacles.map(({ shape, origin }) => ({
      mesh: solid([{ shape, origin, colour: theme.soft }]),
      edges: strip(
        (shape.edges || []).map((ends) => [
          ...ends.map((end) => transformed(origin, end)),
          [...theme.soft, 0.9],
        ]),
      ),
      alpha: shape.endless ? 0.07 : 0.24,
    }));
    const flange = model.joints.length;
    const atFlange = ({ shape, origin }) =>
      solid([{ shape, origin, colour: theme.settle, link: flange }]);
    carried = contents.tool.map(atFlange);
    bodies = contents.bodies.map((shapes) => shapes.map(atFlange));
  }

  const drawArm = (poses, count) => {
    const all = new Float32Array(16 * poses.length);
    poses.forEach((pose, link) => {
      all.set(pose, 16 * link);
    });
    place(all);
    draw(arm, count);
    for (const mesh of carried) draw(mesh);
    for (const body of poses.bodies || []) {
      for (const mesh of bodies[body] || []) draw(mesh);
    }
  };
  const shadows = makeShadows(painter, (poses) => drawArm(poses, look.casting));

  /** Sets the style of solids: their own colours, or partly another one; as ghosts with a share. */
  const shade = (tint, tinted, alpha, ghost = 0) => {
    const uniforms = use(solids);
    gl.uniform3fv(uniforms.tint, tint || [1, 1, 1]);
    gl.uniform1f(uniforms.tinted, tinted);
    gl.uniform1f(uniforms.alpha, alpha);
    gl.uniform1f(uniforms.ghost, ghost);
  };
  /** Sets one fill colour. */
  const fillWith = (colour, alpha) => {
    gl.uniform4f(use(flats).colour, ...colour, alpha);
  };
  const place = (matrix) =>
    gl.uniformMatrix4fv(painter.program.uniforms["links[0]"], false, matrix);
  const beadAt = (p, radius, mesh = bead) => {
    place(new Float32Array([radius, 0, 0, 0, 0, radius, 0, 0, 0, 0, radius, 0, ...p, 1]));
    draw(mesh);
  };

  /** Draws robots: joint positions, the TCP in the flange frame if there is a tool, the indices of
      carried bodies, and the colour of ghosts. `gap` is a line from the robot to the nearest
      obstacle or link. */
  function show(arms, gap) {
    const ratio = Math.min(window.devicePixelRatio || 1, 2) * sharpness;
    const width = Math.max(1, Math.round(canvas.clientWidth * ratio));
    const height = Math.max(1, Math.round(canvas.clientHeight * ratio));
    if (canvas.width !== width || canvas.height !== height)
      [canvas.width, canvas.height] = [width, height];
    const all = arms.map(({ q, ghost, tool, bodies: held }) => ({
      poses: Object.assign(linkPoses(q), { bodies: held }),
      ghost,
      tool,
    }));
    const solidOnes = all.filter(({ ghost }) => !ghost);
    if (!standing.length && all.length) {
      standing = all.flatMap(({ poses }) => poses.map((pose) => Array.from(pose.slice(12, 15))));
      sight.aim(contents, standing);
    }
    const { matrix, eye } = sight.camera();
    if (solidOnes.length) shadows.cast(solidOnes, changes, sharpness < 1);

    gl.viewport(0, 0, width, height);
    gl.clearColor(...theme.ground, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);

    for (const each of [solids, flats, lines, floors])
      gl.uniformMatrix4fv(use(each).camera, false, matrix);
    gl.uniform2f(use(lines).pixels, width / 2, height / 2);
    const drawLines = (mesh, px) => {
      gl.uniform1f(use(lines).width, (px * ratio) / 2);
      draw(mesh);
    };

    gl.depthMask(false);
    const under = use(floors);
    gl.uniform3fv(under.patch_, shadows.patch);
    gl.uniform3fv(under.rule, theme.rule);
    gl.uniform1f(under.shadow, solidOnes.length ? Math.min(2.2 * theme.shadow, 0.6) : 0);
    gl.uniform1f(under.extent, 2.2);
    take("near", 0, shadows.near);
    take("far", 1, shadows.far);
    draw(floor);
    gl.depthMask(true);

    shade(null, 0, 1);
    const { uniforms } = painter.program;
    gl.uniform3fv(uniforms.eye, eye);
    gl.uniform3fv(uniforms.key, KEY);
    gl.uniformMatrix4fv(uniforms.sun, false, shadows.sun);
    take("shadows", 2, shadows.depths);
    // Closed solids without back faces: without a graphics card, triangles take most of the time.
    if (look.is_closed) gl.enable(gl.CULL_FACE);
    for (const { poses } of solidOnes) drawArm(poses);
    gl.disable(gl.CULL_FACE);
    // Where two paths coincide, the later one is visible on the broader one before it.
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
    for (const { poses } of solidOnes) beadAt(poses[poses.length - 1].slice(12, 15), 0.012);
    for (const { poses, tool } of solidOnes) {
      if (!tool) continue;
      const [flange, tcp] = [[0, 0, 0], tool].map((at) => transformed(poses[poses.length - 1], at));
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

    // Transparent objects are drawn last: obstacles, spheres, and the nearest surface of a ghost.
    gl.depthMask(false);
    for (const { mesh, alpha } of obstacles) {
      fillWith(theme.soft, alpha);
      place(still);
      draw(mesh);
    }
    for (const { edges } of obstacles) drawLines(edges, 1.5);
    shade(theme.blend, 1, 0.2);
    for (const corner of contents.corners)
      if (corner.radius_m) beadAt(corner.target_m, corner.radius_m, ball);
    gl.depthMask(true);
    // Ghosts are a little thinner, so that the solid robot is visible where both coincide.
    const swell = (m) => {
      for (const each of [flats, solids]) gl.uniform1f(use(each).swell, m);
    };
    swell(-0.002);
    if (look.is_closed) gl.enable(gl.CULL_FACE);
    for (const { poses, ghost } of all) {
      if (!ghost) continue;
      gl.colorMask(false, false, false, false);
      fillWith(theme[ghost], 1);
      drawArm(poses);
      gl.colorMask(true, true, true, true);
      shade(theme[ghost], 0.75, 1, 1);
      drawArm(poses);
    }
    gl.disable(gl.CULL_FACE);
    swell(0);
  }

  /** State of the last drawing by `follow`. */
  let last = { text: "", q: [], since: 0, isSharp: true };

  /** Draws robots in motion. A robot at rest is not drawn again, except once at full resolution if
      it was reduced. `now` is in ms. */
  function follow(arms, gap, now) {
    const STILL_RAD = 1e-4;
    const REST_MS = 250;
    const rounded = gap?.map((end) => end.map((v) => Math.round(v * 5000)));
    const size = [canvas.clientWidth, canvas.clientHeight, window.devicePixelRatio];
    const text = JSON.stringify([
      arms.map(({ ghost, tool }) => [ghost, tool]),
      rounded,
      size,
      sight.state(),
      changes,
    ]);
    const q = arms.map((each) => Array.from(each.q));
    const stands =
      text === last.text &&
      q.every((joints, i) => joints.every((v, j) => Math.abs(v - last.q[i][j]) < STILL_RAD));
    if (!stands) {
      last = { text, q, since: now, isSharp: sharpness === 1 };
      show(arms, gap);
    } else if (!last.isSharp && now - last.since > REST_MS) {
      last.isSharp = true;
      const coarse = sharpness;
      sharpness = 1;
      show(arms, gap);
      sharpness = coarse;
    }
  }

  /** Sets the resolution as a share of the screen resolution, for slow machines. */
  const sharpen = (share) => {
    sharpness = share;
  };
  sight.aim(contents, standing);
  return { ...sight, show, follow, paint, fill, sharpen };
}
