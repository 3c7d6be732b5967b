//! Retiming of goals.

use std::str::FromStr;

use iiwa_kin::{Joints, Robot};
use iiwa_link::{TimedJoints, message::Code};
use iiwa_program::MotionLimits;
use iiwa_traj::Trajectory;

use super::goal::Goal;
use crate::retime::retime;

/// Samples per second of a retimed motion: a drive requires at least 40.
const RATE_HZ: f64 = 200.0;

/// Condition for the retiming of goals on their path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RetimeGoals {
    /// Retime goals that violate limits with their own times: ROS planners do not consider jerk.
    #[default]
    Needed,
    /// Retime all goals.
    Always,
    /// Retime no goals: those that violate limits are refused.
    Never,
}

impl FromStr for RetimeGoals {
    type Err = ();

    fn from_str(text: &str) -> Result<Self, ()> {
        match text {
            "needed" => Ok(Self::Needed),
            "always" => Ok(Self::Always),
            "never" => Ok(Self::Never),
            _ => Err(()),
        }
    }
}

impl RetimeGoals {
    /// Returns the name as a value of the node parameter.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Needed => "needed",
            Self::Always => "always",
            Self::Never => "never",
        }
    }
}

/// Retiming settings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Retiming {
    pub(super) when: RetimeGoals,
    /// Maximum deviation from the goal's path, in rad in joint space.
    pub(super) tolerance_rad: f64,
}

/// The motion to be sent to the drive.
#[derive(Clone, Debug)]
pub(super) struct Prepared {
    pub(super) motion: TimedJoints,
    /// Remark for people; may be empty.
    pub(super) remark: String,
}

/// Returns the motion of a goal, retimed if necessary. A retimed motion is at least as long as the
/// goal's own times.
///
/// # Errors
///
/// The reason why the goal cannot be retimed, as text for people.
pub(super) fn prepare(
    robot: &Robot,
    goal: &Goal,
    retiming: &Retiming,
    from: Option<&Joints>,
) -> Result<Prepared, String> {
    for (i, point) in goal.points.iter().enumerate() {
        let outside = robot.limits().check(&point.q);
        outside.map_err(|outside| format!("point {}: {outside}", i + 1))?;
    }
    let first = goal.points.first().map(|point| point.q).unwrap_or_default();
    let motion = goal.motion(from.unwrap_or(&first));
    let fault = match retiming.when {
        RetimeGoals::Never => None,
        RetimeGoals::Always => Some(String::new()),
        RetimeGoals::Needed => {
            let start = motion.joints_rad.first().copied().unwrap_or_default();
            let refusal = motion.check(robot.limits(), &start).err();
            refusal.filter(|refusal| refusal.code == Code::Limit).map(|refusal| refusal.message)
        }
    };
    let Some(fault) = fault else { return Ok(Prepared { motion, remark: String::new() }) };
    let limits = MotionLimits::full(robot);
    let retimed = retime(robot, limits, &motion.joints_rad, retiming.tolerance_rad)
        .map_err(|error| error.to_string())?;
    let planned_s = motion.duration_s();
    let new = sampled(&retimed.trajectory, planned_s);
    let mut remark = format!(
        "the trajectory got new times on its path: {:.3} s instead of {planned_s:.3} s; the arm \
         passed its points within {:.4} rad",
        new.duration_s(),
        retimed.deviation_rad
    );
    if !fault.is_empty() {
        remark.push_str("; with its own times, ");
        remark.push_str(&fault);
    }
    Ok(Prepared { motion: new, remark })
}

/// Samples a trajectory for the drive, slowed down uniformly if its duration is below `min_s`,
/// because a requested slow motion must remain slow.
fn sampled(trajectory: &Trajectory, min_s: f64) -> TimedJoints {
    let planned_s = trajectory.cycle_time_s();
    let slower = if planned_s > 0.0 { (min_s / planned_s).max(1.0) } else { 1.0 };
    let mut motion = TimedJoints::default();
    for state in trajectory.samples(RATE_HZ * slower) {
        let t_s = state.t_s * slower;
        // The distance from the last sample to the end may be below the rounding error.
        if motion.t_s.last().is_some_and(|before| t_s - before < 1e-5) {
            motion.t_s.pop();
            motion.joints_rad.pop();
        }
        motion.t_s.push(t_s);
        motion.joints_rad.push(state.q);
    }
    if let [only] = motion.joints_rad[..] {
        motion.t_s.push(min_s.max(1.0 / RATE_HZ));
        motion.joints_rad.push(only);
    }
    motion
}

#[cfg(test)]
mod tests {
    use iiwa_kin::RosNames;

    use super::*;
    use crate::{
        dds::messages::{Duration, FollowGoal, JointTrajectoryPoint},
        retime::DEFAULT_TOLERANCE_RAD,
    };

    fn goal(points: &[(f64, f64)]) -> Goal {
        let arm = RosNames::default().joints();
        let mut goal = FollowGoal::default();
        goal.trajectory.joint_names = arm.to_vec();
        goal.trajectory.points = points
            .iter()
            .map(|(t_s, q)| JointTrajectoryPoint {
                time_from_start: Duration::from_seconds(*t_s),
                ..JointTrajectoryPoint::of_positions(&[*q, 0.0, 0.0, *q, 0.0, 0.0, 0.0])
            })
            .collect();
        Goal::read(&goal, &arm, 0.0).unwrap()
    }

    fn prepared(goal: &Goal, when: RetimeGoals) -> Result<Prepared, String> {
        let retiming = Retiming { when, tolerance_rad: DEFAULT_TOLERANCE_RAD };
        prepare(&Robot::default(), goal, &retiming, None)
    }

    #[test]
    fn trajectories_beyond_limits_are_retimed_within_them() {
        let limits = *Robot::default().limits();
        for (end_s, slow) in [(0.2, false), (5.0, true)] {
            let linear = goal(&[(0.0, 0.0), (0.5 * end_s, 0.3), (end_s, 0.5)]);
            let original = prepared(&linear, RetimeGoals::Never).unwrap();
            assert_eq!(original.motion.check(&limits, &[0.0; 7]).unwrap_err().code, Code::Limit);
            let new = prepared(&linear, RetimeGoals::Needed).unwrap();
            assert_eq!(new.motion.check(&limits, &[0.0; 7]), Ok(()));
            assert!(new.remark.contains("instead of"), "{}", new.remark);
            if slow {
                assert!((new.motion.duration_s() - end_s).abs() < 1e-9);
            } else {
                assert!(new.motion.duration_s() > end_s);
            }
        }
    }

    #[test]
    fn trajectories_within_limits_keep_their_times() {
        let rest = goal(&[(0.0, 0.1), (1.0, 0.1)]);
        let at_rest = prepared(&rest, RetimeGoals::Needed).unwrap();
        assert!(at_rest.remark.is_empty());
        assert_eq!(at_rest.motion.duration_s(), 1.0);
        let always = prepared(&rest, RetimeGoals::Always).unwrap();
        assert_eq!(always.motion.duration_s(), 1.0);
    }

    #[test]
    fn unreachable_points_are_refused() {
        let fault = prepared(&goal(&[(0.0, 0.0), (1.0, 3.1)]), RetimeGoals::Needed).unwrap_err();
        assert!(fault.starts_with("point 2: "), "{fault}");
    }
}
