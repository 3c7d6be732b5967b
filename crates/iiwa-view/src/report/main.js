// The page: what is shown when, and what its buttons do.

const [first, second] = report.arms;
const isPlan = first.role === "plan";
/** What an arm is called where both are shown. */
const called = (arm) => (arm.role === "recording" ? "measured" : arm === second ? "other plan" : "plan");
/** At first the page shows the plan, or everything there is. */
const whole = isPlan
  ? { from: first.start_s, to: Math.max(first.end_s, first.start_s + 1e-3) }
  : { from: startS, to: endS };
const state = {
  time: whole.from,
  playing: false,
  speed: 1,
  window: { ...whole },
  joints: Array(7).fill(true),
  percent: true,
};

// ---- the head of the page

function writeHead() {
  const { figures } = report;
  const seconds = (value) => `${number(value, 3)} s`;
  const arm = (it) => `${it.samples} samples${it.rate_hz ? `, ${number(it.rate_hz, 0)} Hz` : ""}`;
  const summary = {
    plan: `Plan for ${report.robot.name}, limits of velocity${figures.timing === "acceleration" ? " and acceleration" : ", acceleration and jerk"}`,
    part: `Part of a plan for ${report.robot.name}: ${arm(first)}`,
    recording: `Recording of ${report.robot.name}: ${arm(first)}`,
  };
  const beside = second ? `; ${called(second)}: ${arm(second)}` : "";
  $("summary").textContent = summary[first.role] + beside;
  const list = $("figures");
  if (figures.cycle_time_s !== undefined) figure(list, "Cycle time", seconds(Number(figures.cycle_time_s)));
  else figure(list, "Duration", seconds(first.end_s - first.start_s));
  if (isPlan && figures.motion_time_s !== undefined) {
    figure(list, "in motion", seconds(figures.motion_time_s));
    figure(list, "settling", seconds(figures.settle_time_s));
    figure(list, "waiting", seconds(figures.wait_time_s));
  }
  const cycle = report.compared?.report.cycle_time;
  if (cycle) {
    figure(list, "measured", seconds(cycle.real_s));
    figure(list, "off by", `${number(cycle.error_s, 4)} s, ${number(cycle.error_percent, 2)} %`);
  }
  for (const it of report.arms.filter((arm) => arm.clearance)) {
    const { nearest } = it.clearance;
    const of = second ? `, ${called(it)}` : "";
    const pair = `${pairText(nearest.link, nearest.obstacle)} at ${number(nearest.at_s, 3)} s`;
    figure(list, `clearance${of}: ${pair}`, nearest.distance_mm ? `${number(nearest.distance_mm, 1)} mm` : "touching");
  }
  for (const note of report.notes) $("notes").append(element("li", note));
  const methods = report.arms.map((it) => {
    const columns = Math.max(it.position.samples_a_column, it.velocity.samples_a_column);
    const thinned =
      columns > 1 ? `; thinned out: each column spans from the lowest to the highest of ${columns} samples` : "";
    return `${it.file}: ${it.method}${thinned}.`;
  });
  if (second) methods.unshift(`Broad and pale: ${first.file}; thin: ${second.file}.`);
  $("method").textContent = methods.join(" ");
  const assumed = report.robot.assumptions.filter((text) => !text.startsWith("masses"));
  $("footer").textContent =
    `${report.robot.name}. Made by iiwasim report.` +
    (assumed.length ? ` Assumed, not from a source: ${assumed.join("; ")}.` : "");
}

// ---- the 3D view

/** What is drawn of the ways: the plan's by its pieces, the recording's beside it. */
function ways() {
  const all = [wayOf(first, report.pieces, "line", second ? 6 : 3.5, toolAt)];
  if (second) all.push(wayOf(second, [], "measured", 1.8, toolAt, whole.from - 1, whole.to + 1));
  return all;
}

const around = surroundings(report.scene);
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
      element("p", "The 3D view needs WebGL 2, which this browser does not have. Everything else works.", "notes"),
    );
}

function drawScene() {
  if (!scene) return;
  const arms = report.arms.map((arm, i) => ({
    q: jointsAt(arm, state.time),
    tool: toolAt(state.time),
    ghost: second && i === 0 ? "accent" : null,
  }));
  // As the twin shows a plan: where the arm comes nearest, whenever that is.
  const nearest = report.arms.at(-1).clearance?.nearest;
  scene.show(arms, nearest ? [nearest.on_arm_m, nearest.on_obstacle_m] : null);
}

