//! Plans of motion programs: from a text or a file to the trajectory, its figures and its warnings.
//!
//! A [`ProgramSource`] is a program with the files that it names. A [`PlanRequest`] selects robot,
//! torque limit and speed override; its [`PlanOptions`] select path options and timing.
//! [`PlanRequest::plan`] returns the whole [`Plan`]. [`PlanRequest::begin`] returns a [`Planning`],
//! an iterator over the sections of the trajectory, from stop to stop: each section is planned when
//! the caller asks for it. [`PlanRequest`] reports all failures as an [`Error`], with the place in
//! the program's text if it is known.
//!
//! ```
//! use iiwa_plan::{PlanRequest, ProgramSource};
//!
//! let text = r#"{
//!     "version": 1,
//!     "robot": "lbr_iiwa_14_r820",
//!     "start": { "joints_deg": [-20, 0, 0, 0, 0, 0, 0] },
//!     "motions": [{ "type": "ptp", "joints_deg": [20, 0, 0, 0, 0, 0, 0] }]
//! }"#;
//! let plan = PlanRequest::default().plan(&ProgramSource::from_json(text)?)?;
//! assert_eq!(plan.robot().name(), "lbr_iiwa_14_r820");
//! assert!(plan.trajectory.cycle_time_s() > 0.8);
//! assert!(plan.warnings(&plan.figures()).is_empty());
//! # Ok::<(), iiwa_plan::Error>(())
//! ```

mod error;
mod io_rows;
mod limit_records;
mod meshes;
mod part_records;
mod plan;
mod plan_figures;
mod plan_gates;
mod plan_options;
mod plan_request;
mod planning;
mod program_source;
mod rests_on;
mod warnings;

pub use error::Error;
pub use limit_records::{
    ClearanceRecord, EnergyRecord, LargestTorque, LimitRecord, LimitShareRecord, LoadRecord,
    PowerRecord, SelfClearanceRecord, TorqueRecord,
};
pub use meshes::embedded_mesh;
pub use part_records::{
    BlendRecord, GroupRecord, LateBlendRecord, RepeatRecord, ShortenedBlendRecord,
};
pub use plan::Plan;
pub use plan_figures::{CartesianRecord, MotionRecord, PlanFigures, SingularityRecord};
pub use plan_gates::{GateRecord, GateRecords, PlanGates, UnmetGates, is_above};
pub use plan_options::PlanOptions;
pub use plan_request::PlanRequest;
pub use planning::Planning;
pub use program_source::{ProgramSource, ProgramText};
pub use rests_on::{AssumptionRecord, section_assumptions};
pub use warnings::warnings;
