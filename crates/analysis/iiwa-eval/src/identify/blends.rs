//! Blend curve: kappa, start and end of a blend, fitted to the samples around a corner.
//!
//! The path does not depend on time, and neither does the fit: it minimises the distances of the
//! samples from the curve.

use crate::least_squares::{self, FitModel};

/// Range of corner angles, in degrees, at which samples show the curve.
const GAMMA_DEG: std::ops::RangeInclusive<f64> = 3.0..=177.0;

/// Corner of a path, in joint space or of the TCP: the target that is blended away, and the
/// directions into and out of the corner.
#[derive(Clone, Copy, Debug)]
pub(super) struct PathCorner<const N: usize> {
    target: [f64; N],
    into: [f64; N],
    /// Unit vector perpendicular to `into`, on the side of the outgoing line.
    across: [f64; N],
    gamma_rad: f64,
}

fn sub<const N: usize>(a: &[f64; N], b: &[f64; N]) -> [f64; N] {
    std::array::from_fn(|i| a[i] - b[i])
}

fn dot<const N: usize>(a: &[f64; N], b: &[f64; N]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn unit<const N: usize>(a: &[f64; N]) -> [f64; N] {
    let scale = dot(a, a).sqrt().recip();
    a.map(|v| scale * v)
}

impl<const N: usize> PathCorner<N> {
    /// Creates the corner at a target between two points; none if it is too straight or too sharp.
    pub(super) fn new(target: &[f64; N], before: &[f64; N], after: &[f64; N]) -> Option<Self> {
        let into = unit(&sub(target, before));
        let leaving = unit(&sub(after, target));
        let along = dot(&into, &leaving);
        let beside: [f64; N] = std::array::from_fn(|j| leaving[j] - along * into[j]);
        let gamma_rad = dot(&beside, &beside).sqrt().atan2(along);
        GAMMA_DEG.contains(&gamma_rad.to_degrees()).then(|| Self {
            target: *target,
            into,
            across: unit(&beside),
            gamma_rad,
        })
    }

    pub(super) fn gamma_deg(&self) -> f64 {
        self.gamma_rad.to_degrees()
    }

    /// Returns a sample in the plane of the corner, relative to the target: along the incoming
    /// line, and perpendicular to it.
    pub(super) fn in_plane(&self, parameters: &[f64; N]) -> [f64; 2] {
        let from_target = sub(parameters, &self.target);
        [dot(&from_target, &self.into), dot(&from_target, &self.across)]
    }

    /// Returns the distance of a sample from that plane.
    pub(super) fn off_plane(&self, parameters: &[f64; N]) -> f64 {
        let from_target = sub(parameters, &self.target);
        let [along, across] = self.in_plane(parameters);
        (dot(&from_target, &from_target) - along * along - across * across).max(0.0).sqrt()
    }
}

/// Initial values of the fit, relative to the expected kappa.
const STARTS: [f64; 3] = [0.0, -1.5, 1.5];

/// Angle in degrees from which more than one initial value is tried.
const SHARP_DEG: f64 = 140.0;

const KAPPA: usize = 0;
const BEFORE: usize = 1;
const AFTER: usize = 2;

/// Samples around a corner, in its plane and in order.
struct Bend<'a> {
    samples: &'a [[f64; 2]],
    out: [f64; 2],
}

/// Point of the curve, its tangent, and its derivatives by the parameters.
struct BlendPoint {
    at: [f64; 2],
    slope: [f64; 2],
    by: [[f64; 2]; 3],
}

/// Returns alpha and beta (Larsen 2019, Eq. 18 and 21) for N = 2 with their derivatives, for `s` in
/// [0, 1].
fn weights(s: f64) -> [[f64; 2]; 2] {
    let rest = 1.0 - s;
    let hump = s * rest;
    let alpha = s * s * s * (10.0 - s * (15.0 - 6.0 * s));
    [[alpha, 30.0 * hump * hump], [-hump * hump * hump, -3.0 * hump * hump * (rest - s)]]
}

impl Bend<'_> {
    /// Returns a point of the curve (Larsen 2019, Eq. 39) for `s` in [0, 1], or of the lines before
    /// and after it.
    fn point(&self, [kappa, before, after]: [f64; 3], s: f64) -> BlendPoint {
        let out = self.out;
        let on_curve = s.clamp(0.0, 1.0);
        let beyond = s - on_curve;
        let [[alpha, alpha_slope], [beta, beta_slope]] = weights(on_curve);
        // Shares of the two directions, in units of the blend's reach on either side.
        let first = -(1.0 - alpha) * (1.0 - on_curve) + kappa * beta;
        let second = alpha * on_curve - kappa * beta;
        let first_slope = (1.0 - alpha) + alpha_slope * (1.0 - on_curve) + kappa * beta_slope;
        let second_slope = alpha + alpha_slope * on_curve - kappa * beta_slope;
        let join = |first: f64, second: f64| [first + second * out[0], second * out[1]];
        let slope = join(first_slope * before, second_slope * after);
        let joined = join(first * before, second * after);
        BlendPoint {
            at: [joined[0] + beyond * slope[0], joined[1] + beyond * slope[1]],
            slope,
            by: [
                join(beta * before, -beta * after),
                join(first + beyond * first_slope, 0.0),
                join(0.0, second + beyond * second_slope),
            ],
        }
    }
}

