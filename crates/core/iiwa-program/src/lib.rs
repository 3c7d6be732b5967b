//! Motion programs of the KUKA LBR iiwa: motions, tools, bases and frames, and their JSON form. The
//! crate does not plan trajectories.
//!
//! ```
//! use iiwa_program::{Motion, Program};
//!
//! let program = Program::from_json(r#"{
//!     "version": 1,
//!     "tools": { "gripper": { "tcp": { "z_mm": 120 } } },
//!     "tool": "gripper",
//!     "start": { "joints_deg": [0, 30, 0, -60, 0, 90, 0] },
//!     "motions": [
//!         { "type": "ptp", "joints_deg": [0, 30, 0, -80, 0, 70, 0], "velocity_rel": 0.5 },
//!         { "type": "lin_rel", "offset": { "z_mm": 50 }, "cart_velocity_mm_s": 100 }
//!     ]
//! }"#)?;
//! assert!(matches!(program.motions[1], Motion::Cartesian(_)));
//! assert_eq!(program.tcps()?[1].position_m, [0.0, 0.0, 0.12]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A [`Program`] has a start, [`Motion`]s and a [`Workcell`] of tools, bases and frames.
//! [`Program::from_json`] reads a program and reports the place of a [`Fault`] in the text;
//! [`Program::from_deg`] builds a program in code.

mod all_faults;
mod at_motions;
mod blend;
mod cartesian_fault;
mod cartesian_motion;
mod fault;
mod flange_load;
mod io_entry;
mod io_value;
mod limit_kind;
mod motion_index;
mod motion_label;
mod motion_limits;
mod motion_list;
mod motion_path;
mod motion_type;
mod moved_cell;
mod name_place;
mod placed_frame;
mod program;
mod program_builder;
mod repeat_block;
mod source;
mod target;
mod task;
mod tasks;
mod tool_limits;
mod wire;
mod workcell;

pub use at_motions::{CarriedShapes, OverlappingWait, ShapesFrom};
pub use blend::{Blend, CART_MM_MIN, SUNRISE_REL_MIN};
pub use cartesian_fault::{CartesianFault, CourseFault};
pub use cartesian_motion::{
    AuxOrientation, CartesianMotion, Circ, Course, MAX_SEGMENTS, OrientationType, PathBlend,
    SegmentCourse, SegmentLimits, SplineSegment,
};
pub use fault::Fault;
pub use flange_load::{FlangeLoad, LoadShape, MAX_SHAPES, ShapeFault};
pub use iiwa_kin::{Load, Mount};
pub use io_entry::{IoEntry, IoKind, MAX_IO_NAME};
pub use io_value::IoValue;
pub use limit_kind::{ByKind, LimitKind};
pub use motion_index::MotionIndex;
pub use motion_label::{MAX_COMMENT, MAX_NAME, MotionLabel};
pub use motion_limits::{MotionLimits, TcpSpeedSource};
pub use motion_list::MotionList;
pub use motion_path::motion_path;
pub use motion_type::MotionType;
pub use placed_frame::PlacedFrame;
pub use program::{MAX_OVERLAP, Motion, Program, Ptp, Start};
pub use program_builder::ProgramBuilder;
pub use repeat_block::{MAX_REPEAT_DEPTH, MAX_REPEATED, RepeatBlock, Round};
pub use source::{Source, Sources, motion_origin, with_motions};
pub use target::{Frame, Target, TargetRef};
pub use task::{MAX_TASKS, Task, TaskFault};
pub use tasks::TaskMotions;
pub use tool_limits::ToolLimits;
pub use wire::{MAX_ERRORS, ProgramError};
pub use workcell::{
    Base, MAX_FLANGE_M, MAX_TORQUE_LIMIT, MIN_OVERRIDE, MIN_TORQUE_LIMIT, NameFault, OperatingMode,
    ROBOT, Tool, Workcell,
};
