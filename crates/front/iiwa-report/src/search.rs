//! Reports of program optimisation, task order and robot placement (feature `optimise`).

mod advice_report;
mod change_rows;
mod optimum_report;
mod order_report;
mod place_report;

pub use advice_report::AdviceReport;
pub use change_rows::ChangeTable;
pub use optimum_report::OptimumReport;
pub use order_report::OrderReport;
pub use place_report::PlaceReport;

pub(crate) use place_report::PlaceRow;
