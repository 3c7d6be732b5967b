//! The limits in eight cells at once, and what they contribute to a step of the solver.
//!
//! In a cell x is a cubic of the share f of its length, with V = dx/df and W = d2x/df2, of which W
//! changes linearly from W0 to W1:
//! `x(f) = x + V f + W0 (f^2/2 - f^3/6) + W1 f^3/6`.
//! The four numbers (x, V, W0, W1) at its start are its state. Limits are kept
//! - in speed, at three of the four control points of that cubic (the fourth is the next cell's first):
//!   it stays in their hull, so that it cannot swing out in between;
//! - in acceleration, `q' x'/2 + q'' x`, at the start and in the middle, or on lines at the middle
//!   control point of x';
//! - in jerk, `sqrt(x) (q' x''/2 + 3/2 q'' x' + q''' x)`, at both ends and in the middle. Here x moves to
//!   the other slack, which leaves something linear below `x^(-1/2)`.
//!
//! Every limit is a row, divided by the limit so that the bound is 1, with a slack s and a dual z on
//! either slack. Lines have one row for all joints, which move in proportion; curves have seven.

use pulp::Simd;

use super::{
    limited_segment::{LimitedSegment, Rates},
    mesh::{Cell, Mesh},
    quadratic::{CellState, Quadratic, Terms},
    settings::InteriorPointSettings,
    slack_pair::{InteriorStep, InteriorSteps, SlackPair},
};
use crate::lanes::{LANES, Lanes, Vector, registers};

/// The functions that are the state's own numbers.
const UNIT: [CellState; 4] =
    [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];
/// x at the start of a cell.
pub(crate) const START_X: CellState = UNIT[0];
/// x at the end of a cell.
pub(crate) const END_X: CellState = [1.0, 1.0, 1.0 / 3.0, 1.0 / 6.0];
/// V there.
pub(crate) const END_V: CellState = [0.0, 1.0, 0.5, 0.5];
/// x in the middle.
const MIDDLE_X: CellState = [1.0, 0.5, 5.0 / 48.0, 1.0 / 48.0];
/// V in the middle.
const MIDDLE_V: CellState = [0.0, 1.0, 3.0 / 8.0, 1.0 / 8.0];
/// W there.
const MIDDLE_W: CellState = [0.0, 0.0, 0.5, 0.5];
/// V at its middle control point: the parabola V(f) stays in the hull of both ends and it.
const CONTROL_V: CellState = [0.0, 1.0, 0.5, 0.0];
/// The first three control points of x.
const CONTROL: [CellState; 3] =
    [[1.0, 0.0, 0.0, 0.0], [1.0, 1.0 / 3.0, 0.0, 0.0], [1.0, 2.0 / 3.0, 1.0 / 6.0, 0.0]];

/// The shares of a cell's length at which jerk is kept.
const JERK_PLACES: [f64; 3] = [0.0, 1.0, 0.5];

const SETTINGS: InteriorPointSettings = super::settings::SETTINGS.interior_point;

/// What is summed up over all limits.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Sums {
    /// Slacks times duals.
    pub(crate) gap: f64,
    /// Largest share of a bound by which a limit is not met.
    pub(crate) residual: f64,
}

/// The largest relative ratios that a full step would bring.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct StepRatios {
    pub(crate) slack: f64,
    pub(crate) dual: f64,
    pub(crate) x: f64,
}

/// The rows of acceleration at one place of a cell: factors of x and V for each joint.
#[derive(Clone, Copy, Debug)]
struct AccelerationRows<const J: usize> {
    x: [Lanes; J],
    v: [Lanes; J],
    slacks: [[SlackPair; 2]; J],
}

/// The rows of jerk at one place of a cell: factors of x, V and W for each joint.
#[derive(Clone, Copy, Debug)]
struct JerkRows<const J: usize> {
    x: [Lanes; J],
    v: [Lanes; J],
    w: [Lanes; J],
    slacks: [[SlackPair; 2]; J],
}

/// The row of speed at a control point: one over the largest x. The other slack keeps x positive.
#[derive(Clone, Copy, Debug, Default)]
struct VelocityRows {
    x: Lanes,
    slacks: [SlackPair; 2],
}

