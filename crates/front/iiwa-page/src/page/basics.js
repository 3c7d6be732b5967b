// What the pages' scripts share: elements, numbers, colours.

const $ = (id) => document.getElementById(id);

/** An element with a text, and of a class. */
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

/** Degrees of a radian. */
const DEG = 180 / Math.PI;

/** A number with so many decimals, and no minus in front of nothing. */
function number(value, decimals) {
  if (!Number.isFinite(value)) return "\u2013";
  const text = value.toFixed(decimals);
  return Number(text) === 0 ? text.replace("-", "") : text;
}

/** A length or an angle that is not negative: what the decimals do not show is said to be below them. */
function atLeast(value, decimals, unit) {
  const least = 10 ** -decimals;
  return value > 0 && value < least
    ? `below ${least} ${unit}`
    : `${number(value, decimals)} ${unit}`;
}

/** The page's colours: as CSS has them for canvases, or as three numbers for the 3D view. */
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
