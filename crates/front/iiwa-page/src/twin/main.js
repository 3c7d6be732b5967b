// Display modes: the live robot, the simulation of a plan, or a run compared with its plan.

const shown = { mode: "live", time: 0, playing: false, frame: null };

$("title").textContent = `Twin of ${robot.name}`;
$("footer").textContent = [
  `Follows ${setup.drive}.`,
  setup.folder
    ? `Programs, plans and recordings are kept in ${setup.folder}.`
    : "Programs, plans and recordings are kept until the end of the twin (--output keeps them).",
  `Positions are kept in ${setup.positions}.`,
  "The button that stops the robot is not an emergency stop: it needs this page, the network, the",
  "drive and the robot program.",
].join(" ");

let scene = null;
try {
  scene = makeScene($("scene"));
} catch (error) {
  console.warn(error);
}
if (scene) {
  makeTurnable($("scene"), scene, () => {});
  const paint = () => scene.paint(theme().solid);
  paint();
  window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", paint);
} else {
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

/** The surroundings and the tool of the robot. */
const around = surroundings(setup.scene);

function fillScene() {
  if (!scene) return;
  const { plan } = desk;
  const { workcell, pieces, corners } = plan
    ? plan.sketch
    : { workcell: { tcps: [], frames: [] }, pieces: [], corners: [] };
  const toolAt = toolOf(workcell.tcps, pieces);
  const ways = plan ? [wayOf(plan.arms[0], pieces, "line", 3.5, toolAt)] : [];
  if (canReplay()) ways.push(wayOf(desk.run.arms[1], [], "measured", 1.8, toolAt));
  scene.fill({ ways, corners, frames: workcell.frames, ...around });
}

// ---- playback

/** The robots that are played in a mode. */
function played(mode) {
  if (mode === "simulation" && desk.plan) return desk.plan.arms;
  if (mode === "replay" && canReplay()) return desk.run.arms;
  return [];
}

function show(mode) {
  if (mode !== "live" && !played(mode).length) mode = "live";
  if (mode !== shown.mode) {
    play(false);
    shown.time = 0;
  }
  shown.mode = mode;
  for (const name of ["live", "simulation", "replay"])
    $(name).setAttribute("aria-pressed", String(name === mode));
  const arms = played(mode);
  const why = {
    simulation: desk.plan ? "" : "Simulation needs a loaded program.",
    replay: canReplay()
      ? ""
      : isRunning()
        ? "Replay is available after the run."
        : "Replay needs a recorded run on the robot.",
    play: arms.length ? "" : "Play and the time slider work in Simulation and Replay.",
  };
  for (const name of ["simulation", "replay", "play"]) disableFor($(name), why[name]);
  disableFor($("scrub"), why.play);
  writeText("player-why", Object.values(why).filter(Boolean).join(" "));
  if (arms.length) $("scrub").max = lastS(arms);
  writeMode();
  const parts = [];
  if (mode === "simulation") parts.push(["accent", "see-through arm: the plan"]);
  if (mode === "replay")
    parts.push(["accent", "see-through arm: the plan"], ["measured", "solid arm: the recording"]);
  if (desk.plan) {
    const what = desk.plan.sketch.workcell.tcps.length ? "TCP" : "flange";
    parts.push(["line", `planned ${what} path`], ["blend", "blends"]);
  }
  if (canReplay()) parts.push(["measured", "measured path"]);
  if (around.obstacles.length) parts.push(["soft", "obstacles"]);
  if (around.tool.length) parts.push(["settle", "tool"]);
  legend($("legend"), parts);
}

/** Writes the display mode, and whether the shown position is live. */
function writeMode() {
  const texts = {
    live: "Live",
    simulation: "Live, with the plan's simulation",
    replay: "Replay: not live",
  };
  const isReplay = shown.mode === "replay";
  const isLost = !isReplay && (Boolean(trouble()) || (live.newest !== null && isStale()));
  const isAwaited = !isReplay && !isLost && live.newest === null;
  $("mode").textContent = isLost
    ? live.newest === null
      ? "Not live: arm position unknown"
      : "Not live: last known position"
    : isAwaited
      ? "Waiting for the arm"
      : texts[shown.mode];
  $("mode").classList.toggle("bad", isLost || isReplay);
  $("mode").classList.toggle("waiting", isAwaited);
}

const lastS = (arms) => Math.max(...arms.map((arm) => arm.end_s));

function play(on) {
  shown.playing = on && played(shown.mode).length > 0;
  if (shown.playing && shown.time >= lastS(played(shown.mode)) - 1e-9) shown.time = 0;
  shown.frame = null;
  $("play").textContent = shown.playing ? "Pause" : "Play";
}

function advance(now) {
  if (!shown.playing) return;
  const passed = shown.frame === null ? 0 : (now - shown.frame) / 1000;
  shown.frame = now;
  const end = lastS(played(shown.mode));
  // A page that was hidden continues from its last time.
  shown.time = Math.min(shown.time + Math.min(passed, 1), end);
  if (shown.time >= end) play(false);
}

for (const mode of ["live", "simulation", "replay"]) {
  $(mode).addEventListener("click", () => {
    show(mode);
    if (mode !== "live") play(true);
  });
}
$("play").addEventListener("click", () => play(!shown.playing));
$("scrub").addEventListener("input", () => {
  play(false);
  shown.time = Number($("scrub").value);
});

// ---- every frame

/** Draws the robots; with `now`, the time of a frame in ms, only if something has changed. */
function drawArms(now = null) {
  const arms = played(shown.mode);
  const poses = arms.map((arm) => jointsAt(arm, shown.time));
  const isReplay = shown.mode === "replay";
  const drawn = poses.map((q, i) => ({ q, ghost: isReplay && i === 1 ? null : "accent" }));
  const where = live.newest;
  if (where && !isReplay) drawn.push({ q: where.joints_rad, ghost: isStale() ? "settle" : null });
  const nearest =
    shown.mode === "live" ? where?.nearest : shown.mode === "simulation" ? desk.plan.nearest : null;
  const gap = nearest ? [nearest.on_link_m, nearest.on_other_m] : null;
  if (now === null) scene?.show(drawn, gap);
  else scene?.follow(drawn, gap, now);
  $("clock").textContent = arms.length ? `${number(shown.time, 2)} s` : "\u2013";
  if (arms.length) $("scrub").value = shown.time;
}

/** Adaptive resolution: frames that are late, on a busy machine or without a graphics card, get
    fewer pixels. From time to time, a higher resolution is tried. */
const rate = { sharpness: 1, since: 0, frames: 0, coarse: 0 };
function keepPace(now) {
  const LEAST = 0.35;
  rate.frames += 1;
  const passed = now - rate.since;
  if (passed < 500) return;
  const apart = passed / rate.frames;
  [rate.since, rate.frames] = [now, 0];
  if (apart > 1000 || !scene) return;
  if (apart > 24 && rate.sharpness > LEAST) {
    rate.sharpness = Math.max(rate.sharpness * Math.max(Math.sqrt(20 / apart), 0.6), LEAST);
    rate.coarse = now;
  } else if (rate.sharpness < 1 && now - rate.coarse > 30_000) {
    rate.sharpness = Math.min(rate.sharpness * 1.25, 1);
    rate.coarse = now;
  }
  scene.sharpen(rate.sharpness);
}

let written = 0;
function frame(now) {
  keepPace(now);
  advance(now);
  drawArms(now);
  drawnNow();
  if (now - written > 100) {
    written = now;
    if (live.newest) {
      writeJoints(live.newest.joints_rad);
      writeNearest();
    }
    writeLink();
    writeMode();
    writeHistory();
  }
  requestAnimationFrame(frame);
}

show("live");
fillScene();
connect();
requestAnimationFrame(frame);
