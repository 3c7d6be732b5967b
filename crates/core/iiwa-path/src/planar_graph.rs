//! Planar curves in joint space.

use iiwa_kin::Joints;

use crate::continuity::Continuity;

/// Number of values of sigma per call of [`PlanarGraph::derivatives`], as many as fill the widest
/// vector register.
pub const PLACES: usize = 8;

/// A curve `q(sigma) = start + sigma ahead + f(sigma) across` in joint space: the graph of one
/// function f in the plane of two directions.
///
/// All joints share the parts that depend on sigma: `q' = ahead + f' across`, `q'' = f'' across`
/// and `q''' = f''' across`. The planner therefore computes them once for all joints, and drops
/// joints that can never limit such a curve.
///
/// ```
/// use iiwa_path::{Continuity, PolynomialBlend, Segment};
///
/// let corner = [0.5, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
/// let d0 = [0.1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
/// let d1 = [0.0, 0.1, 0.0, 0.0, 0.0, 0.0, 0.0];
/// let blend = PolynomialBlend::new(&corner, d0, &d1, 7.5, Continuity::Second);
/// let graph = blend.as_planar_graph().expect("two lines span a plane");
/// // Half-way: sigma is from 0 to twice the reach.
/// let [slope, ..] = graph.derivatives(&[0.1; 8]);
/// let [dq, ..] = blend.sigma_derivatives(0.5);
/// assert!((graph.ahead()[0] + slope[0] * graph.across()[0] - dq[0]).abs() < 1e-14);
/// ```
pub trait PlanarGraph {
    /// Direction along which the curve advances evenly; dimensionless, because joints and sigma are
    /// both in rad.
    fn ahead(&self) -> Joints;

    /// Direction in which the curve bends, in rad.
    fn across(&self) -> Joints;

    /// The polynomials of the curve, if it is a polynomial blend.
    fn polynomials(&self) -> Option<BlendPolynomials> {
        None
    }

    /// First to third derivative of f with respect to sigma at eight `sigma_rad`; in 1/rad, 1/rad^2
    /// and 1/rad^3.
    fn derivatives(&self, sigma_rad: &[f64; PLACES]) -> [[f64; PLACES]; 3];
}

/// A polynomial blend in s: `q(s) = start + (s + alpha) d0 + (s alpha - kappa beta) (d1 - d0)`
/// (Larsen 2019, Eq. 39), with the polynomials of [`BlendBasis`](crate::BlendBasis).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlendPolynomials {
    /// Order of continuity with the neighbours, which selects the polynomials.
    pub continuity: Continuity,
    /// The weight of beta.
    pub kappa: f64,
    /// d0: difference from the start to the target, in rad.
    pub arrival_rad: Joints,
    /// d1 - d0, in rad.
    pub turn_rad: Joints,
}
