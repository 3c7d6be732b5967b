//! Lower bound of the time from one group of motions to the next.

use iiwa_kin::Joints;
use iiwa_path::{JointPath, Step};
use iiwa_program::LimitKind;
use iiwa_traj::Trajectory;

/// Point-to-point motions from stop to stop between two groups, the last one to the first target of
/// the second group. None of them is faster than with constant acceleration and deceleration at the
/// limits of speed and acceleration. The time at rest depends only on the motions.
pub(crate) struct GapBound {
    start_rad: Joints,
    lines: Vec<LineBound>,
    wait_s: f64,
    settle_s: f64,
}

struct LineBound {
    to_rad: Joints,
    /// Limits of speed and of acceleration, in rad/s and rad/s^2.
    limits: [Joints; 2],
}

impl GapBound {
    /// Creates the bound from the plan of a gap between any two positions; `None` if one of its
    /// `moves` is without displacement there.
    pub(crate) fn new(plan: &Trajectory, moves: usize) -> Option<Self> {
        let path = plan.path();
        let lines = path.steps().iter().enumerate().filter_map(|(index, step)| match step {
            Step::Move { segment, .. } => {
                Some(LineBound { to_rad: segment.at(1.0).q, limits: limits(path, index) })
            }
            _ => None,
        });
        let lines: Vec<_> = lines.collect();
        let totals = plan.totals();
        (lines.len() == moves).then_some(Self {
            start_rad: *path.start_rad(),
            lines,
            wait_s: totals.wait_time_s,
            settle_s: totals.settle_time_s,
        })
    }

    /// Returns the bound between two positions, in s; without them, those of the plan count.
    pub(crate) fn time_s(&self, from_rad: Option<&Joints>, to_rad: Option<&Joints>) -> f64 {
        /// A motion without displacement may have another standstill.
        const STILL_RAD: f64 = 1e-6;

        let mut at = *from_rad.unwrap_or(&self.start_rad);
        let (mut moving_s, mut is_still) = (0.0, false);
        let last = self.lines.len().saturating_sub(1);
        for (index, line) in self.lines.iter().enumerate() {
            let to = *to_rad.filter(|_| index == last).unwrap_or(&line.to_rad);
            let way: Joints = std::array::from_fn(|joint| (to[joint] - at[joint]).abs());
            is_still |= way.iter().all(|way| *way < STILL_RAD);
            moving_s += line.time_s(&way);
            at = to;
        }
        moving_s + self.wait_s + if is_still { 0.0 } else { self.settle_s }
    }
}

impl LineBound {
    /// Returns the shortest time of a line with these ways of the joints, in s.
    fn time_s(&self, way: &Joints) -> f64 {
        // In lines per second, and per second squared.
        let [speed, acceleration] = self.limits.each_ref().map(|limits| {
            let shares = limits.iter().zip(way).map(|(limit, way)| limit / way);
            shares.fold(f64::INFINITY, f64::min)
        });
        if speed * speed < acceleration {
            1.0 / speed + speed / acceleration
        } else {
            2.0 / acceleration.sqrt()
        }
    }
}

fn limits(path: &JointPath, step: usize) -> [Joints; 2] {
    let limits = path.limits_of(step);
    [LimitKind::Velocity, LimitKind::Acceleration].map(|kind| *limits.of(kind))
}
