//! Cycle times at robot base positions, as text and as JSON.

use std::fmt::Write as _;

use iiwa_optimise::{PlaceGrid, PlaceMap, TimedPlace};
use serde::Serialize;

use crate::{
    signed::rounded,
    table::{fitted, table},
};

/// Cycle times of a program at robot base positions. As JSON, this is the object of
/// `iiwasim place --json`.
#[derive(Clone, Debug, Serialize)]
pub struct PlaceReport {
    /// Cycle time at the present place of the robot.
    cycle_time_s: f64,
    /// The fastest place that was found; none if no place saves a millisecond.
    pub(crate) best: Option<PlaceRow>,
    /// Number of joint positions, which stay as they are, among the targets of all rounds.
    joint_targets: usize,
    /// Number of plans that were compared.
    plans: u64,
    /// Number of places on the grid at which the arm is too near to an obstacle or to itself; none
    /// if places were not checked for collisions.
    #[serde(skip_serializing_if = "Option::is_none")]
    too_near: Option<usize>,
    /// Places on the grid: x changes fastest, then y, then z.
    places: Vec<PlaceRow>,
    /// Values of x and of y, in mm.
    #[serde(skip)]
    pub(crate) axes_mm: [Vec<f64>; 2],
}

/// A place of the robot, from its present place, and the cycle time there.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct PlaceRow {
    pub(crate) x_mm: f64,
    pub(crate) y_mm: f64,
    pub(crate) z_mm: f64,
    pub(crate) yaw_deg: f64,
    /// None if the robot cannot execute the program there.
    pub(crate) cycle_time_s: Option<f64>,
    /// True if the arm is too near to an obstacle or to itself; none if places were not checked for
    /// collisions.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) too_near: Option<bool>,
}

impl PlaceRow {
    fn new(timed: &TimedPlace, is_checked: bool) -> Self {
        let [x_mm, y_mm, z_mm] = timed.place.shift_m.map(|shift| rounded(1e3 * shift, 6));
        let yaw_deg = rounded(timed.place.yaw_rad.to_degrees(), 6);
        let cycle_time_s = timed.cycle_time_s.map(|time| rounded(time, 9));
        let too_near = is_checked.then_some(timed.is_rejected);
        Self { x_mm, y_mm, z_mm, yaw_deg, cycle_time_s, too_near }
    }

    pub(crate) fn is_too_near(&self) -> bool {
        self.too_near == Some(true)
    }

    /// Cycle time at a place that keeps the clearances, in s.
    pub(crate) fn accepted_time_s(&self) -> Option<f64> {
        self.cycle_time_s.filter(|_| !self.is_too_near())
    }
}

impl PlaceReport {
    /// Creates the report of a search on `grid`. `joint_targets` is the number of joint positions
    /// among the targets of the program, and `is_checked` says whether places were checked for
    /// collisions.
    #[must_use]
    pub fn new(map: &PlaceMap, grid: &PlaceGrid, joint_targets: usize, is_checked: bool) -> Self {
        let [x, y, _] = &grid.shifts_m;
        let row = |timed: &TimedPlace| PlaceRow::new(timed, is_checked);
        let places: Vec<_> = map.places.iter().map(row).collect();
        let too_near = places.iter().filter(|place| place.is_too_near()).count();
        Self {
            cycle_time_s: rounded(map.cycle_time_s, 9),
            best: map.best.as_ref().map(row),
            joint_targets,
            plans: map.plans,
            too_near: is_checked.then_some(too_near),
            places,
            axes_mm: [x, y].map(|axis| axis.iter().map(|value| rounded(1e3 * value, 6)).collect()),
        }
    }