function writeLegends() {
  const { tcps, frames } = report.workcell;
  const parts = [["line", `way of the ${tcps.length ? "TCP" : "flange"}`]];
  const has = (kind) => report.pieces.some((piece) => piece.kind === kind);
  if (has("line")) parts[0][1] = "lines";
  else if (has("lin") || has("circ") || has("spline")) parts.pop();
  if (has("lin")) parts.push(["lin", "lines of the TCP"]);
  if (has("circ")) parts.push(["circ", "circles of the TCP"]);
  if (has("spline")) parts.push(["spline", "splines of the TCP"]);
  if (report.pieces.some((piece) => piece.kind === "blend")) {
    const marks = ["from where they begin to where they end"];
    if (report.corners.length) marks.push("dots: their targets");
    if (report.corners.some((corner) => corner.radius_m)) marks.push("spheres: their radii");
    parts.push(["blend", `blends, ${marks.join("; ")}`]);
  }
  if (tcps.length) parts.push(["ink", "tool, from the flange to its TCP"]);
  if (frames.length) parts.push(["soft", "crosses of axes: frames; x red, y green, z blue"]);
  if (around.obstacles.length)
    parts.push(["soft", "what stands around"], ["blend", "thick line: where the arm comes nearest to it"]);
  if (around.tool.length) parts.push(["settle", "shapes of the tool"]);
  if (second)
    parts.push(
      ["accent", `see-through arm: ${called(first)}`],
      ["measured", `solid arm and thin line: ${called(second)}`],
    );
  if (scene) legend($("legend"), parts);
  const kinds = [
    ["line", "line"],
    ["lin", "line of the TCP"],
    ["circ", "circle of the TCP"],
    ["spline", "segment of a spline"],
    ["blend", "blend"],
    ["settle", "settling"],
    ["wait", "waiting"],
  ];
  const there = new Set(report.pieces.map((piece) => piece.kind));
  legend(
    $("kinds"),
    kinds.filter(([kind]) => there.has(kind)),
  );
  document.querySelector(".track").hidden = report.pieces.length === 0;
  const bands = [["beyond", "beyond the robot's limits"]];
  if (Object.keys(report.shares).length) bands.push(["own", "beyond the motion's own limits, if narrower"]);
  legend($("bands"), bands);
}

// ---- curves

/** A canvas with the line that shows the time, in a place. */
function chart(parent, title, height) {
  if (title) parent.append(title);
  const box = element("div", "", "chart");
  const canvas = element("canvas");
  if (height) canvas.style.height = `${height}px`;
  box.append(canvas, element("i", "", "cursor"));
  parent.append(box);
  return canvas;
}

const charts = QUANTITIES.filter(({ key }) => report.arms.some((arm) => arm[key].columns > 0)).map(
  (quantity, i, all) => {
    const title = element("h3");
    const last = i + 1 === all.length && !report.workcell.speed;
    const canvas = chart($("charts"), title, last ? 166 : 0);
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", `${quantity.title} of the joints over time`);
    const draw = (colours) => {
      const largest = drawQuantity(canvas, quantity, state, colours, last);
      const beyond =
        state.percent && largest > MOST_PERCENT ? `, up to ${number(largest, 0)}, drawn up to ${MOST_PERCENT}` : "";
      title.textContent = `${quantity.title}, ${state.percent ? "% of the limit" : quantity.unit}${beyond}`;
    };
    return { canvas, draw };
  },
);
if (report.workcell.speed) {
  const title = element("h3", "Speed of the TCP, mm/s");
  const canvas = chart($("charts"), title, 146);
  canvas.setAttribute("role", "img");
  canvas.setAttribute("aria-label", "Speed of the TCP over time");
  const curve = { ...report.workcell.speed, colour: "lin", factor: 1000 };
  charts.push({ canvas, draw: (colours) => drawCurves(canvas, [curve], state, colours, true) });
}
charts.push({ canvas: $("timeline"), draw: (colours) => drawTimeline($("timeline"), state, colours) });
if (report.compared) {
  for (const [values, title, last] of [
    ["tcp_mm", "Flange off its path, mm", false],
    ["joints_mrad", "Joints off their path, mrad", true],
  ]) {
    const canvas = chart($("deviations"), element("h3", title), last ? 126 : 110);
    const { plan_s: t_s, [values]: all } = report.compared;
    const curve = { t_s, low: all, high: all, colour: "measured" };
    charts.push({ canvas, draw: (colours) => drawCurves(canvas, [curve], state, colours, last) });
  }
}
/** The arms with obstacles around them; what is told of pairs is of the last of them. */
const near = report.arms.filter((arm) => arm.clearance);
if (near.length) {
  $("clearance").hidden = false;
  const { obstacles } = report.scene;
  for (const { clearance } of near) {
    for (const pair of clearance.pairs) pair.text = pairText(pair.link, obstacles[pair.obstacle].name);
  }
  const canvas = chart($("clearances"), element("h3", "Smallest distance of the arm, mm"), 146);
  canvas.setAttribute("role", "img");
  canvas.setAttribute("aria-label", "Clearance of the arm over time");
  const curves = near.map(({ role, clearance }) => ({
    ...clearance.distance,
    colour: role === "recording" ? "measured" : "accent",
    factor: 1000,
  }));
  const { pairs } = near.at(-1).clearance;
  charts.push({ canvas, draw: (colours) => drawClearance(canvas, curves, pairs, state, colours) });
}

