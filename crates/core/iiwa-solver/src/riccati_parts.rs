//! Riccati recursion over eight parts of a chain side by side, one part in each vector lane.
//!
//! In the recursion each stage waits for the next one, so that its time is the latency of the
//! operations and not their number. Here the chain is cut into eight parts of equal length, which
//! are eliminated at the same time. The step (E, F) of (x, V) after each part remains a parameter:
//! the cost of a part is a quadratic function of (x, V) at its start and of (E, F). Eight small
//! eliminations then join the parts, from the last one to the first one.

use pulp::Simd;

use crate::{
    cell_functions::{CellState, EndV, EndX, Functional, Terms},
    lanes::{LANES, Lanes, Vector, columns, registers},
    stage_chain::{CostToGo, StageChain},
};

/// Number of stages from which parts are used.
pub(crate) const MIN_STAGES: usize = 8 * LANES;

/// Least length of the last cell of a part, as a share of the longest cell. W0 and W1 of this cell
/// meet a given state; in shorter cells they are differences of large numbers, and steps lose their
/// precision.
const MIN_LAST_LENGTH: f64 = 1e-3;

/// A quadratic function of (x, V, E, F): the upper triangle of its coefficients over
/// (x, V, E, F, 1), row by row, without the constant.
type PartCost<T> = [T; 14];

/// One stage of each part: the feedback `dW0 = -w0 [dx, dV, E, F, 1]` and `dW1 = -w1 [...]`, and
/// the transition to the next stage.
#[derive(Clone, Debug, Default)]
pub(crate) struct PartGain {
    w0: [Lanes; 5],
    w1: [Lanes; 5],
    transition: Transition<Lanes>,
}

/// Transition to the next stage: x and V there are `(END_X y, ratio END_V y) + defect`.
#[derive(Clone, Copy, Debug, Default)]
struct Transition<T> {
    /// Length of the next cell over that of this one.
    ratio: T,
    defect: [T; 2],
}

/// Steps of x and V at the start of each part and after the last one.
pub(crate) type PartStates = [[f64; 2]; LANES + 1];

/// Feedback at the end of a part, `E = -e [dx, dV, 1]` and `F = -f [dx, dV, 1]`.
type JoinGain = [[f64; 3]; 2];

/// The parts of a chain with their costs and gains.
pub(crate) struct Parts<'a> {
    chain: &'a StageChain<'a>,
    /// Number of stages in each part.
    stages: usize,
    gains: &'a mut Vec<PartGain>,
}

impl<'a> Parts<'a> {
    /// Returns the parts at the beginning of a chain, with the number of their stages together; at
    /// least one stage is left to the recursion of the whole chain. `None` if the chain is short,
    /// has cells with fixed W0 and W1, or has short cells at the end of each possible part.
    #[inline(always)]
    pub(crate) fn of<S: Simd>(
        chain: &'a StageChain<'a>,
        gains: &'a mut Vec<PartGain>,
    ) -> Option<(Self, usize)> {
        let all = chain.stages.clone();
        if S::F64_LANES == 1 || all.len() < MIN_STAGES || chain.free[all.clone()].contains(&false) {
            return None;
        }
        let lengths = &chain.lengths[all.clone()];
        let min_length = MIN_LAST_LENGTH * lengths.iter().copied().fold(0.0, f64::max);
        let ends_long =
            |stages: &usize| (1..=LANES).all(|part| lengths[part * stages - 1] >= min_length);
        let most = (all.len() - 1) / LANES;
        let stages = (most - most / 8..=most).rev().find(ends_long)?;
        if gains.len() < stages {
            gains.resize(stages, PartGain::default());
        }
        Some((Self { chain, stages, gains }, LANES * stages))
    }

    /// Index of the cell at a stage of the part in a lane.
    #[inline(always)]
    fn cell(&self, lane: usize, stage: usize) -> usize {
        self.chain.stages.start + lane * self.stages + stage
    }

