// Positions, the plan, and its run on the robot.

const desk = { positions: [], plan: null, run: null };

/** `true` if the last file could not be loaded, until this is reported. */
let loadFailed = false;

/** Unpacks the robots of a plan or a run for drawing. */
const unpackArms = (sketch) =>
  sketch.arms.map((arm) => ({
    ...arm,
    poses: unpackPoses(arm.poses),
    torque: unpackCurve(arm.torque),
  }));

link.takes.plan = (plan) => {
  const isNew = plan && (!desk.plan || desk.plan.id !== plan.id);
  // Errors of the previous plan are obsolete.
  if (isNew) forgetComplaints();
  desk.plan = plan && { ...plan, arms: unpackArms(plan.sketch) };
  writePlan();
  fillScene();
  if (!plan) {
    show("live");
    reportEmptyDesk();
  } else if (isNew) {
    show("simulation");
    play(true);
  }
};

link.takes.run = (run) => {
  const began = run && run.phase === "running";
  desk.run = run && { ...run, arms: run.sketch ? unpackArms(run.sketch) : null };
  watchRun(began);
  writeRun();
  fillScene();
  if (began || (!canReplay() && shown.mode === "replay")) show("live");
  else show(shown.mode);
};

const isRunning = () =>
  Boolean(desk.run) && (desk.run.phase === "running" || desk.run.phase === "to_start");
const canReplay = () => Boolean(desk.run?.arms && desk.run.arms.length > 1);

/** Texts for the clearance to obstacles and the self-clearance. */
function clearanceTexts({ nearest, self_nearest: own }) {
  return [
    ...(nearest ? [`Smallest clearance on the path: ${nearestText(nearest)}.`] : []),
    ...(own ? [`Smallest distance to self-collision: ${nearestText(own)}.`] : []),
  ];
}

function writePlan() {
  const { plan } = desk;
  for (const id of ["plan", "plan-figures", "clear"]) $(id).hidden = !plan;
  $("plan-empty").hidden = Boolean(plan);
  writeSend();
  if (!plan) return;
  $("plan-figures").replaceChildren();
  figure($("plan-figures"), "program", plan.name);
  figure($("plan-figures"), "cycle time", `${number(plan.cycle_time_s, 3)} s`);
  figure($("plan-figures"), "motions", String(plan.motions));
  $("plan-nearest").textContent = setup.scene
    ? clearanceTexts(plan).join(" ")
    : "Obstacles are not checked: the twin was started without a scene (--scene FILE).";
  $("plan-refused").hidden = plan.refused === null;
  $("plan-refused").textContent = plan.refused === null ? "" : `Cannot be sent: ${plan.refused}.`;
  $("plan-warnings").replaceChildren(
    ...plan.warnings.map((text) => element("li", `Warning: ${text}`)),
  );
  writeRun();
}

/** Enables sending and unloading, or writes why neither is possible now. */
function writeSend() {
  const { plan } = desk;
  const running = isRunning() ? "A program is running: wait for its end, or stop the robot." : "";
  const missing = plan ? "" : "First load a program, or create one from saved positions.";
  const refused = plan && plan.refused !== null ? `Cannot be sent: ${plan.refused}.` : "";
  disableFor($("send"), running || missing || refused);
  disableFor($("clear"), running);
  writeText("send-why", running || missing);
}

function writeRun() {
  const { plan, run } = desk;
  writeSend();
  const words = {
    to_start: "Moving to the start",
    running: "Program running",
    done: "Program finished",
    failed: "Program not finished",
  };
  $("run").textContent = run ? words[run.phase] + (run.error ? `: ${run.error}` : ".") : "";
  const notes = [];
  if (run && run.phase === "done" && run.cycle_time_s !== null && plan) {
    const off = plan.cycle_time_s - run.cycle_time_s;
    notes.push(
      `Measured ${number(run.cycle_time_s, 3)} s, planned ${number(plan.cycle_time_s, 3)} s: ` +
        `error ${number(off, 3)} s, ${number((100 * off) / run.cycle_time_s, 2)} %.`,
    );
  }
  if (run?.sketch) {
    const { compared } = run.sketch;
    if (compared)
      notes.push(`Largest flange deviation: ${atLeast(compared.tcp_deviation.max_mm, 2, "mm")}.`);
    notes.push(...run.sketch.notes);
  }
  $("run-notes").textContent = notes.join(" ");
  const files = [
    ["report.html", "Report"],
    ["files/program.json", "Program"],
    ["files/plan.mcap", "Plan"],
  ];
  if (run?.sketch) files.push(["files/measured.mcap", "Run result"]);
  $("files").replaceChildren(
    ...(plan ? files : []).map(([path, name]) => {
      const to = element("a", name);
      to.href = path + location.search;
      if (path === "report.html") [to.target, to.rel] = ["_blank", "noopener"];
      else to.download = "";
      return to;
    }),
  );
}

