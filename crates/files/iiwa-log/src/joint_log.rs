//! Joint positions over time, from any supported file format.

mod check;
mod columns;
mod error;
mod format;
mod loss;
mod options;
#[cfg(feature = "parquet")]
mod parquet;
mod recording;
mod row;
mod samples;
mod shown;
mod table;

use std::fmt;
use std::io::Write;

use iiwa_kin::Robot;
use serde::{Deserialize, Serialize};

pub use columns::joint_column;
pub use error::JointLogError;
pub use loss::{FilePlace, Loss};
pub use options::{AngleUnit, LogOptions, Positions};

use crate::RecordedRobotError;
use crate::recorded_robot::recorded_robot;

/// Joint positions over time, without the other content of a recording.
///
/// # Formats
///
/// [`read`](Self::read) detects the format by the content of a file, not by its name:
///
/// - An MCAP file with `/joint_states`, as this crate writes it. The robot is read from the
///   metadata record `iiwasim`; without that record, as in a file whose recorder was killed, from
///   `/robot_description`. The program is the attachment `program.json`.
/// - A table: a line of column names, then a line per sample, with commas, semicolons, tabs or
///   spaces between fields. Names may be quoted; case is ignored. The decimal separator is a point.
///   Lines that begin with `#` or `%` are comments; the header may be the last comment before the
///   data.
/// - An Apache Parquet file with such columns, with the feature `parquet`.
///
/// | column | accepted names |
/// |---|---|
/// | time, s | `t_s`, `time_s`, `time` or `t`; or both of `ZeitInSec` and `ZeitInNanoSec` |
/// | joint 1, rad | `joint_1`, `iiwa_joint_1`, `q1`, `q01` or `A1`, each with the suffix `_rad`, or without a suffix (a [`Loss`] reports the assumption) |
/// | joint 1, degrees | the same names with the suffix `_deg` |
/// | joint 1 of a KUKA `DataRecorder` | `axisQMsr_ROBOT[0]`, or else `axisQCmd_ROBOT[0]` or `axisQCmdT1m_ROBOT[0]` |
/// | torque of joint 1, Nm | `torque_1_nm`, `effort_1`, with or without `joint_` or `iiwa_joint_` before the number |
/// | torque of joint 1 of a KUKA `DataRecorder` | `axisTauMsr_ROBOT[0]`, with the controller's sign |
///
/// Torques are read if all seven columns exist. Torques in tables are those that the joints exert,
/// except in a `DataRecorder` log. Measured positions (`axisQMsr_`) have priority over commanded
/// ones, and these over the others; [`source`](Self::source) reports the choice. A `DataRecorder`
/// names the robot in its columns but no unit of its positions. All other columns are ignored.
/// [`LogOptions`] select commanded positions, and a unit.
///
/// # Errors and losses
///
/// A value that is missing or not a number, two samples at one time with different values, time
/// that runs backwards, positions or speeds that no LBR iiwa reaches: an error, with the line. A
/// file that ends early, a section without samples, a repeated sample: a [`Loss`]. Missing data are
/// never invented.
///
/// ```
/// use iiwa_log::JointLog;
///
/// let file = "t_s,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg,q7_deg\n\
///             0.0,0,0,0,90,0,0,0\n\
///             0.1,0,0,0,91,0,0,0\n";
/// let log = JointLog::read(file.as_bytes())?;
/// assert_eq!(log.t_s, [0.0, 0.1]);
/// assert_eq!(log.q_rad[0][3], 90_f64.to_radians());
/// assert!(log.losses.is_empty());
/// # Ok::<(), iiwa_log::JointLogError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct JointLog {
    /// Times, in s since an arbitrary origin, strictly increasing.
    pub t_s: Vec<f64>,
    /// Joint positions at these times, in rad.
    pub q_rad: Vec<[f64; 7]>,
    /// Torques at these times, in Nm, where the file has them; empty if the file has none. The
    /// torques of a plan are those that the joints exert; measured torques have the sign of the
    /// controller, which is the opposite one for KUKA.
    pub torques_nm: Vec<Option<[f64; 7]>>,
    /// Motion program of the recording, if known: JSON.
    pub program: Option<String>,
    /// `true` for a plan, which contains no measurements.
    pub is_plan: bool,
    /// Name of the robot, if the recording contains it.
    pub robot: Option<String>,
    /// Profile of the robot, if the recording contains it: JSON.
    pub profile: Option<String>,
    /// Cycle time stated by the recording, in s.
    pub cycle_time_s: Option<f64>,
    /// Clock of the stated cycle time.
    pub timed_by: CycleClock,
    /// Origin of the positions; `None` if they were not read.
    pub source: Option<PositionSource>,
    /// Parts of the motion that the file lacks, in the order of time.
    pub losses: Vec<Loss>,
}