function drawCharts() {
  const colours = theme().flat;
  for (const it of charts) it.draw(colours);
  placeCursors();
}

function placeCursors() {
  const share = (state.time - state.window.from) / (state.window.to - state.window.from);
  for (const cursor of document.querySelectorAll(".cursor")) {
    cursor.hidden = share < 0 || share > 1;
    cursor.style.left = `calc(${LEFT}px + ${share} * (100% - ${LEFT + RIGHT}px))`;
  }
}

// ---- what there is now

const cells = { joints: [], flange: [], rows: [] };

function writeNowTable() {
  for (let j = 0; j < 7; j++) {
    const row = element("tr");
    const range = element("div", "", "range");
    const mark = element("i");
    range.append(mark);
    const wide = element("td", "", "wide");
    wide.append(range);
    const [position, velocity] = [element("td"), element("td")];
    row.append(element("td", `A${j + 1}`), position, velocity, wide);
    $("joints").append(row);
    cells.joints.push({ position, velocity, mark });
  }
  for (const arm of report.arms) {
    const row = element("tr");
    const places = [element("td"), element("td"), element("td")];
    row.append(element("td", called(arm)), ...places);
    $("flange").append(row);
    cells.flange.push(places);
  }
}

function writeNow() {
  const t = state.time;
  $("clock").textContent = `${number(t, 3)} s`;
  $("scrub").value = t;
  $("scrub").setAttribute("aria-valuetext", `${number(t, 3)} s`);
  const arm = second || first;
  const q = jointsAt(arm, t);
  cells.joints.forEach(({ position, velocity, mark }, j) => {
    position.textContent = number(q[j] * DEG, 2);
    velocity.textContent = arm.velocity.columns ? number(valueAt(arm.velocity, t, j) * DEG, 1) : "";
    const { lower_rad: lower, upper_rad: upper } = report.robot;
    mark.style.left = `${(100 * (q[j] - lower[j])) / (upper[j] - lower[j])}%`;
  });
  report.arms.forEach((it, i) => {
    flangeAt(jointsAt(it, t)).forEach((v, k) => {
      cells.flange[i][k].textContent = number(1000 * v, 1);
    });
  });
  const piece = report.pieces.length ? pieceAt(t) : null;
  const words = {
    line: "on its line",
    lin: "on the line of its TCP",
    circ: "on the circle of its TCP",
    spline: "on a spline of its TCP",
    blend: "blending in",
    settle: "settling",
    wait: "waiting",
  };
  $("piece").textContent = piece
    ? `Motion ${piece.motion}, ${words[piece.kind] || piece.kind}${piece.limit ? `; limited by the ${piece.limit.replace("_", " ")}${piece.joint ? ` of A${piece.joint}` : ""}` : ""}`
    : "";
  if (near.length) {
    const { distance, pairs } = near.at(-1).clearance;
    const starts = pairs.map((pair) => pair.from_s);
    const mm = 1000 * valueAt(distance, t, 0, 1);
    const pair = pairs[Math.max(countUpTo(starts, t) - 1, 0)];
    $("pair").textContent = `At ${number(t, 3)} s: ${mm > 0 ? `${number(mm, 1)} mm` : "touching"}, ${pair.text}`;
  }
  for (const { row, motion } of cells.rows) row.classList.toggle("current", Boolean(piece) && piece.motion === motion);
}

