//! Goals of `FollowJointTrajectory`: parsing, and interpolation between their points.

use iiwa_kin::{Joints, hermite};
use iiwa_link::{MAX_STEP_S, TimedJoints};

use super::{
    messages::{FollowGoal, JointTolerance},
    path_joints::JointOrder,
};

/// Maximum number of points of a goal.
const MAX_POINTS: usize = 20_000;

/// Maximum duration of a goal, in s: its samples are fewer than the maximum number of points of a
/// drive.
const LONGEST_S: f64 = 900.0;

/// Maximum start delay of a goal, in s, because the clocks of two machines differ. Goals with a
/// later start are refused.
const LATEST_START_S: f64 = 1.0;

/// Time between samples: less than the maximum step of a drive, and commensurate with common FRI
/// cycle times.
const SAMPLE_S: f64 = 0.005;

/// A point of a goal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct GoalPoint {
    /// Time after the start, in s.
    pub(super) t_s: f64,
    pub(super) q: Joints,
    /// Velocities, if given.
    dq: Option<Joints>,
    ddq: Option<Joints>,
}

/// A well-formed goal.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Goal {
    pub(super) points: Vec<GoalPoint>,
    /// Tolerance of each joint about the last point at the end, in rad, if given.
    tolerance_rad: [Option<f64>; 7],
}

impl Goal {
    /// Parses a message, for a robot with these joints, at a time in s since 1970.
    ///
    /// # Errors
    ///
    /// The fault, as text for people.
    pub(super) fn read(
        message: &FollowGoal,
        arm: &[String; 7],
        now_s: f64,
    ) -> Result<Self, String> {
        let trajectory = &message.trajectory;
        if !message.multi_dof_trajectory.points.is_empty() {
            return Err("the arm has no joints of several degrees of freedom".to_owned());
        }
        let order = JointOrder::new(arm, &trajectory.joint_names)?;
        if trajectory.points.is_empty() {
            return Err("the trajectory has no points".to_owned());
        }
        if trajectory.points.len() > MAX_POINTS {
            let count = trajectory.points.len();
            return Err(format!(
                "the trajectory has {count} points, at most {MAX_POINTS} are allowed"
            ));
        }
        let stamp = trajectory.header.stamp;
        let ahead_s = stamp.seconds() - now_s;
        if !stamp.is_zero() && ahead_s > LATEST_START_S {
            return Err(format!(
                "the trajectory is to start in {ahead_s:.1} s; send it then, with a stamp of zero"
            ));
        }
        let mut points: Vec<GoalPoint> = Vec::with_capacity(trajectory.points.len());
        for (i, point) in trajectory.points.iter().enumerate() {
            let pick = |quantity: &str, values: &[f64]| {
                order.pick(values).map_err(|fault| format!("point {}: {quantity}: {fault}", i + 1))
            };
            let q = pick("positions", &point.positions)?;
            let q = q.ok_or_else(|| format!("point {} has no positions", i + 1))?;
            let t_s = point.time_from_start.seconds();
            let before = points.last().map_or(-f64::MIN_POSITIVE, |before| before.t_s);
            if t_s <= before || t_s > LONGEST_S {
                return Err(format!(
                    "point {}: time_from_start is {t_s} s; it has to rise from 0 to {LONGEST_S} s \
                     at most",
                    i + 1
                ));
            }
            points.push(GoalPoint {
                t_s,
                q,
                dq: pick("velocities", &point.velocities)?,
                ddq: pick("accelerations", &point.accelerations)?,
            });
        }
        let tolerance_rad = tolerances(arm, &message.goal_tolerance)?;
        Ok(Self { points, tolerance_rad })
    }

