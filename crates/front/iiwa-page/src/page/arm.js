// The robot: joints from the URDF, link poses from joint positions; and shapes for obstacles.
// Matrices are 4 by 4, in column order as in WebGL.

function product(a, b) {
  const c = new Float32Array(16);
  for (let column = 0; column < 4; column++) {
    for (let row = 0; row < 4; row++) {
      let sum = 0;
      for (let k = 0; k < 4; k++) sum += a[4 * k + row] * b[4 * column + k];
      c[4 * column + row] = sum;
    }
  }
  return c;
}

/** A pose from a position and the roll, pitch and yaw of URDF. */
function placed([x, y, z], [roll, pitch, yaw]) {
  const [sr, cr, sp, cp] = [Math.sin(roll), Math.cos(roll), Math.sin(pitch), Math.cos(pitch)];
  const [sy, cy] = [Math.sin(yaw), Math.cos(yaw)];
  return new Float32Array([
    cy * cp,
    sy * cp,
    -sp,
    0,
    cy * sp * sr - sy * cr,
    sy * sp * sr + cy * cr,
    cp * sr,
    0,
    cy * sp * cr + sy * sr,
    sy * sp * cr - cy * sr,
    cp * cr,
    0,
    x,
    y,
    z,
    1,
  ]);
}

function transformed(m, [x, y, z], w = 1) {
  return [0, 1, 2].map((i) => m[i] * x + m[4 + i] * y + m[8 + i] * z + m[12 + i] * w);
}

const model = (() => {
  const xml = new DOMParser().parseFromString(robot.urdf, "application/xml");
  const numbers = (element, name) => {
    const text = element?.getAttribute(name);
    return text ? text.trim().split(/\s+/).map(Number) : [0, 0, 0];
  };
  const origin = (element) => {
    const at = element.querySelector("origin");
    return placed(numbers(at, "xyz"), numbers(at, "rpy"));
  };
  // From the base to the flange: the child of each joint is the parent of the next one.
  const joints = [...xml.querySelectorAll("robot > joint")].map((joint) => ({
    origin: origin(joint),
    moves: joint.getAttribute("type") === "revolute",
  }));
  return { joints };
})();

/** Poses of all links in the base, the flange last, at joint positions in rad. */
function linkPoses(q) {
  const poses = [placed([0, 0, 0], [0, 0, 0])];
  let j = 0;
  for (const joint of model.joints) {
    const turn = joint.moves ? q[j++] : 0;
    poses.push(
      product(product(poses[poses.length - 1], joint.origin), placed([0, 0, 0], [0, 0, turn])),
    );
  }
  return poses;
}

/** Position of the flange, in m. */
function flangeAt(q) {
  const poses = linkPoses(q);
  return Array.from(poses[poses.length - 1].slice(12, 15));
}

/** Position, in m, of a TCP given in the flange frame; without a TCP, position of the flange. */
function tcpAt(q, offset) {
  return offset ? transformed(linkPoses(q).at(-1), offset) : flangeAt(q);
}

/** Function from time to the TCP in motion, in the flange frame; null without tools. `tcps`
    are the TCPs of a program, each from a motion on. */
function toolOf(tcps, pieces) {
  if (!tcps.length) return () => null;
  const starts = pieces.map((piece) => piece.start_s);
  const motions = tcps.map((tcp) => tcp.motion);
  return (t) => {
    const piece = pieces[Math.max(countUpTo(starts, t + 1e-9) - 1, 0)];
    return tcps[Math.max(countUpTo(motions, piece ? piece.motion : 1) - 1, 0)].offset_m;
  };
}

/** The TCP path: positions in m, and their times; `gaps` has the indices at which another TCP
    starts to move, before which the path has a gap. Indistinguishable positions are left out. */
function tcpPath(arm, toolAt, from = -Infinity, to = Infinity) {
  const APART_M = 5e-4;
  const places = [];
  const times = [];
  const gaps = new Set();
  let tool = null;
  const add = (t, place) => {
    places.push(place);
    times.push(t);
  };
  let before;
  for (let i = 0; i < arm.poses.count; i++) {
    const t = arm.poses.t_s[i];
    if (t < from || t > to) continue;
    const q = arm.poses.q_rad.subarray(7 * i, 7 * i + 7);
    const place = tcpAt(q, toolAt(t));
    if (places.length && toolAt(t) !== tool) {
      if (before) add(...before);
      before = undefined;
      gaps.add(places.length);
      add(t, place);
    }
    tool = toolAt(t);
    const last = places[places.length - 1];
    if (!last || Math.hypot(...place.map((v, k) => v - last[k])) > APART_M) {
      // The path continues from the end of a standstill.
      add(t, place);
      before = undefined;
    } else {
      before = [t, place];
    }
  }
  if (before) add(...before);
  return { places, times, gaps };
}

/** The TCP path for the 3D view, in the colour `usual` except for blends and TCP motions of a
    plan. */