    /// Backward pass: finds the gains of all stages. Returns the costs of the parts.
    #[inline(always)]
    pub(crate) fn backwards<S: Simd>(&mut self, simd: S) -> PartCost<Lanes> {
        let StageChain { lengths, quadratics, states, .. } = *self.chain;
        let first_of_lanes = self.chain.stages.start;
        let mut cost = PartCost::default();
        let after = |a: usize| Lanes::from_fn(|l| states[self.cell(l, self.stages)][a]);
        let mut next = [after(0), after(1)];
        let mut next_length = Lanes::from_fn(|l| lengths[self.cell(l, self.stages)]);
        for stage in (0..self.stages).rev() {
            let at = |l: usize| first_of_lanes + l * self.stages + stage;
            let length = Lanes::from_fn(|l| lengths[at(l)]);
            let gain = &mut self.gains[stage];
            for r in 0..registers::<S>() {
                let mut sum = Terms::new(simd);
                sum.h = columns(simd, r, |l| &quadratics[at(l)].h);
                sum.g = columns(simd, r, |l| &quadratics[at(l)].g);
                let state = &columns(simd, r, |l| &states[at(l)]);
                let ratio = next_length.load(simd, r) * length.load(simd, r).inverse();
                let defect = [
                    EndX::of(state) - next[0].load(simd, r),
                    ratio * EndV::of(state) - next[1].load(simd, r),
                ];
                next[0].store(r, state[0]);
                next[1].store(r, state[1]);
                let transition = Transition { ratio, defect };
                let mut of_next = load(simd, r, &cost);
                let [w0, w1] = if stage + 1 == self.stages {
                    end(&sum, &transition, &mut of_next)
                } else {
                    eliminate(&mut sum, &transition, &mut of_next)
                };
                store(r, &mut cost, &of_next);
                store(r, &mut gain.w0, &w0);
                store(r, &mut gain.w1, &w1);
                gain.transition.ratio.store(r, ratio);
                store(r, &mut gain.transition.defect, &defect);
            }
            next_length = length;
        }
        cost
    }

    /// Forward pass: finds the steps of all stages from the states between the parts.
    #[inline(always)]
    pub(crate) fn forwards<S: Simd>(&self, simd: S, between: &PartStates, steps: &mut [CellState]) {
        let at = |a: usize, after: usize| Lanes::from_fn(|l| between[l + after][a]);
        let (mut state, end) = ([at(0, 0), at(1, 0)], [at(0, 1), at(1, 1)]);
        let mut step = [Lanes::default(); 4];
        for stage in 0..self.stages {
            let PartGain { w0, w1, transition } = &self.gains[stage];
            for r in 0..registers::<S>() {
                let [x, v] = load(simd, r, &state);
                let [e, f] = load(simd, r, &end);
                let of = [x, v, e, f];
                let y = &[x, v, control(r, w0, of), control(r, w1, of)];
                let [dx, dv] = load(simd, r, &transition.defect);
                let next_v = transition.ratio.load(simd, r).mul_add(EndV::of(y), dv);
                store(r, &mut state, &[EndX::of(y) + dx, next_v]);
                store(r, &mut step, y);
            }
            for l in 0..LANES {
                let to = &mut steps[self.cell(l, stage)];
                for a in 0..4 {
                    to[a] = step[a].0[l];
                }
            }
        }
    }
}

/// Step of a control by its feedback `w`.
#[inline(always)]
fn control<S: Simd>(r: usize, w: &[Lanes; 5], [x, v, e, f]: [Vector<S>; 4]) -> Vector<S> {
    let simd = x.simd();
    let by_end = w[2].load(simd, r).mul_add(e, w[3].load(simd, r).mul_add(f, w[4].load(simd, r)));
    -w[0].load(simd, r).mul_add(x, w[1].load(simd, r).mul_add(v, by_end))
}

