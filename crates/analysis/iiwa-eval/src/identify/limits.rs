//! Joint limits from motions along lines.

use iiwa_kin::Joints;

use crate::{estimate::Estimate, identify::ramps::Observed, quantile::median};

/// Top speed, acceleration or jerk of a motion along a line: the largest one within the limits of
/// all joints. At least one joint is at its limit.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bound {
    /// Limit of each joint if that joint limited the motion; zero for joints at rest.
    of_joint: Joints,
    /// Relative standard deviation.
    deviation: f64,
}

/// Share of a motion below which a joint counts as at rest: targets in degrees are rounded.
pub(super) const ROUNDING: f64 = 1e-9;

/// Number of standard deviations that bounds the error of an observation.
const SURE_DEVIATIONS: f64 = 3.0;

impl Bound {
    /// Creates the bounds from a figure along the way, the direction of the way (a unit vector) and
    /// the motion's shares of the limits.
    pub(super) fn new(along: Observed, direction: &Joints, shares: &Joints) -> Self {
        let (figure, deviation) = along;
        let moves = |j: usize| direction[j].abs() > ROUNDING;
        let of_joint =
            |j: usize| if moves(j) { figure * direction[j].abs() / shares[j] } else { 0.0 };
        Self { of_joint: std::array::from_fn(of_joint), deviation: deviation / figure }
    }
}

/// Model with approximately correct limits.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plausible<'a> {
    /// Limits of the model.
    pub(super) limits: &'a Joints,
    /// Factor around the typical result; motions whose limits are further off were not fitted well.
    pub(super) factor: f64,
    /// Minimum usage of its limit by a joint that may limit a motion, as a share of the largest
    /// usage of any joint.
    pub(super) share: f64,
}

/// Returns the bounds that are plausible under a model.
pub(super) fn plausible(bounds: &[Bound], by: Plausible<'_>) -> Vec<Bound> {
    let Plausible { limits: model, factor, share } = by;
    let largest = |bound: &Bound| (0..7).map(|j| bound.of_joint[j] / model[j]).fold(0.0, f64::max);
    let mut all: Vec<f64> = bounds.iter().map(largest).collect();
    if all.is_empty() {
        return Vec::new();
    }
    let usual = median(&mut all);
    let alike =
        bounds.iter().filter(|bound| (usual / factor..=usual * factor).contains(&largest(bound)));
    let with_near_joints = |bound: &Bound| {
        let min_ratio = share * largest(bound);
        let near = |j: usize| bound.of_joint[j] / model[j] >= min_ratio;
        let of_joint = |j: usize| if near(j) { bound.of_joint[j] } else { 0.0 };
        Bound { of_joint: std::array::from_fn(of_joint), ..*bound }
    };
    alike.map(with_near_joints).collect()
}

/// Returns the joint if there is exactly one.
pub(super) fn only(mut joints: impl Iterator<Item = usize>) -> Option<usize> {
    joints.next().filter(|_| joints.next().is_none())
}

/// Returns the limits of one kind, for the joints whose limits the observations show.
///
/// No joint exceeds its limit, so that its largest observed figure is a lower bound. In each motion
/// some joint is at its limit: one of those within `tolerance` (a share) of their own largest
/// figure. If there is only one such joint, its limit is shown. A figure that noise makes too large
/// must not have the effect that motions limited by this joint seem to be limited by others: the
/// largest figure is a lower confidence bound, and its neighbourhood an upper one.
pub(super) fn estimate(bounds: &[Bound], tolerance: f64) -> [Option<Estimate>; 7] {
    let mut largest = [0.0; 7];
    for bound in bounds {
        let surely = (1.0 - SURE_DEVIATIONS * bound.deviation).max(0.0);
        largest = std::array::from_fn(|j| (surely * bound.of_joint[j]).max(largest[j]));
    }
    let mut shown: [Vec<(f64, f64)>; 7] = Default::default();
    for bound in bounds {
        let moving = (0..7).filter(|&j| bound.of_joint[j] > 0.0);
        let maybe = 1.0 + SURE_DEVIATIONS * bound.deviation;
        let near = (0..7).filter(|&j| {
            maybe * bound.of_joint[j] > (1.0 - tolerance) * largest[j].max(f64::MIN_POSITIVE)
        });
        if let Some(j) = only(moving).or_else(|| only(near)) {
            let figure = bound.of_joint[j];
            shown[j].push((figure, figure * bound.deviation));
        }
    }
    shown.map(|observations| Estimate::mean(&observations))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Creates a motion of joints 1 and 2 with displacements `by`, limited by `limits`.
    fn bound(by: [f64; 2], limits: [f64; 2]) -> Bound {
        let length = by[0].hypot(by[1]);
        let direction = [by[0] / length, by[1] / length, 0.0, 0.0, 0.0, 0.0, 0.0];
        let along = (0..2).map(|j| limits[j] / direction[j].abs()).fold(f64::MAX, f64::min);
        Bound::new((along, 1e-6), &direction, &[1.0; 7])
    }

    #[test]
    fn a_joint_that_moves_alone_shows_its_limit() {
        let actual = estimate(&[bound([1.0, 0.0], [3.0, 5.0])], 0.01);
        assert!((actual[0].unwrap().value - 3.0).abs() < 1e-12);
        assert_eq!(actual[1..], [None; 6]);
    }

    /// One motion of two joints may be limited by either of them; a second motion decides.
    #[test]
    fn several_motions_determine_a_limit() {
        let limits = [3.0, 5.0];
        let first = bound([1.0, 1.0], limits);
        assert_eq!(estimate(&[first], 0.01), [None; 7]);
        let actual = estimate(&[first, bound([0.1, 1.0], limits)], 0.01);
        assert!((actual[0].unwrap().value - 3.0).abs() < 1e-12);
        assert!((actual[1].unwrap().value - 5.0).abs() < 1e-12);
    }

    /// Joint 1 limits all motions; noise makes one of them seem faster.
    #[test]
    fn noise_does_not_blame_another_joint() {
        let limits = [3.0, 50.0];
        let mut noisy = bound([1.0, 0.0], limits);
        noisy.of_joint[0] *= 1.2;
        noisy.deviation = 0.1;
        let actual = estimate(&[noisy, bound([1.0, 1.0], limits)], 0.01);
        assert_eq!(actual[1], None);
        assert!(actual[0].unwrap().holds(3.0));
    }
}
