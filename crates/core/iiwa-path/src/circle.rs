//! Blends along a circle in joint space (Larsen 2019, Eq. 27 to 32; Kunz and Stilman 2012).

use iiwa_kin::{Joints, vector};

use crate::segment::{Derivatives, Segment};

/// An arc that is tangent to both neighbours of a blend.
#[derive(Clone, Debug, PartialEq)]
pub struct CircularBlend {
    centre: Joints,
    /// Vectors from the centre to the start, and along the incoming direction, each with the length
    /// of the radius.
    x: Joints,
    y: Joints,
    gamma: f64,
    length: f64,
}

impl CircularBlend {
    /// Creates the arc at `target_rad` between the unit directions `y0` and `y1`, with both ends
    /// `reach_rad` from the target.
    pub(crate) fn new(target_rad: &Joints, y0: &Joints, y1: &Joints, reach_rad: f64) -> Self {
        let gamma = vector::angle(y0, y1);
        let radius = reach_rad / (gamma / 2.0).tan();
        // The centre is on the bisector of the corner.
        let inwards = vector::sub(y1, y0);
        let distance = reach_rad / (gamma / 2.0).sin();
        let centre = vector::add_scaled(target_rad, distance / vector::norm(&inwards), &inwards);
        let start = vector::add_scaled(target_rad, -reach_rad, y0);
        Self {
            x: vector::sub(&start, &centre),
            y: vector::scale(radius, y0),
            centre,
            gamma,
            length: radius * gamma,
        }
    }

    /// Length of the arc in joint space, in rad.
    #[must_use]
    pub fn length_rad(&self) -> f64 {
        self.length
    }
}

impl Segment for CircularBlend {
    fn at(&self, s: f64) -> Derivatives {
        let (sin, cos) = (s * self.gamma).sin_cos();
        let g = self.gamma;
        let mix = |a: f64, b: f64| vector::add_scaled(&vector::scale(a, &self.x), b, &self.y);
        Derivatives {
            q: vector::add_scaled(&mix(cos, sin), 1.0, &self.centre),
            dq: mix(-g * sin, g * cos),
            ddq: mix(-g * g * cos, -g * g * sin),
            dddq: mix(g * g * g * sin, -g * g * g * cos),
        }
    }

    fn bend_bound_rad(&self) -> Joints {
        std::array::from_fn(|j| self.gamma * self.gamma * self.x[j].hypot(self.y[j]))
    }

    fn tangent_lengths_rad(&self) -> [f64; 2] {
        [self.length; 2]
    }

    fn has_continuous_curvature(&self) -> bool {
        false
    }
}
