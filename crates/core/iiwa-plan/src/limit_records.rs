//! Figures of a plan beside limits: shares of limits, torques, the loads behind them, clearances.
//! Torques, work and power are on the output side of the gears.

use std::{borrow::Cow, fmt};

use iiwa_kin::{Joint, Joints};
use iiwa_program::{Motion, MotionIndex, MotionLabel, Program, Source};
use iiwa_traj::{Limit, MotionTorques, TorqueFigures};
use serde::{Deserialize, Serialize};

/// A limit with the share of a motion's time for which it is active.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LimitShareRecord {
    /// Limit.
    #[serde(flatten)]
    pub limit: LimitRecord,
    /// Share of the time, 0 to 1.
    pub share: f64,
}

/// A joint limit, a TCP limit, or a limit of another kind.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LimitRecord {
    /// Joint, 1 to 7; `None` for a limit that does not belong to a joint.
    pub joint: Option<usize>,
    /// Kind: `velocity`, `acceleration` or `jerk`, for a TCP limit with the prefix `cart_` (along
    /// the path) or `orientation_` (angular); `torque`; `minimum_duration` of short motions under
    /// Sunrise; `t1_velocity` of TCP and flange in T1; or the name of another limit. In plans of
    /// earlier versions, `cart_velocity` is also the kind of the minimum duration and of T1.
    pub kind: Cow<'static, str>,
}

impl From<Limit> for LimitRecord {
    fn from(limit: Limit) -> Self {
        Self { joint: limit.joint().map(Joint::number), kind: limit.name().into() }
    }
}

/// Writes `A4 velocity`, `cart velocity` or `T1 velocity`.
impl fmt::Display for LimitRecord {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(joint) = self.joint {
            write!(f, "A{joint} ")?;
        }
        // A name, not a word.
        let kind = self.kind.strip_prefix("t1_").map(|kind| format!("T1 {kind}"));
        f.write_str(&kind.unwrap_or_else(|| self.kind.to_string()).replace('_', " "))
    }
}

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

/// Change of the load: a `load` entry of the program.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LoadRecord {
    /// Number in the program, from 1.
    pub index: usize,
    /// Name, comment and group, if the entry has any of them.
    #[serde(flatten)]
    pub label: MotionLabel,
    /// Mass of the load, in kg; `None` if the entry removes it, which leaves the tool's load.
    pub mass_kg: Option<f64>,
    /// Source line, if known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub source: Option<Source>,
}

impl LoadRecord {
    /// Changes of the load in a program, in order.
    pub(crate) fn all(program: &Program) -> Vec<Self> {
        let record = |(motion, entry): (_, &Motion)| {
            let Motion::Load(load) = entry else { return None };
            Some(Self {
                index: MotionIndex::number(motion),
                label: program.sources.label(motion).cloned().unwrap_or_default(),
                mass_kg: load.as_ref().map(|payload| payload.load.mass_kg),
                source: program.sources.of(motion).cloned(),
            })
        };
        program.entries().filter_map(record).collect()
    }
}

/// Smallest distance between the arm and the scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ClearanceRecord {
    /// Distance in mm; 0 if the arm touches the obstacle.
    pub distance_mm: f64,
    /// Link of the arm, 2 to 7, 8 for the tool, or 9 for the workpiece. Links 0 and 1 have the same
    /// distances at all poses.
    pub link: usize,
    /// Obstacle name.
    pub obstacle: String,
    /// Time, in s.
    pub at_s: f64,
}

/// Smallest distance of the arm from itself.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SelfClearanceRecord {
    /// Distance in mm; 0 if the two links touch.
    pub distance_mm: f64,
    /// First link, 3 to 7, 8 for the tool, or 9 for the workpiece.
    pub link: usize,
    /// Second link, 0 to 5: at least three numbers lower, since closer links are assumed not to
    /// touch each other.
    pub other_link: usize,
    /// Time, in s.
    pub at_s: f64,
}
