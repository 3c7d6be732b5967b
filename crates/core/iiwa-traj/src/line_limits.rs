//! Speeds along a straight line.
//!
//! All speeds are expressed by x = (ds/dt)^2, which is linear in s at constant d2s/dt2.

use iiwa_kin::vector::largest_multiple;

use crate::sweep::SweepNode;

/// Minimum share of a line over which the speed changes. A shorter ramp of a slow motion is
/// stretched to this length, because it would be lost in rounding; u only decreases, and the cost
/// is a share of the time that is as small.
const SHORTEST: f64 = 1e-9;

/// Limits along a line with s in [0, 1].
#[derive(Clone, Copy, Debug)]
pub(crate) struct LineLimits {
    /// Largest x, in 1/s^2.
    pub(crate) x_max: f64,
    /// Largest |d2s/dt2|, in 1/s^2.
    pub(crate) u_max: f64,
}

impl LineLimits {
    /// Creates the limits along `direction` (dq/ds, in rad) from velocity and acceleration limits.
    pub(crate) fn new(direction: &[f64; 7], velocity: &[f64; 7], acceleration: &[f64; 7]) -> Self {
        Self {
            x_max: largest_multiple(direction, velocity).powi(2),
            u_max: largest_multiple(direction, acceleration),
        }
    }

    /// Returns the largest x at one end, given `x` at the other.
    pub(crate) fn reach(&self, x: f64) -> f64 {
        (x + 2.0 * self.u_max).min(self.x_max)
    }

    /// Returns the fastest motion from x0 at s = 0 to x1 at s = 1: up to four nodes (s, x), between
    /// which d2s/dt2 is constant. Each end must be reachable from the other.
    pub(crate) fn fastest(&self, x0: f64, x1: f64) -> impl Iterator<Item = (f64, SweepNode)> {
        let top = (0.5 * (x0 + x1) + self.u_max).min(self.x_max).max(x0).max(x1);
        let ramp = |x: f64| {
            let rises = top - x > 1e-12 * top;
            if rises { ((top - x) / (2.0 * self.u_max)).max(SHORTEST) } else { 0.0 }
        };
        let (up, down) = (ramp(x0), ramp(x1));
        // A single ramp may miss its end by rounding, and two may overlap by rounding.
        let peak = up / (up + down);
        let (up, down) = if up + down < 1.0 - SHORTEST { (up, 1.0 - down) } else { (peak, peak) };
        let inside = |s: f64| s > 0.0 && s < 1.0;
        let top_starts = inside(up).then_some((up, top));
        let top_ends = (inside(down) && down > up).then_some((down, top));
        let nodes = [Some((0.0, x0)), top_starts, top_ends, Some((1.0, x1))];
        let nexts = [
            top_starts.or(top_ends).unwrap_or((1.0, x1)),
            top_ends.unwrap_or((1.0, x1)),
            (1.0, x1),
            (1.0, x1),
        ];
        std::iter::zip(nodes, nexts).filter_map(|(node, (next_s, next_x))| {
            let (s, x) = node?;
            let u = if next_s > s { (next_x - x) / (2.0 * (next_s - s)) } else { 0.0 };
            Some((s, SweepNode { x, u: [u; 2], ..SweepNode::default() }))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn duration(limits: LineLimits, x0: f64, x1: f64) -> f64 {
        let nodes: Vec<_> = limits.fastest(x0, x1).collect();
        nodes
            .windows(2)
            .map(|w| 2.0 * (w[1].0 - w[0].0) / (w[0].1.x.sqrt() + w[1].1.x.sqrt()))
            .sum()
    }

    #[test]
    fn trapezoid_and_triangle() {
        // Speed 1/s is reached after 0.5 s and a quarter of the way, at each end: 0.5 s at speed
        // 1/s remain for the other half.
        let trapezoid = LineLimits { x_max: 1.0, u_max: 2.0 };
        assert!((duration(trapezoid, 0.0, 0.0) - 1.5).abs() < 1e-15);
        let triangle = LineLimits { x_max: 100.0, u_max: 4.0 };
        assert!((duration(triangle, 0.0, 0.0) - 1.0).abs() < 1e-15);
    }

    #[test]
    fn very_short_ramps_are_kept() {
        // Ramps of 1 s at each end of 2e10 s.
        let slow = LineLimits { x_max: 2.5e-21, u_max: 5e-11 };
        assert!((duration(slow, 0.0, 0.0) / 2e10 - 1.0).abs() < 1e-8);
        assert!((duration(slow, 0.0, slow.x_max) / 2e10 - 1.0).abs() < 1e-8);
    }

    #[test]
    fn one_ramp_is_two_nodes() {
        let limits = LineLimits { x_max: 10.0, u_max: 2.0 };
        assert_eq!(limits.fastest(1.0, 5.0).count(), 2);
        assert_eq!(limits.fastest(5.0, 1.0).count(), 2);
        assert_eq!(limits.fastest(10.0, 10.0).count(), 2);
    }
}
