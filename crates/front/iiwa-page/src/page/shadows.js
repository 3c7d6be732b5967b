// Shadows of the key light: on the robot by a depth map, on the floor with soft edges.

/** Direction to the key light: over the viewer's shoulder. */
const KEY = (() => {
  const [x, y, z] = [0.55, -0.45, 1.05];
  const length = Math.hypot(x, y, z);
  return [x / length, y / length, z / length];
})();

const QUAD = [-1, -1, 1, -1, 1, 1, -1, -1, 1, 1, -1, 1];

/** Shadows of robots that `drawArm` draws. */
function makeShadows(painter, drawArm) {
  const { gl, compiled, use, draw, into, take } = painter;
  const flats = compiled(FLAT_VERTEX, FLAT_FRAGMENT);
  const mask = compiled(MASK_VERTEX, MASK_FRAGMENT);
  const blur = compiled(BLUR_VERTEX, BLUR_FRAGMENT);
  const square = painter.upload([["corner", 2]], QUAD);
  const depths = painter.picture(768, true);
  const [cast, between, near, far] = [256, 128, 128, 128].map((size) =>
    painter.picture(size, false),
  );
  const made = { depths, near, far, sun: new Float32Array(16), patch: [0, 0, 1] };
  let before = "";
  let isLate = false;

  /** Projection from the light to a box of half width `reach` around `middle`. */
  const seenFrom = (middle, reach) => {
    const side = [-KEY[1], KEY[0], 0].map((v) => v / Math.hypot(KEY[0], KEY[1]));
    const up = [0, 1, 2].map(
      (i) => KEY[(i + 1) % 3] * side[(i + 2) % 3] - KEY[(i + 2) % 3] * side[(i + 1) % 3],
    );
    const matrix = new Float32Array(16);
    [side, up, KEY.map((v) => -v)].forEach((axis, row) => {
      axis.forEach((v, column) => {
        matrix[4 * column + row] = v / reach;
      });
      matrix[12 + row] = -axis.reduce((sum, v, i) => sum + v * middle[i], 0) / reach;
    });
    matrix[15] = 1;
    return matrix;
  };

  const blurred = (from, to, width) => {
    for (const [source, target, step] of [
      [from, between, [width, 0]],
      [between, to, [0, width]],
    ]) {
      into(target);
      const uniforms = use(blur);
      take("image", 0, source);
      gl.uniform2f(uniforms.step_, ...step);
      draw(square);
    }
  };

  const castOnArm = (arms) => {
    gl.disable(gl.BLEND);
    gl.enable(gl.DEPTH_TEST);
    gl.depthMask(true);
    gl.depthFunc(gl.LEQUAL);
    into(depths);
    gl.clear(gl.DEPTH_BUFFER_BIT);
    gl.uniformMatrix4fv(use(flats).camera, false, made.sun);
    // Surfaces at grazing light must not shade themselves.
    gl.enable(gl.POLYGON_OFFSET_FILL);
    gl.polygonOffset(4, 8);
    for (const { poses } of arms) drawArm(poses);
    gl.disable(gl.POLYGON_OFFSET_FILL);
  };

  const castOnFloor = (arms, places) => {
    // The shadow of each joint centre on the floor.
    const cast_ = places.map((place) => [0, 1].map((i) => place[i] - (KEY[i] / KEY[2]) * place[2]));
    const [x, y] = [0, 1]
      .map((i) => cast_.map((place) => place[i]))
      .map((all) => [Math.min(...all), Math.max(...all)]);
    const half = Math.max(x[1] - x[0], y[1] - y[0]) / 2 + 0.45;
    made.patch = [(x[0] + x[1]) / 2, (y[0] + y[1]) / 2, half];

    gl.disable(gl.DEPTH_TEST);
    into(cast);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT);
    gl.enable(gl.BLEND);
    gl.blendEquation(gl.MAX);
    gl.blendFunc(gl.ONE, gl.ONE);
    const uniforms = use(mask);
    gl.uniform3fv(uniforms.key, KEY);
    gl.uniform3fv(uniforms.patch_, made.patch);
    for (const { poses } of arms) drawArm(poses);
    gl.blendEquation(gl.FUNC_ADD);
    gl.disable(gl.BLEND);
    // Blur radii are in m, independent of the size of the patch.
    blurred(cast, near, 0.008 / (2 * half));
    blurred(near, far, 0.03 / (2 * half));
  };

  /** Updates the shadows of robots in these poses, unless poses and contents are unchanged. With
      `isQuick`, floor shadows are updated every other time. */
  made.cast = (arms, changes, isQuick) => {
    const places = arms.flatMap(({ poses }) => poses.map((pose) => Array.from(pose.slice(12, 15))));
    const now = [
      changes,
      isQuick,
      ...arms.map(({ poses }) => poses.map((pose) => pose.join()).join()),
    ].join(";");
    if (now === before) return;
    before = now;
    const ROOM_M = 0.2;
    const box = [0, 1, 2]
      .map((i) => places.map((place) => place[i]))
      .map((all) => [Math.min(...all), Math.max(...all)]);
    const middle = box.map(([low, high]) => (low + high) / 2);
    const reach = Math.hypot(...box.map(([low, high]) => high - low)) / 2 + ROOM_M;
    made.sun = seenFrom(middle, reach);
    castOnArm(arms);
    isLate = isQuick && !isLate;
    if (!isLate) castOnFloor(arms, places);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  };
  return made;
}
