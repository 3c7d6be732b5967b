//! JSON output of a plan.

use iiwa_plan::PlanFigures;
use serde::Serialize;

/// Figures, and the path of the file.
#[derive(Serialize)]
pub(super) struct PlanAnswer<'a> {
    /// Program, if there are several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) program: Option<&'a str>,
    #[serde(flatten)]
    pub(super) figures: &'a PlanFigures,
    pub(super) output: Option<String>,
    /// Warnings about the program.
    pub(super) warnings: &'a [String],
}
