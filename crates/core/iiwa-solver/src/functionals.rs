//! Linear functions of the state of a cell that are known at compile time.

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
