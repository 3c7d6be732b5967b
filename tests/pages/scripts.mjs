// Scripts of the pages, run outside a browser.

import { readFileSync } from "node:fs";

const SOURCES = new URL("../../crates/front/iiwa-page/src/", import.meta.url);

/** Runs scripts of a page in one scope, with the given globals; returns what is called `names`
    there. */
export function scripts(files, names, globals = {}) {
  const texts = files.map((file) => readFileSync(new URL(file, SOURCES), "utf8"));
  const run = new Function(...Object.keys(globals), `${texts.join("\n")}\nreturn { ${names} };`);
  return run(...Object.values(globals));
}

/** Pseudo-random numbers from 0 to 1, the same in each run. */
export function randoms(seed = 1) {
  let state = seed;
  return () => {
    state = (state * 48271) % 2147483647;
    return state / 2147483647;
  };
}
