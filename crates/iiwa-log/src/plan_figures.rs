//! The figures of a plan: its times, its motions and its blends.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fmt;

use iiwa_kin::{Joint, Robot};
use iiwa_traj::{
    BlendFigures, CartesianFigures, Limit, MotionFigures, Section, Timing, Totals, Trajectory,
};
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::PlanOptions;

/// The figures of a plan. As JSON, this is the object of `iiwasim plan --json`; in a file, each key is an
/// entry of the metadata record `iiwasim`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlanFigures {
    /// From the start to the end of the last settling or waiting, in s.
    pub cycle_time_s: f64,
    /// The part of it in motion, in s.
    pub motion_time_s: f64,
    /// The part of it in which the arm settles, in s.
    pub settle_time_s: f64,
    /// The part of it in which the program waits, in s.
    pub wait_time_s: f64,
    /// How it was timed: `acceleration` or `jerk`.
    pub timing: Cow<'static, str>,
    /// The robot's name.
    pub robot: String,
    /// Samples per blend of the sweep under limits of acceleration.
    pub samples: u32,
    /// Limits of the robot that the figures rest on and no source states.
    pub assumptions: Vec<String>,
    /// How near the arm comes to the scene, if there is one with obstacles.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub clearance: Option<ClearanceRecord>,
    /// How near the arm comes to itself, if there is a scene.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub self_clearance: Option<SelfClearanceRecord>,
    /// The motions of the program, in order.
    pub motions: Vec<MotionRecord>,
    /// The blends between them, in order.
    pub blends: Vec<BlendRecord>,
}

/// Where the arm comes nearest to the scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ClearanceRecord {
    /// Distance in mm; 0 if the arm touches the obstacle.
    pub distance_mm: f64,
    /// The arm's link, 2 to 7, or 8 for the tool.
    pub link: usize,
    /// The obstacle's name.
    pub obstacle: String,
    /// When, in s.
    pub at_s: f64,
}

/// Where the arm comes nearest to itself.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SelfClearanceRecord {
    /// Distance in mm; 0 if the two links touch.
    pub distance_mm: f64,
    /// The link that comes near, 3 to 7, or 8 for the tool.
    pub link: usize,
    /// The link that it comes near to, 0 to 5.
    pub other_link: usize,
    /// When, in s.
    pub at_s: f64,
}

/// A motion of the program, or a wait.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MotionRecord {
    /// The place in the program, from 1.
    pub index: usize,
    /// `ptp`, `lin`, `lin_rel`, `circ`, `spline`, `spl` or `wait`.
    pub r#type: Cow<'static, str>,
    /// When it starts, in s.
    pub start_s: f64,
    /// When it ends, in s.
    pub end_s: f64,
    /// The largest share of its velocity limit that any joint reaches, 0 to 1.
    pub peak_velocity_rel: f64,
    /// The limit that binds for the longest time, if any does.
    pub limited_by: Option<LimitRecord>,
    /// All limits that bind, with their shares of the time.
    pub limits: Vec<LimitShareRecord>,
    /// What there is to say of the TCP of a motion to a frame, or of a program with a tool.
    #[serde(flatten, default, skip_serializing_if = "Option::is_none")]
    pub cartesian: Option<CartesianRecord>,
}

/// What there is to say of the TCP of a motion to a frame.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CartesianRecord {
    /// Its top speed, in mm/s.
    pub tcp_speed_peak_mm_s: f64,
    /// Where the arm is nearest to a singularity.
    pub singularity: SingularityRecord,
    /// The status at the motion's end, 0 to 7.
    pub status: u8,
    /// E1, the position of A3, at its start and at its end, in deg.
    pub e1_deg: [f64; 2],
}

/// Where the arm is nearest to a singularity.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SingularityRecord {
    /// How near: 0 in the singularity, 1 at most.
    pub least: f64,
    /// When, in s.
    pub at_s: f64,
    /// `shoulder`, `elbow` or `wrist`.
    pub axis: Cow<'static, str>,
}

/// A limit and the share of a motion's time for which it binds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LimitShareRecord {
    /// The limit.
    #[serde(flatten)]
    pub limit: LimitRecord,
    /// Share of the time, 0 to 1.
    pub share: f64,
}

