//! Torques, work and power in the figures of a plan, all on the output side of the gears.

use std::fmt;

use iiwa_kin::{Joint, Joints};
use iiwa_traj::{MotionTorques, TorqueFigures};
use serde::{Deserialize, Serialize};

/// Torques of a motion.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TorqueRecord {
    /// Torque of each joint with the largest absolute value, with its sign, in Nm.
    pub peak_nm: Joints,
    /// Absolute value of the largest torque, in per cent of the robot's limit.
    pub peak_percent: Joints,
    /// Time of the largest torque, in s.
    pub peak_at_s: Joints,
    /// Largest torque that each joint would need to hold the robot at rest somewhere on the path,
    /// with its sign, in Nm.
    pub static_nm: Joints,
}

/// Work of the joints over the whole program, in J.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct EnergyRecord {
    /// Work done by each joint.
    pub positive: Joints,
    /// Work done on each joint: 0 or less.
    pub negative: Joints,
}

/// Largest total power of the joints.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PowerRecord {
    /// Peak power, in W; power absorbed by other joints at the same time is not subtracted.
    pub peak_w: f64,
    /// Time of the peak, in s.
    pub at_s: f64,
}

/// The torque of a plan with the largest share of its limit. Displayed for example as
/// `A2 at 61 % of its limit (-107.3 Nm), in motion 1 at 0.214 s`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LargestTorque {
    /// Motion number, from 1.
    pub motion: usize,
    /// Joint.
    pub joint: Joint,
    /// Torque, in per cent of the limit.
    pub percent: f64,
    /// Torque, in Nm.
    pub torque_nm: f64,
    /// Time, in s.
    pub at_s: f64,
}

impl fmt::Display for LargestTorque {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { motion, joint, percent, torque_nm, at_s } = self;
        write!(
            f,
            "{joint} at {percent:.0} % of its limit ({torque_nm:.1} Nm), in motion {motion} \
             at {at_s:.3} s"
        )
    }
}

/// Torques above this are reported, in per cent of the limit. Plans with torque limits exceed the
/// limits by at most 1 %.
const KEPT_PERCENT: f64 = 101.0;

impl TorqueRecord {
    /// Torque limit of a joint, in Nm, from the peak and its share of the limit, because records
    /// do not store limits. NaN, for which comparisons give no warning, if the peak is zero.
    fn limit_nm(&self, j: usize) -> f64 {
        100.0 * self.peak_nm[j].abs() / self.peak_percent[j]
    }

    /// Largest share of all joints; the first joint's for equal shares. `motion` is only stored in
    /// the result.
    pub(crate) fn largest(&self, motion: usize) -> LargestTorque {
        let larger = |a: Joint, b: Joint| {
            let is_larger = self.peak_percent[b.index()] > self.peak_percent[a.index()];
            if is_larger { b } else { a }
        };
        let joint = Joint::ALL.into_iter().fold(Joint::A1, larger);
        let j = joint.index();
        LargestTorque {
            motion,
            joint,
            percent: self.peak_percent[j],
            torque_nm: self.peak_nm[j],
            at_s: self.peak_at_s[j],
        }
    }

    /// Warning about torques above the limits, if any.
    pub(crate) fn warning(&self) -> Option<String> {
        let is_too_heavy = |j: &usize| self.static_nm[*j].abs() > self.limit_nm(*j);
        if let Some(j) = (0..7).find(is_too_heavy) {
            return Some(format!(
                "{} cannot hold the arm and its payload at rest on this path: holding takes {:.0} \
                 Nm of its {:.0}",
                Joint::ALL[j],
                self.static_nm[j].abs(),
                self.limit_nm(j)
            ));
        }
        let LargestTorque { joint, percent, torque_nm, at_s, .. } = self.largest(0);
        let limit_nm = self.limit_nm(joint.index());
        (percent > KEPT_PERCENT).then(|| {
            format!(
                "{joint} needs {percent:.0} % of its torque ({:.0} Nm of {limit_nm:.0}) at \
                 {at_s:.2} s",
                torque_nm.abs()
            )
        })
    }

    /// Appends the part of the motion after an intermediate stop.
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
    /// Updates the peak with the next section.
    pub(crate) fn add(&mut self, torques: &TorqueFigures) {
        if torques.peak_power_w > self.peak_w {
            *self = Self { peak_w: torques.peak_power_w, at_s: torques.peak_power_at_s };
        }
    }
}