/// Clock of a stated cycle time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[non_exhaustive]
pub enum CycleClock {
    /// Robot program: from its beginning to its end.
    #[default]
    RobotProgram,
    /// Commanded positions of the controller: from their first change to their last one, without
    /// standstill before and after, such as the settle time.
    CommandedPosition,
}

impl CycleClock {
    /// Name in recordings and in JSON.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::RobotProgram => "robot_program",
            Self::CommandedPosition => "commanded_position",
        }
    }

    /// Parses a name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        [Self::RobotProgram, Self::CommandedPosition].into_iter().find(|it| it.name() == name)
    }
}

/// Origin of joint positions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[non_exhaustive]
pub enum PositionSource {
    /// `/joint_states` of an MCAP file.
    Mcap,
    /// Table with a column per joint.
    Table,
    /// Measured positions of a `DataRecorder` (`axisQMsr_`).
    Measured,
    /// Commanded positions of a `DataRecorder` (`axisQCmd_`).
    Commanded,
}

impl fmt::Display for PositionSource {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Mcap => "/joint_states of an MCAP file",
            Self::Table => "a table",
            Self::Measured => "a DataRecorder log, measured positions (axisQMsr)",
            Self::Commanded => "a DataRecorder log, commanded positions (axisQCmd)",
        })
    }
}

impl JointLog {
    /// Creates a log of these positions at these times.
    #[must_use]
    pub fn new(t_s: Vec<f64>, q_rad: Vec<[f64; 7]>) -> Self {
        Self { t_s, q_rad, ..Self::default() }
    }

    /// Writes a table that [`read`](Self::read) reads back to the same times and positions: the
    /// columns `t_s` and `joint_1_rad` to `joint_7_rad`, separated by commas; if all samples have
    /// torques, also the exerted torques as `torque_1_nm` to `torque_7_nm`.
    ///
    /// # Errors
    ///
    /// Errors of the stream.
    pub fn write_csv<W: Write>(&self, mut stream: W) -> std::io::Result<()> {
        stream.write_all(b"t_s")?;
        for joint in 1..=7 {
            write!(stream, ",joint_{joint}_rad")?;
        }
        let torques: Vec<_> = self.exerted_nm().map_while(|known| known).collect();
        let with_torques = !torques.is_empty() && torques.len() == self.t_s.len();
        if with_torques {
            for joint in 1..=7 {
                write!(stream, ",torque_{joint}_nm")?;
            }
        }
        stream.write_all(b"\n")?;
        for (i, (t_s, q_rad)) in self.t_s.iter().zip(&self.q_rad).enumerate() {
            // Shortest text that gives the same number.
            write!(stream, "{t_s:?}")?;
            let torques = torques.get(i).filter(|_| with_torques);
            for number in q_rad.iter().chain(torques.into_iter().flatten()) {
                write!(stream, ",{number:?}")?;
            }
            stream.write_all(b"\n")?;
        }
        stream.flush()
    }

    /// Robot of the recorded profile, or the built-in robot that the recording names; `None` if the
    /// recording contains neither.
    ///
    /// # Errors
    ///
    /// [`RecordedRobotError`] if the recording names a robot that is not built in and lacks its
    /// profile, or its profile cannot be read.
    pub fn recorded_robot(&self) -> Result<Option<Robot>, RecordedRobotError> {
        recorded_robot(self.robot.as_deref(), self.profile.as_deref())
    }

    /// Torques that the joints exert, in Nm, where the file has torques: the torques of a plan
    /// unchanged, measured ones negated, since KUKA's controller uses the opposite sign.
    pub fn exerted_nm(&self) -> impl Iterator<Item = Option<[f64; 7]>> {
        let sign = if self.is_plan { 1.0 } else { -1.0 };
        self.torques_nm.iter().map(move |torques| torques.map(|nm| nm.map(|it| sign * it)))
    }

    /// Time from the first sample to the last, s.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        match (self.t_s.first(), self.t_s.last()) {
            (Some(first), Some(last)) => last - first,
            _ => 0.0,
        }
    }

    /// Median time between consecutive samples, s. `None` for fewer than two samples.
    #[must_use]
    pub fn period_s(&self) -> Option<f64> {
        let mut steps: Vec<f64> = self.t_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
        if steps.is_empty() {
            return None;
        }
        let middle = steps.len() / 2;
        let (_, median, _) = steps.select_nth_unstable_by(middle, f64::total_cmp);
        Some(*median)
    }
}
