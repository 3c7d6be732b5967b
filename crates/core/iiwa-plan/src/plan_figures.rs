//! The figures of a plan: its times, its motions and its blends.

use std::borrow::Cow;
use std::fmt;
use std::iter::zip;

use iiwa_kin::{Joint, Robot};
use iiwa_program::Source;
use iiwa_traj::{
    BlendFigures, CartesianFigures, LateBlend, Limit, MotionFigures, Section, Timing,
    TorqueFigures, Totals, Trajectory,
};
use serde::{Deserialize, Serialize};

use crate::torque_record::{EnergyRecord, LargestTorque, PowerRecord, TorqueRecord};
use crate::{
    PlanOptions,
    rests_on::{self, AssumptionRecord},
};

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
    /// How it was timed: `sunrise`, `jerk` or `acceleration`.
    pub timing: Cow<'static, str>,
    /// The robot's name.
    pub robot: String,
    /// Samples per blend of the sweep under limits of acceleration.
    pub samples: u32,
    /// The limit of torques, in per cent of the robot's, if they were limited.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub limit_torque_percent: Option<f64>,
    /// The controller's override, in per cent, if it is not 100.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub override_percent: Option<f64>,
    /// Limits of the robot that the figures rest on and no source states.
    pub assumptions: Vec<String>,
    /// What is assumed of the controller, as far as the time rests on it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub rests_on: Vec<AssumptionRecord>,
    /// How near the arm comes to the scene, if there is one with obstacles.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub clearance: Option<ClearanceRecord>,
    /// How near the arm comes to itself, if there is a scene.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub self_clearance: Option<SelfClearanceRecord>,
    /// The work of the joints, behind the gears; none of a plan without motions, or of an earlier version.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub energy_j: Option<EnergyRecord>,
    /// The most that the joints give at once, likewise.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub power: Option<PowerRecord>,
    /// The motions of the program, in order.
    pub motions: Vec<MotionRecord>,
    /// The blends between them, in order.
    pub blends: Vec<BlendRecord>,
    /// Those before which the arm stops, since the motions after them are not known in time.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub blends_too_late: Vec<LateBlendRecord>,
}

/// A blend into a motion that is not known in time: the arm stops where it begins.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LateBlendRecord {
    /// The motion whose target it blends away, from 1.
    pub after_motion: usize,
    /// When the waits before the next motion are over, and it is known, in s.
    pub known_s: f64,
    /// By when it would have to be known for the arm not to stop, in s.
    pub needed_s: f64,
}

/// What a motion was made from.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SourceRecord {
    /// The file's name.
    pub file: String,
    /// The line, from 1.
    pub line: u32,
}

/// As compilers write it: `Welding.java:84`.
impl fmt::Display for SourceRecord {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { file, line } = self;
        write!(f, "{file}:{line}")
    }
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
    /// Its torques, behind the gears; none in a plan of an earlier version.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub torque: Option<TorqueRecord>,
    /// What it was made from, if that is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub source: Option<SourceRecord>,
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
        match (&mut self.torque, next.torque) {
            (Some(own), Some(next)) => own.go_on(&next),
            (own, next) => *own = own.take().or(next),
        }
    }
}

