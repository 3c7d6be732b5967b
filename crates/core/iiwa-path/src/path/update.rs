//! Update of a path after a change of one motion.

use std::{ops::Range, sync::Arc};

use super::JointPath;
use crate::{builder::steps, carried::Carried, options::PathOptions, segment::Segment, step::Step};
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
    /// Changes the path of a program into that of `program`, which differs in one `motion`.
    /// Recomputes only what depends on that motion: the blends at its target and at those of its
    /// two neighbours, and the lines in between.
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
        // A motion to a frame ends in joints that depend on its start, and so do all motions after
        // it. A wait that overlaps motions also affects all of them.
        let overlaps = |program: &Program| program.motions.iter().any(Motion::is_overlapping_wait);
        let range =
            if program.has_frames() || overlaps(program) || !self.overlapping_waits().is_empty() {
                0..program.motions.len()
            } else {
                affected(&program.motions, motion.index())
            };
        program.check_motions(range.clone(), self.robot.limits())?;
        let before = self.steps_of(&range);
        let mut new = steps(program, &self.robot, options, range)?;
        let carried = Carried::new(program)?;

        let limits = MotionLimits::of_motion(
            &self.robot,
            &program.motions[motion.index()],
            &program.workcell,
        );
        // Equal curves with other limits are replaced as well: their timing changes.
        let changed = limits != self.limits[motion.index()];
        let is_same = |old: &Step, new: &Step| {
            let is_limited = matches!(new, Step::Move { motion: index, .. } if *index == motion);
            old.is_same(new) && !(changed && is_limited)
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
        Arc::make_mut(&mut self.limits)[motion.index()] = limits;
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

/// Motions whose steps may change with the motion at `index`.
fn affected(motions: &[Motion], index: usize) -> Range<usize> {
    let is_ptp = |place: &usize| matches!(motions[*place], Motion::Ptp(_));
    // The motion before is blended into this one.
    let first = (0..index).rev().find(is_ptp).unwrap_or(index);
    // The next motion is blended into the one after it.
    let last = (index + 1..motions.len()).filter(is_ptp).take(2).last().unwrap_or(index);
    first..last + 1
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
