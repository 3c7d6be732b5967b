//! Smallest clearances in the difference of two plans.

use iiwa_json::printable;
use iiwa_kin::part_name;
use iiwa_plan::{ClearanceRecord, PlanFigures, SelfClearanceRecord};
use serde::Serialize;

use crate::signed::signed;

/// A smallest distance in both plans.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct ClearanceChange<T> {
    old: T,
    new: T,
}

impl<T: ComparedDistance + Clone> ClearanceChange<T> {
    /// Distances of two plans; `None` if the distance of a plan is not known.
    pub(crate) fn new(
        plans: [&PlanFigures; 2],
        of: impl Fn(&PlanFigures) -> Option<&T>,
    ) -> Option<Self> {
        let [old, new] = plans.map(|figures| of(figures).cloned());
        Some(Self { old: old?, new: new? })
    }

    /// Describes both distances and their change; `subject` is the beginning of the sentence.
    pub(crate) fn sentence(&self, subject: &str) -> String {
        let [old_mm, new_mm] = [&self.old, &self.new].map(ComparedDistance::distance_mm);
        let [old, new] = [&self.old, &self.new].map(ComparedDistance::place);
        format!(
            "{subject} {old_mm:.1} mm before, {new_mm:.1} mm after: {} mm ({old} before, {new} \
             after)",
            signed(new_mm - old_mm, 1)
        )
    }
}

/// A smallest distance.
pub(crate) trait ComparedDistance {
    /// Distance, in mm.
    fn distance_mm(&self) -> f64;

    /// Parts and time, such as `link 5 to table at 1.200 s`.
    fn place(&self) -> String;
}

impl ComparedDistance for ClearanceRecord {
    fn distance_mm(&self) -> f64 {
        self.distance_mm
    }

    fn place(&self) -> String {
        let Self { link, obstacle, at_s, .. } = self;
        format!("{} to {} at {at_s:.3} s", part_name(*link), printable(obstacle))
    }
}

impl ComparedDistance for SelfClearanceRecord {
    fn distance_mm(&self) -> f64 {
        self.distance_mm
    }

    fn place(&self) -> String {
        let Self { link, other_link, at_s, .. } = self;
        format!("{} to {} at {at_s:.3} s", part_name(*link), part_name(*other_link))
    }
}
