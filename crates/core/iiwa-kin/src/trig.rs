//! Sine and cosine of several angles at once.
//!
//! Kinematics spends most of its time here. The routine has no branches, so that the compiler
//! vectorises it, and uses only additions, multiplications and bit operations, so that every
//! machine produces the same bits.

#![expect(
    clippy::inline_always,
    reason = "kernels must be inlined into the function that enables vector instructions"
)]

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

/// Largest angle, in rad, for which the reduction below is exact to double precision.
const MAX_REDUCED_RAD: f64 = 1.0e6;

/// 2^52 + 2^51: adding it rounds to the nearest integer and leaves that integer in the low bits.
const ROUND: f64 = 6_755_399_441_055_744.0;

// pi/2 in three parts of 33, 33 and 53 bits: `k * part` is exact for |k| < 2^20.
const HALF_PI: [f64; 3] =
    [1.570_796_326_734_125_6, 6.077_100_506_303_966e-11, 2.022_266_248_795_950_6e-21];

// Coefficients of fdlibm (`k_sin.c` and `k_cos.c`, Sun Microsystems 1993) for |r| <= pi/4.
const SIN: [f64; 6] = [
    -1.666_666_666_666_663_2e-1,
    8.333_333_333_322_49e-3,
    -1.984_126_982_985_795e-4,
    2.755_731_370_707_007e-6,
    -2.505_076_025_340_686_3e-8,
    1.589_690_995_211_55e-10,
];
const COS: [f64; 6] = [
    4.166_666_666_666_66e-2,
    -1.388_888_888_887_411e-3,
    2.480_158_728_947_673e-5,
    -2.755_731_435_139_066_3e-7,
    2.087_572_321_298_175e-9,
    -1.135_964_755_778_819_5e-11,
];

/// Returns true if [`reduced`] is accurate for all of `angles`; false if one is NaN.
#[inline(always)]
pub(crate) fn reducible(angles: &[f64]) -> bool {
    angles.iter().fold(true, |all, x| all & (x.abs() <= MAX_REDUCED_RAD))
}

/// Sine and cosine of `x` rad, for |x| up to [`MAX_REDUCED_RAD`]; error below 2 ulp of 1.
#[inline(always)]
pub(crate) fn reduced(x: f64) -> (f64, f64) {
    let shifted = x * std::f64::consts::FRAC_2_PI + ROUND;
    let quarter_turns = shifted.to_bits();
    let k = shifted - ROUND;
    let r = ((x - k * HALF_PI[0]) - k * HALF_PI[1]) - k * HALF_PI[2];
    let z = r * r;
    let sin = r + r * z * series(&SIN, z);
    let cos = (1.0 - 0.5 * z) + z * z * series(&COS, z);

    // Odd quarter turns swap sine and cosine; two bits of the count give the signs.
    let swap = (quarter_turns & 1).wrapping_neg();
    let (sin, cos) = (sin.to_bits(), cos.to_bits());
    let exchange = (sin ^ cos) & swap;
    let sin_sign = (quarter_turns & 2) << 62;
    let cos_sign = (quarter_turns.wrapping_add(1) & 2) << 62;
    (f64::from_bits(sin ^ exchange ^ sin_sign), f64::from_bits(cos ^ exchange ^ cos_sign))
}

/// Polynomial in `z` by Estrin's scheme, which keeps the chain of dependent operations short.
#[inline(always)]
fn series(c: &[f64; 6], z: f64) -> f64 {
    let z2 = z * z;
    ((c[0] + c[1] * z) + (c[2] + c[3] * z) * z2) + (c[4] + c[5] * z) * (z2 * z2)
}

/// Sine and cosine of each of `angles`, in rad.
#[inline(always)]
pub(crate) fn sin_cos<const N: usize>(angles: &[f64; N]) -> ([f64; N], [f64; N]) {
    if !reducible(angles) {
        return by_the_standard_library(angles);
    }
    let (mut sin, mut cos) = ([0.0; N], [0.0; N]);
    for i in 0..N {
        (sin[i], cos[i]) = reduced(angles[i]);
    }
    (sin, cos)
}

