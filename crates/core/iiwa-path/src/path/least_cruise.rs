//! The speed limit of short LIN and CIRC motions.

use std::sync::Arc;

use iiwa_kin::vector;
use iiwa_program::{LimitKind, MotionLimits, MotionType};

use super::JointPath;
use crate::{segment::Segment, step::Step};

/// Values of s at which the largest TCP speed within the joint velocity limits is computed.
const PLACES: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];

/// Upper bound on the ratio of the maximum of this speed along the motion to its maximum at these
/// places.
const BETWEEN: f64 = 1.5;

/// Relative difference of speeds that is rounding.
const ROUNDING: f64 = 1e-9;

impl JointPath {
    /// Returns the path with one more limit: on a LIN or CIRC motion from rest to rest, the TCP
    /// speed is at most the path length over `seconds`. Returns `None` if no motion could exceed
    /// this limit.
    #[must_use]
    pub fn with_least_cruise(&self, seconds: f64) -> Option<Self> {
        let moves = |step: Option<usize>| {
            step.and_then(|step| self.steps.get(step)).is_some_and(Step::moves)
        };
        let mut steps: Option<Vec<Step>> = None;
        for (i, step) in self.steps.iter().enumerate() {
            let Step::Move { motion, segment, blend: None, .. } = step else { continue };
            let is_of_tcp = matches!(
                self.motion_type(*motion),
                Some(MotionType::Lin | MotionType::LinRel | MotionType::Circ)
            );
            if !is_of_tcp || moves(i.checked_sub(1)) || moves(Some(i + 1)) {
                continue;
            }
            let limits = self.limits_of(i);
            let [way_m, ..] = segment.tool_way(0.0).way_m;
            let speed = way_m / seconds;
            // A limit that cannot become active is left out, so that the path can be shared. One
            // that equals the program's can become active.
            let least = speed * (1.0 - ROUNDING);
            if !segment.has_even_tool_way() || top_speed(segment.as_ref(), limits) < least {
                continue;
            }
            let limited = Some(Arc::new(limits.with_minimum_duration(speed)));
            let steps = steps.get_or_insert_with(|| self.steps.to_vec());
            if let Step::Move { limits, .. } = &mut steps[i] {
                *limits = limited;
            }
        }
        Some(Self { steps: Arc::new(steps?), ..self.clone() })
    }
}

/// Returns an upper bound on the TCP speed within the velocity limits, in m/s, on a path with
/// constant dl/ds.
fn top_speed(segment: &dyn Segment, limits: &MotionLimits) -> f64 {
    let joints = PLACES.map(|s| {
        let [way_m, ..] = segment.tool_way(s).way_m;
        way_m * vector::largest_multiple(&segment.at(s).dq, limits.velocity_rad_s())
    });
    let joints = BETWEEN * joints.into_iter().fold(0.0, f64::max);
    joints.min(limits.tool().way[LimitKind::Velocity])
}

#[cfg(test)]
mod tests {
    use super::*;
    use iiwa_kin::Robot;
    use iiwa_program::Program;

    fn path(second_mm: f64, blend: bool) -> JointPath {
        let blend = if blend { r#", "blend": {"cart_mm": 5}"# } else { "" };
        let program = Program::from_json(&format!(
            r#"{{"version": 1, "start": {{"joints_deg": [0, 30, 0, -80, 0, 60, 0]}}, "motions": [
                {{"type": "lin_rel", "offset": {{"z_mm": 30}}{blend}}},
                {{"type": "lin_rel", "offset": {{"x_mm": {second_mm}}}}}]}}"#
        ));
        JointPath::new(&program.unwrap(), &Robot::default()).unwrap()
    }

    #[test]
    fn short_motions_from_rest_to_rest_are_slower() {
        let path = path(150.0, false);
        let slower = path.with_least_cruise(0.2).unwrap();
        let limit = |step: usize| slower.limits_of(step).tool().way[LimitKind::Velocity];
        let moves: Vec<usize> =
            (0..path.steps().len()).filter(|step| path.steps()[*step].moves()).collect();
        assert!((limit(moves[0]) - 0.15).abs() < 1e-9);
        assert!((limit(moves[1]) - 0.75).abs() < 1e-9);
        // In 0.01 s, the velocity limits of the joints are lower.
        assert!(path.with_least_cruise(0.01).is_none());
    }

    #[test]
    fn motions_that_go_on_are_not() {
        assert!(path(60.0, true).with_least_cruise(0.2).is_none());
    }
}
