//! A trajectory as a client sends it: joint positions with stamps.

mod differences;

use std::{fmt, marker::PhantomData};

use iiwa_kin::{Joints, Limits};
use serde::{
    Deserialize, Deserializer, Serialize,
    de::{Error as _, IgnoredAny, SeqAccess, Visitor},
};

use crate::message::{Code, Figures, Refusal};

/// Joint positions with stamps.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TimedJoints {
    /// Stamps, in s; they increase strictly. The first one is the start, whatever it is.
    #[serde(deserialize_with = "bounded")]
    pub t_s: Vec<f64>,
    /// Positions at these times, in rad.
    #[serde(deserialize_with = "points")]
    pub joints_rad: Vec<Joints>,
}

fn points<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<Joints>, D::Error> {
    let points: Vec<Point> = bounded(deserializer)?;
    Ok(points.into_iter().map(|Point(joints_rad)| joints_rad).collect())
}

/// A list that is read no further than to its [`MAX_POINTS`]-th value.
fn bounded<'de, T: Deserialize<'de>, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Vec<T>, D::Error> {
    struct OfList<T>(PhantomData<T>);
    impl<'de, T: Deserialize<'de>> Visitor<'de> for OfList<T> {
        type Value = Vec<T>;
        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            write!(f, "a sequence of at most {MAX_POINTS} values")
        }
        fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Vec<T>, A::Error> {
            let mut values = Vec::new();
            while let Some(value) = seq.next_element()? {
                if values.len() == MAX_POINTS {
                    return Err(A::Error::invalid_length(MAX_POINTS + 1, &self));
                }
                values.push(value);
            }
            Ok(values)
        }
    }
    deserializer.deserialize_seq(OfList(PhantomData))
}

/// Exactly seven numbers. Left to itself, serde finds an eighth one to be text after the end.
struct Point(Joints);

impl<'de> Deserialize<'de> for Point {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct OfSeven;
        impl<'de> Visitor<'de> for OfSeven {
            type Value = Point;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("seven joint angles, A1 to A7")
            }
            fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Point, A::Error> {
                let mut joints_rad = [0.0; 7];
                for (count, joint) in joints_rad.iter_mut().enumerate() {
                    let Some(value) = seq.next_element()? else {
                        return Err(A::Error::invalid_length(count, &self));
                    };
                    *joint = value;
                }
                let mut count = 7;
                while seq.next_element::<IgnoredAny>()?.is_some() {
                    count += 1;
                }
                if count == 7 {
                    Ok(Point(joints_rad))
                } else {
                    Err(A::Error::invalid_length(count, &self))
                }
            }
        }
        deserializer.deserialize_seq(OfSeven)
    }
}

/// Most points of a trajectory: 13 minutes, if there is one every 4 ms.
pub const MAX_POINTS: usize = 200_000;

/// How far from the robot a trajectory may start, in rad: half a degree.
pub const START_TOLERANCE_RAD: f64 = 0.5 * std::f64::consts::PI / 180.0;

/// How far beyond the robot's limits of velocity, acceleration and jerk a trajectory may go, as a share.
///
/// Planners keep limits exactly at some places and nearly in between; what is beyond these margins is
/// no rounding any more.
pub const MARGINS: [f64; 3] = [0.02, 0.05, 0.10];

/// Longest step from one point to the next while the arm moves, in s. Points that keep the limits tell too
/// little of what is between those that are farther apart: the acceleration limits are reached within 30
/// to 60 ms.
pub const MAX_STEP_S: f64 = 0.025;

