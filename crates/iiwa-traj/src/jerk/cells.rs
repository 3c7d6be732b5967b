//! The limits in four cells at once, and what they contribute to a step of the solver.
//!
//! In a cell x is a cubic of the share f of its length, with V = dx/df and W = d2x/df2, of which W
//! changes linearly from W0 to W1:
//! `x(f) = x + V f + W0 (f^2/2 - f^3/6) + W1 f^3/6`.
//! The four numbers (x, V, W0, W1) at its start are its state. Limits are kept
//! - in speed, at three of the four control points of that cubic (the fourth is the next cell's first):
//!   it stays in their hull, so that it cannot swing out in between;
//! - in acceleration, `q' x'/2 + q'' x`, at the start and in the middle, or on lines at the middle
//!   control point of x';
//! - in jerk, `sqrt(x) (q' x''/2 + 3/2 q'' x' + q''' x)`, at both ends, and on
//!   curves in the middle. Here x moves to the other side, which leaves something linear below
//!   `x^(-1/2)`.
//!
//! Every limit is a row, divided by the limit so that the bound is 1, with a slack s and a dual z on
//! either side. Lines have one row for all joints, which move in proportion; curves have seven.

use super::{
    leg::{Leg, Rates},
    mesh::Cell,
};
use crate::lanes::{LANES, Lanes};

/// (x, V, W0, W1) of a cell, or factors of them.
pub(crate) type State = [f64; 4];

/// x at the end of a cell.
pub(crate) const END_X: State = [1.0, 1.0, 1.0 / 3.0, 1.0 / 6.0];
/// V there.
pub(crate) const END_V: State = [0.0, 1.0, 0.5, 0.5];
/// W there.
const END_W: State = [0.0, 0.0, 0.0, 1.0];
/// x in the middle.
const MIDDLE_X: State = [1.0, 0.5, 5.0 / 48.0, 1.0 / 48.0];
/// V in the middle.
const MIDDLE_V: State = [0.0, 1.0, 3.0 / 8.0, 1.0 / 8.0];
/// W there.
const MIDDLE_W: State = [0.0, 0.0, 0.5, 0.5];
/// V at its middle control point: the parabola V(f) stays in the hull of both ends and it.
const CONTROL_V: State = [0.0, 1.0, 0.5, 0.0];
/// The first three control points of x.
const CONTROL: [State; 3] =
    [[1.0, 0.0, 0.0, 0.0], [1.0, 1.0 / 3.0, 0.0, 0.0], [1.0, 2.0 / 3.0, 1.0 / 6.0, 0.0]];

/// Where jerk is kept in a cell, and the share of its limit that is allowed there: what the ends keep
/// exactly may swing out a little in the middle.
const JERK_PLACES: [(f64, f64); 3] = [(0.0, 1.0), (1.0, 1.0), (0.5, 1.015)];

/// A quadratic function of a cell's state.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Quadratic {
    /// Second derivatives, of which the upper triangle by rows.
    pub(crate) h: [f64; 10],
    /// First derivatives.
    pub(crate) g: State,
}

impl Quadratic {
    /// Adds `curvature / 2 (row y)^2 + slope (row y)`.
    pub(crate) fn add(&mut self, row: &State, curvature: f64, slope: f64) {
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

/// What is summed up over all limits.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Sums {
    /// Slacks times duals.
    pub(crate) gap: f64,
    /// Largest share of a bound by which a limit is not met.
    pub(crate) residual: f64,
}

/// The largest relative falls that a full step would bring.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Falls {
    pub(crate) slack: f64,
    pub(crate) dual: f64,
    pub(crate) x: f64,
}

/// A step: the product that slacks and duals were to have, and the shares of it that they go.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Step {
    pub(crate) mu: f64,
    pub(crate) primal: f64,
    pub(crate) dual: f64,
}

/// Slack and dual of one side of a limit.
#[derive(Clone, Copy, Debug, Default)]
struct Side {
    s: Lanes,
    z: Lanes,
    /// One over the slack: dividing is slow.
    inverse: Lanes,
    /// Step of the slack, which the dual's follows from.
    ds: Lanes,
}

impl Side {
    /// The slack is the room that is left, but not less than `least`.
    #[inline(always)]
    fn start(&mut self, room: Lanes, least: Lanes, mu: f64) {
        self.s = room.max(least);
        self.inverse = 1.0 / self.s;
        self.z = mu * self.inverse;
        self.ds = Lanes::ZERO;
    }

