//! Riccati recursion: the Newton step of all cells as a linear-quadratic control problem.
//!
//! A stage is a cell, its state the step of (x, V) at its start, its controls the steps of (W0,
//! W1). The next state is `(END_X y, ratio END_V y)` plus the continuity defect, with ratio the
//! length of the next cell over that of this one. The stage cost is `y^T h y / 2 + g^T y`. The
//! backward pass keeps the cost-to-go from the start of a cell as
//! `p_xx x^2 / 2 + p_xv x V + p_vv V^2 / 2 + pg_x x + pg_v V` and eliminates W1 and then W0 as
//! scalars. The forward pass applies the feedback. Time is linear in the number of cells. A range
//! of cells can be solved alone: its start is fixed, and W0 and W1 of its last cell follow from the
//! fixed state of the cell after it. Long chains are solved in eight parts side by side
//! (`riccati_parts`).

use pulp::Simd;

use crate::{
    cell_functions::{CellState, EndV, EndX, Functional, Quadratic},
    riccati_parts::{self, PartGain, Parts},
    stage_chain::{CostToGo, StageChain},
};

/// Feedback `dW0 = -w0 [dx, dV, 1]`, `dW1 = -w1 [dx, dV, 1]`, and the closed-loop transition to the
/// next state, `next [dx, dV, 1]`.
///
/// `next` is stored so that a stage of the forward pass need not wait for the controls of the stage
/// before.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Gain {
    w0: [f64; 3],
    w1: [f64; 3],
    next: [[f64; 3]; 2],
}

impl Gain {
    /// Feedback of cell `k` that meets the fixed x and V of the next cell.
    fn meeting(lengths: &[f64], states: &[CellState], k: usize) -> Self {
        let [dx, dv] = defect(lengths, states, k);
        let dv = dv * lengths[k] / lengths[k + 1];
        // The cubic with the given x and V at both ends.
        let (w0, w1) = ([6.0, 4.0, 6.0 * dx - 2.0 * dv], [-6.0, -2.0, 4.0 * dv - 6.0 * dx]);
        Self { w0, w1, next: [[0.0; 3]; 2] }
    }

    /// Sets `next`, for a next cell `ratio` times as long, with the continuity `defect`.
    #[inline(always)]
    fn leading_on<S: Simd>(self, ratio: f64, defect: [f64; 2]) -> Self {
        let Self { w0, w1, .. } = self;
        let row = |row: CellState, scale: f64, defect: f64| -> [f64; 3] {
            let through = |a: usize| fused::<S>(-row[2], w0[a], -row[3] * w1[a]);
            [
                scale * (row[0] + through(0)),
                scale * (row[1] + through(1)),
                fused::<S>(scale, through(2), defect),
            ]
        };
        let [dx, dv] = defect;
        Self { w0, w1, next: [row(EndX::ROW, 1.0, dx), row(EndV::ROW, ratio, dv)] }
    }

    /// Cost-to-go from the start of the cell.
    #[inline(never)]
    fn cost(&self, Quadratic { h, g }: &Quadratic) -> CostToGo {
        let ([w0x, w0v, w0], [w1x, w1v, w1]) = (self.w0, self.w1);
        let by = [[1.0, 0.0, -w0x, -w1x], [0.0, 1.0, -w0v, -w1v]];
        let [xx, xv, xw, xz, vv, vw, vz, ww, wz, zz] = *h;
        let product = |[x, v, w, z]: CellState| {
            [
                xx * x + xv * v + xw * w + xz * z,
                xv * x + vv * v + vw * w + vz * z,
                xw * x + vw * v + ww * w + wz * z,
                xz * x + vz * v + wz * w + zz * z,
            ]
        };
        let [of_x, of_v] = by.map(product);
        let constant = product([0.0, 0.0, -w0, -w1]);
        let slope: CellState = std::array::from_fn(|a| g[a] + constant[a]);
        let second = [dot(&by[0], &of_x), dot(&by[0], &of_v), dot(&by[1], &of_v)];
        CostToGo { p: second, g: by.map(|by| dot(&by, &slope)) }
    }
}

/// Gains of the stages, of a chain and of its parts.
#[derive(Default)]
pub(crate) struct Gains {
    stages: Vec<Gain>,
    parts: Vec<PartGain>,
}

/// Error: the quadratic function has no minimum, because numbers are out of range.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NotConvex;

