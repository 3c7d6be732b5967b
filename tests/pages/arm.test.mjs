import assert from "node:assert/strict";
import { test } from "node:test";
import { randoms, scripts } from "./scripts.mjs";

/** A robot of two joints about z and y, 1 m and 0.5 m long, as a parsed URDF. */
const element = (attributes, origin) => ({
  getAttribute: (name) => attributes[name] ?? null,
  querySelector: () => origin && element(origin),
});
const joints = [
  element({ type: "revolute" }, { xyz: "0 0 0.3", rpy: "0 0 0" }),
  element({ type: "revolute" }, { xyz: "1 0 0", rpy: "-1.5707963267948966 0 0" }),
  element({ type: "fixed" }, { xyz: "0.5 0 0", rpy: "0 0 0" }),
];
class DOMParser {
  parseFromString() {
    return { querySelectorAll: () => joints };
  }
}

const arm = scripts(
  ["page/poses.js", "page/arm.js"],
  ["product", "placed", "transformed", "flangeAt", "tcpAt", "tcpPath", "toolOf"],
  { DOMParser, robot: { urdf: "" } },
);

const near = (a, b) =>
  assert(
    a.every((value, i) => Math.abs(value - b[i]) < 1e-6),
    `${a} instead of ${b}`,
  );

test("poses are those of a robot that is calculated by hand", () => {
  const random = randoms(5);
  for (let i = 0; i < 50; i++) {
    const [a, b] = [6 * random() - 3, 6 * random() - 3];
    const reach = 1 + 0.5 * Math.cos(b);
    // Its second axis is the y axis of the turned base: a positive angle lowers the flange.
    near(arm.flangeAt([a, b]), [reach * Math.cos(a), reach * Math.sin(a), 0.3 - 0.5 * Math.sin(b)]);
  }
  near(arm.tcpAt([0, 0], [0.1, 0, 0]), [1.6, 0, 0.3]);
  near(arm.tcpAt([0, 0], null), [1.5, 0, 0.3]);
});

test("a product of poses applies the second one first", () => {
  const random = randoms(9);
  for (let i = 0; i < 50; i++) {
    const three = () => [random(), random(), random()].map((v) => 2 * v - 1);
    const [a, b, p] = [arm.placed(three(), three()), arm.placed(three(), three()), three()];
    near(arm.transformed(arm.product(a, b), p), arm.transformed(a, arm.transformed(b, p)));
    // Rotations keep lengths.
    const [v, w] = [p, arm.transformed(a, p, 0)].map((it) => Math.hypot(...it));
    assert(Math.abs(v - w) < 1e-6);
  }
});

test("each piece has the tool of its motion", () => {
  const pieces = [
    { start_s: 0, motion: 1 },
    { start_s: 1, motion: 2 },
    { start_s: 2, motion: 5 },
  ];
  const tcps = [
    { motion: 1, offset_m: "first" },
    { motion: 3, offset_m: "second" },
  ];
  const at = arm.toolOf(tcps, pieces);
  assert.deepEqual([-1, 0, 1.5, 2, 9].map(at), ["first", "first", "first", "second", "second"]);
  assert.equal(arm.toolOf([], pieces)(1), null);
});

test("a path omits what looks the same and has a gap at a new tool", () => {
  // Two poses at rest, a move, and another tool at 3 s.
  const angles = [0, 0, 0.1, 0.1, 0.2];
  const poses = {
    count: 5,
    t_s: Float64Array.of(0, 1, 2, 3, 4),
    q_rad: Float32Array.from(angles.flatMap((a) => [a, 0, 0, 0, 0, 0, 0])),
  };
  const offset = [0.1, 0, 0];
  const toolAt = (t) => (t < 3 ? null : offset);
  const { places, times, gaps } = arm.tcpPath({ poses }, toolAt);
  assert.deepEqual(times, [0, 2, 3, 4]);
  assert.deepEqual([...gaps], [2]);
  near(places[0], [1.5, 0, 0.3]);
  near(places[2], [1.6 * Math.cos(0.1), 1.6 * Math.sin(0.1), 0.3]);
});
