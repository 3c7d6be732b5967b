//! Numbers with their first three derivatives.

use std::ops::{Add, Div, Mul, Neg, Sub};

use crate::{number::Number, trig};

/// A function of one parameter near one parameter value: the coefficients c0 to c3 of its power
/// series, which are the value, f', f''/2 and f'''/6. Arithmetic drops all higher powers.
///
/// ```
/// use iiwa_kin::{Number, Taylor};
///
/// let s = Taylor::variable(0.5);
/// let (sin, _) = (s * s).sin_cos();
/// let [value, first, ..] = sin.derivatives();
/// assert!((value - 0.25_f64.sin()).abs() < 1e-15);
/// assert!((first - 2.0 * 0.5 * 0.25_f64.cos()).abs() < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Taylor(pub [f64; 4]);

impl Taylor {
    /// A constant.
    #[must_use]
    #[inline]
    pub const fn constant(value: f64) -> Self {
        Self([value, 0.0, 0.0, 0.0])
    }

    /// The parameter itself, at this value.
    #[must_use]
    #[inline]
    pub const fn variable(value: f64) -> Self {
        Self([value, 1.0, 0.0, 0.0])
    }

    /// The value and the first, second and third derivatives.
    #[must_use]
    #[inline]
    pub const fn derivatives(self) -> [f64; 4] {
        let [c0, c1, c2, c3] = self.0;
        [c0, c1, 2.0 * c2, 6.0 * c3]
    }

    /// Integral of the derivative series `[c0, c1, c2]`, with the value `start`.
    #[inline]
    fn integral(start: f64, [c0, c1, c2]: [f64; 3]) -> Self {
        Self([start, c0, 0.5 * c1, c2 / 3.0])
    }

    /// `x y' - y x'`, as the series of a derivative.
    #[inline]
    fn sweep(y: Self, x: Self) -> [f64; 3] {
        let ([y0, y1, y2, y3], [x0, x1, x2, x3]) = (y.0, x.0);
        [
            x0 * y1 - y0 * x1,
            2.0 * (x0 * y2 - y0 * x2),
            3.0 * (x0 * y3 - y0 * x3) + (x1 * y2 - y1 * x2),
        ]
    }
}

impl Add for Taylor {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        let (a, b) = (self.0, other.0);
        Self([a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3]])
    }
}

impl Add<f64> for Taylor {
    type Output = Self;

    #[inline]
    fn add(self, other: f64) -> Self {
        let [c0, c1, c2, c3] = self.0;
        Self([c0 + other, c1, c2, c3])
    }
}

impl Sub for Taylor {
    type Output = Self;

    #[inline]
    fn sub(self, other: Self) -> Self {
        let (a, b) = (self.0, other.0);
        Self([a[0] - b[0], a[1] - b[1], a[2] - b[2], a[3] - b[3]])
    }
}

impl Neg for Taylor {
    type Output = Self;

    #[inline]
    fn neg(self) -> Self {
        Self(self.0.map(|c| -c))
    }
}

impl Mul for Taylor {
    type Output = Self;

    #[inline]
    fn mul(self, other: Self) -> Self {
        let (a, b) = (self.0, other.0);
        Self([
            a[0] * b[0],
            a[0] * b[1] + a[1] * b[0],
            a[0] * b[2] + a[1] * b[1] + a[2] * b[0],
            a[0] * b[3] + a[1] * b[2] + a[2] * b[1] + a[3] * b[0],
        ])
    }
}

impl Mul<f64> for Taylor {
    type Output = Self;

    #[inline]
    fn mul(self, factor: f64) -> Self {
        Self(self.0.map(|c| c * factor))
    }
}

impl Div for Taylor {
    type Output = Self;

    #[inline]
    fn div(self, other: Self) -> Self {
        let (a, b) = (self.0, other.0);
        let reciprocal = b[0].recip();
        let q0 = a[0] * reciprocal;
        let q1 = (a[1] - q0 * b[1]) * reciprocal;
        let q2 = (a[2] - q0 * b[2] - q1 * b[1]) * reciprocal;
        let q3 = (a[3] - q0 * b[3] - q1 * b[2] - q2 * b[1]) * reciprocal;
        Self([q0, q1, q2, q3])
    }
}

impl Number for Taylor {
    #[inline]
    fn constant(value: f64) -> Self {
        Self::constant(value)
    }

    #[inline]
    fn value(self) -> f64 {
        self.0[0]
    }

    #[inline]
    fn sqrt(self) -> Self {
        let [a0, a1, a2, a3] = self.0;
        let r0 = a0.sqrt();
        let half = 0.5 / r0;
        let r1 = a1 * half;
        let r2 = (a2 - r1 * r1) * half;
        let r3 = (a3 - 2.0 * r1 * r2) * half;
        Self([r0, r1, r2, r3])
    }

    #[inline]
    fn sin_cos(self) -> (Self, Self) {
        // Coefficient by coefficient from sin' = cos a' and cos' = -sin a'.
        let [a0, a1, a2, a3] = self.0;
        let ([s0], [c0]) = trig::sin_cos(&[a0]);
        let (s1, c1) = (c0 * a1, -s0 * a1);
        let (s2, c2) = (c0 * a2 + 0.5 * c1 * a1, -s0 * a2 - 0.5 * s1 * a1);
        let s3 = c0 * a3 + (2.0 * c1 * a2 + c2 * a1) / 3.0;
        let c3 = -s0 * a3 - (2.0 * s1 * a2 + s2 * a1) / 3.0;
        (Self([s0, s1, s2, s3]), Self([c0, c1, c2, c3]))
    }

    #[inline]
    fn atan2(y: Self, x: Self) -> Self {
        let [w0, w1, w2] = Self::sweep(y, x);
        let square = x * x + y * y;
        let Self([r0, r1, r2, _]) = Self([w0, w1, w2, 0.0]) / square;
        Self::integral(trig::atan2(y.0[0], x.0[0]), [r0, r1, r2])
    }

    #[inline]
    fn angles<const N: usize>(sin: &[Self; N], cos: &[Self; N]) -> [Self; N] {
        let mut angles = [Self::constant(0.0); N];
        for i in 0..N {
            angles[i].0[0] = trig::atan2(sin[i].0[0], cos[i].0[0]);
        }
        for i in 0..N {
            angles[i] = Self::integral(angles[i].0[0], Self::sweep(sin[i], cos[i]));
        }
        angles
    }
}
