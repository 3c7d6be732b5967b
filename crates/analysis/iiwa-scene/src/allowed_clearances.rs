//! Clearances that changes of a program have to keep.

use std::{collections::BTreeMap, iter::zip, sync::OnceLock};

use iiwa_kin::Pose;
use iiwa_program::MotionIndex;
use iiwa_traj::Trajectory;

use crate::{ArmInScene, CarriedBodies, IgnoredPair, Other, PlannedClearance};

/// Clearances from obstacles and of the arm from itself that a changed program has to keep: each
/// motion a smallest one, or its own one before the change if that is less.
#[derive(Debug)]
pub struct AllowedClearances<'a> {
    arm: &'a ArmInScene,
    unchanged: &'a Trajectory,
    min_m: f64,
    /// Smallest clearance of each motion of the unchanged program, in m.
    motions_m: BTreeMap<MotionIndex, f64>,
    itself_m: f64,
    here: OnceLock<Here>,
}

/// Distances from obstacles in the unchanged program.
#[derive(Debug)]
struct Here {
    /// Distance of links 0 and 1 from each obstacle, in m.
    base_m: Vec<f64>,
    near: Vec<NearPair>,
}

/// Part of the arm and obstacle that are nearer to each other in the unchanged program than changed
/// programs may be.
#[derive(Debug)]
struct NearPair {
    pair: IgnoredPair,
    /// Smallest distance of the pair in each motion, in m.
    motions_m: BTreeMap<MotionIndex, f64>,
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
        unchanged: &'a Trajectory,
        min_m: f64,
    ) -> Result<Self, PlannedClearance> {
        match arm.clearance_of(unchanged) {
            Some(nearest) if nearest.clearance.distance_m <= 0.0 => Err(nearest),
            _ => Ok(Self {
                arm,
                unchanged,
                min_m,
                motions_m: clearances_m(arm, unchanged),
                itself_m: itself_m(arm, unchanged),
                here: OnceLock::new(),
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

    /// Returns true if the program keeps the clearances with the robot at another place, where it
    /// has the trajectory `moved`. `cell` is the pose of the former robot base there, and
    /// `with_robot` the indices of the obstacles that move with the base
    /// ([`Scene::with_cell_at`](crate::Scene::with_cell_at)).
    ///
    /// A motion may have a smaller clearance than the smallest allowed one only between the same
    /// part of the arm and the same obstacle as in the unchanged program, and not a smaller one
    /// than there. A gripper that picks a part 2 mm above a table does so at each place, and no
    /// place could be found if it were rejected. [`allow`](Self::allow) accepts these 2 mm from any
    /// obstacle in that motion. At another place that would be too weak: the arm passes other
    /// obstacles there.
    ///
    /// Links 0 and 1 count as well, since the robot base moves: they have to keep the smallest
    /// clearance, or their own one at the former place if that is less. An obstacle that they touch
    /// at the former place carries the base: they are not checked against it, however far the base
    /// is lowered into it. Obstacles are not checked against each other.
    #[must_use]
    pub fn allow_elsewhere(&self, cell: &Pose, with_robot: &[usize], moved: &Trajectory) -> bool {
        let scene = self.arm.scene().with_cell_at(cell, with_robot);
        let arm = self.arm.among_obstacles_of(scene);
        let Here { base_m, near } = self.here.get_or_init(|| self.here());
        let motions_keep = |arm: &ArmInScene, before_m: &dyn Fn(MotionIndex) -> Option<f64>| {
            clearances_m(arm, moved).into_iter().all(|(motion, clearance_m)| {
                self.keeps(clearance_m, before_m(motion).unwrap_or(f64::INFINITY))
            })
        };
        zip(arm.base_clearances_m(), base_m).all(|(now_m, before_m)| self.keeps(now_m, *before_m))
            && self.keeps(itself_m(&arm, moved), self.itself_m)
            && motions_keep(&arm.checking(|pair| near.iter().all(|it| it.pair != pair)), &|_| None)
            && near.iter().all(|near| {
                let alone = arm.checking(|pair| pair == near.pair);
                motions_keep(&alone, &|motion| near.motions_m.get(&motion).copied())
            })
    }

    /// Returns the distances of the base, and the pairs that are nearer than `min_m` in any motion
    /// of the unchanged program.
    fn here(&self) -> Here {
        // Of all pairs, also those whose distance no motion changes.
        let here = self.arm.among_obstacles_of(self.arm.scene().clone());
        let mut pairs: Vec<IgnoredPair> = Vec::new();
        // The search for clearances finds the nearest pair of each motion; the next pair is found
        // without those before it.
        loop {
            let arm = here.checking(|pair| !pairs.contains(&pair));
            let sections = self.unchanged.sections().iter();
            let nearest = sections.flat_map(|section| arm.clearances(section));
            let before = pairs.len();
            for nearest in nearest.filter(|it| it.clearance.distance_m < self.min_m) {
                let Other::Obstacle(obstacle) = nearest.clearance.other else { continue };
                let pair = IgnoredPair { link: nearest.clearance.link, obstacle };
                if !pairs.contains(&pair) {
                    pairs.push(pair);
                }
            }
            if pairs.len() == before {
                break;
            }
        }
        let near = pairs.into_iter().map(|pair| {
            let alone = here.checking(|it| it == pair);
            NearPair { pair, motions_m: clearances_m(&alone, self.unchanged) }
        });
        Here { base_m: here.base_clearances_m(), near: near.collect() }
    }

    /// Returns true if a clearance is allowed where the unchanged program has `before_m`. What did
    /// not touch must not touch, whatever the smallest clearance.
    fn keeps(&self, clearance_m: f64, before_m: f64) -> bool {
        clearance_m >= self.min_m.min(before_m) - Self::ACCURACY_M
            && (clearance_m > 0.0 || before_m <= 0.0)
    }

    fn allow_by(
        &self,
        arm: &ArmInScene,
        changed: &Trajectory,
        origin: impl Fn(MotionIndex) -> MotionIndex,
    ) -> bool {
        self.keeps(itself_m(arm, changed), self.itself_m)
            && clearances_m(arm, changed).into_iter().all(|(motion, clearance_m)| {
                let before_m = self.motions_m.get(&origin(motion)).copied();
                self.keeps(clearance_m, before_m.unwrap_or(f64::INFINITY))
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
