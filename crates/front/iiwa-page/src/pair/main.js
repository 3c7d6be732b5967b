// The page with two plans: one time for both.

const NAMES = ["Before", "After"];

const pair = JSON.parse($("data").textContent);
const ends = pair.plans.map((plan) => plan.end_s);
const whole = { from: 0, to: Math.max(...ends, 1e-3) };
const state = { time: 0, playing: false, speed: 1 };

const frames = pair.plans.map(({ html }, i) => {
  const frame = element("iframe");
  frame.title = `Plan ${NAMES[i].toLowerCase()} the change`;
  frame.allowFullscreen = true;
  frame.srcdoc = html;
  return frame;
});

const timelines = pair.plans.map(({ end_s: end, pieces }, i) => {
  const chart = element("div", "", "chart");
  const canvas = element("canvas", "", "strip");
  canvas.setAttribute("role", "img");
  canvas.setAttribute("aria-label", `Timeline of the motions ${NAMES[i].toLowerCase()} the change`);
  const cursor = element("i", "", "cursor");
  chart.append(canvas, cursor);
  $("timelines").append(element("h3", `${NAMES[i]}: ${number(end, 3)} s`), chart);
  canvas.addEventListener("click", (event) => {
    const width = canvas.clientWidth - LEFT - RIGHT;
    play(false);
    seek(((event.offsetX - LEFT) / width) * whole.to);
  });
  return { canvas, cursor, pieces, end };
});

function drawTimelines() {
  const { flat } = theme();
  for (const { canvas, pieces } of timelines) drawTimeline(canvas, pieces, whole, flat);
}

/** True while this page sets what the plans show. */
let leads = false;
/** Calls `show` for the pages of some plans. */
function lead(some, show) {
  leads = true;
  for (const frame of some) show(frame.contentWindow);
  leads = false;
}

function seek(t) {
  state.time = Math.min(Math.max(t, whole.from), whole.to);
  lead(frames, (page) => page.seek?.(state.time));
  showNow();
}

function showNow() {
  $("clock").textContent = `${number(state.time, 3)} s`;
  $("scrub").value = state.time;
  for (const { canvas, cursor, end } of timelines) {
    const width = canvas.clientWidth - LEFT - RIGHT;
    cursor.style.left = `${LEFT + (Math.min(state.time, end) / whole.to) * width}px`;
  }
}

const play = makePlayer(state, whole, [whole.from, whole.to], seek);

function writeHead() {
  const [before, after] = ends;
  const percent = (100 * (after - before)) / before;
  figure($("figures"), "before", `${number(before, 3)} s`);
  figure($("figures"), "after", `${number(after, 3)} s`);
  figure(
    $("figures"),
    "difference",
    `${number(after - before, 3)} s, ${number(percent, 1)} %`.replace(/-/g, "\u2212"),
  );
  const { head, rows } = pair.changes;
  $("changes").hidden = rows.length === 0;
  const table = $("change-table");
  const row = (cells, kind) => {
    const made = element("tr");
    made.append(...cells.map((text) => element(kind, text, "word")));
    return made;
  };
  const [top, body] = [element("thead"), element("tbody")];
  top.append(row(head, "th"));
  body.append(...rows.map((cells) => row(cells, "td")));
  table.append(top, body);
  pieceLegend(
    $("kinds"),
    pair.plans.flatMap(({ pieces }) => pieces),
  );
}

/** Once its page is there: what a user does in it is done in the other one as well. */
function join(frame, others) {
  const inside = frame.contentDocument;
  inside.addEventListener("time", ({ detail }) => {
    if (leads) return;
    play(false);
    seek(detail);
  });
  inside.addEventListener("pause", () => play(false));
  inside.addEventListener("view", ({ detail }) => lead(others, (page) => page.viewFrom?.(detail)));
  // As high as its content.
  const fit = () => {
    frame.style.height = `${Math.ceil(inside.body.getBoundingClientRect().height) + 2}px`;
  };
  new ResizeObserver(fit).observe(inside.body);
  return fit;
}

/** On paper, the plans are one below the other. */
function printed(on, fits) {
  document.documentElement.classList.toggle("printed", on);
  // Not all browsers tell pages in frames.
  const kind = on ? "beforeprint" : "afterprint";
  for (const frame of frames) frame.contentWindow.dispatchEvent(new Event(kind));
  for (const fit of fits) fit();
  draw();
}

writeHead();
const loaded = frames.map((frame, i) => {
  const plan = element("div");
  plan.append(element("h2", NAMES[i]), frame);
  const shown = new Promise((done) => frame.addEventListener("load", done, { once: true }));
  $("plans").append(plan);
  return shown;
});
const draw = () => {
  drawTimelines();
  showNow();
};
window.addEventListener("resize", draw);
window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw);
draw();
Promise.all(loaded).then(() => {
  const fits = frames.map((frame, i) => join(frame, [frames[1 - i]]));
  window.addEventListener("beforeprint", () => printed(true, fits));
  window.addEventListener("afterprint", () => printed(false, fits));
  seek(state.time);
  document.documentElement.dataset.drawnMs = String(Math.round(performance.now()));
});
