//! Inverse kinematics of a point: joints A1, A2 and A4 that bring a point of the flange to a place, while A3 and the
//! wrist's joints A5 to A7 are given.
//!
//! Seen from the elbow the point is at a fixed distance, so that A4 follows from its distance from the shoulder; its height
//! and its way round the vertical axis give A1 and A2, as those of the wrist do in [`inverse`](mod@crate::inverse).

use crate::{Joints, Robot, number::Number, unreachable::Unreachable};

/// How far out of reach a point may be, in m: what rounding is.
const ROUNDING_M: f64 = 1e-9;

/// A point of the flange, and on which side of it shoulder and elbow are.
///
/// ```
/// use iiwa_kin::{FlangePoint, Robot};
///
/// let robot = Robot::lbr_iiwa_7_r800();
/// let joints = [0.3, 0.5, 0.2, -1.0, 0.4, 0.7, -0.1];
/// let tcp_m = [0.0, 0.02, 0.12];
/// let point = FlangePoint::new(&robot, tcp_m, &joints);
/// let flange = robot.flange_pose(&joints);
/// let place_m = std::array::from_fn(|i| {
///     flange.position_m[i] + (0..3).map(|k| flange.rotation[i][k] * tcp_m[k]).sum::<f64>()
/// });
/// let again = point.joints_at(&robot, &place_m, joints[2], [0.4, 0.7, -0.1])?;
/// assert!((0..7).all(|j| (again[j] - joints[j]).abs() < 1e-12));
/// # Ok::<(), iiwa_kin::Unreachable>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlangePoint {
    /// Where it is in the flange's frame, in m.
    point_m: [f64; 3],
    /// 1 or -1: the side of the upper arm to which the elbow bends, and the side of A1 on which the point is.
    elbow: f64,
    ahead: f64,
}

/// The point as seen from the elbow, in the directions of the forearm.
fn from_elbow<T: Number>([_, _, d5, d7]: &[f64; 4], point_m: &[f64; 3], wrist: [T; 3]) -> [T; 3] {
    let [a5, a6, a7] = wrist.map(T::sin_cos);
    let [x, y, z] = *point_m;
    let about_z = |(sin, cos): (T, T), [x, y, z]: [T; 3]| [x * cos - y * sin, x * sin + y * cos, z];
    let [x, y, z] = about_z(a7, [x, y, z + d7].map(T::constant));
    let (sin6, cos6) = a6;
    let [x, y, z] = about_z(a5, [x * cos6 + z * sin6, y, z * cos6 - x * sin6]);
    [x, y, z + *d5]
}

impl FlangePoint {
    /// The point, on the side of shoulder and elbow on which it is at these joints.
    #[must_use]
    pub fn new(robot: &Robot, point_m: [f64; 3], joints_rad: &Joints) -> Self {
        let [_, a2, a3, a4, a5, a6, a7] = *joints_rad;
        let d = robot.offsets();
        let [x, y, z] = from_elbow(&d, &point_m, [a5, a6, a7]);
        let (sin4, cos4) = a4.sin_cos();
        let across = x * cos4 - z * sin4;
        let up = x * sin4 + z * cos4 + d[1];
        let (sin3, cos3) = a3.sin_cos();
        let ahead = (across * cos3 - y * sin3) * a2.cos() + up * a2.sin();
        let sign = |value: f64| if value < 0.0 { -1.0 } else { 1.0 };
        Self { point_m, elbow: sign(across), ahead: sign(ahead) }
    }

    /// The joints, in rad, that bring it to a place in the base frame, in m, with joint A3 and the wrist's joints A5 to A7
    /// at these positions. Limits of the joints are not checked.
    ///
    /// Derivatives are not finite where the point is as far from the shoulder as can be, or on the border of what is within
    /// reach with this position of A3.
    ///
    /// # Errors
    ///
    /// If the point does not reach there.
    pub fn joints_at<T: Number>(
        &self,
        robot: &Robot,
        place_m: &[T; 3],
        e1: T,
        wrist: [T; 3],
    ) -> Result<[T; 7], Unreachable> {
        let d = robot.offsets();
        let [d1, d3, ..] = d;
        let [x, y, z] = from_elbow(&d, &self.point_m, wrist);
        let place = [place_m[0], place_m[1], place_m[2] + -d1];
        let aside = place[0] * place[0] + place[1] * place[1];
        let distance = aside + place[2] * place[2];
        // Along the upper arm from the elbow, and across it.
        let lever = x * x + z * z;
        let along = (distance - lever - y * y + -(d3 * d3)) * (0.5 / d3);
        let across_square = lever - along * along;
        if across_square.value() < 0.0 {
            return Err(out_of_reach(d3, [distance, lever, y].map(T::value)));
        }
        let across = across_square.sqrt() * self.elbow;
        let (sin3, cos3) = e1.sin_cos();
        let v = [across * cos3 - y * sin3, across * sin3 + y * cos3, along + d3];
        let ahead_square = aside - v[1] * v[1];
        if ahead_square.value() < 0.0 {
            let by_mm = 1e3 * (v[1].value().abs() - aside.value().sqrt());
            return Err(Unreachable::NearAxis { e1_rad: e1.value(), by_mm });
        }
        let ahead = ahead_square.sqrt() * self.ahead;
        let a1 = T::atan2(place[1] * ahead - place[0] * v[1], place[0] * ahead + place[1] * v[1]);
        let a2 = T::atan2(ahead * v[2] - place[2] * v[0], place[2] * v[2] + ahead * v[0]);
        let a4 = T::atan2(along * x - across * z, across * x + along * z);
        let [a5, a6, a7] = wrist;
        Ok([a1, a2, e1, a4, a5, a6, a7])
    }
}

#[cold]
fn out_of_reach(d3: f64, [distance, lever, y]: [f64; 3]) -> Unreachable {
    let reach = |sign: f64| {
        let along = sign.mul_add(lever.sqrt(), d3);
        along.hypot(y)
    };
    let distance = distance.sqrt();
    if distance > reach(1.0) - ROUNDING_M {
        Unreachable::TooFar { by_mm: 1e3 * (distance - reach(1.0)).max(0.0) }
    } else {
        Unreachable::TooNear { by_mm: 1e3 * (reach(-1.0) - distance).max(0.0) }
    }
}
