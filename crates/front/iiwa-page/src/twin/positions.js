// Saved positions: their names, their order, and programs of them.

/** A button for an action on a position. */
function positionButton(text, label, what, parameters) {
  const button = element("button", text);
  button.type = "button";
  button.setAttribute("aria-label", label);
  button.title = label;
  button.addEventListener("click", () => ask("positions-said", what, parameters));
  return button;
}

/** An unused position name. */
function freeName(positions) {
  const names = new Set(positions.map(({ name }) => name));
  let count = positions.length + 1;
  while (names.has(`P${count}`)) count += 1;
  return `P${count}`;
}

let suggested = "";
link.takes.positions = (positions) => {
  desk.positions = positions;
  const last = positions.length - 1;
  $("positions").replaceChildren(
    ...positions.map(({ id, name, joints_rad: q }, i) => {
      const row = element("tr");
      const rename = element("button", name, "name");
      rename.type = "button";
      rename.title = "Rename";
      rename.setAttribute("aria-label", `Rename ${name}`);
      rename.addEventListener("click", () => askForName(id, name));
      const up = positionButton("\u2191", `Move ${name} up`, "move_position", {
        position: id,
        by: -1,
      });
      const down = positionButton("\u2193", `Move ${name} down`, "move_position", {
        position: id,
        by: 1,
      });
      disableFor(up, i === 0 ? `${name} is already first` : "", up.title);
      disableFor(down, i === last ? `${name} is already last` : "", down.title);
      const remove = positionButton("Remove", `Remove ${name}`, "remove_position", {
        position: id,
      });
      row.append(
        element("td", "", "word"),
        element("td", q.map((v) => number(v * DEG, 1)).join(", "), "word small"),
        element("td", "", "keys"),
      );
      row.firstChild.append(rename);
      row.lastChild.append(up, down, remove);
      return row;
    }),
  );
  $("make").hidden = positions.length < 2;
  $("positions-empty").hidden = positions.length >= 2;
  // A name typed by the user is kept.
  if ($("position-name").value === suggested) {
    suggested = freeName(positions);
    $("position-name").value = suggested;
  }
};

async function askForName(id, name) {
  const dialog = $("rename");
  $("new-name").value = name;
  dialog.returnValue = "";
  dialog.showModal();
  $("new-name").select();
  const isSure = await new Promise((done) => {
    dialog.addEventListener("close", () => done(dialog.returnValue === "yes"), { once: true });
  });
  if (isSure)
    await ask("positions-said", "rename_position", { position: id, name: $("new-name").value });
}

$("save").addEventListener("submit", async (event) => {
  event.preventDefault();
  const name = $("position-name").value;
  suggested = name;
  await ask("positions-said", "save_position", { name });
});
$("make").addEventListener("submit", (event) => {
  event.preventDefault();
  ask("positions-said", "make_program", {
    velocity_percent: Number($("velocity").value),
    blend_mm: Number($("blend").value),
  });
});
