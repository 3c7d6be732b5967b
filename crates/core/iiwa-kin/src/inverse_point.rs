//! Inverse kinematics of a point: joints A1, A2 and A4 that bring a point of the flange to a
//! position, with A3 and the wrist joints A5 to A7 given.
//!
//! The point is at a fixed distance from the elbow, so A4 follows from its distance from the
//! shoulder; its height and its azimuth about the vertical axis give A1 and A2, as the wrist
//! position does in [`inverse`](mod@crate::inverse).

use crate::{Joints, Robot, number::Number, unreachable::Unreachable};

/// Distance beyond the reach, in m, that is still attributed to rounding.
const ROUNDING_M: f64 = 1e-9;

/// A point fixed to the flange, with the side of shoulder and elbow on which the arm keeps it.
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
    /// Position in the flange frame, in m.
    point_m: [f64; 3],
    /// Signs, 1 or -1: the side of the upper arm to which the elbow bends, and the side of A1 on
    /// which the point is.
    elbow: f64,
    ahead: f64,
}

/// Position of the point relative to the elbow, in forearm directions.
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
    /// Creates the point with the shoulder and elbow sides that it has at these joint positions.
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

    /// Joint positions, in rad, that bring the point to a position in the base frame, in m, with
    /// joint A3 and the wrist joints A5 to A7 given. Joint ranges are not checked.
    ///
    /// Derivatives are not finite at the largest distance from the shoulder, or at the border of
    /// the reach for this position of A3.
    ///
    /// # Errors
    ///
    /// If the position is out of reach.
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
        // Components of the point position along and across the upper arm, from the elbow.
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
        Unreachable::too_far("TCP", distance, reach(1.0))
    } else {
        Unreachable::too_near("TCP", distance, reach(-1.0))
    }
}
