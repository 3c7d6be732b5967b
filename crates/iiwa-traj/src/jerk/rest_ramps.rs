//! Ramps next to the rests of a section, as soft as those of PTP motions under Sunrise.
//!
//! Recorded are PTP motions from rest to rest. **Assumed** here is that any other motion leaves rest, and comes to it, in the time of
//! the ramp of a PTP motion there in the direction of its path: jerk is that low until the arm has reached its speed.

use iiwa_kin::{RampEnd, RampLaw, RampLimits};
use iiwa_path::JointPath;
use iiwa_solver::{LimitedSegment, RestRamp, SweptNode};

use crate::{
    section::Piece,
    sunrise::{EndRamp, Ramp, ramp_limits},
};

/// Share of its first acceleration below which the arm has reached its speed.
const STEADY: f64 = 0.25;

/// Where the limits of jerk are as elsewhere, as a multiple of a ramp's reach in joint space: soon after the speed is reached.
const SHARP: f64 = 1.25;

/// How the acceleration-limited stamps leave a rest, or seen backwards come to it, along sigma.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Departure {
    acceleration_rad_s2: f64,
    /// The speed that is reached, and the way until then.
    speed_rad_s: f64,
    way_rad: f64,
}

impl Departure {
    /// That of stamps with these ways from the rest, in rad, and squares of the speed. None if they do not move.
    fn new(stamps: impl Iterator<Item = [f64; 2]>) -> Option<Self> {
        let (mut at, mut found) = ([0.0; 2], None);
        for [way_rad, x] in stamps {
            // Segments share the stamp at which they meet.
            if way_rad <= at[0] {
                continue;
            }
            let acceleration = 0.5 * (x - at[1]) / (way_rad - at[0]);
            let first = found.map_or(acceleration, |found: Self| found.acceleration_rad_s2);
            if acceleration <= STEADY * first {
                break;
            }
            found = Some(Self { acceleration_rad_s2: first, speed_rad_s: x.sqrt(), way_rad });
            at = [way_rad, x];
        }
        found
    }

    /// The ramp of a path in joint space, whose limits of jerk leave `jerk`: it takes the time and the way of the ramp of a PTP motion to
    /// the speed, but with one jerk.
    fn in_joint_space(&self, jerk: f64, law: &RampLaw, limits: &RampLimits) -> RestRamp {
        let Self { acceleration_rad_s2, speed_rad_s, way_rad } = *self;
        let ramp = Ramp::to(acceleration_rad_s2, limits, law.width_rad_s).below(speed_rad_s);
        let lost_s = ramp.lost_s();
        let reach_rad = way_rad + speed_rad_s * lost_s;
        RestRamp {
            // Constant jerk loses half its time.
            jerk_rel: (0.5 * ramp.acceleration / lost_s / jerk).min(1.0),
            reach_rad,
            end_rad: SHARP * reach_rad,
        }
    }

    /// The ramp of a path of the TCP, of `whole_rad` in all, whose limits of jerk leave `jerk`: as that of a single SPL.
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

/// The segments of `pieces`, the first and the last with soft ramps at the rests from which and to which they go. `stamps` are the
/// acceleration-limited ones of each.
pub(super) fn soften<'a>(
    segments: Vec<LimitedSegment<'a>>,
    stamps: &[&[SweptNode]],
    path: &JointPath,
    pieces: &[Piece],
    rests: [bool; 2],
) -> Vec<LimitedSegment<'a>> {
    let lengths: Vec<f64> = segments.iter().map(LimitedSegment::length_rad).collect();
    let whole: f64 = lengths.iter().sum();
    let starts: Vec<f64> = lengths
        .iter()
        .scan(0.0, |before, length| Some(std::mem::replace(before, *before + length)))
        .collect();
    let all = std::iter::zip(stamps, std::iter::zip(&starts, &lengths)).flat_map(
        |(nodes, (start, length))| {
            nodes.iter().map(move |node| [start + node.p * length, (node.rate * length).powi(2)])
        },
    );
    let departures =
        [Departure::new(all.clone()), Departure::new(all.rev().map(|[way, x]| [whole - way, x]))];
    let law = path.ramp_law();
    let ramps: [Option<RestRamp>; 2] = std::array::from_fn(|k| {
        let end = RampEnd::BOTH[k];
        let (segment, piece, s) = match end {
            RampEnd::Start => (segments.first()?, pieces.first()?, 0.0),
            RampEnd::Stop => (segments.last()?, pieces.last()?, 1.0),
        };
        let mut departure = departures[k].filter(|_| rests[k])?;
        let limits = ramp_limits(path, pieces, end)?;
        let [_, acceleration, jerk] = segment.straight(s);
        if segment.limits_torque() {
            // Torques may leave next to none: the law knows ramps of the limits of acceleration.
            departure.acceleration_rad_s2 = acceleration;
        }
        if piece.kind.is_of_tcp() {
            departure.of_tcp(jerk, &law, &limits, whole)
        } else {
            Some(departure.in_joint_space(jerk, &law, &limits))
        }
    });
    // Not in the blends between: their bends would take jerk that is not there.
    let last = segments.len() - 1;
    let with_ramps = |(i, segment): (usize, LimitedSegment<'a>)| {
        let [start, stop] = [ramps[0].filter(|_| i == 0), ramps[1].filter(|_| i == last)];
        segment.with_rest_ramps([start, stop])
    };
    segments.into_iter().enumerate().map(with_ramps).collect()
}