/// Finds the steps of all states.
#[inline(always)]
pub(crate) fn solve<S: Simd>(
    simd: S,
    chain: &StageChain<'_>,
    gains: &mut Gains,
    steps: &mut [CellState],
) -> Result<(), NotConvex> {
    let Gains { stages: gains, parts } = gains;
    gains.resize(chain.lengths.len(), Gain::default());
    if let Some((mut parts, count)) = Parts::of::<S>(chain, parts) {
        let rest_start = chain.stages.start + count;
        let rest = StageChain { stages: rest_start..chain.stages.end, ..chain.clone() };
        let after = backwards::<S>(&rest, gains);
        let costs = parts.backwards(simd);
        // Rounding can deprive the parts of a minimum that the whole chain has.
        if let Some((cost, ends)) = riccati_parts::join(&costs, after)
            && let Ok(first) = first_step(chain, cost)
        {
            let between = riccati_parts::between(first, &ends);
            parts.forwards(simd, &between, steps);
            forwards::<S>(&rest, gains, between[between.len() - 1], steps);
            return Ok(());
        }
    }
    let cost = backwards::<S>(chain, gains);
    forwards::<S>(chain, gains, first_step(chain, cost)?, steps);
    Ok(())
}

/// Backward pass: finds the feedback of all stages. Returns the cost-to-go from the first one.
#[inline(always)]
fn backwards<S: Simd>(chain: &StageChain<'_>, gains: &mut [Gain]) -> CostToGo {
    let StageChain { ref stages, lengths, free, quadratics, states, ref to_rest, .. } = *chain;
    let n = lengths.len();
    let mut cost = CostToGo::default();
    for k in stages.clone().rev() {
        if k + 1 == stages.end && k + 1 < n {
            gains[k] = Gain::meeting(lengths, states, k);
            cost = gains[k].cost(&quadratics[k]);
            continue;
        }
        let Quadratic { h: mut m, mut g } = quadratics[k];
        if !free[k] {
            (m, g) = ([0.0; 10], [0.0; 4]);
        }
        let mut onward = (0.0, [0.0; 2]);
        if k + 1 < stages.end {
            let [dx, dv] = defect(lengths, states, k);
            let CostToGo { p, g: next } = cost;
            let next = [
                fused::<S>(p[0], dx, fused::<S>(p[1], dv, next[0])),
                fused::<S>(p[1], dx, fused::<S>(p[2], dv, next[1])),
            ];
            // V of the next cell in units of the length of this one.
            let ratio = lengths[k + 1] / lengths[k];
            onward = (ratio, [dx, dv]);
            let [xx, xv, vv] = [p[0], ratio * p[1], ratio * ratio * p[2]];
            let slope = [next[0], ratio * next[1]];
            let mut i = 0;
            for a in 0..4 {
                let (ex, ev) = (EndX::ROW[a], EndV::ROW[a]);
                let px = fused::<S>(xv, ev, xx * ex);
                let pv = fused::<S>(vv, ev, xv * ex);
                for b in a..4 {
                    m[i] = fused::<S>(px, EndX::ROW[b], fused::<S>(pv, EndV::ROW[b], m[i]));
                    i += 1;
                }
                g[a] = fused::<S>(slope[0], ex, fused::<S>(slope[1], ev, g[a]));
            }
        } else {
            (m, g) = without_w1(&m, &g, to_rest);
        }
        let [mut xx, mut xv, mut xw, xz, mut vv, mut vw, vz, mut ww, wz, zz] = m;
        let mut gain = Gain::default();
        if free[k] {
            // z denotes W1, w denotes W0.
            let inverse = 1.0 / zz;
            let w1 = [xz * inverse, vz * inverse, wz * inverse, g[3] * inverse];
            xx = fused::<S>(-xz, w1[0], xx);
            xv = fused::<S>(-xz, w1[1], xv);
            xw = fused::<S>(-xz, w1[2], xw);
            vv = fused::<S>(-vz, w1[1], vv);
            vw = fused::<S>(-vz, w1[2], vw);
            ww = fused::<S>(-wz, w1[2], ww);
            g = [
                fused::<S>(-xz, w1[3], g[0]),
                fused::<S>(-vz, w1[3], g[1]),
                fused::<S>(-wz, w1[3], g[2]),
                0.0,
            ];
            let inverse = 1.0 / ww;
            let w0 = [xw * inverse, vw * inverse, g[2] * inverse];
            xx = fused::<S>(-xw, w0[0], xx);
            xv = fused::<S>(-xw, w0[1], xv);
            vv = fused::<S>(-vw, w0[1], vv);
            g = [fused::<S>(-xw, w0[2], g[0]), fused::<S>(-vw, w0[2], g[1]), 0.0, 0.0];
            // Substitutes the feedback of W0 in that of W1.
            let [by_x, by_v, by_w0, one] = w1;
            let w1 = [
                fused::<S>(-by_w0, w0[0], by_x),
                fused::<S>(-by_w0, w0[1], by_v),
                fused::<S>(-by_w0, w0[2], one),
            ];
            gain = Gain { w0, w1, ..gain };
        }
        let (ratio, defect) = onward;
        gains[k] = gain.leading_on::<S>(ratio, defect);
        cost = CostToGo::convex([xx, xv, vv], [g[0], g[1]]);
    }
    cost
}

