//! Recursive Newton-Euler algorithm, written out for the LBR iiwa.
//!
//! All vectors are given in link frames: z is the joint axis, the origins are in base, shoulder,
//! elbow and wrist. Successive frames differ by a quarter turn about x and a turn about z; only the
//! elbow and the wrist are offset from the preceding origin, along z. So the shoulder does not
//! move, and no force is computed where no lever arm follows.

#![expect(
    clippy::inline_always,
    reason = "kernels must be inlined into the function that enables vector instructions"
)]

use crate::{Joints, rigid_body::Moments, robot::TWIST_QUARTERS, rotation::Vec3};

/// Moving masses and geometry of the arm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Linkage {
    /// Links 1 to 7, each in its own frame; the last one includes all that it carries.
    pub(crate) links: [Moments; 7],
    /// Distances base to shoulder, shoulder to elbow, elbow to wrist and wrist to flange, in m.
    pub(crate) offsets: [f64; 4],
    /// Apparent acceleration, in m/s^2, of the base at rest: the negative of gravity.
    pub(crate) rest: Vec3<f64>,
}

/// Motion of a link, in its own frame.
#[derive(Clone, Copy)]
struct Movement {
    /// Angular velocity, in rad/s.
    spin: Vec3<f64>,
    /// Angular acceleration, in rad/s^2.
    turn: Vec3<f64>,
    /// Acceleration of the origin, in m/s^2.
    rise: Vec3<f64>,
}

/// Rotates `v` from the axes of link `j` - 1 into the axes of link `j` (index from 0).
#[inline(always)]
fn outwards(j: usize, [x, y, z]: Vec3<f64>, s: f64, c: f64) -> Vec3<f64> {
    let (y, z) = if TWIST_QUARTERS[j - 1] > 0 { (z, -y) } else { (-z, y) };
    [c * x + s * y, c * y - s * x, z]
}

/// Rotates `v` from the axes of link `j` into the axes of the link before.
#[inline(always)]
fn inwards(j: usize, [x, y, z]: Vec3<f64>, s: f64, c: f64) -> Vec3<f64> {
    let (x, y) = (c * x - s * y, s * x + c * y);
    if TWIST_QUARTERS[j - 1] > 0 { [x, -z, y] } else { [x, z, -y] }
}

#[inline(always)]
fn sum(a: Vec3<f64>, b: Vec3<f64>) -> Vec3<f64> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

impl Movement {
    /// Motion of link `j`, from the motion of the link before.
    #[inline(always)]
    fn next(self, j: usize, s: f64, c: f64, rate: f64, rate_change: f64) -> Self {
        let spin = outwards(j, self.spin, s, c);
        let turn = outwards(j, self.turn, s, c);
        Self {
            spin: [spin[0], spin[1], spin[2] + rate],
            turn: [turn[0] + rate * spin[1], turn[1] - rate * spin[0], turn[2] + rate_change],
            rise: outwards(j, self.rise, s, c),
        }
    }

    /// Motion of the point at `d` on the link's z axis.
    #[inline(always)]
    fn at(self, d: f64) -> Self {
        let ([p, q, r], [dp, dq, _], [x, y, z]) = (self.spin, self.turn, self.rise);
        let rise = [x + d * (dq + p * r), y + d * (q * r - dp), z - d * (p * p + q * q)];
        Self { rise, ..self }
    }
}

