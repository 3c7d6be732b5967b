// Appearance of the robot: packed surfaces of its links.

/** A direction from its octahedral coordinates. */
function folded(u, v) {
  const z = 1 - Math.abs(u) - Math.abs(v);
  const under = Math.max(-z, 0);
  const [x, y] = [u + (u < 0 ? under : -under), v + (v < 0 ? under : -under)];
  const length = Math.hypot(x, y, z);
  return [x / length, y / length, z / length];
}

/** Linear light of an sRGB colour share. */
const lightOf = (share) => share ** 2.2;

/** All link surfaces for the 3D view: ten numbers per vertex (position, normal, colour, link), and
    triangles; the number of indices that cast shadows; and a flag for closed surfaces, whose
    insides cannot be seen. */
function unpackLook({ links, is_closed }) {
  const FULL = 65535;
  const parts = links.flatMap((surfaces, link) =>
    surfaces.map((it) => ({
      ...it,
      link,
      positions: new Uint16Array(unpack(it.positions)),
      normals: new Uint16Array(unpack(it.normals)),
      triangles: it.is_large
        ? new Uint32Array(unpack(it.triangles))
        : new Uint16Array(unpack(it.triangles)),
    })),
  );
  // The largest surfaces are first, as only they cast a visible shadow.
  const CASTS_M = 0.13;
  parts.sort((a, b) => Math.max(...b.size_m) - Math.max(...a.size_m));
  const sum = (of) => parts.reduce((all, part) => all + of(part), 0);
  const floats = new Float32Array(10 * sum((part) => part.positions.length / 3));
  const triangles = new Uint32Array(sum((part) => part.triangles.length));
  let [first, next, casting] = [0, 0, 0];
  for (const {
    link,
    paint,
    low_m: low,
    size_m: size,
    positions,
    normals,
    triangles: corners,
  } of parts) {
    const count = positions.length / 3;
    for (let i = 0; i < count; i++) {
      const at = 10 * (first + i);
      for (let k = 0; k < 3; k++) floats[at + k] = low[k] + (size[k] * positions[3 * i + k]) / FULL;
      floats.set(
        folded((2 * normals[2 * i]) / FULL - 1, (2 * normals[2 * i + 1]) / FULL - 1),
        at + 3,
      );
      for (let k = 0; k < 3; k++) floats[at + 6 + k] = lightOf(paint[k] / 255);
      floats[at + 9] = link;
    }
    for (const corner of corners) triangles[next++] = first + corner;
    first += count;
    if (Math.max(...size) > CASTS_M) casting = next;
  }
  return { floats, triangles, casting, is_closed };
}
