//! Errors of comparing a recording with a plan.

use iiwa_program::MotionIndex;

/// Reason why a comparison is not possible. Figures that would be wrong are never returned.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CompareError {
    /// The plan has no motion.
    #[error("no joint moves in the plan")]
    PlanWithoutMotion,
    /// The recording has too few samples.
    #[error("{samples} samples are in the recording; at least 4 are needed")]
    TooFewSamples {
        /// Number of samples.
        samples: usize,
    },
    /// The recording contains invalid values.
    #[error("the recording's sample {index}, counted from 1, {fault}")]
    BadSample {
        /// Index in the recording, from 1.
        index: usize,
        /// Description of the fault.
        fault: &'static str,
    },
    /// The recorded robot does not move.
    #[error("no motion in the recording: no joint moves by more than {extent_rad:.1e} rad")]
    NoMotion {
        /// Largest range of a joint, in rad.
        extent_rad: f64,
    },
    /// The files belong to different robots.
    #[error("the plan is for the robot {planned}, the recording is of {measured}")]
    OtherRobot {
        /// Robot of the plan.
        planned: String,
        /// Robot of the recording.
        measured: String,
    },
    /// The robot is never at the program's start.
    #[error(
        "this is not the same program, or not from its start: the arm is never nearer to the \
         plan's start than {distance_rad:.3} rad, at {t_s:.3} s of the recording"
    )]
    OtherStart {
        /// Smallest distance, in rad.
        distance_rad: f64,
        /// Time, in s, on the recording's clock.
        t_s: f64,
    },
    /// The robot reaches the start and remains there.
    #[error(
        "the recording ends before the program begins: the arm is at the plan's start at {t_s:.3} \
         s and does not leave it"
    )]
    NeverLeaves {
        /// Time at the start, in s, on the recording's clock.
        t_s: f64,
    },
    /// The robot leaves the path.
    #[error(
        "this is not the same program: {distance_rad:.3} rad off the plan's path at {t_s:.3} s of \
         the recording, in motion {motion}"
    )]
    OtherPath {
        /// Distance from the path, in rad.
        distance_rad: f64,
        /// Time, in s, on the recording's clock.
        t_s: f64,
        /// Motion in the plan.
        motion: MotionIndex,
    },
    /// The robot is off the path throughout.
    #[error(
        "this is not the same program: the arm is {mean_rad:.3} rad off the plan's path on average"
    )]
    OffAllAlong {
        /// Mean distance, in rad.
        mean_rad: f64,
    },
    /// The robot does not reach the end.
    #[error(
        "the recorded motion ends early: at its last sample, {t_s:.3} s, the arm is in motion \
         {motion}, {left_rad:.3} rad before the end of the plan's path"
    )]
    EndsEarly {
        /// Time of the last sample, in s, on the recording's clock.
        t_s: f64,
        /// Motion in the plan.
        motion: MotionIndex,
        /// Remaining length of the path, in rad.
        left_rad: f64,
    },
    /// The recording contains no rest before the motion.
    #[error(
        "the recording begins in motion: at {t_s:.3} s the arm is {distance_rad:.1e} rad past the \
         plan's start already"
    )]
    BeginsInMotion {
        /// Time nearest to the start, in s, on the recording's clock.
        t_s: f64,
        /// Distance from the start, in rad.
        distance_rad: f64,
    },
    /// The robot passes the start or the end of the program and rests elsewhere.
    #[error(
        "the arm is not at rest at the plan's {edge}: at {t_s:.3} s of the recording it is {:.2} \
         deg away from there",
        .distance_rad.to_degrees()
    )]
    RestElsewhere {
        /// `start` or `end`.
        edge: &'static str,
        /// Time, in s, on the recording's clock.
        t_s: f64,
        /// Distance, in rad.
        distance_rad: f64,
    },
    /// The robot does not rest at the program's end.
    #[error(
        "the recorded motion does not end with the plan's: at {t_s:.3} s the arm is \
         {distance_rad:.1e} rad from its end, and not at rest"
    )]
    DoesNotStop {
        /// Time nearest to the end, in s, on the recording's clock.
        t_s: f64,
        /// Distance from the end, in rad.
        distance_rad: f64,
    },
    /// A gap hides the start or the end.
    #[error(
        "the {edge} of the motion is in a gap of the recording: nothing is known from {from_s:.3} \
         s to {to_s:.3} s"
    )]
    GapAtEdge {
        /// `start` or `end`.
        edge: &'static str,
        /// Last sample before the gap, in s, on the recording's clock.
        from_s: f64,
        /// First sample after the gap, in s, on the recording's clock.
        to_s: f64,
    },
}
