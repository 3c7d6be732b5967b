//! Figures of a plan: times, motions and blends.

use std::borrow::Cow;
use std::iter::zip;

use iiwa_kin::Robot;
use iiwa_path::JointPath;
use iiwa_program::{IoEntry, IoValue, MotionIndex, MotionLabel, Round, Source, motion_origin};
use iiwa_traj::{
    CartesianFigures, MotionFigures, Section, Timing, TorqueFigures, Totals, Trajectory,
};
use serde::{Deserialize, Serialize};

use crate::{
    PlanOptions,
    io_rows::{self, OverlapClock},
    limit_records::{
        ClearanceRecord, EnergyRecord, LargestTorque, LimitRecord, LimitShareRecord, LoadRecord,
        PowerRecord, SelfClearanceRecord, TorqueRecord,
    },
    part_records::{BlendRecord, GroupRecord, LateBlendRecord, RepeatRecord},
    rests_on::{self, AssumptionRecord, CountedAssumptions},
};

/// Figures of a plan. As JSON, this is the object of `iiwasim plan --json`; in an MCAP file, each
/// key is an entry of the metadata record `iiwasim`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlanFigures {
    /// Time from the start to the end of the last settling or waiting, in s.
    pub cycle_time_s: f64,
    /// Part of the cycle time in motion, in s.
    pub motion_time_s: f64,
    /// Part of the cycle time in which the robot settles, in s.
    pub settle_time_s: f64,
    /// Part of the cycle time in which the program waits, in s.
    pub wait_time_s: f64,
    /// Timing method: `sunrise`, `jerk` or `acceleration`.
    pub timing: Cow<'static, str>,
    /// Robot name.
    pub robot: String,
    /// Number of samples per blend in the sweep under acceleration limits.
    pub samples: u32,
    /// Torque limit, in per cent of the robot's torque limits, if any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub limit_torque_percent: Option<f64>,
    /// Override of the controller, in per cent, if not 100.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub override_percent: Option<f64>,
    /// Operating mode of the controller, `t1`, if not the automatic mode.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mode: Option<Cow<'static, str>>,
    /// Speed limit of TCP and flange in T1, in mm/s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub t1_speed_mm_s: Option<f64>,
    /// Warnings about the program and its torques, as messages for the user; of complete plans
    /// only.
    #[serde(default)]
    pub warnings: Vec<String>,
    /// Assumed robot limits that the figures depend on, for which no source gives a value (not the
    /// assumptions about the controller, which are `rests_on`).
    pub assumptions: Vec<String>,
    /// Assumptions about the controller that the cycle time depends on, as listed by `iiwasim plan
    /// --assumptions` (not the assumed robot limits, which are `assumptions`).
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub rests_on: Vec<AssumptionRecord>,
    /// Smallest distance between the arm and the scene, if there is a scene with obstacles.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub clearance: Option<ClearanceRecord>,
    /// Smallest distance of the arm from itself, if there is a scene.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub self_clearance: Option<SelfClearanceRecord>,
    /// Work of the joints on the output side of the gears; absent for a plan without motions, or of
    /// an earlier version.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub energy_j: Option<EnergyRecord>,
    /// Largest total power of the joints; absent for a plan without motions, or of an earlier
    /// version.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub power: Option<PowerRecord>,
    /// Motions and waits of the program that have a duration, and all inputs and outputs, in order.
    pub motions: Vec<MotionRecord>,
    /// Changes of the load, in order.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub loads: Vec<LoadRecord>,
    /// Groups of motions, in the order of their first motions; of complete plans only.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub groups: Vec<GroupRecord>,
    /// Repeat blocks in the order of the program, each before its inner blocks; of complete plans
    /// only.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub repeats: Vec<RepeatRecord>,
    /// Blends between the motions, in order.
    pub blends: Vec<BlendRecord>,
    /// Blends before which the robot stops because the next motion is not known in time.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub blends_too_late: Vec<LateBlendRecord>,
    /// Time of the entries that overlap motions, in the sections so far.
    #[serde(skip)]
    clock: OverlapClock,
    /// Assumptions that are counted for the last motion so far.
    #[serde(skip)]
    counted: CountedAssumptions,
}

