//! Why there are no joint positions.

use std::io;

use iiwa_kin::Joint;

use super::{Place, Positions};
use crate::ReadError;

/// Why joint positions could not be read, or do not fit a robot.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum JointLogError {
    /// The stream failed.
    #[error("reading failed")]
    Io {
        /// What the stream says.
        #[from]
        source: io::Error,
    },
    /// A file without content.
    #[error("the file is empty")]
    Empty,
    /// Neither an MCAP file nor a table.
    #[error(
        "neither an MCAP file nor a table of joint positions: expected a header line such as \
         `t_s,joint_1_rad,...,joint_7_rad`, found {found}"
    )]
    Unknown {
        /// What the file begins with.
        found: String,
    },
    /// A Parquet file, and this build lacks the feature `parquet`.
    #[error("Apache Parquet files are not supported by this build (feature `parquet`)")]
    ParquetNotSupported,
    /// A column that a table needs.
    #[error("line {line}: no column for {what}, expected {expected}")]
    MissingColumn {
        /// The header line, from 1.
        line: u64,
        /// What would be in it.
        what: String,
        /// The names that it may have.
        expected: String,
    },
    /// A `DataRecorder` log without the positions that are required.
    #[error(
        "line {line}: no {} positions (columns `{}_...[0]` to `[6]`) in this DataRecorder log, only {} ones: read those, \
         or record both",
        .positions.names().0, .positions.names().1, .positions.other().names().0
    )]
    MissingPositions {
        /// The header line, from 1.
        line: u64,
        /// Those that are missing.
        positions: Positions,
    },
    /// Two columns of the same content.
    #[error("line {line}: `{first}` and `{second}` are both a column for {what}")]
    DuplicateColumn {
        /// The header line, from 1.
        line: u64,
        /// What is in it.
        what: String,
        /// The name of one.
        first: String,
        /// The name of the other.
        second: String,
    },
    /// A line that does not have the fields of the header.
    #[error("line {line} has {found} fields, the header has {expected}")]
    FieldCount {
        /// The line, from 1.
        line: u64,
        /// Its fields.
        found: usize,
        /// The header's.
        expected: usize,
    },
    /// A field of a table that is not the number it should be.
    #[error("line {line}, column `{column}`: `{found}` is not {expected}")]
    Field {
        /// The line, from 1.
        line: u64,
        /// The column's name.
        column: String,
        /// The field.
        found: String,
        /// What it should be.
        expected: &'static str,
    },
    /// The container of a recording, or a message in it.
    #[error("not a sound recording")]
    Recording {
        /// What is wrong with it.
        #[from]
        source: ReadError,
    },
    /// A recording with a position that is not a number.
    #[error("{place}: joint {joint} is at {found_rad} rad")]
    NotFinite {
        /// The sample.
        place: Place,
        /// The joint.
        joint: Joint,
        /// Its position, rad.
        found_rad: f64,
    },
    /// A file that has no sample.
    #[error("no joint positions in the file")]
    NoSamples,
    /// A sample that is earlier than the one before it.
    #[error("{place}: time runs backwards, from {previous_s} s to {t_s} s")]
    Backwards {
        /// The later sample in the file.
        place: Place,
        /// Its time, s.
        t_s: f64,
        /// The time before, s.
        previous_s: f64,
    },
    /// Two samples of one time with different positions.
    #[error("{place}: a second sample at {t_s} s, with other positions")]
    SameTime {
        /// The second sample.
        place: Place,
        /// The time, s.
        t_s: f64,
    },
    /// An angle in rad that no LBR iiwa reaches.
    #[error(
        "{place}: joint {joint} at {found_rad} rad, and no LBR iiwa turns further than 3.054 rad \
         (175 degrees): the positions look like degrees, which need columns such as `joint_{}_deg`",
        .joint.number()
    )]
    Degrees {
        /// The sample.
        place: Place,
        /// The joint.
        joint: Joint,
        /// Its position as if it were in rad.
        found_rad: f64,
    },
    /// An angle in degrees that no LBR iiwa reaches.
    #[error(
        "{place}: joint {joint} at {found_deg} degrees, and no LBR iiwa turns further than 175: \
         not an LBR iiwa, or not degrees"
    )]
    OutOfReach {
        /// The sample.
        place: Place,
        /// The joint.
        joint: Joint,
        /// Its position, degrees.
        found_deg: f64,
    },
    /// A speed that no LBR iiwa has.
    #[error(
        "joint {joint} turns at {found_rad_s:.1} rad/s about {t_s:.3} s, where at most \
         {most_rad_s:.1} rad/s are possible: wrong units (degrees as radians, or a time that is not \
         in seconds), wrong robot, or positions that jump"
    )]
    TooFast {
        /// The joint.
        joint: Joint,
        /// When, s.
        t_s: f64,
        /// Its speed, over a section of at least 0.05 s, rad/s.
        found_rad_s: f64,
        /// The most that is accepted, rad/s.
        most_rad_s: f64,
    },
    /// A sample rate at which no motion of a robot is recorded.
    #[error(
        "implausible sample rate: {:.3} Hz; is the time column in seconds?",
        .period_s.recip()
    )]
    Rate {
        /// The usual time from one sample to the next, s.
        period_s: f64,
    },
    /// A position outside a robot's range.
    #[error(
        "joint {joint} is at {:.2} degrees at {t_s:.3} s, and the range of {robot} ends at {:.2}: \
         wrong robot or wrong units",
        found_rad.to_degrees(), limit_rad.to_degrees()
    )]
    OutsideLimits {
        /// The robot's name.
        robot: String,
        /// The joint.
        joint: Joint,
        /// When, s.
        t_s: f64,
        /// Its position, rad.
        found_rad: f64,
        /// The end of its range, rad.
        limit_rad: f64,
    },
    /// A recording of another built-in robot.
    #[error("a recording of {found}, not of {expected}: wrong robot")]
    WrongRobot {
        /// The robot of the recording.
        found: String,
        /// The robot that it was held against.
        expected: String,
    },
    /// A recording in which nothing moves.
    #[error("no motion: no joint moves by more than {most_rad:.1e} rad in {duration_s:.3} s")]
    NoMotion {
        /// The widest motion of any joint, rad.
        most_rad: f64,
        /// The time from the first sample to the last, s.
        duration_s: f64,
    },
}
