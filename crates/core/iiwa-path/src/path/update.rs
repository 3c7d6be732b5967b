//! Update of a path after a change of one motion.

use std::{
    ops::{Range, RangeInclusive},
    sync::Arc,
};

use super::JointPath;
use crate::{
    builder::steps, carried::Carried, legs::Legs, options::PathOptions, segment::Segment,
    step::Step,
};
use iiwa_program::{Fault, Motion, MotionIndex, MotionLimits, Program};

/// Steps that an [update](JointPath::update) replaced. All other steps are unchanged.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReplacedSteps {
    /// Indices of the replaced steps in the old path.
    pub before: Range<usize>,
    /// Indices of the new steps in the new path.
    pub after: Range<usize>,
}

impl JointPath {
    /// Lists the motions of `program`, from which the path was built, so that its first
    /// [update](Self::update) recomputes as little as later ones. Without this call, the first
    /// update of a program with frames recomputes all motions.
    ///
    /// # Errors
    ///
    /// None for the program of the path.
    pub fn prepare_updates(&mut self, program: &Program) -> Result<(), Fault> {
        self.legs = Legs::new(program, &self.robot)?.listed().cloned();
        Ok(())
    }

    /// Changes the path of a program into that of `program`, which differs in one `motion`.
    /// Recomputes only what depends on that motion: the blends at its target and at those of its
    /// two neighbours, and the lines in between. A motion to a frame may end in other joints if it
    /// starts in others: motions after a changed one are recomputed up to the first that starts
    /// where it did, within rounding (1e-12 rad). `options` have to be those of the path.
    ///
    /// # Errors
    ///
    /// If the program requires something that this robot cannot do. The path is then unchanged.
    pub fn update(
        &mut self,
        program: &Program,
        options: PathOptions,
        motion: MotionIndex,
    ) -> Result<ReplacedSteps, Fault> {
        self.update_all(program, options, motion..=motion)
    }

    /// As [`update`](Self::update), for a program that differs in the motions of a range.
    ///
    /// # Errors
    ///
    /// As for [`update`](Self::update).
    pub fn update_all(
        &mut self,
        program: &Program,
        options: PathOptions,
        motions: RangeInclusive<MotionIndex>,
    ) -> Result<ReplacedSteps, Fault> {
        let motions = motions.start().index()..motions.end().index() + 1;
        let all = 0..program.motions.len();
        if program.has_frames() {
            program.check_motions(all.clone(), self.robot.limits())?;
        }
        let (legs, mut range) =
            Legs::changed(program, &self.robot, self.legs.as_ref(), motions.clone())?;
        // A wait that overlaps motions affects all of them.
        let overlaps = program.motions.iter().any(Motion::is_overlapping_wait);
        if overlaps || !self.overlapping_waits().is_empty() {
            range = all;
        }
        if !program.has_frames() {
            program.check_motions(range.clone(), self.robot.limits())?;
        }
        let before = self.steps_of(&range);
        let mut new = steps(program, &self.robot, options, &legs, range)?;
        let carried = Carried::new(program)?;

        let limits: Vec<_> = program.motions[motions.clone()]
            .iter()
            .map(|entry| MotionLimits::of_motion(&self.robot, entry, &program.workcell))
            .collect();
        // Equal curves with other limits are replaced as well: their timing changes. In T1, so it
        // does with another TCP.
        let changed: Vec<_> = motions
            .clone()
            .zip(&limits)
            .filter(|(index, limits)| {
                **limits != self.limits[*index] || carried.tcp(*index) != self.carried.tcp(*index)
            })
            .map(|(index, _)| MotionIndex::new(index))
            .collect();
        let is_same = |old: &Step, new: &Step| {
            let is_limited =
                matches!(new, Step::Move { motion: index, .. } if changed.contains(index));
            old.is_same(new) && !is_limited
        };
        // New steps that are equal to the old ones are not replaced.
        let old = &self.steps[before.clone()];
        let count = old.len().min(new.len());
        let first = (0..count).take_while(|&i| is_same(&old[i], &new[i])).count();
        let pairs = old.iter().rev().zip(new.iter().rev()).take(count - first);
        let last = pairs.take_while(|(old, new)| is_same(old, new)).count();
        let replaced = before.start + first..before.end - last;
        new.truncate(new.len() - last);
        new.drain(..first);
        let after = replaced.start..replaced.start + new.len();

        // All that can fail precedes the first change: after an error, the path is unchanged.
        self.carried = Arc::new(carried);
        self.legs = legs.listed().cloned();
        Arc::make_mut(&mut self.limits)[motions].copy_from_slice(&limits);
        Arc::make_mut(&mut self.steps).splice(replaced.clone(), new);
        Ok(ReplacedSteps { before: replaced, after })
    }

    /// Indices of the steps of the motions in `range`.
    fn steps_of(&self, range: &Range<usize>) -> Range<usize> {
        let motion = |step: &Step| match step {
            // A blend is built with the motion that it ends, but has the limits of the next one.
            Step::Move { blend: Some(corner), .. } => corner.motion.index(),
            Step::Move { motion, .. }
            | Step::Corner { motion, .. }
            | Step::Settle { motion, .. }
            | Step::Wait { motion, .. } => motion.index(),
        };
        let before = |bound: usize| self.steps.partition_point(|step| motion(step) < bound);
        before(range.start)..before(range.end)
    }
}

impl Step {
    /// True if the step equals another one whose segments have the same kinds of shapes.
    fn is_same(&self, other: &Self) -> bool {
        match (self, other) {
            (
                Self::Move { motion, segment, blend, limits },
                Self::Move {
                    motion: other_motion,
                    segment: other_segment,
                    blend: other_blend,
                    limits: other_limits,
                },
            ) => {
                motion == other_motion
                    && blend == other_blend
                    && limits == other_limits
                    && is_same_curve(segment.as_ref(), other_segment.as_ref())
            }
            (
                Self::Corner { motion, place },
                Self::Corner { motion: other, place: other_place },
            ) => motion == other && place == other_place,
            (
                Self::Settle { motion, blocking, still },
                Self::Settle { motion: of, blocking: other, still: as_still },
            ) => (motion, blocking, still) == (of, other, as_still),
            (
                Self::Wait { motion, seconds },
                Self::Wait { motion: other, seconds: other_seconds },
            ) => motion == other && seconds.to_bits() == other_seconds.to_bits(),
            _ => false,
        }
    }
}

/// True if two segments are equal: lines and blends of one shape follow from their ends and the
/// directions there.
fn is_same_curve(a: &dyn Segment, b: &dyn Segment) -> bool {
    a.is_straight() == b.is_straight() && [0.0, 1.0].into_iter().all(|s| a.at(s) == b.at(s))
}
