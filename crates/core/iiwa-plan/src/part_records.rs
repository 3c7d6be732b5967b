//! Times of the parts of a plan: blends, groups of motions, repeat blocks.

use std::collections::HashMap;

use iiwa_path::ShortenedBlend;
use iiwa_program::{MotionLabel, RepeatBlock};
use iiwa_traj::{BlendFigures, LateBlend};
use serde::{Deserialize, Serialize};

/// A blend between two motions.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BlendRecord {
    /// Motion whose target is blended, from 1.
    pub after_motion: usize,
    /// Angle between the two motions, in deg: between the TCP directions in a blend between two
    /// paths of one TCP on which the wrist joints are not interpolated, otherwise in joint space.
    pub gamma_deg: f64,
    /// Joint positions at the start of the blend, in rad.
    pub start_rad: [f64; 7],
    /// Joint positions at the end of the blend, in rad.
    pub end_rad: [f64; 7],
    /// Joint positions at the middle of the blend, in rad.
    pub mid_rad: [f64; 7],
    /// Flange position at the middle of the blend, in m; despite the name, also with a tool.
    pub mid_tcp_m: [f64; 3],
    /// Start time, in s.
    pub start_s: f64,
    /// End time, in s.
    pub end_s: f64,
    /// Difference from the radius in the program, if the blend is smaller.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shortened: Option<ShortenedBlendRecord>,
}

/// Radius of a blend that would exceed half of a motion or, next to a spline, half of the spline's
/// first or last segment.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ShortenedBlendRecord {
    /// Motion of which the blend takes half, from 1.
    pub half_of_motion: usize,
    /// Radius in the program, in mm.
    pub asked_mm: f64,
    /// Distance of the TCP from the target at the end of the blend, in mm.
    pub used_mm: f64,
}

/// A blend into a motion that is not known in time: the robot stops at the start of the blend.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LateBlendRecord {
    /// Motion whose target is blended, from 1.
    pub after_motion: usize,
    /// Time at which the next motion is known, after the preceding waits, in s.
    pub known_s: f64,
    /// Latest time at which the next motion would have to be known to avoid the stop, in s.
    pub needed_s: f64,
}

impl From<&LateBlend> for LateBlendRecord {
    fn from(late: &LateBlend) -> Self {
        let LateBlend { after_motion, known_s, needed_s } = *late;
        Self { after_motion: after_motion.number(), known_s, needed_s }
    }
}

impl From<&BlendFigures> for BlendRecord {
    fn from(figures: &BlendFigures) -> Self {
        Self {
            after_motion: figures.motion.number(),
            gamma_deg: figures.gamma_deg,
            start_rad: figures.start_rad,
            end_rad: figures.end_rad,
            mid_rad: figures.mid_rad,
            mid_tcp_m: figures.mid_tcp_m,
            start_s: figures.start_s,
            end_s: figures.end_s,
            shortened: figures.shortened.as_ref().map(ShortenedBlendRecord::from),
        }
    }
}

impl From<&ShortenedBlend> for ShortenedBlendRecord {
    fn from(shortened: &ShortenedBlend) -> Self {
        let ShortenedBlend { half_of, asked_mm, used_mm } = *shortened;
        Self { half_of_motion: half_of.number(), asked_mm, used_mm }
    }
}

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