// ---- the table of motions

/** A limit of a joint, or of the TCP. */
function limitName(joint, kind) {
  return (joint ? `A${joint} ` : "") + kind.replace("_", " ");
}

/** The motions, as the figures have them; else as the pieces tell. */
function motionRows() {
  if (Array.isArray(report.figures.motions)) return report.figures.motions;
  const rows = [];
  for (const piece of report.pieces) {
    let row = rows[rows.length - 1];
    if (!row || row.index !== piece.motion) {
      row = { index: piece.motion, type: piece.kind === "wait" ? "wait" : "ptp", start_s: piece.start_s, limits: [] };
      row.limited_by = piece.limit ? { joint: piece.joint, kind: piece.limit } : null;
      rows.push(row);
    }
    if (piece.kind !== "settle") row.end_s = piece.end_s;
  }
  return rows;
}

function writeMotions() {
  const SHOWN = 300;
  const rows = motionRows();
  if (!rows.length) return;
  $("motions").hidden = false;
  const measured = report.compared ? new Map(report.compared.report.motions.map((row) => [row.index, row])) : null;
  const head = element("tr");
  const names = ["motion", "type", "start s", "end s", "duration s", "top speed %"];
  const hasTcp = rows.some((row) => row.tcp_speed_peak_mm_s !== undefined);
  if (hasTcp) names.push("TCP mm/s", "nearest singularity");
  if (measured) names.push("real s", "error s", "error %");
  names.push("limited by");
  for (const name of names) head.append(element("th", name, name === "type" || name === "limited by" ? "word" : ""));
  const headed = element("thead");
  headed.append(head);
  const body = element("tbody");
  for (const motion of rows.slice(0, SHOWN)) {
    const row = element("tr");
    // On a phone, each cell says itself what it is.
    const add = (text, kind) => {
      const cell = element("td", text, kind);
      cell.dataset.name = names[row.children.length];
      row.append(cell);
    };
    add(motion.index);
    add(motion.type, "word");
    for (const value of [motion.start_s, motion.end_s, motion.end_s - motion.start_s]) add(number(value, 3));
    add(motion.peak_velocity_rel === undefined ? "" : number(100 * motion.peak_velocity_rel, 1));
    if (hasTcp) {
      const { tcp_speed_peak_mm_s: speed, singularity } = motion;
      add(speed === undefined ? "" : number(speed, 1));
      add(singularity ? `${number(singularity.least, 3)} ${singularity.axis}` : "");
    }
    if (measured) {
      const real = measured.get(motion.index) || {};
      const or = (value, decimals) => (typeof value === "number" ? number(value, decimals) : "?");
      add(or(real.real_s, 3));
      add(or(real.error_s, 4));
      add(or(real.error_percent, 2));
    }
    const shares = (motion.limits || [])
      .filter(({ share }) => share >= 0.005)
      .slice(0, 4)
      .map(({ joint, kind, share }) => `${limitName(joint, kind)} ${number(100 * share, 0)} %`);
    if (!shares.length && motion.limited_by) shares.push(limitName(motion.limited_by.joint, motion.limited_by.kind));
    add(shares.join(", "), "word");
    row.addEventListener("click", () => {
      seek(motion.start_s);
    });
    body.append(row);
    cells.rows.push({ row, motion: motion.index });
  }
  $("table").append(headed, body);
  const hidden = rows.length - Math.min(rows.length, SHOWN);
  $("more").textContent =
    "A motion lasts from the start of the blend that leads into it to the start of the blend that leads out of it, or to its stop; the shares are of its time." +
    (hidden ? ` ${hidden} more motions: iiwasim plan --json has them.` : "");
}

