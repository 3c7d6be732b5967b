// Curves over time, on 2D canvases.

/** Margins left and right of the curves, in px. */
const LEFT = 56;
const RIGHT = 8;

/** Clears a canvas and matches its resolution to the screen; sizes are in CSS px. */
function cleared(canvas) {
  const ratio = Math.min(window.devicePixelRatio || 1, 2);
  const [width, height] = [canvas.clientWidth, canvas.clientHeight];
  canvas.width = Math.max(1, Math.round(width * ratio));
  canvas.height = Math.max(1, Math.round(height * ratio));
  const context = canvas.getContext("2d");
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.font = `11px ${getComputedStyle(document.body).fontFamily}`;
  return { context, width, height };
}

/** A step of 1, 2 or 5 times a power of ten that divides a span into some `count`. */
function step(span, count) {
  const rough = span / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  const digit = rough / power;
  return power * (digit < 1.5 ? 1 : digit < 3.5 ? 2 : digit < 7.5 ? 5 : 10);
}

/** Tick values of an axis, with labels that fit in their room. */
function ticks(from, to, count) {
  const LONGEST = 7;
  const by = step(to - from, count);
  const decimals = Math.min(Math.max(0, -Math.floor(Math.log10(by) + 1e-9)), 100);
  const values = [];
  for (let i = Math.ceil(from / by - 1e-9); i * by <= to + 1e-9 * by; i++) values.push(i * by);
  const plain = values.map((value) => number(value, decimals));
  const fits = plain.every((text) => text.length <= LONGEST);
  const short = (value) => (value === 0 ? "0" : value.toExponential(1));
  return values.map((value, i) => ({ value, text: fits ? plain[i] : short(value) }));
}

/** Draws a curve with possibly far more values than pixels: in each column of pixels, the first,
    lowest, highest and last value. NaN is a gap. */
function trace(context, times, low, high, stride, offset, window_, x, y) {
  const first = Math.max(countUpTo(times, window_.from) - 1, 0);
  const last = Math.min(countUpTo(times, window_.to), times.length - 1);
  context.beginPath();
  let down = false;
  let pixel = null;
  const flush = () => {
    if (!pixel) return;
    const [px, a, least, most, b] = pixel;
    if (down) context.lineTo(px, a);
    else context.moveTo(px, a);
    if (least !== most) {
      context.lineTo(px, least);
      context.lineTo(px, most);
      context.lineTo(px, b);
    }
    down = true;
    pixel = null;
  };
  for (let i = first; i <= last; i++) {
    const k = stride * i + offset;
    if (Number.isNaN(low[k])) {
      flush();
      down = false;
      continue;
    }
    const px = x(times[i]);
    const [a, b] = [y(low[k]), y(high[k])];
    if (pixel && Math.floor(pixel[0]) === Math.floor(px)) {
      pixel[2] = Math.max(pixel[2], a);
      pixel[3] = Math.min(pixel[3], b);
      pixel[4] = b;
    } else {
      flush();
      pixel = [px, a, a, b, b];
    }
  }
  flush();
  context.stroke();
}

/** Draws the axes of a chart with lines and numbers; returns the scales from values to px. */
function axes(context, size, window_, range, theme, withTimes) {
  const bottom = size.height - (withTimes ? 20 : 6);
  const top = 6;
  const [left, right] = [LEFT, size.width - RIGHT];
  const x = (t) => left + ((t - window_.from) / (window_.to - window_.from)) * (right - left);
  const y = (v) => bottom - ((v - range[0]) / (range[1] - range[0])) * (bottom - top);
  context.lineWidth = 1;
  context.strokeStyle = theme.rule;
  context.fillStyle = theme.soft;
  context.textAlign = "right";
  context.textBaseline = "middle";
  const line = (...points) => {
    context.beginPath();
    for (const [px, py] of points) context.lineTo(px, py);
    context.stroke();
  };
  for (const { value, text } of ticks(...range, 4)) {
    const py = Math.round(y(value)) + 0.5;
    line([left, py], [right, py]);
    // Half a line of text is above the tick, and half below.
    context.fillText(text, left - 6, Math.min(Math.max(py, 6), size.height - 6));
  }
  context.textAlign = "center";
  context.textBaseline = "top";
  let written = -Infinity;
  for (const { value, text } of ticks(window_.from, window_.to, Math.max(2, size.width / 110))) {
    const px = Math.round(x(value)) + 0.5;
    line([px, top], [px, bottom]);
    if (!withTimes) continue;
    const half = context.measureText(`${text} s`).width / 2;
    const middle = Math.min(Math.max(px, half), size.width - half);
    if (middle - half < written + 6) continue;
    context.fillText(`${text} s`, middle, bottom + 5);
    written = middle + half;
  }
  return { x, y, left, right, top, bottom };
}

