//! Closed-form inverse kinematics: the joint positions that reach a pose.
//!
//! With the position of joint A3 given (Sunrise's E1), six joints are left. The distance of the
//! wrist from the shoulder gives A4; its height and its azimuth about the vertical axis give A1 and
//! A2; the remaining orientation gives A5 to A7. Each step has two solutions, which the three bits
//! of [`Status`] select.
//!
//! One generic function serves plain numbers and Taylor series. It computes with sines and cosines,
//! each a quotient of known lengths, and takes all angles at the end.

#![expect(
    clippy::inline_always,
    reason = "kernels must be inlined where their numbers are known to be plain or Taylor series"
)]

use crate::{
    Joints, MovingPose, Pose, Robot, Taylor,
    number::Number,
    redundancy::Status,
    rotation::{cross, dot},
    unreachable::Unreachable,
};

/// Distance beyond the reach, in m, that is still accepted. A millionth of a millimetre: poses at
/// the border of the reach must not fail because their text form is rounded.
const ROUNDING_M: f64 = 1e-9;

/// Threshold (in m, or as a sine) below which two axes count as aligned. Only the sum of their
/// joint positions is then defined; the first of the two joints is set to 0.
const IN_LINE: f64 = 1e-12;

impl Robot {
    /// Joint positions, in rad, that bring the flange to a pose in the base frame, with joint A3 at
    /// `e1_rad` and the configuration selected by `status`. Joint ranges are not checked; A1, A2
    /// and A4 to A7 are between -pi and pi.
    ///
    /// If A6 is 0 (to 1e-12), A5 is set to 0; if the wrist is above the base, A1 is set to 0.
    ///
    /// ```
    /// use iiwa_kin::Robot;
    ///
    /// let robot = Robot::lbr_iiwa_7_r800();
    /// let joints = [0.3, 0.5, 0.2, -1.0, 0.4, 0.7, -0.1];
    /// let redundancy = robot.redundancy(&joints);
    /// let flange = robot.flange_pose(&joints);
    /// let again = robot.inverse(&flange, redundancy.e1_rad, redundancy.status)?;
    /// assert!((0..7).all(|j| (again[j] - joints[j]).abs() < 1e-12));
    /// # Ok::<(), iiwa_kin::Unreachable>(())
    /// ```
    ///
    /// # Errors
    ///
    /// If no joint positions reach the pose, or none with this E1.
    pub fn inverse(
        &self,
        flange: &Pose,
        e1_rad: f64,
        status: Status,
    ) -> Result<Joints, Unreachable> {
        solve(&self.offsets(), &flange.position_m, &flange.rotation, e1_rad, status)
    }

    /// Joint positions, in rad, and their first three derivatives for a moving flange and E1. The
    /// values equal those of [`inverse`](Self::inverse) at every value of the parameter.
    ///
    /// At a singularity ([`Robot::singularity`]) the derivatives are not finite.
    ///
    /// # Errors
    ///
    /// If no joint positions reach the pose, or none with this E1.
    pub fn inverse_moving(
        &self,
        flange: &MovingPose,
        e1: Taylor,
        status: Status,
    ) -> Result<[Taylor; 7], Unreachable> {
        solve(&self.offsets(), &flange.position_m, &flange.rotation, e1, status)
    }
}

/// Wrist position relative to the shoulder, in base directions, with the squares of its distances
/// from the vertical axis and from the shoulder.
#[inline(always)]
fn wrist<T: Number>(d: &[f64; 4], position: &[T; 3], rotation: &[[T; 3]; 3]) -> ([T; 3], T, T) {
    let w = [
        position[0] + rotation[0][2] * -d[3],
        position[1] + rotation[1][2] * -d[3],
        position[2] + rotation[2][2] * -d[3] + -d[0],
    ];
    let aside = w[0] * w[0] + w[1] * w[1];
    (w, aside, aside + w[2] * w[2])
}

/// Sine (above 0) and cosine of A4 from the squared distance between wrist and shoulder, by the law
/// of cosines. Uses square roots of sums and differences because `acos` would lose half of the
/// digits near 0.
#[inline(always)]
fn elbow<T: Number>([_, d3, d5, _]: &[f64; 4], distance: T) -> Result<(T, T), Unreachable> {
    let (longest, shortest) = (d3 + d5, d3 - d5);
    let mut to_stretched = -distance + longest * longest;
    let mut to_folded = distance + -(shortest * shortest);
    if to_stretched.value() < 0.0 || to_folded.value() < 0.0 {
        check_distance(distance.value().sqrt(), longest, shortest.abs())?;
        let (none, all) = (T::constant(0.0), T::constant(4.0 * d3 * d5));
        (to_stretched, to_folded) =
            if to_stretched.value() < 0.0 { (none, all) } else { (all, none) };
    }
    let per = (2.0 * d3 * d5).recip();
    let sin = to_stretched.sqrt() * to_folded.sqrt() * per;
    Ok((sin, (to_folded - to_stretched) * (0.5 * per)))
}

#[cold]
fn check_distance(distance: f64, longest: f64, shortest: f64) -> Result<(), Unreachable> {
    if distance > longest + ROUNDING_M {
        return Err(Unreachable::too_far("wrist", distance, longest));
    }
    if distance < shortest - ROUNDING_M {
        return Err(Unreachable::too_near("wrist", distance, shortest));
    }
    Ok(())
}