/// A motion of the program, a wait, or an input or output.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MotionRecord {
    /// Number in the program, from 1.
    pub index: usize,
    /// Type: `ptp`, `lin`, `lin_rel`, `circ`, `spline`, `spl`, `wait`, `set` or `wait_for`.
    pub r#type: Cow<'static, str>,
    /// Name, comment and group, if the motion has any of them.
    #[serde(flatten)]
    pub label: MotionLabel,
    /// Rounds in the repeat blocks that contain the motion, the outermost block first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub rounds: Vec<Round>,
    /// Name of the output that is set, or of the input that the program waits for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub io: Option<String>,
    /// New value of the output, or the value that the input is assumed to have at the end.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub value: Option<IoValue>,
    /// Start time, in s.
    pub start_s: f64,
    /// End time, in s.
    pub end_s: f64,
    /// Top speed: the largest share of a joint's velocity limit (the robot's limit, not the
    /// motion's), 0 to 1.
    pub peak_velocity_rel: f64,
    /// Limit that is active for the longest time or, if none is active, the one that the motion
    /// approaches most closely; `None` for a wait.
    pub limited_by: Option<LimitRecord>,
    /// Active limits, with their shares of the time.
    pub limits: Vec<LimitShareRecord>,
    /// TCP figures of a motion to a frame, or of a program with a tool.
    #[serde(flatten, default, skip_serializing_if = "Option::is_none")]
    pub cartesian: Option<CartesianRecord>,
    /// Torques on the output side of the gears; absent in a plan of an earlier version.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub torque: Option<TorqueRecord>,
    /// Source line, if known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub source: Option<Source>,
}

/// TCP figures of a motion to a frame, or of a motion in a program with a tool.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CartesianRecord {
    /// Top TCP speed, in mm/s.
    pub tcp_speed_peak_mm_s: f64,
    /// Smallest distance from a singularity.
    pub singularity: SingularityRecord,
    /// Status at the end of the motion, 0 to 7.
    pub status: u8,
    /// E1, the position of A3, at the start and at the end of the motion, in deg.
    pub e1_deg: [f64; 2],
}

/// Smallest distance of the arm from a singularity.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SingularityRecord {
    /// Smallest distance, as a measure without unit: 0 at the singularity, 1 at most.
    pub least: f64,
    /// Time, in s.
    pub at_s: f64,
    /// Singular part: `shoulder`, `elbow` or `wrist`.
    pub axis: Cow<'static, str>,
}

impl MotionRecord {
    /// Number, name, source and rounds of the motion for messages, for example
    /// `motion 4 "seam" (Welding.java:84)`. A long name is shortened.
    #[must_use]
    pub fn title(&self) -> String {
        let Self { index, label, source, rounds, .. } = self;
        format!("motion {index}{}", motion_origin(label.name.as_deref(), source.as_ref(), rounds))
    }

    /// Input or output and its value, for tables and messages, for example `Gripper.Closed = true`;
    /// `None` for other entries.
    #[must_use]
    pub fn io_text(&self) -> Option<String> {
        self.io.as_deref().zip(self.value).map(|(io, value)| format!("{io} = {value}"))
    }

    /// Row of an input or output without a piece of the trajectory.
    pub(crate) fn of_io(path: &JointPath, motion: MotionIndex, entry: &IoEntry, at_s: f64) -> Self {
        Self {
            index: motion.number(),
            r#type: entry.motion_type().name().into(),
            label: path.sources().label(motion).cloned().unwrap_or_default(),
            rounds: path.sources().rounds(motion),
            io: Some(entry.io.clone()),
            value: Some(entry.value),
            start_s: at_s,
            end_s: at_s,
            peak_velocity_rel: 0.0,
            limited_by: None,
            limits: Vec::new(),
            cartesian: None,
            torque: None,
            source: path.sources().of(motion).cloned(),
        }
    }

    /// Appends the part of the motion after an intermediate stop.
    fn go_on(&mut self, next: Self) {
        let times = [self.end_s - self.start_s, next.end_s - next.start_s];
        let of_all = |share: f64, part: usize| share * times[part] / (times[0] + times[1]);
        for limit in &mut self.limits {
            limit.share = of_all(limit.share, 0);
        }
        for LimitShareRecord { limit, share } in next.limits {
            let share = of_all(share, 1);
            match self.limits.iter_mut().find(|record| record.limit == limit) {
                Some(record) => record.share += share,
                None => self.limits.push(LimitShareRecord { limit, share }),
            }
        }
        self.limits.sort_by(|a, b| b.share.total_cmp(&a.share));
        self.limited_by = self.limits.first().map(|first| first.limit.clone());
        self.end_s = next.end_s;
        self.peak_velocity_rel = self.peak_velocity_rel.max(next.peak_velocity_rel);
        self.cartesian = match (self.cartesian.take(), next.cartesian) {
            (Some(first), Some(next)) => Some(CartesianRecord {
                tcp_speed_peak_mm_s: first.tcp_speed_peak_mm_s.max(next.tcp_speed_peak_mm_s),
                singularity: if next.singularity.least < first.singularity.least {
                    next.singularity
                } else {
                    first.singularity
                },
                status: next.status,
                e1_deg: [first.e1_deg[0], next.e1_deg[1]],
            }),
            (first, next) => first.or(next),
        };
        match (&mut self.torque, next.torque) {
            (Some(first), Some(next)) => first.go_on(&next),
            (first, next) => *first = first.take().or(next),
        }
    }
}

