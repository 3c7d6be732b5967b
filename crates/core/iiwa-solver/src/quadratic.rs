//! Quadratic functions of the state of a cell, whose sum a Newton step minimises.

use pulp::Simd;

use crate::functionals::{CellState, Functional};
use crate::lanes::Vector;

/// A quadratic function of the state of a cell.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Quadratic {
    /// Second derivatives: the upper triangle, row by row.
    pub(crate) h: [f64; 10],
    /// First derivatives.
    pub(crate) g: CellState,
}

impl Quadratic {
    /// Adds `curvature / 2 (row y)^2 + slope (row y)`.
    pub(crate) fn add(&mut self, row: &CellState, curvature: f64, slope: f64) {
        let mut i = 0;
        for a in 0..4 {
            for b in a..4 {
                self.h[i] += curvature * row[a] * row[b];
                i += 1;
            }
            self.g[a] += slope * row[a];
        }
    }
}

/// Contributions of limits, for one register of lanes.
pub(crate) struct Terms<S: Simd> {
    pub(crate) h: [Vector<S>; 10],
    pub(crate) g: [Vector<S>; 4],
    /// Sum of the products of slacks and duals.
    pub(crate) gap: Vector<S>,
    /// Largest residual of a row, as a share of its bound.
    pub(crate) residual: Vector<S>,
}

impl<S: Simd> Terms<S> {
    pub(crate) fn new(simd: S) -> Self {
        let zero = Vector::splat(simd, 0.0);
        Self { h: [zero; 10], g: [zero; 4], gap: zero, residual: zero }
    }

    /// Adds `factor (P y)^2 / 2`.
    #[inline(always)]
    pub(crate) fn add_square<P: Functional>(&mut self, factor: Vector<S>) {
        self.add_entry::<P, P, 0, 0, 0>(factor);
        self.add_entry::<P, P, 1, 0, 1>(factor);
        self.add_entry::<P, P, 2, 0, 2>(factor);
        self.add_entry::<P, P, 3, 0, 3>(factor);
        self.add_entry::<P, P, 4, 1, 1>(factor);
        self.add_entry::<P, P, 5, 1, 2>(factor);
        self.add_entry::<P, P, 6, 1, 3>(factor);
        self.add_entry::<P, P, 7, 2, 2>(factor);
        self.add_entry::<P, P, 8, 2, 3>(factor);
        self.add_entry::<P, P, 9, 3, 3>(factor);
    }

    /// Adds `factor (P y) (Q y)`, whose second derivatives are `factor (P Q^T + Q P^T)`.
    #[inline(always)]
    pub(crate) fn add_product<P: Functional, Q: Functional>(&mut self, factor: Vector<S>) {
        self.add_symmetric::<P, Q, 0, 0, 0>(factor);
        self.add_symmetric::<P, Q, 1, 0, 1>(factor);
        self.add_symmetric::<P, Q, 2, 0, 2>(factor);
        self.add_symmetric::<P, Q, 3, 0, 3>(factor);
        self.add_symmetric::<P, Q, 4, 1, 1>(factor);
        self.add_symmetric::<P, Q, 5, 1, 2>(factor);
        self.add_symmetric::<P, Q, 6, 1, 3>(factor);
        self.add_symmetric::<P, Q, 7, 2, 2>(factor);
        self.add_symmetric::<P, Q, 8, 2, 3>(factor);
        self.add_symmetric::<P, Q, 9, 3, 3>(factor);
    }

    /// Adds `factor (P y)`.
    #[inline(always)]
    pub(crate) fn add_linear<P: Functional>(&mut self, factor: Vector<S>) {
        for a in 0..4 {
            scaled_add(&mut self.g[a], factor, P::ROW[a]);
        }
    }

    #[inline(always)]
    fn add_entry<P: Functional, Q: Functional, const I: usize, const A: usize, const B: usize>(
        &mut self,
        factor: Vector<S>,
    ) {
        scaled_add(&mut self.h[I], factor, const { P::ROW[A] * Q::ROW[B] });
    }

    #[inline(always)]
    fn add_symmetric<
        P: Functional,
        Q: Functional,
        const I: usize,
        const A: usize,
        const B: usize,
    >(
        &mut self,
        factor: Vector<S>,
    ) {
        let coefficient = const { P::ROW[A] * Q::ROW[B] + Q::ROW[A] * P::ROW[B] };
        scaled_add(&mut self.h[I], factor, coefficient);
    }
}

/// `sum += factor * coefficient`, for a coefficient known at compile time.
#[inline(always)]
fn scaled_add<S: Simd>(sum: &mut Vector<S>, factor: Vector<S>, coefficient: f64) {
    if coefficient == 1.0 {
        *sum = *sum + factor;
    } else if coefficient != 0.0 {
        *sum = factor.mul_add(Vector::splat(factor.simd(), coefficient), *sum);
    }
}
