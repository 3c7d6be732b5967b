// The camera of the 3D view: it looks at a centre from a direction, far enough to show everything.

/** View directions: angle about z and elevation, in rad. */
const LOOKS = {
  usual: { azimuth: -0.9, height: 0.36 },
  front: { azimuth: 0, height: 0 },
  side: { azimuth: -Math.PI / 2, height: 0 },
  top: { azimuth: -Math.PI / 2, height: Math.PI / 2 },
};

/** Tangent of half the vertical angle of view. */
const LENS = Math.tan(0.25);

/** The camera of a canvas. */
function makeSight(canvas) {
  let view;
  /** Points that the view has to include, each with some room around it. */
  let points = [];
  let fitted = null;

  /** Axes of a view: to the right, upwards, and back to the viewer. */
  const axesOf = ({ azimuth, height }) => {
    const [sa, ca] = [Math.sin(azimuth), Math.cos(azimuth)];
    const [sh, ch] = [Math.sin(height), Math.cos(height)];
    return [
      [-sa, ca, 0],
      [-ca * sh, -sa * sh, ch],
      [ca * ch, sa * ch, sh],
    ];
  };
  /** The smallest and the largest number. `Math.min(...all)` would overflow the call stack for the
      points of hundreds of obstacles. */
  const ends = (all) =>
    all.reduce(
      ([low, high], v) => [Math.min(low, v), Math.max(high, v)],
      [Number.POSITIVE_INFINITY, Number.NEGATIVE_INFINITY],
    );
  const along = (axis, p) => axis[0] * p[0] + axis[1] * p[1] + axis[2] * p[2];

  /** Includes the robot, its paths and the nearby parts of obstacles in the view. */
  function aim(contents, standing) {
    const NEAR_M = 0.12;
    const MOST = 400;
    const thinned = (all) => all.filter((_, i) => i % Math.ceil(all.length / MOST) === 0);
    points = [[0, 0, 0.05], ...standing];
    for (const { places, joints } of contents.ways)
      points.push(...thinned(places), ...thinned(joints));
    // Without a path, the robot may move anywhere nearby.
    const REACH_M = 0.4;
    const around = [-REACH_M, REACH_M].flatMap((v) => [
      [v, 0, 0.5],
      [0, v, 0.5],
    ]);
    if (!contents.ways.length) points.push([0, 0, 0.9], ...around);
    const box = [0, 1, 2].map((i) => {
      const [low, high] = ends(points.map((p) => p[i]));
      return [low - NEAR_M, high + NEAR_M];
    });
    for (const { shape, origin } of contents.obstacles) {
      if (shape.endless) continue;
      for (const corner of thinned(shape.positions)) {
        points.push(
          transformed(origin, corner).map((v, i) => Math.min(Math.max(v, box[i][0]), box[i][1])),
        );
      }
    }
    fitted = null;
  }

  /** Aspect ratio of the canvas, and the share of its height under the buttons: positive at the
      top, negative at the bottom. */
  function frame() {
    const height = Math.max(canvas.clientHeight, 1);
    const bar = canvas.parentElement?.querySelector(".looks");
    const share = bar?.offsetHeight ? Math.min((bar.offsetHeight + 10) / height, 0.3) : 0;
    const isAbove = bar && 2 * bar.offsetTop < height;
    return { aspect: canvas.clientWidth / height || 1, share: isAbove ? share : -share };
  }

  /** The centre, and the distance from which everything is in the view, for a direction. */
  function fit(look, { aspect, share }) {
    const across = 1 - Math.abs(share);
    const axes = axesOf(look);
    const spans = axes.map((axis) => points.map((p) => along(axis, p)));
    const ROOM_M = 0.13;
    const middles = spans.map((all) => ends(all).reduce((low, high) => (low + high) / 2));
    const middle = [0, 1, 2].map((i) =>
      axes.reduce((sum, axis, k) => sum + axis[i] * middles[k], 0),
    );
    const needed = points.map((_, k) => {
      const [x, y, z] = spans.map((all, i) => all[k] - middles[i]);
      return (
        z +
        Math.max((Math.abs(x) + ROOM_M) / (LENS * aspect), (Math.abs(y) + ROOM_M) / (LENS * across))
      );
    });
    return { middle, far: ends(needed)[1], aspect, share };
  }

  /** The fitted view for the current size of the canvas. */
  function fitting() {
    const now = frame();
    const isSame =
      fitted && ["aspect", "share"].every((name) => Math.abs(fitted[name] - now[name]) < 1e-6);
    if (!isSame) fitted = fit(view.fitted, now);
    return { ...fitted, far: fitted.far / view.nearer };
  }

  /** The matrix from the base to the canvas, and the eye. */
  function camera() {
    const { middle: aimed, far, aspect, share } = fitting();
    const [right, up, back] = axesOf(view);
    const middle = aimed.map((v, i) => v + view.offset_m[i]);
    const eye = middle.map((v, i) => v + far * back[i]);
    const look = new Float32Array(16);
    [right, up, back].forEach((axis, row) => {
      axis.forEach((v, column) => {
        look[4 * column + row] = v;
      });
      look[12 + row] = -along(axis, eye);
    });
    look[15] = 1;
    const [near, end] = [0.02 * far, far + 6];
    const lens = new Float32Array(16);
    lens[0] = 1 / (LENS * aspect);
    lens[5] = 1 / LENS;
    // The centre of the area without the buttons.
    lens[9] = share;
    lens[10] = (near + end) / (near - end);
    lens[11] = -1;
    lens[14] = (2 * near * end) / (near - end);
    return { matrix: product(lens, look), eye };
  }

  /** Turns the view, in rad, and zooms by a factor. */
  function turn(azimuth, height, nearer = 1) {
    view.azimuth += azimuth;
    view.height = Math.min(Math.max(view.height + height, -0.3), Math.PI / 2);
    view.nearer = Math.min(Math.max(view.nearer * nearer, 0.3), 8);
  }

  /** Shifts the view, in px. */
  function pan(right_px, down_px) {
    const m = (2 * LENS * fitting().far) / Math.max(canvas.clientHeight, 1);
    const [right, up] = axesOf(view);
    const most = 2;
    view.offset_m = view.offset_m.map((v, i) => {
      const shifted = v - m * right_px * right[i] + m * down_px * up[i];
      return Math.min(Math.max(shifted, -most), most);
    });
  }

  /** Selects a view direction by its name. */
  function look(name) {
    view = { ...LOOKS[name], fitted: LOOKS[name], nearer: 1, offset_m: [0, 0, 0] };
    fitted = null;
  }
  const reset = () => look("usual");
  reset();
  /** Takes over the view of another scene, which fits the size of this canvas. */
  function adopt(other) {
    view = { ...other };
    fitted = null;
  }
  /** All state that a picture depends on. */
  const state = () => [view, fitted];
  return { aim, camera, turn, pan, look, reset, adopt, state };
}