impl PlanFigures {
    /// Figures of a plan without sections. `samples` is the requested number of samples per blend
    /// in the sweep.
    #[must_use]
    pub fn new(timing: Timing, robot: &Robot, samples: u32) -> Self {
        let used = |quantity: &str| match timing {
            Timing::Jerk(_) => quantity == "acceleration" || quantity == "jerk",
            Timing::Sunrise(_) => ["acceleration", "jerk", "ramps"].contains(&quantity),
            _ => quantity == "acceleration",
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
            mode: None,
            t1_speed_mm_s: None,
            warnings: Vec::new(),
            assumptions: robot
                .assumptions()
                .iter()
                .filter(|assumption| used(&assumption.quantity))
                .map(|assumption| format!("{}: {}", assumption.quantity, assumption.basis))
                .collect(),
            rests_on: Vec::new(),
            clearance: None,
            self_clearance: None,
            energy_j: None,
            power: None,
            motions: Vec::new(),
            loads: Vec::new(),
            groups: Vec::new(),
            repeats: Vec::new(),
            blends: Vec::new(),
            blends_too_late: Vec::new(),
            clock: OverlapClock::default(),
            counted: CountedAssumptions::default(),
        }
    }

    /// Figures of a whole trajectory planned with `options`. The changes of the load are not known:
    /// they do not belong to the trajectory.
    #[must_use]
    pub fn of(trajectory: &Trajectory, options: &PlanOptions) -> Self {
        let mut figures = Self::new(options.timing, trajectory.path().robot(), options.samples);
        trajectory.sections().iter().for_each(|section| figures.add(section));
        figures.add_groups(trajectory.path());
        figures
    }

    /// Adds up the times of groups and of repeat blocks, after the last section of `path`.
    pub fn add_groups(&mut self, path: &JointPath) {
        let motions = self.motions.iter();
        let motions =
            motions.map(|motion| (motion.label.group.as_deref(), motion.end_s - motion.start_s));
        self.groups = GroupRecord::all(motions, self.cycle_time_s);
        // The row of an input or output that delays nothing is at the start of a motion before the
        // entry: it does not show the end of that motion.
        let delays = |row: &MotionRecord| {
            let motion = MotionIndex::from_number(row.index);
            let overlaps = motion.and_then(|it| path.io(it)).is_some_and(|it| it.overlap > 0);
            row.end_s > row.start_s || !overlaps
        };
        let rows = self.motions.iter().filter(|row| delays(row));
        let rows: Vec<(usize, f64)> = rows.map(|row| (row.index, row.start_s)).collect();
        let start_s = |index: usize| {
            // Motion numbers start at 1, and some entries have no duration.
            let next = rows.partition_point(|(number, _)| *number <= index);
            rows.get(next).map_or(self.cycle_time_s, |(_, start_s)| *start_s)
        };
        self.repeats = RepeatRecord::all(path.sources().repeats(), &start_s, self.cycle_time_s);
    }

    /// Adds the next section of the trajectory.
    pub fn add(&mut self, section: &Section) {
        let mut totals = Totals {
            motion_time_s: self.motion_time_s,
            settle_time_s: self.settle_time_s,
            wait_time_s: self.wait_time_s,
        };
        totals.add(section);
        // Rounded so that a value given in per cent is reproduced exactly.
        let percent = |share: f64| (1e11 * share).round() / 1e9;
        self.limit_torque_percent = section.path().torque_limit_rel().map(percent);
        let speed_override = section.path().speed_override();
        self.override_percent = (speed_override < 1.0).then(|| percent(speed_override));
        let t1_speed_m_s = section.path().t1_speed_m_s();
        self.mode = t1_speed_m_s.map(|_| "t1".into());
        self.t1_speed_mm_s = t1_speed_m_s.map(|speed_m_s| (1e9 * speed_m_s).round() / 1e6);
        self.cycle_time_s = totals.cycle_time_s();
        self.motion_time_s = totals.motion_time_s;
        self.settle_time_s = totals.settle_time_s;
        self.wait_time_s = totals.wait_time_s;
        let mut torques = TorqueFigures::default();
        torques.add(section);
        self.energy_j.get_or_insert_default().add(&torques);
        self.power.get_or_insert_default().add(&torques);
        // `section.motions()` and `torques.motions` have the same entries in the same order.
        let sources = section.path().sources();
        for (motion, torques) in zip(&section.motions(), &torques.motions) {
            let torque = Some(TorqueRecord::from(torques));
            let source = sources.of(motion.motion).cloned();
            let label = sources.label(motion.motion).cloned().unwrap_or_default();
            let rounds = sources.rounds(motion.motion);
            let entry = section.path().io(motion.motion);
            let (io, value) = (entry.map(|entry| entry.io.clone()), entry.map(|entry| entry.value));
            let motion = MotionRecord::from(motion);
            let motion = MotionRecord { label, rounds, io, value, torque, source, ..motion };
            match self.motions.last_mut().filter(|last| last.index == motion.index) {
                // The motion stopped on its way, as a spline does where segments do not join
                // smoothly.
                Some(last) => last.go_on(motion),
                None => self.motions.push(motion),
            }
        }
        rests_on::add(&mut self.rests_on, &mut self.counted, section, &self.timing);
        self.add_io(section);
        self.blends.extend(section.blends().iter().map(BlendRecord::from));
        self.blends_too_late.extend(section.late_blend().map(LateBlendRecord::from));
    }

