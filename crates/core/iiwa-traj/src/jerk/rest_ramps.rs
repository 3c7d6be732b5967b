//! Ramps at the start and at the end of a section, as soft as the recorded ramps under Sunrise.
//!
//! Only PTP motions and splines from rest to rest have been recorded. This module **assumes** the
//! same acceleration and braking times for all other motions: on a path in joint space, those of a
//! PTP motion in the direction of the path, and on a TCP path those of a single SPL. To this end, a
//! lower jerk limit applies until the robot has reached its speed.

use iiwa_kin::{RampEnd, RampLaw, RampLimits};
use iiwa_path::JointPath;
use iiwa_solver::{LimitedSegment, RestRamp};

use crate::{
    section::Piece,
    sunrise::{EndRamp, Ramp, ramp_limits},
};

/// Share of the first acceleration below which the robot has reached its speed.
const STEADY: f64 = 0.25;

/// Way after which the full jerk limits apply again, as a multiple of a ramp's reach in joint
/// space.
const SHARP: f64 = 1.25;

/// First acceleration from rest in the acceleration-limited stamps; for the end of a section, they
/// are read backwards.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Departure {
    acceleration_rad_s2: f64,
    /// Speed that is reached.
    speed_rad_s: f64,
    way_rad: f64,
}

impl Departure {
    /// Reads stamps: distances from rest in rad, and squared speeds. None without motion.
    fn new(stamps: impl Iterator<Item = [f64; 2]>) -> Option<Self> {
        let (mut stamp, mut ramp) = ([0.0; 2], None);
        for [way_rad, x] in stamps {
            // Adjacent segments share a stamp.
            if way_rad <= stamp[0] {
                continue;
            }
            let acceleration = 0.5 * (x - stamp[1]) / (way_rad - stamp[0]);
            let first = ramp.map_or(acceleration, |ramp: Self| ramp.acceleration_rad_s2);
            if acceleration <= STEADY * first {
                break;
            }
            ramp = Some(Self { acceleration_rad_s2: first, speed_rad_s: x.sqrt(), way_rad });
            stamp = [way_rad, x];
        }
        ramp
    }

    /// Returns the ramp of a path in joint space with the jerk limit `jerk`: time and way to the
    /// speed are those of the ramp of a PTP motion, but jerk is constant.
    fn in_joint_space(&self, jerk: f64, law: &RampLaw, limits: &RampLimits) -> RestRamp {
        let Self { acceleration_rad_s2, speed_rad_s, way_rad } = *self;
        let ramp = Ramp::to(acceleration_rad_s2, limits, law.width_rad_s).below(speed_rad_s);
        let lost_s = ramp.lost_s();
        let reach_rad = way_rad + speed_rad_s * lost_s;
        RestRamp {
            // A ramp of constant jerk loses half its time.
            jerk_rel: (0.5 * ramp.acceleration / lost_s / jerk).min(1.0),
            reach_rad,
            end_rad: SHARP * reach_rad,
        }
    }

    /// Returns the ramp of a TCP path of length `whole_rad` with the jerk limit `jerk`, like that
    /// of a single SPL.
    fn of_tcp(
        &self,
        jerk: f64,
        law: &RampLaw,
        limits: &RampLimits,
        whole_rad: f64,
    ) -> Option<RestRamp> {
        let Self { acceleration_rad_s2, speed_rad_s, way_rad } = *self;
        let ramp = EndRamp::new(
            [speed_rad_s, acceleration_rad_s2],
            whole_rad / law.least_cruise_s,
            limits,
            law,
            way_rad,
        )?;
        Some(RestRamp {
            jerk_rel: (acceleration_rad_s2 / ramp.build_up_s / jerk).min(1.0),
            reach_rad: ramp.reach_rad,
            end_rad: 2.0 * ramp.reach_rad,
        })
    }
}

/// Softens the ramps of the first and the last of `segments`, those of `pieces`, at the ends with
/// rest (`rests`).
///
/// Ramps do not continue into blends: lower jerk limits would also slow down the bends of blends.
pub(super) fn soften(
    segments: &mut [LimitedSegment<'_>],
    path: &JointPath,
    pieces: &[Piece],
    rests: [bool; 2],
) {
    let starts_rad = segments.iter().scan(0.0, |start, segment| {
        let after = *start + segment.length_rad();
        Some(std::mem::replace(start, after))
    });
    let starts_rad: Vec<f64> = starts_rad.collect();
    let whole_rad: f64 = segments.iter().map(LimitedSegment::length_rad).sum();
    let stamps = std::iter::zip(&*segments, starts_rad)
        .flat_map(|(segment, start)| segment.swept().map(move |[sigma, x]| [start + sigma, x]));
    let departures = [
        Departure::new(stamps.clone()),
        Departure::new(stamps.rev().map(|[way, x]| [whole_rad - way, x])),
    ];
    let law = path.ramp_law();
    let ramp = |k: usize| {
        let end = RampEnd::BOTH[k];
        let (segment, piece, s) = match end {
            RampEnd::Start => (segments.first()?, pieces.first()?, 0.0),
            RampEnd::Stop => (segments.last()?, pieces.last()?, 1.0),
        };
        let mut departure = departures[k].filter(|_| rests[k])?;
        let limits = ramp_limits(path, pieces, end)?;
        let [_, acceleration, jerk] = segment.straight(s);
        if segment.has_rows() {
            // Further limits may leave almost no acceleration, and the ramp law is defined for
            // ramps to the acceleration limit.
            departure.acceleration_rad_s2 = acceleration;
        }
        if piece.kind.is_of_tcp() {
            departure.of_tcp(jerk, &law, &limits, whole_rad)
        } else {
            Some(departure.in_joint_space(jerk, &law, &limits))
        }
    };
    let [start, stop] = [ramp(0), ramp(1)];
    if let Some((first, ramp)) = segments.first_mut().zip(start) {
        first.set_rest_ramp(RampEnd::Start, ramp);
    }
    if let Some((last, ramp)) = segments.last_mut().zip(stop) {
        last.set_rest_ramp(RampEnd::Stop, ramp);
    }
}
