//! Segments of a path, of any shape.

use std::{fmt, sync::Arc};

use iiwa_kin::{Joints, vector};

use crate::planar_graph::PlanarGraph;

/// Joint positions as a function of s in [0, 1], and their first three derivatives with respect to
/// s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Derivatives {
    /// Position, in rad.
    pub q: Joints,
    /// First derivative, in rad.
    pub dq: Joints,
    /// Second derivative, in rad.
    pub ddq: Joints,
    /// Third derivative, in rad.
    pub dddq: Joints,
}

/// First to third derivative with respect to s of the TCP path length and of the angle by which the
/// TCP turns.
///
/// ```
/// use iiwa_path::ToolWay;
///
/// // 0.3 m in a straight line, evenly parameterised, without rotation.
/// let way = ToolWay { way_m: [0.3, 0.0, 0.0], ..ToolWay::default() };
/// assert_eq!(way.turn_rad, [0.0; 3]);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ToolWay {
    /// Derivatives of the path length, in m; the first is not negative.
    pub way_m: [f64; 3],
    /// Derivatives of the angle, in rad; the first is not negative.
    pub turn_rad: [f64; 3],
}

/// A smooth segment of a path, with its path parameter s in [0, 1].
///
/// A shape is one type that implements this trait. Planners use a shape only through it.
///
/// ```
/// use iiwa_kin::Joints;
/// use iiwa_path::{Derivatives, Segment};
///
/// /// Joint 1 swings; s is the angle of a sine.
/// #[derive(Debug)]
/// struct Swing {
///     amplitude_rad: f64,
/// }
///
/// impl Segment for Swing {
///     fn at(&self, s: f64) -> Derivatives {
///         let only = |v: f64| [self.amplitude_rad * v, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
///         let (sin, cos) = s.sin_cos();
///         Derivatives { q: only(sin), dq: only(cos), ddq: only(-sin), dddq: only(-cos) }
///     }
///
///     fn bend_bound_rad(&self) -> Joints {
///         [self.amplitude_rad, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
///     }
/// }
///
/// let swing = Swing { amplitude_rad: 0.5 };
/// assert_eq!(swing.tangent_lengths_rad(), [0.5, 0.5 * 1.0_f64.cos()]);
/// ```
pub trait Segment: fmt::Debug + Send + Sync {
    /// Position and derivatives at `s` in [0, 1].
    fn at(&self, s: f64) -> Derivatives;

    /// Upper bound of `|d2q/ds2|` on [0, 1] for each joint, in rad.
    ///
    /// Each joint of q at s is at most `bound (s - m)^2 / 2` away from the tangent at m.
    fn bend_bound_rad(&self) -> Joints;

    /// Length of the tangent dq/ds at the start and at the end, in rad.
    ///
    /// At the junction of two segments, the tangents have the same direction and may differ in
    /// length. dq/dt is continuous there, so that ds/dt changes by the inverse ratio of the
    /// lengths.
    fn tangent_lengths_rad(&self) -> [f64; 2] {
        [0.0, 1.0].map(|s| vector::norm(&self.at(s).dq))
    }

    /// True if dq/ds is constant: an evenly parameterised straight line. Its limits are constant
    /// along it, so that its stamps have a closed form.
    fn is_straight(&self) -> bool {
        false
    }

    /// True if acceleration is continuous where the segment joins its neighbours at speed: at both
    /// ends, d2q/ds2 has no component perpendicular to dq/ds. Jerk-limited timing requires this.
    fn has_continuous_curvature(&self) -> bool {
        true
    }

    /// Motion of the TCP at `s`. The default is no motion: TCP limits do not apply to the segment.
    fn tool_way(&self, s: f64) -> ToolWay {
        let _ = s;
        ToolWay::default()
    }

    /// True if the TCP moves and turns evenly: [`tool_way`](Self::tool_way) is constant, and only
    /// its first derivatives are not zero. This is the case on TCP lines and arcs: there, the
    /// stricter of the limits on translation and on rotation is sufficient.
    fn has_even_tool_way(&self) -> bool {
        false
    }

    /// Returns the segment without the T1 speed limit of the flange, if the segment is
    /// [supervised](crate::JointPath::unsupervised).
    fn unsupervised(&self) -> Option<Arc<dyn Segment>> {
        None
    }

    /// Path parameter sigma of the segment and its first three derivatives with respect to s, in
    /// units of [`sigma_unit_rad`](Self::sigma_unit_rad). It is 0 at s = 0 and increases with s.
    ///
    /// Jerk-limited stamps are a function of sigma: choose it such that d3q/dsigma3 has no jump
    /// along the path where the segment joins its neighbours. The default is s.
    fn sigma(&self, s: f64) -> [f64; 4] {
        [s, 1.0, 0.0, 0.0]
    }

    /// Unit of [`sigma`](Self::sigma), in rad, in which `|dq/dsigma|` is 1 at both ends.
    fn sigma_unit_rad(&self) -> f64 {
        self.tangent_lengths_rad()[0]
    }

