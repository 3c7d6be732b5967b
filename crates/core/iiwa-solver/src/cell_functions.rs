//! Functions of the state of a cell: linear ones that are known at compile time, and quadratic
//! ones, whose sum a Newton step minimises.

use pulp::Simd;

use crate::lanes::Vector;

/// State (x, V, W0, W1) of a cell, or coefficients of the state.
pub(crate) type CellState = [f64; 4];

/// A linear function of the state (x, V, W0, W1) of a cell.
pub(crate) trait Functional {
    /// Coefficients of the state.
    const ROW: CellState;

    /// Values in some cells.
    #[inline(always)]
    fn of<S: Simd>(y: &[Vector<S>; 4]) -> Vector<S> {
        let mut sum: Option<Vector<S>> = None;
        for a in 0..4 {
            let factor = Self::ROW[a];
            if factor != 0.0 {
                sum = Some(match sum {
                    None if factor == 1.0 => y[a],
                    None => y[a] * factor,
                    Some(sum) if factor == 1.0 => sum + y[a],
                    Some(sum) => y[a].mul_add(Vector::splat(y[a].simd(), factor), sum),
                });
            }
        }
        sum.unwrap_or(y[0] * 0.0)
    }
}

macro_rules! functionals {
    ($($(#[$doc:meta])* $name:ident = $row:expr;)*) => {$(
        $(#[$doc])*
        pub(crate) struct $name;

        impl Functional for $name {
            const ROW: CellState = $row;
        }
    )*};
}

functionals! {
    /// x at the start of a cell, its first control point.
    StartX = [1.0, 0.0, 0.0, 0.0];
    /// V at the start.
    StartV = [0.0, 1.0, 0.0, 0.0];
    /// W at the start.
    StartW = [0.0, 0.0, 1.0, 0.0];
    /// x at the end, its fourth control point.
    EndX = [1.0, 1.0, 1.0 / 3.0, 1.0 / 6.0];
    /// V at the end.
    EndV = [0.0, 1.0, 0.5, 0.5];
    /// W at the end.
    EndW = [0.0, 0.0, 0.0, 1.0];
    /// x in the middle.
    MiddleX = [1.0, 0.5, 5.0 / 48.0, 1.0 / 48.0];
    /// V in the middle.
    MiddleV = [0.0, 1.0, 3.0 / 8.0, 1.0 / 8.0];
    /// W in the middle.
    MiddleW = [0.0, 0.0, 0.5, 0.5];
    /// x at its second control point.
    SecondControlX = [1.0, 1.0 / 3.0, 0.0, 0.0];
    /// x at its third control point.
    ThirdControlX = [1.0, 2.0 / 3.0, 1.0 / 6.0, 0.0];
    /// V at its middle control point: the parabola V(f) stays in the hull of this value and those
    /// at both ends.
    ControlV = [0.0, 1.0, 0.5, 0.0];
}

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_those_of_the_cubic() {
        let y = [0.7, -0.4, 1.3, -2.1];
        // x, V and W at a share of the cell.
        let at = |f: f64| {
            let [x, v, w0, w1] = y;
            let slope = w1 - w0;
            [
                x + f * (v + f * (w0 / 2.0 + f * slope / 6.0)),
                v + f * (w0 + f * slope / 2.0),
                w0 + f * slope,
            ]
        };
        let product = |row: CellState| -> f64 { (0..4).map(|a| row[a] * y[a]).sum() };
        let [[x0, v0, w0], [xm, vm, wm], [x1, v1, w1]] = [0.0, 0.5, 1.0].map(at);
        let cases = [
            ("StartX", StartX::ROW, x0),
            ("StartV", StartV::ROW, v0),
            ("StartW", StartW::ROW, w0),
            ("MiddleX", MiddleX::ROW, xm),
            ("MiddleV", MiddleV::ROW, vm),
            ("MiddleW", MiddleW::ROW, wm),
            ("EndX", EndX::ROW, x1),
            ("EndV", EndV::ROW, v1),
            ("EndW", EndW::ROW, w1),
            ("SecondControlX", SecondControlX::ROW, x0 + v0 / 3.0),
            ("ThirdControlX", ThirdControlX::ROW, x1 - v1 / 3.0),
            ("ControlV", ControlV::ROW, v0 + w0 / 2.0),
        ];
        for (name, row, expected) in cases {
            assert!((product(row) - expected).abs() < 1e-15, "{name}: {} {expected}", product(row));
        }
    }
}
