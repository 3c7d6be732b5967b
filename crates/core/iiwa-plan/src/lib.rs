//! Plans of motion programs: from a text or a file to the trajectory, its figures and its warnings.
//!
//! A [`ProgramSource`] is a program with the files that it names. A [`PlanRequest`] selects robot,
//! torque limit and override; its [`PlanOptions`] select path options and timing.
//! [`PlanRequest::plan`] returns the whole [`Plan`], [`PlanRequest::begin`] a [`Planning`], which
//! keeps the trajectory of one section at a time. [`PlanRequest`] reports all failures as an
//! [`Error`], with the place in the program's text if it is known.
//!
//! ```
//! use iiwa_plan::{PlanRequest, ProgramSource};
//!
//! let text = r#"{ "version": 1, "robot": "lbr_iiwa_14_r820", "start": { "joints_deg": [-20, 0, 0, 0, 0, 0, 0] },
//!     "motions": [{ "type": "ptp", "joints_deg": [20, 0, 0, 0, 0, 0, 0] }] }"#;
//! let plan = PlanRequest::default().plan(&ProgramSource::from_json(text)?)?;
//! assert_eq!(plan.robot().name(), "lbr_iiwa_14_r820");
//! assert!(plan.trajectory.cycle_time_s() > 0.8);
//! assert!(plan.warnings(&plan.figures()).is_empty());
//! # Ok::<(), iiwa_plan::Error>(())
//! ```

mod error;
mod plan;
mod plan_figures;
mod plan_gates;
mod plan_options;
mod plan_request;
mod planning;
mod program_source;
mod program_text;
mod rests_on;
mod torque_record;
mod warnings;

pub use error::Error;
pub use plan::Plan;
pub use plan_figures::{
    BlendRecord, CartesianRecord, ClearanceRecord, LateBlendRecord, LimitRecord, LimitShareRecord,
    MotionRecord, PlanFigures, SelfClearanceRecord, SingularityRecord, SourceRecord,
};
pub use plan_gates::{PlanGates, UnmetGates};
pub use plan_options::PlanOptions;
pub use plan_request::PlanRequest;
pub use planning::Planning;
pub use program_source::ProgramSource;
pub use program_text::ProgramText;
pub use rests_on::AssumptionRecord;
pub use torque_record::{EnergyRecord, LargestTorque, PowerRecord, TorqueRecord};
pub use warnings::warnings;
