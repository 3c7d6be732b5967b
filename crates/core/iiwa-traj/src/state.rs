//! State of the robot at one instant.

use iiwa_kin::Joints;
use iiwa_program::MotionIndex;

/// State of the robot at one instant.
///
/// ```
/// use iiwa_kin::Robot;
/// use iiwa_path::JointPath;
/// use iiwa_program::{Start, Sources, Workcell, Motion, Program, Ptp};
/// use iiwa_traj::{Timing, Trajectory};
///
/// let target = [0.5, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0];
/// let program =
///     Program {
///         robot: None,
///         start: Start::Joints([0.0; 7]),
///         motions: vec![Motion::Ptp(Ptp::to(target))],
///         workcell: Workcell::default(),
///         sources: Sources::default(),
///     };
/// let path = JointPath::new(&program, &Robot::default())?;
/// let trajectory = Trajectory::plan(&path, Timing::jerk_limited())?;
/// // Jerk-limited timing begins with the jerk of the joint that limits it.
/// let state = trajectory.at(0.0);
/// assert!(state.ddq[3].abs() < 1e-9 && state.dddq[3] < -100.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct State {
    /// Time, in s.
    pub t_s: f64,
    /// Position, in rad.
    pub q: Joints,
    /// Velocity, in rad/s.
    pub dq: Joints,
    /// Acceleration, in rad/s^2. Where it jumps, the value after the jump.
    pub ddq: Joints,
    /// Jerk, in rad/s^3. Where it jumps, the value after the jump.
    pub dddq: Joints,
    /// Motion that is executed.
    pub motion: MotionIndex,
    /// Index of the current step among the path's [steps](iiwa_path::JointPath::steps).
    pub step: usize,
}
