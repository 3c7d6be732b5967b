//! Why no joints reach a pose.

use std::f64::consts::{FRAC_PI_2, PI};

/// No joints reach a pose, whatever their limits.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Unreachable {
    /// The arm is too short.
    #[error("out of reach: the arm is {by_mm:.3} mm too short")]
    TooFar {
        /// How much farther from the shoulder the wrist is than the stretched arm reaches, in mm.
        by_mm: f64,
    },
    /// The pose is too near to the shoulder.
    #[error("out of reach: the wrist is {by_mm:.3} mm too near to the shoulder")]
    TooNear {
        /// How much nearer to the shoulder the wrist is than the folded arm, in mm.
        by_mm: f64,
    },
    /// A point can be reached, but not with this position of joint A3.
    #[error(
        "out of reach with E1 at {:.3} deg: it is {by_mm:.3} mm too near to the axis of A1", .e1_rad.to_degrees()
    )]
    NearAxis {
        /// E1 as asked for, in rad.
        e1_rad: f64,
        /// How much nearer to the axis of A1 the point is than the arm can bring it, in mm.
        by_mm: f64,
    },
    /// The pose can be reached, but not with this position of joint A3.
    #[error(
        "out of reach with E1 at {:.3} deg; within reach is E1 from {}",
        .e1_rad.to_degrees(), listed(&e1_ranges(*.within_rad))
    )]
    E1 {
        /// E1 as asked for, in rad.
        e1_rad: f64,
        /// How far E1 may be from 0 or from 180 deg, in rad.
        within_rad: f64,
    },
}

/// What is within `within_rad` of 0 or of half a turn, between half a turn back and half a turn ahead.
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
