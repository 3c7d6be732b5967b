//! Settings of a search.

use std::sync::{
    Arc,
    atomic::{AtomicBool, AtomicU64},
};

use iiwa_kin::Robot;
use iiwa_plan::PlanOptions;

use crate::{cycle_time::CycleTimes, freedom::Freedom};

/// Settings of a search for changes.
#[derive(Clone, Debug)]
pub(crate) struct SearchSettings {
    pub(crate) robot: Robot,
    pub(crate) options: PlanOptions,
    pub(crate) freedom: Freedom,
    pub(crate) max_blend_mm: f64,
    /// Number of plans of all searches.
    pub(crate) plans: Arc<AtomicU64>,
    pub(crate) stop: Arc<AtomicBool>,
}

impl SearchSettings {
    /// Returns a planner that counts its plans in `plans`, too.
    pub(crate) fn cycle_times<'a>(&'a self, plans: &'a AtomicU64) -> CycleTimes<'a> {
        CycleTimes::new(&self.robot, &self.options, &self.stop, [plans, &self.plans])
    }
}