/// Eight cells with `J` rows of each kind.
#[derive(Clone, Debug)]
pub(crate) struct CellBlock<const J: usize> {
    /// Which cells. In the last block some may be there twice, which changes nothing.
    cells: [usize; LANES],
    /// Half the length: the weight of `x^(-1/2)` at both ends in the duration.
    weight: Lanes,
    speeds: [VelocityRows; 3],
    accelerations: [AccelerationRows<J>; 2],
    jerks: [JerkRows<J>; 3],
}

/// x, V and W somewhere in the cells.
type Place<S> = [Vector<S>; 3];

/// Blocks of the cells in `list`.
pub(crate) fn blocks<const J: usize>(
    segments: &[LimitedSegment<'_>],
    mesh: &Mesh,
    list: &[usize],
) -> Vec<CellBlock<J>> {
    list.chunks(LANES)
        .map(|chunk| {
            let mut block = CellBlock::new(std::array::from_fn(|l| chunk[l.min(chunk.len() - 1)]));
            for lane in 0..LANES {
                let at = block.cells[lane];
                let cell = &mesh.cells[at];
                let starts_leg = match at.checked_sub(1) {
                    Some(before) => mesh.cells[before].segment != cell.segment,
                    None => mesh.from_rest.is_none_or(|rest| rest.segment != cell.segment),
                };
                let before = if starts_leg { cell.segment.checked_sub(1) } else { None };
                let before = before.map(|before| &segments[before]);
                block.limit(lane, cell, &segments[cell.segment], before);
            }
            block
        })
        .collect()
}

impl<const J: usize> CellBlock<J> {
    fn new(cells: [usize; LANES]) -> Self {
        let rows = [Lanes::default(); J];
        let slacks = [[SlackPair::default(); 2]; J];
        Self {
            cells,
            weight: Lanes::default(),
            speeds: [VelocityRows::default(); 3],
            accelerations: [AccelerationRows { x: rows, v: rows, slacks }; 2],
            jerks: [JerkRows::new(); 3],
        }
    }

    /// How many limits there are.
    pub(crate) fn count(blocks: &[Self]) -> usize {
        LANES * blocks.len() * (6 + 4 * J + 6 * J)
    }

    /// Sets the rows of one cell, of which `before` is the segment that ends where it starts.
    fn limit(
        &mut self,
        lane: usize,
        cell: &Cell,
        segment: &LimitedSegment<'_>,
        before: Option<&LimitedSegment<'_>>,
    ) {
        let Cell { from, length, .. } = *cell;
        let at = |share: f64| segment.rates(segment.s(from + share * length).clamp(0.0, 1.0));
        let least = |own: &[f64; 7], other: Option<&[f64; 7]>| {
            other.map_or(*own, |other| std::array::from_fn(|j| own[j].min(other[j])))
        };
        let speed = least(
            &segment.limits.velocity_rad_s,
            before.map(|before| &before.limits.velocity_rad_s),
        );
        let acceleration = least(
            &segment.limits.acceleration_rad_s2,
            before.map(|before| &before.limits.acceleration_rad_s2),
        );

        self.weight.0[lane] = 0.5 * length;
        let start = at(0.0);
        let cap = |[dq, ..]: &Rates, speed: &[f64; 7]| {
            (0..7).map(|j| (dq[j] / speed[j]).powi(2)).fold(0.0, f64::max)
        };
        self.speeds[0].x.0[lane] = cap(&start, &speed);
        self.speeds[1].x.0[lane] = cap(&at(1.0 / 3.0), &segment.limits.velocity_rad_s);
        self.speeds[2].x.0[lane] = cap(&at(2.0 / 3.0), &segment.limits.velocity_rad_s);

        self.accelerations[0].limit(lane, &start, length, &acceleration.map(|limit| 1.0 / limit));
        let [_, own, jerk] = &segment.inverse;
        self.accelerations[1].limit(lane, &at(0.5), length, own);
        for (rows, place) in self.jerks.iter_mut().zip(JERK_PLACES) {
            let bound = if J > 1 && place == 0.5 { SETTINGS.mid_jerk } else { 1.0 };
            rows.limit(lane, &at(place), length, &jerk.map(|inverse| inverse / bound));
        }
    }

    /// Lowers the limits of speed, acceleration and jerk in each cell by the factors `by`.
    pub(crate) fn tighten(&mut self, by: &[[f64; 3]]) {
        for (lane, cell) in self.cells.into_iter().enumerate() {
            let [speed, acceleration, jerk] = by[cell];
            for row in &mut self.speeds {
                row.x.0[lane] /= speed * speed;
            }
            for rows in &mut self.accelerations {
                for row in rows.x.iter_mut().chain(&mut rows.v) {
                    row.0[lane] /= acceleration;
                }
            }
            for rows in &mut self.jerks {
                for row in rows.x.iter_mut().chain(&mut rows.v).chain(&mut rows.w) {
                    row.0[lane] /= jerk;
                }
            }
        }
    }

    #[inline(always)]
    fn gather(&self, states: &[CellState]) -> [Lanes; 4] {
        std::array::from_fn(|a| Lanes::from_fn(|l| states[self.cells[l]][a]))
    }

    /// Sets slacks to what the limits leave, but at least the share `least` of the bound, and duals
    /// so that their product is `mu`.
    #[inline(always)]
    pub(crate) fn start<S: Simd>(&mut self, simd: S, states: &[CellState], mu: f64, least: f64) {
        let lanes = self.gather(states);
        let one = Vector::splat(simd, 1.0);
        let least = Vector::splat(simd, least);
        let mu = Vector::splat(simd, mu);
        for r in 0..registers::<S>() {
            let y = lanes.map(|lanes| lanes.load(simd, r));
            for (speed, control) in self.speeds.iter_mut().zip(&CONTROL) {
                let value = speed.x.load(simd, r) * times(control, &y);
                speed.slacks[0].start(r, one - value, least, mu);
                speed.slacks[1].start(r, value, least * value.abs(), mu);
            }
            for (acceleration, [x, v, _]) in
                self.accelerations.iter_mut().zip(acceleration_places::<J, S>(&y))
            {
                for j in 0..J {
                    let value =
                        acceleration.x[j].load(simd, r) * x + acceleration.v[j].load(simd, r) * v;
                    acceleration.slacks[j][0].start(r, one - value, least, mu);
                    acceleration.slacks[j][1].start(r, one + value, least, mu);
                }
            }
            for (jerk, [x, v, w]) in self.jerks.iter_mut().zip(jerk_places(&y)) {
                let bound = x.sqrt().inverse();
                for j in 0..J {
                    let value = jerk.x[j].load(simd, r) * x
                        + jerk.v[j].load(simd, r) * v
                        + jerk.w[j].load(simd, r) * w;
                    jerk.slacks[j][0].start(r, bound - value, least * bound, mu);
                    jerk.slacks[j][1].start(r, bound + value, least * bound, mu);
                }
            }
        }
    }

    /// Goes the last step of slacks and duals, then writes what the cells' duration and limits contribute
    /// to the quadratic function that the next step minimises.
    #[inline(always)]
    pub(crate) fn assemble<S: Simd>(
        &mut self,
        simd: S,
        states: &[CellState],
        [last, next]: [InteriorStep; 2],
        quadratics: &mut [Quadratic],
        sums: &mut Sums,
    ) {
        let lanes = self.gather(states);
        let mut h = [Lanes::default(); 10];
        let mut g = [Lanes::default(); 4];
        for r in 0..registers::<S>() {
            let y = lanes.map(|lanes| lanes.load(simd, r));
            let zero = Vector::splat(simd, 0.0);
            let mut sum = Terms { h: [zero; 10], g: [zero; 4], gap: zero, residual: zero };
            let steps = InteriorSteps::new(simd, r, last, next);
            self.speed_terms(&steps, &y, &mut sum);
            self.acceleration_terms(&steps, &y, &mut sum);
            self.jerk_terms(&steps, &y, &mut sum);
            std::iter::zip(&mut h, sum.h).for_each(|(lanes, h)| lanes.store(r, h));
            std::iter::zip(&mut g, sum.g).for_each(|(lanes, g)| lanes.store(r, g));
            sums.gap += sum.gap.sum();
            sums.residual = sums.residual.max(sum.residual.largest());
        }
        for (lane, cell) in self.cells.into_iter().enumerate() {
            quadratics[cell] =
                Quadratic { h: h.map(|value| value.0[lane]), g: g.map(|value| value.0[lane]) };
        }
    }

    #[inline(always)]
    fn speed_terms<S: Simd>(
        &mut self,
        steps: &InteriorSteps<S>,
        y: &[Vector<S>; 4],
        sum: &mut Terms<S>,
    ) {
        let one = Vector::splat(steps.simd, 1.0);
        for (speed, control) in self.speeds.iter_mut().zip(&CONTROL) {
            let row = speed.x.load(steps.simd, steps.register);
            let value = row * times(control, y);
            let [a, b] = &mut speed.slacks;
            let (a, b) = (a.advance(steps), b.advance(steps));
            let miss = [value - one + a.s, b.s - value];
            sum.gap = a.s.mul_add(a.z, b.s.mul_add(b.z, sum.gap));
            sum.residual = sum.residual.max(miss[0].abs()).max(miss[1].abs());
            let both = (a.weight + b.weight) * row * row;
            let slope = (a.slope(steps, miss[0]) - b.slope(steps, miss[1])) * row;
            sum.add(&[(*control, *control, both)], &[(*control, slope)]);
        }
    }

    #[inline(always)]
    fn acceleration_terms<S: Simd>(
        &mut self,
        steps: &InteriorSteps<S>,
        y: &[Vector<S>; 4],
        sum: &mut Terms<S>,
    ) {
        let InteriorSteps { simd, register, .. } = *steps;
        let zero = Vector::splat(simd, 0.0);
        let one = Vector::splat(simd, 1.0);
        for (n, [x, v, _]) in acceleration_places::<J, S>(y).into_iter().enumerate() {
            let acceleration = &mut self.accelerations[n];
            let [mut xx, mut xv, mut vv, mut gx, mut gv] = [zero; 5];
            for j in 0..J {
                let (px, pv) = (
                    acceleration.x[j].load(simd, register),
                    acceleration.v[j].load(simd, register),
                );
                let value = px.mul_add(x, pv * v);
                let [a, b] = &mut acceleration.slacks[j];
                let (a, b) = (a.advance(steps), b.advance(steps));
                let miss = [value - one + a.s, b.s - value - one];
                sum.gap = a.s.mul_add(a.z, b.s.mul_add(b.z, sum.gap));
                sum.residual = sum.residual.max(miss[0].abs()).max(miss[1].abs());
                let slope = a.slope(steps, miss[0]) - b.slope(steps, miss[1]);
                let both = a.weight + b.weight;
                let (bx, bv) = (both * px, both * pv);
                xx = bx.mul_add(px, xx);
                xv = bx.mul_add(pv, xv);
                vv = bv.mul_add(pv, vv);
                gx = slope.mul_add(px, gx);
                gv = slope.mul_add(pv, gv);
            }
            let (rx, rv) =
                if n == 0 { (UNIT[0], UNIT[1]) } else { (MIDDLE_X, *acceleration_v::<J>()) };
            sum.add(&[(rx, rx, xx), (rx, rv, xv), (rv, rv, vv)], &[(rx, gx), (rv, gv)]);
        }
    }

    #[inline(always)]
    fn jerk_terms<S: Simd>(
        &mut self,
        steps: &InteriorSteps<S>,
        y: &[Vector<S>; 4],
        sum: &mut Terms<S>,
    ) {
        let InteriorSteps { simd, register, .. } = *steps;
        let zero = Vector::splat(simd, 0.0);
        for (n, (jerk, [x, v, w])) in self.jerks.iter_mut().zip(jerk_places(y)).enumerate() {
            // The duration is taken at both ends.
            let in_duration = if n < 2 { self.weight.load(simd, register) } else { zero };
            let share = x.sqrt();
            let inverse = x.inverse();
            let bound = share * inverse;
            let bound_slope = bound * inverse * -0.5;
            let [mut xx, mut xv, mut xw, mut vv, mut vw, mut ww] = [zero; 6];
            let [mut gx, mut gv, mut gw] = [zero; 3];
            // What goes with the bound's slope: sums and differences of the two slacks.
            let [mut ex, mut ev, mut ew, mut weights, mut slopes, mut duals] = [zero; 6];
            for j in 0..J {
                let jx = jerk.x[j].load(simd, register);
                let jv = jerk.v[j].load(simd, register);
                let jw = jerk.w[j].load(simd, register);
                let value = jx.mul_add(x, jv.mul_add(v, jw * w));
                let [a, b] = &mut jerk.slacks[j];
                let (a, b) = (a.advance(steps), b.advance(steps));
                let miss = [value - bound + a.s, b.s - value - bound];
                sum.gap = a.s.mul_add(a.z, b.s.mul_add(b.z, sum.gap));
                let largest = miss[0].abs().max(miss[1].abs());
                sum.residual = sum.residual.max(largest * share);
                let slope = [a.slope(steps, miss[0]), b.slope(steps, miss[1])];
                let (both, apart) = (a.weight + b.weight, a.weight - b.weight);
                let (bx, bv, bw) = (both * jx, both * jv, both * jw);
                xx = bx.mul_add(jx, xx);
                xv = bx.mul_add(jv, xv);
                xw = bx.mul_add(jw, xw);
                vv = bv.mul_add(jv, vv);
                vw = bv.mul_add(jw, vw);
                ww = bw.mul_add(jw, ww);
                let apart_slope = slope[0] - slope[1];
                gx = apart_slope.mul_add(jx, gx);
                gv = apart_slope.mul_add(jv, gv);
                gw = apart_slope.mul_add(jw, gw);
                ex = apart.mul_add(jx, ex);
                ev = apart.mul_add(jv, ev);
                ew = apart.mul_add(jw, ew);
                weights = weights + both;
                slopes = slopes + slope[0] + slope[1];
                duals = duals + a.z + b.z;
            }
            // The duration curves upwards in x; the bound does too, which makes the Lagrangian curve
            // downwards where duals are large. A step needs a function that curves upwards: the
            // size of the curvature is right, and never nothing.
            let kept = (in_duration - duals).abs().max(in_duration * SETTINGS.kept_curvature);
            let curvature = bound * inverse * inverse * kept * 0.75;
            xx = bound_slope.mul_add(bound_slope * weights - ex * 2.0, xx + curvature);
            xv = xv - bound_slope * ev;
            xw = xw - bound_slope * ew;
            gx = bound_slope.mul_add(in_duration - slopes, gx);
            let [rx, rv, rw] = [
                [UNIT[0], UNIT[1], UNIT[2]],
                [END_X, END_V, UNIT[3]],
                [MIDDLE_X, MIDDLE_V, MIDDLE_W],
            ][n];
            sum.add(
                &[
                    (rx, rx, xx),
                    (rx, rv, xv),
                    (rx, rw, xw),
                    (rv, rv, vv),
                    (rv, rw, vw),
                    (rw, rw, ww),
                ],
                &[(rx, gx), (rv, gv), (rw, gw)],
            );
        }
    }

    /// Finds the steps of slacks that go with the steps `moves` of the states.
    #[inline(always)]
    pub(crate) fn direct<S: Simd>(
        &mut self,
        simd: S,
        states: &[CellState],
        moves: &[CellState],
        mu: f64,
        ratios: &mut StepRatios,
    ) {
        let (lanes, lane_moves) = (self.gather(states), self.gather(moves));
        let (zero, one) = (Vector::splat(simd, 0.0), Vector::splat(simd, 1.0));
        let mu = Vector::splat(simd, mu);
        for r in 0..registers::<S>() {
            let y = lanes.map(|lanes| lanes.load(simd, r));
            let dy = lane_moves.map(|lanes| lanes.load(simd, r));
            let [mut slack, mut dual, mut ratio] = [zero; 3];
            for (speed, control) in self.speeds.iter_mut().zip(&CONTROL) {
                let value = speed.x.load(simd, r) * (times(control, &y) + times(control, &dy));
                let [a, b] = &mut speed.slacks;
                let a = a.direct(r, one - value, mu);
                let b = b.direct(r, value, mu);
                slack = slack.max(a[0].max(b[0]));
                dual = dual.max(a[1].max(b[1]));
            }
            let places =
                std::iter::zip(acceleration_places::<J, S>(&y), acceleration_places::<J, S>(&dy));
            for (acceleration, ([x, v, _], [dx, dv, _])) in
                self.accelerations.iter_mut().zip(places)
            {
                let (x, v) = (x + dx, v + dv);
                for j in 0..J {
                    let value = acceleration.x[j]
                        .load(simd, r)
                        .mul_add(x, acceleration.v[j].load(simd, r) * v);
                    let [a, b] = &mut acceleration.slacks[j];
                    let a = a.direct(r, one - value, mu);
                    let b = b.direct(r, one + value, mu);
                    slack = slack.max(a[0].max(b[0]));
                    dual = dual.max(a[1].max(b[1]));
                }
            }
            let places = std::iter::zip(jerk_places(&y), jerk_places(&dy));
            for (jerk, ([x, v, w], [dx, dv, dw])) in self.jerks.iter_mut().zip(places) {
                let inverse = x.inverse();
                let share = dx * inverse;
                let bound = x.sqrt() * inverse * (one - share * 0.5);
                ratio = ratio.max(-share);
                let (x, v, w) = (x + dx, v + dv, w + dw);
                for j in 0..J {
                    let value = jerk.x[j].load(simd, r).mul_add(
                        x,
                        jerk.v[j].load(simd, r).mul_add(v, jerk.w[j].load(simd, r) * w),
                    );
                    let [a, b] = &mut jerk.slacks[j];
                    let a = a.direct(r, bound - value, mu);
                    let b = b.direct(r, bound + value, mu);
                    slack = slack.max(a[0].max(b[0]));
                    dual = dual.max(a[1].max(b[1]));
                }
            }
            ratios.slack = ratios.slack.max(slack.largest());
            ratios.dual = ratios.dual.max(dual.largest());
            ratios.x = ratios.x.max(ratio.largest());
        }
    }
}

impl<const J: usize> AccelerationRows<J> {
    fn limit(&mut self, lane: usize, [dq, ddq, _]: &Rates, length: f64, inverse: &[f64; 7]) {
        // x' = V / length.
        let half = 0.5 / length;
        if J == 1 {
            self.v[0].0[lane] = proportion(dq, inverse) * half;
            return;
        }
        for j in 0..J {
            self.x[j].0[lane] = ddq[j] * inverse[j];
            self.v[j].0[lane] = dq[j] * inverse[j] * half;
        }
    }
}

impl<const J: usize> JerkRows<J> {
    fn new() -> Self {
        let rows = [Lanes::default(); J];
        Self { x: rows, v: rows, w: rows, slacks: [[SlackPair::default(); 2]; J] }
    }

    fn limit(&mut self, lane: usize, [dq, ddq, dddq]: &Rates, length: f64, inverse: &[f64; 7]) {
        let (one, two) = (1.5 / length, 0.5 / (length * length));
        if J == 1 {
            self.w[0].0[lane] = proportion(dq, inverse) * two;
            return;
        }
        for j in 0..J {
            self.x[j].0[lane] = dddq[j] * inverse[j];
            self.v[j].0[lane] = ddq[j] * inverse[j] * one;
            self.w[j].0[lane] = dq[j] * inverse[j] * two;
        }
    }
}

/// On a line all joints move in proportion: the one that comes first at its limit counts.
fn proportion(dq: &[f64; 7], inverse: &[f64; 7]) -> f64 {
    std::iter::zip(dq, inverse).map(|(d, i)| d.abs() * i).fold(0.0, f64::max)
}

#[inline(always)]
fn times<S: Simd>(row: &CellState, y: &[Vector<S>; 4]) -> Vector<S> {
    y[0] * row[0] + y[1] * row[1] + y[2] * row[2] + y[3] * row[3]
}

/// V where acceleration is kept in the middle of a cell. On a line, where it alone counts, at its
/// control point.
#[inline(always)]
fn acceleration_v<const J: usize>() -> &'static CellState {
    if J == 1 { &CONTROL_V } else { &MIDDLE_V }
}

#[inline(always)]
fn acceleration_places<const J: usize, S: Simd>(y: &[Vector<S>; 4]) -> [Place<S>; 2] {
    [
        [y[0], y[1], y[2]],
        [times(&MIDDLE_X, y), times(acceleration_v::<J>(), y), times(&MIDDLE_W, y)],
    ]
}

#[inline(always)]
fn jerk_places<S: Simd>(y: &[Vector<S>; 4]) -> [Place<S>; 3] {
    [
        [y[0], y[1], y[2]],
        [times(&END_X, y), times(&END_V, y), y[3]],
        [times(&MIDDLE_X, y), times(&MIDDLE_V, y), times(&MIDDLE_W, y)],
    ]
}