impl FitModel<3> for Bend<'_> {
    fn samples(&self, parameters: &[f64; 3], mut each: impl FnMut(f64, [f64; 3])) {
        let [_, before, _] = *parameters;
        // Samples are in order: the nearest point of one sample is a good guess for the next.
        let mut s = self.samples.first().map_or(0.0, |first| first[0] / before + 1.0);
        for sample in self.samples {
            let mut point = self.point(*parameters, s);
            for _ in 0..8 {
                let squared = point.slope[0].powi(2) + point.slope[1].powi(2);
                let off = [sample[0] - point.at[0], sample[1] - point.at[1]];
                let step = (off[0] * point.slope[0] + off[1] * point.slope[1])
                    / squared.max(f64::MIN_POSITIVE);
                s = (s + step.clamp(-0.2, 0.2)).clamp(-1.0, 2.0);
                point = self.point(*parameters, s);
                if step.abs() < 1e-6 {
                    break;
                }
            }
            let length = point.slope[0].hypot(point.slope[1]).max(f64::MIN_POSITIVE);
            let across = [-point.slope[1] / length, point.slope[0] / length];
            let part = |v: [f64; 2]| v[0] * across[0] + v[1] * across[1];
            let off = [sample[0] - point.at[0], sample[1] - point.at[1]];
            each(part(off), point.by.map(part));
        }
    }

    fn lower_bounds(&self) -> [f64; 3] {
        [f64::NEG_INFINITY, 1e-6, 1e-6]
    }
}

/// Observed blend. Lengths are in the unit of the samples: rad in joint space, m for the TCP.
#[derive(Clone, Copy, Debug)]
pub(super) struct BlendCurve {
    /// kappa and its standard deviation, with the blend's planned start and end.
    pub(super) kappa: (f64, f64),
    /// Fit with free start and end; none if the samples do not determine them.
    pub(super) free: Option<FreeBlend>,
    /// Root mean square distance from the curve.
    pub(super) residual: f64,
}

/// Blend with free start and end.
#[derive(Clone, Copy, Debug)]
pub(super) struct FreeBlend {
    /// kappa and its standard deviation.
    pub(super) kappa: (f64, f64),
    /// Distances of the start and the end from the target, each with its standard deviation.
    pub(super) reach: [(f64, f64); 2],
    /// Standard deviation of the difference between both distances.
    pub(super) difference_deviation: f64,
    /// Root mean square distance from the curve.
    pub(super) residual: f64,
}

impl BlendCurve {
    /// Fits the curve of a blend with the expected `kappa` and `reach` on either side; none if the
    /// samples do not determine it.
    pub(super) fn fit<const N: usize>(
        corner: &PathCorner<N>,
        samples: &[[f64; 2]],
        kappa: f64,
        reach: f64,
    ) -> Option<Self> {
        let (sin, cos) = corner.gamma_rad.sin_cos();
        let bend = Bend { samples, out: [cos, sin] };
        // In a sharp corner both branches are close to each other, and samples may be matched to
        // the wrong one.
        let starts = if corner.gamma_deg() < SHARP_DEG { &STARTS[..1] } else { &STARTS };
        let bound = starts
            .iter()
            .filter_map(|off| {
                let start = [kappa + off, reach, reach];
                least_squares::fit(&bend, start, [false, true, true])
            })
            .min_by(|a, b| a.residual.total_cmp(&b.residual))?;
        let free = least_squares::fit(&bend, bound.parameters, [false; 3]);
        Some(Self {
            kappa: (bound.parameters[KAPPA], bound.deviation(KAPPA)),
            free: free.as_ref().map(FreeBlend::of),
            residual: bound.residual,
        })
    }
}

impl FreeBlend {
    fn of(fit: &least_squares::Fit<3>) -> Self {
        let figure = |parameter: usize| (fit.parameters[parameter], fit.deviation(parameter));
        Self {
            kappa: figure(KAPPA),
            reach: [BEFORE, AFTER].map(figure),
            difference_deviation: fit.deviation_of(|p: &[f64; 3]| p[AFTER] - p[BEFORE]),
            residual: fit.residual,
        }
    }
}

#[cfg(test)]
mod tests {
    use iiwa_path::{Continuity, PolynomialBlend, Segment};

    use super::*;

    /// The curve equals that of the planner.
    #[test]
    fn the_curve_is_the_planners() {
        const STEP: f64 = 1e-6;
        let before = [-0.5, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        let after = [0.2, 0.0, 0.0, 0.4, 0.0, 0.0, 0.0];
        let corner = PathCorner::new(&[0.0; 7], &before, &after).unwrap();
        let (sin, cos) = corner.gamma_rad.sin_cos();
        let bend = Bend { samples: &[], out: [cos, sin] };
        let (kappa, reach) = (1.7, 0.1);
        let d0 = unit(&sub(&[0.0; 7], &before)).map(|v| reach * v);
        let d1 = unit(&after).map(|v| reach * v);
        let blend = PolynomialBlend::new(&[0.0; 7], d0, &d1, kappa, Continuity::Second);
        for i in 0..=20 {
            let s = f64::from(i) / 20.0;
            let expected = corner.in_plane(&blend.at(s).q);
            let point = bend.point([kappa, reach, reach], s);
            assert!((point.at[0] - expected[0]).hypot(point.at[1] - expected[1]) < 1e-15);
            // Slopes and derivatives by the parameters agree with finite differences.
            let slope = |to: &BlendPoint| [0, 1].map(|k| (to.at[k] - point.at[k]) / STEP);
            let near = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]) < 1e-4;
            if s < 1.0 {
                assert!(near(slope(&bend.point([kappa, reach, reach], s + STEP)), point.slope));
            }
            for parameter in 0..3 {
                let mut moved = [kappa, reach, reach];
                moved[parameter] += STEP;
                assert!(near(slope(&bend.point(moved, s)), point.by[parameter]));
            }
        }
    }
}
