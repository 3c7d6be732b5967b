//! Reachable positions of joint A3 for a pose.

use std::f64::consts::PI;

use crate::{
    Joint, Pose, Robot,
    inverse::arm_at,
    redundancy::Status,
    unreachable::{Unreachable, e1_ranges},
};

/// Steps per turn of E1 at which the joint ranges are sampled. Ranges and gaps narrower than a
/// step, half a degree, are found only if A1 or A2 bounds them.
const STEPS: u32 = 720;

/// Resolution of the ends of ranges, in rad. A condition that holds there holds within the rounding
/// of a limit.
const RESOLUTION_RAD: f64 = 1e-10;

impl Robot {
    /// Ranges of E1, in rad from -pi to pi, in which the pose is within reach, regardless of the
    /// joint ranges. Either the whole turn, or neighbourhoods of 0 and of half a turn: |sin E1| <=
    /// rho / (d5 |sin A4|), with rho the distance of the wrist from the base axis.
    ///
    /// ```
    /// use iiwa_kin::Robot;
    ///
    /// let robot = Robot::lbr_iiwa_7_r800();
    /// let flange = robot.flange_pose(&[0.0, 0.1, 0.5, -1.5, 0.0, 0.7, 0.0]);
    /// let ranges = robot.reachable_e1(&flange)?;
    /// assert!(ranges.iter().any(|[from, to]| (*from..=*to).contains(&0.5)));
    /// # Ok::<(), iiwa_kin::Unreachable>(())
    /// ```
    ///
    /// # Errors
    ///
    /// If the pose is out of reach.
    pub fn reachable_e1(&self, flange: &Pose) -> Result<Vec<[f64; 2]>, Unreachable> {
        let arm = arm_at(&self.offsets(), flange)?;
        Ok(e1_ranges(arm.within_rad()))
    }

    /// Ranges of E1, in rad, in which the pose is within reach with the configuration `status` and
    /// all joints are within their ranges. Empty if no such range exists.
    ///
    /// Range ends set by A1, A2, A3 or the reach are found however close together; for the
    /// other joints, E1 is sampled every half degree.
    ///
    /// # Errors
    ///
    /// If the pose is out of reach regardless of the joint ranges.
    pub fn allowed_e1(&self, flange: &Pose, status: Status) -> Result<Vec<[f64; 2]>, Unreachable> {
        let arm = arm_at(&self.offsets(), flange)?;
        let allowed = |e1: f64| {
            let joints = self.inverse(flange, e1, status);
            joints.is_ok_and(|joints| self.limits().check(&joints).is_ok())
        };

        let mut candidates = self.ends(&arm.wrist_m, arm.sin_a4 * status.signs()[1], arm.cos_a4);
        candidates.extend(e1_ranges(arm.within_rad()).as_flattened());
        candidates.extend((0..=STEPS).map(|k| PI * (f64::from(2 * k) / f64::from(STEPS) - 1.0)));
        let [lower, upper] = self.limits().range_rad(Joint::A3).map(|limit| limit.clamp(-PI, PI));
        candidates.extend([lower, upper]);
        candidates.retain(|e1| (lower..=upper).contains(e1));
        candidates.sort_by(f64::total_cmp);
        candidates.dedup();

        // A candidate may be the end of a range only up to rounding, so the midpoint between two
        // candidates decides.
        let mut ranges: Vec<[f64; 2]> = Vec::new();
        let mut open: Option<[f64; 2]> = None;
        for pair in candidates.windows(2) {
            let (from, to) = (pair[0], pair[1]);
            let middle = 0.5 * (from + to);
            if !allowed(middle) {
                ranges.extend(open.take());
                continue;
            }
            let end = border(&allowed, middle, to);
            match &mut open {
                // It is open because `from` is allowed.
                Some(range) => range[1] = end,
                None => open = Some([border(&allowed, middle, from), end]),
            }
            if end < to {
                ranges.extend(open.take());
            }
        }
        ranges.extend(open);
        Ok(ranges)
    }

    /// E1 at which A1 or A2 may cross a limit, in closed form.
    fn ends(&self, wrist_m: &[f64; 3], sin_a4: f64, cos_a4: f64) -> Vec<f64> {
        let [_, upper_arm, forearm, _] = self.offsets();
        let [x, y, z] = *wrist_m;
        let lever = forearm * sin_a4;
        let mut ends = Vec::new();
        for limit in self.limits().range_rad(Joint::A1) {
            let (sin, cos) = limit.sin_cos();
            let e1 = ((x * sin - y * cos) / lever).asin();
            ends.extend([e1, PI - e1, -PI - e1]);
        }
        for limit in self.limits().range_rad(Joint::A2) {
            let (sin, cos) = limit.sin_cos();
            let e1 = ((z - (upper_arm + forearm * cos_a4) * cos) / (lever * sin)).acos();
            ends.extend([e1, -e1]);
        }
        // The result is NaN if the limit is never crossed.
        ends.retain(|e1| e1.is_finite());
        ends
    }
}

/// Last value from `inside` towards `end` for which `holds` is true, by bisection: `end` itself, or
/// within [`RESOLUTION_RAD`].
fn border(holds: &impl Fn(f64) -> bool, inside: f64, end: f64) -> f64 {
    if holds(end) {
        return end;
    }
    let (mut inside, mut outside) = (inside, end);
    while (outside - inside).abs() > RESOLUTION_RAD {
        let middle = 0.5 * (inside + outside);
        if holds(middle) {
            inside = middle;
        } else {
            outside = middle;
        }
    }
    inside
}
