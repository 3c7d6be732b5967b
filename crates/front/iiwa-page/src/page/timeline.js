// The timeline of a plan.

/** Pieces of the path, as KUKA names them. */
const PIECE_NAMES = {
  line: "PTP",
  lin: "LIN",
  circ: "CIRC",
  spline: "spline segment",
  blend: "blend",
  settle: "settling",
  wait: "waiting",
};

/** Draws motions, blends, settling times and waits over the time axis of the curves. */
function drawTimeline(canvas, pieces, window_, theme) {
  const size = cleared(canvas);
  const { context } = size;
  const [left, right] = [LEFT, size.width - RIGHT];
  const x = (t) => left + ((t - window_.from) / (window_.to - window_.from)) * (right - left);
  const [top, bottom] = [4, size.height - 18];
  context.save();
  context.beginPath();
  context.rect(left, 0, right - left, size.height);
  context.clip();
  const first = Math.max(
    pieces.findIndex((piece) => piece.end_s > window_.from),
    0,
  );
  let labelled = -Infinity;
  for (let i = first; i < pieces.length; i++) {
    const piece = pieces[i];
    if (piece.start_s > window_.to) break;
    const [a, b] = [x(piece.start_s), x(piece.end_s)];
    const width = Math.max(b - a, 1);
    context.fillStyle = theme[piece.kind] || theme.settle;
    // Standstill is lower than motion, so that shape and colour both distinguish them.
    const moves = piece.kind !== "settle" && piece.kind !== "wait";
    const height = moves ? bottom - top : (bottom - top) / 2;
    context.fillRect(a, bottom - height, width > 3 ? width - 1 : width, height);
    if (piece.kind === "blend" && width > 6) {
      // Blends are hatched.
      context.save();
      context.beginPath();
      context.rect(a, top, width - 1, bottom - top);
      context.clip();
      context.strokeStyle = theme.paper;
      context.globalAlpha = 0.55;
      context.lineWidth = 1.5;
      context.beginPath();
      for (let h = a - (bottom - top); h < b; h += 6) {
        context.moveTo(h, bottom);
        context.lineTo(h + bottom - top, top);
      }
      context.stroke();
      context.restore();
    }
    const before = pieces[i - 1];
    const at = Math.max(a, left);
    if ((!before || before.motion !== piece.motion) && at > labelled) {
      const text = `${piece.motion}`;
      context.fillStyle = theme.soft;
      context.textAlign = "left";
      context.textBaseline = "top";
      context.fillText(text, at, bottom + 4);
      labelled = at + context.measureText(text).width + 4;
    }
  }
  context.restore();
  context.fillStyle = theme.soft;
  context.textAlign = "right";
  context.textBaseline = "top";
  context.fillText("motion", left - 6, bottom + 4);
}

/** The legend of the pieces that are drawn. */
function pieceLegend(target, pieces) {
  const there = new Set(pieces.map((piece) => piece.kind));
  legend(
    target,
    Object.entries(PIECE_NAMES).filter(([kind]) => there.has(kind)),
  );
}
