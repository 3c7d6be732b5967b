//! Search for the place where a segment leaves the sphere about a target that is blended away.
//!
//! All three searches run from the target along the segment, in u: 0 at the target, 1 at the other
//! end of the segment (Larsen 2019 uses s = 1 - u). They end half-way, at u = 1/2, so that the
//! blends at the two ends of a segment never overlap.

use iiwa_kin::{Joints, Robot, rotation, vector};
use iiwa_program::Blend;

/// Algorithm that searches for the crossing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum BlendSearch {
    /// The crossing nearest to the target, provably.
    #[default]
    FirstCrossing,
    /// Bisection (Larsen 2019, Algorithm 1): may find another crossing than the nearest.
    Algorithm1,
    /// Steps of 0.001 (Larsen 2019, Algorithm 2): may step over a pair of crossings, and finds a
    /// crossing up to one step too late.
    Algorithm2,
}

/// Largest share of a segment that a blend takes.
pub(crate) const HALF: f64 = 0.5;

impl BlendSearch {
    /// Returns the u at which the segment from `point_rad` to `other_end_rad` first leaves the
    /// sphere of `radius_m` about the TCP at `point_rad`, or `None` if it stays inside in its first
    /// half. `tcp_m` is the position of the TCP in the flange frame, in m.
    ///
    /// ```
    /// use iiwa_kin::Robot;
    /// use iiwa_path::BlendSearch;
    ///
    /// let robot = Robot::default();
    /// let (corner, other) = ([0.5, 0.3, 0.0, -1.0, 0.0, 0.7, 0.0], [0.0; 7]);
    /// let u = BlendSearch::FirstCrossing.crossing(&robot, &[0.0; 3], &corner, &other, 0.05);
    /// // A blend of 50 mm begins on the last tenth of the motion.
    /// assert!(u.is_some_and(|u| u < 0.1));
    /// ```
    #[must_use]
    pub fn crossing(
        self,
        robot: &Robot,
        tcp_m: &[f64; 3],
        point_rad: &Joints,
        other_end_rad: &Joints,
        radius_m: f64,
    ) -> Option<f64> {
        let tcp = (*tcp_m != [0.0; 3]).then_some(tcp_m);
        let length_m = tcp.map_or(0.0, rotation::norm);
        // The robot never leaves a sphere of this size, and the squared radius must be finite.
        let radius_m = radius_m.min(4.0 * (robot.axis_reach_m()[0] + length_m));
        let mut walk = Walk {
            robot,
            tcp,
            point: point_rad,
            way: vector::sub(other_end_rad, point_rad),
            centre: [0.0; 3],
        };
        walk.centre = walk.position(point_rad);
        match self {
            Self::FirstCrossing => walk.first_crossing(radius_m),
            Self::Algorithm1 => walk.algorithm_1(radius_m),
            Self::Algorithm2 => walk.algorithm_2(radius_m),
        }
    }

    /// Share of the segment from `target_rad` to `other_end_rad` that `blend` cuts off (Larsen
    /// 2019, section 4.1), before Algorithm 3 makes the distances on both sides of the target
    /// equal. `tcp_m` is the TCP in the flange frame. Returns `None` if the blend is too small to
    /// have an effect.
    #[must_use]
    pub fn share(
        self,
        blend: Blend,
        robot: &Robot,
        tcp_m: &[f64; 3],
        target_rad: &Joints,
        other_end_rad: &Joints,
    ) -> Option<f64> {
        blend.has_effect().then(|| match blend {
            Blend::Fraction(b) => b,
            Blend::SunriseRel(x) => x / 2.0,
            Blend::CartMm(r) => {
                let crossing = self.crossing(robot, tcp_m, target_rad, other_end_rad, r * 1e-3);
                crossing.unwrap_or(HALF)
            }
        })
    }
}

/// Distance between the TCP positions at two joint positions, in mm. `tcp_m` is the position of the
/// TCP in the flange frame, in m.
pub(crate) fn tcp_distance_mm(robot: &Robot, tcp_m: &[f64; 3], ends_rad: [&Joints; 2]) -> f64 {
    let [from, to] = ends_rad.map(|q| robot.tcp_motion(tcp_m, q, &[0.0; 7]).0);
    1e3 * rotation::norm(&rotation::sub(&to, &from))
}

struct Walk<'a> {
    robot: &'a Robot,
    /// TCP in the flange frame; `None` for the flange itself.
    tcp: Option<&'a [f64; 3]>,
    point: &'a Joints,
    way: Joints,
    centre: [f64; 3],
}