function writeCompared() {
  if (!report.compared) return;
  $("compared").hidden = false;
  const { cycle_time: cycle, tcp_deviation: tcp, joint_deviation: joint, ...rest } = report.compared.report;
  const list = $("errors");
  figure(list, "simulated", `${number(cycle.simulated_s, 3)} s`);
  figure(list, "real", `${number(cycle.real_s, 3)} s`);
  figure(list, "error of the cycle time", `${number(cycle.error_s, 4)} s, ${number(cycle.error_percent, 2)} %`);
  figure(list, `flange off its path, at most (motion ${tcp.motion})`, `${number(tcp.max_mm, 3)} mm`);
  figure(list, "on average", `${number(tcp.mean_mm, 3)} mm`);
  figure(list, `joints, at most (motion ${joint.motion})`, `${number(1e3 * joint.max_rad, 3)} mrad`);
  const notes = [
    `Each sample is held against the nearest place of the planned path, whenever the arm is there; noise of the recording (${rest.noise_rad.toExponential(1)} rad) counts as distance.`,
    ...rest.losses,
  ];
  if (rest.again_s !== null)
    notes.push(
      `The program is in the recording again, from ${number(rest.again_s, 3)} s of it on: the first time counts.`,
    );
  const sentence = (text) => text[0].toUpperCase() + text.slice(1) + (text.endsWith(".") ? "" : ".");
  $("compared-notes").textContent = notes.map(sentence).join(" ");
}

// ---- time

let drawn = false;
/** Draws what depends on the time, once a frame. */
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
  const { from, to } = state.window;
  if (state.time < from || state.time > to) look(state.time - 0.1 * (to - from), to - from);
  update();
}

/** Shows another window of time on all curves. */
function look(from, span) {
  const most = Math.max(endS - startS, 1e-3);
  const wide = Math.min(Math.max(span, 0.02), most);
  const at = Math.min(Math.max(from, startS), endS - wide);
  state.window = { from: at, to: at + wide };
  drawCharts();
}

function zoom(factor) {
  const { from, to } = state.window;
  const middle = state.time >= from && state.time <= to ? state.time : (from + to) / 2;
  const span = (to - from) * factor;
  look(middle - ((middle - from) / (to - from)) * span, span);
}

let frame = null;
function play(on) {
  state.playing = on;
  $("play").textContent = on ? "Pause" : "Play";
  $("play").setAttribute("aria-label", on ? "Pause" : "Play");
  frame = null;
  if (!on) return;
  if (state.time >= whole.to - 1e-9) seek(whole.from);
  requestAnimationFrame(tick);
}

function tick(now) {
  if (!state.playing) return;
  const passed = frame === null ? 0 : (now - frame) / 1000;
  frame = now;
  // A page that was out of sight goes on from where it was.
  const next = state.time + Math.min(passed, 1) * state.speed;
  const end = state.time > whole.to ? endS : whole.to;
  seek(Math.min(next, end));
  if (next >= end) play(false);
  else requestAnimationFrame(tick);
}

// ---- what people do

function listen() {
  const scrub = $("scrub");
  [scrub.min, scrub.max] = [startS, endS];
  scrub.addEventListener("input", () => {
    play(false);
    seek(Number(scrub.value));
  });
  $("play").addEventListener("click", () => play(!state.playing));
  const speeds = [0.1, 0.25, 0.5, 1, 2, 5, 10];
  if (whole.to - whole.from > 120) speeds.push(60);
  for (const speed of speeds) {
    const option = element("option", `${speed}\u00d7`);
    option.value = speed;
    option.selected = speed === 1;
    $("speed").append(option);
  }
  $("speed").addEventListener("change", () => {
    state.speed = Number($("speed").value);
  });

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

  // A pointer on a curve or on the timeline takes the time along.
  for (const { canvas } of charts) {
    const to = (event) => {
      const box = canvas.getBoundingClientRect();
      const share = (event.clientX - box.left - LEFT) / (box.width - LEFT - RIGHT);
      const { from, to: end } = state.window;
      play(false);
      seek(from + Math.min(Math.max(share, 0), 1) * (end - from));
    };
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      to(event);
    });
    canvas.addEventListener("pointermove", (event) => {
      if (event.buttons) to(event);
    });
  }

  if (scene) {
    makeTurnable($("scene"), scene, update);
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
  // Printers take no WebGL, but a copy of its picture.
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
writeCompared();
writeLegends();
const drawAll = listen();
// page.html#t=1.5 opens at 1.5 s.
const asked = Number(new URLSearchParams(location.hash.slice(1)).get("t") || NaN);
if (Number.isFinite(asked)) state.time = Math.min(Math.max(asked, startS), endS);
drawAll();
// Since the page was asked for.
document.documentElement.dataset.drawnMs = String(Math.round(performance.now()));