/// Arm geometry that a pose fixes before E1 is chosen.
pub(crate) struct ArmGeometry {
    /// Wrist position relative to the shoulder.
    pub(crate) wrist_m: [f64; 3],
    /// |sin A4|; the status selects its sign.
    pub(crate) sin_a4: f64,
    pub(crate) cos_a4: f64,
    /// d5 |sin A4|: the largest distance of the wrist from the plane of A1 and A2.
    lever_m: f64,
}

impl ArmGeometry {
    /// Largest deviation of E1 from 0 or from half a turn, in rad; a quarter turn if every E1 is
    /// possible.
    pub(crate) fn within_rad(&self) -> f64 {
        let [x, y, _] = self.wrist_m;
        x.hypot(y).atan2((self.lever_m * self.lever_m - x * x - y * y).max(0.0).sqrt())
    }
}

/// Arm geometry at a flange pose; an error if the pose is out of reach.
pub(crate) fn arm_at(d: &[f64; 4], flange: &Pose) -> Result<ArmGeometry, Unreachable> {
    let (wrist_m, _, distance) = wrist(d, &flange.position_m, &flange.rotation);
    let (sin_a4, cos_a4) = elbow(d, distance)?;
    Ok(ArmGeometry { wrist_m, sin_a4, cos_a4, lever_m: d[2] * sin_a4 })
}

#[inline(always)]
fn solve<T: Number>(
    d: &[f64; 4],
    position: &[T; 3],
    rotation: &[[T; 3]; 3],
    e1: T,
    status: Status,
) -> Result<[T; 7], Unreachable> {
    let [_, d3, d5, _] = *d;
    let [ahead_sign, a4_sign, a6_sign] = status.signs();
    let (zero, one) = (T::constant(0.0), T::constant(1.0));
    let (w, aside, distance) = wrist(d, position, rotation);

    let (sin4, cos4) = elbow(d, distance)?;
    let sin4 = sin4 * a4_sign;

    // The wrist in the frame rotated by A1 and A2 is v; in the frame rotated by A1 alone, (ahead,
    // v[1], w[2]).
    let (sin3, cos3) = e1.sin_cos();
    let lever = sin4 * -d5;
    let mut v = [lever * cos3, lever * sin3, cos4 * d5 + d3];
    let mut ahead_square = aside - v[1] * v[1];
    if ahead_square.value() < 0.0 {
        let border = aside.sqrt();
        let beyond_m = v[1].value().abs() - border.value();
        if beyond_m > ROUNDING_M {
            let within_rad = (border.value() / lever.value().abs()).asin();
            return Err(Unreachable::E1 { e1_rad: e1.value(), within_rad });
        }
        v[1] = if v[1].value() < 0.0 { -border } else { border };
        ahead_square = zero;
    }
    let ahead = ahead_square.sqrt() * ahead_sign;

    let (sin1, cos1) = if aside.value() > IN_LINE * IN_LINE {
        let per = one / aside;
        ((w[1] * ahead - w[0] * v[1]) * per, (w[0] * ahead + w[1] * v[1]) * per)
    } else {
        (zero, one)
    };
    let square = ahead_square + w[2] * w[2];
    let (sin2, cos2) = if square.value() > IN_LINE * IN_LINE {
        let per = one / square;
        ((ahead * v[2] - w[2] * v[0]) * per, (w[2] * v[2] + ahead * v[0]) * per)
    } else {
        (zero, one)
    };

    // Frame of the forearm: z along the forearm, y along the axis of A4.
    let upper_arm = [cos1 * sin2, sin1 * sin2, cos2];
    let z: [T; 3] = std::array::from_fn(|i| (w[i] - upper_arm[i] * d3) * d5.recip());
    let turned = sin3 * cos2;
    let y = [-(turned * cos1 + cos3 * sin1), cos3 * cos1 - turned * sin1, sin3 * sin2];
    let x = cross(&y, &z);

    // The flange orientation relative to that frame is a rotation about z, y and z.
    let axis = |k: usize| [rotation[0][k], rotation[1][k], rotation[2][k]];
    let flange_z = axis(2);
    let (along_x, along_y) = (dot(&x, &flange_z), dot(&y, &flange_z));
    let square = along_x * along_x + along_y * along_y;
    let cos6 = dot(&z, &flange_z);
    let (sin6, sin5, cos5) = if square.value() > IN_LINE * IN_LINE {
        let length = square.sqrt();
        let per = one / length * a6_sign;
        (length * a6_sign, along_y * per, along_x * per)
    } else {
        (zero, zero, one)
    };
    // A7 is measured from the axis of A6. This holds even near A6 = 0, where A5 is ill-conditioned
    // and only the sum of A5 and A7 is defined.
    let axis6 = std::array::from_fn(|i| y[i] * cos5 - x[i] * sin5);
    let (sin7, cos7) = (dot(&axis6, &axis(0)), dot(&axis6, &axis(1)));

    let [a1, a2, a4, a5, a6, a7] =
        T::angles(&[sin1, sin2, sin4, sin5, sin6, sin7], &[cos1, cos2, cos4, cos5, cos6, cos7]);
    Ok([a1, a2, e1, a4, a5, a6, a7])
}
