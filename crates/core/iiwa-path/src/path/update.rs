//! A path whose program changes in one motion.

use std::{ops::Range, sync::Arc};

use super::JointPath;
use crate::{
    builder::steps,
    carried::Carried,
    options::PathOptions,
    path_motion::{has_tools, path_motions},
    segment::Segment,
    step::Step,
};
use iiwa_program::{Fault, Motion, MotionIndex, MotionLimits, Program};

/// Which steps of a path an [update](JointPath::update) replaced. All others are what they were.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReplacedSteps {
    /// Their places before.
    pub before: Range<usize>,
    /// The places of those that came instead.
    pub after: Range<usize>,
}

impl JointPath {
    /// Makes this, the path of a program, that of `program`, which differs from it in one `motion`. Only what that
    /// motion has to do with is made anew: of its target, its two neighbours' blends and the lines between.
    ///
    /// # Errors
    ///
    /// If the program asks for something that this robot cannot do. The path then stays as it was.
    pub fn update(
        &mut self,
        program: &Program,
        options: PathOptions,
        motion: MotionIndex,
    ) -> Result<ReplacedSteps, Fault> {
        // Where a motion to a frame starts settles how it ends, and with it all that follows.
        // And waits that overlap motions have to do with all of these.
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
        let motions = path_motions(program)?;

        let limits = MotionLimits::of_motion(
            &self.robot,
            &program.motions[motion.index()],
            &program.workcell,
        );
        let changed = limits != self.limits[motion.index()];
        let is_same = |old: &Step, new: &Step| {
            let is_limited = matches!(new, Step::Move { motion: own, .. } if *own == motion);
            old.is_same(new) && !(changed && is_limited)
        };
        // What comes out as it was stays.
        let old = &self.steps[before.clone()];
        let count = old.len().min(new.len());
        let first = (0..count).take_while(|&i| is_same(&old[i], &new[i])).count();
        let pairs = old.iter().rev().zip(new.iter().rev()).take(count - first);
        let last = pairs.take_while(|(old, new)| is_same(old, new)).count();
        let replaced = before.start + first..before.end - last;
        new.truncate(new.len() - last);
        new.drain(..first);
        let after = replaced.start..replaced.start + new.len();

        self.carried = Arc::new(Carried::new(program));
        self.has_tools = has_tools(&motions);
        self.motions = Arc::new(motions);
        Arc::make_mut(&mut self.limits)[motion.index()] = limits;
        Arc::make_mut(&mut self.steps).splice(replaced.clone(), new);
        Ok(ReplacedSteps { before: replaced, after })
    }

    /// The steps that were made for the motions in `range`.
    fn steps_of(&self, range: &Range<usize>) -> Range<usize> {
        let motion = |step: &Step| match step {
            Step::Move { blend: Some(corner), .. } => corner.motion.index(),
            Step::Move { motion, .. }
            | Step::Corner { motion }
            | Step::Settle { motion, .. }
            | Step::Wait { motion, .. } => motion.index(),
        };
        let before = |bound: usize| self.steps.partition_point(|step| motion(step) < bound);
        before(range.start)..before(range.end)
    }
}

/// The motions whose steps may differ when the one at `index` does.
fn affected(motions: &[Motion], index: usize) -> Range<usize> {
    let is_ptp = |place: &usize| matches!(motions[*place], Motion::Ptp(_));
    let first = (0..index).rev().find(is_ptp).unwrap_or(index);
    // The next one is blended into the one after it.
    let last = (index + 1..motions.len()).filter(is_ptp).take(2).last().unwrap_or(index);
    first..last + 1
}

impl Step {
    /// Whether it is the same as one that was made of the same kinds of segments.
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
            (Self::Corner { motion }, Self::Corner { motion: other }) => motion == other,
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

/// Lines and blends of one shape follow from their ends and the directions there.
fn is_same_curve(a: &dyn Segment, b: &dyn Segment) -> bool {
    a.is_straight() == b.is_straight() && [0.0, 1.0].into_iter().all(|s| a.at(s) == b.at(s))
}
