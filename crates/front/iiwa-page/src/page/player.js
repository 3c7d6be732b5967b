// Playback: the button, the slider and the speeds of a page.

/** Makes the controls of the time, and returns a function that starts or stops playback. Playback
    covers `whole`, the slider all times. `seek` shows the page at a time. */
function makePlayer(state, whole, [startS, endS], seek) {
  let frame = null;

  function play(on) {
    state.playing = on;
    $("play").textContent = on ? "Pause" : "Play";
    $("play").setAttribute("aria-label", on ? "Pause" : "Play");
    frame = null;
    if (!on) return;
    if (state.time >= whole.to - 1e-9) seek(whole.from);
    requestAnimationFrame(tick);
  }

  function tick(now) {
    if (!state.playing) return;
    const passed = frame === null ? 0 : (now - frame) / 1000;
    frame = now;
    // A page that was hidden continues from its last time.
    const next = state.time + Math.min(passed, 1) * state.speed;
    const end = state.time > whole.to ? endS : whole.to;
    seek(Math.min(next, end));
    if (next >= end) play(false);
    else requestAnimationFrame(tick);
  }

  const scrub = $("scrub");
  [scrub.min, scrub.max] = [startS, endS];
  scrub.addEventListener("input", () => {
    play(false);
    seek(Number(scrub.value));
  });
  $("play").addEventListener("click", () => play(!state.playing));
  const speeds = [0.1, 0.25, 0.5, 1, 2, 5, 10];
  if (whole.to - whole.from > 120) speeds.push(60);
  for (const speed of speeds) {
    const option = element("option", `${speed}\u00d7`);
    option.value = speed;
    option.selected = speed === 1;
    $("speed").append(option);
  }
  $("speed").addEventListener("change", () => {
    state.speed = Number($("speed").value);
  });
  return play;
}