/// Moment about the origin, in Nm, and force, in N, that produce this motion of a link; the force
/// is zero unless `FORCE`.
#[inline(always)]
fn wrench<const FORCE: bool>(link: &Moments, movement: &Movement) -> [Vec3<f64>; 2] {
    let ([p, q, r], [dp, dq, dr], [ax, ay, az]) = (movement.spin, movement.turn, movement.rise);
    let (pp, qq, rr) = (p * p, q * q, r * r);
    let (pq, pr, qr) = (p * q, p * r, q * r);
    // A point x of the link accelerates by W x relative to the origin, with W = [turn] + [spin]^2.
    let (w_xy, w_yx) = (pq - dr, pq + dr);
    let (w_zx, w_xz) = (pr - dq, pr + dq);
    let (w_yz, w_zy) = (qr - dp, qr + dp);
    let [hx, hy, hz] = link.first_kg_m;
    let [xx, xy, xz, yy, yz, zz] = link.second_kg_m2;
    // Moment: mass-weighted sum of x times (rise + W x). Force: mass-weighted sum of rise + W x.
    let moment = [
        (yy * w_zy - zz * w_yz) + (xy * w_zx - xz * w_yx) + yz * (rr - qq) + (hy * az - hz * ay),
        (zz * w_xz - xx * w_zx) + (yz * w_xy - xy * w_zy) + xz * (pp - rr) + (hz * ax - hx * az),
        (xx * w_yx - yy * w_xy) + (xz * w_yz - yz * w_xz) + xy * (qq - pp) + (hx * ay - hy * ax),
    ];
    if !FORCE {
        return [moment, [0.0; 3]];
    }
    let m = link.mass_kg;
    let force = [
        m * ax + (w_xy * hy + w_xz * hz - (qq + rr) * hx),
        m * ay + (w_yx * hx + w_yz * hz - (pp + rr) * hy),
        m * az + (w_zx * hx + w_zy * hy - (pp + qq) * hz),
    ];
    [moment, force]
}

/// Joint torques, in Nm: `M(q) q'' + C(q, q') q'`, plus the gravity torques if `RISES`.
#[inline(always)]
pub(crate) fn inverse_dynamics<const RISES: bool>(
    arm: &Linkage,
    [s, c]: [&Joints; 2],
    rate: &Joints,
    rate_change: &Joints,
) -> Joints {
    let links = &arm.links;
    let [_, elbow, wrist, _] = arm.offsets;

    // Outward recursion: motion of the links.
    let [x, y, z] = if RISES { arm.rest } else { [0.0; 3] };
    let rise = [c[0] * x + s[0] * y, c[0] * y - s[0] * x, z];
    // The first link rotates about one axis only.
    let foot = links[0].second_kg_m2[0] + links[0].second_kg_m2[3];
    let [hx, hy, _] = links[0].first_kg_m;
    let first = foot * rate_change[0] + (hx * rise[1] - hy * rise[0]);
    let second = Movement {
        spin: [-s[1] * rate[0], -c[1] * rate[0], rate[1]],
        turn: [
            -s[1] * rate_change[0] - c[1] * rate[0] * rate[1],
            s[1] * rate[0] * rate[1] - c[1] * rate_change[0],
            rate_change[1],
        ],
        rise: outwards(1, rise, s[1], c[1]),
    };
    let third = second.next(2, s[2], c[2], rate[2], rate_change[2]);
    let fourth = third.at(elbow).next(3, s[3], c[3], rate[3], rate_change[3]);
    let fifth = fourth.next(4, s[4], c[4], rate[4], rate_change[4]);
    let sixth = fifth.at(wrist).next(5, s[5], c[5], rate[5], rate_change[5]);
    let seventh = sixth.next(6, s[6], c[6], rate[6], rate_change[6]);

    // Inward recursion: moments and forces.
    let [n7, f7] = wrench::<true>(&links[6], &seventh);
    let [n6, f6] = wrench::<true>(&links[5], &sixth);
    let n6 = sum(n6, inwards(6, n7, s[6], c[6]));
    let f6 = sum(f6, inwards(6, f7, s[6], c[6]));
    let [n5, f5] = wrench::<true>(&links[4], &fifth);
    let from6 = inwards(5, f6, s[5], c[5]);
    let n5 = lever(sum(n5, inwards(5, n6, s[5], c[5])), wrist, &from6);
    let f5 = sum(f5, from6);
    let [n4, f4] = wrench::<true>(&links[3], &fourth);
    let n4 = sum(n4, inwards(4, n5, s[4], c[4]));
    let f4 = sum(f4, inwards(4, f5, s[4], c[4]));
    let [n3, _] = wrench::<false>(&links[2], &third);
    let n3 = lever(sum(n3, inwards(3, n4, s[3], c[3])), elbow, &inwards(3, f4, s[3], c[3]));
    let [n2, _] = wrench::<false>(&links[1], &second);
    let n2 = sum(n2, inwards(2, n3, s[2], c[2]));
    let n1 = first + inwards(1, n2, s[1], c[1])[2];
    [n1, n2[2], n3[2], n4[2], n5[2], n6[2], n7[2]]
}