    #[inline(always)]
    fn advance(&mut self, step: Step) {
        let dz = (step.mu - self.z * self.ds) * self.inverse - self.z;
        self.s += step.primal * self.ds;
        self.z += step.dual * dz;
        self.inverse = 1.0 / self.s;
    }

    /// Sets the slack's step. The relative falls of slack and dual that go with it.
    #[inline(always)]
    fn direct(&mut self, ds: Lanes, mu: f64) -> [Lanes; 2] {
        self.ds = ds;
        let fall = -ds * self.inverse;
        // dz = (mu - z ds) / s - z.
        [fall, 1.0 - fall - mu * self.inverse / self.z]
    }
}

/// The rows of acceleration at one place of a cell: factors of x and V for each joint.
#[derive(Clone, Copy, Debug)]
struct Push<const J: usize> {
    x: [Lanes; J],
    v: [Lanes; J],
    sides: [[Side; 2]; J],
}

/// The rows of jerk at one place of a cell: factors of x, V and W for each joint.
#[derive(Clone, Copy, Debug)]
struct Jerk<const J: usize> {
    x: [Lanes; J],
    v: [Lanes; J],
    w: [Lanes; J],
    sides: [[Side; 2]; J],
}

/// The row of speed at a control point: one over the largest x. The other side keeps x positive.
#[derive(Clone, Copy, Debug, Default)]
struct Speed {
    x: Lanes,
    sides: [Side; 2],
}

/// Four cells with `J` rows of each kind, and jerk kept at `N` places.
#[derive(Clone, Debug)]
pub(crate) struct Block<const J: usize, const N: usize> {
    /// Which cells. In the last block some may be there twice, which changes nothing.
    cells: [usize; LANES],
    /// Half the length: the weight of `x^(-1/2)` at both ends in the duration.
    weight: Lanes,
    speeds: [Speed; 3],
    pushes: [Push<J>; 2],
    jerks: [Jerk<J>; N],
}

/// x, V and W somewhere in four cells.
type Place = [Lanes; 3];

