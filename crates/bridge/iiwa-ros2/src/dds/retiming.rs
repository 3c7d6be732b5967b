//! Whether a goal runs with its own times or with new ones.

use std::str::FromStr;

use iiwa_kin::{Joints, Robot};
use iiwa_link::{TimedJoints, message::Code};
use iiwa_program::MotionLimits;
use iiwa_traj::Trajectory;

use super::goal::Goal;
use crate::retime::retime;

/// Samples a second of a motion with new times: a drive asks for 40 at least.
const RATE_HZ: f64 = 200.0;

/// When a goal gets new times on its path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RetimeGoals {
    /// If it breaks limits with its own: planners of ROS know none of jerk.
    #[default]
    Needed,
    /// In any case.
    Always,
    /// Never: what breaks limits is refused.
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
    /// Its name as a value of the node's parameter.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Needed => "needed",
            Self::Always => "always",
            Self::Never => "never",
        }
    }
}

/// How a goal gets new times.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Retiming {
    pub(super) when: RetimeGoals,
    /// How far the arm may pass the goal's path, in rad in joint space.
    pub(super) tolerance_rad: f64,
}

/// What is sent to the drive.
#[derive(Clone, Debug)]
pub(super) struct Prepared {
    pub(super) motion: TimedJoints,
    /// For people; empty if there is nothing to say.
    pub(super) remark: String,
}

/// The motion of a goal, with new times if it needs them. It does not take less time than the goal gives.
///
/// # Errors
///
/// Why it gets no times, for people.
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
    let own_s = motion.duration_s();
    let new = sampled(&retimed.trajectory, own_s);
    let mut remark = format!(
        "the trajectory got new times on its path: {:.3} s instead of {own_s:.3} s; the arm passed its points within {:.4} rad",
        new.duration_s(),
        retimed.deviation_rad
    );
    if !fault.is_empty() {
        remark.push_str("; with its own times, ");
        remark.push_str(&fault);
    }
    Ok(Prepared { motion: new, remark })
}

/// A trajectory as points for the drive, slowed down evenly if it takes less than `least_s`: who asks for a slow motion gets
/// one.
fn sampled(trajectory: &Trajectory, least_s: f64) -> TimedJoints {
    let own_s = trajectory.cycle_time_s();
    let slower = if own_s > 0.0 { (least_s / own_s).max(1.0) } else { 1.0 };
    let mut motion = TimedJoints::default();
    for state in trajectory.samples(RATE_HZ * slower) {
        let t_s = state.t_s * slower;
        // The end may follow the last sample by less than rounding.
        if motion.t_s.last().is_some_and(|before| t_s - before < 1e-5) {
            motion.t_s.pop();
            motion.joints_rad.pop();
        }
        motion.t_s.push(t_s);
        motion.joints_rad.push(state.q);
    }
    if let [only] = motion.joints_rad[..] {
        motion.t_s.push(least_s.max(1.0 / RATE_HZ));
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
    fn what_breaks_limits_gets_new_times_and_keeps_them() {
        let limits = *Robot::default().limits();
        for (end_s, slow) in [(0.2, false), (5.0, true)] {
            let linear = goal(&[(0.0, 0.0), (0.5 * end_s, 0.3), (end_s, 0.5)]);
            let own = prepared(&linear, RetimeGoals::Never).unwrap();
            assert_eq!(own.motion.check(&limits, &[0.0; 7]).unwrap_err().code, Code::Limit);
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
    fn what_keeps_limits_keeps_its_times() {
        let rest = goal(&[(0.0, 0.1), (1.0, 0.1)]);
        let own = prepared(&rest, RetimeGoals::Needed).unwrap();
        assert!(own.remark.is_empty());
        assert_eq!(own.motion.duration_s(), 1.0);
        let always = prepared(&rest, RetimeGoals::Always).unwrap();
        assert_eq!(always.motion.duration_s(), 1.0);
    }

    #[test]
    fn what_is_out_of_reach_is_refused() {
        let fault = prepared(&goal(&[(0.0, 0.0), (1.0, 3.1)]), RetimeGoals::Needed).unwrap_err();
        assert!(fault.starts_with("point 2: "), "{fault}");
    }
}
