//! Checks of a trajectory against the robot.

use iiwa_kin::{Joints, Limits};

use super::{differences, points::TimedJoints};
use crate::message::{
    refusal::{Code, Refusal},
    text::Figures,
};

/// Maximum distance of the start of a trajectory from the robot at each joint, in rad: half a
/// degree.
pub const START_TOLERANCE_RAD: f64 = 0.5 * std::f64::consts::PI / 180.0;

/// Maximum step between points while the robot moves, in s. The robot reaches its acceleration
/// limits within 30 to 60 ms: points that are farther apart do not determine the motion between
/// them.
pub const MAX_STEP_S: f64 = 0.025;

/// Maximum duration of a trajectory, in s: a longer one is probably a mistake.
const LONGEST_S: f64 = 24.0 * 3600.0;

impl TimedJoints {
    /// Checks that a robot at rest at `start_rad`, in rad, can run this trajectory.
    ///
    /// The trajectory has to be well-formed, with finite numbers and strictly increasing time
    /// stamps; to start within [`START_TOLERANCE_RAD`] of the robot; to stay within the joint
    /// ranges; and to satisfy the velocity, acceleration and jerk limits with
    /// [`MARGINS`](crate::MARGINS), from rest at its start to rest at its end. These limits are
    /// checked by divided differences of the points over 1 to 24 ms, with an allowance for
    /// positions and stamps that are rounded to six decimals. While the robot moves, points are at
    /// most [`MAX_STEP_S`] apart.
    ///
    /// # Errors
    ///
    /// [`Code::BadRequest`], [`Code::StartMismatch`] or [`Code::Limit`], with the first fault and
    /// its position.
    ///
    /// ```
    /// use iiwa_kin::Robot;
    /// use iiwa_link::{TimedJoints, message::Code};
    ///
    /// let at_rest = TimedJoints { t_s: vec![0.0, 1.0], joints_rad: vec![[0.1; 7]; 2] };
    /// let limits = *Robot::default().limits();
    /// assert_eq!(at_rest.check(&limits, &[0.1; 7]), Ok(()));
    /// let refusal = at_rest.check(&limits, &[0.2; 7]).unwrap_err();
    /// assert_eq!(refusal.code, Code::StartMismatch);
    /// ```
    pub fn check(&self, limits: &Limits, start_rad: &Joints) -> Result<(), Refusal> {
        // First: all other checks rely on two points, increasing stamps and finite numbers.
        self.check_form()?;
        let start = &self.joints_rad[0];
        let off = |j: &usize| (start[*j] - start_rad[*j]).abs();
        let worst = (0..7).max_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(0);
        // A NaN distance is not within the tolerance.
        let is_near = off(&worst) <= START_TOLERANCE_RAD;
        if !is_near {
            return Err(Refusal::new(
                Code::StartMismatch,
                format!(
                    "the trajectory starts with joint A{} at {} deg, the robot is at {} deg; at \
                     most {} deg apart are allowed",
                    worst + 1,
                    Figures(start[worst].to_degrees(), 3),
                    Figures(start_rad[worst].to_degrees(), 3),
                    START_TOLERANCE_RAD.to_degrees()
                ),
            ));
        }
        for (i, q) in self.joints_rad.iter().enumerate() {
            if let Err(outside) = limits.check(q) {
                return Err(Refusal::new(Code::Limit, format!("point {}: {outside}", i + 1)));
            }
        }
        self.check_steps()?;
        differences::check(self, limits)
    }

    fn check_steps(&self) -> Result<(), Refusal> {
        // Stamps are sums: allow for rounding.
        const LONGEST_STEP_S: f64 = MAX_STEP_S + 1e-6;
        let step_s = |i: usize| self.t_s[i + 1] - self.t_s[i];
        let is_far = |i: &usize| step_s(*i) > LONGEST_STEP_S && !self.rests_after(*i);
        match (0..self.t_s.len() - 1).find(is_far) {
            None => Ok(()),
            Some(i) => Err(Refusal::bad(format!(
                "point {}: {} s after the one before; while the arm moves, at most {MAX_STEP_S} s \
                 are allowed",
                i + 2,
                Figures(step_s(i), 4)
            ))),
        }
    }

    /// Returns true if the robot is at rest from a point to the next one.
    fn rests_after(&self, i: usize) -> bool {
        self.joints_rad[i] == self.joints_rad[i + 1]
    }

    fn check_form(&self) -> Result<(), Refusal> {
        let (stamps, points) = (self.t_s.len(), self.joints_rad.len());
        if stamps != points {
            return Err(Refusal::bad(format!(
                "the trajectory has {stamps} stamps and {points} points; give one stamp per point"
            )));
        }
        if points < 2 {
            return Err(Refusal::bad(format!(
                "the trajectory has {points} points; at least 2 are required"
            )));
        }
        let finite =
            |i: usize| self.t_s[i].is_finite() && self.joints_rad[i].iter().all(|q| q.is_finite());
        if let Some(i) = (0..points).find(|&i| !finite(i)) {
            return Err(Refusal::bad(format!(
                "point {} contains a value that is not finite",
                i + 1
            )));
        }
        if let Some(i) = (1..points).find(|&i| self.t_s[i] <= self.t_s[i - 1]) {
            return Err(Refusal::bad(format!(
                "point {}: its stamp, {:?} s, is not later than the one before, {:?} s",
                i + 1,
                self.t_s[i],
                self.t_s[i - 1]
            )));
        }
        if self.duration_s() > LONGEST_S {
            return Err(Refusal::bad(format!(
                "the trajectory takes {} s; at most a day, {LONGEST_S} s, is allowed",
                Figures(self.duration_s(), 0)
            )));
        }
        Ok(())
    }
}
