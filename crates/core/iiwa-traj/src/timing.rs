//! Timing laws, their options and errors.

use iiwa_kin::Joint;
use iiwa_program::MotionIndex;

use crate::limit::Limit;

/// Limits of a trajectory, and the method of time parameterisation.
///
/// ```
/// use iiwa_kin::Robot;
/// use iiwa_path::JointPath;
/// use iiwa_program::{Blend, Program};
/// use iiwa_traj::{SweepOptions, Timing, Trajectory};
///
/// let program = Program::from_deg([0.0; 7])
///     .ptp_deg([40.0, 0.0, 0.0, -60.0, 0.0, 0.0, 0.0])
///     .blend(Blend::Fraction(0.3))
///     .ptp_deg([40.0, 30.0, 0.0, -30.0, 0.0, 0.0, 0.0])
///     .build();
/// let path = JointPath::new(&program, &Robot::default())?;
/// let sweep = SweepOptions { samples: 400 };
/// let acceleration = Trajectory::plan(&path, Timing::Acceleration(sweep))?;
/// let jerk = Trajectory::plan(&path, Timing::jerk_limited())?;
/// assert!(jerk.cycle_time_s() > acceleration.cycle_time_s());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Timing {
    /// Velocity and acceleration limits, by the sample sweep of Larsen 2019, section 2.4.
    Acceleration(SweepOptions),
    /// Velocity, acceleration and jerk limits.
    Jerk(JerkOptions),
    /// The limits of [`Jerk`](Self::Jerk), but motions from rest to rest follow recordings of
    /// Sunrise: PTP motions start and stop by the robot's [`RampLaw`](iiwa_kin::RampLaw), and
    /// splines follow its [`SplineSpeed`](iiwa_kin::SplineSpeed), a model. Sunrise's timing of
    /// blends and of LIN and CIRC motions is not known. These keep jerk limits, which are lower
    /// next to rest, so that their ramps take as long there as those of PTP motions and single SPL.
    ///
    /// Along splines, joint velocities keep their limits. Where the path bends, joint accelerations
    /// and jerks exceed theirs.
    Sunrise(JerkOptions),
}

impl Default for Timing {
    fn default() -> Self {
        Self::Sunrise(JerkOptions::default())
    }
}

impl Timing {
    /// Returns [`Jerk`](Self::Jerk) with default options: velocity, acceleration and jerk limits
    /// apply to all motions, as set-points that are commanded one by one require.
    #[must_use]
    pub fn jerk_limited() -> Self {
        Self::Jerk(JerkOptions::default())
    }

    /// Returns the name of the timing: `acceleration`, `jerk` or `sunrise`.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Acceleration(_) => "acceleration",
            Self::Jerk(_) => "jerk",
            Self::Sunrise(_) => "sunrise",
        }
    }
}

/// Resolution of the sweep.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SweepOptions {
    /// Intervals per blend, close to N of Larsen 2019, section 2.4.1; 100 by default, at least 2.
    ///
    /// Lines need no intervals: limits are constant along a line, so that the fastest motion
    /// accelerates, keeps its speed and decelerates, at instants that have a closed form.
    pub samples: usize,
}

impl Default for SweepOptions {
    fn default() -> Self {
        Self { samples: 100 }
    }
}

/// Options of jerk-limited timing.
///
/// A straight line from rest to rest has a closed form. Sections with blends are solved on cells:
/// limits are enforced at some points of each cell and may be exceeded in between by 0.1 %
/// (velocity), 0.2 % (acceleration) and 2 % (jerk). The curvature of blends must be continuous with
/// that of the lines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JerkOptions {
    /// Factor of refinement of the cells; above 0, 1 by default.
    pub refinement: f64,
    /// Solves every section as a whole, without the closed form of straight lines from rest to rest
    /// and the receding horizon of long sections. Tests of this and other crates compare both with
    /// this option. It takes longer. Off by default.
    pub general: bool,
}

impl Default for JerkOptions {
    fn default() -> Self {
        Self { refinement: 1.0, general: false }
    }
}

/// Error of time parameterisation.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TimingError {
    /// The stamps exceed a limit. A trajectory is never returned in this case.
    #[error(
        "motion {motion}: the stamps found for it reach {ratio} times the limit of {limit}; \
         this is a fault of the planner, please report the program"
    )]
    LimitExceeded {
        /// Motion.
        motion: MotionIndex,
        /// Limit that is exceeded.
        limit: Limit,
        /// Value over limit.
        ratio: f64,
    },
    /// A joint cannot hold the arm and its payload within the torque limit: no motion is slow
    /// enough.
    #[error(
        "motion {motion}: {joint} cannot hold the arm with its load there: standstill requires \
         {:.1} Nm{}, and the limit is {:.1} Nm{}; raise the torque limit, or choose a lighter \
         load or poses nearer to the base",
        .holding_nm.abs(),
        if *.friction_nm > 0.0 {
            format!(" plus {friction_nm:.1} Nm of friction")
        } else {
            String::new()
        },
        .limit_nm,
        if .holding_nm.abs() + .friction_nm < *.limit_nm { ", which leaves less than 1 % \
                                                            for motion" } else { "" }
    )]
    CannotHold {
        /// Motion on whose path the pose is.
        motion: MotionIndex,
        /// Joint.
        joint: Joint,
        /// Holding torque, with its sign, in Nm.
        holding_nm: f64,
        /// Additional friction torque, in Nm.
        friction_nm: f64,
        /// Largest torque of the joint, in Nm.
        limit_nm: f64,
    },
    /// Too many rows of [further limits](crate::PathLimit).
    #[error(
        "the further limits (beyond velocity, acceleration and jerk) have {rows} rows; at most \
         {max} are supported"
    )]
    TooManyRows {
        /// Rows of the limits of a step.
        rows: usize,
        /// Largest possible number of rows.
        max: usize,
    },
    /// A blend of this shape starts and ends with a jump in curvature, where jerk would be
    /// infinite.
    #[error(
        "motion {motion}: the blend at its end begins with a jump in acceleration, which no limit \
         of jerk allows; choose another shape of blends, or timing without jerk"
    )]
    CurvatureJumps {
        /// Motion whose target is blended away.
        motion: MotionIndex,
    },
    /// The jerk-limited solver did not converge.
    #[error(
        "motion {motion}: no jerk-limited stamps were found for the section that starts with it; \
         please report the program"
    )]
    NotConverged {
        /// First motion of a section without a stop.
        motion: MotionIndex,
    },
    /// The flag of [`Planner::interrupted_by`](crate::Planner::interrupted_by) was set.
    #[error("interrupted")]
    Interrupted,
    /// The sweep found no stamps: the robot would stop on the way, or intervals had to be tightened
    /// too many times.
    #[error("motion {motion}: time parameterisation failed; please report the program")]
    Stuck {
        /// Motion, or the first one of a section without a stop.
        motion: MotionIndex,
    },
}

impl TimingError {
    /// Returns the motion that caused the error, if there is one.
    #[must_use]
    pub fn motion(&self) -> Option<MotionIndex> {
        match self {
            Self::LimitExceeded { motion, .. }
            | Self::CannotHold { motion, .. }
            | Self::CurvatureJumps { motion }
            | Self::NotConverged { motion }
            | Self::Stuck { motion } => Some(*motion),
            Self::TooManyRows { .. } | Self::Interrupted => None,
        }
    }
}
