// The page: updates over time, and actions of its buttons.

// ---- the 3D view

/** The drawn TCP paths: the plan by its pieces, and the recording. */
function ways() {
  const all = [wayOf(first, report.pieces, "line", second ? 6 : 3.5, toolAt)];
  if (second) all.push(wayOf(second, [], "measured", 1.8, toolAt, whole.from - 1, whole.to + 1));
  return all;
}

const around = surroundings(report.scene, report.carried);
const bodiesAt = report.arms.map(bodiesOf);
let scene = null;
try {
  scene = makeScene($("scene"));
  scene?.fill({ ways: ways(), corners: report.corners, frames: report.workcell.frames, ...around });
} catch (error) {
  console.warn(error);
}
if (!scene) {
  document
    .querySelector(".view")
    .replaceChildren(
      element(
        "p",
        "The 3D view needs WebGL 2, which this browser does not have. Everything else works.",
        "notes",
      ),
    );
}

function drawScene() {
  if (!scene) return;
  const arms = report.arms.map((arm, i) => ({
    q: jointsAt(arm, state.time),
    tool: toolAt(state.time),
    bodies: bodiesAt[i](state.time),
    ghost: second && i === 0 ? "accent" : null,
  }));
  // The minimum clearance over all times, as in the twin.
  const nearest = report.arms.at(-1).clearance?.nearest;
  scene.show(arms, nearest ? [nearest.on_link_m, nearest.on_other_m] : null);
}

// ---- time

let drawn = false;
/** Draws everything that depends on the time, once per frame. */
function update() {
  if (drawn) return;
  drawn = true;
  requestAnimationFrame(() => {
    drawn = false;
    drawNow();
  });
}

function drawNow() {
  drawScene();
  writeNow();
  placeCursors();
}

function seek(t) {
  state.time = Math.min(Math.max(t, startS), endS);
  tell("time", state.time);
  const { from, to } = state.window;
  if (state.time < from || state.time > to) look(state.time - 0.1 * (to - from), to - from);
  update();
}

/** Shows another time window in all charts. */
function look(from, span) {
  const most = Math.max(endS - startS, 1e-3);
  const wide = Math.min(Math.max(span, 0.02), most);
  const at = Math.min(Math.max(from, startS), endS - wide);
  state.window = { from: at, to: at + wide };
  drawCharts();
  pointAt(null, 0);
}

/** Tells a page that has this one in a frame. */
function tell(kind, detail) {
  document.dispatchEvent(new CustomEvent(kind, { detail }));
}

/** Shows the 3D view from a place of that page. */
function viewFrom(view) {
  scene?.adopt(view);
  update();
}

function zoom(factor) {
  const { from, to } = state.window;
  const middle = state.time >= from && state.time <= to ? state.time : (from + to) / 2;
  const span = (to - from) * factor;
  look(middle - ((middle - from) / (to - from)) * span, span);
}

const player = makePlayer(state, whole, [startS, endS], seek);
function play(on) {
  player(on);
  if (!on) tell("pause");
}

// ---- user input

function listen() {
  state.joints.forEach((_, j) => {
    const label = element("label");
    const box = element("input");
    box.type = "checkbox";
    box.checked = true;
    const swatch = element("i", "", "swatch");
    swatch.style.background = `var(--a${j + 1})`;
    swatch.style.marginRight = "0";
    label.append(box, swatch, `A${j + 1}`);
    box.addEventListener("change", () => {
      state.joints[j] = box.checked;
      drawCharts();
    });
    $("chips").append(label);
  });
  $("units").addEventListener("click", () => {
    state.percent = !state.percent;
    $("units").textContent = state.percent ? "Show degrees" : "Show % of limits";
    $("units").setAttribute("aria-pressed", String(!state.percent));
    drawCharts();
  });
  $("in").addEventListener("click", () => zoom(0.5));
  $("out").addEventListener("click", () => zoom(2));
  $("whole").addEventListener("click", () => look(whole.from, whole.to - whole.from));

  for (const chart of charts) listenToChart(chart);
  tellSliders();

  if (scene) {
    makeTurnable($("scene"), scene, () => {
      tell("view", scene.state()[0]);
      update();
    });
  }

  const draw = () => {
    if (scene) scene.paint(theme().solid);
    drawCharts();
    drawNow();
  };
  window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw);
  let resized = false;
  window.addEventListener("resize", () => {
    if (resized) return;
    resized = true;
    requestAnimationFrame(() => {
      resized = false;
      draw();
    });
  });
  // WebGL canvases are not printed; a copy as an image is.
  const onPaper = (on) => {
    const paper = $("paper");
    if (paper) paper.hidden = true;
    const scene3d = $("scene");
    if (on) document.documentElement.classList.add("printed", "measuring");
    else document.documentElement.classList.remove("printed");
    draw();
    if (on && scene && paper) {
      [paper.width, paper.height] = [scene3d.width, scene3d.height];
      paper.getContext("2d").drawImage(scene3d, 0, 0);
      paper.hidden = false;
    }
    document.documentElement.classList.remove("measuring");
  };
  window.addEventListener("beforeprint", () => onPaper(true));
  window.addEventListener("afterprint", () => onPaper(false));
  return draw;
}

writeHead();
writeNowTable();
writeMotions();
writeGroups();
writeRepeats();
writeCompared();
writeLegends();
const drawAll = listen();
// page.html#t=1.5 opens at 1.5 s.
const asked = Number(new URLSearchParams(location.hash.slice(1)).get("t") || NaN);
if (Number.isFinite(asked)) state.time = Math.min(Math.max(asked, startS), endS);
drawAll();
// Time since navigation.
document.documentElement.dataset.drawnMs = String(Math.round(performance.now()));
