// Looking at the 3D view from elsewhere: by mouse, fingers and keys.

/** Turns `scene` by what is done on its canvas; `changed` draws it again. */
function makeTurnable(canvas, scene, changed) {
  const fingers = new Map();
  const apart = () => {
    const [a, b] = [...fingers.values()];
    return Math.hypot(a.clientX - b.clientX, a.clientY - b.clientY);
  };
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, event);
  });
  canvas.addEventListener("pointermove", (event) => {
    const before = fingers.get(event.pointerId);
    if (!before) return;
    const spread = fingers.size === 2 ? apart() : 0;
    fingers.set(event.pointerId, event);
    if (fingers.size === 2) scene.turn(0, 0, apart() / Math.max(spread, 1));
    else scene.turn((before.clientX - event.clientX) / 160, (event.clientY - before.clientY) / 160);
    changed();
  });
  for (const end of ["pointerup", "pointercancel"]) {
    canvas.addEventListener(end, (event) => fingers.delete(event.pointerId));
  }
  canvas.addEventListener(
    "wheel",
    (event) => {
      event.preventDefault();
      scene.turn(0, 0, Math.exp(-event.deltaY / 600));
      changed();
    },
    { passive: false },
  );
  canvas.addEventListener("keydown", (event) => {
    const turns = {
      ArrowLeft: [-0.1, 0],
      ArrowRight: [0.1, 0],
      ArrowUp: [0, 0.1],
      ArrowDown: [0, -0.1],
      "+": [0, 0, 1.15],
      "-": [0, 0, 1 / 1.15],
    };
    if (!turns[event.key]) return;
    event.preventDefault();
    scene.turn(...turns[event.key]);
    changed();
  });
}