/// Eliminates W1 and then W0 of a stage. `cost` is the cost from the next stage on, and becomes
/// that from this stage on. Returns the feedback of both.
#[inline(always)]
fn eliminate<S: Simd>(
    stage: &mut Terms<S>,
    Transition { ratio, defect: [dx, dv] }: &Transition<Vector<S>>,
    cost: &mut PartCost<Vector<S>>,
) -> [[Vector<S>; 5]; 2] {
    let [xx, xv, xe, xf, x, vv, ve, vf, v, ee, ef, e, ff, f] = *cost;
    // At the defect, and with V in units of the length of this cell.
    let by_x = xx.mul_add(*dx, xv.mul_add(*dv, x));
    let by_v = xv.mul_add(*dx, vv.mul_add(*dv, v)) * *ratio;
    let by_e = xe.mul_add(*dx, ve.mul_add(*dv, e));
    let by_f = xf.mul_add(*dx, vf.mul_add(*dv, f));
    stage.add_square::<EndX>(xx);
    stage.add_product::<EndX, EndV>(xv * *ratio);
    stage.add_square::<EndV>(vv * *ratio * *ratio);
    stage.add_linear::<EndX>(by_x);
    stage.add_linear::<EndV>(by_v);
    let with_e = through(xe, ve * *ratio);
    let with_f = through(xf, vf * *ratio);
    // Here w denotes W0 and z denotes W1.
    let [xx, xv, xw, xz, vv, vw, vz, ww, wz, zz] = stage.h;
    let [x, v, w, z] = stage.g;
    *cost = [xx, xv, with_e[0], with_f[0], x, vv, with_e[1], with_f[1], v, ee, ef, by_e, ff, by_f];
    let inverse = zz.inverse();
    let row = [xz, vz, with_e[3], with_f[3], z];
    let mut w1 = scaled(&row, inverse);
    let w1_by_w0 = wz * inverse;
    subtract(cost, &row, &w1);
    let mut row = [xw, vw, with_e[2], with_f[2], w];
    for a in 0..5 {
        row[a] = (-wz).mul_add(w1[a], row[a]);
    }
    let inverse = (-wz).mul_add(w1_by_w0, ww).inverse();
    let w0 = scaled(&row, inverse);
    subtract(cost, &row, &w0);
    // Substitutes the feedback of W0 in that of W1.
    for a in 0..5 {
        w1[a] = (-w1_by_w0).mul_add(w0[a], w1[a]);
    }
    [w0, w1]
}

/// Feedback of the last stage of a part, the cubic that meets (E, F); sets `cost` to the cost of
/// the stage.
#[inline(always)]
fn end<S: Simd>(
    stage: &Terms<S>,
    Transition { ratio, defect: [dx, dv] }: &Transition<Vector<S>>,
    cost: &mut PartCost<Vector<S>>,
) -> [[Vector<S>; 5]; 2] {
    let number = |value: f64| Vector::splat(ratio.simd(), value);
    let inverse = ratio.inverse();
    let dv = *dv * inverse;
    let w0 = [number(6.0), number(4.0), number(-6.0), inverse * 2.0, *dx * 6.0 - dv * 2.0];
    let w1 = [number(-6.0), number(-2.0), number(6.0), inverse * -4.0, dv * 4.0 - *dx * 6.0];
    let [xx, xv, xw, xz, vv, vw, vz, ww, wz, zz] = stage.h;
    let (zero, one) = (number(0.0), number(1.0));
    let mut i = 0;
    for a in 0..4 {
        for b in a..5 {
            // State of the cell by the variable b.
            let x = if b == 0 { one } else { zero };
            let v = if b == 1 { one } else { zero };
            let (w, z) = (-w0[b], -w1[b]);
            let mut product = [
                xx * x + xv * v + xw * w + xz * z,
                xv * x + vv * v + vw * w + vz * z,
                xw * x + vw * v + ww * w + wz * z,
                xz * x + vz * v + wz * w + zz * z,
            ];
            if b == 4 {
                for c in 0..4 {
                    product[c] = product[c] + stage.g[c];
                }
            }
            let controls = -(w0[a] * product[2] + w1[a] * product[3]);
            cost[i] = if a < 2 { controls + product[a] } else { controls };
            i += 1;
        }
    }
    [w0, w1]
}

