//! Quadratic functions of the state of a cell: what a step minimises is their sum.

use pulp::Simd;

use crate::lanes::Vector;

/// (x, V, W0, W1) of a cell, or factors of them.
pub(crate) type CellState = [f64; 4];

/// A quadratic function of a cell's state.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Quadratic {
    /// Second derivatives, of which the upper triangle by rows.
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

/// What limits contribute, for one register of lanes.
pub(crate) struct Terms<S: Simd> {
    pub(crate) h: [Vector<S>; 10],
    pub(crate) g: [Vector<S>; 4],
    pub(crate) gap: Vector<S>,
    pub(crate) residual: Vector<S>,
}

impl<S: Simd> Terms<S> {
    /// Adds products of two linear functions of the state, each with its factor (those of two different
    /// ones count twice), and linear functions.
    #[inline(always)]
    pub(crate) fn add<const P: usize, const L: usize>(
        &mut self,
        products: &[(CellState, CellState, Vector<S>); P],
        linear: &[(CellState, Vector<S>); L],
    ) {
        for (p, q, factor) in products {
            let same = p == q;
            let mut i = 0;
            for a in 0..4 {
                for b in a..4 {
                    let twice = if same { p[a] * q[b] } else { p[a] * q[b] + q[a] * p[b] };
                    if twice != 0.0 {
                        self.h[i] = self.h[i] + *factor * twice;
                    }
                    i += 1;
                }
            }
        }
        for (row, factor) in linear {
            for a in 0..4 {
                if row[a] != 0.0 {
                    self.g[a] = self.g[a] + *factor * row[a];
                }
            }
        }
    }
}
