// The data of the page: unpacked numbers, and access by time.

const report = JSON.parse(document.getElementById("data").textContent);
const { robot } = report;

for (const arm of report.arms) {
  arm.poses = unpackPoses(arm.poses);
  for (const name of ["position", "velocity", "acceleration", "jerk", "snap", "torque"])
    arm[name] = unpackCurve(arm[name]);
  if (arm.speed) arm.speed = unpackCurve(arm.speed);
  for (const it of [arm.clearance, arm.self_clearance])
    if (it) it.distance = unpackCurve(it.distance);
}
const { compared } = report;
for (const name of ["tcp_mm", "joints_mrad"])
  if (compared) compared[name] = unpackCurve(compared[name]);

const startS = Math.min(...report.arms.map((arm) => arm.start_s));
const endS = Math.max(...report.arms.map((arm) => arm.end_s), startS + 1e-3);

/** Value number `j` of `of` of a curve at a time: linear interpolation between the column
    centres. */
function valueAt(curve, t, j, of = 7) {
  const last = curve.t_s.length - 1;
  const i = Math.min(Math.max(countUpTo(curve.t_s, t) - 1, 0), last);
  const next = Math.min(i + 1, last);
  const middle = (k) => (curve.low[of * k + j] + curve.high[of * k + j]) / 2;
  const span = curve.t_s[next] - curve.t_s[i];
  const share = span > 0 ? Math.min(Math.max((t - curve.t_s[i]) / span, 0), 1) : 0;
  return share === 0 ? middle(i) : middle(i) + share * (middle(next) - middle(i));
}

/** Value of a curve at a time; NaN beyond its ends and in its gaps. */
function readingAt(curve, t, j, of = 1) {
  const { t_s } = curve;
  if (!t_s.length || t < t_s[0] - 1e-9 || t > t_s[t_s.length - 1] + 1e-9) return Number.NaN;
  return valueAt(curve, t, j, of);
}

const pieceStarts = report.pieces.map((piece) => piece.start_s);
/** The TCP in motion at a time, in the flange frame. */
const toolAt = toolOf(report.workcell.tcps, report.pieces);
/** The piece of the plan at a time, if there is one. */
function pieceAt(t) {
  return report.pieces[Math.max(countUpTo(pieceStarts, t) - 1, 0)];
}

// ---- shown state

const [first, second] = report.arms;
const isPlan = first.role === "plan";
/** Name of a robot if both are shown. */
const called = (arm) =>
  arm.role === "recording" ? "measured" : arm === second ? "other plan" : "plan";
/** Initial time window: the plan, or the whole recording. */
const whole = isPlan
  ? { from: first.start_s, to: Math.max(first.end_s, first.start_s + 1e-3) }
  : { from: startS, to: endS };
const state = {
  time: whole.from,
  playing: false,
  speed: 1,
  window: { ...whole },
  joints: Array(7).fill(true),
  percent: true,
};
