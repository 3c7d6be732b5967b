//! Observations of individual motions, and the parts that were not used.

use iiwa_kin::{Joint, Joints};
use iiwa_program::MotionIndex;

/// Motion along a line from rest to rest.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct LineObservation {
    /// Index of the recording, from 0.
    pub recording: usize,
    /// Index of the motion.
    pub motion: MotionIndex,
    /// Joint, if only one moves.
    pub joint: Option<Joint>,
    /// Start, in rad.
    pub from_rad: Joints,
    /// End, in rad.
    pub to_rad: Joints,
    /// Start and end times, in s, on the recording's clock.
    pub time_s: [f64; 2],
    /// Top speed along the line, in rad/s, if it was held for some time.
    pub speed_rad_s: Option<f64>,
    /// Acceleration along the line, in rad/s^2, if it was held for some time.
    pub acceleration_rad_s2: Option<f64>,
    /// Jerk along the line, in rad/s^3, if the samples determine it.
    pub jerk_rad_s3: Option<f64>,
    /// Law that explains the motion.
    pub law: LineLaw,
    /// Root mean square residual of that law, in rad.
    pub residual_rad: f64,
    /// Noise of the recording along the line, in rad.
    pub noise_rad: f64,
}

impl LineObservation {
    /// Returns true if the residual is far above the noise: none of the known laws explains the
    /// motion.
    #[must_use]
    pub fn is_unexplained(&self) -> bool {
        self.residual_rad > UNEXPLAINED_RAD.max(30.0 * self.noise_rad)
    }
}

/// Residual, in rad, up to which a motion always counts as explained: lag and friction of measured
/// positions cause such residuals.
const UNEXPLAINED_RAD: f64 = 2e-5;

/// Law of acceleration and deceleration along a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum LineLaw {
    /// Seven phases of constant jerk.
    Jerk,
    /// Ramps that begin with constant snap, as under Sunrise: see [`RampLaw`](iiwa_kin::RampLaw).
    Snap,
}

/// Observed blend in joint space.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct BlendObservation {
    /// Index of the recording, from 0.
    pub recording: usize,
    /// Motion whose target is blended away.
    pub motion: MotionIndex,
    /// Angle of the corner, in degrees.
    pub gamma_deg: f64,
    /// kappa and its standard deviation.
    pub kappa: (f64, f64),
    /// Planned distance of the start and the end from the target (with Algorithm 3), in rad.
    pub reach_rad: f64,
    /// Observed distances of the start and the end from the target, in rad, if the samples show
    /// them.
    pub found_reach_rad: Option<[f64; 2]>,
    /// Root mean square distance of the samples from the curve, in rad.
    pub residual_rad: f64,
}

/// Observed blend between two straight TCP paths.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct TcpBlendObservation {
    /// Index of the recording, from 0.
    pub recording: usize,
    /// Motion whose target is blended away.
    pub motion: MotionIndex,
    /// Start and end times of the evaluated samples, in s, on the recording's clock.
    pub time_s: [f64; 2],
    /// Angle between the TCP directions, in degrees.
    pub gamma_deg: f64,
    /// kappa and its standard deviation.
    pub kappa: (f64, f64),
    /// Planned distance of the start and the end from the target, in m.
    pub reach_m: f64,
    /// Observed distances of the start and the end from the target, in m, if the samples show them.
    pub found_reach_m: Option<[f64; 2]>,
    /// Root mean square distance of the samples from the curve, including the distance from its
    /// plane, in m.
    pub residual_m: f64,
}

/// Comparison of a TCP path, or of a blend at its end, with the assumed path, regardless of time:
/// each sample is compared with the point of the assumed path nearest to its TCP.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct CourseObservation {
    /// Index of the recording, from 0.
    pub recording: usize,
    /// Motion; for a blend the motion whose target is blended away.
    pub motion: MotionIndex,
    /// Kind of the part.
    pub part: CoursePart,
    /// Change of the TCP orientation from start to end, in rad.
    pub turn_rad: f64,
    /// Change of E1, in rad.
    pub e1_rad: f64,
    /// Largest distance of the TCP from the assumed path, in m.
    pub off_m: f64,
    /// Largest angle between the measured and the assumed orientation, in rad.
    pub turn_off_rad: f64,
    /// Largest difference between the measured and the assumed E1, in rad.
    pub e1_off_rad: f64,
    /// Number of samples.
    pub samples: usize,
}

/// Part of a path with an assumed law.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum CoursePart {
    /// TCP path: the position is known, orientation and E1 along the path are assumed.
    Path,
    /// Blend between two TCP paths.
    TcpBlend,
    /// Blend between a motion in joint space and a TCP path, or between paths of two TCPs.
    JointBlend,
}

impl CoursePart {
    /// All kinds of parts.
    pub const ALL: [Self; 3] = [Self::Path, Self::TcpBlend, Self::JointBlend];
}

impl std::fmt::Display for CoursePart {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Path => "TCP paths",
            Self::TcpBlend => "blends between TCP paths",
            Self::JointBlend => "blends between joint space and a TCP path",
        })
    }
}

/// Largest residual of a motion along a line, or of a blend, as a share of the way.
pub(super) const LEFT_SHARE: f64 = 0.01;

/// Minimum number of samples of a motion.
pub(super) const FEWEST: usize = 20;

/// Part of a recording that was not used.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeftOut {
    /// Index of the recording, from 0.
    pub recording: usize,
    /// Index of the motion.
    pub motion: MotionIndex,
    /// Reason.
    pub why: Why,
}

/// Reason why a part of a recording was not used.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Why {
    /// The robot did not perform the motion, nor the rest of the program.
    NotFollowed,
    /// Too few samples.
    TooFewSamples,
    /// The motion does not follow a known law along a line from rest to rest; with its residual, in
    /// rad.
    NoLine(f64),
    /// The path around the corner does not fit the blend curve; with its residual, in rad.
    NoBlend(f64),
    /// The TCP path around the corner does not fit the blend curve; with its residual, in m.
    NoTcpBlend(f64),
    /// The TCP was off the programmed path; with its distance, in m.
    OffCourse(f64),
}

impl std::fmt::Display for Why {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NotFollowed => f.write_str("the arm does not follow the program from here on"),
            Self::TooFewSamples => f.write_str("too few samples"),
            Self::NoLine(left) => write!(
                f,
                "the motion does not fit a line from rest to rest: residual {:.3} deg",
                left.to_degrees()
            ),
            Self::NoBlend(left) => write!(
                f,
                "the path does not fit the blend curve of the iiwa: residual {:.3} deg",
                left.to_degrees()
            ),
            Self::NoTcpBlend(left) => write!(
                f,
                "the TCP path does not fit the blend curve of the iiwa: residual {:.3} mm",
                1e3 * left
            ),
            Self::OffCourse(off) => {
                write!(f, "the TCP is {:.1} mm away from the programmed path", 1e3 * off)
            }
        }
    }
}
