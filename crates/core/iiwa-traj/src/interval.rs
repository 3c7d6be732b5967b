//! Nodes of the time parameterisation, and motion between two nodes.
//!
//! The sweep lets d2p/dt2 change linearly with p. With the rate of change `k`,
//! `d2p/dt2 = u + k (p - p0)` is solved by hyperbolic sines for positive k, by sines for negative k
//! and by a parabola for k = 0. In terms of `z = k t^2` all three are one smooth function, so that
//! small k lose no digits. The result is a polynomial of time that meets both nodes.

use pulp::Simd;

/// Node of a piece. Up to the next node, p is the polynomial of degree five in time that meets
/// both, or the cubic with linear d2p/dt2 if that misses the next node by at most 1e-12 of the way.
/// Under jerk-limited timing, d2p/dt2 is continuous from interval to interval.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Node {
    /// Time since the start of the section, in s.
    pub t_s: f64,
    /// Time to the next node, in s; 0 at the last node. Unlike differences of `t_s`, it keeps all
    /// digits late in a section.
    pub dt_s: f64,
    /// Position in the piece's segment: share of its sigma, 0 to 1, as input of
    /// [`at_share`](iiwa_path::Segment::at_share).
    pub p: f64,
    /// Change of p to the next node; 0 at the last node. Unlike differences of `p`, it keeps all
    /// digits.
    pub dp: f64,
    /// dp/dt, in 1/s.
    pub rate: f64,
    /// d2p/dt2 just after this node and just before the next one, in 1/s^2.
    pub u: [f64; 2],
}

/// Returns the durations of eight intervals of length `ds`, in s. The rates at both ends (1/s) add
/// up to `rates`, and the second derivative changes by `change`, linearly with the way.
#[inline(always)]
pub(crate) fn durations<S: Simd>(
    simd: S,
    ds: &[f64; 8],
    rates: &[f64; 8],
    change: &[f64; 8],
) -> [f64; 8] {
    // tanh(sqrt(k) t / 2) = sqrt(k) ds / rates, and with tan for negative k.
    let (mut means, mut zs, mut times) = ([0.0; 8], [0.0; 8], [0.0; 8]);
    {
        let row = |row| S::as_simd_f64s(row).0;
        let (ds, rates, change) = (row(ds), row(rates), row(change));
        let (means, zs) = (S::as_mut_simd_f64s(&mut means).0, S::as_mut_simd_f64s(&mut zs).0);
        let times = S::as_mut_simd_f64s(&mut times).0;
        for k in 0..times.len() {
            // k ds^2 / rates^2 is change ds / rates^2.
            let over = simd.div_f64s(simd.splat_f64s(1.0), rates[k]);
            let share = simd.mul_f64s(ds[k], over);
            let z = simd.mul_f64s(simd.mul_f64s(change[k], over), share);
            let mut sum = simd.splat_f64s(0.0);
            for c in ARTANH.iter().rev() {
                sum = simd.mul_add_e_f64s(sum, z, simd.splat_f64s(*c));
            }
            means[k] = simd.add_f64s(share, share);
            zs[k] = z;
            times[k] = simd.mul_f64s(means[k], sum);
        }
    }
    for (time, (mean, z)) in times.iter_mut().zip(means.into_iter().zip(zs)) {
        if z.abs() >= SMALL {
            *time = mean * artanh_over_root(z);
        }
    }
    times
}

/// |z| below which the series is exact to 1e-14.
const SMALL: f64 = 0.02;

/// Coefficients of the series of artanh(sqrt z) / sqrt z.
const ARTANH: [f64; 8] =
    [1.0, 1.0 / 3.0, 1.0 / 5.0, 1.0 / 7.0, 1.0 / 9.0, 1.0 / 11.0, 1.0 / 13.0, 1.0 / 15.0];
#[inline(never)]
fn artanh_over_root(z: f64) -> f64 {
    let root = z.abs().sqrt();
    if z > 0.0 { root.atanh() / root } else { root.atan() / root }
}

/// Returns the instant `seconds` after `t_s`, both counted from `start_s`, but at least the next
/// representable instant: in long programs, tiny intervals are lost in rounding, and stamps must
/// increase.
#[inline(always)]
pub(crate) fn later(start_s: f64, t_s: f64, seconds: f64) -> f64 {
    let later = t_s + seconds;
    if start_s + later > start_s + t_s { later } else { next_instant(start_s, t_s) }
}

#[cold]
fn next_instant(start_s: f64, t_s: f64) -> f64 {
    let now = start_s + t_s;
    let next = now.next_up();
    let later = (next - start_s).max(t_s.next_up());
    // Rounding down may lead to the same instant again.
    if start_s + later < next { later + (next - now) } else { later }
}

/// Progress between two nodes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct IntervalProgress {
    /// Change of p.
    pub(crate) dp: f64,
    /// dp/dt, in 1/s.
    pub(crate) rate: f64,
    /// d2p/dt2, in 1/s^2.
    pub(crate) u: f64,
    /// d3p/dt3, in 1/s^3.
    pub(crate) du: f64,
}

/// Share of the way between two nodes by which a polynomial may miss the second node: far above the
/// rounding of nodes, far below anything visible.
const MISSED: f64 = 1e-12;

