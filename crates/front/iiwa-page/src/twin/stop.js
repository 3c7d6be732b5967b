// Stopping the robot: buttons in the header, in dialogs and on the full screen, and the Escape key.

/** Requests a stop. Open dialogs are cancelled; a failure is reported in the header, which is
    always in view. */
async function stopRobot() {
  const request = ask("stop-said", "stop");
  for (const dialog of document.querySelectorAll("dialog[open]")) dialog.close("no");
  const isStopped = await request;
  // The full screen hides the header.
  if (!isStopped && document.fullscreenElement) document.exitFullscreen();
}

for (const button of document.querySelectorAll(".stop"))
  button.addEventListener("click", stopRobot);

// Escape first leaves a dialog, the full screen or a text field. A second press stops the robot.
document.addEventListener("keydown", (event) => {
  if (event.key !== "Escape" || event.repeat || event.isComposing) return;
  if (document.querySelector("dialog[open]") || document.fullscreenElement) return;
  const field = event.target.closest("input[type=text], input[type=number]");
  if (field) field.blur();
  else stopRobot();
});

// Keyboard focus and links scroll to below the header.
const header = document.querySelector("header");
new ResizeObserver(() => {
  document.documentElement.style.scrollPaddingTop = `${header.offsetHeight}px`;
}).observe(header);
