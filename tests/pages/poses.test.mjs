import assert from "node:assert/strict";
import { test } from "node:test";
import { randoms, scripts } from "./scripts.mjs";

const { countUpTo, jointsAt, unpackPoses, unpackCurve } = scripts(
  ["page/poses.js"],
  ["countUpTo", "jointsAt", "unpackPoses", "unpackCurve"],
);

const packed = (numbers) => Buffer.from(numbers.buffer).toString("base64");

test("packed poses are those that were packed", () => {
  const t_s = Float64Array.of(0, 0.1, 1 / 3);
  const q_rad = Float32Array.from({ length: 21 }, (_, i) => Math.sin(i));
  const poses = unpackPoses({ count: 3, t_s: packed(t_s), q_rad: packed(q_rad) });
  assert.deepEqual(poses, { count: 3, t_s, q_rad });
});

test("a curve without highest values has the lowest ones for both", () => {
  const [t_s, low] = [Float64Array.of(0, 1), Float32Array.of(-1, 2)];
  const curve = unpackCurve({ t_s: packed(t_s), low: packed(low) });
  assert.deepEqual([...curve.high], [-1, 2]);
  const high = Float32Array.of(5, 6);
  const other = unpackCurve({ t_s: packed(t_s), low: packed(low), high: packed(high) });
  assert.deepEqual([...other.high], [5, 6]);
});

test("times are counted as one by one", () => {
  const random = randoms();
  for (let size = 0; size < 40; size++) {
    // Some times occur twice.
    const times = Array.from({ length: size }, () => Math.floor(20 * random())).sort(
      (a, b) => a - b,
    );
    for (let t = -1; t <= 21; t += 0.5)
      assert.equal(countUpTo(times, t), times.filter((time) => time <= t).length);
  }
});

test("joints are interpolated, and kept before the start and after the end", () => {
  const q_rad = Float32Array.from({ length: 21 }, (_, i) =>
    i < 7 ? 0 : i < 14 ? i - 7 : 2 * (i - 14),
  );
  const arm = { poses: { t_s: [1, 2, 2], q_rad } };
  assert.deepEqual(jointsAt(arm, 0), [0, 0, 0, 0, 0, 0, 0]);
  assert.deepEqual(jointsAt(arm, 1.5), [0, 0.5, 1, 1.5, 2, 2.5, 3]);
  // At a jump, the later pose.
  assert.deepEqual(jointsAt(arm, 2), [0, 2, 4, 6, 8, 10, 12]);
  assert.deepEqual(jointsAt(arm, 9), [0, 2, 4, 6, 8, 10, 12]);
});
