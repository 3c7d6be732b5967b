//! Motion between two nodes: d2s/dt2 changes linearly with s.
//!
//! With `k` that rate of change, `d2s/dt2 = u + k (s - s0)` has hyperbolic sines for solutions where
//! k is positive, sines where it is negative, and a parabola where it is zero. Written with
//! `z = k t^2` all three are one smooth function each, so that small k lose no digits.

use pulp::Simd;

use crate::node::Node;

/// Times to go by `ds`, in s, with the rates at both ends (ds/dt, 1/s) adding up to `rates` while
/// d2s/dt2 changes by `change`: of eight intervals.
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

/// The change of s, and ds/dt in 1/s, at `t` (s) after the start of an interval of length `ds`; ds/dt is `from`
/// (1/s) at its start, and d2s/dt2 (1/s^2) goes from `u[0]` to `u[1]` linearly with s.
#[inline]
pub(crate) fn at(t: f64, ds: f64, from: f64, u: [f64; 2]) -> (f64, f64) {
    let k = (u[1] - u[0]) / ds;
    let z = k * t * t;
    let (sinh, cosh_less_1) = if z.abs() < SMALL {
        (t * series(z, &SINH), t * t * series(z, &COSH))
    } else if z > 0.0 {
        let root = k.sqrt();
        ((root * t).sinh() / root, ((root * t).cosh() - 1.0) / k)
    } else {
        let root = (-k).sqrt();
        ((root * t).sin() / root, ((root * t).cos() - 1.0) / k)
    };
    (from * sinh + u[0] * cosh_less_1, from * (1.0 + k * cosh_less_1) + u[0] * sinh)
}

/// Below this |z| the series are good to 1e-14.
const SMALL: f64 = 0.02;

/// artanh(sqrt z) / sqrt z.
const ARTANH: [f64; 8] =
    [1.0, 1.0 / 3.0, 1.0 / 5.0, 1.0 / 7.0, 1.0 / 9.0, 1.0 / 11.0, 1.0 / 13.0, 1.0 / 15.0];
/// sinh(sqrt z) / sqrt z.
const SINH: [f64; 8] = [
    1.0,
    1.0 / 6.0,
    1.0 / 120.0,
    1.0 / 5_040.0,
    1.0 / 362_880.0,
    1.0 / 39_916_800.0,
    1.0 / 6_227_020_800.0,
    1.0 / 1_307_674_368_000.0,
];
/// (cosh(sqrt z) - 1) / z.
const COSH: [f64; 8] = [
    1.0 / 2.0,
    1.0 / 24.0,
    1.0 / 720.0,
    1.0 / 40_320.0,
    1.0 / 3_628_800.0,
    1.0 / 479_001_600.0,
    1.0 / 87_178_291_200.0,
    1.0 / 20_922_789_888_000.0,
];

#[inline(always)]
fn series(z: f64, coefficients: &[f64; 8]) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, c| sum * z + c)
}

#[inline(never)]
fn artanh_over_root(z: f64) -> f64 {
    let root = z.abs().sqrt();
    if z > 0.0 { root.atanh() / root } else { root.atan() / root }
}

/// The instant `seconds` after `t_s`, or at least the next number: over long sections, tiny intervals
/// are lost in rounding.
#[inline(always)]
pub(crate) fn later(t_s: f64, seconds: f64) -> f64 {
    let later = t_s + seconds;
    if later <= t_s { t_s.next_up() } else { later }
}

/// How far the arm is between two nodes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Progress {
    /// Of the difference in s, 0 to 1.
    pub(crate) share: f64,
    /// ds/dt, in 1/s.
    pub(crate) rate: f64,
    /// d2s/dt2, in 1/s^2.
    pub(crate) u: f64,
    /// d3s/dt3, in 1/s^3.
    pub(crate) du: f64,
}

/// Progress at `t` after the node `from`, where s is the polynomial of degree five in time that meets
/// both nodes.
#[inline]
pub(crate) fn smooth(t: f64, from: &Node, to: &Node) -> Progress {
    let whole = to.t_s - from.t_s;
    let (v, a) = (from.rate, from.u[0]);
    // What constant d2s/dt2 would miss at the end.
    let ds = to.s - from.s;
    let way = ds - whole * (v + 0.5 * whole * a);
    let rate = whole * (to.rate - v - whole * a);
    let u = whole * whole * (from.u[1] - a);
    let cubic = 10.0 * way - 4.0 * rate + 0.5 * u;
    let quartic = -15.0 * way + 7.0 * rate - u;
    let quintic = 6.0 * way - 3.0 * rate + 0.5 * u;
    let f = t / whole;
    let s = t * (v + 0.5 * t * a) + f * f * f * (cubic + f * (quartic + f * quintic));
    let ds_dt = v + t * a + f * f * (3.0 * cubic + f * (4.0 * quartic + f * 5.0 * quintic)) / whole;
    let d2s_dt2 =
        a + f * (6.0 * cubic + f * (12.0 * quartic + f * 20.0 * quintic)) / (whole * whole);
    let d3s_dt3 =
        (6.0 * cubic + f * (24.0 * quartic + f * 60.0 * quintic)) / (whole * whole * whole);
    Progress { share: s / ds, rate: ds_dt, u: d2s_dt2, du: d3s_dt3 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn ends_where_and_as_fast_as_it_should(
            ds in 1e-3..1.0_f64, x0 in 0.0..4.0_f64, u0 in -2.0..2.0_f64, u1 in -2.0..2.0_f64,
        ) {
            let x1 = x0 + ds * (u0 + u1);
            // The rate must stay real in between as well: the parabola x(s) may have its lowest
            // point there.
            let vertex = ds * u0 / (u0 - u1);
            let inside = vertex > 0.0 && vertex < ds;
            let lowest = if inside { x0.min(x1).min(x0 + u0 * vertex) } else { x0.min(x1) };
            prop_assume!(lowest > 1e-2);
            let rates = x0.sqrt() + x1.sqrt();
            let [t, ..] = durations(pulp::Scalar::new(), &[ds; 8], &[rates; 8], &[u1 - u0; 8]);
            let (s, rate) = at(t, ds, x0.sqrt(), [u0, u1]);
            prop_assert!((s - ds).abs() < 1e-11 * (1.0 + t), "s = {s}, ds = {ds}, t = {t}");
            prop_assert!((rate - x1.sqrt()).abs() < 1e-11 * (1.0 + t));
        }
    }

    #[test]
    fn series_and_functions_meet() {
        for sign in [-1.0, 1.0] {
            let z = sign * SMALL;
            assert!((series(z, &ARTANH) - artanh_over_root(z)).abs() < 1e-14);
            let (below, above) = (SMALL * (1.0 - 1e-12), SMALL * (1.0 + 1e-12));
            let u = |z: f64| [1.0, 1.0 + sign * z];
            let (a, b) = (at(1.0, 1.0, 1.0, u(below)), at(1.0, 1.0, 1.0, u(above)));
            assert!((a.0 - b.0).abs() < 1e-12 && (a.1 - b.1).abs() < 1e-12);
        }
    }
}