/// Step of x and V at the first stage, from the cost-to-go from there.
#[inline(always)]
fn first_step(chain: &StageChain<'_>, CostToGo { p, g }: CostToGo) -> Result<[f64; 2], NotConvex> {
    let Some(slope) = chain.slope_from_rest else { return Ok([0.0; 2]) };
    let curvature = p[0] + slope * (2.0 * p[1] + slope * p[2]);
    if !(curvature > 0.0 && curvature.is_finite()) {
        return Err(NotConvex);
    }
    let x = -(g[0] + slope * g[1]) / curvature;
    Ok([x, slope * x])
}

/// Forward pass: finds the steps from the feedback of all stages and the step of x and V at the
/// first one.
#[inline(always)]
fn forwards<S: Simd>(
    chain: &StageChain<'_>,
    gains: &[Gain],
    [mut x, mut v]: [f64; 2],
    steps: &mut [CellState],
) {
    let StageChain { ref stages, lengths, free, ref to_rest, .. } = *chain;
    let n = lengths.len();
    for k in stages.clone() {
        let Gain { w0, w1, next } = gains[k];
        let mut dy = [x, v, 0.0, 0.0];
        if free[k] {
            let by = |w: [f64; 3]| -fused::<S>(w[0], x, fused::<S>(w[1], v, w[2]));
            dy[2] = by(w0);
            if k + 1 < n {
                dy[3] = by(w1);
            } else {
                come_to_rest(to_rest, &mut dy);
            }
        }
        steps[k] = dy;
        let by = |row: [f64; 3]| fused::<S>(row[0], x, fused::<S>(row[1], v, row[2]));
        [x, v] = next.map(by);
    }
}

/// Continuity defect in x and V between the end of cell `k` and the start of the next one.
#[inline(always)]
pub(crate) fn defect(lengths: &[f64], states: &[CellState], k: usize) -> [f64; 2] {
    let (y, next) = (&states[k], &states[k + 1]);
    let ratio = lengths[k + 1] / lengths[k];
    [dot(&EndX::ROW, y) - next[0], ratio * dot(&EndV::ROW, y) - next[1]]
}

/// Sets W1 so that x ends at rest: `to_rest y` is zero.
#[inline(always)]
pub(crate) fn come_to_rest(to_rest: &CellState, y: &mut CellState) {
    y[3] = -(to_rest[0] * y[0] + to_rest[1] * y[1] + to_rest[2] * y[2]) / to_rest[3];
}

#[inline(always)]
pub(crate) fn dot(a: &CellState, b: &CellState) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3]
}

/// Eliminates W1 of the last cell by [`come_to_rest`] from its quadratic function; the diagonal
/// entry of W1 becomes 1.
#[inline(never)]
fn without_w1(m: &[f64; 10], g: &CellState, to_rest: &CellState) -> ([f64; 10], CellState) {
    let f: [f64; 3] = std::array::from_fn(|a| -to_rest[a] / to_rest[3]);
    let [xx, xv, xw, xz, vv, vw, vz, ww, wz, zz] = *m;
    let m = [
        xx + f[0] * (2.0 * xz + f[0] * zz),
        xv + f[0] * vz + f[1] * xz + f[0] * f[1] * zz,
        xw + f[0] * wz + f[2] * xz + f[0] * f[2] * zz,
        0.0,
        vv + f[1] * (2.0 * vz + f[1] * zz),
        vw + f[1] * wz + f[2] * vz + f[1] * f[2] * zz,
        0.0,
        ww + f[2] * (2.0 * wz + f[2] * zz),
        0.0,
        1.0,
    ];
    (m, [g[0] + f[0] * g[3], g[1] + f[1] * g[3], g[2] + f[2] * g[3], 0.0])
}

