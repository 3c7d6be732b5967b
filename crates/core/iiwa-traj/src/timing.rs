//! What limits the stamps.

use iiwa_kin::Joint;
use iiwa_program::MotionIndex;

use crate::limit::Limit;

/// The limits that a trajectory keeps, and how its stamps are found.
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
    /// Velocity and acceleration, by the sample sweep of Larsen 2019, section 2.4.
    Acceleration(SweepOptions),
    /// Velocity, acceleration and jerk.
    Jerk(JerkOptions),
    /// As [`Jerk`](Self::Jerk), but for motions from rest to rest as Sunrise was seen to plan them: PTP motions start and stop
    /// by the robot's [`RampLaw`](iiwa_kin::RampLaw), and splines go by its [`SplineSpeed`](iiwa_kin::SplineSpeed), a model. What
    /// Sunrise does with blends and with LIN and CIRC motions is not known. They keep limits of jerk, and next to rest lower ones, so
    /// that their ramps take as long there as those of PTP motions and single SPL.
    ///
    /// Along splines, joint velocities keep their limits, and joint accelerations and jerks exceed theirs in bends.
    Sunrise(JerkOptions),
}

impl Default for Timing {
    fn default() -> Self {
        Self::Sunrise(JerkOptions::default())
    }
}

impl Timing {
    /// Limits of velocity, acceleration and jerk, everywhere: for what is commanded point by point.
    #[must_use]
    pub fn jerk_limited() -> Self {
        Self::Jerk(JerkOptions::default())
    }

    /// The name of the timing: `acceleration`, `jerk` or `sunrise`.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Acceleration(_) => "acceleration",
            Self::Jerk(_) => "jerk",
            Self::Sunrise(_) => "sunrise",
        }
    }
}

/// How fine the sweep is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SweepOptions {
    /// Intervals per blend, close to N of Larsen 2019, section 2.4.1; 100 by default, at least 2.
    ///
    /// Lines need none: limits do not change along them, so that the fastest way over a line is to
    /// speed up, to keep the speed and to slow down, at instants that are found in closed form.
    pub samples: usize,
}

impl Default for SweepOptions {
    fn default() -> Self {
        Self { samples: 100 }
    }
}

/// How jerk-limited stamps are found.
///
/// A straight line from rest to rest has a closed form. Sections with blends are solved for on cells, at
/// some places of which limits are kept exactly; in between they may be exceeded by 0.1 % (velocity),
/// 0.2 % (acceleration) and 2 % (jerk). Blends have to be of a shape whose curvature continues that of
/// the lines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JerkOptions {
    /// How many times as fine as usual the cells are; above 0, 1 by default.
    pub refinement: f64,
    /// Solve for every section as a whole, without the closed form of straight lines from rest to rest and the receding horizon of
    /// long sections. Tests of this and other crates check both against it. It takes longer. Off by default.
    pub general: bool,
}

impl Default for JerkOptions {
    fn default() -> Self {
        Self { refinement: 1.0, general: false }
    }
}

/// Why a path got no stamps.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TimingError {
    /// The stamps that were found do not keep the limits. A trajectory is never handed out then.
    #[error(
        "motion {motion}: the stamps found for it reach {ratio} times the limit of {limit}; \
         this is a fault of the planner, please report the program"
    )]
    LimitExceeded {
        /// The motion.
        motion: MotionIndex,
        /// What is exceeded.
        limit: Limit,
        /// Value over limit.
        ratio: f64,
    },
    /// A joint cannot hold the arm with its load within the limit of torques: no motion is slow enough.
    #[error(
        "motion {motion}: {joint} cannot hold the arm with its load there: it takes {:.1} Nm to stand still{}, of the {:.1} Nm \
         that it may exert{}; raise the limit of torques, or choose a lighter load or poses nearer to the base",
        .holding_nm.abs(),
        if *.friction_nm > 0.0 { format!(", and {friction_nm:.1} Nm of friction") } else { String::new() },
        .limit_nm,
        if .holding_nm.abs() + .friction_nm < *.limit_nm { ", which leaves less than a hundredth to move it" } else { "" }
    )]
    CannotHold {
        /// The motion, on the way of which it is.
        motion: MotionIndex,
        /// The joint.
        joint: Joint,
        /// The torque that it takes, with its sign, in Nm.
        holding_nm: f64,
        /// What friction takes on top, in Nm.
        friction_nm: f64,
        /// The most that the joint may exert, in Nm.
        limit_nm: f64,
    },
    /// More rows of [further limits](crate::PathLimit) than the planner takes.
    #[error(
        "{rows} rows of limits beside velocity, acceleration and jerk: at most {most} are possible"
    )]
    TooManyRows {
        /// The rows of the limits of a step.
        rows: usize,
        /// The most that are possible.
        most: usize,
    },
    /// A blend of this shape starts and ends with a jump in curvature, at which jerk would be infinite.
    #[error(
        "motion {motion}: the blend at its end begins with a jump in acceleration, which no limit of jerk \
         allows; choose another shape of blends, or timing without jerk"
    )]
    CurvatureJumps {
        /// The motion whose target is blended away.
        motion: MotionIndex,
    },
    /// The jerk-limited solver did not converge.
    #[error(
        "motion {motion}: no jerk-limited stamps were found for what starts with it; please report the \
         program"
    )]
    NotConverged {
        /// The first motion of a section without a stop.
        motion: MotionIndex,
    },
    /// The flag of [`Planner::interrupted_by`](crate::Planner::interrupted_by) was set.
    #[error("interrupted")]
    Interrupted,
    /// No stamps were found: the arm would stop on the way, or intervals had to be tightened again and
    /// again.
    #[error("motion {motion}: no way was found to move through it; please report the program")]
    Stuck {
        /// The motion, or the first one of a section without a stop.
        motion: MotionIndex,
    },
}

impl TimingError {
    /// The motion at fault, if it is one.
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
