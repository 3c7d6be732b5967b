//! Changes of the load.

use iiwa_program::{Motion, MotionIndex, MotionLabel, Program, Source};
use serde::{Deserialize, Serialize};

/// Change of the load: a `load` entry of the program.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LoadRecord {
    /// Number in the program, from 1.
    pub index: usize,
    /// Name, comment and group, if the entry has any of them.
    #[serde(flatten)]
    pub label: MotionLabel,
    /// Mass of the load, in kg; `None` if the entry removes it, which leaves the tool's load.
    pub mass_kg: Option<f64>,
    /// Source line, if known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub source: Option<Source>,
}

impl LoadRecord {
    /// Changes of the load in a program, in order.
    pub(crate) fn all(program: &Program) -> Vec<Self> {
        let record = |(motion, entry): (_, &Motion)| {
            let Motion::Load(load) = entry else { return None };
            Some(Self {
                index: MotionIndex::number(motion),
                label: program.sources.label(motion).cloned().unwrap_or_default(),
                mass_kg: load.as_ref().map(|payload| payload.load.mass_kg),
                source: program.sources.of(motion).cloned(),
            })
        };
        program.entries().filter_map(record).collect()
    }
}