/// `a b + c`, fused into one instruction on machines with vector registers.
#[inline(always)]
fn fused<S: Simd>(a: f64, b: f64, c: f64) -> f64 {
    // Without them, `mul_add` would be a function call.
    if S::F64_LANES > 1 { a.mul_add(b, c) } else { a * b + c }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pseudo-random numbers between -1 and 1.
    fn numbers() -> impl FnMut() -> f64 {
        let mut n = 0.0_f64;
        move || {
            n += 1.0;
            (12.9898 * n * n).sin()
        }
    }

    /// Solves linear equations by Gauss elimination with row pivots; each row ends with its
    /// right-hand side.
    fn eliminated(mut rows: Vec<Vec<f64>>) -> Vec<f64> {
        let n = rows.len();
        for i in 0..n {
            let pivot = (i..n).max_by(|&a, &b| rows[a][i].abs().total_cmp(&rows[b][i].abs()));
            rows.swap(i, pivot.unwrap());
            for k in (0..n).filter(|k| *k != i) {
                let factor = rows[k][i] / rows[i][i];
                for c in i..=n {
                    rows[k][c] -= factor * rows[i][c];
                }
            }
        }
        (0..n).map(|i| rows[i][n] / rows[i][i]).collect()
    }

    /// Solves the Karush-Kuhn-Tucker conditions of all stages in one dense matrix.
    fn dense(chain: &StageChain<'_>) -> Vec<f64> {
        let (first, stages) = (chain.stages.start, chain.stages.len());
        let (unknowns, n) = (4 * stages, chain.lengths.len());
        // Coefficients by stage and component, and the right-hand side.
        let mut constraints: Vec<(Vec<(usize, f64)>, f64)> = Vec::new();
        match chain.slope_from_rest {
            Some(slope) => constraints.push((vec![(0, slope), (1, -1.0)], 0.0)),
            None => constraints.extend([0, 1].map(|a| (vec![(a, 1.0)], 0.0))),
        }
        for i in 0..stages {
            let k = first + i;
            if !chain.free[k] {
                constraints.extend([2, 3].map(|a| (vec![(4 * i + a, 1.0)], 0.0)));
            }
            if k + 1 == n {
                constraints.push(((0..4).map(|a| (4 * i + a, chain.to_rest[a])).collect(), 0.0));
                continue;
            }
            let ratio = chain.lengths[k + 1] / chain.lengths[k];
            let ends = [(EndX::ROW, 1.0), (EndV::ROW, ratio)];
            for (a, (row, scale)) in ends.into_iter().enumerate() {
                let missing = chain.states[k + 1][a] - scale * dot(&row, &chain.states[k]);
                let mut terms: Vec<_> = (0..4).map(|b| (4 * i + b, scale * row[b])).collect();
                if i + 1 < stages {
                    terms.push((4 * (i + 1) + a, -1.0));
                }
                constraints.push((terms, missing));
            }
        }
        let size = unknowns + constraints.len();
        let mut rows = vec![vec![0.0; size + 1]; size];
        for i in (0..stages).filter(|i| chain.free[first + i]) {
            let Quadratic { h, g } = chain.quadratics[first + i];
            let mut entries = h.into_iter();
            for a in 0..4 {
                for b in a..4 {
                    let entry = entries.next().unwrap();
                    rows[4 * i + a][4 * i + b] = entry;
                    rows[4 * i + b][4 * i + a] = entry;
                }
                rows[4 * i + a][size] = -g[a];
            }
        }
        for (c, (terms, side)) in constraints.into_iter().enumerate() {
            for (unknown, factor) in terms {
                rows[unknown][unknowns + c] = factor;
                rows[unknowns + c][unknown] = factor;
            }
            rows[unknowns + c][size] = side;
        }
        eliminated(rows)
    }

    /// Solves a chain with the widest vector registers of this machine.
    struct WithRegisters<'a>(&'a StageChain<'a>);

    impl pulp::WithSimd for WithRegisters<'_> {
        type Output = (Vec<CellState>, usize);

        fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
            let (mut gains, mut steps) = (Gains::default(), vec![[f64::NAN; 4]; 90]);
            solve(simd, self.0, &mut gains, &mut steps).unwrap();
            (steps, gains.parts.len())
        }
    }

    #[test]
    fn steps_of_parts_are_those_of_the_whole_chain() {
        const CELLS: usize = 90;
        let mut number = numbers();
        let lengths: Vec<f64> = (0..CELLS).map(|_| 0.5 + 0.45 * number()).collect();
        let states: Vec<CellState> = (0..CELLS).map(|_| [(); 4].map(|()| number())).collect();
        let quadratics: Vec<Quadratic> = (0..CELLS)
            .map(|_| {
                let mut sum = Quadratic::default();
                for _ in 0..8 {
                    sum.add(&[(); 4].map(|()| number()), 1.5 + number(), number());
                }
                sum
            })
            .collect();
        let to_rest = [1.0, 1.2, 0.5, 0.4];
        let free = vec![true; CELLS];
        // With short cells at the ends of all possible parts, the whole chain is solved.
        let mut short = lengths.clone();
        short[9..11].fill(1e-5);
        for (stages, slope_from_rest) in
            [(0..90, Some(0.8)), (0..90, None), (3..75, None), (0..65, Some(-0.4)), (26..90, None)]
        {
            let case = format!("{stages:?}, {slope_from_rest:?}");
            let chain = StageChain {
                stages: stages.clone(),
                lengths: &lengths,
                free: &free,
                quadratics: &quadratics,
                states: &states,
                slope_from_rest,
                to_rest,
            };
            let (steps, parts) = pulp::Arch::new().dispatch(WithRegisters(&chain));
            let registers = !matches!(pulp::Arch::new(), pulp::Arch::Scalar);
            assert_eq!(parts > 0, registers, "{case}");
            let expected = dense(&chain);
            for (step, expected) in steps[stages.clone()].iter().flatten().zip(&expected) {
                let error = (step - expected).abs();
                assert!(error < 1e-8 * (1.0 + expected.abs()), "{case}: {step} {expected}");
            }
            let (before, after) = (&steps[..stages.start], &steps[stages.end..]);
            assert!(before.iter().chain(after).flatten().all(|step| step.is_nan()), "{case}");
            let ends_short = StageChain { lengths: &short, ..chain };
            let (_, parts) = pulp::Arch::new().dispatch(WithRegisters(&ends_short));
            let has_long_ends = [0..65, 26..90].contains(&stages);
            assert_eq!(parts > 0, registers && has_long_ends, "{case}");
        }
    }

    #[test]
    fn steps_are_those_of_a_dense_matrix() {
        let mut number = numbers();
        let lengths = [0.3, 0.5, 0.2, 0.4];
        let states: [CellState; 4] = [(); 4].map(|()| [(); 4].map(|()| number()));
        let quadratics: [Quadratic; 4] = [(); 4].map(|()| {
            let mut sum = Quadratic::default();
            for _ in 0..8 {
                sum.add(&[(); 4].map(|()| number()), 1.5 + number(), number());
            }
            sum
        });
        let to_rest = [1.0, 1.0 + 0.3 * number(), 0.5, 0.4];
        let [all, inner] = [[true; 4], [true, false, true, true]];
        let cases = [
            (0..4, None, all),
            (0..4, Some(0.8), all),
            (0..4, Some(-1.2), inner),
            (0..3, Some(0.8), all),
            (1..3, None, all),
            (1..4, None, all),
            (0..4, None, inner),
            (0..1, Some(0.3), all),
            (3..4, None, all),
        ];
        for (stages, slope_from_rest, free) in cases {
            let case = format!("{stages:?}, {slope_from_rest:?}, {free:?}");
            let chain = StageChain {
                stages: stages.clone(),
                lengths: &lengths,
                free: &free,
                quadratics: &quadratics,
                states: &states,
                slope_from_rest,
                to_rest,
            };
            let (mut gains, mut steps) = (Gains::default(), [[f64::NAN; 4]; 4]);
            solve(pulp::Scalar::new(), &chain, &mut gains, &mut steps).unwrap();
            let expected = dense(&chain);
            for (step, expected) in steps[stages.clone()].iter().flatten().zip(&expected) {
                let error = (step - expected).abs();
                assert!(error < 1e-8 * (1.0 + expected.abs()), "{case}: {step} {expected}");
            }
            let (before, after) = (&steps[..stages.start], &steps[stages.end..]);
            assert!(before.iter().chain(after).flatten().all(|step| step.is_nan()), "{case}");
        }
    }
}