/// Blocks of the cells in `list`, of which the first has number `offset` in `cells`.
pub(crate) fn blocks<const J: usize, const N: usize>(
    legs: &[Leg<'_>],
    cells: &[Cell],
    offset: usize,
    list: &[usize],
) -> Vec<Block<J, N>> {
    list.chunks(LANES)
        .map(|chunk| {
            let mut block = Block::new(std::array::from_fn(|l| chunk[l.min(chunk.len() - 1)]));
            for lane in 0..LANES {
                let at = block.cells[lane] + offset;
                let before = (cells[at - 1].leg != cells[at].leg).then(|| &legs[cells[at - 1].leg]);
                block.limit(lane, &cells[at], &legs[cells[at].leg], before);
            }
            block
        })
        .collect()
}

impl<const J: usize, const N: usize> Block<J, N> {
    fn new(cells: [usize; LANES]) -> Self {
        let rows = [Lanes::ZERO; J];
        let sides = [[Side::default(); 2]; J];
        Self {
            cells,
            weight: Lanes::ZERO,
            speeds: [Speed::default(); 3],
            pushes: [Push { x: rows, v: rows, sides }; 2],
            jerks: [Jerk::new(); N],
        }
    }

    /// How many limits there are.
    pub(crate) fn count(blocks: &[Self]) -> usize {
        LANES * blocks.len() * (6 + 4 * J + 2 * N * J)
    }

    /// Sets the rows of one cell, of which `before` is the leg that ends where it starts.
    fn limit(&mut self, lane: usize, cell: &Cell, leg: &Leg<'_>, before: Option<&Leg<'_>>) {
        let Cell { from, length, .. } = *cell;
        let at = |share: f64| leg.rates(leg.s(from + share * length).clamp(0.0, 1.0));
        let least = |own: &[f64; 7], other: Option<&[f64; 7]>| {
            other.map_or(*own, |other| std::array::from_fn(|j| own[j].min(other[j])))
        };
        let speed =
            least(&leg.limits.velocity_rad_s, before.map(|before| &before.limits.velocity_rad_s));
        let acceleration = least(
            &leg.limits.acceleration_rad_s2,
            before.map(|before| &before.limits.acceleration_rad_s2),
        );
        let inverse = |limits: &[f64; 7]| limits.map(|limit| 1.0 / limit);

        self.weight.0[lane] = 0.5 * length;
        let start = at(0.0);
        let cap = |[dq, ..]: &Rates, speed: &[f64; 7]| {
            (0..7).map(|j| (dq[j] / speed[j]).powi(2)).fold(0.0, f64::max)
        };
        self.speeds[0].x.0[lane] = cap(&start, &speed);
        self.speeds[1].x.0[lane] = cap(&at(1.0 / 3.0), &leg.limits.velocity_rad_s);
        self.speeds[2].x.0[lane] = cap(&at(2.0 / 3.0), &leg.limits.velocity_rad_s);

        self.pushes[0].limit(lane, &start, length, &inverse(&acceleration));
        self.pushes[1].limit(lane, &at(0.5), length, &inverse(&leg.limits.acceleration_rad_s2));
        let jerk = inverse(&leg.limits.jerk_rad_s3);
        for (rows, (place, bound)) in self.jerks.iter_mut().zip(JERK_PLACES) {
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
            for push in &mut self.pushes {
                for row in push.x.iter_mut().chain(&mut push.v) {
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
    fn gather(&self, states: &[State]) -> [Lanes; 4] {
        std::array::from_fn(|a| Lanes::from_fn(|l| states[self.cells[l]][a]))
    }

    /// Sets slacks to what the limits leave, but at least the share `least` of the bound, and duals
    /// so that their product is `mu`.
    #[inline(always)]
    pub(crate) fn start(&mut self, states: &[State], mu: f64, least: f64) {
        let y = self.gather(states);
        let one = Lanes::splat(1.0);
        for (speed, control) in self.speeds.iter_mut().zip(&CONTROL) {
            let value = speed.x * times(control, &y);
            speed.sides[0].start(1.0 - value, least * one, mu);
            speed.sides[1].start(value, least * value.abs(), mu);
        }
        for (push, [x, v, _]) in self.pushes.iter_mut().zip(push_places::<J>(&y)) {
            for j in 0..J {
                let value = push.x[j] * x + push.v[j] * v;
                push.sides[j][0].start(1.0 - value, least * one, mu);
                push.sides[j][1].start(1.0 + value, least * one, mu);
            }
        }
        for (jerk, place) in self.jerks.iter_mut().zip(jerk_places(&y)) {
            jerk.start(place, mu, least);
        }
    }

    /// Goes the last step of slacks and duals, then writes what the cells' duration and limits contribute
    /// to the quadratic function that the next step minimises.
    #[inline(always)]
    pub(crate) fn assemble(
        &mut self,
        states: &[State],
        last: Step,
        mu: f64,
        quadratics: &mut [Quadratic],
        sums: &mut Sums,
    ) {
        let y = self.gather(states);
        let (mut gap, mut residual) = (Lanes::ZERO, Lanes::ZERO);
        let mut h = [Lanes::ZERO; 10];
        let mut g = [Lanes::ZERO; 4];

        for (speed, control) in self.speeds.iter_mut().zip(&CONTROL) {
            let value = speed.x * times(control, &y);
            let [a, b] = &mut speed.sides;
            a.advance(last);
            b.advance(last);
            let inverse = [a.inverse, b.inverse];
            let weight = [a.z * inverse[0], b.z * inverse[1]];
            let miss = [value - 1.0 + a.s, b.s - value];
            gap += a.s * a.z + b.s * b.z;
            residual = residual.max(miss[0].abs()).max(miss[1].abs());
            let curvature = (weight[0] + weight[1]) * speed.x * speed.x;
            let slope = ((mu * inverse[0] + weight[0] * miss[0])
                - (mu * inverse[1] + weight[1] * miss[1]))
                * speed.x;
            let mut i = 0;
            for a in 0..4 {
                for b in a..4 {
                    h[i] += curvature * (control[a] * control[b]);
                    i += 1;
                }
                g[a] += slope * control[a];
            }
        }

        for (n, [x, v, _]) in push_places::<J>(&y).into_iter().enumerate() {
            let push = &mut self.pushes[n];
            let [mut xx, mut xv, mut vv, mut gx, mut gv] = [Lanes::ZERO; 5];
            for j in 0..J {
                let (px, pv) = (push.x[j], push.v[j]);
                let value = px * x + pv * v;
                let [a, b] = &mut push.sides[j];
                a.advance(last);
                b.advance(last);
                let inverse = [a.inverse, b.inverse];
                let weight = [a.z * inverse[0], b.z * inverse[1]];
                let miss = [value - 1.0 + a.s, -value - 1.0 + b.s];
                let slope = (mu * inverse[0] + weight[0] * miss[0])
                    - (mu * inverse[1] + weight[1] * miss[1]);
                gap += a.s * a.z + b.s * b.z;
                residual = residual.max(miss[0].abs()).max(miss[1].abs());
                let both = weight[0] + weight[1];
                let (bx, bv) = (both * px, both * pv);
                xx += bx * px;
                xv += bx * pv;
                vv += bv * pv;
                gx += slope * px;
                gv += slope * pv;
            }
            if n == 0 {
                h[0] += xx;
                h[1] += xv;
                h[4] += vv;
                g[0] += gx;
                g[1] += gv;
            } else {
                let (rx, rv) = (&MIDDLE_X, push_v::<J>());
                let mut i = 0;
                for a in 0..4 {
                    for b in a..4 {
                        h[i] += xx * (rx[a] * rx[b])
                            + xv * (rx[a] * rv[b] + rv[a] * rx[b])
                            + vv * (rv[a] * rv[b]);
                        i += 1;
                    }
                    g[a] += gx * rx[a] + gv * rv[a];
                }
            }
        }

        for (n, (jerk, [x, v, w])) in self.jerks.iter_mut().zip(jerk_places(&y)).enumerate() {
            // The duration is taken at both ends.
            let in_duration = if n < 2 { self.weight } else { Lanes::ZERO };
            let bound = 1.0 / x.sqrt();
            let bound_slope = -0.5 * bound / x;
            let share = x.sqrt();
            let [mut xx, mut xv, mut xw, mut vv, mut vw, mut ww] = [Lanes::ZERO; 6];
            let [mut gx, mut gv, mut gw] = [Lanes::ZERO; 3];
            // What goes with the bound's slope: sums and differences of the two sides.
            let [mut ex, mut ev, mut ew, mut both_sum, mut slope_sum, mut duals] = [Lanes::ZERO; 6];
            for j in 0..J {
                let (jx, jv, jw) = (jerk.x[j], jerk.v[j], jerk.w[j]);
                let value = jx * x + jv * v + jw * w;
                let [a, b] = &mut jerk.sides[j];
                a.advance(last);
                b.advance(last);
                let inverse = [a.inverse, b.inverse];
                let weight = [a.z * inverse[0], b.z * inverse[1]];
                let miss = [value - bound + a.s, -value - bound + b.s];
                let slope =
                    [mu * inverse[0] + weight[0] * miss[0], mu * inverse[1] + weight[1] * miss[1]];
                gap += a.s * a.z + b.s * b.z;
                residual = residual.max(miss[0].abs() * share).max(miss[1].abs() * share);
                let (both, apart) = (weight[0] + weight[1], weight[0] - weight[1]);
                let (bx, bv, bw) = (both * jx, both * jv, both * jw);
                xx += bx * jx;
                xv += bx * jv;
                xw += bx * jw;
                vv += bv * jv;
                vw += bv * jw;
                ww += bw * jw;
                let slopes = slope[0] - slope[1];
                gx += slopes * jx;
                gv += slopes * jv;
                gw += slopes * jw;
                ex += apart * jx;
                ev += apart * jv;
                ew += apart * jw;
                both_sum += both;
                slope_sum += slope[0] + slope[1];
                duals += a.z + b.z;
            }
            // The duration curves upwards in x; the bound does too, which makes the Lagrangian curve
            // downwards where duals are large: there a little of the former is kept.
            let kept = (in_duration - duals).abs().max(KEPT_CURVATURE * in_duration);
            let curvature = 0.75 * bound / (x * x) * kept;
            xx = xx - 2.0 * bound_slope * ex + bound_slope * bound_slope * both_sum + curvature;
            xv = xv - bound_slope * ev;
            xw = xw - bound_slope * ew;
            gx = gx - bound_slope * slope_sum + in_duration * bound_slope;
            if n == 0 {
                h[0] += xx;
                h[1] += xv;
                h[2] += xw;
                h[4] += vv;
                h[5] += vw;
                h[7] += ww;
                g[0] += gx;
                g[1] += gv;
                g[2] += gw;
            } else {
                let (rx, rv, rw) = if n == 1 {
                    (&END_X, &END_V, &END_W)
                } else {
                    (&MIDDLE_X, &MIDDLE_V, &MIDDLE_W)
                };
                let mut i = 0;
                for a in 0..4 {
                    for b in a..4 {
                        h[i] += xx * (rx[a] * rx[b])
                            + xv * (rx[a] * rv[b] + rv[a] * rx[b])
                            + vv * (rv[a] * rv[b])
                            + xw * (rx[a] * rw[b] + rw[a] * rx[b])
                            + vw * (rv[a] * rw[b] + rw[a] * rv[b])
                            + ww * (rw[a] * rw[b]);
                        i += 1;
                    }
                    g[a] += gx * rx[a] + gv * rv[a] + gw * rw[a];
                }
            }
        }

        for (lane, cell) in self.cells.into_iter().enumerate() {
            quadratics[cell] =
                Quadratic { h: h.map(|value| value.0[lane]), g: g.map(|value| value.0[lane]) };
        }
        sums.gap += gap.sum();
        sums.residual = sums.residual.max(residual.largest());
    }

    /// Finds the steps of slacks and duals that go with the steps `moves` of the states.
    #[inline(always)]
    pub(crate) fn direct(&mut self, states: &[State], moves: &[State], mu: f64, falls: &mut Falls) {
        let (y, dy) = (self.gather(states), self.gather(moves));
        let [mut slack, mut dual, mut fall] = [Lanes::ZERO; 3];
        let mut set = |side: &mut Side, ds: Lanes| {
            let [of_slack, of_dual] = side.direct(ds, mu);
            slack = slack.max(of_slack);
            dual = dual.max(of_dual);
        };
        for (speed, control) in self.speeds.iter_mut().zip(&CONTROL) {
            let value = speed.x * (times(control, &y) + times(control, &dy));
            let [a, b] = &mut speed.sides;
            set(a, 1.0 - value - a.s);
            set(b, value - b.s);
        }
        let places = std::iter::zip(push_places::<J>(&y), push_places::<J>(&dy));
        for (push, ([x, v, _], [dx, dv, _])) in self.pushes.iter_mut().zip(places) {
            for j in 0..J {
                let value = push.x[j] * (x + dx) + push.v[j] * (v + dv);
                let [a, b] = &mut push.sides[j];
                set(a, 1.0 - value - a.s);
                set(b, 1.0 + value - b.s);
            }
        }
        let places = std::iter::zip(jerk_places(&y), jerk_places(&dy));
        for (jerk, ([x, v, w], [dx, dv, dw])) in self.jerks.iter_mut().zip(places) {
            let bound = 1.0 / x.sqrt();
            let bound = bound - 0.5 * bound / x * dx;
            for j in 0..J {
                let value = jerk.x[j] * (x + dx) + jerk.v[j] * (v + dv) + jerk.w[j] * (w + dw);
                let [a, b] = &mut jerk.sides[j];
                set(a, bound - value - a.s);
                set(b, bound + value - b.s);
            }
            fall = fall.max(-dx / x);
        }
        falls.slack = falls.slack.max(slack.largest());
        falls.dual = falls.dual.max(dual.largest());
        falls.x = falls.x.max(fall.largest());
    }
}

/// Least share of the duration's curvature that a step keeps.
const KEPT_CURVATURE: f64 = 0.02;

impl<const J: usize> Push<J> {
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

impl<const J: usize> Jerk<J> {
    fn new() -> Self {
        let rows = [Lanes::ZERO; J];
        Self { x: rows, v: rows, w: rows, sides: [[Side::default(); 2]; J] }
    }

    #[inline(always)]
    fn start(&mut self, [x, v, w]: Place, mu: f64, least: f64) {
        let bound = 1.0 / x.sqrt();
        for j in 0..J {
            let value = self.x[j] * x + self.v[j] * v + self.w[j] * w;
            self.sides[j][0].start(bound - value, least * bound, mu);
            self.sides[j][1].start(bound + value, least * bound, mu);
        }
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
fn times(row: &State, y: &[Lanes; 4]) -> Lanes {
    row[0] * y[0] + row[1] * y[1] + row[2] * y[2] + row[3] * y[3]
}

/// V where acceleration is kept in the middle of a cell. On a line, where it alone counts, at its
/// control point.
#[inline(always)]
fn push_v<const J: usize>() -> &'static State {
    if J == 1 { &CONTROL_V } else { &MIDDLE_V }
}

#[inline(always)]
fn push_places<const J: usize>(y: &[Lanes; 4]) -> [Place; 2] {
    let middle = [times(&MIDDLE_X, y), times(push_v::<J>(), y), Lanes::ZERO];
    [[y[0], y[1], Lanes::ZERO], middle]
}

#[inline(always)]
fn jerk_places(y: &[Lanes; 4]) -> [Place; 3] {
    [
        [y[0], y[1], y[2]],
        [times(&END_X, y), times(&END_V, y), y[3]],
        [times(&MIDDLE_X, y), times(&MIDDLE_V, y), times(&MIDDLE_W, y)],
    ]
}
