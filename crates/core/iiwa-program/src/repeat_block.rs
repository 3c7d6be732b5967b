//! Repeat blocks of programs.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use crate::{motion_index::MotionIndex, motion_label::MotionLabel};

/// Largest number of motions that the repeat blocks of a program have when written out. Each
/// segment of a spline and each shape of a load counts.
pub const MAX_REPEATED: usize = 100_000;

/// Largest total length of labels, sources and names in the repeat blocks of a program when written
/// out, in bytes.
pub(crate) const MAX_REPEATED_TEXT: usize = 16_000_000;

/// Deepest nesting of repeat blocks.
pub const MAX_REPEAT_DEPTH: usize = 8;

/// A block of motions that a program repeats.
///
/// The motion list of a program contains the motions of all rounds; the block states which motions
/// belong together.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RepeatBlock {
    /// Index of the first motion, from 0: in the motion list, for an inner block in a round of the
    /// outer block.
    pub first: usize,
    /// Number of motions per round, with the motions of inner blocks written out.
    pub motions: usize,
    /// Number of rounds.
    pub count: usize,
    /// Name and comment of the block, and the group of its motions.
    pub label: MotionLabel,
    /// Blocks within a round, in order.
    pub inner: Vec<Self>,
}

/// Round of a repeat block.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Round {
    /// Number of the round, from 1.
    pub number: usize,
    /// Number of rounds of the block.
    pub count: usize,
}

impl RepeatBlock {
    /// Indices of all motions, if the list or the round that `first` refers to starts at `base`.
    #[must_use]
    pub fn range(&self, base: usize) -> Range<usize> {
        let first = base.saturating_add(self.first);
        first..first.saturating_add(self.motions.saturating_mul(self.count))
    }

    /// Returns true if all rounds are the same; `equal` compares the motions at two indices. `base`
    /// is as for [`range`](Self::range), `length` the length of the motion list.
    pub(crate) fn is_intact(
        &self,
        base: usize,
        length: usize,
        equal: &impl Fn(usize, usize) -> bool,
    ) -> bool {
        let Range { start, end } = self.range(base);
        let is_whole = self.motions > 0 && self.count > 0 && end <= length;
        let inner_end = self.inner.last().map_or(0, |inner| inner.range(0).end);
        is_whole
            && inner_end <= self.motions
            && (start + self.motions..end).all(|index| equal(index, index - self.motions))
    }

    /// Depth of the nesting, 1 for a block without inner blocks.
    pub(crate) fn depth(&self) -> usize {
        1 + self.inner.iter().map(Self::depth).max().unwrap_or_default()
    }
}

/// Rounds of a motion in the blocks that contain the motion, from the outermost block on.
pub(crate) fn rounds_of(blocks: &[RepeatBlock], motion: MotionIndex) -> Vec<Round> {
    let (mut blocks, mut index) = (blocks, motion.index());
    let mut rounds = Vec::new();
    while let Some((block, within)) = enclosing(blocks, index) {
        rounds.push(Round { number: 1 + within / block.motions, count: block.count });
        (blocks, index) = (&block.inner, within % block.motions);
    }
    rounds
}

/// Counterpart of a motion in the first rounds of its enclosing blocks.
pub(crate) fn in_first_rounds(blocks: &[RepeatBlock], motion: MotionIndex) -> MotionIndex {
    let (mut blocks, mut index, mut base) = (blocks, motion.index(), 0);
    while let Some((block, within)) = enclosing(blocks, index) {
        base += block.first;
        (blocks, index) = (&block.inner, within % block.motions);
    }
    MotionIndex::new(base + index)
}

/// The block that contains the motion at `index`, and the offset of the motion in the block.
fn enclosing(blocks: &[RepeatBlock], index: usize) -> Option<(&RepeatBlock, usize)> {
    // Blocks are in order.
    let after = blocks.partition_point(|block| block.first <= index);
    let block = &blocks[after.checked_sub(1)?];
    block.range(0).contains(&index).then(|| (block, index - block.first))
}

/// Returns repeat blocks for motions in another order, with the inner blocks of those whose motions
/// do not follow each other any more. `origins` has the former index of each motion.
pub(crate) fn reordered_blocks(blocks: &[RepeatBlock], origins: &[usize]) -> Vec<RepeatBlock> {
    let mut all = Vec::new();
    add_reordered(blocks, 0, origins, &mut all);
    all.sort_by_key(|block| block.first);
    all
}

/// Adds the blocks of a list or of a round that starts at `base`.
fn add_reordered(
    blocks: &[RepeatBlock],
    base: usize,
    origins: &[usize],
    all: &mut Vec<RepeatBlock>,
) {
    for block in blocks {
        let range = block.range(base);
        if range.end > origins.len() {
            // The program has been changed since.
            continue;
        }
        let Some(first) = origins.iter().position(|origin| *origin == range.start) else {
            continue;
        };
        let there = origins.iter().skip(first).take(range.len()).copied();
        if there.eq(range.clone()) {
            all.push(RepeatBlock { first, ..block.clone() });
            continue;
        }
        for round in range.step_by(block.motions.max(1)) {
            add_reordered(&block.inner, round, origins, all);
        }
    }
}
