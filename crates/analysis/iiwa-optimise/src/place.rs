//! Search for the robot base position with the shortest cycle time.

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use iiwa_kin::{Mount, Pose};
use iiwa_program::Program;
use iiwa_traj::{PlanError, Trajectory};
use rayon::prelude::*;

use crate::{change_search::LEAST_S, optimiser::Optimiser};

/// A place of the robot: shift and rotation of its base from its present place, in its own frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[expect(clippy::exhaustive_structs, reason = "a place is written out in full")]
pub struct Place {
    /// Shift, in m.
    pub shift_m: [f64; 3],
    /// Rotation about the z axis, in rad.
    pub yaw_rad: f64,
}

impl Place {
    /// Returns the pose of the former base in the base at this place.
    #[must_use]
    pub fn cell(&self) -> Pose {
        Pose::from_xyz_abc(self.shift_m, [self.yaw_rad, 0.0, 0.0]).inverse()
    }

    /// Shifts along x, y and z, and the rotation.
    fn values(&self) -> [f64; 4] {
        let [x, y, z] = self.shift_m;
        [x, y, z, self.yaw_rad]
    }

    fn from_values([x, y, z, yaw_rad]: [f64; 4]) -> Self {
        Self { shift_m: [x, y, z], yaw_rad }
    }
}

/// Places that a search tries: all combinations of these values, in increasing order.
#[derive(Clone, Debug, PartialEq)]
#[expect(clippy::exhaustive_structs, reason = "a grid is written out in full")]
pub struct PlaceGrid {
    /// Shifts along x, y and z, in m, at least one each.
    pub shifts_m: [Vec<f64>; 3],
    /// Rotations about z, in rad, at least one.
    pub yaws_rad: Vec<f64>,
}

impl PlaceGrid {
    /// Largest number of places that the command and the Python package try: an hour for programs
    /// that take a tenth of a second to plan.
    pub const MOST_PLACES: usize = 50_000;

    /// Returns `steps` values at equal distances over a range, or the single value of a range of
    /// one.
    #[must_use]
    pub fn axis([from, to]: [f64; 2], steps: usize) -> Vec<f64> {
        if from == to {
            return vec![from];
        }
        let share = |step: usize| step as f64 / (steps.max(2) - 1) as f64;
        (0..steps).map(|step| from + share(step) * (to - from)).collect()
    }

    /// Number of places.
    #[must_use]
    pub fn count(&self) -> usize {
        self.axes().iter().fold(1, |count, axis| count.saturating_mul(axis.len()))
    }

    /// Returns true if gravity would turn with the base: the grid has rotations, and the robot is
    /// mounted neither upright nor hanging. Such a search has no meaning.
    #[must_use]
    pub fn turns_gravity(&self, mount: &Mount) -> bool {
        let [x, y, z] = mount.gravity_m_s2();
        self.yaws_rad.iter().any(|yaw_rad| *yaw_rad != 0.0) && x.hypot(y) > 1e-6 * z.abs()
    }

    fn axes(&self) -> [&[f64]; 4] {
        let [x, y, z] = &self.shifts_m;
        [x, y, z, &self.yaws_rad]
    }

    /// All places: x changes fastest, then y, then z.
    fn places(&self) -> Vec<Place> {
        let mut places = vec![[0.0; 4]];
        for (index, axis) in self.axes().into_iter().enumerate().rev() {
            let with = |place: &[f64; 4], value: f64| {
                let mut place = *place;
                place[index] = value;
                place
            };
            places = places
                .iter()
                .flat_map(|place| axis.iter().map(move |value| with(place, *value)))
                .collect();
        }
        places.into_iter().map(Place::from_values).collect()
    }
}

/// Rule for the trajectory of a program with the robot at another place.
pub type PlaceRule<'a> = &'a (dyn Fn(&Place, &Trajectory) -> bool + Sync);

/// A place with the cycle time of the program there.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct TimedPlace {
    /// The place.
    pub place: Place,
    /// Cycle time, in s; `None` if the robot cannot execute the program there.
    pub cycle_time_s: Option<f64>,
    /// `true` if the robot can execute the program there, but the rule of the search does not
    /// accept its trajectory: for example because the arm is too near to an obstacle.
    pub is_rejected: bool,
}

impl TimedPlace {
    /// Cycle time at a place that is not rejected, in s.
    fn accepted_time_s(&self) -> Option<f64> {
        self.cycle_time_s.filter(|_| !self.is_rejected)
    }
}

/// Result of a search for a place.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct PlaceMap {
    /// Cycle time at the present place, in s.
    pub cycle_time_s: f64,
    /// All places of the grid: x changes fastest, then y, then z.
    pub places: Vec<TimedPlace>,
    /// The fastest place that was found and is not rejected, on the grid or beside it; `None` if
    /// none saves a millisecond.
    pub best: Option<TimedPlace>,
    /// The program at the best place; without one, the program itself.
    pub program: Program,
    /// Number of plans that were compared.
    pub plans: u64,
}

impl PlaceMap {
    /// Cycle time of [`program`](Self::program), in s.
    #[must_use]
    pub fn changed_cycle_time_s(&self) -> f64 {
        self.best.and_then(|best| best.cycle_time_s).unwrap_or(self.cycle_time_s)
    }
}

