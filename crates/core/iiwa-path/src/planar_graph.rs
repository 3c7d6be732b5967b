//! Curves in a plane of joint space.

use iiwa_kin::Joints;

use crate::continuity::Continuity;

/// How many places [`PlanarGraph::derivatives`] takes at a time: as many as fill the widest vector register.
pub const PLACES: usize = 8;

/// A curve `q(sigma) = start + sigma ahead + f(sigma) across` in joint space: the graph of one function f in the
/// plane of two directions.
///
/// All joints share what depends on sigma: `q' = ahead + f' across`, `q'' = f'' across` and `q''' = f''' across`.
/// So the planner finds it once for all of them, and leaves out joints that can never limit such a curve.
///
/// ```
/// use iiwa_path::{Continuity, PolynomialBlend, Segment};
///
/// let corner = [0.5, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
/// let d0 = [0.1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
/// let d1 = [0.0, 0.1, 0.0, 0.0, 0.0, 0.0, 0.0];
/// let blend = PolynomialBlend::new(&corner, d0, &d1, 7.5, Continuity::Second);
/// let graph = blend.as_planar_graph().expect("two lines span a plane");
/// // Half-way: sigma goes from 0 to twice the reach.
/// let [slope, ..] = graph.derivatives(&[0.1; 8]);
/// let [dq, ..] = blend.sigma_derivatives(0.5);
/// assert!((graph.ahead()[0] + slope[0] * graph.across()[0] - dq[0]).abs() < 1e-14);
/// ```
pub trait PlanarGraph {
    /// The direction in which the curve goes evenly; 1 if joints and sigma are in rad.
    fn ahead(&self) -> Joints;

    /// The direction in which it bends, in rad.
    fn across(&self) -> Joints;

    /// The polynomials of which the curve consists, if it is a blend of polynomials.
    fn polynomials(&self) -> Option<BlendPolynomials> {
        None
    }

    /// First to third derivative of f by sigma at eight `sigma_rad`; in 1/rad, 1/rad^2 and 1/rad^3.
    fn derivatives(&self, sigma_rad: &[f64; PLACES]) -> [[f64; PLACES]; 3];
}

/// A blend of polynomials in s: `q(s) = start + (s + alpha) d0 + (s alpha - kappa beta) (d1 - d0)` (Larsen 2019, Eq. 39), with the
/// polynomials of [`BlendBasis`](crate::BlendBasis).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlendPolynomials {
    /// Up to which derivative it continues its neighbours: the order of the polynomials.
    pub continuity: Continuity,
    /// The weight of beta.
    pub kappa: f64,
    /// d0: from the start to the target that is blended away, in rad.
    pub arrival_rad: Joints,
    /// d1 - d0, in rad.
    pub turn_rad: Joints,
}