/// Adds to a moment the moment of a force at `d` on the z axis.
#[inline(always)]
fn lever(moment: Vec3<f64>, d: f64, force: &Vec3<f64>) -> Vec3<f64> {
    [moment[0] - d * force[1], moment[1] + d * force[0], moment[2]]
}

/// Joint torques, in Nm, that hold the arm at rest against gravity.
#[inline(always)]
pub(crate) fn holding(arm: &Linkage, [s, c]: [&Joints; 2]) -> Joints {
    let links = &arm.links;
    let [_, elbow, wrist, _] = arm.offsets;
    let [x, y, z] = arm.rest;
    let r1 = [c[0] * x + s[0] * y, c[0] * y - s[0] * x, z];
    let r2 = outwards(1, r1, s[1], c[1]);
    let r3 = outwards(2, r2, s[2], c[2]);
    let r4 = outwards(3, r3, s[3], c[3]);
    let r5 = outwards(4, r4, s[4], c[4]);
    let r6 = outwards(5, r5, s[5], c[5]);
    let r7 = outwards(6, r6, s[6], c[6]);
    // First moments of everything that a joint carries, about the origin of its link.
    let beyond_wrist = links[5].mass_kg + links[6].mass_kg;
    let beyond_elbow = beyond_wrist + links[3].mass_kg + links[4].mass_kg;
    let h7 = links[6].first_kg_m;
    let h6 = sum(links[5].first_kg_m, inwards(6, h7, s[6], c[6]));
    let mut h5 = sum(links[4].first_kg_m, inwards(5, h6, s[5], c[5]));
    h5[2] += wrist * beyond_wrist;
    let h4 = sum(links[3].first_kg_m, inwards(4, h5, s[4], c[4]));
    let mut h3 = sum(links[2].first_kg_m, inwards(3, h4, s[3], c[3]));
    h3[2] += elbow * beyond_elbow;
    let h2 = sum(links[1].first_kg_m, inwards(2, h3, s[2], c[2]));
    let h1 = sum(links[0].first_kg_m, inwards(1, h2, s[1], c[1]));
    let about = |h: Vec3<f64>, r: Vec3<f64>| h[0] * r[1] - h[1] * r[0];
    [
        about(h1, r1),
        about(h2, r2),
        about(h3, r3),
        about(h4, r4),
        about(h5, r5),
        about(h6, r6),
        about(h7, r7),
    ]
}

/// Mass matrix, in kg m^2, by the composite rigid body algorithm: for each joint, all that it
/// carries is treated as one body.
pub(crate) fn mass_matrix(arm: &Linkage, [s, c]: [&Joints; 2]) -> [Joints; 7] {
    let mut matrix = [[0.0; 7]; 7];
    let mut carried = Moments::default();
    for j in (0..7).rev() {
        carried = carried.plus(&arm.links[j]);
        // Moment and force that accelerate the composite body about its joint axis at 1 rad/s^2.
        let [hx, hy, _] = carried.first_kg_m;
        let [xx, _, xz, yy, yz, _] = carried.second_kg_m2;
        let (mut moment, mut force) = ([-xz, -yz, xx + yy], [-hy, hx, 0.0]);
        matrix[j][j] = moment[2];
        for i in (0..j).rev() {
            let (s, c) = (s[i + 1], c[i + 1]);
            force = inwards(i + 1, force, s, c);
            moment = lever(inwards(i + 1, moment, s, c), arm.lever_of(i), &force);
            matrix[i][j] = moment[2];
            matrix[j][i] = moment[2];
        }
        if j > 0 {
            let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
                .map(|axis| inwards(j, axis, s[j], c[j]));
            carried = carried.turned(&axes).shifted(arm.lever_of(j - 1));
        }
    }
    matrix
}

impl Linkage {
    /// Offset of the next link's origin from that of link `j`, along z, in m.
    fn lever_of(&self, j: usize) -> f64 {
        match j {
            2 => self.offsets[1],
            4 => self.offsets[2],
            _ => 0.0,
        }
    }
}
