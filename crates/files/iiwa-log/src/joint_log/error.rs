//! Errors of reading joint positions.

use std::io;

use iiwa_kin::Joint;

use super::{FilePlace, Positions};
use crate::ReadError;

/// Reason why joint positions could not be read, or do not fit a robot.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum JointLogError {
    /// The stream failed.
    #[error("reading failed")]
    Io {
        /// Error of the stream.
        #[from]
        source: io::Error,
    },
    /// A file without content.
    #[error("the file is empty")]
    Empty,
    /// The file is neither an MCAP file nor a table.
    #[error(
        "neither an MCAP file nor a table of joint positions: expected a header line such as \
         `t_s,joint_1_rad,...,joint_7_rad`, found {found}"
    )]
    Unknown {
        /// Beginning of the file.
        found: String,
    },
    /// The file is a Parquet file, and this build lacks the feature `parquet`.
    #[error("Apache Parquet files are not supported by this build (feature `parquet`)")]
    ParquetNotSupported,
    /// A Parquet file is damaged, or has contents that are not supported.
    #[error("Apache Parquet: {message}")]
    Parquet {
        /// Fault and its place.
        message: String,
    },
    /// A number is missing in a row of a Parquet file.
    #[error("{place}, column `{column}`: the value is missing (null)")]
    Null {
        /// The row.
        place: FilePlace,
        /// Name of the column.
        column: String,
    },
    /// A required column of a table is missing.
    #[error("{place}: no column for {quantity}, expected {expected}")]
    MissingColumn {
        /// Place of the column names.
        place: FilePlace,
        /// Quantity of the column.
        quantity: String,
        /// Accepted names.
        expected: String,
    },
    /// A `DataRecorder` log without the positions that are required.
    #[error(
        "{place}: no {} positions (columns `{}_...[0]` to `[6]`) in this DataRecorder log, \
         only {} ones: read those, or record both",
        .positions.names().0, .positions.names().1, .positions.other().names().0
    )]
    MissingPositions {
        /// Place of the column names.
        place: FilePlace,
        /// Missing positions.
        positions: Positions,
    },
    /// Two columns of the same quantity.
    #[error("{place}: `{first}` and `{second}` are both a column for {quantity}")]
    DuplicateColumn {
        /// Place of the column names.
        place: FilePlace,
        /// Quantity of the columns.
        quantity: String,
        /// Name of the first column.
        first: String,
        /// Name of the second column.
        second: String,
    },
    /// A line with another number of fields than the header.
    #[error("line {line} has {found} fields, the header has {expected}")]
    FieldCount {
        /// The line, from 1.
        line: u64,
        /// Number of its fields.
        found: usize,
        /// Number of fields in the header.
        expected: usize,
    },
    /// A field of a table that is not the expected number.
    #[error("{place}, column `{column}`: `{found}` is not {expected}")]
    Field {
        /// Line or row.
        place: FilePlace,
        /// Name of the column.
        column: String,
        /// Content of the field.
        found: String,
        /// Expected content.
        expected: &'static str,
    },
    /// The container of a recording, or a message in it, is invalid.
    #[error("not a valid recording")]
    Recording {
        /// Error of the reader.
        #[from]
        source: ReadError,
    },
    /// A recording with a position that is not a number.
    #[error("{place}: joint {joint} is at {found_rad} rad")]
    NotFinite {
        /// The sample.
        place: FilePlace,
        /// The joint.
        joint: Joint,
        /// Position of the joint, rad.
        found_rad: f64,
    },
    /// The file contains no samples.
    #[error("no joint positions in the file")]
    NoSamples,
    /// A sample that is earlier than the one before it.
    #[error("{place}: time runs backwards, from {previous_s} s to {t_s} s")]
    Backwards {
        /// The second of the two samples.
        place: FilePlace,
        /// Time of that sample, s.
        t_s: f64,
        /// Time of the sample before, s.
        previous_s: f64,
    },
    /// Two samples at one time with different positions.
    #[error("{place}: a second sample at {t_s} s, with other positions")]
    SameTime {
        /// The second sample.
        place: FilePlace,
        /// Time of both samples, s.
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
        place: FilePlace,
        /// The joint.
        joint: Joint,
        /// Position of the joint, read as rad.
        found_rad: f64,
    },
    /// An angle in degrees that no LBR iiwa reaches.
    #[error(
        "{place}: joint {joint} at {found_deg} degrees, and no LBR iiwa turns further than 175: \
         not an LBR iiwa, or not degrees"
    )]
    OutOfReach {
        /// The sample.
        place: FilePlace,
        /// The joint.
        joint: Joint,
        /// Position of the joint, degrees.
        found_deg: f64,
    },
    /// A speed that no LBR iiwa reaches.
    #[error(
        "joint {joint} turns at {found_rad_s:.1} rad/s about {t_s:.3} s, where at most \
         {max_rad_s:.1} rad/s are possible: wrong units (degrees as radians, or a time that is not \
         in seconds), wrong robot, or positions that jump"
    )]
    TooFast {
        /// The joint.
        joint: Joint,
        /// Time, s.
        t_s: f64,
        /// Mean speed over a section of at least 0.05 s, rad/s.
        found_rad_s: f64,
        /// Highest accepted speed, rad/s.
        max_rad_s: f64,
    },
    /// An implausible sample rate for the motion of a robot.
    #[error(
        "implausible sample rate: {:.3} Hz; is the time column in seconds?",
        .period_s.recip()
    )]
    Rate {
        /// Time between consecutive samples, s: the median if it is too long, the mean if it is too
        /// short.
        period_s: f64,
    },
    /// A position outside the joint range of the robot.
    #[error(
        "joint {joint} is at {:.2} degrees at {t_s:.3} s, and the range of {robot} ends at {:.2}: \
         wrong robot or wrong units",
        found_rad.to_degrees(), limit_rad.to_degrees()
    )]
    OutsideLimits {
        /// Name of the robot.
        robot: String,
        /// The joint.
        joint: Joint,
        /// Time, s.
        t_s: f64,
        /// Position of the joint, rad.
        found_rad: f64,
        /// Nearest bound of the joint range, rad.
        limit_rad: f64,
    },
    /// A recording of another built-in robot.
    #[error("recorded on another robot: {found}, not {expected}")]
    WrongRobot {
        /// Robot of the recording.
        found: String,
        /// Robot that the recording was checked against.
        expected: String,
    },
    /// A recording without motion.
    #[error("no motion: no joint moves by more than {max_rad:.1e} rad in {duration_s:.3} s")]
    NoMotion {
        /// Largest extent of any joint, rad.
        max_rad: f64,
        /// Time from the first sample to the last, s.
        duration_s: f64,
    },
}
