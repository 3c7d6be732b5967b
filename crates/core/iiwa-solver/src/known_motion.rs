//! Motion with known derivatives, for tests of rows.

use iiwa_path::Coordinates;
use pulp::Scalar;

use crate::{geometry::SigmaDerivatives, lanes::Vector};

/// Motion `sigma = A sin(w t)`, so that `x = (dsigma/dt)^2 = w^2 (A^2 - sigma^2)`, on a curve whose
/// coordinates are cubic in sigma.
pub(crate) struct KnownMotion {
    amplitude: f64,
    rate: f64,
}

/// Step of finite differences, in s.
const STEP_S: f64 = 1e-3;

impl KnownMotion {
    pub(crate) const SLOW: Self = Self { amplitude: 0.4, rate: 1.1 };
    pub(crate) const FAST: Self = Self { amplitude: 0.7, rate: 2.3 };

    /// sigma at an instant, in rad.
    fn sigma(&self, t_s: f64) -> f64 {
        self.amplitude * (self.rate * t_s).sin()
    }

    /// x, V and W of a cell of this `length` that contains the instant.
    pub(crate) fn place(&self, t_s: f64, length: f64) -> [f64; 3] {
        let (square, sigma) = (self.rate * self.rate, self.sigma(t_s));
        let x = square * (self.amplitude * self.amplitude - sigma * sigma);
        [x, -2.0 * square * sigma * length, -2.0 * square * length * length]
    }

    /// Derivatives of the curve with respect to sigma at an instant.
    pub(crate) fn curve(&self, t_s: f64) -> SigmaDerivatives {
        let s = self.sigma(t_s);
        let by = |f: fn([f64; 3], f64) -> f64| std::array::from_fn(|j| f(factors(j), s));
        [
            by(|[a, b, c], s| a + 2.0 * b * s + 3.0 * c * s * s),
            by(|[_, b, c], s| 2.0 * b + 6.0 * c * s),
            by(|[_, _, c], _| 6.0 * c),
        ]
    }

    /// Velocity, acceleration and jerk at an instant, as central differences of positions.
    pub(crate) fn differences(&self, t_s: f64) -> [Coordinates; 3] {
        let at = |steps: f64| -> Coordinates {
            let s = self.sigma(t_s + steps * STEP_S);
            std::array::from_fn(|j| {
                let [a, b, c] = factors(j);
                s * (a + s * (b + s * c))
            })
        };
        let [p2, p1, q, m1, m2] = [2.0, 1.0, 0.0, -1.0, -2.0].map(at);
        let by = |f: &dyn Fn(usize) -> f64| std::array::from_fn(f);
        [
            by(&|j| (p1[j] - m1[j]) / (2.0 * STEP_S)),
            by(&|j| (p1[j] - 2.0 * q[j] + m1[j]) / STEP_S.powi(2)),
            by(&|j| (p2[j] - 2.0 * p1[j] + 2.0 * m1[j] - m2[j]) / (2.0 * STEP_S.powi(3))),
        ]
    }
}

/// Coefficients of sigma, its square and its cube in a coordinate.
fn factors(j: usize) -> [f64; 3] {
    let j = j as f64;
    [0.9 - 0.3 * j, 0.4 + 0.2 * j, 0.7 - 0.25 * j]
}

/// Instants, and the lengths of cells that contain them, one for each lane.
pub(crate) const PLACES: [(f64, f64); 8] = [
    (0.1, 0.01),
    (-0.1, 0.01),
    (0.3, 0.2),
    (-0.3, 0.2),
    (0.0, 1.0),
    (0.5, 2.0),
    (-0.4, 0.5),
    (0.6, 0.05),
];

/// Reciprocals of the limits, different for each coordinate.
pub(crate) const INVERSE: Coordinates = [0.5, 0.7, 1.1, 0.9, 1.3, 0.6, 0.8, 0.4];

/// Numbers as vector registers of one lane.
pub(crate) fn splat<const N: usize>(numbers: [f64; N]) -> [Vector<Scalar>; N] {
    numbers.map(|number| Vector::splat(Scalar::new(), number))
}

/// Asserts that two numbers are equal up to the error of finite differences.
pub(crate) fn assert_near(actual: f64, expected: f64, case: &str) {
    assert!(
        (actual - expected).abs() < 1e-4 * (1.0 + expected.abs()),
        "{case}: {actual} {expected}"
    );
}
