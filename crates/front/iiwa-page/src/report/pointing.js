// Input on the charts by mouse, touch and keys: values at a point, time window, time.

/** Least motion of a mouse drag, in px. */
const STILL_PX = 5;

const pointing = { chart: null, t: 0 };

/** The time at a screen position, within the time window. */
function timeAt({ canvas }, clientX) {
  const box = canvas.getBoundingClientRect();
  const share = (clientX - box.left - LEFT) / (box.width - LEFT - RIGHT);
  const { from, to } = state.window;
  return from + Math.min(Math.max(share, 0), 1) * (to - from);
}

/** Shows the values at a time beside one chart, and a line at that time in all charts; hides both
    without a chart. */
function pointAt(chart, t) {
  [pointing.chart, pointing.t] = [chart, t];
  for (const it of charts) {
    if (chart) placeAt(it.hover, t);
    else it.hover.hidden = true;
    it.told.hidden = it !== chart || it.hover.hidden;
  }
  if (!chart || chart.told.hidden) return;
  const { told, canvas } = chart;
  const readings = chart.readings(t);
  const rows = readings.map(([colour, name, text]) => {
    const row = element("span");
    const swatch = element("i", "", "swatch");
    swatch.style.background = `var(--${colour})`;
    row.append(swatch, name ? `${name} ` : "", element("b", text));
    return row;
  });
  told.replaceChildren(element("b", `${number(t, 3)} s`), ...rows);
  const words = readings.map(([, name, text]) => `${name} ${text}`.trim());
  canvas.setAttribute("aria-valuetext", [`${number(t, 3)} s`, ...words].join(", "));
  // The values are beside the line, and within the chart.
  const [wide, share] = [canvas.clientWidth, shareOf(t)];
  const at = LEFT + share * (wide - LEFT - RIGHT);
  const left = at + 10 + told.offsetWidth > wide ? at - 10 - told.offsetWidth : at + 10;
  told.style.left = `${Math.max(Math.min(left, wide - told.offsetWidth), 0)}px`;
}

/** Updates the slider values of the charts for assistive technology. */
function tellSliders() {
  for (const { canvas } of charts) {
    canvas.setAttribute("aria-valuemin", number(startS, 3));
    canvas.setAttribute("aria-valuemax", number(endS, 3));
    canvas.setAttribute("aria-valuenow", number(state.time, 3));
    canvas.setAttribute("aria-valuetext", `${number(state.time, 3)} s`);
  }
}

/** Pinch zoom: each finger keeps its time, and the fingers set the time window. */
function spread(chart, pinch, fingers) {
  const box = chart.canvas.getBoundingClientRect();
  const wide = box.width - LEFT - RIGHT;
  const shares = [...fingers.values()].map(({ now }) => (now - box.left - LEFT) / wide);
  const apart = shares[1] - shares[0];
  if (Math.abs(apart) < 0.02) return;
  const span = (pinch[1] - pinch[0]) / apart;
  if (span > 0) look(pinch[0] - shares[0] * span, span);
}

function listenToChart(chart) {
  const { canvas, select } = chart;
  const isTimeline = canvas.id === "timeline";
  const fingers = new Map();
  let pinch = null;
  const drags = (finger) => Math.abs(finger.now - finger.from) > STILL_PX;
  canvas.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    canvas.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, { from: event.clientX, now: event.clientX });
    pinch = fingers.size === 2 ? [...fingers.values()].map(({ now }) => timeAt(chart, now)) : null;
    play(false);
    if (isTimeline || event.pointerType === "touch") seek(timeAt(chart, event.clientX));
  });
  canvas.addEventListener("pointermove", (event) => {
    const finger = fingers.get(event.pointerId);
    const t = timeAt(chart, event.clientX);
    if (finger) finger.now = event.clientX;
    if (pinch && fingers.size === 2) return spread(chart, pinch, fingers);
    if (finger && (isTimeline || event.pointerType === "touch")) seek(t);
    else if (finger && drags(finger)) {
      const box = canvas.getBoundingClientRect();
      const ends = [finger.from, finger.now].map((at) =>
        Math.min(Math.max(at - box.left, LEFT), box.width - RIGHT),
      );
      select.hidden = false;
      select.style.left = `${Math.min(...ends)}px`;
      select.style.width = `${Math.abs(ends[1] - ends[0])}px`;
    }
    pointAt(chart, t);
  });
  const lift = (event) => {
    const finger = fingers.get(event.pointerId);
    fingers.delete(event.pointerId);
    select.hidden = true;
    if (fingers.size === 0) pinch = null;
    return finger;
  };
  canvas.addEventListener("pointerup", (event) => {
    const wasPinch = pinch !== null;
    const finger = lift(event);
    if (!finger || wasPinch || isTimeline || event.pointerType === "touch") return;
    if (!drags(finger)) return seek(timeAt(chart, event.clientX));
    const ends = [timeAt(chart, finger.from), timeAt(chart, event.clientX)];
    look(Math.min(...ends), Math.abs(ends[1] - ends[0]));
  });
  canvas.addEventListener("pointercancel", lift);
  canvas.addEventListener("pointerleave", () => pointAt(null, 0));
  canvas.addEventListener("dblclick", () => look(whole.from, whole.to - whole.from));
  canvas.addEventListener("keydown", (event) => {
    const span = state.window.to - state.window.from;
    const by = (event.shiftKey ? 0.1 : 0.01) * span;
    const does = {
      ArrowLeft: () => seek(state.time - by),
      ArrowRight: () => seek(state.time + by),
      PageDown: () => seek(state.time - 0.1 * span),
      PageUp: () => seek(state.time + 0.1 * span),
      Home: () => seek(state.window.from),
      End: () => seek(state.window.to),
      "+": () => zoom(0.5),
      "-": () => zoom(2),
      0: () => look(whole.from, whole.to - whole.from),
    };
    if (!does[event.key] || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    play(false);
    does[event.key]();
    tellSliders();
    pointAt(chart, state.time);
  });
  canvas.addEventListener("focus", () => {
    if (!canvas.matches(":focus-visible")) return;
    tellSliders();
    pointAt(chart, state.time);
  });
  canvas.addEventListener("blur", () => pointAt(null, 0));
}
