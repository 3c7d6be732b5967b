// Tables of current values, motions and errors.

const cells = { joints: [], poses: [], rows: [] };

/** Types of motions, as KUKA names them. */
const TYPE_NAMES = {
  ptp: "PTP",
  lin: "LIN",
  lin_rel: "LIN_REL",
  circ: "CIRC",
  spl: "SPL",
  spline: "Spline",
};

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
  writePoseTable();
}

/** Adds the table of the current poses: flange and, with a tool, TCP of each robot. */
function writePoseTable() {
  const points = hasTool ? ["flange", "TCP"] : ["flange"];
  if (second) {
    const names = element("tr");
    names.append(element("th"));
    for (const arm of report.arms) {
      const name = element("th", called(arm));
      name.colSpan = points.length;
      names.append(name);
    }
    $("pose-head").append(names);
  }
  const head = element("tr");
  head.append(element("th"), ...report.arms.flatMap(() => points.map((it) => element("th", it))));
  $("pose-head").append(head);
  for (const name of ["X mm", "Y mm", "Z mm", "A deg", "B deg", "C deg"]) {
    const row = element("tr");
    const values = report.arms.flatMap(() => points.map(() => element("td")));
    row.append(element("td", name), ...values);
    $("pose").append(row);
    cells.poses.push(values);
  }
}

/** Writes the current poses. */
function writePoses(t) {
  const poses = report.arms.flatMap((arm) =>
    (hasTool ? [false, true] : [false]).map((isTcp) => placeOf(arm, t, isTcp)),
  );
  cells.poses.forEach((values, k) => {
    values.forEach((cell, i) => {
      cell.textContent = number(poses[i][k], k < 3 ? 1 : 2);
    });
  });
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
  writePoses(t);
  const piece = report.pieces.length ? pieceAt(t) : null;
  const limitText = ({ limit, joint }) =>
    limit ? `; limited by the ${limitName(null, limit)}${joint ? ` of A${joint}` : ""}` : "";
  $("piece").textContent = piece
    ? `Motion ${piece.motion}${titleOf(piece.motion)}, ` +
      `${PIECE_NAMES[piece.kind] || piece.kind}${limitText(piece)}`
    : "";
  const near = report.arms.filter((arm) => arm.clearance).at(-1)?.clearance;
  if (near) {
    const mm = 1000 * valueAt(near.distance, t, 0, 1);
    const pair = pairAt(near, t);
    const distance = mm > 0 ? `${number(mm, 1)} mm` : "touching";
    $("pair").textContent = `At ${number(t, 3)} s: ${distance}, ${pairText(pair.link, pair.other)}`;
  }
  for (const { row, motion, segment } of cells.rows)
    row.classList.toggle(
      "current",
      Boolean(piece) && (segment ? piece === segment : piece.motion === motion),
    );
}

// ---- the table of motions

let titles = null;

/** The round of a motion in its repeat blocks; empty outside of blocks. */
function roundOf({ rounds = [] }) {
  const texts = rounds.map(({ number, count }) => `${number} of ${count}`);
  return texts.length ? `round ${texts.join(", ")}` : "";
}

/** The name of a motion in quotes, and its source and round in parentheses, if known. */
function titleOf(motion) {
  titles ??= new Map(
    motionRows().map((motion) => {
      const { index, name, source } = motion;
      const origin = [source ? `${source.file}:${source.line}` : "", roundOf(motion)];
      const known = origin.filter(Boolean).join(", ");
      return [index, (name ? ` "${name}"` : "") + (known ? ` (${known})` : "")];
    }),
  );
  return titles.get(motion) || "";
}

