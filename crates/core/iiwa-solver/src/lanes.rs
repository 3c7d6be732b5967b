//! Arrays of eight numbers, one for each cell of a block, and vector registers that hold them.

use std::ops::{Add, Mul, Neg, Sub};

use pulp::{Arch, Scalar, Simd, WithSimd};

/// Number of lanes, as many as the widest vector register holds.
pub(crate) const LANES: usize = 8;

/// Lanes in memory.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(64))]
pub(crate) struct Lanes(pub(crate) [f64; LANES]);

/// Lanes in a vector register.
#[derive(Clone, Copy)]
pub(crate) struct Vector<S: Simd> {
    simd: S,
    numbers: S::f64s,
}

/// Runs `operation` with the widest vector registers of this machine.
///
/// Without optimisation, each inlined vector operation would have its own stack slots, 8 MB in
/// total, which is more than the stack of a thread. Unoptimised builds therefore use scalar
/// operations.
pub(crate) fn dispatch<T: WithSimd>(operation: T) -> T::Output {
    if cfg!(unoptimised) { operation.with_simd(Scalar) } else { Arch::new().dispatch(operation) }
}

/// Number of registers that the lanes fill.
#[inline(always)]
pub(crate) fn registers<S: Simd>() -> usize {
    LANES / S::F64_LANES
}

/// Returns one register of the columns of eight rows, one row for each lane.
///
/// Written out: closures of `array::from_fn` would be compiled without vector instructions, and
/// lanes that are stored one by one are slow to load as a vector.
#[inline(always)]
pub(crate) fn columns<'a, S: Simd, const N: usize>(
    simd: S,
    register: usize,
    row: impl Fn(usize) -> &'a [f64; N],
) -> [Vector<S>; N] {
    let first = register * S::F64_LANES;
    // The register needs only its own lanes. The compiler omits the others.
    let lane = |i: usize| first + if i < S::F64_LANES { i } else { 0 };
    let (a, b, c, d) = (row(lane(0)), row(lane(1)), row(lane(2)), row(lane(3)));
    let (e, f, g, h) = (row(lane(4)), row(lane(5)), row(lane(6)), row(lane(7)));
    let mut columns = [Vector::splat(simd, 0.0); N];
    for i in 0..N {
        columns[i] = Lanes([a[i], b[i], c[i], d[i], e[i], f[i], g[i], h[i]]).load(simd, 0);
    }
    columns
}

impl Lanes {
    #[inline(always)]
    pub(crate) fn from_fn(f: impl FnMut(usize) -> f64) -> Self {
        Self(std::array::from_fn(f))
    }

    #[inline(always)]
    pub(crate) fn load<S: Simd>(&self, simd: S, register: usize) -> Vector<S> {
        Vector { simd, numbers: S::as_simd_f64s(&self.0).0[register] }
    }

    /// Returns `total` plus the sum of all lanes, in one order for all register widths, so that
    /// each machine finds the same last bits.
    #[inline(always)]
    pub(crate) fn add_to(&self, total: f64) -> f64 {
        let Self([a, b, c, d, e, f, g, h]) = self;
        total + ((a + c) + (b + d)) + ((e + g) + (f + h))
    }

    #[inline(always)]
    pub(crate) fn store<S: Simd>(&mut self, register: usize, vector: Vector<S>) {
        S::as_mut_simd_f64s(&mut self.0).0[register] = vector.numbers;
    }
}

impl<S: Simd> Vector<S> {
    #[inline(always)]
    pub(crate) fn splat(simd: S, value: f64) -> Self {
        Self { simd, numbers: simd.splat_f64s(value) }
    }

    #[inline(always)]
    pub(crate) fn simd(self) -> S {
        self.simd
    }

    /// `self * factor + summand`.
    #[inline(always)]
    pub(crate) fn mul_add(self, factor: Self, summand: Self) -> Self {
        let numbers = self.simd.mul_add_e_f64s(self.numbers, factor.numbers, summand.numbers);
        Self { numbers, ..self }
    }

    #[inline(always)]
    pub(crate) fn inverse(self) -> Self {
        let one = self.simd.splat_f64s(1.0);
        Self { numbers: self.simd.div_f64s(one, self.numbers), ..self }
    }

    #[inline(always)]
    pub(crate) fn sqrt(self) -> Self {
        Self { numbers: self.simd.sqrt_f64s(self.numbers), ..self }
    }

    #[inline(always)]
    pub(crate) fn abs(self) -> Self {
        Self { numbers: self.simd.abs_f64s(self.numbers), ..self }
    }

    #[inline(always)]
    pub(crate) fn max(self, other: Self) -> Self {
        Self { numbers: self.simd.max_f64s(self.numbers, other.numbers), ..self }
    }

    #[inline(always)]
    pub(crate) fn min(self, other: Self) -> Self {
        Self { numbers: self.simd.min_f64s(self.numbers, other.numbers), ..self }
    }

    #[inline(always)]
    pub(crate) fn largest(self) -> f64 {
        self.simd.reduce_max_f64s(self.numbers)
    }
}

impl<S: Simd> Add for Vector<S> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { numbers: self.simd.add_f64s(self.numbers, other.numbers), ..self }
    }
}

impl<S: Simd> Sub for Vector<S> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self { numbers: self.simd.sub_f64s(self.numbers, other.numbers), ..self }
    }
}

impl<S: Simd> Mul for Vector<S> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self { numbers: self.simd.mul_f64s(self.numbers, other.numbers), ..self }
    }
}

impl<S: Simd> Mul<f64> for Vector<S> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, factor: f64) -> Self {
        self * Self::splat(self.simd, factor)
    }
}

impl<S: Simd> Neg for Vector<S> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self { numbers: self.simd.neg_f64s(self.numbers), ..self }
    }
}
