//! Why a recording cannot be held against a plan.

use iiwa_program::MotionIndex;

/// Why there are no figures. A figure that would be wrong is not given.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CompareError {
    /// The plan has nothing to compare.
    #[error("nothing moves in the plan")]
    PlanStands,
    /// The recording has next to nothing.
    #[error("{samples} samples are in the recording; at least 4 are needed")]
    TooFewSamples {
        /// How many it has.
        samples: usize,
    },
    /// The recording's numbers cannot be compared.
    #[error("the recording's sample {index}, counted from 1, {what}")]
    BadSample {
        /// Its place in the recording, from 1.
        index: usize,
        /// What is wrong with it.
        what: &'static str,
    },
    /// The arm stands all the time.
    #[error(
        "there is no motion in the recording: no joint moves by more than {extent_rad:.1e} rad"
    )]
    NoMotion {
        /// The largest range of a joint, in rad.
        extent_rad: f64,
    },
    /// The files are about different robots.
    #[error("the plan is for the robot {planned}, the recording is of {measured}")]
    OtherRobot {
        /// The plan's robot.
        planned: String,
        /// The recording's robot.
        measured: String,
    },
    /// The arm is never where the program starts.
    #[error(
        "this is not the same program, or not from its start: the arm is never nearer to the plan's \
         start than {distance_rad:.3} rad, at {t_s:.3} s of the recording"
    )]
    OtherStart {
        /// How near it comes, in rad.
        distance_rad: f64,
        /// When, in s of the recording.
        t_s: f64,
    },
    /// The arm gets to the start and remains there.
    #[error(
        "the recording ends before the program begins: the arm is at the plan's start at {t_s:.3} s \
         and does not leave it"
    )]
    NeverLeaves {
        /// When it is there, in s of the recording.
        t_s: f64,
    },
    /// The arm leaves the path.
    #[error(
        "this is not the same program: {distance_rad:.3} rad off the plan's path at {t_s:.3} s of the \
         recording, in motion {motion}"
    )]
    OtherPath {
        /// How far it is off, in rad.
        distance_rad: f64,
        /// When, in s of the recording.
        t_s: f64,
        /// The motion in the plan.
        motion: MotionIndex,
    },
    /// The arm is off the path all along.
    #[error(
        "this is not the same program: the arm is {mean_rad:.3} rad off the plan's path on average"
    )]
    OffAllAlong {
        /// The mean, in rad.
        mean_rad: f64,
    },
    /// The arm does not get to the end.
    #[error(
        "the recorded motion ends early: at its last sample, {t_s:.3} s, the arm is in motion {motion}, \
         {left_rad:.3} rad before the end of the plan's path"
    )]
    EndsEarly {
        /// The last sample, in s of the recording.
        t_s: f64,
        /// The motion in the plan.
        motion: MotionIndex,
        /// What is left of the path, in rad.
        left_rad: f64,
    },
    /// The recording has no stand before the motion.
    #[error(
        "the recording begins in motion: at {t_s:.3} s the arm is {distance_rad:.1e} rad past the \
         plan's start already"
    )]
    BeginsInMotion {
        /// When it is nearest to the start, in s of the recording.
        t_s: f64,
        /// How far it is away, in rad.
        distance_rad: f64,
    },
    /// The arm passes the start or the end of the program and stands elsewhere.
    #[error(
        "the arm does not stand where the plan's {edge} is: at {t_s:.3} s of the recording it is {:.2} deg \
         away from there",
        .distance_rad.to_degrees()
    )]
    StandsElsewhere {
        /// `start` or `end`.
        edge: &'static str,
        /// When, in s of the recording.
        t_s: f64,
        /// How far away it is, in rad.
        distance_rad: f64,
    },
    /// The arm does not stand where the program ends.
    #[error(
        "the recorded motion does not end with the plan's: at {t_s:.3} s the arm is {distance_rad:.1e} rad \
         from its end, and does not stand there"
    )]
    DoesNotStop {
        /// When it is nearest to the end, in s of the recording.
        t_s: f64,
        /// How far it is away, in rad.
        distance_rad: f64,
    },
    /// A gap hides the start or the end.
    #[error(
        "the {edge} of the motion is in a gap of the recording: nothing is known from {from_s:.3} s to \
         {to_s:.3} s"
    )]
    GapAtEdge {
        /// `start` or `end`.
        edge: &'static str,
        /// Last sample before the gap, in s of the recording.
        from_s: f64,
        /// First sample after it, in s of the recording.
        to_s: f64,
    },
}
