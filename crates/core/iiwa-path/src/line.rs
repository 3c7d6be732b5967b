//! Straight lines in joint space.

use iiwa_kin::{Joints, vector};

use crate::segment::{Derivatives, Segment};

/// A PTP segment: `q(s) = start + s direction` (Larsen 2019, Eq. 10).
///
/// ```
/// use iiwa_path::{Line, Segment};
///
/// let line = Line::new([0.0; 7], [0.3, 0.0, 0.0, -0.4, 0.0, 0.0, 0.0]);
/// assert_eq!(line.length_rad(), 0.5);
/// assert_eq!(line.at(0.5).q[3], -0.2);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    start: Joints,
    direction: Joints,
    length: f64,
}

impl Line {
    /// Creates the line from `start_rad` to `end_rad`.
    #[must_use]
    pub fn new(start_rad: Joints, end_rad: Joints) -> Self {
        let direction = vector::sub(&end_rad, &start_rad);
        Self { start: start_rad, direction, length: vector::norm(&direction) }
    }

    /// Difference between both ends, in rad: dq/ds.
    #[must_use]
    pub fn direction_rad(&self) -> &Joints {
        &self.direction
    }

    /// Length in joint space (Euclidean norm), in rad.
    #[must_use]
    pub fn length_rad(&self) -> f64 {
        self.length
    }
}

impl Segment for Line {
    fn at(&self, s: f64) -> Derivatives {
        Derivatives {
            q: vector::add_scaled(&self.start, s, &self.direction),
            dq: self.direction,
            ddq: [0.0; 7],
            dddq: [0.0; 7],
        }
    }

    fn bend_bound_rad(&self) -> Joints {
        [0.0; 7]
    }

    fn at_share(&self, p: f64) -> Derivatives {
        self.at(p)
    }

    fn tangent_lengths_rad(&self) -> [f64; 2] {
        [self.length; 2]
    }

    fn is_straight(&self) -> bool {
        true
    }

    fn s_at(&self, sigma: f64) -> f64 {
        sigma
    }
}
