// Tables of current values, motions and errors.

const cells = { joints: [], flange: [], rows: [] };

function writeNowTable() {
  for (let j = 0; j < 7; j++) {
    const row = element("tr");
    const range = element("div", "", "range");
    const mark = element("i");
    range.append(mark);
    const wide = element("td", "", "wide");
    wide.append(range);
    const [position, velocity, torque] = [element("td"), element("td"), element("td")];
    row.append(element("td", `A${j + 1}`), position, velocity, torque, wide);
    $("joints").append(row);
    cells.joints.push({ position, velocity, torque, mark });
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
  cells.joints.forEach(({ position, velocity, torque, mark }, j) => {
    position.textContent = number(q[j] * DEG, 2);
    velocity.textContent = arm.velocity.columns ? number(valueAt(arm.velocity, t, j) * DEG, 1) : "";
    torque.textContent = arm.torque.columns ? number(readingAt(arm.torque, t, j, 7), 1) : "";
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
    line: "on a straight line in joint space",
    lin: "on a TCP line",
    circ: "on a TCP circle",
    spline: "on a TCP spline",
    blend: "blending in",
    settle: "settling",
    wait: "waiting",
  };
  $("piece").textContent = piece
    ? `Motion ${piece.motion}${sourceOf(piece.motion)}, ${words[piece.kind] || piece.kind}${piece.limit ? `; limited by the ${piece.limit.replace("_", " ")}${piece.joint ? ` of A${piece.joint}` : ""}` : ""}`
    : "";
  const near = report.arms.filter((arm) => arm.clearance).at(-1)?.clearance;
  if (near) {
    const mm = 1000 * valueAt(near.distance, t, 0, 1);
    const pair = pairAt(near, t);
    $("pair").textContent =
      `At ${number(t, 3)} s: ${mm > 0 ? `${number(mm, 1)} mm` : "touching"}, ${pairText(pair.link, pair.other)}`;
  }
  for (const { row, motion } of cells.rows)
    row.classList.toggle("current", Boolean(piece) && piece.motion === motion);
}

// ---- the table of motions

let sources = null;

/** The source of a motion in parentheses, if known. */
function sourceOf(motion) {
  sources ??= new Map(
    motionRows().flatMap(({ index, source }) => (source ? [[index, source]] : [])),
  );
  const source = sources.get(motion);
  return source ? ` (${source.file}:${source.line})` : "";
}

/** The name of a joint or TCP limit. */
function limitName(joint, kind) {
  return (joint ? `A${joint} ` : "") + kind.replace("_", " ");
}

/** The motions from the figures; without figures, from the pieces. */
function motionRows() {
  if (Array.isArray(report.figures.motions)) return report.figures.motions;
  const rows = [];
  for (const piece of report.pieces) {
    let row = rows[rows.length - 1];
    if (!row || row.index !== piece.motion) {
      row = {
        index: piece.motion,
        type: piece.kind === "wait" ? "wait" : "ptp",
        start_s: piece.start_s,
        limits: [],
      };
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
  const measured = report.compared
    ? new Map(report.compared.report.motions.map((row) => [row.index, row]))
    : null;
  const head = element("tr");
  const names = ["motion", "type", "start s", "end s", "duration s", "top speed %"];
  const hasTcp = rows.some((row) => row.tcp_speed_peak_mm_s !== undefined);
  if (hasTcp) names.push("TCP mm/s", "nearest singularity");
  const hasTorque = rows.some((row) => row.torque);
  if (hasTorque) names.push("top torque");
  if (measured) names.push("measured s", "error s", "error %");
  const hasSource = rows.some((row) => row.source);
  if (hasSource) names.push("source");
  names.push("limited by");
  for (const name of names)
    head.append(element("th", name, ["type", "source", "limited by"].includes(name) ? "word" : ""));
  const headed = element("thead");
  headed.append(head);
  const body = element("tbody");
  for (const motion of rows.slice(0, SHOWN)) {
    const row = element("tr");
    // On narrow screens, each cell has its own label.
    const add = (text, kind) => {
      const cell = element("td", text, kind);
      cell.dataset.name = names[row.children.length];
      row.append(cell);
    };
    add(motion.index);
    add(motion.type, "word");
    for (const value of [motion.start_s, motion.end_s, motion.end_s - motion.start_s])
      add(number(value, 3));
    add(motion.peak_velocity_rel === undefined ? "" : number(100 * motion.peak_velocity_rel, 1));
    if (hasTcp) {
      const { tcp_speed_peak_mm_s: speed, singularity } = motion;
      add(speed === undefined ? "" : number(speed, 1));
      add(singularity ? `${number(singularity.least, 3)} ${singularity.axis}` : "");
    }
    if (hasTorque) {
      const { joint, percent, nm } = largestTorque([motion]);
      add(motion.torque ? `A${joint} ${number(percent, 0)} %, ${number(nm, 1)} Nm` : "");
    }
    if (measured) {
      const real = measured.get(motion.index) || {};
      const or = (value, decimals) => (typeof value === "number" ? number(value, decimals) : "?");
      add(or(real.real_s, 3));
      add(or(real.error_s, 4));
      add(or(real.error_percent, 2));
    }
    if (hasSource) add(motion.source ? `${motion.source.file}:${motion.source.line}` : "", "word");
    const shares = (motion.limits || [])
      .filter(({ share }) => share >= 0.005)
      .slice(0, 4)
      .map(({ joint, kind, share }) => `${limitName(joint, kind)} ${number(100 * share, 0)} %`);
    if (!shares.length && motion.limited_by)
      shares.push(limitName(motion.limited_by.joint, motion.limited_by.kind));
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
    "A motion lasts from the start of the blend before it to the start of the blend after it, or to its stop; shares are relative to its duration." +
    (hidden ? ` ${hidden} more motions: iiwasim plan --json has them.` : "");
}

function writeCompared() {
  if (!report.compared) return;
  $("compared").hidden = false;
  const {
    cycle_time: cycle,
    tcp_deviation: tcp,
    joint_deviation: joint,
    ...rest
  } = report.compared.report;
  const list = $("errors");
  figure(list, "simulated", `${number(cycle.simulated_s, 3)} s`);
  figure(list, "real", `${number(cycle.real_s, 3)} s`);
  figure(
    list,
    "error of the cycle time",
    `${number(cycle.error_s, 4)} s, ${number(cycle.error_percent, 2)} %`,
  );
  figure(list, `largest flange deviation (motion ${tcp.motion})`, atLeast(tcp.max_mm, 3, "mm"));
  figure(list, "on average", atLeast(tcp.mean_mm, 3, "mm"));
  figure(
    list,
    `largest joint deviation (motion ${joint.motion})`,
    atLeast(1e3 * joint.max_rad, 3, "mrad"),
  );
  const notes = [
    `Each sample is compared with the nearest point of the planned path, regardless of time; recording noise (${rest.noise_rad.toExponential(1)} rad) counts as distance.`,
    ...rest.losses,
  ];
  if (rest.again_s !== null)
    notes.push(
      `The recording contains the program again, from ${number(rest.again_s, 3)} s on; the first run is used.`,
    );
  const sentence = (text) =>
    text[0].toUpperCase() + text.slice(1) + (text.endsWith(".") ? "" : ".");
  $("compared-notes").textContent = notes.map(sentence).join(" ");
}
