// Live position and state of the robot.

const live = { newest: null, fresh: false, health: {}, drawn: [], apart_ms: 0 };

/** Maximum age of a live position, in ms. */
const STALE_MS = 1000;

/** Time by the clock of the twin, in ms since 1970, with fractions. */
const clockMs = () => performance.timeOrigin + performance.now() - live.apart_ms;

/** Updates the clock offset. The twin may run on another machine, and the clock of the page stops
    while a laptop sleeps. As a message cannot arrive before it was sent, the fastest message gives
    the offset. */
function compareClocks(at_ms) {
  const SAME_MS = 200;
  const apart = clockMs() + live.apart_ms - at_ms;
  if (live.newest === null || apart < live.apart_ms)
    live.apart_ms = apart < 0 || apart > SAME_MS ? apart : 0;
}

link.takes.live = (where) => {
  if (!where?.joints_rad) return;
  compareClocks(where.at_ms);
  live.newest = where;
  live.fresh = true;
  remember(where);
};
link.takes.health = (health) => {
  live.health = health || {};
  writeHealth();
};

const isStale = () => !live.newest || clockMs() - live.newest.at_ms > STALE_MS;

/** Records that the latest message is on the screen, and its age at that time. */
function drawnNow() {
  if (!live.fresh) return;
  live.fresh = false;
  const now = clockMs();
  live.drawn.push({ now, late: now - live.newest.at_ms + live.newest.behind_ms });
}

/** Number of frames in the last second, and the maximum age of their positions when drawn. */
function pace() {
  const now = clockMs();
  live.drawn = live.drawn.filter((it) => now - it.now < 1000);
  return { frames: live.drawn.length, late: Math.max(0, ...live.drawn.map((it) => it.late)) };
}

// ---- text output

const jointCells = Array.from({ length: 7 }, (_, j) => {
  const row = element("tr");
  const [position, temperature, torque] = [element("td"), element("td"), element("td")];
  const range = element("div", "", "range");
  const mark = element("i");
  range.append(mark);
  const wide = element("td", "", "wide");
  wide.append(range);
  const jog = element("td", "", "jog");
  for (const sign of [-1, 1]) {
    const button = element("button", sign < 0 ? "\u2212" : "+");
    button.type = "button";
    const label = `Jog A${j + 1} in ${sign < 0 ? "negative" : "positive"} direction`;
    button.setAttribute("aria-label", label);
    button.setAttribute("aria-describedby", "jog-why");
    button.addEventListener("click", () => jogJoint(j + 1, sign));
    jog.append(button);
  }
  row.append(element("td", `A${j + 1}`), position, temperature, torque, wide, jog);
  $("joints").append(row);
  return { position, temperature, torque, mark };
});

/** Moves a joint of the simulated robot by the jog increment of the page. */
function jogJoint(joint, sign) {
  const step = $("jog-step");
  if (step.reportValidity()) ask("jog-said", "jog", { joint, step_deg: sign * Number(step.value) });
}

function writeJoints(q) {
  jointCells.forEach(({ position, mark }, j) => {
    position.textContent = number(q[j] * DEG, 2);
    const { lower_rad: lower, upper_rad: upper } = robot;
    mark.style.left = `${(100 * (q[j] - lower[j])) / (upper[j] - lower[j])}%`;
  });
  flangeAt(q).forEach((v, k) => {
    $("flange").children[k + 1].textContent = number(1000 * v, 1);
  });
}

function writeNearest() {
  for (const [id, title, nearest, least] of [
    ["nearest", "Nearest obstacle", live.newest?.nearest, setup.min_clearance_mm],
    ["self-nearest", "Distance to self-collision", live.newest?.self_nearest, 0],
  ]) {
    $(id).hidden = !nearest;
    if (!nearest) continue;
    $(id).textContent = `${title}: ${nearestText(nearest)}`;
    $(id).classList.toggle("near", nearest.distance_mm === 0 || nearest.distance_mm < least);
  }
}

$("no-scene").hidden = setup.scene !== null;

