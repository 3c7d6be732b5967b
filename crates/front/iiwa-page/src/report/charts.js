// Curves of joint quantities with their limits, the clearance and the timeline.

const QUANTITIES = [
  { key: "position", title: "Position", unit: "deg", limit: "upper_rad" },
  { key: "velocity", title: "Velocity", unit: "deg/s", limit: "velocity_rad_s" },
  { key: "acceleration", title: "Acceleration", unit: "deg/s\u00b2", limit: "acceleration_rad_s2" },
  { key: "jerk", title: "Jerk", unit: "deg/s\u00b3", limit: "jerk_rad_s3" },
  // Joints do not have a snap limit. The chart is shown on request.
  { key: "snap", title: "Snap", unit: "deg/s\u2074" },
  { key: "torque", title: "Torque, link side", unit: "Nm", limit: "torque_nm", factor: 1 },
];

/** Time intervals with motion-specific limits: shares of the robot limits, one per joint. */
function ownLimits(key) {
  const runs = [];
  for (const { motion, start_s, end_s } of report.pieces) {
    const shares = report.shares[motion]?.[key];
    if (!shares || shares.every((share) => share === 1)) continue;
    const last = runs[runs.length - 1];
    // Consecutive motions with the same limits share one band.
    if (last && last.to === start_s && last.shares.every((share, j) => share === shares[j]))
      last.to = end_s;
    else runs.push({ from: start_s, to: end_s, shares });
  }
  return runs;
}
for (const quantity of QUANTITIES) quantity.own = ownLimits(quantity.key);

/** Drawn range of a quantity, in per cent of the limits: a larger range would flatten the
    curves. */
const MOST_PERCENT = 300;

/** True if a quantity is shown as a share of its limit. */
const asShare = (quantity) => state.percent && Boolean(quantity.limit);

/** The scale from the value of a joint to the shown value: in per cent of its limits, whose middle
    is 0, or in deg or Nm. */
function shownScale(quantity) {
  const percent = asShare(quantity);
  const upper = report.robot[quantity.limit] || Array(7).fill(Infinity);
  const lower = quantity.key === "position" ? report.robot.lower_rad : upper.map((limit) => -limit);
  const { factor = DEG } = quantity;
  const scale = (j) => (percent ? 200 / (upper[j] - lower[j]) : factor);
  const offset = (j) => (percent ? (-100 * (upper[j] + lower[j])) / (upper[j] - lower[j]) : 0);
  return {
    scale,
    offset,
    highest: (j) => scale(j) * upper[j] + offset(j),
    lowest: (j) => scale(j) * lower[j] + offset(j),
  };
}

/** Draws one quantity of all joints; returns the largest value. `state` is shared: the time window,
    the selected joints, the units. */