// Coefficients of fdlibm (`s_atan.c`, Sun Microsystems 1993) for |u| < 7/16.
const ATAN: [f64; 11] = [
    3.333_333_333_333_293e-1,
    -1.999_999_999_987_648_3e-1,
    1.428_571_427_250_346_6e-1,
    -1.111_111_040_546_235_6e-1,
    9.090_887_133_436_507e-2,
    -7.691_876_205_044_83e-2,
    6.661_073_137_387_531e-2,
    -5.833_570_133_790_573_5e-2,
    4.976_877_994_615_932e-2,
    -3.653_157_274_421_691_6e-2,
    1.628_582_011_536_578_2e-2,
];

/// Angle of the point (`x`, `y`), in rad, from -pi to pi; error below 2 ulp of pi. 0 at the origin,
/// and never -0.
#[inline(always)]
pub(crate) fn atan2(y: f64, x: f64) -> f64 {
    /// tan(pi/8): largest quotient for the series. A point beyond is first rotated by pi/4, which
    /// makes its quotient small enough.
    const EIGHTH: f64 = 0.414_213_562_373_095_03;
    let (flat, steep) = (x.abs(), y.abs());
    let swap = steep > flat;
    let (long, short) = if swap { (steep, flat) } else { (flat, steep) };
    let turn = short > EIGHTH * long;
    let (above, below) = if turn { (short - long, short + long) } else { (short, long) };
    let u = above / (below + if below == 0.0 { 1.0 } else { 0.0 });
    let z = u * u;
    let w = z * z;
    let odd = z
        * (ATAN[0] + w * (ATAN[2] + w * (ATAN[4] + w * (ATAN[6] + w * (ATAN[8] + w * ATAN[10])))));
    let even = w * (ATAN[1] + w * (ATAN[3] + w * (ATAN[5] + w * (ATAN[7] + w * ATAN[9]))));
    let small = u - u * (odd + even);
    let eighth = if turn { small + FRAC_PI_4 } else { small };
    let quarter = if swap { FRAC_PI_2 - eighth } else { eighth };
    let half = if x < 0.0 { PI - quarter } else { quarter };
    half.copysign(y) + 0.0
}

#[cold]
fn by_the_standard_library<const N: usize>(angles: &[f64; N]) -> ([f64; N], [f64; N]) {
    (angles.map(f64::sin), angles.map(f64::cos))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn agrees_with_the_standard_library(x in -1.0e6..1.0e6_f64, y in -3.2..3.2_f64) {
            let (sin, cos) = sin_cos(&[x, y]);
            for (i, angle) in [x, y].into_iter().enumerate() {
                prop_assert!((sin[i] - angle.sin()).abs() < 5e-16, "sin {angle}");
                prop_assert!((cos[i] - angle.cos()).abs() < 5e-16, "cos {angle}");
            }
        }
    }

    proptest! {
        #[test]
        fn angles_agree_with_the_standard_library(
            turn in -3.2..3.2_f64, y in -1.0..1.0_f64, x in -1.0..1.0_f64, scale in -30..30_i32,
        ) {
            let (sin, cos) = turn.sin_cos();
            prop_assert!((atan2(sin, cos) - sin.atan2(cos)).abs() < 9e-16, "at {turn}");
            let k = 10.0_f64.powi(scale);
            prop_assert!((atan2(k * y, k * x) - (k * y).atan2(k * x)).abs() < 9e-16, "({x}, {y})");
        }
    }

    #[test]
    fn angles_of_axes_are_exact() {
        for (y, x) in [(0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0), (1.0, 1.0), (0.0, 0.0)] {
            assert_eq!(atan2(y, x), f64::atan2(y, x), "({x}, {y})");
        }
        assert!(atan2(-0.0, 1.0).is_sign_positive());
        assert!(atan2(f64::NAN, 1.0).is_nan() && atan2(1.0, f64::NAN).is_nan());
    }

    #[test]
    fn leaves_huge_angles_and_nan_to_the_standard_library() {
        let (sin, cos) = sin_cos(&[1.0e300, f64::NAN, 0.5]);
        assert_eq!((sin[0], cos[0]), 1.0e300_f64.sin_cos());
        assert!(sin[1].is_nan() && cos[1].is_nan());
        assert!((sin[2] - 0.5_f64.sin()).abs() < 1e-15);
    }

    #[test]
    fn quarter_turns_are_exact_to_rounding() {
        for k in -8_i32..=8 {
            let x = f64::from(k) * std::f64::consts::FRAC_PI_2;
            let (sin, cos) = sin_cos(&[x]);
            assert!((sin[0] - x.sin()).abs() < 2e-16 && (cos[0] - x.cos()).abs() < 2e-16, "{k}");
        }
    }
}