/// A limit of a joint or of the TCP.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LimitRecord {
    /// The joint, 1 to 7; none if the TCP is limited.
    pub joint: Option<usize>,
    /// `velocity`, `acceleration` or `jerk`; of the TCP the same after `cart_` (along its way) or `orientation_` (as it
    /// turns).
    pub kind: Cow<'static, str>,
}

/// A blend between two motions.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BlendRecord {
    /// The motion whose target it blends away, from 1.
    pub after_motion: usize,
    /// The angle between the two motions in joint space, in deg.
    pub gamma_deg: f64,
    /// Joint positions where it starts, in rad.
    pub start_rad: [f64; 7],
    /// Joint positions where it ends, in rad.
    pub end_rad: [f64; 7],
    /// Joint positions half-way, in rad.
    pub mid_rad: [f64; 7],
    /// The flange's position there, in m.
    pub mid_tcp_m: [f64; 3],
    /// When it starts, in s.
    pub start_s: f64,
    /// When it ends, in s.
    pub end_s: f64,
}

impl MotionRecord {
    /// Adds what it does after a stop on its way.
    fn go_on(&mut self, next: Self) {
        let times = [self.end_s - self.start_s, next.end_s - next.start_s];
        let of_all = |share: f64, part: usize| share * times[part] / (times[0] + times[1]);
        for limit in &mut self.limits {
            limit.share = of_all(limit.share, 0);
        }
        for LimitShareRecord { limit, share } in next.limits {
            let share = of_all(share, 1);
            match self.limits.iter_mut().find(|own| own.limit == limit) {
                Some(own) => own.share += share,
                None => self.limits.push(LimitShareRecord { limit, share }),
            }
        }
        self.limits.sort_by(|a, b| b.share.total_cmp(&a.share));
        self.limited_by = self.limits.first().map(|first| first.limit.clone());
        self.end_s = next.end_s;
        self.peak_velocity_rel = self.peak_velocity_rel.max(next.peak_velocity_rel);
        self.cartesian = match (self.cartesian.take(), next.cartesian) {
            (Some(own), Some(next)) => Some(CartesianRecord {
                tcp_speed_peak_mm_s: own.tcp_speed_peak_mm_s.max(next.tcp_speed_peak_mm_s),
                singularity: if next.singularity.least < own.singularity.least {
                    next.singularity
                } else {
                    own.singularity
                },
                status: next.status,
                e1_deg: [own.e1_deg[0], next.e1_deg[1]],
            }),
            (own, next) => own.or(next),
        };
    }
}

impl PlanFigures {
    /// The figures of a plan without any section yet. `samples` are those per blend of the sweep, as they
    /// were asked for.
    #[must_use]
    pub fn new(timing: Timing, robot: &Robot, samples: u32) -> Self {
        let used = |what: &str| match timing {
            Timing::Jerk(_) => what == "acceleration" || what == "jerk",
            _ => what == "acceleration",
        };
        Self {
            cycle_time_s: 0.0,
            motion_time_s: 0.0,
            settle_time_s: 0.0,
            wait_time_s: 0.0,
            timing: timing.name().into(),
            robot: robot.name().to_owned(),
            samples,
            assumptions: robot
                .assumptions()
                .iter()
                .filter(|assumption| used(&assumption.what))
                .map(|assumption| format!("{}: {}", assumption.what, assumption.basis))
                .collect(),
            clearance: None,
            self_clearance: None,
            motions: Vec::new(),
            blends: Vec::new(),
        }
    }

    /// The figures of a whole trajectory, which was planned with `options`.
    #[must_use]
    pub fn of(trajectory: &Trajectory, options: &PlanOptions) -> Self {
        let mut figures = Self::new(options.timing, trajectory.path().robot(), options.samples);
        trajectory.sections().iter().for_each(|section| figures.add(section));
        figures
    }

    /// Adds the next section of the trajectory.
    pub fn add(&mut self, section: &Section) {
        let mut totals = Totals {
            motion_time_s: self.motion_time_s,
            settle_time_s: self.settle_time_s,
            wait_time_s: self.wait_time_s,
        };
        totals.add(section);
        self.cycle_time_s = totals.cycle_time_s();
        self.motion_time_s = totals.motion_time_s;
        self.settle_time_s = totals.settle_time_s;
        self.wait_time_s = totals.wait_time_s;
        for motion in section.motions().iter().map(MotionRecord::from) {
            match self.motions.last_mut().filter(|last| last.index == motion.index) {
                // It stopped on its way, as a spline does where its segments do not join smoothly.
                Some(last) => last.go_on(motion),
                None => self.motions.push(motion),
            }
        }
        self.blends.extend(section.blends().iter().map(BlendRecord::from));
    }

