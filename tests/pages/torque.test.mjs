import assert from "node:assert/strict";
import { test } from "node:test";
import { scripts } from "./scripts.mjs";

/** Joint 1 waits for 0.2 s, accelerates to 0.5 rad/s within 0.1 s, and turns until 3 s; the others
    stand still. */
const turned = (t) => {
  const moving = Math.min(Math.max(t - 0.2, 0), 2.8);
  return moving < 0.1 ? 2.5 * moving * moving : 0.5 * moving - 0.025;
};
const joints = (t) => [turned(t), 0.3, 0, -1, 0, 0.5, 0];

/** A page with a plan of these joints whose torque is its time, in Nm, times the number of the
    joint. */
function page(joints) {
  const t_s = Float64Array.from({ length: 121 }, (_, i) => i / 40);
  const q_rad = Float32Array.from([...t_s].flatMap((t) => joints(t)));
  const low = Float32Array.from([...t_s].flatMap((t) => [1, 2, 3, 4, 5, 6, 7].map((j) => t * j)));
  const arm = { poses: { count: 121, t_s, q_rad }, end_s: 3, torque: { t_s, low, high: low } };
  const desk = { plan: { start_rad: joints(0), arms: [arm] } };
  const live = { newest: null };
  const { watchRun, plannedTorques } = scripts(
    ["page/poses.js", "twin/torque.js"],
    ["watchRun", "plannedTorques"],
    { desk, live },
  );
  const sample = (t, q) => {
    live.newest = { t_s: t, joints_rad: q };
    return plannedTorques(t, q);
  };
  return { watchRun, sample };
}

/** Torques of a run that begins at 100 s by the drive's clock, with samples at these times of the
    plan. */
function torques(times) {
  const { watchRun, sample } = page(joints);
  sample(99, joints(0));
  watchRun(true);
  return times.map((t) => sample(100 + t, joints(t)));
}

const isUnknown = (row) => row.length === 7 && row.every(Number.isNaN);

test("torques are those of the plan at the time of the robot", () => {
  const times = Array.from({ length: 600 }, (_, i) => 0.005 * i);
  torques(times).forEach((row, i) => {
    if (times[i] < 0.2) assert(isUnknown(row), `known at ${times[i]} s`);
    if (times[i] < 0.25) return;
    row.forEach((torque, j) => {
      // The plan has a torque for each 25 ms.
      assert(Math.abs(torque / (j + 1) - times[i]) < 0.04, `${torque} at ${times[i]} s`);
    });
  });
});

test("a page that misses the departure finds the time of the plan from the position", () => {
  for (const first of [0.3, 0.7, 1.9]) {
    const [row, next] = torques([first, first + 0.5]);
    assert(Math.abs(row[0] - first) < 0.03, `${row[0]} at ${first} s`);
    assert(Math.abs(next[0] - first - 0.5) < 0.03, `${next[0]} after ${first} s`);
  }
});

test("a path that comes back is at its first pass", () => {
  // There and back; joint 2 is a little farther on the way back.
  const there = (t) => joints(Math.min(t, 3 - t));
  const both = (t) => there(t).map((q, j) => (j === 1 && t > 1.5 ? q + 1e-3 : q));
  const { watchRun, sample } = page(both);
  sample(99, both(0));
  watchRun(true);
  sample(100.2, both(0.2));
  // 0.4 s after the last sample at rest, so that the way back is out of question, though nearer.
  const [torque] = sample(100.6, both(2.4));
  assert(Math.abs(torque - 0.6) < 0.03, `${torque}`);
});

test("torques are unknown after the end and outside a run", () => {
  const [, last, after] = torques([1, 2.9, 3.2]);
  assert(!isUnknown(last));
  assert(isUnknown(after));
  const { watchRun, sample } = page(joints);
  assert(isUnknown(sample(100, joints(1))));
  // The page was opened during the run, away from the start.
  watchRun(true);
  assert(isUnknown(sample(101, joints(2))));
});