impl Walk<'_> {
    fn position(&self, q: &Joints) -> [f64; 3] {
        match self.tcp {
            None => self.robot.flange_position(q),
            Some(tcp) => self.robot.tcp_motion(tcp, q, &[0.0; 7]).0,
        }
    }

    fn distance(&self, u: f64) -> f64 {
        let p = self.position(&vector::add_scaled(self.point, u, &self.way));
        (0..3).map(|i| (p[i] - self.centre[i]).powi(2)).sum::<f64>().sqrt()
    }

    /// Squared distance from the centre of the sphere, and half its derivative with respect to u.
    fn squared_distance(&self, u: f64) -> (f64, f64) {
        let q = vector::add_scaled(self.point, u, &self.way);
        let (p, v) = match self.tcp {
            None => self.robot.flange_motion(&q, &self.way),
            Some(tcp) => self.robot.tcp_motion(tcp, &q, &self.way),
        };
        (0..3).fold((0.0, 0.0), |(square, rate), i| {
            let d = p[i] - self.centre[i];
            (square + d * d, rate + d * v[i])
        })
    }

    /// Upper bounds on the whole segment: of the TCP speed |dp/du| (m), and of the TCP acceleration
    /// |d2p/du2| (m).
    ///
    /// Per unit of angle, joint j moves the TCP by at most its distance `r_j` from the joint axis.
    /// The second derivative with respect to joints i <= j is the cross product of the axis of i
    /// with that motion, so it is at most `r_j` as well.
    fn bounds(&self) -> (f64, f64) {
        let reach = self.reach_m();
        let mut before = 0.0;
        let (mut speed, mut acceleration) = (0.0, 0.0);
        for (way, reach) in self.way.iter().zip(reach) {
            let way = way.abs();
            speed += way * reach;
            acceleration += (2.0 * before + way) * way * reach;
            before += way;
        }
        (speed, acceleration)
    }

    /// Upper bound of the distance of the TCP from each joint axis, in m.
    fn reach_m(&self) -> Joints {
        let mut reach = self.robot.axis_reach_m();
        if let Some(tcp) = self.tcp {
            let beside = tcp[0].hypot(tcp[1]);
            for reach in &mut reach {
                *reach += rotation::norm(tcp);
            }
            reach[6] = beside;
        }
        reach
    }

    /// Advances by steps that cannot cross the sphere, and ends on it.
    ///
    /// With f the squared distance from the centre, `f'' = 2 |p'|^2 + 2 (p - c) p''` is at most
    /// `K = 2 (L^2 + r A)` inside the sphere, with L and A the bounds of speed and acceleration. So
    /// `f(u + h) <= f + f' h + K/2 h^2`, and the h for which the right side is r^2 is a step that
    /// does not cross the sphere. Near a crossing, the steps turn into Newton steps from inside.
    fn first_crossing(&self, radius: f64) -> Option<f64> {
        let (speed, acceleration) = self.bounds();
        let half_k = speed * speed + radius * acceleration;
        let square = radius * radius;
        let mut u = 0.0;
        loop {
            let (f, half_rate) = self.squared_distance(u);
            let gap = square - f;
            if gap <= REACHED * square {
                return Some(u);
            }
            let root = (half_rate * half_rate + half_k * gap).sqrt();
            // The same root, in the two forms without cancellation.
            u += if half_rate >= 0.0 {
                gap / (half_rate + root)
            } else {
                (root - half_rate) / half_k
            };
            if u > HALF || u.is_nan() {
                return None;
            }
        }
    }

    fn algorithm_1(&self, radius: f64) -> Option<f64> {
        let mut s = 1.0;
        let mut step = 1.0;
        let mut distance: f64 = 0.0;
        // Without a crossing, the bisection converges to the far end and would never stop.
        while (distance - radius).abs() > ALGORITHM_1_TOLERANCE_M && step > f64::EPSILON {
            step /= 2.0;
            s += if distance >= radius { step } else { -step };
            distance = self.distance(1.0 - s);
        }
        let is_close = (distance - radius).abs() <= ALGORITHM_1_TOLERANCE_M;
        (is_close && 1.0 - s <= HALF).then_some(1.0 - s)
    }

    fn algorithm_2(&self, radius: f64) -> Option<f64> {
        // Counting the steps keeps s an exact multiple of the step; the thesis subtracts the step
        // repeatedly.
        (1..=ALGORITHM_2_STEPS)
            .map(|step| f64::from(step) * (HALF / f64::from(ALGORITHM_2_STEPS)))
            .find(|&u| self.distance(u) >= radius)
    }
}

/// Relative distance to the squared radius at which the sphere counts as reached.
const REACHED: f64 = 1e-13;
/// epsilon of Larsen 2019, Algorithm 1.
const ALGORITHM_1_TOLERANCE_M: f64 = 1e-9;
/// Steps of 0.001 up to the half (Larsen 2019, Algorithm 2).
const ALGORITHM_2_STEPS: u32 = 500;
