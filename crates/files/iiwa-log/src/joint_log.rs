//! What the joints did, whatever file it was in.

mod check;
mod columns;
mod error;
mod format;
mod loss;
mod options;
#[cfg(feature = "parquet")]
mod parquet;
mod recording;
mod samples;
mod shown;
mod table;

use std::fmt;
use std::io::Write;

use iiwa_kin::Robot;
use serde::{Deserialize, Serialize};

pub use error::JointLogError;
pub use loss::{Loss, Place};
pub use options::{AngleUnit, LogOptions, Positions};

use crate::RecordedRobotError;
use crate::recorded_robot::recorded_robot;

/// Joint positions over time: what is left of a recording when all else is taken away.
///
/// # Formats
///
/// [`read`](Self::read) tells by a file's content, not by its name, which of these it is:
///
/// - An MCAP file with `/joint_states`, as this crate writes. The robot is that of the metadata
///   record `iiwasim`; without one, as in a file whose recorder was killed, it is the one of
///   `/robot_description`. The program is the attachment `program.json`.
/// - A table: a line of column names, then a line a sample, with commas, semicolons, tabs or spaces
///   between fields. Names may be in quotes and in capitals or not. A decimal point is a point.
///
/// - An Apache Parquet file with such columns, with the feature `parquet`.
///
/// | column | accepted names |
/// |---|---|
/// | time, s | `t_s`, `time_s`, `time` or `t`; or both of `ZeitInSec` and `ZeitInNanoSec` |
/// | joint 1, rad | `joint_1`, `iiwa_joint_1`, `q1` or `A1`, with `_rad` behind it or nothing |
/// | joint 1, degrees | the same with `_deg` |
/// | joint 1 of a KUKA `DataRecorder` | `axisQMsr_ROBOT[0]`, or else `axisQCmd_ROBOT[0]` or `axisQCmdT1m_ROBOT[0]` |
/// | torque of joint 1, Nm | `torque_1_nm`, `effort_1`, with or without `joint_` or `iiwa_joint_` before the number |
/// | torque of joint 1 of a KUKA `DataRecorder` | `axisTauMsr_ROBOT[0]`, with the controller's sign |
///
/// Torques are read if all seven are there. In tables they are what joints exert, but for those of a `DataRecorder`.
/// Measured positions (`axisQMsr_`) are taken where there are any, then commanded ones, then the
/// others; [`source`](Self::source) says which it was. A `DataRecorder` names the robot in its
/// columns and no unit of its positions, and its header may begin with `%`. All other columns are passed over.
/// [`LogOptions`] choose commanded positions, and a unit.
///
/// # What is refused, and what is lost
///
/// A value that is missing or is no number, two samples of one time with different values, time
/// that runs backwards, positions or speeds that no LBR iiwa has: an error, with the line. A file
/// that breaks off, a section without samples, a sample that is there twice: a [`Loss`]. Nothing is
/// made up in its place.
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
    /// Times, in s from any instant; they increase strictly.
    pub t_s: Vec<f64>,
    /// Joint positions at these times, in rad.
    pub q_rad: Vec<[f64; 7]>,
    /// Torques at these times, in Nm, where the file has any; empty if it has none. Those of a plan are what the joints
    /// exert; those that a controller measured have the sign that it gives them, which KUKA's turns round.
    pub torques_nm: Vec<Option<[f64; 7]>>,
    /// The motion program that was run, if the recording has it: JSON.
    pub program: Option<String>,
    /// Whether it is a plan, of which nothing was measured.
    pub is_plan: bool,
    /// The robot's name, if the recording has it.
    pub robot: Option<String>,
    /// The robot's profile, if the recording has it: JSON.
    pub profile: Option<String>,
    /// The cycle time that the recording states, in s.
    pub cycle_time_s: Option<f64>,
    /// What that was taken from.
    pub timed_by: CycleClock,
    /// Where the positions were read; `None` if they were not read.
    pub source: Option<Source>,
    /// What the file does not have of the motion, in the order of time.
    pub losses: Vec<Loss>,
}

/// What a stated cycle time was taken from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[non_exhaustive]
pub enum CycleClock {
    /// The robot program: from its beginning to its end.
    #[default]
    RobotProgram,
    /// The positions that the controller commanded: from their first change to their last one, without standing before
    /// and after, such as the time to settle.
    CommandedPosition,
}

impl CycleClock {
    /// Its name in recordings and in JSON.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::RobotProgram => "robot_program",
            Self::CommandedPosition => "commanded_position",
        }
    }

    /// Of a name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        [Self::RobotProgram, Self::CommandedPosition].into_iter().find(|it| it.name() == name)
    }
}

/// Where joint positions were read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[non_exhaustive]
pub enum Source {
    /// `/joint_states` of an MCAP file.
    Mcap,
    /// A table with a column a joint.
    Table,
    /// `axisQMsr_` of a `DataRecorder`: measured positions.
    Measured,
    /// `axisQCmd_` of a `DataRecorder`, which had no measured ones: commanded positions.
    Commanded,
}

impl fmt::Display for Source {
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
    /// A log of these positions at these times.
    #[must_use]
    pub fn new(t_s: Vec<f64>, q_rad: Vec<[f64; 7]>) -> Self {
        Self { t_s, q_rad, ..Self::default() }
    }

    /// Writes a table that [`read`](Self::read) reads back to the same times and positions: the
    /// columns `t_s` and `joint_1_rad` to `joint_7_rad`, with commas between them; if all samples have torques,
    /// what the joints exert as `torque_1_nm` to `torque_7_nm`.
    ///
    /// # Errors
    ///
    /// If the stream refuses.
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
            // The shortest text that gives the same number.
            write!(stream, "{t_s:?}")?;
            let torques = torques.get(i).filter(|_| with_torques);
            for number in q_rad.iter().chain(torques.into_iter().flatten()) {
                write!(stream, ",{number:?}")?;
            }
            stream.write_all(b"\n")?;
        }
        stream.flush()
    }

    /// The robot of the recording's profile, or the built-in one that it names; none if it tells neither.
    ///
    /// # Errors
    ///
    /// [`RecordedRobotError`] if it names a robot that is not built in and has no profile of it, or its
    /// profile cannot be read.
    pub fn recorded_robot(&self) -> Result<Option<Robot>, RecordedRobotError> {
        recorded_robot(self.robot.as_deref(), self.profile.as_deref())
    }

    /// What the joints exert, in Nm, where the file has torques: those of a plan as they are, and measured ones turned,
    /// since KUKA's controller gives them the other sign.
    pub fn exerted_nm(&self) -> impl Iterator<Item = Option<[f64; 7]>> {
        let sign = if self.is_plan { 1.0 } else { -1.0 };
        self.torques_nm.iter().map(move |torques| torques.map(|nm| nm.map(|it| sign * it)))
    }

    /// From the first sample to the last, s.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        match (self.t_s.first(), self.t_s.last()) {
            (Some(first), Some(last)) => last - first,
            _ => 0.0,
        }
    }

    /// The usual time from one sample to the next, s: the median. `None` for fewer than two samples.
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
