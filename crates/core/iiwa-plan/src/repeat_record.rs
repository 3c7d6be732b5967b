//! Times of repeat blocks.

use iiwa_program::{MotionLabel, RepeatBlock};
use serde::{Deserialize, Serialize};

/// Times of a repeat block. A round lasts from the start of its first motion to the start of the
/// motion after the round, or to the end of the program: with settling and waits. Inputs and
/// outputs that overlap motions count only if the robot waits for them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RepeatRecord {
    /// Name, comment and group, if the block has any of them.
    #[serde(flatten)]
    pub label: MotionLabel,
    /// Number of the first motion, from 1.
    pub first_motion: usize,
    /// Number of motions per round in the program.
    pub motions: usize,
    /// Number of rounds; of an inner block, per round of the outer block.
    pub count: usize,
    /// Depth of the nesting: 1, for an inner block 2 or more.
    pub depth: usize,
    /// Sum of the times of all rounds, in s; of an inner block, in all rounds of the outer block.
    pub duration_s: f64,
    /// Share of the cycle time, 0 to 1.
    pub share: f64,
    /// Time of the shortest round, in s.
    pub min_round_s: f64,
    /// Time of the longest round, in s.
    pub max_round_s: f64,
}

impl RepeatRecord {
    /// Records of blocks, each followed by those of its inner blocks. `start_s` returns the start
    /// of the first motion with a duration from an index on, or the cycle time.
    pub(crate) fn all(
        blocks: &[RepeatBlock],
        start_s: &impl Fn(usize) -> f64,
        cycle_time_s: f64,
    ) -> Vec<Self> {
        let mut records = Vec::new();
        add(&mut records, blocks, &[0], 1, start_s);
        for record in &mut records {
            record.share = if cycle_time_s > 0.0 { record.duration_s / cycle_time_s } else { 0.0 };
        }
        records
    }
}

/// Adds the records of blocks; `bases` are the indices at which the rounds with these blocks start.
fn add(
    records: &mut Vec<RepeatRecord>,
    blocks: &[RepeatBlock],
    bases: &[usize],
    depth: usize,
    start_s: &impl Fn(usize) -> f64,
) {
    for block in blocks {
        let rounds: Vec<usize> = bases
            .iter()
            .flat_map(|base| block.range(*base).step_by(block.motions.max(1)))
            .collect();
        let Some(first) = rounds.first() else { continue };
        let times_s = rounds.iter().map(|round| start_s(round + block.motions) - start_s(*round));
        let record = RepeatRecord {
            label: block.label.clone(),
            first_motion: first + 1,
            motions: block.motions,
            count: block.count,
            depth,
            duration_s: times_s.clone().sum(),
            share: 0.0,
            min_round_s: times_s.clone().fold(f64::INFINITY, f64::min),
            max_round_s: times_s.fold(0.0, f64::max),
        };
        records.push(record);
        add(records, &block.inner, &rounds, depth + 1, start_s);
    }
}