/// Longest trajectory, in s: more than a day is a slip of the pen, as a wait of a program is.
const LONGEST_S: f64 = 24.0 * 3600.0;

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
    /// its end. They are checked by divided differences of the points over 1 to 24 ms; what rounding to
    /// six decimals explains is no excess. While the arm moves, points are at most [`MAX_STEP_S`] apart.
    ///
    /// # Errors
    ///
    /// [`Code::BadRequest`], [`Code::StartMismatch`] or [`Code::Limit`], with the place.
    pub fn check(&self, limits: &Limits, start_rad: &Joints) -> Result<(), Refusal> {
        self.check_form()?;
        let start = &self.joints_rad[0];
        let off = |j: &usize| (start[*j] - start_rad[*j]).abs();
        let worst = (0..7).max_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(0);
        // What is no number is near nothing.
        let is_near = off(&worst) <= START_TOLERANCE_RAD;
        if !is_near {
            return Err(Refusal::new(
                Code::StartMismatch,
                format!(
                    "the trajectory starts with joint {} at {} deg, the robot is at {} deg; they may be \
                     {} deg apart",
                    worst + 1,
                    Figures(start[worst].to_degrees(), 3),
                    Figures(start_rad[worst].to_degrees(), 3),
                    START_TOLERANCE_RAD.to_degrees()
                ),
            ));
        }
        for (i, q) in self.joints_rad.iter().enumerate() {
            if let Some(j) = limits.outside(q) {
                return Err(Refusal::new(
                    Code::Limit,
                    format!(
                        "point {}: joint {} is at {} deg, its limit is +-{:.3} deg",
                        i + 1,
                        j + 1,
                        Figures(q[j].to_degrees(), 3),
                        limits.position_rad[j].to_degrees()
                    ),
                ));
            }
        }
        self.check_steps()?;
        differences::check(self, limits)
    }

    fn check_steps(&self) -> Result<(), Refusal> {
        // Stamps are sums.
        const MOST_S: f64 = MAX_STEP_S + 1e-6;
        let step_s = |i: usize| self.t_s[i + 1] - self.t_s[i];
        let is_far = |i: &usize| step_s(*i) > MOST_S && !self.rests_after(*i);
        match (0..self.t_s.len() - 1).find(is_far) {
            None => Ok(()),
            Some(i) => Err(Refusal::bad(format!(
                "point {}: {} s after the one before; while the arm moves, {MAX_STEP_S} s is the most",
                i + 2,
                Figures(step_s(i), 4)
            ))),
        }
    }

    /// Whether the arm stands from a point to the next one.
    fn rests_after(&self, i: usize) -> bool {
        self.joints_rad[i] == self.joints_rad[i + 1]
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
                "point {}: its stamp, {:?} s, is not after the one before, {:?} s",
                i + 1,
                self.t_s[i],
                self.t_s[i - 1]
            )));
        }
        if self.duration_s() > LONGEST_S {
            return Err(Refusal::bad(format!(
                "the trajectory takes {} s; a day, {LONGEST_S} s, is the most",
                Figures(self.duration_s(), 0)
            )));
        }
        Ok(())
    }

    /// Where the joints are `t_s` after the start, in rad; before it at the start, after the end there.
    ///
    /// Between points, a cubic with the slopes of parabolas through three points, and of zero where a
    /// joint rests: at both ends, and beside steps without motion. Beside rest the slopes are limited, so
    /// that a joint never swings beyond the place where it stops, which may be the end of its range.
    #[must_use]
    pub fn at(&self, t_s: f64) -> Joints {
        let count = self.t_s.len().min(self.joints_rad.len());
        let (stamps, points) = (&self.t_s[..count], &self.joints_rad[..count]);
        let ([first_s, ..], [first, .., last]) = (stamps, points) else {
            return points.first().copied().unwrap_or_default();
        };
        // Not the other way round: next to the date of a clock, milliseconds would be rounded away.
        let next = stamps.partition_point(|stamp| stamp - first_s <= t_s);
        if next == 0 {
            return *first;
        }
        if next >= count {
            return *last;
        }
        let i = next - 1;
        let h = stamps[next] - stamps[i];
        let x = (t_s - (stamps[i] - first_s)) / h;
        let (from, to) = (&points[i], &points[next]);
        let (before, after) = (self.slope(i), self.slope(next));
        std::array::from_fn(|j| {
            let rise = to[j] - from[j];
            let (a, b) = (before[j] * h - rise, rise - after[j] * h);
            from[j] + x * rise + x * (1.0 - x) * ((1.0 - x) * a + x * b)
        })
    }

    /// The slopes at a point, in rad/s.
    ///
    /// A cubic between two points stays between them if its slopes there have the sign of its secant and
    /// are at most three times as steep (Fritsch and Carlson 1980). That is asked for beside rest only, for
    /// two points, as the joint may be next to rest at the first one: elsewhere, a place nearby where a joint
    /// turns would spoil the slope.
    fn slope(&self, i: usize) -> Joints {
        let last = self.t_s.len().min(self.joints_rad.len()) - 1;
        if i == 0 || i >= last {
            return [0.0; 7];
        }
        let (before, after) = (self.t_s[i] - self.t_s[i - 1], self.t_s[i + 1] - self.t_s[i]);
        std::array::from_fn(|j| {
            let [a, b, c] = [i - 1, i, i + 1].map(|k| self.joints_rad[k][j]);
            let (from, to) = ((b - a) / before, (c - b) / after);
            if from == 0.0 || to == 0.0 {
                return 0.0;
            }
            let mut slope = (from * after + to * before) / (before + after);
            if self.rests_before(i, j) {
                slope = within_secant(slope, from);
            }
            if self.rests_from(i, j, last) {
                slope = within_secant(slope, to);
            }
            slope
        })
    }

    /// Whether joint `j` has rested one or two points before point `i`.
    fn rests_before(&self, i: usize, j: usize) -> bool {
        let q = |k: usize| self.joints_rad[k][j];
        i <= 2 || q(i - 2) == q(i - 1) || q(i - 3) == q(i - 2)
    }

    /// Whether joint `j` rests from one or two points after point `i` on; `last` is the last point.
    fn rests_from(&self, i: usize, j: usize, last: usize) -> bool {
        let q = |k: usize| self.joints_rad[k][j];
        i + 2 >= last || q(i + 1) == q(i + 2) || q(i + 2) == q(i + 3)
    }
}

/// The slope, limited so that a cubic that ends with it, and begins with zero, stays between its ends.
fn within_secant(slope: f64, secant: f64) -> f64 {
    let [low, high] = if secant > 0.0 { [0.0, 3.0 * secant] } else { [3.0 * secant, 0.0] };
    // Not `clamp`, which panics where a bound is not a number.
    slope.max(low).min(high)
}
