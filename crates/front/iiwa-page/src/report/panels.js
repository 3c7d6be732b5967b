// The charts of the page: drawing, and values at a time.

/** Least shown deviation, in mm or mrad: below it, recordings are noise. */
const LEAST_DEVIATION = 0.001;

/** All charts: drawing function, values at a time as colour, name and text, and the element for the
    values. */
const charts = [];

/** Adds a chart to a part of the page, below a title. */
function addChart(parent, { title, label, height, draw, readings }) {
  if (title) parent.append(title);
  const box = element("div", "", "chart");
  const canvas = element("canvas");
  if (height) canvas.style.height = `${height}px`;
  box.append(canvas, element("i", "", "cursor"));
  parent.append(box);
  return listChart(canvas, label, draw, readings);
}

/** Registers a canvas as a chart. For assistive technology, the chart is a time slider. */
function listChart(canvas, label, draw, readings = () => []) {
  const marks = {
    select: element("i", "", "selection"),
    hover: element("i", "", "hover"),
    told: element("div", "", "told"),
  };
  for (const mark of Object.values(marks)) mark.hidden = true;
  canvas.parentElement.append(...Object.values(marks));
  canvas.tabIndex = 0;
  canvas.setAttribute("role", "slider");
  canvas.setAttribute("aria-label", label);
  const chart = { canvas, draw: (colours) => draw(canvas, colours), readings, ...marks };
  charts.push(chart);
  return chart;
}

/** Values of the robots that have a curve, as one text. */
function valuesAt(of, decimals, unit) {
  const texts = report.arms
    .map((arm) => number(of(arm), decimals))
    .filter((text) => text !== "\u2013");
  return texts.length ? `${texts.join(" | ")} ${unit}` : "";
}

function addQuantities() {
  const shown = QUANTITIES.filter(({ key }) => report.arms.some((arm) => arm[key].columns > 0));
  const lowest = shown.filter(({ key }) => key !== "snap").at(-1);
  shown.forEach((quantity) => {
    const title = element("h3");
    const last = quantity === lowest;
    const { canvas } = addChart($("charts"), {
      title,
      label: `${quantity.title} of the joints over time`,
      height: last ? 166 : 0,
      draw: (canvas, colours) => {
        if (canvas.parentElement.hidden) return;
        const percent = asShare(quantity);
        const largest = drawQuantity(canvas, quantity, state, colours, last);
        const beyond =
          percent && largest > MOST_PERCENT
            ? `, up to ${number(largest, 0)}, drawn up to ${MOST_PERCENT}`
            : "";
        const unit = percent ? "% of the limit" : quantity.unit;
        title.textContent = `${quantity.title}, ${unit}${beyond}`;
      },
      readings: (t) => {
        const { scale, offset } = shownScale(quantity);
        const percent = asShare(quantity);
        const value = (arm, j) => readingAt(arm[quantity.key], t, j, 7) * scale(j) + offset(j);
        const joints = state.joints.flatMap((on, j) => (on ? [j] : []));
        return joints.map((j) => [
          `a${j + 1}`,
          `A${j + 1}`,
          valuesAt((arm) => value(arm, j), percent ? 1 : 2, percent ? "%" : quantity.unit),
        ]);
      },
    });
    if (quantity.key === "snap") offerSnap(title, canvas.parentElement);
  });
}

/** A button that shows the chart of the snap, and hides it. */
function offerSnap(title, box) {
  const show = (on) => {
    title.hidden = box.hidden = !on;
    $("snap").textContent = on ? "Hide snap" : "Show snap";
    $("snap").setAttribute("aria-pressed", String(on));
  };
  show(false);
  $("snap").hidden = false;
  $("snap").addEventListener("click", () => {
    show(box.hidden);
    drawCharts();
  });
}

/** Adds charts of the deviations from the plan over time. */
function addDeviations() {
  for (const [key, what, unit, last] of [
    ["tcp_mm", "Flange deviation", "mm", false],
    ["joints_mrad", "Joint deviation", "mrad", true],
  ]) {
    const curve = { ...report.compared[key], colour: "measured" };
    const most = curve.high.reduce((a, b) => Math.max(a, b || 0), 0);
    const title =
      most < LEAST_DEVIATION ? `${what}: below ${LEAST_DEVIATION} ${unit}` : `${what}, ${unit}`;
    addChart($("deviations"), {
      title: element("h3", title),
      label: `${what} over time`,
      height: last ? 126 : 110,
      draw: (canvas, colours) =>
        drawCurves(canvas, [curve], state.window, colours, {
          least: LEAST_DEVIATION,
          withTimes: last,
        }),
      readings: (t) => [["measured", "off by", atLeast(readingAt(curve, t, 0), 3, unit)]],
    });
  }
}

/** The nearest pair at a time. */
function pairAt({ pairs }, t) {
  const starts = pairs.map((pair) => pair.from_s);
  return pairs[Math.max(countUpTo(starts, t) - 1, 0)];
}

/** Adds a chart of the clearance or the self-clearance, with the pairs of the last robot. */
function addClearance(key, title, label) {
  const arms = report.arms.filter((arm) => arm[key]);
  if (!arms.length) return;
  $("clearance").hidden = false;
  const curves = arms.map(({ role, [key]: clearance }, i) => ({
    ...clearance.distance,
    colour: role === "recording" ? "measured" : "accent",
    factor: 1000,
    under: arms.length > 1 && i === 0,
  }));
  const last = arms.at(-1)[key];
  const pairs = last.pairs.map((pair) => ({ ...pair, text: pairText(pair.link, pair.other) }));
  addChart($("clearances"), {
    title: element("h3", title),
    label,
    height: 146,
    draw: (canvas, colours) => drawClearance(canvas, curves, pairs, state.window, colours),
    readings: (t) => {
      const pair = pairAt(last, t);
      return [
        ...curves.map((curve, i) => [
          curve.colour,
          called(arms[i]),
          `${number(1000 * readingAt(curve, t, 0), 1)} mm`,
        ]),
        ["soft", "", pairText(pair.link, pair.other)],
      ];
    },
  });
}

addQuantities();
listChart(
  $("timeline"),
  "Timeline of the motions",
  (canvas, colours) => drawTimeline(canvas, report.pieces, state.window, colours),
  (t) => {
    const piece = report.pieces.length ? pieceAt(t) : null;
    return piece
      ? [[piece.kind, `Motion ${piece.motion}`, PIECE_NAMES[piece.kind] || piece.kind]]
      : [];
  },
);
if (report.compared) addDeviations();
addClearance(
  "clearance",
  "Smallest distance of the arm from obstacles, mm",
  "Clearance of the arm over time",
);
addClearance(
  "self_clearance",
  "Smallest distance of the arm from itself, mm",
  "Distance of the arm from itself over time",
);
addPoint();

function drawCharts() {
  const colours = theme().flat;
  for (const chart of charts) chart.draw(colours);
  placeCursors();
}

/** Horizontal position of a time in the charts, as a share of their width. */
const shareOf = (t) => (t - state.window.from) / (state.window.to - state.window.from);

function placeAt(mark, t) {
  const share = shareOf(t);
  mark.hidden = share < 0 || share > 1;
  mark.style.left = `calc(${LEFT}px + ${share} * (100% - ${LEFT + RIGHT}px))`;
}

function placeCursors() {
  for (const cursor of document.querySelectorAll(".cursor")) placeAt(cursor, state.time);
}
