// Packed poses over time.

/** Bytes of a base64 text. */
function unpack(text) {
  const raw = atob(text);
  const bytes = new Uint8Array(raw.length);
  for (let i = 0; i < raw.length; i++) bytes[i] = raw.charCodeAt(i);
  return bytes.buffer;
}

/** Unpacks poses: their number, times in s, and joint positions in rad, seven per pose. */
function unpackPoses({ count, t_s, q_rad }) {
  return { count, t_s: new Float64Array(unpack(t_s)), q_rad: new Float32Array(unpack(q_rad)) };
}

/** Unpacks a curve: times in s, and for each interval the lowest and the highest value. */
function unpackCurve(curve) {
  const low = new Float32Array(unpack(curve.low));
  const high = curve.high === undefined ? low : new Float32Array(unpack(curve.high));
  return { ...curve, t_s: new Float64Array(unpack(curve.t_s)), low, high };
}

/** Number of `times`, which increase, that are at most `t`. */
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

/** Joint positions at a time, in rad, by linear interpolation of poses. */
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
