//! Planning of many programs in parallel.

use iiwa_kin::Robot;
use iiwa_path::{JointPath, PathOptions};
use iiwa_program::{Fault, MotionIndex, Program};
use rayon::prelude::{IntoParallelRefIterator, ParallelIterator};

use crate::{
    planner::Planner,
    timing::{Timing, TimingError},
    trajectory::Trajectory,
};

/// Error of planning a program.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PlanError {
    /// The program is not feasible for the robot.
    #[error(transparent)]
    Fault(#[from] Fault),
    /// Time parameterisation of the path failed.
    #[error(transparent)]
    Timing(#[from] TimingError),
}

impl PlanError {
    /// Returns the motion that caused the error, if there is one.
    #[must_use]
    pub fn motion(&self) -> Option<MotionIndex> {
        match self {
            Self::Fault(fault) => fault.motion(),
            Self::Timing(error) => error.motion(),
        }
    }
}

/// Plans all `programs` on `robot` in parallel on all cores, for optimisers that try many programs
/// and keep the best. The results are in the order of the programs and equal those of
/// [`Trajectory::plan`]. A program that cannot be planned yields an error in its place and does not
/// affect the others.
///
/// The function runs on the current rayon pool: the global one, usually with one thread per core,
/// unless called within another: `pool.install(|| plan_all(...))` plans on the threads of `pool`
/// only.
///
/// ```
/// use iiwa_kin::Robot;
/// use iiwa_path::PathOptions;
/// use iiwa_program::{Start, Sources, Workcell, Motion, Program, Ptp};
/// use iiwa_traj::{Timing, plan_all};
///
/// // Elbow angles of a via point: the second one gives the shortest cycle time.
/// let by_way_of = |elbow_rad: f64| Program {
///     robot: None,
///     start: Start::Joints([0.5, 0.3, 0.0, -1.0, 0.0, 0.7, 0.0]),
///     motions: vec![
///         Motion::Ptp(Ptp::to([0.0, 0.3, 0.0, elbow_rad, 0.0, 0.7, 0.0])),
///         Motion::Ptp(Ptp::to([-0.5, 0.3, 0.0, -1.4, 0.0, 0.7, 0.0])),
///     ], workcell: Workcell::default(), sources: Sources::default(),
/// };
/// let programs = [-2.0, -1.2, 0.0, 9.0].map(by_way_of);
/// let plans = plan_all(
///     &programs,
///     &Robot::lbr_iiwa_7_r800(),
///     PathOptions::default(),
///     Timing::default(),
/// );
///
/// let times_s = plans.iter().map(|plan| plan.as_ref().map(|plan| plan.cycle_time_s()));
/// let best = times_s.enumerate().filter_map(|(i, time_s)| Some((i, time_s.ok()?)));
/// assert_eq!(best.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(i, _)| i), Some(1));
/// let error = plans[3].as_ref().expect_err("no elbow bends by nine rad");
/// assert!(error.to_string().starts_with("motion 1: joint A4 is at 515.66"));
/// ```
#[must_use]
pub fn plan_all(
    programs: &[Program],
    robot: &Robot,
    path_options: PathOptions,
    timing: Timing,
) -> Vec<Result<Trajectory, PlanError>> {
    let plan = |planner: &mut Option<Planner>, program| {
        let path = JointPath::with_options(program, robot, path_options)?;
        let planner = planner.get_or_insert_with(|| Planner::new(&path, timing));
        planner.restart(&path);
        Ok(Trajectory::by(planner)?)
    };
    // One planner per thread, whose memory is reused from program to program.
    programs.par_iter().map_init(|| None, plan).collect()
}
