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

    /// Returns true if the distances differ by `least_mm` or more, or if one of them is a contact.
    pub(crate) fn differs(&self, least_mm: f64) -> bool {
        let [old_mm, new_mm] = self.distances_mm();
        (new_mm - old_mm).abs() >= least_mm || (old_mm > 0.0) != (new_mm > 0.0)
    }

    /// Describes both distances and their change; `subject` is the beginning of the sentence.
    pub(crate) fn sentence(&self, subject: &str) -> String {
        let distances_mm = self.distances_mm();
        let [old_mm, new_mm] = distances_mm;
        let [old, new] = [&self.old, &self.new].map(ComparedDistance::place);
        let [before, after] = distances_mm.map(|distance_mm| {
            if distance_mm > 0.0 { format!("{distance_mm:.1} mm") } else { "contact".to_owned() }
        });
        format!(
            "{subject} {before} before, {after} after: {} mm ({old} before, {new} after)",
            signed(new_mm - old_mm, 1)
        )
    }

    fn distances_mm(&self) -> [f64; 2] {
        [&self.old, &self.new].map(ComparedDistance::distance_mm)
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
