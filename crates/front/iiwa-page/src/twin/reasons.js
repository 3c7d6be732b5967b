// Disabled controls: each has a reason, as its tooltip and as text on the page.

/** Disables a control for a reason, which becomes its tooltip; without a reason, enables the
    control and sets its ordinary tooltip. */
function disableFor(control, reason, tooltip = "") {
  control.disabled = reason !== "";
  control.title = reason || tooltip;
}

/** Replaces a text on the page if it has changed. */
function writeText(id, text) {
  if ($(id).textContent !== text) $(id).textContent = text;
}
