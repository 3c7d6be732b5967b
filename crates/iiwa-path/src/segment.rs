//! Segments of a path, whatever their shape.

use std::fmt;

use iiwa_kin::{Joints, vector};

use crate::grid::Grid;

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

    /// Whether q(s) stays in one plane of joint space. Then few joints can limit it, the same ones all along,
    /// and the planner leaves out the others.
    fn is_planar(&self) -> bool {
        self.is_straight()
    }

    /// First and second derivatives at every node of `grid`, each joint times its `scale`.
    ///
    /// The eighth number of each row is zero: rows of eight fill vector registers.
    ///
    /// # Panics
    ///
    /// If `dq` or `ddq` has fewer rows than the grid has nodes.
    fn rates(&self, grid: &Grid, scale: &Joints, dq: &mut [[f64; 8]], ddq: &mut [[f64; 8]]) {
        let intervals = grid.intervals() as f64;
        let nodes = ..=grid.intervals();
        for (i, (dq, ddq)) in dq[nodes].iter_mut().zip(&mut ddq[nodes]).enumerate() {
            let at = self.at(i as f64 / intervals);
            for j in 0..7 {
                dq[j] = at.dq[j] * scale[j];
                ddq[j] = at.ddq[j] * scale[j];
            }
            (dq[7], ddq[7]) = (0.0, 0.0);
        }
    }
}

/// First to third derivative of s by sigma in rad, from sigma and its derivatives by s in units of `unit_rad`.
pub(crate) fn by_sigma([_, p, r, w]: [f64; 4], unit_rad: f64) -> [f64; 3] {
    let one = 1.0 / (p * unit_rad);
    let two = -r * one * one / p;
    let three = (3.0 * r * r - p * w) * one * one * one / (p * p);
    [one, two, three]
}

/// The s in [0, 1] at which `sigma`, which rises, has a value, starting from `s`.
pub(crate) fn newton(sigma: impl Fn(f64) -> [f64; 4], value: f64, mut s: f64) -> f64 {
    for _ in 0..NEWTON_STEPS {
        let [at, slope, ..] = sigma(s);
        let step = (at - value) / slope;
        s = (s - step).clamp(0.0, 1.0);
        if step.abs() < 1e-15 {
            break;
        }
    }
    s
}

/// Blends take two to four.
const NEWTON_STEPS: usize = 20;
