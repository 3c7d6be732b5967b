//! Plans and recordings of the KUKA LBR iiwa as reports (Markdown), tables (text) and pictures
//! (SVG).
//!
//! All results are returned as text or as values that serialise to JSON. The crate reads and writes
//! no files, and prints nothing.
//!
//! - [`PlanPicture`] draws a plan while it is computed, [`draw_comparison`] a recording beside its
//!   plan, [`draw_places`] cycle times at robot base positions.
//! - [`ExperimentKind`] lists the experiments, those of the thesis (Larsen 2019) and those of this
//!   project, and writes the [`Chapter`] of each.
//! - [`AdviceReport`], [`ComparisonReport`], [`DifferenceReport`], [`IdentificationReport`],
//!   [`ImportReport`], [`OptimumReport`], [`OrderReport`], [`PlaceReport`], [`plan_table`] and
//!   [`Summary`] format results as text and tables.

mod causes;
mod comparison_report;
mod difference_clearance;
mod difference_groups;
mod difference_report;
mod difference_summary;
mod duration;
mod error_record;
#[cfg(feature = "experiments")]
mod experiment;
mod identification_report;
#[cfg(feature = "sunrise")]
mod import_report;
mod markdown;
mod picture;
mod plan_clearance;
mod plan_table;
mod robot_sheet;
mod run_report;
#[cfg(feature = "optimise")]
mod search;
mod signed;
mod stated_time;
mod summary;
mod table;
mod validation_report;
mod warning;

pub use causes::with_causes;
pub use comparison_report::ComparisonReport;
pub use difference_report::DifferenceReport;
pub use difference_summary::{DifferenceSummary, ProgramDifference};
pub use duration::long_duration;
pub use error_record::{ErrorRecord, ProgramErrors};
#[cfg(feature = "experiments")]
pub use experiment::{
    Bench, Chapter, ExperimentError, ExperimentKind, TrialRun, VirtualArm, motion_warning,
    other_robot, preface, wrapped,
};
pub use identification_report::IdentificationReport;
#[cfg(feature = "sunrise")]
pub use import_report::ImportReport;
#[cfg(feature = "optimise")]
pub use picture::draw_places;
pub use picture::{PictureError, PictureFormat, PlanPicture, draw_comparison};
pub use plan_clearance::{add_clearances, carried};
pub use plan_table::{assumption_lines, plan_table};
pub use robot_sheet::{robot_sheet, robots_table, rounded};
pub use run_report::RunReport;
#[cfg(feature = "optimise")]
pub use search::{AdviceReport, ChangeTable, OptimumReport, OrderReport, PlaceReport};
pub use summary::{PlannedTimes, Summary, SummaryRow};
pub use table::{fitted, table};
pub use validation_report::ValidationReport;
pub use warning::warning_lines;
