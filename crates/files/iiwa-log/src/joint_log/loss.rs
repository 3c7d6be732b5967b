//! What a file does not have of the motion that it recorded.

use std::fmt;

use serde::{Deserialize, Serialize};

/// Where in a file something is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[non_exhaustive]
pub enum Place {
    /// A line of a table, from 1; the header is one.
    Line(u64),
    /// A sample of a recording, from 1.
    Sample(u64),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line(line) => write!(f, "line {line}"),
            Self::Sample(sample) => write!(f, "sample {sample}"),
        }
    }
}

/// A part of a motion that its recording does not have, or that was left out of it, or assumed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum Loss {
    /// A section without samples: a step of more than 2.5 times the usual one.
    Gap {
        /// The last sample before, s.
        from_s: f64,
        /// The first sample after, s.
        to_s: f64,
        /// How many samples would fit in between, at the usual period.
        missing: u64,
    },
    /// Samples with the time and the positions of the one before them. They were left out.
    Repeated {
        /// The first of them.
        first: Place,
        /// Its time, s.
        t_s: f64,
        /// How many there are.
        count: u64,
    },
    /// Positions without a unit were read as degrees: one of them is beyond every range in rad.
    DegreesAssumed {
        /// The sample.
        place: Place,
        /// The joint's number, from 1.
        joint: usize,
        /// Its position, degrees.
        found_deg: f64,
    },
    /// The last line of a table has no end, so that its last number may lack digits. It was left
    /// out.
    LastLine {
        /// Its number.
        line: u64,
    },
    /// The file is cut off or damaged: what comes behind is not known.
    BrokenOff {
        /// The last sample before, s.
        t_s: f64,
        /// How many samples there are.
        samples: u64,
        /// What is wrong with the file.
        reason: String,
    },
}

impl fmt::Display for Loss {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Gap { from_s, to_s, missing } => write!(
                f,
                "no samples from {from_s:.3} s to {to_s:.3} s ({:.3} s): some {missing} are missing",
                to_s - from_s
            ),
            Self::Repeated { first, t_s, count: 1 } => {
                write!(f, "{first}, at {t_s:.3} s, repeats the sample before and was left out")
            }
            Self::Repeated { first, t_s, count } => write!(
                f,
                "{count} samples repeat the one before and were left out, the first of them is \
                 {first}, at {t_s:.3} s"
            ),
            Self::DegreesAssumed { place, joint, found_deg } => write!(
                f,
                "the file states no unit of its positions: read as degrees, as joint A{joint} is at {found_deg:.3} in {place}"
            ),
            Self::LastLine { line } => write!(
                f,
                "line {line}, the last one, does not end: it may be cut off and was left out"
            ),
            Self::BrokenOff { t_s, samples, reason } => {
                write!(f, "all behind {t_s:.3} s is lost, after {samples} samples: {reason}")
            }
        }
    }
}
