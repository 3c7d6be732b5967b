// Plots of joints, flange or TCP speed and torques over the last seconds.

/** Numbers per sample: seven joint positions in rad, the speed in m/s, seven measured and seven
    planned torques in Nm. */
const NUMBERS = 22;
const SPEED = 7;
const MEASURED = 8;
const PLANNED = 15;

const history_ = {
  /** Time window of the plots, in s. */
  span: 30,
  count: 0,
  t_s: new Float64Array(16_000),
  rows: new Float32Array(NUMBERS * 16_000),
  places: [],
};

/** The TCP of the program on the page, in the flange frame; null for the flange. */
const tipOf = () => desk.plan?.sketch.workcell.tcps[0]?.offset_m || null;

/** Records a sample; a restarted drive has other times. */
function remember({ t_s: t, joints_rad: q, torque_nm: torques }) {
  /** Minimum interval for speeds, in s: over shorter intervals, speeds are noise. */
  const OVER_S = 0.045;
  const past = history_;
  if (past.count && t <= past.t_s[past.count - 1]) {
    if (t > past.t_s[past.count - 1] - 1) return;
    [past.count, past.places] = [0, []];
  }
  const limit = past.t_s.length;
  if (past.count === limit) {
    // Samples older than two minutes are dropped.
    const kept = (3 * limit) / 4;
    past.t_s.copyWithin(0, limit - kept);
    past.rows.copyWithin(0, NUMBERS * (limit - kept));
    past.count = kept;
  }
  const tip = tipOf();
  const places = past.places;
  if (places.length && String(places.at(-1).tip) !== String(tip)) places.length = 0;
  places.push({ t, tip, at: tcpAt(q, tip) });
  while (places.length > 2 && t - places[1].t >= OVER_S) places.shift();
  const { t: from, at } = places[0];
  // After a gap, the speed is unknown.
  const isKnown = t - from >= OVER_S && t - from < 0.5;
  const i = past.count;
  past.t_s[i] = t;
  past.rows.set(q, NUMBERS * i);
  past.rows.set(torques || Array(7).fill(Number.NaN), NUMBERS * i + MEASURED);
  past.rows.set(plannedTorques(t, q), NUMBERS * i + PLANNED);
  past.rows[NUMBERS * i + SPEED] = isKnown
    ? Math.hypot(...places.at(-1).at.map((v, k) => v - at[k])) / (t - from)
    : Number.NaN;
  past.count += 1;
}

/** The current speed, in m/s; NaN if unknown. */
const speedNow = () =>
  history_.count ? history_.rows[NUMBERS * (history_.count - 1) + SPEED] : Number.NaN;

/** Shows the text of an empty chart while none of its values is known. */
function markEmpty(id, rows, columns) {
  let isEmpty = true;
  for (let row = rows.length - NUMBERS; isEmpty && row >= 0; row -= NUMBERS)
    isEmpty = columns.every((at) => Number.isNaN(rows[row + at]));
  $(id).parentElement.querySelector(".empty").hidden = !isEmpty;
}

/** The numbers of seven joints in a sample, from `first`. */
const sevenFrom = (first) => Array.from({ length: 7 }, (_, j) => first + j);

/** Draws the last seconds; the newest is at 0. */
function drawHistory() {
  const past = history_;
  const newest = past.count ? past.t_s[past.count - 1] : 0;
  const first = countUpTo(past.t_s.subarray(0, past.count), newest - past.span);
  const t_s = past.t_s.subarray(first, past.count).map((t) => t - newest);
  const rows = past.rows.subarray(NUMBERS * first, NUMBERS * past.count);
  markEmpty("history-joints", rows, sevenFrom(0));
  markEmpty("history-speed", rows, [SPEED]);
  markEmpty("history-torque", rows, [...sevenFrom(MEASURED), ...sevenFrom(PLANNED)]);
  const colours = theme().flat;
  const window_ = { from: -past.span, to: 0 };
  const curve = (at, colour, factor) => ({
    t_s,
    low: rows,
    high: rows,
    of: NUMBERS,
    at,
    colour,
    factor,
  });
  const joints = Array.from({ length: 7 }, (_, j) => curve(j, `a${j + 1}`, DEG));
  drawCurves($("history-joints"), joints, window_, colours, {
    fromZero: false,
    least: 1,
  });
  drawCurves($("history-speed"), [curve(SPEED, "accent", 1000)], window_, colours, { least: 10 });
  const shares = (at, under) =>
    robot.torque_nm.map((limit, j) => ({ ...curve(at + j, `a${j + 1}`, 100 / limit), under }));
  const torques = [...shares(PLANNED, true), ...shares(MEASURED, false)];
  drawCurves($("history-torque"), torques, window_, colours, { fromZero: false, least: 10 });
}

/** True if the plots are on the screen; otherwise, they are not drawn. */
let isHistorySeen = false;
new IntersectionObserver((entries) => {
  isHistorySeen = entries.at(-1).isIntersecting;
}).observe(document.querySelector(".charts"));

function writeHistory() {
  const speed = speedNow();
  const what = tipOf() ? "TCP" : "flange";
  $("history-title").textContent = `Speed of the ${what}, mm/s`;
  $("speed-now").textContent =
    isStale() || Number.isNaN(speed) ? "" : `The ${what} moves at ${number(1000 * speed, 0)} mm/s`;
  if (isHistorySeen) drawHistory();
}

for (const [id, span] of [
  ["history-30", 30],
  ["history-120", 120],
]) {
  $(id).addEventListener("click", () => {
    history_.span = span;
    for (const it of ["history-30", "history-120"])
      $(it).setAttribute("aria-pressed", String(it === id));
    drawHistory();
  });
}
legend(
  $("history-legend"),
  Array.from({ length: 7 }, (_, j) => [`a${j + 1}`, `A${j + 1}`]),
);
