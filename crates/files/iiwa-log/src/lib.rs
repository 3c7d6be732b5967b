//! Recordings of a KUKA LBR iiwa as MCAP files for ROS 2 tools and viewers.
//!
//! A [`Writer`] writes joint states, transforms, poses, motions and a trajectory, with times since
//! the start of the motion, compressed, into any [`Write`]. A [`Recorder`] records the robot while
//! it moves, into a file that is complete at every moment. [`Recording`] reads such a file back,
//! and [`Reader`] reads it entry by entry. A [`PlanWriter`] writes a plan, and a [`PlanRecord`] is
//! read back from its file. [`Topic`] lists the topics and their types. For other transports, an
//! [`Encoder`] encodes single messages, and an [`Arm`] computes their content.
//!
//! [`JointLog`] contains the joint positions over time only, from such a file, from CSV or from a
//! log of KUKA's `DataRecorder`. It rejects implausible data, and reports what a file has lost.
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
mod plan;
mod plan_metadata;
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
pub use encoder::{Encoder, Frame};
pub use entry::{Attachment, Entry, JointSample, Motion, MotionSample, PoseSample};
pub use error::{ReadError, WriteError};
pub use joint_log::{
    AngleUnit, CycleClock, JointLog, JointLogError, LogOptions, Loss, Place, Positions, Source,
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