    /// Returns the motion from the first point to the last. A goal whose first point is later than
    /// its start begins at `from`, the current position.
    pub(super) fn motion(&self, from: &Joints) -> TimedJoints {
        let rest =
            |t_s: f64, q: Joints| GoalPoint { t_s, q, dq: Some([0.0; 7]), ddq: Some([0.0; 7]) };
        let mut points = Vec::with_capacity(self.points.len() + 1);
        if self.points.first().is_some_and(|first| first.t_s > 0.0) {
            points.push(rest(0.0, *from));
        }
        points.extend_from_slice(&self.points);
        let mut motion = TimedJoints::default();
        let mut add = |t_s, q| {
            motion.t_s.push(t_s);
            motion.joints_rad.push(q);
        };
        for two in points.windows(2) {
            let steps = steps(two[1].t_s - two[0].t_s);
            for step in 0..steps {
                let share = step as f64 / steps as f64;
                let (t_s, q) = between(&two[0], &two[1], share);
                add(t_s, q);
            }
        }
        if let Some(last) = points.last() {
            add(last.t_s, last.q);
            // A single point at the current position is a motion at rest.
            if points.len() == 1 {
                add(last.t_s + MAX_STEP_S, last.q);
            }
        }
        motion
    }

    /// Returns the reason why the robot is not at the goal, if it is not.
    pub(super) fn missed_by(&self, arm: &[String; 7], q: &Joints) -> Option<String> {
        let last = self.points.last()?;
        (0..7).find_map(|j| {
            let (off, tolerance) = ((q[j] - last.q[j]).abs(), self.tolerance_rad[j]?);
            let name = &arm[j];
            (off > tolerance).then(|| {
                format!(
                    "joint `{name}` is {off:.6} rad from the goal; its tolerance is {tolerance} rad"
                )
            })
        })
    }
}

fn tolerances(arm: &[String; 7], requested: &[JointTolerance]) -> Result<[Option<f64>; 7], String> {
    let mut tolerances = [None; 7];
    for JointTolerance { name, position, .. } in requested {
        let j = arm.iter().position(|joint| joint == name);
        let j = j.ok_or_else(|| format!("goal_tolerance: unknown joint `{name}`"))?;
        // Zero means unspecified, and -1 removes a tolerance.
        tolerances[j] = (*position > 0.0).then_some(*position);
    }
    Ok(tolerances)
}

/// Number of samples between two points: dense enough for the drive and for its jerk check.
fn steps(way_s: f64) -> usize {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a number of samples"
    )]
    let steps = (way_s / SAMPLE_S).ceil() as usize;
    steps.max(1)
}

/// Interpolates between two points like `joint_trajectory_controller`: by quintics if both have
/// accelerations, by cubics if they have velocities, otherwise linearly.
fn between(a: &GoalPoint, b: &GoalPoint, share: f64) -> (f64, Joints) {
    let h = b.t_s - a.t_s;
    let t_s = a.t_s + share * h;
    let q = match (a.dq.zip(b.dq), a.ddq.zip(b.ddq)) {
        (Some((va, vb)), Some((aa, ab))) => std::array::from_fn(|j| {
            let ends = [[a.q[j], va[j], aa[j]], [b.q[j], vb[j], ab[j]]];
            let [start, end] = ends.map(|[q, dq, ddq]| [q, dq * h, ddq * h * h]);
            hermite::value(&hermite::quintic(start, end), share)
        }),
        (Some((va, vb)), None) => std::array::from_fn(|j| {
            let c = hermite::cubic([a.q[j], va[j] * h], [b.q[j], vb[j] * h]);
            hermite::value(&c, share)
        }),
        (None, _) => std::array::from_fn(|j| a.q[j] + share * (b.q[j] - a.q[j])),
    };
    (t_s, q)
}

#[cfg(test)]
mod tests {
    use iiwa_kin::RosNames;

    use super::*;
    use crate::dds::messages::{Duration, JointTrajectoryPoint, MultiDofPoint, Time};

    fn arm() -> [String; 7] {
        RosNames::default().joints()
    }

    fn message(points: &[(f64, f64)]) -> FollowGoal {
        let mut goal = FollowGoal::default();
        goal.trajectory.joint_names = arm().to_vec();
        goal.trajectory.points = points
            .iter()
            .map(|(t_s, q)| JointTrajectoryPoint {
                time_from_start: Duration::from_seconds(*t_s),
                ..JointTrajectoryPoint::of_positions(&[*q; 7])
            })
            .collect();
        goal
    }

    fn read(message: &FollowGoal) -> Result<Goal, String> {
        Goal::read(message, &arm(), 1.7e9)
    }

