//! Clearances that changes of a program have to keep.

use std::collections::BTreeMap;

use iiwa_program::MotionIndex;
use iiwa_traj::Trajectory;

use crate::{ArmInScene, CarriedBodies, PlannedClearance};

/// Clearances from obstacles and of the arm from itself that a changed program has to keep: each
/// motion a smallest one, or its own one before the change if that is less.
#[derive(Debug)]
pub struct AllowedClearances<'a> {
    arm: &'a ArmInScene,
    min_m: f64,
    /// Smallest clearance of each motion of the unchanged program, in m.
    motions_m: BTreeMap<MotionIndex, f64>,
    itself_m: f64,
}

impl<'a> AllowedClearances<'a> {
    /// Accuracy of clearances, in m.
    const ACCURACY_M: f64 = 1e-4;

    /// Measures the unchanged program, whose changes have to keep `min_m`.
    ///
    /// # Errors
    ///
    /// The first contact, if the unchanged program touches an obstacle: changes could not be told
    /// from it.
    pub fn new(
        arm: &'a ArmInScene,
        unchanged: &Trajectory,
        min_m: f64,
    ) -> Result<Self, PlannedClearance> {
        match arm.clearance_of(unchanged) {
            Some(nearest) if nearest.clearance.distance_m <= 0.0 => Err(nearest),
            _ => Ok(Self {
                arm,
                min_m,
                motions_m: clearances_m(arm, unchanged),
                itself_m: itself_m(arm, unchanged),
            }),
        }
    }

    /// Returns true if a changed program keeps the clearances.
    #[must_use]
    pub fn allow(&self, changed: &Trajectory) -> bool {
        self.allow_by(self.arm, changed, |motion| motion)
    }

    /// Returns true if a program keeps the clearances that consists of entries of the unchanged
    /// one: `origins` has the index there of each of its entries, and `bodies` are the shapes that
    /// it carries.
    #[must_use]
    pub fn allow_reordered(
        &self,
        bodies: &CarriedBodies,
        changed: &Trajectory,
        origins: &[usize],
    ) -> bool {
        self.allow_by(&self.arm.carrying(bodies), changed, |motion| {
            origins.get(motion.index()).map_or(motion, |origin| MotionIndex::new(*origin))
        })
    }

    fn allow_by(
        &self,
        arm: &ArmInScene,
        changed: &Trajectory,
        origin: impl Fn(MotionIndex) -> MotionIndex,
    ) -> bool {
        let least_m = |before_m: f64| self.min_m.min(before_m) - Self::ACCURACY_M;
        itself_m(arm, changed) >= least_m(self.itself_m)
            && clearances_m(arm, changed).into_iter().all(|(motion, clearance_m)| {
                let before_m = self.motions_m.get(&origin(motion)).copied();
                clearance_m >= least_m(before_m.unwrap_or(f64::INFINITY))
            })
    }
}

/// Smallest distance of each motion from the obstacles, in m.
fn clearances_m(arm: &ArmInScene, trajectory: &Trajectory) -> BTreeMap<MotionIndex, f64> {
    let mut motions_m = BTreeMap::new();
    let planned = trajectory.sections().iter().flat_map(|section| arm.clearances(section));
    for nearest in planned {
        let least_m = motions_m.entry(nearest.motion).or_insert(f64::INFINITY);
        *least_m = nearest.clearance.distance_m.min(*least_m);
    }
    motions_m
}

/// Smallest distance of the arm from itself, in m.
fn itself_m(arm: &ArmInScene, trajectory: &Trajectory) -> f64 {
    arm.self_clearance_of(trajectory).map_or(f64::INFINITY, |nearest| nearest.clearance.distance_m)
}