function drawQuantity(canvas, quantity, state, theme, withTimes) {
  const size = cleared(canvas);
  const { context } = size;
  const shown = state.joints.flatMap((on, j) => (on ? [j] : []));
  const { scale, offset, highest, lowest } = shownScale(quantity);
  const percent = asShare(quantity);
  // Drawn range: in per cent, at least the band of the limits, at most three times as much.
  let most = percent ? 108 : 0;
  for (const arm of report.arms) {
    const curve = arm[quantity.key];
    const from = Math.max(countUpTo(curve.t_s, state.window.from) - 1, 0);
    const to = countUpTo(curve.t_s, state.window.to);
    for (const j of shown) {
      const [factor, shift] = [scale(j), offset(j)];
      for (let i = from; i < to; i++) {
        const [low, high] = [
          curve.low[7 * i + j] * factor + shift,
          curve.high[7 * i + j] * factor + shift,
        ];
        const value = Math.max(Math.abs(low), Math.abs(high));
        if (value * 1.06 > most) most = value * 1.06;
      }
    }
  }
  const largest = most / 1.06;
  most = Math.min(most, percent ? MOST_PERCENT : Infinity) || 1;
  const axis = axes(context, size, state.window, [-most, most], theme, withTimes);
  const { x, y, left, right, top, bottom } = axis;

  clipped(context, axis);
  // Area beyond the limits: of all joints in per cent, else of the joint with the widest limits.
  const farthest = percent ? 100 : Math.max(...shown.map(highest), 0);
  const deepest = percent ? -100 : Math.min(...shown.map(lowest), 0);
  context.fillStyle = theme.beyond;
  context.fillRect(left, top, right - left, Math.max(0, y(farthest) - top));
  context.fillRect(left, y(deepest), right - left, Math.max(0, bottom - y(deepest)));
  context.setLineDash([5, 4]);
  context.lineWidth = 1;
  for (const j of percent ? [-1] : quantity.limit ? shown : []) {
    context.strokeStyle = percent ? theme.blend : theme.joints[j];
    for (const limit of percent ? [-100, 100] : [lowest(j), highest(j)]) {
      const at = Math.round(y(limit)) + 0.5;
      context.beginPath();
      context.moveTo(left, at);
      context.lineTo(right, at);
      context.stroke();
    }
  }
  // The area beyond motion-specific limits, from the start to the end of each motion.
  context.setLineDash([2, 3]);
  for (const { from, to, shares } of quantity.own) {
    const [a, b] = [Math.max(x(from), left), Math.min(x(to), right)];
    if (a >= b) continue;
    const own = (j) => shares[j] * highest(j);
    const widest = Math.max(...shown.map(own), 0);
    context.fillStyle = theme.own;
    context.fillRect(a, y(farthest), b - a, y(widest) - y(farthest));
    context.fillRect(a, y(-widest), b - a, y(-farthest) - y(-widest));
    const same = percent && shown.every((j) => shares[j] === shares[shown[0]]);
    for (const j of same ? shown.slice(0, 1) : shown.filter((k) => shares[k] < 1)) {
      context.strokeStyle = same ? theme.blend : theme.joints[j];
      for (const sign of [-1, 1]) {
        const at = Math.round(y(sign * own(j))) + 0.5;
        context.beginPath();
        context.moveTo(a, at);
        context.lineTo(b, at);
        context.stroke();
      }
    }
  }
  context.setLineDash([]);
  context.lineJoin = "round";
  report.arms.forEach((arm, index) => {
    // The plan is a pale, broad band under the measured curve.
    const under = report.arms.length > 1 && index === 0;
    context.globalAlpha = under ? 0.4 : 1;
    context.lineWidth = under ? 4 : 1.5;
    const curve = arm[quantity.key];
    for (const j of shown) {
      context.strokeStyle = theme.joints[j];
      trace(context, curve.t_s, curve.low, curve.high, 7, j, state.window, x, (v) =>
        y(v * scale(j) + offset(j)),
      );
    }
  });
  context.globalAlpha = 1;
  context.restore();
  if (report.arms.every((arm) => arm[quantity.key].columns === 0)) {
    context.fillStyle = theme.soft;
    context.textAlign = "center";
    context.fillText("not in the file", (left + right) / 2, (top + bottom) / 2);
  }
  return largest;
}

/** Draws the clearance, and the nearest pair over time; `pairs` belong to the last curve. */
function drawClearance(canvas, curves, pairs, window_, theme) {
  // Names of pairs are above the curve.
  const { context, ...axis } = drawCurves(canvas, curves, window_, theme, { room: 0.3, least: 1 });
  const { x, left, right, top, bottom } = axis;
  clipped(context, axis);
  context.textAlign = "left";
  context.textBaseline = "top";
  context.setLineDash([2, 3]);
  pairs.forEach(({ from_s, text }, i) => {
    const [from, to] = [x(from_s), i + 1 < pairs.length ? x(pairs[i + 1].from_s) : right];
    if (to < left || from > right) return;
    context.strokeStyle = theme.soft;
    context.beginPath();
    context.moveTo(from, bottom);
    context.lineTo(from, top);
    context.stroke();
    const at = Math.max(from, left) + 4;
    if (Math.min(to, right) - at < context.measureText(text).width + 4) return;
    context.fillStyle = theme.soft;
    context.fillText(text, at, top + 2);
  });
  context.restore();
}
