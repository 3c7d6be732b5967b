//! Pieces of a path.

use iiwa_kin::Joints;

use crate::{circle::CircularBlend, grid::Grid, line::Line, polynomial::PolynomialBlend};

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

/// A smooth piece of a path, with its parameter s in [0, 1].
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Segment {
    /// A straight line in joint space (Larsen 2019, Eq. 10).
    Line(Line),
    /// A blend by polynomials (Larsen 2019, Eq. 13, 26 and 39).
    Polynomial(PolynomialBlend),
    /// A blend along a circle in joint space (Larsen 2019, Eq. 32).
    Circle(CircularBlend),
}

impl Segment {
    /// Position and derivatives at `s` in [0, 1].
    #[must_use]
    pub fn at(&self, s: f64) -> Derivatives {
        match self {
            Self::Line(line) => line.at(s),
            Self::Polynomial(blend) => blend.at(s),
            Self::Circle(blend) => blend.at(s),
        }
    }

    /// Length of the tangent dq/ds at both ends, in rad.
    ///
    /// Where two pieces of a path meet, dq/ds points the same way and only this length differs: a
    /// speed ds/dt in one piece is that speed times the ratio of the lengths in the other.
    #[must_use]
    pub fn end_tangent_rad(&self) -> f64 {
        match self {
            Self::Line(line) => line.length_rad(),
            Self::Polynomial(blend) => blend.reach_rad(),
            Self::Circle(blend) => blend.length_rad(),
        }
    }

    /// For each joint, a bound of `|d2q/ds2|` on all of [0, 1], in rad.
    ///
    /// With it, q at s is at most half of it times `(s - m)^2` away from the tangent at m.
    #[must_use]
    pub fn bend_bound_rad(&self) -> Joints {
        match self {
            Self::Line(_) => [0.0; 7],
            Self::Polynomial(blend) => blend.bend_bound_rad(),
            Self::Circle(blend) => blend.bend_bound_rad(),
        }
    }

    /// The piece as a line, if it is straight and evenly parametrised: dq/ds does not change.
    #[must_use]
    pub fn as_line(&self) -> Option<&Line> {
        match self {
            Self::Line(line) => Some(line),
            _ => None,
        }
    }

    /// The piece as a blend by polynomials, if it is one.
    #[must_use]
    pub fn as_polynomial(&self) -> Option<&PolynomialBlend> {
        match self {
            Self::Polynomial(blend) => Some(blend),
            _ => None,
        }
    }

    /// First and second derivatives at every node of `grid`, each joint times its `scale`.
    ///
    /// The eighth number of each row is zero: rows of eight fill vector registers. For blends by
    /// polynomials this costs six multiplications a joint, since the grid holds the polynomials.
    ///
    /// # Panics
    ///
    /// If `dq` or `ddq` is shorter than the grid.
    #[inline(always)]
    pub fn rates(&self, grid: &Grid, scale: &Joints, dq: &mut [[f64; 8]], ddq: &mut [[f64; 8]]) {
        if let Self::Polynomial(blend) = self {
            return blend.rates(grid, scale, dq, ddq);
        }
        let intervals = grid.intervals() as f64;
        for (i, (dq, ddq)) in dq[..=grid.intervals()].iter_mut().zip(ddq).enumerate() {
            let at = self.at(i as f64 / intervals);
            for j in 0..7 {
                dq[j] = at.dq[j] * scale[j];
                ddq[j] = at.ddq[j] * scale[j];
            }
            (dq[7], ddq[7]) = (0.0, 0.0);
        }
    }
}