/** Clips drawing to the area between the axes, until `restore`. */
function clipped(context, { left, right, top, bottom }) {
  context.save();
  context.beginPath();
  context.rect(left, top, right - left, bottom - top);
  context.clip();
}

/** A horizontal line at a value, with a text above it. */
function levelLine(context, { left, right, y }, value, text, colour) {
  const at = Math.round(y(value)) + 0.5;
  context.save();
  context.strokeStyle = colour;
  context.fillStyle = colour;
  context.setLineDash([6, 4]);
  context.beginPath();
  context.moveTo(left, at);
  context.lineTo(right, at);
  context.stroke();
  context.textAlign = "right";
  context.textBaseline = "bottom";
  context.fillText(text, right - 4, at - 2);
  context.restore();
}

/** The lowest and the highest value of curves within a time window. */
function extent(curves, window_) {
  let [least, most] = [Infinity, -Infinity];
  for (const { t_s, low, high, of = 1, at = 0, factor = 1 } of curves) {
    const from = Math.max(countUpTo(t_s, window_.from) - 1, 0);
    const to = Math.min(countUpTo(t_s, window_.to), t_s.length - 1);
    for (let i = from; i <= to; i++) {
      const [a, b] = [factor * low[of * i + at], factor * high[of * i + at]];
      if (a < least) least = a;
      if (b > most) most = b;
    }
  }
  return least <= most ? [least, most] : [0, 0];
}

/** Draws curves with one axis. A curve has times, lowest and highest values (`of` numbers per time,
    of which number `at` is drawn), the name of its colour and a factor; a curve `under` others is
    pale and broad. Options: `fromZero` for an axis from 0, `least` for the minimum span of the
    axis, `room` above the curves as a share of the span, levels with their texts, `withTimes`.
    Returns the scales from times and values to px. */
function drawCurves(canvas, curves, window_, theme, options = {}) {
  const { fromZero = true, least = 0, room = 0.08, levels = [], withTimes = true } = options;
  const size = cleared(canvas);
  const { context } = size;
  let [low, high] = extent(curves, window_);
  for (const { value } of levels) high = Math.max(high, value);
  if (fromZero) low = 0;
  const lack = least - (high - low);
  if (lack > 0) [low, high] = fromZero ? [low, high + lack] : [low - lack / 2, high + lack / 2];
  const span = high - low || 1;
  const range = fromZero ? [0, high + room * span || 1] : [low - room * span, high + room * span];
  const axis = axes(context, size, window_, range, theme, withTimes);
  clipped(context, axis);
  for (const { value, text, colour = "blend" } of levels)
    levelLine(context, axis, value, text, theme[colour]);
  context.lineJoin = "round";
  for (const { t_s, low, high, of = 1, at = 0, colour, factor = 1, under = false } of curves) {
    context.globalAlpha = under ? 0.4 : 1;
    context.lineWidth = under ? 4 : 1.5;
    context.strokeStyle = theme[colour] || theme.joints[Number(colour.slice(1)) - 1];
    trace(context, t_s, low, high, of, at, window_, axis.x, (v) => axis.y(factor * v));
  }
  context.restore();
  return { context, ...axis };
}
