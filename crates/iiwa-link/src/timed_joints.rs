//! A trajectory as a client sends it: joint positions with stamps.

use iiwa_kin::{Joints, Limits};
use serde::{Deserialize, Serialize};

use crate::message::{Code, Refusal};

/// Joint positions with stamps.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TimedJoints {
    /// Stamps, in s; they increase strictly. The first one is the start, whatever it is.
    pub t_s: Vec<f64>,
    /// Positions at these times, in rad.
    pub joints_rad: Vec<Joints>,
}

/// How far from the robot a trajectory may start, in rad: half a degree.
pub const START_TOLERANCE_RAD: f64 = 0.5 * std::f64::consts::PI / 180.0;

/// How far beyond the robot's limits of velocity, acceleration and jerk a trajectory may go, as a share.
///
/// Planners keep limits exactly at some places and nearly in between; what is beyond these margins is
/// no rounding any more.
pub const MARGINS: [f64; 3] = [0.02, 0.05, 0.10];

/// Positions may be rounded to six decimals, in rad: a difference that this explains is no fault.
const ROUNDING_RAD: f64 = 0.5e-6;

/// Longest time over which differences are taken, in s. Over longer ones they tell less, and over
/// shorter ones rounding counts for more.
const LONGEST_DIFFERENCE_S: f64 = 0.1;