// ---- confirmation dialogs

/** Asks in a dialog with lines of text; returns true if the answer was yes. */
function confirmed(title, lines, yes, start = null) {
  const dialog = $("confirm");
  $("confirm-title").textContent = title;
  $("confirm-text").replaceChildren(...lines.map((line) => element("p", line)));
  $("confirm-yes").textContent = yes;
  $("confirm-start").hidden = start === null;
  $("confirm-start").querySelector("span").textContent = start || "";
  $("move-to-start").checked = false;
  const allow = () => {
    const why =
      start !== null && !$("move-to-start").checked
        ? "Tick the move to the program's start first."
        : "";
    disableFor($("confirm-yes"), why);
    writeText("confirm-why", why);
  };
  $("move-to-start").onchange = allow;
  allow();
  dialog.returnValue = "";
  dialog.showModal();
  return new Promise((done) => {
    dialog.addEventListener("close", () => done(dialog.returnValue === "yes"), { once: true });
  });
}

async function send() {
  const { plan } = desk;
  const lines = [
    `${plan.name}: ${plan.motions} motion${plan.motions === 1 ? "" : "s"}, ` +
      `${number(plan.cycle_time_s, 3)} s.`,
    ...(setup.scene
      ? clearanceTexts(plan)
      : ["No scene: the program has not been checked for collisions with obstacles."]),
    ...plan.warnings.map((text) => `Warning: ${text}.`),
    "The robot will move. Keep everyone out of its reach, and the emergency stop at hand.",
  ];
  const q = live.newest ? live.newest.joints_rad : plan.start_rad;
  const off = q.map((v, j) => Math.abs(v - plan.start_rad[j]));
  const far = off.indexOf(Math.max(...off));
  const away = off[far] > 1e-3;
  const start = away
    ? `First move to the program's start, at 10 % of the speed: joint ${far + 1} has ` +
      `${number(off[far] * DEG, 1)} degrees to go, the others less`
    : null;
  if (await confirmed("Send the program to the robot?", lines, "Send it", start)) {
    await ask("program-said", "send", { plan: plan.id, move_to_start: away });
  }
}

async function loadFile(file) {
  if (!file) return;
  if (file.size > 4 * 2 ** 20) {
    await ask("program-said", "clear_program");
    $("program-said").textContent =
      `${file.name} is longer than 4 MiB, the most that the twin accepts; iiwasim plan has no ` +
      "such limit. Nothing is loaded.";
    return;
  }
  const isLoaded = await attempt("program-said", async () =>
    handOver(file.name, await file.text()),
  );
  loadFailed = !isLoaded;
  if (!desk.plan) reportEmptyDesk();
}

/**
 * Adds to the error of a file that no program is loaded. The previous plan may be dropped only
 * after the error arrives.
 */
function reportEmptyDesk() {
  if (loadFailed) $("program-said").textContent += "\nNothing is loaded.";
  loadFailed = false;
}

$("file").addEventListener("change", async () => {
  await loadFile($("file").files[0]);
  // Cleared, so that selecting the same file again also causes an event.
  $("file").value = "";
});
document.addEventListener("dragover", (event) => event.preventDefault());
document.addEventListener("drop", (event) => {
  event.preventDefault();
  loadFile(event.dataTransfer.files[0]);
});
$("send").addEventListener("click", send);
$("clear").addEventListener("click", () => ask("program-said", "clear_program"));
