// The surroundings and the tool of the robot: a scene for the 3D view, and as text.

/** The pose of a shape: its position, and the three rows of its rotation matrix. */
function posed([x, y, z], rows) {
  const [a, b, c] = rows || [
    [1, 0, 0],
    [0, 1, 0],
    [0, 0, 1],
  ];
  return new Float32Array([
    a[0],
    b[0],
    c[0],
    0,
    a[1],
    b[1],
    c[1],
    0,
    a[2],
    b[2],
    c[2],
    0,
    x,
    y,
    z,
    1,
  ]);
}

/** The obstacles of a scene in the base frame, and its tool shapes in the flange frame; `bodies`
    are the tools and workpieces that a program carries, each a list of shapes in the flange
    frame. */
function surroundings(scene, carried) {
  const shaped = (it) => {
    const origin = posed(it.center_m || it.origin_m || [0, 0, 0], it.rotation);
    if (it.type === "box") return { shape: cuboid(it.size_m), origin };
    if (it.type === "cylinder") return { shape: cylinder(it.radius_m, it.length_m), origin };
    if (it.type === "sphere") return { shape: sphere(it.radius_m), origin };
    if (it.type === "hull" || it.type === "mesh")
      return { shape: polyhedron(it.corners_m, it.triangles), origin };
    // The part of the plane nearest to the base.
    const n = it.normal;
    const away = n.reduce((sum, v, i) => sum + v * it.point_m[i], 0);
    const turn = placed(
      [0, 0, 0],
      [0, Math.acos(Math.min(Math.max(n[2], -1), 1)), Math.atan2(n[1], n[0])],
    );
    return { shape: sheet(2.4), origin: product(posed(n.map((v) => v * away)), turn) };
  };
  return {
    obstacles: (scene?.obstacles || []).map(shaped),
    tool: (scene?.tool || []).map(shaped),
    bodies: (carried?.bodies || []).map(({ shapes }) => shapes.map(shaped)),
  };
}

/** Function from time to the indices of the bodies that an arm carries. */
function bodiesOf({ bodies: changes }) {
  if (!changes?.length) return () => [];
  const starts = changes.map(({ from_s }) => from_s);
  return (t) => changes[Math.max(countUpTo(starts, t + 1e-9) - 1, 0)].bodies;
}

/** Name of a part of the arm: a link, the tool or the workpiece. */
function partText(link) {
  return { 8: "the tool", 9: "the workpiece" }[link] || `link ${link}`;
}

/** Text for a link and the obstacle or link nearest to it. */
function pairText(link, other) {
  return `${partText(link)} and ${other}`;
}

/** Text for the minimum clearance. */
function nearestText({ distance_mm: mm, link, other, at_s }) {
  const when = at_s === null ? "" : ` at ${number(at_s, 2)} s`;
  const apart = mm > 0 ? `${number(mm, 1)} mm` : "contact";
  return `${apart} between ${pairText(link, other)}${when}`;
}
