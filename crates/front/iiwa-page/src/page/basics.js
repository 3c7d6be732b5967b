// Functions that the scripts of all pages share: elements, numbers, colours.

const $ = (id) => document.getElementById(id);

/** An element with a text and a class. */
function element(tag, text = "", kind = "") {
  const made = document.createElement(tag);
  made.textContent = text;
  if (kind) made.className = kind;
  return made;
}

function figure(list, name, text) {
  const group = element("div");
  group.append(element("dt", name), element("dd", text));
  list.append(group);
}

function legend(target, entries) {
  target.replaceChildren(
    ...entries.map(([colour, text]) => {
      const entry = element("span");
      const swatch = element("i", "", `swatch ${colour}`);
      swatch.style.background = `var(--${colour})`;
      entry.append(swatch, text);
      return entry;
    }),
  );
}

/** Degrees per radian. */
const DEG = 180 / Math.PI;

/** A number with `decimals` decimals, without a minus sign before zero. */
function number(value, decimals) {
  if (!Number.isFinite(value)) return "\u2013";
  const text = value.toFixed(decimals);
  return Number(text) === 0 ? text.replace("-", "") : text;
}

/** A length or angle, not negative; for a value too small for the decimals, "below" and the least
    shown value. */
function atLeast(value, decimals, unit) {
  const least = 10 ** -decimals;
  return value > 0 && value < least
    ? `below ${least} ${unit}`
    : `${number(value, decimals)} ${unit}`;
}

/** The colours of the page: as in CSS for canvases, or as three numbers for the 3D view. */
function theme() {
  const style = getComputedStyle(document.documentElement);
  const css = (name) => style.getPropertyValue(`--${name}`).trim();
  const names = [
    "paper",
    "ground",
    "ink",
    "soft",
    "rule",
    "accent",
    "line",
    "lin",
    "circ",
    "spline",
    "blend",
    "settle",
    "wait",
    "measured",
    "beyond",
    "own",
  ];
  const flat = Object.fromEntries(names.map((name) => [name, css(name)]));
  flat.joints = Array.from({ length: 7 }, (_, j) => css(`a${j + 1}`));
  const solid = Object.fromEntries(
    names
      .filter((name) => flat[name].startsWith("#"))
      .map((name) => [name, [1, 3, 5].map((i) => parseInt(flat[name].slice(i, i + 2), 16) / 255)]),
  );
  solid.shadow = Number(css("shadow"));
  return { flat, solid };
}
