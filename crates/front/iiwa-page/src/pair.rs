//! Page with two plans of a program, before and after its change, which plays both together.
//!
//! Each plan is shown by its own page, in a frame. The scripts of this page set the time of both.

use iiwa_log::PlanPiece;
use iiwa_report::ChangeTable;
use serde::Serialize;

use crate::{
    Page, PageError,
    page::{self, PagePart},
};

/// Parts of this page only.
const PARTS: [PagePart; 5] = [
    ("/*pair.css*/", include_str!("pair/pair.css")),
    ("/*plot.js*/", include_str!("page/plot.js")),
    ("/*timeline.js*/", include_str!("page/timeline.js")),
    ("/*player.js*/", include_str!("page/player.js")),
    ("/*main.js*/", include_str!("pair/main.js")),
];

/// Data of the page.
#[derive(Serialize)]
struct PairData<'a> {
    plans: [FramedPlan<'a>; 2],
    changes: &'a ChangeTable,
}

/// Plan before or after the change.
#[derive(Serialize)]
struct FramedPlan<'a> {
    end_s: f64,
    pieces: &'a [PlanPiece],
    /// Page of the plan.
    html: String,
}

impl<'a> FramedPlan<'a> {
    fn new(page: &'a Page) -> Result<Self, PageError> {
        let html = page.html()?.replacen("<html ", "<html class=\"framed\" ", 1);
        Ok(Self { end_s: page.end_s(), pieces: page.pieces(), html })
    }
}

/// Assembles a page with the plans before and after a change of a program, and the changes. Both
/// pages have to show a plan, see [`Page::of_program`].
///
/// # Errors
///
/// [`PageError::Json`].
pub fn pair_page(
    title: &str,
    plans: [&Page; 2],
    changes: &ChangeTable,
) -> Result<String, PageError> {
    let [before, after] = plans.map(FramedPlan::new);
    let pair = PairData { plans: [before?, after?], changes };
    page::assemble(include_str!("pair/page.html"), &PARTS, title, &pair)
}
