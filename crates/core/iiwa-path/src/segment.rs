//! Segments of a path, whatever their shape.

use std::{fmt, sync::Arc};

use iiwa_kin::{Joints, vector};

use crate::{
    planar_graph::PlanarGraph,
    sigma::{by_sigma, newton},
    tool_way::ToolWay,
};

/// Joint positions as a function of s in [0, 1], and their first three derivatives by s.
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

/// A smooth segment of a path, with its path parameter s in [0, 1].
///
/// A shape is one type that implements this trait. Planners
/// use nothing else of a shape.
///
/// ```
/// use iiwa_kin::Joints;
/// use iiwa_path::{Derivatives, Segment};
///
/// /// Joint 1 goes to and fro; s runs evenly in the angle of a sine.
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

    /// For each joint, a bound of `|d2q/ds2|` on all of [0, 1], in rad.
    ///
    /// Each joint of q at s is at most `bound (s - m)^2 / 2` away from the tangent at m.
    fn bend_bound_rad(&self) -> Joints;

    /// Length of the tangent dq/ds at the start and at the end, in rad.
    ///
    /// Where two segments meet, dq/ds points the same way and only this length differs: a speed ds/dt in
    /// one segment is that speed times the ratio of the lengths in the other.
    fn tangent_lengths_rad(&self) -> [f64; 2] {
        [0.0, 1.0].map(|s| vector::norm(&self.at(s).dq))
    }

    /// Whether dq/ds is the same everywhere: a straight line that is evenly parametrised. Its limits do
    /// not change along it, so that its stamps have a closed form.
    fn is_straight(&self) -> bool {
        false
    }

    /// Whether acceleration is continuous where the segment joins its neighbours at speed: the part of
    /// d2q/ds2 across dq/ds is zero at both ends. Jerk-limited timing needs it.
    fn has_continuous_curvature(&self) -> bool {
        true
    }

    /// How the TCP goes and turns at `s`. By default it does not: no limit of the TCP holds for the segment.
    fn tool_way(&self, s: f64) -> ToolWay {
        let _ = s;
        ToolWay::default()
    }

    /// Whether the TCP goes and turns evenly: [`tool_way`](Self::tool_way) is the same for all s, and only its first
    /// derivatives are not zero. So it is on a line or an arc of the TCP: then one limit stands for both.
    fn has_even_tool_way(&self) -> bool {
        false
    }

    /// The segment without the speed of the flange, where that is [supervised](crate::JointPath::unsupervised), too.
    fn unsupervised(&self) -> Option<Arc<dyn Segment>> {
        None
    }

    /// The segment's own parametrisation, sigma, and its first three derivatives by s, in units of
    /// [`sigma_unit_rad`](Self::sigma_unit_rad). It rises with s from 0.
    ///
    /// Jerk-limited stamps are found as a function of sigma: it is to be chosen so that d3q/dsigma3 has
    /// no jump along the path where the segment joins its neighbours. By default it is s.
    fn sigma(&self, s: f64) -> [f64; 4] {
        [s, 1.0, 0.0, 0.0]
    }

    /// The unit of [`sigma`](Self::sigma), in rad: `|dq/dsigma|` is 1 at both ends in it.
    fn sigma_unit_rad(&self) -> f64 {
        self.tangent_lengths_rad()[0]
    }

    /// The range of [`sigma`](Self::sigma), in rad: from 0 to this.
    fn sigma_length_rad(&self) -> f64 {
        let [end, ..] = self.sigma(1.0);
        end * self.sigma_unit_rad()
    }

    /// s at a `sigma`, the inverse of [`sigma`](Self::sigma): by Newton's method, unless the shape knows
    /// better.
    fn s_at(&self, sigma: f64) -> f64 {
        let [end, ..] = self.sigma(1.0);
        newton(|s| self.sigma(s), sigma, (sigma / end).clamp(0.0, 1.0))
    }

    /// First to third derivative of q by [`sigma`](Self::sigma) in rad, at `s`; in 1, 1/rad and 1/rad^2. The
    /// jerk-limited solver asks for them again and again: a shape may know a shorter way.
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

    /// Position and derivatives by p, the share of [`sigma`](Self::sigma) from 0 to 1: stamps are found as a
    /// function of p.
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

    /// The segment as the graph of one function in a plane of joint space, if it is one: then its stamps are found in
    /// a fraction of the time.
    fn as_planar_graph(&self) -> Option<&dyn PlanarGraph> {
        None
    }

    /// Places of s where the pieces of the curve meet, from 0 to 1: they are short where joints turn fast. Empty if the curve is one
    /// piece.
    fn breaks(&self) -> &[f64] {
        &[]
    }
}
