// The head of the page, and the legends of robot and curve colours.

/** The peak torque of motions, relative to its limit. */
function largestTorque(motions) {
  const all = motions.flatMap(({ index, torque }) =>
    (torque?.peak_percent || []).map((percent, j) => ({
      motion: index,
      joint: j + 1,
      percent,
      nm: torque.peak_nm[j],
    })),
  );
  return all.reduce(
    (most, next) => (next.percent > most.percent ? next : most),
    all[0] || { percent: Number.NaN },
  );
}

/** Operating mode and override of a plan, where they differ from the default, and its warnings. */
function planStatements({ mode, t1_speed_mm_s: speed, override_percent: override, warnings = [] }) {
  const SHOWN = 20;
  const statements = [];
  if (mode === "t1")
    statements.push(`Operating mode T1: TCP and flange are limited to ${number(speed, 0)} mm/s`);
  else if (mode) statements.push(`Operating mode ${mode}`);
  if (override !== undefined)
    statements.push(
      `Override ${override} %: slows down motions, but neither standstill after stops nor waits`,
    );
  statements.push(...warnings.slice(0, SHOWN).map((text) => `Warning: ${text}`));
  if (warnings.length > SHOWN)
    statements.push(`${warnings.length - SHOWN} more warnings: iiwasim plan --json lists them.`);
  return statements;
}

function writeHead() {
  const { figures } = report;
  const seconds = (value) => `${number(value, 3)} s`;
  const arm = (it) => `${it.samples} samples${it.rate_hz ? `, ${number(it.rate_hz, 0)} Hz` : ""}`;
  const limited =
    figures.timing === "acceleration"
      ? "velocity and acceleration"
      : "velocity, acceleration and jerk";
  const summary = {
    plan: `Plan for ${report.robot.name}, ${limited} limits`,
    part: `Part of a plan for ${report.robot.name}: ${arm(first)}`,
    recording: `Recording of ${report.robot.name}: ${arm(first)}`,
  };
  const beside = second ? `; ${called(second)}: ${arm(second)}` : "";
  $("summary").textContent = summary[first.role] + beside;
  const list = $("figures");
  if (figures.cycle_time_s !== undefined)
    figure(list, "Cycle time", seconds(Number(figures.cycle_time_s)));
  else figure(list, "Duration", seconds(first.end_s - first.start_s));
  if (isPlan && figures.motion_time_s !== undefined) {
    figure(list, "in motion", seconds(figures.motion_time_s));
    figure(list, "settling", seconds(figures.settle_time_s));
    figure(list, "waiting", seconds(figures.wait_time_s));
  }
  if (report.figures.energy_j) {
    const { energy_j: energy, power } = report.figures;
    const { joint, percent, motion } = largestTorque(report.figures.motions);
    const sum = (work) => number(Math.abs(work.reduce((a, b) => a + b, 0)), 0);
    figure(list, `largest torque: A${joint} in motion ${motion}`, `${number(percent, 0)} %`);
    figure(
      list,
      "work delivered, absorbed",
      `${sum(energy.positive)} J, ${sum(energy.negative)} J`,
    );
    figure(list, `peak power, at ${number(power.at_s, 3)} s`, `${number(power.peak_w, 0)} W`);
  }
  const cycle = report.compared?.report.cycle_time;
  if (cycle) {
    figure(list, "measured", seconds(cycle.real_s));
    figure(list, "off by", `${number(cycle.error_s, 4)} s, ${number(cycle.error_percent, 2)} %`);
  }
  for (const it of report.arms) {
    const of = second ? `, ${called(it)}` : "";
    for (const [title, clearance] of [
      ["clearance", it.clearance],
      ["from itself", it.self_clearance],
    ]) {
      if (!clearance) continue;
      const { nearest } = clearance;
      const pair = `${pairText(nearest.link, nearest.other)} at ${number(nearest.at_s, 3)} s`;
      figure(
        list,
        `${title}${of}: ${pair}`,
        nearest.distance_mm ? `${number(nearest.distance_mm, 1)} mm` : "touching",
      );
    }
  }
  for (const note of [...planStatements(figures), ...report.notes])
    $("notes").append(element("li", note));
  const assumedInputs = (figures.rests_on || []).filter(({ what }) => what.startsWith("wait_for:"));
  for (const { what, first: motion } of assumedInputs.slice(0, 10))
    $("notes").append(element("li", `Assumed, from motion ${motion}: ${what}`));
  if (assumedInputs.length > 10)
    $("notes").append(
      element("li", `${assumedInputs.length - 10} more: iiwasim plan --assumptions lists them.`),
    );
  const methods = report.arms.map((it) => {
    const columns = Math.max(it.position.samples_a_column, it.velocity.samples_a_column);
    const thinned =
      columns > 1
        ? `; thinned out: each column spans from the lowest to the highest of ${columns} samples`
        : "";
    return `${it.file}: ${it.method}${thinned}.`;
  });
  if (second) methods.unshift(`Broad and pale: ${first.file}; thin: ${second.file}.`);
  $("method").textContent = methods.join(" ");
  const assumed = report.robot.assumptions.filter((text) => !text.startsWith("masses"));
  $("footer").textContent =
    `${report.robot.name}. Made by iiwasim report.` +
    (assumed.length ? ` Assumed, not from a source: ${assumed.join("; ")}.` : "");
}

function writeLegends() {
  const { tcps, frames } = report.workcell;
  const parts = [["line", `${tcps.length ? "TCP" : "flange"} path`]];
  const has = (kind) => report.pieces.some((piece) => piece.kind === kind);
  if (has("line")) parts[0][1] = "PTP";
  else if (has("lin") || has("circ") || has("spline")) parts.pop();
  if (has("lin")) parts.push(["lin", "LIN"]);
  if (has("circ")) parts.push(["circ", "CIRC"]);
  if (has("spline")) parts.push(["spline", "splines (SPL)"]);
  if (report.pieces.some((piece) => piece.kind === "blend")) {
    const marks = ["from start to end"];
    if (report.corners.length) marks.push("dots: their targets");
    if (report.corners.some((corner) => corner.radius_m)) marks.push("spheres: their radii");
    parts.push(["blend", `blends, ${marks.join("; ")}`]);
  }
  if (tcps.length) parts.push(["ink", "tool, from the flange to its TCP"]);
  if (frames.length) parts.push(["soft", "crosses of axes: frames; x red, y green, z blue"]);
  if (around.obstacles.length)
    parts.push(["soft", "obstacles"], ["blend", "thick line: smallest distance"]);
  if (around.tool.length || around.bodies.length)
    parts.push(["settle", "shapes of tool and workpiece"]);
  if (second)
    parts.push(
      ["accent", `see-through arm: ${called(first)}`],
      ["measured", `solid arm and thin line: ${called(second)}`],
    );
  if (scene) legend($("legend"), parts);
  pieceLegend($("kinds"), report.pieces);
  document.querySelector(".track").hidden = report.pieces.length === 0;
  const bands = [["beyond", "beyond the robot's limits"]];
  if (Object.keys(report.shares).length)
    bands.push(["own", "beyond the motion's own limits, if narrower"]);
  legend($("bands"), bands);
  $("torques").hidden = report.arms.every((arm) => !arm.torque.columns);
}