impl TimedJoints {
    /// From its start to its end, in s.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        match self.t_s.as_slice() {
            [first, .., last] => last - first,
            _ => 0.0,
        }
    }

    /// Finds the first reason not to run this trajectory on a robot that stands at `start_rad`.
    ///
    /// It has to be well-formed, with finite numbers and strictly increasing stamps; to start where the
    /// robot is, within [`START_TOLERANCE_RAD`]; to stay within the position limits; and to keep the
    /// limits of velocity, acceleration and jerk but for [`MARGINS`], from rest at its start to rest at
    /// its end. They are checked by divided differences over one to so many intervals as make 0.1 s. A
    /// divided difference is a mean of the derivative: if a motion keeps its limits, so do all
    /// differences of its samples, at whatever stamps they were taken.
    ///
    /// # Errors
    ///
    /// [`Code::BadRequest`], [`Code::StartMismatch`] or [`Code::Limit`], with the place.
    pub fn check(&self, limits: &Limits, start_rad: &Joints) -> Result<(), Refusal> {
        self.check_form()?;
        let start = &self.joints_rad[0];
        let off = |j: &usize| (start[*j] - start_rad[*j]).abs();
        let worst = (0..7).max_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(0);
        if off(&worst) > START_TOLERANCE_RAD {
            return Err(Refusal::new(
                Code::StartMismatch,
                format!(
                    "the trajectory starts with joint {} at {:.3} deg, the robot is at {:.3} deg; \
                     they may be {} deg apart",
                    worst + 1,
                    start[worst].to_degrees(),
                    start_rad[worst].to_degrees(),
                    START_TOLERANCE_RAD.to_degrees()
                ),
            ));
        }
        for (i, q) in self.joints_rad.iter().enumerate() {
            if let Some(j) = limits.outside(q) {
                return Err(Refusal::new(
                    Code::Limit,
                    format!(
                        "point {}: joint {} is at {:.3} deg, its limit is +-{:.3} deg",
                        i + 1,
                        j + 1,
                        q[j].to_degrees(),
                        limits.position_rad[j].to_degrees()
                    ),
                ));
            }
        }
        self.check_differences(limits)
    }

    fn check_form(&self) -> Result<(), Refusal> {
        let (stamps, points) = (self.t_s.len(), self.joints_rad.len());
        if stamps != points {
            return Err(Refusal::bad(format!(
                "the trajectory has {stamps} stamps and {points} points; give one stamp a point"
            )));
        }
        if points < 2 {
            return Err(Refusal::bad(format!(
                "the trajectory has {points} points; at least 2 are needed"
            )));
        }
        let finite =
            |i: usize| self.t_s[i].is_finite() && self.joints_rad[i].iter().all(|q| q.is_finite());
        if let Some(i) = (0..points).find(|&i| !finite(i)) {
            return Err(Refusal::bad(format!("point {}: a number is not finite", i + 1)));
        }
        if let Some(i) = (1..points).find(|&i| self.t_s[i] <= self.t_s[i - 1]) {
            return Err(Refusal::bad(format!(
                "point {}: its stamp, {} s, is not after the one before, {} s",
                i + 1,
                self.t_s[i],
                self.t_s[i - 1]
            )));
        }
        Ok(())
    }

    fn check_differences(&self, limits: &Limits) -> Result<(), Refusal> {
        let kinds = [
            ("velocity", "deg/s", &limits.velocity_rad_s),
            ("acceleration", "deg/s^2", &limits.acceleration_rad_s2),
            ("jerk", "deg/s^3", &limits.jerk_rad_s3),
        ];
        let mean_step = self.duration_s() / (self.t_s.len() - 1) as f64;
        for (order, (kind, unit, limit)) in (1..).zip(kinds) {
            let mut stride = 1_usize;
            while stride == 1 || (stride * order) as f64 * mean_step <= LONGEST_DIFFERENCE_S {
                for first in self.first_places(order, stride) {
                    if let Some((j, found)) = self.excess(first, stride, order, limit) {
                        let point = usize::try_from(first.max(0)).unwrap_or(0) + 1;
                        return Err(Refusal::new(
                            Code::Limit,
                            format!(
                                "point {point}, at {:.4} s: the {kind} of joint {} is {:.1} {unit}, its limit \
                                 is {:.1} {unit} and the margin {} %{}",
                                self.time(first.max(0)) - self.t_s[0],
                                j + 1,
                                found.to_degrees(),
                                limit[j].to_degrees(),
                                MARGINS[order - 1] * 100.0,
                                self.at_rest_hint(first, stride * order)
                            ),
                        ));
                    }
                }
                stride *= 2;
            }
        }
        Ok(())
    }

    /// The first points of all differences: before the start and after the end the arm rests.
    fn first_places(&self, order: usize, stride: usize) -> std::ops::Range<isize> {
        let reach = isize::try_from(order * stride).unwrap_or(isize::MAX);
        -reach + 1..isize::try_from(self.t_s.len()).unwrap_or(isize::MAX) - 1
    }

    /// The joint whose divided difference over `order` strides from point `first` exceeds its limit, and
    /// the derivative that it stands for.
    fn excess(
        &self,
        first: isize,
        stride: usize,
        order: usize,
        limit: &Joints,
    ) -> Option<(usize, f64)> {
        let place = |i: usize| first + isize::try_from(i * stride).unwrap_or(isize::MAX);
        let mut t = [0.0; 4];
        let mut weight = [1.0; 4];
        for i in 0..=order {
            t[i] = self.time(place(i));
        }
        let mut factorial = 1.0;
        for i in 0..=order {
            factorial *= i.max(1) as f64;
            for k in (0..=order).filter(|&k| k != i) {
                weight[i] /= t[i] - t[k];
            }
        }
        let rounding: f64 =
            weight[..=order].iter().map(|w| w.abs()).sum::<f64>() * factorial * ROUNDING_RAD;
        (0..7).find_map(|j| {
            let difference: f64 =
                (0..=order).map(|i| weight[i] * self.position(place(i))[j]).sum::<f64>()
                    * factorial;
            let most = limit[j] * (1.0 + MARGINS[order - 1]) + rounding;
            // Not `>`: what is no number is no answer.
            (!(difference.abs() <= most)).then_some((j, difference.abs()))
        })
    }

    fn last(&self) -> isize {
        isize::try_from(self.t_s.len()).unwrap_or(isize::MAX) - 1
    }

    /// The stamp of a point; before the start and after the end it goes on with the steps there.
    fn time(&self, place: isize) -> f64 {
        let n = self.t_s.len();
        let last = self.last();
        if place < 0 {
            self.t_s[0] + place as f64 * (self.t_s[1] - self.t_s[0])
        } else if place > last {
            self.t_s[n - 1] + (place - last) as f64 * (self.t_s[n - 1] - self.t_s[n - 2])
        } else {
            self.t_s[place.unsigned_abs()]
        }
    }

    fn position(&self, place: isize) -> &Joints {
        &self.joints_rad[place.clamp(0, self.last()).unsigned_abs()]
    }

    fn at_rest_hint(&self, first: isize, reach: usize) -> &'static str {
        let end = first + isize::try_from(reach).unwrap_or(isize::MAX);
        if first < 0 {
            "; it has to start at rest"
        } else if end > self.last() {
            "; it has to end at rest"
        } else {
            ""
        }
    }

    /// Where the joints are `t_s` after the start, in rad; before it at the start, after the end there.
    ///
    /// Between points, a cubic with the slopes of parabolas through three points, and of zero at both
    /// ends.
    #[must_use]
    pub fn at(&self, t_s: f64) -> Joints {
        let (Some(first), Some(last)) = (self.t_s.first(), self.joints_rad.last()) else {
            return [0.0; 7];
        };
        let t = t_s + first;
        let next = self.t_s.partition_point(|stamp| *stamp <= t);
        if next == 0 {
            return self.joints_rad[0];
        }
        if next >= self.t_s.len() {
            return *last;
        }
        let i = next - 1;
        let h = self.t_s[next] - self.t_s[i];
        let x = (t - self.t_s[i]) / h;
        let (from, to) = (&self.joints_rad[i], &self.joints_rad[next]);
        let (before, after) = (self.slope(i), self.slope(next));
        std::array::from_fn(|j| {
            let rise = to[j] - from[j];
            let (a, b) = (before[j] * h - rise, rise - after[j] * h);
            from[j] + x * rise + x * (1.0 - x) * ((1.0 - x) * a + x * b)
        })
    }

    /// The slope at a point, of the parabola through it and its neighbours, in rad/s.
    fn slope(&self, i: usize) -> Joints {
        if i == 0 || i + 1 >= self.t_s.len() {
            return [0.0; 7];
        }
        let (before, after) = (self.t_s[i] - self.t_s[i - 1], self.t_s[i + 1] - self.t_s[i]);
        std::array::from_fn(|j| {
            let [a, b, c] = [i - 1, i, i + 1].map(|k| self.joints_rad[k][j]);
            ((b - a) / before * after + (c - b) / after * before) / (before + after)
        })
    }
}
