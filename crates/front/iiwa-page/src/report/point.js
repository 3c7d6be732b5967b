// The flange or the TCP over time: speed, position and orientation.

/** Maximum TCP speed in T1 and beside people, in mm/s (ISO 10218-1). */
const REDUCED_MM_S = 250;

const hasTool = report.workcell.tcps.length > 0;
/** The shown point: the TCP if `tcp` is true, else the flange. */
const point = { tcp: hasTool, level: false, cache: new Map() };

/** The TCP pose at a time, in the flange frame: position and three rows of the rotation matrix. */
function tipAt(t) {
  const piece = report.pieces.length ? pieceAt(t + 1e-9) : null;
  const { tcps } = report.workcell;
  const motions = tcps.map((tcp) => tcp.motion);
  return tcps[Math.max(countUpTo(motions, piece ? piece.motion : 1) - 1, 0)];
}

/** Position of flange or TCP, in mm, and its angles A, B, C, in deg: R = Rz(A) Ry(B) Rx(C). */
function placeOf(arm, t, isTcp = point.tcp) {
  let m = linkPoses(jointsAt(arm, t)).at(-1);
  if (isTcp) {
    const { offset_m, rotation } = tipAt(t);
    m = product(m, posed(offset_m, rotation));
  }
  const flat = Math.hypot(m[0], m[1]);
  // At the singularity, A and C rotate about the same axis, and A is set to 0.
  const [sinA, cosA] = flat > 1e-6 ? [m[1] / flat, m[0] / flat] : [0, 1];
  const c = Math.atan2(sinA * m[8] - cosA * m[9], cosA * m[5] - sinA * m[4]);
  const abc = [Math.atan2(sinA, cosA), Math.atan2(-m[2], flat), c];
  return [1000 * m[12], 1000 * m[13], 1000 * m[14], ...abc.map((angle) => DEG * angle)];
}

/** Poses of a robot over the time window, at the resolution of the screen: six numbers each, and
    NaN in gaps. Angles are unwrapped beyond 180 deg. */
function placesOver(arm, window_) {
  const SAMPLES = 600;
  const key = `${report.arms.indexOf(arm)} ${point.tcp} ${window_.from} ${window_.to}`;
  if (point.cache.has(key)) return point.cache.get(key);
  const [from, to] = [Math.max(window_.from, arm.start_s), Math.min(window_.to, arm.end_s)];
  const times = [];
  const rows = [];
  const gap = Array(6).fill(Number.NaN);
  for (let i = 0; i <= SAMPLES && from <= to; i++) {
    const t = from + ((to - from) * i) / SAMPLES;
    const isGap = Number.isNaN(readingAt(arm.position, t, 0, 7));
    const row = isGap ? gap : placeOf(arm, t);
    const before = rows.at(-1) || gap;
    for (let k = 3; k < 6; k++)
      if (!Number.isNaN(before[k])) row[k] += 360 * Math.round((before[k] - row[k]) / 360);
    times.push(t);
    rows.push(row);
  }
  const all = Float32Array.from(rows.flat());
  const places = { t_s: Float64Array.from(times), low: all, high: all, of: 6 };
  if (point.cache.size > 8) point.cache.clear();
  point.cache.set(key, places);
  return places;
}

/** The speed of the flange or the TCP of a robot. */
function speedOf(arm) {
  return { ...arm.speed, of: hasTool ? 2 : 1, at: hasTool && point.tcp ? 1 : 0, factor: 1000 };
}

const POINT_PLACES = [
  { title: "Position", unit: "mm", names: ["X", "Y", "Z"], at: 0, least: 1 },
  { title: "Orientation", unit: "deg", names: ["A", "B", "C"], at: 3, least: 1 },
];
/** Colours of the three axes: well distinguishable joint colours. */
const AXIS_COLOURS = ["a7", "a4", "a6"];

function addPoint() {
  const arms = report.arms.filter((arm) => arm.speed?.columns > 0);
  const isUnder = (i) => report.arms.length > 1 && i === 0;
  if (arms.length) {
    addChart($("point-charts"), {
      title: element("h3", "Speed, mm/s"),
      label: "Speed over time",
      height: 126,
      draw: (canvas, colours) => {
        const curves = arms.map((arm, i) => ({
          ...speedOf(arm),
          colour: arm.role === "recording" ? "measured" : "accent",
          under: arms.length > 1 && i === 0,
        }));
        const levels = point.level ? [{ value: REDUCED_MM_S, text: `${REDUCED_MM_S} mm/s` }] : [];
        drawCurves(canvas, curves, state.window, colours, { least: 1, levels, withTimes: false });
      },
      readings: (t) =>
        arms.map((arm) => {
          const curve = speedOf(arm);
          const colour = arm.role === "recording" ? "measured" : "accent";
          const speed = readingAt(curve, t, curve.at, curve.of);
          return [colour, called(arm), `${number(1000 * speed, 1)} mm/s`];
        }),
    });
  }
  POINT_PLACES.forEach(({ title, unit, names, at, least }, k) => {
    const last = k + 1 === POINT_PLACES.length;
    const heading = element("h3", `${title}, ${unit}`);
    legend(
      heading.appendChild(element("span", "", "legend axes")),
      names.map((name, i) => [AXIS_COLOURS[i], name]),
    );
    addChart($("point-charts"), {
      title: heading,
      label: `${title} over time`,
      height: last ? 146 : 126,
      draw: (canvas, colours) => {
        const curves = report.arms.flatMap((arm, i) =>
          names.map((_, axis) => ({
            ...placesOver(arm, state.window),
            at: at + axis,
            colour: AXIS_COLOURS[axis],
            under: isUnder(i),
          })),
        );
        drawCurves(canvas, curves, state.window, colours, {
          fromZero: false,
          least,
          withTimes: last,
        });
      },
      readings: (t) =>
        names.map((name, axis) => {
          const inside = (arm) => t >= arm.start_s && t <= arm.end_s;
          const value = (arm) => (inside(arm) ? placeOf(arm, t)[at + axis] : Number.NaN);
          return [AXIS_COLOURS[axis], name, valuesAt(value, 2, unit)];
        }),
    });
  });
  for (const id of ["point-tcp", "point-flange"]) {
    $(id).hidden = !hasTool;
    $(id).addEventListener("click", () => {
      point.tcp = id === "point-tcp";
      writePoint();
      drawCharts();
    });
  }
  $("level").addEventListener("change", () => {
    point.level = $("level").checked;
    drawCharts();
  });
  writePoint();
}

function writePoint() {
  $("point-title").textContent = `${point.tcp ? "TCP" : "Flange"} over time`;
  $("point-tcp").setAttribute("aria-pressed", String(point.tcp));
  $("point-flange").setAttribute("aria-pressed", String(!point.tcp));
}
