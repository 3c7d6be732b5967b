//! Limits of the joints, from motions along lines.

use iiwa_kin::Joints;

use crate::{estimate::Estimate, identify::ramps::Observed, quantile::median};

/// The top speed of a motion along a line, or its acceleration or jerk: the largest that all joints
/// allow. At least one of them is at its limit.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bound {
    /// What each joint's limit would be if it were the one, and its standard deviation; zero for joints
    /// that do not move.
    of_joint: Joints,
    /// Standard deviation over figure.
    deviation: f64,
}

/// A joint with a smaller share in a motion does not move: targets in degrees are rounded.
pub(super) const ROUNDING: f64 = 1e-9;

/// Nothing is taken to be off by more standard deviations.
const SURE_DEVIATIONS: f64 = 3.0;

impl Bound {
    /// From a figure along the way, the direction of the way (a unit vector) and the shares of the
    /// limits that the motion was allowed.
    pub(super) fn new(along: Observed, direction: &Joints, shares: &Joints) -> Self {
        let (figure, deviation) = along;
        let moves = |j: usize| direction[j].abs() > ROUNDING;
        let of_joint =
            |j: usize| if moves(j) { figure * direction[j].abs() / shares[j] } else { 0.0 };
        Self { of_joint: std::array::from_fn(of_joint), deviation: deviation / figure }
    }
}

/// A model whose limits are about right.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plausible<'a> {
    /// Its limits.
    pub(super) limits: &'a Joints,
    /// A motion that shows limits which are, compared with what the others show, larger or smaller by more than this factor
    /// was not fitted well.
    pub(super) factor: f64,
    /// A joint that uses less of its limit than this share of what the joint uses that is nearest to its own is not the one.
    pub(super) share: f64,
}

/// The bounds without what is not plausible by a model.
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
        let least = share * largest(bound);
        let near = |j: usize| bound.of_joint[j] / model[j] >= least;
        let of_joint = |j: usize| if near(j) { bound.of_joint[j] } else { 0.0 };
        Bound { of_joint: std::array::from_fn(of_joint), ..*bound }
    };
    alike.map(with_near_joints).collect()
}

/// The joint, if it is only one.
pub(super) fn only(mut joints: impl Iterator<Item = usize>) -> Option<usize> {
    joints.next().filter(|_| joints.next().is_none())
}

/// The limits of one kind, for the joints whose limits the observations show.
///
/// No joint exceeds its limit, so that the largest figure that was seen of it is a lower bound. In each
/// motion some joint is at its limit: one of those that come near to their own largest figure, within
/// `tolerance` (a share). Where that is one joint only, its limit is shown. Noise is not to make one
/// figure of a joint so large that the motions which it limits seem to be limited by others: the largest
/// is what surely was reached, and near it is what may be.
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

    /// A motion of joints 1 and 2, by so much each, limited by `limits`.
    fn bound(by: [f64; 2], limits: [f64; 2]) -> Bound {
        let length = by[0].hypot(by[1]);
        let direction = [by[0] / length, by[1] / length, 0.0, 0.0, 0.0, 0.0, 0.0];
        let along = (0..2).map(|j| limits[j] / direction[j].abs()).fold(f64::MAX, f64::min);
        Bound::new((along, 1e-6), &direction, &[1.0; 7])
    }

    #[test]
    fn a_joint_that_moves_alone_shows_its_limit() {
        let found = estimate(&[bound([1.0, 0.0], [3.0, 5.0])], 0.01);
        assert!((found[0].unwrap().value - 3.0).abs() < 1e-12);
        assert_eq!(found[1..], [None; 6]);
    }

    /// One motion of two joints may be limited by either; a second one tells.
    #[test]
    fn what_several_motions_show_together() {
        let limits = [3.0, 5.0];
        let first = bound([1.0, 1.0], limits);
        assert_eq!(estimate(&[first], 0.01), [None; 7]);
        let found = estimate(&[first, bound([0.1, 1.0], limits)], 0.01);
        assert!((found[0].unwrap().value - 3.0).abs() < 1e-12);
        assert!((found[1].unwrap().value - 5.0).abs() < 1e-12);
    }

    /// Joint 1 limits all motions; one of them, in noise, seems to be faster.
    #[test]
    fn noise_does_not_blame_another_joint() {
        let limits = [3.0, 50.0];
        let mut noisy = bound([1.0, 0.0], limits);
        noisy.of_joint[0] *= 1.2;
        noisy.deviation = 0.1;
        let found = estimate(&[noisy, bound([1.0, 1.0], limits)], 0.01);
        assert_eq!(found[1], None);
        assert!(found[0].unwrap().holds(3.0));
    }
}
