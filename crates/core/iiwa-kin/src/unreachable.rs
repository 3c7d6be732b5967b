//! Reasons why a pose is out of reach.

use std::f64::consts::{FRAC_PI_2, PI};

/// A pose is out of reach, regardless of the joint ranges.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Unreachable {
    /// The arm is too short.
    #[error(
        "out of reach: the arm is {by_mm:.3} mm too short: the {point} would be {distance_mm:.3} \
         mm from the shoulder, and the stretched arm reaches {max_mm:.3} mm"
    )]
    TooFar {
        /// Distance of the point beyond the reach of the stretched arm, in mm.
        by_mm: f64,
        /// Point: `wrist`, or `TCP` if the positions of the wrist joints are given.
        point: &'static str,
        /// Distance from the shoulder to the point, in mm.
        distance_mm: f64,
        /// Distance that the stretched arm reaches, in mm.
        max_mm: f64,
    },
    /// The pose is too close to the shoulder.
    #[error(
        "out of reach: the {point} is {by_mm:.3} mm too near to the shoulder: it would be \
         {distance_mm:.3} mm from the shoulder, and the folded arm comes as near as {min_mm:.3} mm"
    )]
    TooNear {
        /// Distance by which the point is closer to the shoulder than the folded arm allows, in mm.
        by_mm: f64,
        /// Point: `wrist`, or `TCP` if the positions of the wrist joints are given.
        point: &'static str,
        /// Distance from the shoulder to the point, in mm.
        distance_mm: f64,
        /// Distance that the folded arm reaches, in mm.
        min_mm: f64,
    },
    /// A point is reachable, but not with this position of joint A3.
    #[error(
        "out of reach with E1 at {:.3} deg: it is {by_mm:.3} mm too near to the axis of A1",
        .e1_rad.to_degrees()
    )]
    NearAxis {
        /// Requested E1, in rad.
        e1_rad: f64,
        /// Distance by which the point is closer to the axis of A1 than the arm allows, in mm.
        by_mm: f64,
    },
    /// The pose is reachable, but not with this position of joint A3.
    #[error(
        "out of reach with E1 at {:.3} deg; within reach is E1 from {}",
        .e1_rad.to_degrees(), listed(&e1_ranges(*.within_rad))
    )]
    E1 {
        /// Requested E1, in rad.
        e1_rad: f64,
        /// Largest reachable deviation of E1 from 0 or from 180 deg, in rad.
        within_rad: f64,
    },
}

impl Unreachable {
    /// Error of a point that is further from the shoulder than the stretched arm reaches, in m.
    pub(crate) fn too_far(point: &'static str, distance_m: f64, max_m: f64) -> Self {
        let by_mm = 1e3 * (distance_m - max_m).max(0.0);
        Self::TooFar { by_mm, point, distance_mm: 1e3 * distance_m, max_mm: 1e3 * max_m }
    }

    /// Error of a point that is nearer to the shoulder than the folded arm reaches, in m.
    pub(crate) fn too_near(point: &'static str, distance_m: f64, min_m: f64) -> Self {
        let by_mm = 1e3 * (min_m - distance_m).max(0.0);
        Self::TooNear { by_mm, point, distance_mm: 1e3 * distance_m, min_mm: 1e3 * min_m }
    }
}

/// Ranges within `within_rad` of 0 or of half a turn, between -pi and pi.
pub(crate) fn e1_ranges(within_rad: f64) -> Vec<[f64; 2]> {
    if within_rad >= FRAC_PI_2 {
        return vec![[-PI, PI]];
    }
    vec![[-PI, within_rad - PI], [-within_rad, within_rad], [PI - within_rad, PI]]
}

fn listed(ranges_rad: &[[f64; 2]]) -> String {
    let ranges: Vec<String> = ranges_rad
        .iter()
        .map(|range| {
            let [from, to] = range.map(f64::to_degrees);
            format!("{from:.3} to {to:.3} deg")
        })
        .collect();
    ranges.join(", ")
}
