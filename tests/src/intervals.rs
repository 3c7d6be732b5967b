//! Motion between two nodes as polynomials, whose maxima [`extremes`](crate::extremes) computes.

use iiwa_kin::Joints;
use iiwa_path::Segment;
use iiwa_traj::Node;

use crate::bernstein::{Bernstein, Octet};

/// Motion between two nodes: p over time, relative to the time interval.
pub(crate) struct Interval {
    from_p: f64,
    duration_s: f64,
    /// Upper bound on the position error at the next node caused by rounding of p and the stamps.
    miss: f64,
    /// Coefficients of p - `from_p`, in powers of the relative time.
    way: [f64; 6],
}

/// Relative error with which a polynomial may miss the second node.
const MISSED: f64 = 1e-12;

impl Interval {
    /// Returns the polynomial with p, dp/dt and d2p/dt2 of both nodes. If constant d3p/dt3 misses
    /// the second node by at most [`MISSED`], the polynomial has constant d3p/dt3.
    pub(crate) fn between(from: &Node, to: &Node) -> Self {
        let t = from.dt_s;
        // In relative time: speeds, and halves of accelerations.
        let [v0, v1] = [t * from.rate, t * to.rate];
        let [a0, a1] = [0.5 * t * t * from.u[0], 0.5 * t * t * from.u[1]];
        // Errors of constant d3p/dt3 at the end, in position and first derivative; the last two
        // powers correct them.
        let miss_a = a1 - a0;
        let mut miss = from.dp - v0 - a0 - miss_a / 3.0;
        let mut miss_v = v1 - v0 - 2.0 * a0 - miss_a;
        let mut missed = f64::EPSILON * (from.dp + from.rate.max(to.rate) * t);
        if miss.abs().max(miss_v.abs()) <= MISSED * from.dp {
            (miss, miss_v, missed) = (0.0, 0.0, 0.0);
        }
        let way = [
            0.0,
            v0,
            a0,
            10.0 * miss - 4.0 * miss_v + miss_a / 3.0,
            -15.0 * miss + 7.0 * miss_v,
            6.0 * miss - 3.0 * miss_v,
        ];
        Self { from_p: from.p, duration_s: t, miss: missed, way }
    }

    /// Derivative `order` of p with respect to time, in powers of the relative time.
    fn derivative(&self, order: u8) -> [f64; 5] {
        let n = usize::from(order);
        let scale = self.duration_s.powi(-i32::from(order));
        std::array::from_fn(|i| {
            let Some(c) = self.way.get(i + n) else { return 0.0 };
            (1..=n).map(|k| (i + k) as f64).product::<f64>() * c * scale
        })
    }

    /// Returns p at the relative time `t`.
    pub(crate) fn p(&self, t: f64) -> f64 {
        self.from_p + horner(&self.way, t)
    }

    /// Velocity, acceleration and jerk of each joint, relative to the limits.
    pub(crate) fn functions(
        &self,
        t: f64,
        segment: &dyn Segment,
        [v, a, j]: &[Joints; 3],
    ) -> [Octet; 3] {
        let d = segment.at_share(self.p(t));
        let [rate, u, du] = [1, 2, 3].map(|order| horner(&self.derivative(order), t));
        let mut rows = [[0.0; 8]; 3];
        for i in 0..7 {
            rows[0][i] = v[i] * d.dq[i] * rate;
            rows[1][i] = a[i] * (d.dq[i] * u + d.ddq[i] * rate * rate);
            rows[2][i] =
                j[i] * (d.dq[i] * du + rate * (3.0 * d.ddq[i] * u + d.dddq[i] * rate * rate));
        }
        rows
    }

    /// Velocity, acceleration and jerk of p, in powers of the relative time.
    pub(crate) fn line(&self) -> [[f64; 5]; 3] {
        [1, 2, 3].map(|order| self.derivative(order))
    }

    /// Upper bound on the error of d3p/dt3, in 1/s^3, due to rounding of p and the stamps: the
    /// position error is corrected by a polynomial whose third derivative is 60 times that error at
    /// both ends.
    pub(crate) fn rounding(&self) -> f64 {
        60.0 * self.miss * self.duration_s.powi(-3)
    }

    /// dp/dt.
    pub(crate) fn rate(&self) -> Bernstein {
        Bernstein::from_powers(&self.derivative(1))
    }
}

fn horner(powers: &[f64], t: f64) -> f64 {
    powers.iter().rev().fold(0.0, |sum, c| sum * t + c)
}
