//! Blends between two straight TCP paths: kappa, start and end, in the plane of both paths.

use iiwa_kin::{
    Joints,
    rotation::{Vec3, norm, sub},
};
use iiwa_path::Step;
use iiwa_program::{Motion, MotionIndex};

use crate::identify::{
    blends::{BlendCurve, PathCorner},
    findings::Findings,
    observation::{FEWEST, LEFT_SHARE, LeftOut, TcpBlendObservation, Why},
    stops::Passage,
    watched::{CornerSpace, Watched},
};

/// Largest residual of a blend, in m, in addition to a share of its reach: the tracking error of
/// robots.
const LEFT_M: f64 = 3e-4;

/// Largest deviation of a blend's start and end from the plan, as a share of its reach and in
/// standard deviations.
const AS_PLANNED: f64 = 0.005;
const SURE_DEVIATIONS: f64 = 4.0;

/// Evaluated range beyond the ends of a blend, as a share of its reach.
const BEYOND: f64 = 0.5;

fn distance(a: &Vec3<f64>, b: &Vec3<f64>) -> f64 {
    norm(&sub(a, b))
}

/// Evaluates the blends of one section of a recording.
pub(super) fn observe(watched: &Watched<'_>, passage: &Passage, findings: &mut Findings) {
    let steps = &watched.path.steps()[passage.steps.clone()];
    let mut from_sample = passage.samples.start;
    for step in steps {
        let Step::Move { segment, blend: Some(corner), .. } = step else { continue };
        let motion = corner.motion;
        if watched.corner_space(motion) != CornerSpace::StraightWays {
            continue;
        }
        let place = |joints: &Joints| watched.tcp(motion, joints).position_m;
        let Some(ends) = watched.corner(motion) else { continue };
        let ends = ends.each_ref().map(place);
        let [before, target, after] = &ends;
        let Some(corner) = PathCorner::new(target, before, after) else { continue };
        let [start, middle] = [0.0, 0.5].map(|s| place(&segment.at(s).q));
        let reach_m = distance(target, &start);
        let planned_m = planned_reach(watched, motion, &ends);
        let margins = [before, after].map(|end| {
            let longest = planned_m.into_iter().flatten().fold(reach_m, f64::max);
            ((1.0 + BEYOND) * longest).min(distance(target, end))
        });

        let samples = &watched.log.q_rad[from_sample..passage.samples.end];
        let places: Vec<_> = samples.iter().map(place).collect();
        let Some(about) = about(&places, target, &middle, reach_m, margins) else { continue };
        let samples = from_sample + about.first..from_sample + about.last;
        from_sample += about.nearest;
        let places = &places[about.first..about.last];
        let mut leave_out = |reason| {
            let recording = watched.recording;
            findings.known.left_out.push(LeftOut { recording, motion, why: reason });
        };
        if places.len() < FEWEST {
            leave_out(Why::TooFewSamples);
            continue;
        }
        let in_plane: Vec<_> = places.iter().map(|place| corner.in_plane(place)).collect();
        let gamma_deg = corner.gamma_deg();
        let expected = watched.path.robot().tcp_kappa(gamma_deg);
        let Some(curve) = BlendCurve::fit(&corner, &in_plane, expected, reach_m) else {
            leave_out(Why::TooFewSamples);
            continue;
        };
        // The planned start and end are an assumption, which is not used where it does not hold.
        let elsewhere = curve.free.filter(|free| {
            free.reach.iter().any(|(reach, deviation)| {
                let off = (reach - reach_m).abs();
                off > (AS_PLANNED * reach_m).max(SURE_DEVIATIONS * deviation)
            })
        });
        let (kappa, residual) =
            elsewhere.map_or((curve.kappa, curve.residual), |free| (free.kappa, free.residual));
        let across: f64 = places.iter().map(|place| corner.off_plane(place).powi(2)).sum();
        let residual_m = residual.hypot((across / places.len() as f64).sqrt());
        if residual_m > LEFT_M + 2.0 * LEFT_SHARE * reach_m {
            leave_out(Why::NoTcpBlend(residual_m));
            continue;
        }
        if let (Some(free), [Some(planned_before), Some(planned_after)]) = (curve.free, planned_m) {
            let by = planned_after - planned_before;
            let [fitted_before, fitted_after] = free.reach;
            if by.abs() > 0.1 * planned_after.max(planned_before) {
                let share = (fitted_after.0 - fitted_before.0) / by;
                findings.tcp_unequal.push((share, free.difference_deviation / by.abs()));
            } else if let Some(requested_m) = requested_m(watched, motion)
                && (reach_m / requested_m - 1.0).abs() < 1e-6
            {
                for (reach, (value, deviation)) in findings.tcp_reach.iter_mut().zip(free.reach) {
                    reach.push((value / requested_m, deviation / requested_m));
                }
            }
        }
        findings.known.tcp_blends.push(TcpBlendObservation {
            recording: watched.recording,
            motion,
            time_s: [watched.log.t_s[samples.start], watched.log.t_s[samples.end - 1]],
            gamma_deg,
            kappa,
            reach_m,
            found_reach_m: curve.free.map(|free| free.reach.map(|(reach, _)| reach)),
            residual_m,
        });
    }
}

/// Samples around a corner.
struct About {
    first: usize,
    /// Sample nearest to the middle of the blend.
    nearest: usize,
    last: usize,
}

/// Returns the samples around the one nearest to the middle of the blend, within the first pass
/// near it, up to the margins before and after the target.
fn about(
    places: &[Vec3<f64>],
    target: &Vec3<f64>,
    middle: &Vec3<f64>,
    reach_m: f64,
    [before_m, after_m]: [f64; 2],
) -> Option<About> {
    let near = |place: &Vec3<f64>| distance(place, middle) < reach_m;
    let first = places.iter().position(near)?;
    let last = first + places[first..].iter().take_while(|place| near(place)).count();
    let to_middle = |sample: &usize| distance(&places[*sample], middle);
    let nearest = (first..last).min_by(|a, b| to_middle(a).total_cmp(&to_middle(b)))?;
    let (came, goes) = places.split_at(nearest);
    let within = |place: &&Vec3<f64>, margin_m: f64| distance(place, target) < margin_m;
    let before = came.iter().rev().take_while(|place| within(place, before_m)).count();
    let after = goes.iter().take_while(|place| within(place, after_m)).count();
    Some(About { first: nearest - before, nearest, last: nearest + after })
}

/// Returns the programmed distance, in m, if the program gives only a distance.
fn requested_m(watched: &Watched<'_>, motion: MotionIndex) -> Option<f64> {
    let Motion::Cartesian(cartesian) = &watched.program.motions[motion.index()] else {
        return None;
    };
    let blend =
        cartesian.blend.filter(|b| b.orientation_rad.is_none() && b.sunrise_rel.is_none())?;
    blend.cart_mm.map(|mm| 1e-3 * mm)
}

/// Returns the reach of each side of a blend without the other side, in m: at most half of its
/// path.
fn planned_reach(
    watched: &Watched<'_>,
    motion: MotionIndex,
    [before, target, after]: &[Vec3<f64>; 3],
) -> [Option<f64>; 2] {
    let requested_m = requested_m(watched, motion);
    [before, after]
        .map(|end| requested_m.map(|requested_m| requested_m.min(0.5 * distance(target, end))))
}