    /// Writes the report as text, with tables that are at most `width` columns wide, if given.
    #[must_use]
    pub fn text(&self, width: Option<u16>) -> String {
        let Self { cycle_time_s, places, best, plans, .. } = self;
        let mut text = String::new();
        if let Some(layer) = self.layer() {
            let [x, y] = &self.axes_mm;
            let (z_mm, yaw_deg) = (layer[0].z_mm, layer[0].yaw_deg);
            let _ = writeln!(
                text,
                "Cycle time in s with the robot's base at x (across) and y (down), at z {z_mm} mm \
                 and a yaw of {yaw_deg} deg:\n"
            );
            let head: Vec<_> = x.iter().map(|x_mm| format!("x {x_mm} mm")).collect();
            let head = ["y mm"].into_iter().chain(head.iter().map(String::as_str));
            let mut rows = table(&head.collect::<Vec<_>>());
            for (y_mm, row) in y.iter().zip(layer.chunks(x.len())) {
                let times = row.iter().map(|place| match place.cycle_time_s {
                    Some(_) if place.is_too_near() => "too near".to_owned(),
                    Some(time) => format!("{time:.3}"),
                    None => "-".to_owned(),
                });
                rows.add_row([y_mm.to_string()].into_iter().chain(times));
            }
            text.push_str(&fitted(rows, width));
            text.push_str("\n\n");
        }
        let possible = places.iter().filter(|place| place.cycle_time_s.is_some()).count();
        let _ = writeln!(
            text,
            "The robot can execute the program at {possible} of {} places; {plans} plans compared",
            places.len()
        );
        match self.too_near {
            None => {}
            Some(_) if possible == 0 => {}
            Some(0) => text.push_str("The arm keeps its clearances at all of them\n"),
            Some(too_near) => {
                let _ = writeln!(
                    text,
                    "The arm is too near to an obstacle or to itself at {too_near} of them"
                );
            }
        }
        match best {
            Some(PlaceRow { x_mm, y_mm, z_mm, yaw_deg, cycle_time_s: Some(best_s), .. }) => {
                let [x, y, z, yaw] = [x_mm, y_mm, z_mm, yaw_deg].map(|value| rounded(*value, 1));
                let percent = 100.0 * (best_s / cycle_time_s - 1.0);
                let _ = writeln!(
                    text,
                    "Fastest at x {x} mm, y {y} mm, z {z} mm, yaw {yaw} deg: {best_s:.3} s instead \
                     of {cycle_time_s:.3} s, {:+.3} s ({percent:+.1} %)",
                    best_s - cycle_time_s
                );
            }
            _ => {
                let _ = writeln!(
                    text,
                    "No place{} saves a millisecond of the cycle time of {cycle_time_s:.3} s",
                    if self.is_checked() { " that keeps the clearances" } else { "" }
                );
            }
        }
        if best.as_ref().is_some_and(|best| self.is_at_edge(best)) {
            text.push_str("This is at the edge of a range: places beyond it may be faster.\n");
        }
        if self.joint_targets > 0 {
            text.push_str(
                "Targets in joints stay as they are: the TCP is elsewhere in the cell there.\n",
            );
        }
        if !self.is_checked() {
            text.push_str("Places are not checked for collisions.\n");
        }
        text
    }

    /// Returns true if places were checked for collisions.
    fn is_checked(&self) -> bool {
        self.too_near.is_some()
    }

    /// Returns true if a place has the first or the last value of an axis with several values.
    fn is_at_edge(&self, place: &PlaceRow) -> bool {
        let values = |row: &PlaceRow| [row.x_mm, row.y_mm, row.z_mm, row.yaw_deg];
        let (Some(first), Some(last)) = (self.places.first(), self.places.last()) else {
            return false;
        };
        let (first, last, place) = (values(first), values(last), values(place));
        (0..4).any(|axis| {
            first[axis] != last[axis] && [first[axis], last[axis]].contains(&place[axis])
        })
    }

    /// Places with the z and the yaw of the fastest place on the grid, if they differ in x or y. Of
    /// several layers that are as fast, apart from rounding, it is the first one, as in the search.
    pub(crate) fn layer(&self) -> Option<&[PlaceRow]> {
        const EQUAL_S: f64 = 1e-6;

        let per_layer = self.axes_mm[0].len() * self.axes_mm[1].len();
        let timed = |layer: &&[PlaceRow]| {
            let times = layer.iter().filter_map(PlaceRow::accepted_time_s);
            times.fold(f64::INFINITY, f64::min)
        };
        let mut layers = self.places.chunks(per_layer.max(1));
        let least_s = layers.clone().map(|layer| timed(&layer)).fold(f64::INFINITY, f64::min);
        layers.find(|layer| timed(layer) <= least_s + EQUAL_S).filter(|_| per_layer > 1)
    }
}
