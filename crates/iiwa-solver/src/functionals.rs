//! Linear functions of a cell's state that are known at compile time.

use pulp::Simd;

use crate::lanes::Vector;

/// (x, V, W0, W1) of a cell, or factors of them.
pub(crate) type CellState = [f64; 4];

/// A linear function of a cell's state (x, V, W0, W1).
pub(crate) trait Functional {
    /// Its factors.
    const ROW: CellState;

    /// Its value in some cells.
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
    /// V there.
    StartV = [0.0, 1.0, 0.0, 0.0];
    /// W there.
    StartW = [0.0, 0.0, 1.0, 0.0];
    /// x at the end.
    EndX = [1.0, 1.0, 1.0 / 3.0, 1.0 / 6.0];
    /// V there.
    EndV = [0.0, 1.0, 0.5, 0.5];
    /// W there.
    EndW = [0.0, 0.0, 0.0, 1.0];
    /// x in the middle.
    MiddleX = [1.0, 0.5, 5.0 / 48.0, 1.0 / 48.0];
    /// V there.
    MiddleV = [0.0, 1.0, 3.0 / 8.0, 1.0 / 8.0];
    /// W there.
    MiddleW = [0.0, 0.0, 0.5, 0.5];
    /// x at its second control point.
    SecondControlX = [1.0, 1.0 / 3.0, 0.0, 0.0];
    /// x at its third control point.
    ThirdControlX = [1.0, 2.0 / 3.0, 1.0 / 6.0, 0.0];
    /// V at its middle control point: the parabola V(f) stays in the hull of both ends and it.
    ControlV = [0.0, 1.0, 0.5, 0.0];
}