function wayOf(arm, pieces, usual, width, toolAt, from, to) {
  const { places, times, gaps } = tcpPath(arm, toolAt, from, to);
  const starts = pieces.map((piece) => piece.start_s);
  const kinds = times.map((t, i) => {
    if (gaps.has(i)) return null;
    const piece = pieces[Math.max(countUpTo(starts, t - 1e-6) - 1, 0)];
    return piece && ["blend", "lin", "circ", "spline"].includes(piece.kind) ? piece.kind : usual;
  });
  // Joint centres along the path, which the view has to include.
  const POSES = 40;
  const step = Math.max(Math.ceil(arm.poses.count / POSES), 1);
  const joints = [];
  for (let i = 0; i < arm.poses.count; i += step) {
    const t = arm.poses.t_s[i];
    if (t < (from ?? -Infinity) || t > (to ?? Infinity)) continue;
    for (const pose of linkPoses(arm.poses.q_rad.subarray(7 * i, 7 * i + 7)))
      joints.push(Array.from(pose.slice(12, 15)));
  }
  return { places, kinds, width, joints };
}

/** A body of revolution about z: vertices with their normals, and triangles of vertex indices.
    `profile` has radius, height, and the components of the normal along both. */
function turned(profile, sides = 24) {
  const shape = { positions: [], normals: [], triangles: [] };
  profile.forEach(([radius, height, out, up], i) => {
    for (let k = 0; k <= sides; k++) {
      const [s, c] = [Math.sin((2 * Math.PI * k) / sides), Math.cos((2 * Math.PI * k) / sides)];
      shape.positions.push([radius * c, radius * s, height]);
      shape.normals.push([out * c, out * s, up]);
      if (i === 0 || k === 0) continue;
      const b = i * (sides + 1) + k;
      const a = b - sides - 1;
      shape.triangles.push(a - 1, a, b, a - 1, b, b - 1);
    }
  });
  return shape;
}

function sphere(radius, steps = 12, sides = 24) {
  return turned(
    Array.from({ length: steps + 1 }, (_, i) => {
      const angle = Math.PI * (i / steps - 0.5);
      const [s, c] = [Math.sin(angle), Math.cos(angle)];
      return [radius * c, radius * s, c, s];
    }),
    sides,
  );
}

/** A cylinder around its centre, with rounded edges. */
function cylinder(radius, length) {
  const edge = Math.min(0.007, radius / 4, length / 4);
  const half = length / 2;
  const profile = [[0, -half, 0, -1]];
  for (const end of [-1, 1]) {
    for (let i = 0; i <= 2; i++) {
      const angle = (Math.PI / 4) * (end < 0 ? i - 2 : i);
      const [s, c] = [Math.sin(angle), Math.cos(angle)];
      profile.push([radius - edge + edge * c, end * (half - edge) + edge * s, c, s]);
    }
  }
  profile.push([0, half, 0, 1]);
  return turned(profile);
}

/** A box around its centre, with its edges. */
function cuboid(size) {
  const half = size.map((v) => v / 2);
  const shape = { positions: [], normals: [], triangles: [], edges: [] };
  const at = (axis, side, u, v) => {
    const place = [0, 0, 0];
    place[axis] = side * half[axis];
    place[(axis + 1) % 3] = u * half[(axis + 1) % 3];
    place[(axis + 2) % 3] = v * half[(axis + 2) % 3];
    return place;
  };
  for (let axis = 0; axis < 3; axis++) {
    for (const side of [-1, 1]) {
      const normal = [0, 0, 0];
      normal[axis] = side;
      const first = shape.positions.length;
      for (const [u, v] of [
        [-1, -1],
        [1, -1],
        [1, 1],
        [-1, 1],
      ]) {
        shape.positions.push(at(axis, side, u, v));
        shape.normals.push(normal);
      }
      shape.triangles.push(...[0, 1, 2, 0, 2, 3].map((k) => first + k));
      shape.edges.push(
        [at(axis, -1, side, -1), at(axis, 1, side, -1)],
        [at(axis, -1, side, 1), at(axis, 1, side, 1)],
      );
    }
  }
  return shape;
}

/** A surface of flat triangles. */
function polyhedron(corners, triangles) {
  const shape = { positions: [], normals: [], triangles: [] };
  for (const triangle of triangles) {
    const [a, b, c] = triangle.map((corner) => corners[corner]);
    const [u, v] = [b, c].map((it) => it.map((value, i) => value - a[i]));
    const across = [0, 1, 2].map(
      (i) => u[(i + 1) % 3] * v[(i + 2) % 3] - u[(i + 2) % 3] * v[(i + 1) % 3],
    );
    const length = Math.hypot(...across) || 1;
    for (const corner of [a, b, c]) {
      shape.triangles.push(shape.positions.length);
      shape.positions.push(corner);
      shape.normals.push(across.map((value) => value / length));
    }
  }
  return shape;
}

/** A part of a plane, normal to z. The plane is unbounded, so the view need not include it. */
function sheet(size) {
  const h = size / 2;
  const positions = [
    [-h, -h, 0],
    [h, -h, 0],
    [h, h, 0],
    [-h, h, 0],
  ];
  return {
    positions,
    normals: Array(4).fill([0, 0, 1]),
    triangles: [0, 1, 2, 0, 2, 3],
    edges: positions.map((place, i) => [place, positions[(i + 1) % 4]]),
    endless: true,
  };
}
