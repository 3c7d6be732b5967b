//! Torques, work and power in the figures of a plan: those of the link side, behind the gears.

use std::fmt;

use iiwa_kin::{Joint, Joints};
use iiwa_traj::{MotionTorques, TorqueFigures};
use serde::{Deserialize, Serialize};

/// Torques of a motion.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TorqueRecord {
    /// The largest torque of each joint, with its sign, in Nm.
    pub peak_nm: Joints,
    /// Its size in per cent of the robot's limit.
    pub peak_percent: Joints,
    /// When it is reached, in s.
    pub peak_at_s: Joints,
    /// The largest torque that each joint would need to stand still somewhere on the way, with its sign, in Nm.
    pub static_nm: Joints,
}

/// Work of the joints over the whole program, in J.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct EnergyRecord {
    /// What each joint does.
    pub positive: Joints,
    /// What is done on each joint: 0 or less.
    pub negative: Joints,
}

/// The most that the joints give at once.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PowerRecord {
    /// How much, in W; what other joints take back at the time is not counted against it.
    pub peak_w: f64,
    /// When, in s.
    pub at_s: f64,
}

/// The torque of a plan that is nearest to its limit, or farthest above it. As text, for people:
/// `61 % of A2's, -107.3 Nm in motion 1 at 0.214 s`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LargestTorque {
    /// The motion, from 1.
    pub motion: usize,
    /// The joint.
    pub joint: Joint,
    /// The torque, in per cent of the limit.
    pub percent: f64,
    /// The torque, in Nm.
    pub torque_nm: f64,
    /// When, in s.
    pub at_s: f64,
}

impl fmt::Display for LargestTorque {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { motion, joint, percent, torque_nm, at_s } = self;
        write!(
            f,
            "{percent:.0} % of {joint}'s, {torque_nm:.1} Nm in motion {motion} at {at_s:.3} s"
        )
    }
}

/// Plans with limits of torque keep them within 1 %: what is above by less is not warned of, in per cent of the limit.
const KEPT_PERCENT: f64 = 101.0;

impl TorqueRecord {
    /// The limit of a joint, in Nm; not a number if it exerts nothing.
    fn limit_nm(&self, j: usize) -> f64 {
        100.0 * self.peak_nm[j].abs() / self.peak_percent[j]
    }

    /// The largest share of all joints; of the same share, the first joint's.
    pub(crate) fn largest(&self, motion: usize) -> LargestTorque {
        let most = |a: Joint, b: Joint| {
            let is_larger = self.peak_percent[b.index()] > self.peak_percent[a.index()];
            if is_larger { b } else { a }
        };
        let joint = Joint::ALL.into_iter().fold(Joint::A1, most);
        let j = joint.index();
        LargestTorque {
            motion,
            joint,
            percent: self.peak_percent[j],
            torque_nm: self.peak_nm[j],
            at_s: self.peak_at_s[j],
        }
    }

    /// What is to be said of torques above the limits, if any is.
    pub(crate) fn warning(&self) -> Option<String> {
        let is_too_heavy = |j: &usize| self.static_nm[*j].abs() > self.limit_nm(*j);
        if let Some(j) = (0..7).find(is_too_heavy) {
            return Some(format!(
                "{} cannot hold the arm and its load on this way: to stand still takes {:.0} Nm of its {:.0}",
                Joint::ALL[j],
                self.static_nm[j].abs(),
                self.limit_nm(j)
            ));
        }
        let LargestTorque { joint, percent, torque_nm, at_s, .. } = self.largest(0);
        let limit_nm = self.limit_nm(joint.index());
        (percent > KEPT_PERCENT).then(|| {
            format!(
                "{joint} needs {percent:.0} % of its torque ({:.0} Nm of {limit_nm:.0}) at {at_s:.2} s",
                torque_nm.abs()
            )
        })
    }

    /// Adds what comes after a stop on the motion's way.
    pub(crate) fn go_on(&mut self, next: &Self) {
        for j in 0..7 {
            if next.peak_percent[j] > self.peak_percent[j] {
                self.peak_nm[j] = next.peak_nm[j];
                self.peak_percent[j] = next.peak_percent[j];
                self.peak_at_s[j] = next.peak_at_s[j];
            }
            if next.static_nm[j].abs() > self.static_nm[j].abs() {
                self.static_nm[j] = next.static_nm[j];
            }
        }
    }
}

impl From<&MotionTorques> for TorqueRecord {
    fn from(torques: &MotionTorques) -> Self {
        let MotionTorques { peak_nm, peak_rel, peak_at_s, static_nm, .. } = *torques;
        Self { peak_nm, peak_percent: peak_rel.map(|share| 100.0 * share), peak_at_s, static_nm }
    }
}

impl EnergyRecord {
    /// Adds the work of the next section.
    pub(crate) fn add(&mut self, torques: &TorqueFigures) {
        for j in 0..7 {
            self.positive[j] += torques.positive_work_j[j];
            self.negative[j] += torques.negative_work_j[j];
        }
    }
}

impl PowerRecord {
    /// Takes in the next section.
    pub(crate) fn add(&mut self, torques: &TorqueFigures) {
        if torques.peak_power_w > self.peak_w {
            *self = Self { peak_w: torques.peak_power_w, at_s: torques.peak_power_at_s };
        }
    }
}
