import assert from "node:assert/strict";
import { test } from "node:test";
import { randoms, scripts } from "./scripts.mjs";

const { ticks, trace, number, atLeast } = scripts(
  ["page/basics.js", "page/poses.js", "page/plot.js"],
  ["ticks", "trace", "number", "atLeast"],
);

test("numbers have no minus before zero, and unknown ones are dashes", () => {
  assert.equal(number(-0.004, 2), "0.00");
  assert.equal(number(-0.006, 2), "-0.01");
  assert.equal(number(Number.NaN, 2), "\u2013");
  assert.equal(atLeast(0, 1, "mm"), "0.0 mm");
  assert.equal(atLeast(0.04, 1, "mm"), "below 0.1 mm");
});

test("ticks are even and within the axis, and their labels fit", () => {
  const random = randoms(7);
  for (let i = 0; i < 2000; i++) {
    const span = 10 ** (12 * random() - 6);
    const from = (random() - 0.5) * span * 10 ** (2 * random());
    const found = ticks(from, from + span, 4);
    const values = found.map((tick) => tick.value);
    assert(found.length >= 2 && found.length <= 8, `${found.length} ticks`);
    const by = values[1] - values[0];
    const digit = Number((by / 10 ** Math.floor(Math.log10(by) + 1e-6)).toFixed(3));
    assert([1, 2, 5].includes(digit), `a step of ${by}`);
    for (const value of values)
      assert(value >= from - 1e-6 * span && value <= from + span * (1 + 1e-6));
    assert(
      found.every(({ text }) => text.length <= 8),
      JSON.stringify(found),
    );
  }
  const texts = ticks(-0.2, 1, 4).map((tick) => tick.text);
  assert.deepEqual(texts, ["-0.2", "0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
});

/** Lines that `trace` draws, each as a list of points. */
function lines(times, values, width) {
  const drawn = [];
  const context = {
    beginPath: () => {},
    stroke: () => {},
    moveTo: (x, y) => drawn.push([[x, y]]),
    lineTo: (x, y) => drawn.at(-1).push([x, y]),
  };
  const window_ = { from: times[0], to: times.at(-1) };
  const x = (t) => (width * (t - window_.from)) / (window_.to - window_.from);
  // As on a screen: down is positive.
  trace(context, times, values, values, 1, 0, window_, x, (v) => -v);
  return drawn;
}

test("a curve with many values per pixel keeps its extrema", () => {
  const random = randoms(3);
  const times = Array.from({ length: 5000 }, (_, i) => i);
  const values = times.map(() => random());
  values[2345] = 7;
  values[3456] = -5;
  const [line, ...others] = lines(times, values, 40);
  assert.equal(others.length, 0);
  const heights = line.map(([, y]) => -y);
  assert.deepEqual([Math.max(...heights), Math.min(...heights)], [7, -5]);
  assert(line.length <= 4 * 41, `${line.length} points`);
  // Each column of pixels has its own extrema.
  const column = (x) => Math.floor(Math.min(x, 39.999));
  for (let k = 0; k < 40; k++) {
    const own = values.filter((_, i) => column((40 * i) / 4999) === k);
    const shown = line.filter(([x]) => column(x) === k).map(([, y]) => -y);
    assert.equal(Math.max(...shown), Math.max(...own), `column ${k}`);
    assert.equal(Math.min(...shown), Math.min(...own), `column ${k}`);
  }
});

test("unknown values are gaps", () => {
  const drawn = lines([0, 1, 2, 3, 4], [1, 2, Number.NaN, 3, 4], 400);
  assert.deepEqual(drawn, [
    [
      [0, -1],
      [100, -2],
    ],
    [
      [300, -3],
      [400, -4],
    ],
  ]);
});
