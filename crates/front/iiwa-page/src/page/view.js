// Camera control of the 3D view: by mouse, touch, keys and buttons.

/** Turns and shifts `scene` by input on its canvas and its buttons; `changed` draws it again. */
function makeTurnable(canvas, scene, changed) {
  const fingers = new Map();
  const apart = ([a, b]) => Math.hypot(a.clientX - b.clientX, a.clientY - b.clientY);
  const between = ([a, b]) => [(a.clientX + b.clientX) / 2, (a.clientY + b.clientY) / 2];
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, event);
  });
  canvas.addEventListener("pointermove", (event) => {
    const before = fingers.get(event.pointerId);
    if (!before) return;
    const then = [...fingers.values()];
    fingers.set(event.pointerId, event);
    const [right, down] = [event.clientX - before.clientX, event.clientY - before.clientY];
    const isShift = event.shiftKey || Boolean(event.buttons & 6);
    if (fingers.size === 2) {
      const now = [...fingers.values()];
      const [from, to] = [between(then), between(now)];
      scene.turn(0, 0, apart(now) / Math.max(apart(then), 1));
      scene.pan(to[0] - from[0], to[1] - from[1]);
    } else if (isShift) scene.pan(right, down);
    else scene.turn(-right / 160, down / 160);
    changed();
  });
  for (const end of ["pointerup", "pointercancel"]) {
    canvas.addEventListener(end, (event) => fingers.delete(event.pointerId));
  }
  // The right button shifts the view.
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());

  let hinted = 0;
  const hint = () => {
    $("hint").hidden = false;
    clearTimeout(hinted);
    hinted = setTimeout(() => {
      $("hint").hidden = true;
    }, 1800);
  };
  canvas.addEventListener(
    "wheel",
    (event) => {
      // Without focus, the wheel scrolls the page; a pinch on a touchpad is a wheel event with
      // Ctrl.
      if (document.activeElement !== canvas && !event.ctrlKey && !document.fullscreenElement) {
        hint();
        return;
      }
      event.preventDefault();
      $("hint").hidden = true;
      scene.turn(0, 0, Math.exp(-event.deltaY / (event.ctrlKey ? 120 : 600)));
      changed();
    },
    { passive: false },
  );

  const view = canvas.parentElement;
  const fill = () =>
    document.fullscreenElement ? document.exitFullscreen() : view.requestFullscreen();
  if (!view.requestFullscreen) $("look-full").hidden = true;
  document.addEventListener("fullscreenchange", () => {
    const isFull = document.fullscreenElement === view;
    $("look-full").setAttribute("aria-pressed", String(isFull));
    changed();
  });
  const looks = {
    "look-front": () => scene.look("front"),
    "look-side": () => scene.look("side"),
    "look-top": () => scene.look("top"),
    look: () => scene.reset(),
  };
  for (const [id, from] of Object.entries(looks)) {
    $(id).addEventListener("click", () => {
      from();
      changed();
    });
  }
  $("look-full").addEventListener("click", fill);

  canvas.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    const arrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
    const arrow = arrows[event.key];
    const others = {
      "+": () => scene.turn(0, 0, 1.15),
      "-": () => scene.turn(0, 0, 1 / 1.15),
      0: looks.look,
      1: looks["look-front"],
      2: looks["look-side"],
      3: looks["look-top"],
      f: fill,
      F: fill,
    };
    if (arrow && event.shiftKey) scene.pan(-24 * arrow[0], 24 * arrow[1]);
    else if (arrow) scene.turn(0.1 * arrow[0], 0.1 * arrow[1]);
    else if (others[event.key]) others[event.key]();
    else return;
    event.preventDefault();
    changed();
  });
}