    /// Length of the range of [`sigma`](Self::sigma), in rad.
    fn sigma_length_rad(&self) -> f64 {
        let [end, ..] = self.sigma(1.0);
        end * self.sigma_unit_rad()
    }

    /// Returns s at `sigma`, the inverse of [`sigma`](Self::sigma): by Newton's method, unless the
    /// shape has a faster way.
    fn s_at(&self, sigma: f64) -> f64 {
        let [end, ..] = self.sigma(1.0);
        newton(|s| self.sigma(s), sigma, (sigma / end).clamp(0.0, 1.0))
    }

    /// First to third derivative of q with respect to [`sigma`](Self::sigma) in rad, at `s`; in 1,
    /// 1/rad and 1/rad^2. The jerk-limited solver calls it often: a shape may override it with a
    /// faster formula.
    fn sigma_derivatives(&self, s: f64) -> [Joints; 3] {
        let Derivatives { dq, ddq, dddq, .. } = self.at(s);
        let [one, two, three] = by_sigma(self.sigma(s), self.sigma_unit_rad());
        [
            dq.map(|v| v * one),
            std::array::from_fn(|j| ddq[j] * one * one + dq[j] * two),
            std::array::from_fn(|j| {
                dddq[j] * one * one * one + 3.0 * ddq[j] * one * two + dq[j] * three
            }),
        ]
    }

    /// Position and derivatives with respect to p, the share of [`sigma`](Self::sigma) from 0 to 1:
    /// stamps are a function of p.
    fn at_share(&self, p: f64) -> Derivatives {
        let [end, ..] = self.sigma(1.0);
        let s = self.s_at(p * end);
        let [dq, ddq, dddq] = self.sigma_derivatives(s);
        let length = self.sigma_length_rad();
        Derivatives {
            q: self.at(s).q,
            dq: vector::scale(length, &dq),
            ddq: vector::scale(length * length, &ddq),
            dddq: vector::scale(length * length * length, &dddq),
        }
    }

    /// The segment as the graph of one function in a plane of joint space, if it has this form: its
    /// stamps then take a fraction of the computing time.
    fn as_planar_graph(&self) -> Option<&dyn PlanarGraph> {
        None
    }

    /// Values of s at which the pieces of the curve meet, from 0 to 1. Pieces are short where
    /// joints turn fast. Empty if the curve is one piece.
    fn breaks(&self) -> &[f64] {
        &[]
    }
}

/// First to third derivative of s with respect to sigma in rad, from sigma and its derivatives with
/// respect to s in units of `unit_rad`.
pub(crate) fn by_sigma([_, p, r, w]: [f64; 4], unit_rad: f64) -> [f64; 3] {
    let one = 1.0 / (p * unit_rad);
    let two = -r * one * one / p;
    let three = (3.0 * r * r - p * w) * one * one * one / (p * p);
    [one, two, three]
}

/// Returns the s in [0, 1] at which the increasing function `sigma` has a value; `s` is the initial
/// guess.
///
/// Next to a much shorter neighbour, sigma is nearly flat and a Newton step overshoots far. The
/// bracket of the root bounds the steps; a step that leaves the bracket is replaced by bisection.
fn newton(sigma: impl Fn(f64) -> [f64; 4], value: f64, mut s: f64) -> f64 {
    let [mut low, mut high] = [0.0, 1.0];
    for _ in 0..NEWTON_STEPS {
        let [current, slope, ..] = sigma(s);
        if current < value {
            low = s;
        } else {
            high = s;
        }
        let next = s - (current - value) / slope;
        let next = if (low..=high).contains(&next) { next } else { f64::midpoint(low, high) };
        let step = next - s;
        s = next;
        if step.abs() < 1e-15 {
            break;
        }
    }
    s
}

/// Maximum number of steps. Blends take two to four; more if bisection is needed.
const NEWTON_STEPS: usize = 60;

#[cfg(test)]
mod tests {
    use super::*;

    /// Also between neighbours whose lengths differ a thousandfold and more.
    #[test]
    fn every_sigma_has_its_s() {
        // The integral of 1 + (ratio - 1) (3 s^2 - 2 s^3).
        for ratio in [1e-6, 1e-3, 0.1, 1.0, 30.0, 1e4] {
            let by = ratio - 1.0;
            let sigma = |s: f64| {
                [s + by * s * s * s * (1.0 - 0.5 * s), 1.0 + by * s * s * (3.0 - 2.0 * s), 0.0, 0.0]
            };
            let [end, ..] = sigma(1.0);
            for i in 0..=1_000 {
                let value = end * f64::from(i) / 1_000.0;
                let s = newton(sigma, value, (value / end).clamp(0.0, 1.0));
                let [actual, ..] = sigma(s);
                assert!((actual - value).abs() < 1e-14 * end, "{ratio} {i}: {actual} {value}");
            }
        }
    }
}
