// The data of the page: numbers are unpacked, and asked for by time.

const report = JSON.parse(document.getElementById("data").textContent);

/** Bytes of a text in base64. */
function unpack(text) {
  const raw = atob(text);
  const bytes = new Uint8Array(raw.length);
  for (let i = 0; i < raw.length; i++) bytes[i] = raw.charCodeAt(i);
  return bytes.buffer;
}

for (const arm of report.arms) {
  arm.poses.t_s = new Float64Array(unpack(arm.poses.t_s));
  arm.poses.q_rad = new Float32Array(unpack(arm.poses.q_rad));
  for (const name of ["position", "velocity", "acceleration", "jerk"]) {
    const curve = arm[name];
    curve.t_s = new Float64Array(unpack(curve.t_s));
    curve.low = new Float32Array(unpack(curve.low));
    curve.high = curve.high === undefined ? curve.low : new Float32Array(unpack(curve.high));
  }
}

const startS = Math.min(...report.arms.map((arm) => arm.start_s));
const endS = Math.max(...report.arms.map((arm) => arm.end_s), startS + 1e-3);

/** How many of `times`, which increase, are at most `t`. */
function countUpTo(times, t) {
  let from = 0;
  let to = times.length;
  while (from < to) {
    const middle = (from + to) >> 1;
    if (times[middle] <= t) from = middle + 1;
    else to = middle;
  }
  return from;
}

/** Joint positions at a time, in rad: evenly from pose to pose. */
function jointsAt(arm, t) {
  const { t_s, q_rad } = arm.poses;
  const last = t_s.length - 1;
  const i = Math.min(Math.max(countUpTo(t_s, t) - 1, 0), last);
  const next = Math.min(i + 1, last);
  const span = t_s[next] - t_s[i];
  const share = span > 0 ? Math.min(Math.max((t - t_s[i]) / span, 0), 1) : 0;
  return Array.from({ length: 7 }, (_, j) => {
    const q = q_rad[7 * i + j];
    return q + share * (q_rad[7 * next + j] - q);
  });
}

/** A curve's value at a time, of joint j: evenly between columns, the middle of each. */
function valueAt(curve, t, j) {
  const last = curve.t_s.length - 1;
  const i = Math.min(Math.max(countUpTo(curve.t_s, t) - 1, 0), last);
  const next = Math.min(i + 1, last);
  const middle = (k) => (curve.low[7 * k + j] + curve.high[7 * k + j]) / 2;
  const span = curve.t_s[next] - curve.t_s[i];
  const share = span > 0 ? Math.min(Math.max((t - curve.t_s[i]) / span, 0), 1) : 0;
  return share === 0 ? middle(i) : middle(i) + share * (middle(next) - middle(i));
}

/** The piece of the plan at a time, if there is one. */
const pieceStarts = report.pieces.map((piece) => piece.start_s);
function pieceAt(t) {
  return report.pieces[Math.max(countUpTo(pieceStarts, t) - 1, 0)];
}

/** A number with so many decimals, and no minus in front of nothing. */
function number(value, decimals) {
  if (!Number.isFinite(value)) return "\u2013";
  const text = value.toFixed(decimals);
  return Number(text) === 0 ? text.replace("-", "") : text;
}
