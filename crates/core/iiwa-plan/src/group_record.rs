//! Times of groups of motions.

use std::collections::HashMap;

use serde::{Deserialize, Serialize};

/// Total of the motions that have the same `group`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GroupRecord {
    /// Name of the group.
    pub name: String,
    /// Number of motions, waits, inputs and outputs.
    pub motions: usize,
    /// Sum of the times of these motions, in s, without the settling after stops.
    pub duration_s: f64,
    /// Share of the cycle time, 0 to 1.
    pub share: f64,
    /// `false` if other motions lie between the motions of the group.
    pub contiguous: bool,
}

impl GroupRecord {
    /// Groups of motions, each with its group and its duration in s, in the order of their first
    /// motions.
    pub(crate) fn all<'a>(
        motions: impl Iterator<Item = (Option<&'a str>, f64)>,
        cycle_time_s: f64,
    ) -> Vec<Self> {
        let mut groups: Vec<Self> = Vec::new();
        let mut places = HashMap::new();
        let mut before = None;
        for (name, time_s) in motions {
            if let Some(name) = name {
                let place = *places.entry(name).or_insert(groups.len());
                if place == groups.len() {
                    groups.push(Self {
                        name: name.to_owned(),
                        motions: 0,
                        duration_s: 0.0,
                        share: 0.0,
                        contiguous: true,
                    });
                } else if before != Some(name) {
                    groups[place].contiguous = false;
                }
                groups[place].motions += 1;
                groups[place].duration_s += time_s;
            }
            before = name;
        }
        // Motions with a duration make the cycle time positive.
        for group in &mut groups {
            group.share = group.duration_s / cycle_time_s;
        }
        groups
    }
}