/// Products of a cross term with x and V of the next stage, by the state of this cell.
#[inline(always)]
fn through<S: Simd>(x: Vector<S>, v: Vector<S>) -> [Vector<S>; 4] {
    let mut sum = Terms::new(x.simd());
    sum.add_linear::<EndX>(x);
    sum.add_linear::<EndV>(v);
    sum.g
}

/// Subtracts the product of a row and its feedback from a cost.
#[inline(always)]
fn subtract<S: Simd>(
    cost: &mut PartCost<Vector<S>>,
    row: &[Vector<S>; 5],
    feedback: &[Vector<S>; 5],
) {
    let mut i = 0;
    for a in 0..4 {
        for b in a..5 {
            cost[i] = (-row[a]).mul_add(feedback[b], cost[i]);
            i += 1;
        }
    }
}

#[inline(always)]
fn scaled<S: Simd>(row: &[Vector<S>; 5], factor: Vector<S>) -> [Vector<S>; 5] {
    let mut scaled = *row;
    for value in &mut scaled {
        *value = *value * factor;
    }
    scaled
}

#[inline(always)]
fn load<S: Simd, const N: usize>(simd: S, r: usize, lanes: &[Lanes; N]) -> [Vector<S>; N] {
    let mut vectors = [Vector::splat(simd, 0.0); N];
    for (vector, lanes) in vectors.iter_mut().zip(lanes) {
        *vector = lanes.load(simd, r);
    }
    vectors
}

#[inline(always)]
fn store<S: Simd, const N: usize>(r: usize, lanes: &mut [Lanes; N], vectors: &[Vector<S>; N]) {
    for (lanes, vector) in lanes.iter_mut().zip(vectors) {
        lanes.store(r, *vector);
    }
}

/// Joins the parts with the cost-to-go after the last one. Returns the cost-to-go from the first
/// stage and the feedback at the end of each part; `None` if rounding leaves no minimum at an end,
/// or if numbers are out of range.
pub(crate) fn join(
    costs: &PartCost<Lanes>,
    mut after: CostToGo,
) -> Option<(CostToGo, [JoinGain; LANES])> {
    let mut gains = [JoinGain::default(); LANES];
    for l in (0..LANES).rev() {
        let [mut xx, mut xv, xe, xf, mut x, mut vv, ve, vf, mut v, ee, ef, e, ff, f] =
            costs.map(|lanes| lanes.0[l]);
        let CostToGo { p, g } = after;
        // F is eliminated first, then E.
        let ff = ff + p[2];
        let row = [xf, vf, ef + p[1], f + g[1]];
        let by = row.map(|value| value / ff);
        let reduced = [xe - row[2] * by[0], ve - row[2] * by[1], e + g[0] - row[2] * by[3]];
        let ee = ee + p[0] - row[2] * by[2];
        if !(ff > 0.0 && ee > 0.0 && ff.is_finite() && ee.is_finite()) {
            return None;
        }
        let of_e = reduced.map(|value| value / ee);
        let of_f = [by[0] - by[2] * of_e[0], by[1] - by[2] * of_e[1], by[3] - by[2] * of_e[2]];
        xx -= xf * by[0] + reduced[0] * of_e[0];
        xv -= xf * by[1] + reduced[0] * of_e[1];
        vv -= vf * by[1] + reduced[1] * of_e[1];
        x -= xf * by[3] + reduced[0] * of_e[2];
        v -= vf * by[3] + reduced[1] * of_e[2];
        gains[l] = [of_e, of_f];
        after = CostToGo::convex([xx, xv, vv], [x, v]);
    }
    let CostToGo { p, g } = after;
    p.iter().chain(&g).all(|value| value.is_finite()).then_some((after, gains))
}

/// States between the parts, from that at the start.
pub(crate) fn between(start: [f64; 2], gains: &[JoinGain; LANES]) -> PartStates {
    let mut states = PartStates::default();
    states[0] = start;
    for (l, gain) in gains.iter().enumerate() {
        let [x, v] = states[l];
        states[l + 1] = gain.map(|[by_x, by_v, one]| -(by_x * x + by_v * v + one));
    }
    states
}
