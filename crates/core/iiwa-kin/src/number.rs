//! Number types over which formulas are generic.

use std::ops::{Add, Div, Mul, Neg, Sub};

use crate::trig;

/// A real number, or a function of one parameter given by its first derivatives
/// ([`Taylor`](crate::Taylor)). A formula generic over this trait computes values with `f64`, and
/// values with their derivatives with `Taylor`.
///
/// ```
/// use iiwa_kin::{Number, Taylor};
///
/// fn area<T: Number>(radius: T) -> T {
///     radius * radius * std::f64::consts::PI
/// }
/// assert!((area(2.0) - 12.566).abs() < 1e-3);
/// // The derivative of the area is the circumference.
/// let [_, circumference, ..] = area(Taylor::variable(2.0)).derivatives();
/// assert!((circumference - 12.566).abs() < 1e-3);
/// ```
pub trait Number:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Add<f64, Output = Self>
    + Mul<f64, Output = Self>
{
    /// A constant.
    #[must_use]
    fn constant(value: f64) -> Self;

    /// The value without derivatives.
    #[must_use]
    fn value(self) -> f64;

    /// Square root. Derivatives at 0 are not finite.
    #[must_use]
    fn sqrt(self) -> Self;

    /// Sine and cosine of an angle in rad.
    #[must_use]
    fn sin_cos(self) -> (Self, Self);

    /// Angle of the point (`x`, `y`), from -pi to pi rad. Derivatives at the origin are not finite.
    #[must_use]
    fn atan2(y: Self, x: Self) -> Self;

    /// Angles of points on the unit circle, in rad, from their sines and cosines; cheaper than one
    /// [`atan2`](Self::atan2) each.
    #[must_use]
    fn angles<const N: usize>(sin: &[Self; N], cos: &[Self; N]) -> [Self; N];
}

impl Number for f64 {
    #[inline]
    fn constant(value: f64) -> Self {
        value
    }

    #[inline]
    fn value(self) -> f64 {
        self
    }

    #[inline]
    fn sqrt(self) -> Self {
        self.sqrt()
    }

    #[inline]
    fn sin_cos(self) -> (Self, Self) {
        let ([sin], [cos]) = trig::sin_cos(&[self]);
        (sin, cos)
    }

    #[inline]
    fn atan2(y: Self, x: Self) -> Self {
        trig::atan2(y, x)
    }

    #[inline]
    fn angles<const N: usize>(sin: &[Self; N], cos: &[Self; N]) -> [Self; N] {
        let mut angles = [0.0; N];
        for i in 0..N {
            angles[i] = trig::atan2(sin[i], cos[i]);
        }
        angles
    }
}