impl PlanFigures {
    /// The figures of a plan without any section yet. `samples` are those per blend of the sweep, as they
    /// were asked for.
    #[must_use]
    pub fn new(timing: Timing, robot: &Robot, samples: u32) -> Self {
        let used = |what: &str| match timing {
            Timing::Jerk(_) => what == "acceleration" || what == "jerk",
            Timing::Sunrise(_) => ["acceleration", "jerk", "ramps"].contains(&what),
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
            limit_torque_percent: None,
            override_percent: None,
            assumptions: robot
                .assumptions()
                .iter()
                .filter(|assumption| used(&assumption.what))
                .map(|assumption| format!("{}: {}", assumption.what, assumption.basis))
                .collect(),
            rests_on: Vec::new(),
            clearance: None,
            self_clearance: None,
            energy_j: None,
            power: None,
            motions: Vec::new(),
            blends: Vec::new(),
            blends_too_late: Vec::new(),
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
        // What was given in per cent is not to be off by a bit.
        let percent = |share: f64| (1e11 * share).round() / 1e9;
        self.limit_torque_percent = section.path().torque_limit_rel().map(percent);
        let speed_override = section.path().speed_override();
        self.override_percent = (speed_override < 1.0).then(|| percent(speed_override));
        self.cycle_time_s = totals.cycle_time_s();
        self.motion_time_s = totals.motion_time_s;
        self.settle_time_s = totals.settle_time_s;
        self.wait_time_s = totals.wait_time_s;
        let mut torques = TorqueFigures::default();
        torques.add(section);
        self.energy_j.get_or_insert_default().add(&torques);
        self.power.get_or_insert_default().add(&torques);
        // Both have the motions of the section, in order.
        let sources = section.path().sources();
        for (motion, torques) in zip(&section.motions(), &torques.motions) {
            let torque = Some(TorqueRecord::from(torques));
            let source = sources.of(motion.motion).map(SourceRecord::from);
            let motion = MotionRecord { torque, source, ..MotionRecord::from(motion) };
            match self.motions.last_mut().filter(|last| last.index == motion.index) {
                // It stopped on its way, as a spline does where its segments do not join smoothly.
                Some(last) => last.go_on(motion),
                None => self.motions.push(motion),
            }
        }
        rests_on::add(&mut self.rests_on, section, &self.timing);
        self.blends.extend(section.blends().iter().map(BlendRecord::from));
        self.blends_too_late.extend(section.late_blend().map(LateBlendRecord::from));
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

    /// The torque that is the largest share of its limit; none of figures without torques.
    ///
    /// ```
    /// use iiwa_kin::Joint;
    /// use iiwa_plan::{PlanRequest, ProgramSource};
    /// use iiwa_program::Program;
    ///
    /// let program = Program::from_deg([0.0, 90.0, 0.0, 0.0, 0.0, 0.0, 0.0]).wait_s(1.0).build();
    /// let figures = PlanRequest::default().plan(&ProgramSource::from(program))?.figures();
    /// let largest = figures.largest_torque().ok_or("no motion")?;
    /// assert_eq!(largest.joint, Joint::A2);
    /// assert_eq!(largest.to_string(), "37 % of A2's, -65.3 Nm in motion 1 at 0.000 s");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn largest_torque(&self) -> Option<LargestTorque> {
        let torques =
            self.motions.iter().filter_map(|it| Some(it.torque.as_ref()?.largest(it.index)));
        // Of the same share, the first one.
        torques.reduce(|most, next| if next.percent > most.percent { next } else { most })
    }

    /// What is to be said of torques above their limits: a line for each motion, of its worst joint.
    #[must_use]
    pub fn torque_warnings(&self) -> Vec<String> {
        /// Motions that are named, at most.
        const NAMED: usize = 10;
        let warning = |motion: &MotionRecord| {
            let what = motion.torque.as_ref()?.warning()?;
            Some(format!("motion {}: {what}", motion.index))
        };
        let mut all = self.motions.iter().filter_map(warning);
        let mut warnings: Vec<_> = all.by_ref().take(NAMED).collect();
        let more = all.count();
        if more > 0 {
            warnings.push(format!("and {more} more motions need more torque than the joints have"));
        }
        warnings
    }
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
            torque: None,
            source: None,
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

impl From<&Source> for SourceRecord {
    fn from(Source { file, line }: &Source) -> Self {
        Self { file: file.clone(), line: *line }
    }
}

impl From<&LateBlend> for LateBlendRecord {
    fn from(late: &LateBlend) -> Self {
        let LateBlend { after_motion, known_s, needed_s } = *late;
        Self { after_motion: after_motion.number(), known_s, needed_s }
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