/// Returns the progress at `t` after the node `from`, where p is the polynomial of degree five in
/// time that meets both nodes.
///
/// If the cubic with linear d2p/dt2 meets the second node up to [`MISSED`], the result is that
/// cubic: over some nanoseconds, jerk would otherwise consist of the rounding of rates and ways.
#[inline]
pub(crate) fn progress(t: f64, from: &Node, to: &Node) -> IntervalProgress {
    let (whole, dp) = (from.dt_s, from.dp);
    let (v, a) = (from.rate, from.u[0]);
    let harder = whole * whole * (from.u[1] - a);
    // Errors of constant d3p/dt3 at the end.
    let mut way = dp - whole * (v + 0.5 * whole * a) - harder / 6.0;
    let mut faster = whole * (to.rate - v - whole * a) - 0.5 * harder;
    if way.abs().max(faster.abs()) <= MISSED * dp {
        (way, faster) = (0.0, 0.0);
    }
    let cubic = 10.0 * way - 4.0 * faster + harder / 6.0;
    let quartic = -15.0 * way + 7.0 * faster;
    let quintic = 6.0 * way - 3.0 * faster;
    let f = t / whole;
    let p = t * (v + 0.5 * t * a) + f * f * f * (cubic + f * (quartic + f * quintic));
    let rate = v + t * a + f * f * (3.0 * cubic + f * (4.0 * quartic + f * 5.0 * quintic)) / whole;
    let u = a + f * (6.0 * cubic + f * (12.0 * quartic + f * 20.0 * quintic)) / (whole * whole);
    let du = (6.0 * cubic + f * (24.0 * quartic + f * 60.0 * quintic)) / (whole * whole * whole);
    IntervalProgress { dp: p, rate, u, du }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Returns `x(s)` of an interval of length `ds`.
    fn x(s: f64, ds: f64, x0: f64, [u0, u1]: [f64; 2]) -> f64 {
        x0 + 2.0 * u0 * s + (u1 - u0) / ds * s * s
    }

    proptest! {
        #[test]
        fn duration_equals_the_integral(
            ds in 1e-3..1.0_f64, x0 in 0.0..4.0_f64, u0 in -2.0..2.0_f64, u1 in -2.0..2.0_f64,
        ) {
            let x1 = x0 + ds * (u0 + u1);
            // The rate must remain real in between as well: the parabola x(s) may have its minimum
            // there.
            let lowest = (0..=20).map(|i| x(f64::from(i) / 20.0 * ds, ds, x0, [u0, u1]));
            prop_assume!(lowest.fold(f64::INFINITY, f64::min) > 2e-2);
            let rates = x0.sqrt() + x1.sqrt();
            let [t, ..] = durations(pulp::Scalar::new(), &[ds; 8], &[rates; 8], &[u1 - u0; 8]);
            // Simpson's rule for dt = ds / sqrt(x).
            let at = |i: i32| x(f64::from(i) / 8000.0 * ds, ds, x0, [u0, u1]).sqrt().recip();
            let weight = |i| if i == 0 || i == 8000 { 1.0 } else { f64::from(2 + 2 * (i % 2)) };
            let integral = (0..=8000).map(|i| weight(i) * at(i)).sum::<f64>() * ds / 24000.0;
            prop_assert!((t / integral - 1.0).abs() < 1e-8, "{t} {integral}");

            // Between the nodes, the polynomial of time is close to the exact motion.
            let node =
                |x: f64| Node { dt_s: t, dp: ds, rate: x.sqrt(), u: [u0, u1], ..Node::default() };
            let (from, to) = (node(x0), node(x1));
            let half = progress(0.5 * t, &from, &to);
            let expected = x(half.dp, ds, x0, [u0, u1]).sqrt();
            let change = ((u1 - u0) / ds).abs() * t * t;
            prop_assert!((half.rate / expected - 1.0).abs() < 1e-9 + 2e-4 * change * change);
            for (end, t, s, x, u) in [(from, 0.0, 0.0, x0, u0), (to, t, 1.0, x1, u1)] {
                let actual = progress(t, &from, &to);
                prop_assert!((actual.dp / ds - s).abs() < 1e-11, "{end:?}");
                prop_assert!((actual.rate - x.sqrt()).abs() < 1e-9 * (1.0 + x.sqrt()));
                prop_assert!((actual.u - u).abs() < 1e-8 * (1.0 + 1.0 / t));
            }
        }
    }

    /// Over half a nanosecond, the rounding of the rate alone would amount to a thousand times this
    /// jerk.
    #[test]
    fn jerk_is_not_made_of_rounding() {
        let (t, v, a, j) = (5e-10, 0.7, 3.0, 20.0);
        let from = Node {
            dt_s: t,
            dp: t * (v + t * (a / 2.0 + t * j / 6.0)) * (1.0 + f64::EPSILON),
            rate: v,
            u: [a, a + j * t],
            ..Node::default()
        };
        let rate = (v + t * (a + t * j / 2.0)) * (1.0 - f64::EPSILON);
        let to = Node { rate, u: [a + j * t; 2], ..Node::default() };
        for i in 0..=10 {
            let actual = progress(f64::from(i) / 10.0 * t, &from, &to);
            assert!((actual.du / j - 1.0).abs() < 1e-4, "{actual:?}");
        }
        let end = progress(t, &from, &to);
        assert!((end.dp / from.dp - 1.0).abs() < 1e-12 && (end.rate / rate - 1.0).abs() < 1e-12);
    }

    #[test]
    fn series_and_functions_meet() {
        for z in [SMALL, -SMALL] {
            let series = ARTANH.iter().rev().fold(0.0, |sum, c| sum * z + c);
            assert!((series - artanh_over_root(z)).abs() < 1e-14);
        }
    }
}
