//! Parts of a motion that its recording lacks.

use std::fmt;

use serde::{Deserialize, Serialize};

/// Position in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[non_exhaustive]
pub enum FilePlace {
    /// Line of a table, from 1; the header counts.
    Line(u64),
    /// Sample of a recording, from 1.
    Sample(u64),
    /// Row of a Parquet file, from 1.
    Row(u64),
    /// Column names of a Parquet file.
    Schema,
}

impl fmt::Display for FilePlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line(line) => write!(f, "line {line}"),
            Self::Sample(sample) => write!(f, "sample {sample}"),
            Self::Row(row) => write!(f, "row {row}"),
            Self::Schema => f.write_str("schema"),
        }
    }
}

/// Part of a motion that its recording lacks, or that was omitted or assumed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum Loss {
    /// A section without samples: a step of more than 2.5 times the median one.
    Gap {
        /// Last sample before, s.
        from_s: f64,
        /// First sample after, s.
        to_s: f64,
        /// Number of samples that fit in between at the median period.
        missing: u64,
    },
    /// Samples with the time and the positions of the sample before. They were omitted.
    Repeated {
        /// First of these samples.
        first: FilePlace,
        /// Time of that sample, s.
        t_s: f64,
        /// Number of these samples.
        count: u64,
    },
    /// Positions without a unit were read as degrees: one of them is beyond every joint range in
    /// rad.
    DegreesAssumed {
        /// The sample.
        place: FilePlace,
        /// The joint's number, from 1.
        joint: usize,
        /// Position of the joint, degrees.
        found_deg: f64,
    },
    /// Columns of a table without a unit in their names were read as radians.
    RadiansAssumed,
    /// The last line of a table does not end with a line break, so its last number may lack digits.
    /// The line was omitted.
    LastLine {
        /// Number of the line.
        line: u64,
    },
    /// The file is cut off or damaged: the rest is unknown.
    BrokenOff {
        /// Last sample before the damage, s.
        t_s: f64,
        /// Number of samples read.
        samples: u64,
        /// Damage found.
        reason: String,
    },
}

impl fmt::Display for Loss {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Gap { from_s, to_s, missing } => write!(
                f,
                "no samples from {from_s:.3} s to {to_s:.3} s ({:.3} s): some {missing} are \
                 missing",
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
                "the file states no unit of its positions: read as degrees, as joint A{joint} is \
                 at {found_deg:.3} in {place}"
            ),
            Self::RadiansAssumed => write!(
                f,
                "the column names state no unit: positions are read as radians; names such as \
                 joint_1_deg state degrees"
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
