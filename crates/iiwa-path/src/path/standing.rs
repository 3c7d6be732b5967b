//! A path whose waits overlap its motions: how long the arm stands for them is found with time stamps.

use std::sync::Arc;

use super::JointPath;
use crate::{overlapping_wait::OverlappingWait, step::Step};
use iiwa_program::MotionIndex;

impl JointPath {
    /// The waits that overlap motions, in order. Where the arm stops anyway, each of them is a [`Step::Wait`] of 0 s; before
    /// a blend it is no step.
    #[must_use]
    pub fn overlapping_waits(&self) -> &[OverlappingWait] {
        self.carried.overlapping_waits()
    }

    /// The waits that overlap the motion before a blend: those between the two motions that the step at `step` joins. None
    /// of other steps.
    #[must_use]
    pub fn waits_before_blend(&self, step: usize) -> &[OverlappingWait] {
        let Some(Step::Move { motion: next, blend: Some(corner), .. }) = self.steps.get(step)
        else {
            return &[];
        };
        let waits = self.overlapping_waits();
        let before = |motion: MotionIndex| waits.partition_point(|wait| wait.motion < motion);
        &waits[before(corner.motion)..before(*next)]
    }

    /// Has the arm stop before the step at `step`, and stand there for its [waits](Self::waits_before_blend), as yet for
    /// 0 s each. From there it goes on along the same path.
    pub fn stop_before_blend(&mut self, step: usize) {
        let waits = self.waits_before_blend(step).iter();
        let stands: Vec<_> =
            waits.map(|wait| Step::Wait { motion: wait.motion, seconds: 0.0 }).collect();
        Arc::make_mut(&mut self.steps).splice(step..step, stands);
    }

    /// Sets for how long the arm stands in steps that are waits, from the step at `first` on, in s. Other steps take the
    /// place of a number and are passed over.
    pub fn set_standing(&mut self, first: usize, seconds: &[f64]) {
        let steps = Arc::make_mut(&mut self.steps).iter_mut().skip(first);
        for (step, standing_s) in steps.zip(seconds) {
            if let Step::Wait { seconds, .. } = step {
                *seconds = *standing_s;
            }
        }
    }
}