/** The name of a limit: that of a joint, of the TCP, the minimum duration, or T1. */
function limitName(joint, kind) {
  return (joint ? `A${joint} ` : "") + kind.replaceAll("_", " ").replace(/^t1 /, "T1 ");
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

/** Adds a row for each segment of a spline, below the row of the motion. The types are those of the
    program if each of its segments is one piece of the path. */
function addSegments(body, index, names) {
  const pieces = report.pieces.filter((it) => it.motion === index && it.kind === "spline");
  if (pieces.length < 2) return;
  const types = report.segments[index];
  pieces.forEach((piece, k) => {
    const values = {
      motion: `${index}.${k + 1}`,
      type: types?.length === pieces.length ? types[k] : "segment",
      "start s": number(piece.start_s, 3),
      "end s": number(piece.end_s, 3),
      "duration s": number(piece.end_s - piece.start_s, 3),
      "limited by": piece.limit ? limitName(piece.joint, piece.limit) : "",
    };
    const row = element("tr", "", "segment");
    for (const name of names) {
      const cell = element("td", values[name] ?? "", WORDS.includes(name) ? "word" : "");
      cell.dataset.name = name;
      row.append(cell);
    }
    row.addEventListener("click", () => seek(piece.start_s));
    body.append(row);
    cells.rows.push({ row, segment: piece });
  });
}

/** Columns of text. */
const WORDS = ["type", "name", "group", "round", "I/O", "source", "limited by", "comment"];

function writeMotions() {
  const SHOWN = 300;
  const rows = motionRows();
  if (!rows.length) return;
  $("motions").hidden = false;
  const measured = report.compared
    ? new Map(report.compared.report.motions.map((row) => [row.index, row]))
    : null;
  const head = element("tr");
  const labels = ["name", "group"].filter((key) => rows.some((row) => row[key]));
  const hasRound = rows.some(({ rounds }) => rounds);
  const hasIo = rows.some((row) => row.io !== undefined);
  const names = ["motion", "type", ...labels];
  if (hasRound) names.push("round");
  if (hasIo) names.push("I/O");
  names.push("start s", "end s", "duration s", "top speed %");
  const hasTcp = rows.some((row) => row.tcp_speed_peak_mm_s !== undefined);
  if (hasTcp) names.push("TCP mm/s", "nearest singularity");
  const hasTorque = rows.some((row) => row.torque);
  if (hasTorque) names.push("top torque");
  if (measured) names.push("measured s", "error s", "error %");
  const hasSource = rows.some((row) => row.source);
  if (hasSource) names.push("source");
  names.push("limited by");
  const hasComment = rows.some((row) => row.comment);
  if (hasComment) names.push("comment");
  for (const name of names) head.append(element("th", name, WORDS.includes(name) ? "word" : ""));
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
    add(TYPE_NAMES[motion.type] || motion.type, "word");
    for (const key of labels) add(motion[key] || "", "word");
    if (hasRound) add(roundOf(motion).replace("round ", ""), "word");
    if (hasIo) add(motion.io === undefined ? "" : `${motion.io} = ${motion.value}`, "word");
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
    if (hasComment) add(motion.comment || "", "word comment");
    row.addEventListener("click", () => {
      seek(motion.start_s);
    });
    body.append(row);
    cells.rows.push({ row, motion: motion.index });
    addSegments(body, motion.index, names);
  }
  $("table").append(headed, body);
  const hidden = rows.length - Math.min(rows.length, SHOWN);
  $("more").textContent =
    "A motion lasts from the start of the blend before it to the start of the blend after it, or " +
    "to its stop; shares are relative to its duration." +
    (hidden ? ` ${hidden} more motions: iiwasim plan --json has them.` : "");
}

/**
 * Fills a table whose first column has words and whose other columns have numbers. A row has texts,
 * and may have a title.
 */
function fillTable(table, names, rows) {
  const head = element("tr");
  names.forEach((name, column) => {
    head.append(element("th", name, column ? "" : "word"));
  });
  const headed = element("thead");
  headed.append(head);
  const body = element("tbody");
  for (const { texts, title } of rows) {
    const row = element("tr");
    if (title) row.title = title;
    texts.forEach((text, column) => {
      const cell = element("td", text, column ? "" : "word");
      cell.dataset.name = names[column];
      row.append(cell);
    });
    body.append(row);
  }
  table.append(headed, body);
}

/** The table of groups, if the program has any. */
function writeGroups() {
  const SHOWN = 300;
  const groups = report.figures.groups || [];
  if (!groups.length) return;
  $("groups").hidden = false;
  const rows = groups.slice(0, SHOWN).map((group) => ({
    texts: [
      group.contiguous ? group.name : `${group.name} *`,
      group.motions,
      number(group.duration_s, 3),
      number(100 * group.share, 1),
    ],
  }));
  fillTable($("group-table"), ["group", "motions", "duration s", "% of cycle time"], rows);
  const hidden = groups.length - Math.min(groups.length, SHOWN);
  $("group-notes").textContent =
    "Duration: sum of the motions and waits of the group, without settling after stops." +
    (groups.every(({ contiguous }) => contiguous)
      ? ""
      : " * Other motions lie between the motions of this group.") +
    (hidden ? ` ${hidden} more groups: iiwasim plan --json has them.` : "");
}

/** The table of repeat blocks, if the program has any. */
function writeRepeats() {
  const SHOWN = 300;
  const repeats = report.figures.repeats || [];
  if (!repeats.length) return;
  $("repeats").hidden = false;
  const names = [
    "block",
    "first motion",
    "motions",
    "rounds",
    "duration s",
    "% of cycle time",
    "shortest round s",
    "longest round s",
  ];
  const rows = repeats.slice(0, SHOWN).map((repeat) => ({
    title: repeat.comment,
    texts: [
      "> ".repeat(repeat.depth - 1) + (repeat.name || ""),
      repeat.first_motion,
      repeat.motions,
      repeat.count,
      number(repeat.duration_s, 3),
      number(100 * repeat.share, 1),
      number(repeat.min_round_s, 3),
      number(repeat.max_round_s, 3),
    ],
  }));
  fillTable($("repeat-table"), names, rows);
  const hidden = repeats.length - Math.min(repeats.length, SHOWN);
  $("repeat-notes").textContent =
    "A round lasts from the start of its first motion to the start of the motion after the " +
    "round, with settling after stops." +
    (hidden ? ` ${hidden} more blocks: iiwasim plan --json has them.` : "");
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
    "Each sample is compared with the nearest point of the planned path, regardless of time; " +
      `recording noise (${rest.noise_rad.toExponential(1)} rad) counts as distance.`,
    ...rest.losses,
  ];
  if (rest.again_s !== null)
    notes.push(
      `The recording contains the program again, from ${number(rest.again_s, 3)} s on; the first ` +
        "run is used.",
    );
  const sentence = (text) =>
    text[0].toUpperCase() + text.slice(1) + (text.endsWith(".") ? "" : ".");
  $("compared-notes").textContent = notes.map(sentence).join(" ");
}