    /// Adds the rows of inputs and outputs without a piece of the trajectory, and the assumptions
    /// about inputs.
    fn add_io(&mut self, section: &Section) {
        let row = |motions: &[MotionRecord], motion: MotionIndex| {
            motions.binary_search_by_key(&motion.number(), |row| row.index)
        };
        let entries = io_rows::entries(section, |motion| row(&self.motions, motion).is_ok());
        for (motion, entry) in entries {
            if let Err(place) = row(&self.motions, motion) {
                let start_s = |motion| Some(self.motions[row(&self.motions, motion).ok()?].start_s);
                let at_s = io_rows::time_s(&mut self.clock, section, motion, entry, start_s);
                let record = MotionRecord::of_io(section.path(), motion, entry, at_s);
                self.motions.insert(place, record);
            }
            rests_on::add_io(&mut self.rests_on, motion, entry);
        }
    }

    /// Adds a clearance; the smallest is kept, the first of equal ones.
    pub fn add_clearance(&mut self, clearance: ClearanceRecord) {
        let nearest = self.clearance.as_ref().map(|nearest| nearest.distance_mm);
        if nearest.is_none_or(|distance_mm| clearance.distance_mm < distance_mm) {
            self.clearance = Some(clearance);
        }
    }

    /// Adds a clearance of the arm from itself; the smallest is kept, the first of equal ones.
    pub fn add_self_clearance(&mut self, clearance: SelfClearanceRecord) {
        let nearest = self.self_clearance.as_ref().map(|nearest| nearest.distance_mm);
        if nearest.is_none_or(|distance_mm| clearance.distance_mm < distance_mm) {
            self.self_clearance = Some(clearance);
        }
    }

    /// A time with the motion in which the robot is then, for messages:
    /// `at 1.250 s, in motion 4 "seam" (Welding.java:84)`.
    #[must_use]
    pub fn place_at(&self, t_s: f64) -> String {
        let moves = |row: &&MotionRecord| row.peak_velocity_rel > 0.0 && row.start_s <= t_s;
        let Some(motion) = self.motions.iter().rfind(moves) else {
            return format!("at {t_s:.3} s");
        };
        // Between a motion and the next one, the robot is at rest at the end of the first.
        let relation = if t_s <= motion.end_s { "in" } else { "at the end of" };
        format!("at {t_s:.3} s, {relation} {}", motion.title())
    }

    /// Torque with the largest share of its limit; `None` for figures without torques.
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
    /// let text = largest.to_string();
    /// assert_eq!(text, "A2 at 37 % of its limit (-65.3 Nm), in motion 1 at 0.000 s");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn largest_torque(&self) -> Option<LargestTorque> {
        let torques =
            self.motions.iter().filter_map(|it| Some(it.torque.as_ref()?.largest(it.index)));
        // Of equal shares, the first one is kept.
        torques.reduce(|largest, next| if next.percent > largest.percent { next } else { largest })
    }

    /// Warnings about torques above their limits: one line per motion, for its worst joint.
    #[must_use]
    pub fn torque_warnings(&self) -> Vec<String> {
        /// Largest number of motions that are named.
        const NAMED: usize = 10;
        let warning = |motion: &MotionRecord| {
            let message = motion.torque.as_ref()?.warning()?;
            Some(format!("{}: {message}", motion.title()))
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

impl From<&MotionFigures> for MotionRecord {
    fn from(figures: &MotionFigures) -> Self {
        Self {
            index: figures.motion.number(),
            r#type: figures.kind.name().into(),
            label: MotionLabel::default(),
            rounds: Vec::new(),
            io: None,
            value: None,
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
                least: nearest.distance,
                at_s: nearest.at_s,
                axis: nearest.part.to_string().into(),
            },
            status: figures.status.bits(),
            e1_deg: figures.e1_rad.map(f64::to_degrees),
        }
    }
}
