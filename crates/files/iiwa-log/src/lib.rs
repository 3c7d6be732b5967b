//! Plans and recordings of a KUKA LBR iiwa: MCAP files for ROS 2 tools and viewers, and recordings
//! in other formats.
//!
//! | task | type |
//! |---|---|
//! | read positions and torques of a recording in any supported format | [`JointLog`] |
//! | read a whole MCAP recording, except `/tf` | [`Recording`]; entry by entry: [`Reader`] |
//! | record a moving robot | [`Recorder`] |
//! | write and read a plan | [`PlanWriter`], [`PlanRecord`] |
//! | write joint states, transforms, poses and motions into any [`Write`] | [`Writer`] |
//! | encode single messages for other transports | [`Encoder`] |
//!
//! A [`JointLog`] contains positions and torques over time, with the program and the robot if the
//! file states them, from an MCAP file, a table such as CSV, Parquet (feature `parquet`), or a log
//! of KUKA's `DataRecorder`. It rejects implausible data, and lists gaps, repeated samples and
//! assumed units as [`Loss`]. Between writes, the file of a [`Recorder`] is complete and indexed: a
//! killed process loses at most the last period, by default 1 s, and the sample after it. An
//! [`Arm`] computes the other contents of messages from joint positions: link frames, flange pose
//! and URDF; [`Topic`] lists the topics and their types.
//!
//! Lengths are in m, angles in rad, times in s. The same calls give the same bytes.
//!
//! ```
//! use std::io::Cursor;
//! use std::time::Duration;
//!
//! use iiwa_log::{Config, Recording, Writer};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let mut writer = Writer::new(Cursor::new(Vec::new()), Config::default())?;
//! for tick in 0..=250 {
//!     let t = Duration::from_millis(4 * tick);
//!     let angle = t.as_secs_f64();
//!     writer.joint_state(t, &[angle, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], &[1.0; 7], None)?;
//! }
//! let file = writer.finish()?.into_inner();
//!
//! let recording = Recording::from_bytes(&file)?;
//! assert_eq!(recording.joint_states.len(), 251);
//! assert_eq!(recording.joint_states[250].t_s, 1.0);
//! assert_eq!(recording.joint_states[250].q[0], 1.0);
//! # Ok(())
//! # }
//! ```
//!
//! [`Write`]: std::io::Write

mod arm;
mod cdr;
mod chunk;
mod compression;
mod container;
mod diagnostic;
mod encoder;
mod entry;
mod error;
mod joint_log;
mod message_blocks;
mod plan;
mod plan_record;
mod plan_size;
mod plan_table;
mod reader;
mod record;
mod recorded_log;
mod recorded_robot;
mod recorder;
mod recording;
mod ros;
mod storage;
mod tail;
mod template;
mod topic;
mod trajectory;
mod whole_file;
mod writer;

pub use arm::Arm;
pub use diagnostic::{Diagnostic, DiagnosticLevel};
pub use encoder::{Encoder, FramePose};
pub use entry::{Attachment, Entry, JointSample, MotionEntry, MotionSample, PoseSample};
pub use error::{ReadError, WriteError};
pub use joint_log::{
    AngleUnit, CycleClock, FilePlace, JointLog, JointLogError, LogOptions, Loss, PositionSource,
    Positions, joint_column,
};
pub use plan::{PlanConfig, PlanWriter, write_plan};
pub use plan_record::{PlanNode, PlanPiece, PlanRecord, PlanRecordError};
pub use plan_size::PlanSize;
pub use plan_table::PlanTable;
pub use reader::Reader;
pub use recorded_robot::RecordedRobotError;
pub use recorder::{Recorder, RecorderConfig, is_recording};
pub use recording::Recording;
pub use storage::Storage;
pub use topic::Topic;
pub use trajectory::{TrajectoryMessage, TrajectoryPoint};
pub use writer::{Config, DEFAULT_EPOCH, Writer};