/// Number of times that the steps of the grid are halved about the best place.
const HALVINGS: usize = 5;

impl Optimiser {
    /// Searches for the place of the robot at which `program` takes the shortest time: on a grid,
    /// and then about the best place of the grid in ever smaller steps. Each place is planned
    /// exactly; elbow angles are not changed. Joint positions stay as they are
    /// ([`Program::with_cell_at`]), and so does the mounting: a robot on a wall must not be turned,
    /// because gravity would turn with its base.
    ///
    /// # Errors
    ///
    /// If the program cannot be planned at the present place, or if the search is interrupted.
    pub fn place(&self, program: &Program, grid: &PlaceGrid) -> Result<PlaceMap, PlanError> {
        self.placed(program, grid, None)
    }

    /// As [`place`](Self::place), with only those places at which `rule` accepts the whole
    /// trajectory: for example because the arm keeps its distance from obstacles. The rule is
    /// applied at all places, also at slow ones.
    ///
    /// # Errors
    ///
    /// As for [`place`](Self::place).
    pub fn place_within(
        &self,
        program: &Program,
        grid: &PlaceGrid,
        rule: PlaceRule<'_>,
    ) -> Result<PlaceMap, PlanError> {
        self.placed(program, grid, Some(rule))
    }

    fn placed(
        &self,
        program: &Program,
        grid: &PlaceGrid,
        rule: Option<PlaceRule<'_>>,
    ) -> Result<PlaceMap, PlanError> {
        let plans = AtomicU64::new(0);
        let cycle_time_s = self.settings.cycle_times(&plans).plan(program)?.cycle_time_s();
        let timed = |places: Vec<Place>| self.timed(program, places, rule, &plans);
        let places = timed(grid.places());
        let mut best = fastest(&places);
        if let Some(best) = &mut best {
            self.refine(grid, best, timed);
        }
        self.check_stop()?;
        let saves = |place: &TimedPlace| {
            place.cycle_time_s.is_some_and(|place_s| cycle_time_s - place_s >= LEAST_S)
        };
        let best = best.filter(saves);
        let program = match &best {
            Some(best) => program.with_cell_at(&best.place.cell()),
            None => program.clone(),
        };
        Ok(PlaceMap { cycle_time_s, places, best, program, plans: plans.load(Relaxed) })
    }

    /// Moves the best place by steps along each axis, within the range of the grid, and halves the
    /// steps where none of them is faster.
    fn refine(
        &self,
        grid: &PlaceGrid,
        best: &mut TimedPlace,
        timed: impl Fn(Vec<Place>) -> Vec<TimedPlace>,
    ) {
        let bounds = grid.axes().map(|axis| {
            let low = axis.iter().copied().fold(f64::INFINITY, f64::min);
            (low, axis.iter().copied().fold(low, f64::max))
        });
        let mut steps: [f64; 4] = std::array::from_fn(|axis| {
            let (low, high) = bounds[axis];
            0.5 * (high - low) / (grid.axes()[axis].len().max(2) - 1) as f64
        });
        let mut halvings = 0;
        while halvings < HALVINGS && self.check_stop().is_ok() {
            let mut around = Vec::new();
            for axis in 0..4 {
                let (low, high) = bounds[axis];
                for step in [-steps[axis], steps[axis]] {
                    let mut place = best.place.values();
                    place[axis] = (place[axis] + step).max(low).min(high);
                    if place != best.place.values() {
                        around.push(Place::from_values(place));
                    }
                }
            }
            let all = [vec![*best], timed(around)].concat();
            match fastest(&all) {
                Some(next) if next != *best => *best = next,
                _ => {
                    steps = steps.map(|step| 0.5 * step);
                    halvings += 1;
                }
            }
        }
    }

    /// Plans the program at each of these places.
    fn timed(
        &self,
        program: &Program,
        places: Vec<Place>,
        rule: Option<PlaceRule<'_>>,
        plans: &AtomicU64,
    ) -> Vec<TimedPlace> {
        let all = places.into_par_iter().map_init(
            || self.settings.cycle_times(plans),
            |times, place| {
                let is_stopped = self.check_stop().is_err();
                let plan = || times.plan(&program.with_cell_at(&place.cell())).ok();
                let Some(plan) = (!is_stopped).then(plan).flatten() else {
                    return TimedPlace { place, cycle_time_s: None, is_rejected: false };
                };
                TimedPlace {
                    place,
                    cycle_time_s: Some(plan.cycle_time_s()),
                    is_rejected: rule.is_some_and(|rule| !rule(&place, &plan)),
                }
            },
        );
        all.collect()
    }
}

/// Returns the first place that is as fast as any other, apart from rounding, if any of them is not
/// rejected and the robot can execute the program there.
fn fastest(places: &[TimedPlace]) -> Option<TimedPlace> {
    /// A turn of the base alone shifts A1, and changes the cycle time by rounding.
    const EQUAL_S: f64 = 1e-6;

    let times = places.iter().filter_map(TimedPlace::accepted_time_s);
    let least_s = times.min_by(f64::total_cmp)?;
    let is_fast = |place: &&TimedPlace| {
        place.accepted_time_s().is_some_and(|place_s| place_s <= least_s + EQUAL_S)
    };
    places.iter().find(is_fast).copied()
}