    /// Adds a clearance; the first of the smallest ones is kept.
    pub fn add_clearance(&mut self, clearance: ClearanceRecord) {
        let nearest = self.clearance.as_ref().map(|nearest| nearest.distance_mm);
        if nearest.is_none_or(|distance_mm| clearance.distance_mm < distance_mm) {
            self.clearance = Some(clearance);
        }
    }

    /// Adds a clearance of the arm from itself; the first of the smallest ones is kept.
    pub fn add_self_clearance(&mut self, clearance: SelfClearanceRecord) {
        let nearest = self.self_clearance.as_ref().map(|nearest| nearest.distance_mm);
        if nearest.is_none_or(|distance_mm| clearance.distance_mm < distance_mm) {
            self.self_clearance = Some(clearance);
        }
    }

    /// An entry for each key: texts as they are, everything else as JSON.
    pub(crate) fn to_metadata(&self) -> BTreeMap<String, String> {
        let Ok(Value::Object(object)) = serde_json::to_value(self) else {
            return BTreeMap::new();
        };
        let text = |value| match value {
            Value::String(text) => text,
            other => other.to_string(),
        };
        object.into_iter().map(|(key, value)| (key, text(value))).collect()
    }

    /// The figures in these entries; none if they are not those of a plan.
    pub(crate) fn from_metadata(entries: &BTreeMap<String, String>) -> Option<Self> {
        serde_json::from_value(to_json(entries)).ok()
    }
}

/// The entries as a JSON object: an entry that is JSON is taken as such, any other one is a text.
pub(crate) fn to_json(entries: &BTreeMap<String, String>) -> Value {
    let value =
        |text: &String| serde_json::from_str(text).unwrap_or_else(|_| Value::String(text.clone()));
    Value::Object(entries.iter().map(|(key, text)| (key.clone(), value(text))).collect())
}

impl From<Limit> for LimitRecord {
    fn from(limit: Limit) -> Self {
        Self { joint: limit.joint().map(Joint::number), kind: limit.name().into() }
    }
}

/// As it is shown: `A4 velocity`, or `cart velocity`.
impl fmt::Display for LimitRecord {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(joint) = self.joint {
            write!(f, "A{joint} ")?;
        }
        f.write_str(&self.kind.replace('_', " "))
    }
}

impl From<&MotionFigures> for MotionRecord {
    fn from(figures: &MotionFigures) -> Self {
        Self {
            index: figures.motion.number(),
            r#type: figures.kind.name().into(),
            start_s: figures.start_s,
            end_s: figures.end_s,
            peak_velocity_rel: figures.peak_velocity_rel,
            limited_by: figures.limited_by.map(LimitRecord::from),
            limits: figures
                .limits
                .iter()
                .map(|limit| LimitShareRecord { limit: limit.limit.into(), share: limit.share })
                .collect(),
            cartesian: figures.cartesian.as_ref().map(CartesianRecord::from),
        }
    }
}

impl From<&CartesianFigures> for CartesianRecord {
    fn from(figures: &CartesianFigures) -> Self {
        let nearest = figures.nearest_singularity;
        Self {
            tcp_speed_peak_mm_s: 1000.0 * figures.tcp_speed_peak_m_s,
            singularity: SingularityRecord {
                least: nearest.least,
                at_s: nearest.at_s,
                axis: nearest.part.to_string().into(),
            },
            status: figures.status.bits(),
            e1_deg: figures.e1_rad.map(f64::to_degrees),
        }
    }
}

impl From<&BlendFigures> for BlendRecord {
    fn from(figures: &BlendFigures) -> Self {
        Self {
            after_motion: figures.motion.number(),
            gamma_deg: figures.gamma_deg,
            start_rad: figures.start_rad,
            end_rad: figures.end_rad,
            mid_rad: figures.mid_rad,
            mid_tcp_m: figures.mid_tcp_m,
            start_s: figures.start_s,
            end_s: figures.end_s,
        }
    }
}
