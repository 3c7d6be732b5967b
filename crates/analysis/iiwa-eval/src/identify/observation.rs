//! What was observed motion by motion, and what was not used.

use iiwa_kin::{Joint, Joints};
use iiwa_program::MotionIndex;

/// A motion along a line from rest to rest.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct LineObservation {
    /// The recording, from 0.
    pub recording: usize,
    /// The motion.
    pub motion: MotionIndex,
    /// The joint, if only one moves.
    pub joint: Option<Joint>,
    /// The way, in rad.
    pub from_rad: Joints,
    /// The way, in rad.
    pub to_rad: Joints,
    /// When it began and ended, in s of the recording.
    pub time_s: [f64; 2],
    /// Top speed along the way, in rad/s, if it was kept for a time.
    pub speed_rad_s: Option<f64>,
    /// Acceleration along the way, in rad/s^2, if it was kept for a time.
    pub acceleration_rad_s2: Option<f64>,
    /// Jerk along the way, in rad/s^3, if it shows.
    pub jerk_rad_s3: Option<f64>,
    /// The law that explains it.
    pub law: LineLaw,
    /// Root mean square of what that law leaves over, in rad.
    pub residual_rad: f64,
    /// Noise of the recording along the way, in rad.
    pub noise_rad: f64,
}

impl LineObservation {
    /// Whether far more is left over than noise: no law that is known here explains the motion.
    #[must_use]
    pub fn is_unexplained(&self) -> bool {
        self.residual_rad > UNEXPLAINED_RAD.max(30.0 * self.noise_rad)
    }
}

/// Less is never called unexplained, in rad: lag and friction of measured positions.
const UNEXPLAINED_RAD: f64 = 2e-5;

/// How a motion along a line speeds up and slows down.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum LineLaw {
    /// Seven phases of constant jerk.
    Jerk,
    /// Ramps that begin with constant snap, as under Sunrise: see [`RampLaw`](iiwa_kin::RampLaw).
    Snap,
}

/// A blend.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct BlendObservation {
    /// The recording, from 0.
    pub recording: usize,
    /// The motion whose target is blended away.
    pub motion: MotionIndex,
    /// Angle of the corner, in degrees.
    pub gamma_deg: f64,
    /// kappa and its standard deviation.
    pub kappa: (f64, f64),
    /// How far before and behind the target it begins and ends by the program (with Algorithm 3), in rad.
    pub reach_rad: f64,
    /// How far it does, in rad, if the samples tell.
    pub found_reach_rad: Option<[f64; 2]>,
    /// Root mean square of the samples' distances from the curve, in rad.
    pub residual_rad: f64,
}

/// A blend between two straight ways of the TCP.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct TcpBlendObservation {
    /// The recording, from 0.
    pub recording: usize,
    /// The motion whose target is blended away.
    pub motion: MotionIndex,
    /// From when to when it was looked at, in s of the recording.
    pub time_s: [f64; 2],
    /// Angle between the TCP's directions, in degrees.
    pub gamma_deg: f64,
    /// kappa and its standard deviation.
    pub kappa: (f64, f64),
    /// How far before and behind the target it begins and ends as planned, in m.
    pub reach_m: f64,
    /// How far it does, in m, if the samples tell.
    pub found_reach_m: Option<[f64; 2]>,
    /// Root mean square of the samples' distances from the curve, those across its plane among them, in m.
    pub residual_m: f64,
}

/// A path of the TCP, or a blend at an end of one, against what is assumed of it, wherever in time: each sample is held
/// against the place of the assumed path that is nearest to its TCP.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct CourseObservation {
    /// The recording, from 0.
    pub recording: usize,
    /// The motion; of a blend the one whose target is blended away.
    pub motion: MotionIndex,
    /// What it is.
    pub part: CoursePart,
    /// By how much the orientation of the TCP changes from its start to its end, in rad.
    pub turn_rad: f64,
    /// By how much E1 changes, in rad.
    pub e1_rad: f64,
    /// The largest distance of the TCP from the assumed path, in m.
    pub off_m: f64,
    /// The largest angle between its orientation and the assumed one, in rad.
    pub turn_off_rad: f64,
    /// The largest distance of E1 from the assumed one, in rad.
    pub e1_off_rad: f64,
    /// How many samples.
    pub samples: usize,
}

/// A part of a path that a law is assumed of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum CoursePart {
    /// A path of the TCP: where it goes is known; how orientation and E1 go along it is assumed.
    Path,
    /// A blend between two paths of the TCP.
    TcpBlend,
    /// A blend between a motion in joint space and a path of the TCP, or between two TCPs.
    JointBlend,
}

impl CoursePart {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Path, Self::TcpBlend, Self::JointBlend];
}

impl std::fmt::Display for CoursePart {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Path => "paths of the TCP",
            Self::TcpBlend => "blends between paths of the TCP",
            Self::JointBlend => "blends between joint space and a path of the TCP",
        })
    }
}

/// What may be left over of a motion that is taken for one along a line, or for a blend, as a share of the way.
pub(super) const LEFT_SHARE: f64 = 0.01;

/// Least number of samples of a motion.
pub(super) const FEWEST: usize = 20;

/// A part of a recording that was not used.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeftOut {
    /// The recording, from 0.
    pub recording: usize,
    /// The motion.
    pub motion: MotionIndex,
    /// Why.
    pub why: Why,
}

/// Why a part of a recording was not used.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Why {
    /// The arm did not do it, nor anything of the program after it.
    NotFollowed,
    /// There are too few samples.
    TooFewSamples,
    /// The arm did not speed up and slow down as along a line from rest to rest; the distance left over,
    /// in rad.
    NoLine(f64),
    /// The arm did not round the corner as a blend does; the distance left over, in rad.
    NoBlend(f64),
    /// The TCP did not round the corner as a blend does; the distance left over, in m.
    NoTcpBlend(f64),
    /// The TCP was elsewhere than the program says; by so much, in m.
    OffCourse(f64),
}

impl std::fmt::Display for Why {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NotFollowed => f.write_str("the arm does not follow the program from here on"),
            Self::TooFewSamples => f.write_str("too few samples"),
            Self::NoLine(left) => write!(
                f,
                "no motion along a line from rest to rest: {:.3} deg are left over",
                left.to_degrees()
            ),
            Self::NoBlend(left) => {
                write!(f, "no blend of the iiwa's form: {:.3} deg are left over", left.to_degrees())
            }
            Self::NoTcpBlend(left) => {
                write!(
                    f,
                    "no blend of the TCP of the iiwa's form: {:.3} mm are left over",
                    1e3 * left
                )
            }
            Self::OffCourse(off) => {
                write!(f, "the TCP is {:.1} mm away from where the program takes it", 1e3 * off)
            }
        }
    }
}