function writeHealth() {
  const { status, caution, sensors, io } = live.health;
  $("state").replaceChildren();
  const known = (value) =>
    value === undefined || value === null ? "\u2013" : String(value).replaceAll("_", " ");
  const fri = status ? status.fri : {};
  const stopped = fri.safety_stop || status?.conditions?.safety_stop;
  figure(
    $("state"),
    "robot",
    stopped ? `${known(status.state)}, safety stop` : known(status?.state),
  );
  figure($("state"), "FRI session", known(fri.session));
  figure($("state"), "FRI quality", known(fri.quality));
  figure($("state"), "messages lost, late", status ? `${fri.lost}, ${fri.late}` : "\u2013");
  figure($("state"), "robot program", known(status?.robot_program));
  if (caution) figure($("state"), "note", caution);
  jointCells.forEach(({ temperature, torque }, j) => {
    temperature.textContent = sensors?.joint_temperature_c
      ? number(sensors.joint_temperature_c[j], 1)
      : "";
    torque.textContent = sensors ? number(sensors.external_torque_nm[j], 1) : "";
  });
  document.body.classList.toggle("simulated", Boolean(status?.simulated));
  const isIdle = status?.state === "idle";
  const why = isIdle
    ? ""
    : `Jogging needs a robot at rest with an open session; its state is "${known(status?.state)}".`;
  for (const button of document.querySelectorAll("td.jog button"))
    disableFor(button, why, button.getAttribute("aria-label"));
  writeText(
    "jog-why",
    why || "Each press jogs one joint of the simulated robot. Jog a real robot with the smartPAD.",
  );
  writeIo(io || []);
  for (const part of ["io", "joints"]) $(part).classList.toggle("old", Boolean(live.health.is_old));
  // Hidden, but not removed, so that nothing shifts under the mouse when a motion begins or ends.
  $("io-old").style.visibility = live.health.is_old ? "visible" : "hidden";
}

/** Updates the inputs and outputs. Rows are kept while the names are unchanged, so that a button
    does not vanish under a finger. */
function writeIo(io) {
  const body = $("io");
  const names = io.map(({ name }) => name).join("\n");
  $("io-empty").hidden = io.length > 0;
  if (body.dataset.names !== names) {
    body.dataset.names = names;
    body.replaceChildren(
      ...io.map(({ name }) => {
        const row = element("tr");
        row.append(element("td", name, "word"), element("td"), element("td"));
        const button = element("button", "Switch");
        button.type = "button";
        button.addEventListener("click", () => switchIo(name));
        row.lastChild.append(button);
        return row;
      }),
    );
  }
  io.forEach(({ direction, value, error }, i) => {
    const row = body.children[i];
    row.children[1].textContent =
      error || (value === true ? "on" : value === false ? "off" : String(value));
    row.querySelector("button").hidden = typeof value !== "boolean" || direction === "input";
  });
}

async function switchIo(name) {
  const io = live.health.io.find((it) => it.name === name);
  if (!io || typeof io.value !== "boolean") return;
  const sure = await confirmed(
    `Switch ${name} ${io.value ? "off" : "on"}?`,
    io.direction ? [] : ["The robot accepts this for outputs only."],
    "Switch it",
  );
  if (sure) await ask("io-said", "set_io", { name, value: !io.value });
}

/** The error of the connection, if any. */
function trouble() {
  if (!link.open)
    return (
      "The twin cannot be reached; retrying. If it was restarted, open the address that it has " +
      "printed."
    );
  if (live.health.error) return `Retrying: ${live.health.error}`;
  if (live.health.status && live.health.status.fri.session === "silent")
    return "The drive receives no data from the controller; retrying.";
  if (isStale() && live.health.status) return "No data from the drive stream; retrying.";
  return "";
}

function writeLink() {
  const wrong = trouble();
  const { frames, late } = pace();
  $("banner").hidden = !wrong;
  if ($("banner").textContent !== wrong) $("banner").textContent = wrong;
  $("link").textContent = wrong ? "not live" : isStale() ? "connecting" : "live";
  $("link").classList.toggle("bad", Boolean(wrong));
  $("link").classList.toggle("waiting", !wrong && isStale());
  $("pace").textContent =
    wrong || !frames ? "" : `${frames} frames/s, ${number(late, 0)} ms late at most`;
}