    #[test]
    fn a_well_formed_goal_is_read() {
        let goal = read(&message(&[(0.0, 0.1), (1.0, 0.2)])).unwrap();
        assert_eq!(goal.points.len(), 2);
        assert_eq!((goal.points[1].t_s, goal.points[1].q), (1.0, [0.2; 7]));
    }

    #[test]
    fn malformed_goals_are_refused() {
        let good = message(&[(0.0, 0.1), (1.0, 0.2)]);
        let fault = |change: &dyn Fn(&mut FollowGoal)| {
            let mut goal = good.clone();
            change(&mut goal);
            read(&goal).unwrap_err()
        };
        assert!(fault(&|goal| goal.trajectory.points.clear()).contains("no points"));
        assert!(
            fault(&|goal| goal.trajectory.points[1].positions[3] = f64::NAN).contains("point 2")
        );
        assert!(
            fault(&|goal| goal.trajectory.points[1].positions.truncate(6)).contains("6 values")
        );
        assert!(
            fault(&|goal| goal.trajectory.points[1].positions.clear()).contains("no positions")
        );
        assert!(
            fault(&|goal| goal.trajectory.points[0].velocities = vec![0.0]).contains("velocities")
        );
        assert!(fault(&|goal| goal.trajectory.points.swap(0, 1)).contains("rise"));
        let at = |sec| Duration { sec, nanosec: 0 };
        assert!(fault(&|goal| goal.trajectory.points[0].time_from_start = at(-1)).contains("rise"));
        assert!(
            fault(&|goal| goal.trajectory.points[1].time_from_start = at(9999)).contains("rise")
        );
        assert!(fault(&|goal| goal.trajectory.joint_names[0].push('x')).contains("iiwa_joint_1x"));
        assert!(
            fault(&|goal| goal.multi_dof_trajectory.points.push(MultiDofPoint::default()))
                .contains("several")
        );
        let later = Time { sec: 1_700_000_010, nanosec: 0 };
        assert!(fault(&|goal| goal.trajectory.header.stamp = later).contains("start in 10.0 s"));
    }

    #[test]
    fn points_are_met_and_samples_are_close() {
        let goal = read(&message(&[(0.0, 0.1), (0.31, 0.2), (1.0, 0.15)])).unwrap();
        let motion = goal.motion(&[9.0; 7]);
        assert_eq!((motion.t_s[0], motion.joints_rad[0]), (0.0, [0.1; 7]));
        let last = motion.t_s.len() - 1;
        assert_eq!((motion.t_s[last], motion.joints_rad[last]), (1.0, [0.15; 7]));
        assert!(motion.t_s.windows(2).all(|two| two[1] > two[0] && two[1] - two[0] < MAX_STEP_S));
        let met = motion.t_s.iter().position(|t_s| *t_s == 0.31).unwrap();
        assert_eq!(motion.joints_rad[met], [0.2; 7]);
    }

    #[test]
    fn a_late_first_point_is_reached_from_where_the_arm_is() {
        let goal = read(&message(&[(0.5, 0.2)])).unwrap();
        let motion = goal.motion(&[0.1; 7]);
        assert_eq!(motion.joints_rad[0], [0.1; 7]);
        assert_eq!(motion.t_s.last(), Some(&0.5));
        // A single point at the current position is a motion at rest.
        let motion = read(&message(&[(0.0, 0.2)])).unwrap().motion(&[0.2; 7]);
        assert_eq!(motion.joints_rad, [[0.2; 7]; 2]);
    }

    #[test]
    fn the_goal_may_be_missed_within_its_tolerance() {
        let mut message = message(&[(0.0, 0.1), (1.0, 0.2)]);
        assert_eq!(read(&message).unwrap().missed_by(&arm(), &[0.3; 7]), None);
        message.goal_tolerance.push(JointTolerance::of_position("iiwa_joint_2", 0.01));
        let goal = read(&message).unwrap();
        assert_eq!(goal.missed_by(&arm(), &[0.205; 7]), None);
        assert!(goal.missed_by(&arm(), &[0.3; 7]).unwrap().contains("iiwa_joint_2"));
        message.goal_tolerance[0].name = "elbow".to_owned();
        assert!(read(&message).unwrap_err().contains("elbow"));
    }
}
