//! Comparison of a recording with a plan: duration and path.
//!
//! **Times.** The cycle time error is that of Larsen 2019, Eq. 40: `T_s - T_r`, and its share of
//! `T_r`, with the simulated time `T_s` and the real one `T_r`. Joint positions show when the robot
//! leaves its start and when it arrives at its end, but not how long the program rests before and
//! after. Therefore `T_r` is the time from leaving the start to arriving at the end, plus the
//! planned rest at the start and at the end (settling and waits). `T_s` is the plan's cycle time.
//!
//! **Paths.** Each sample is compared with the nearest point of the planned path, regardless of
//! time: in joint space, in rad, and at the flange, in m. The nearest points are searched for in
//! the order of the path, so that a path that reverses is matched correctly.
//!
//! **Torques.** The planned torques at the matched point are subtracted from the recorded torques.
//! Planned torques include the payload and the mounting orientation of the plan, and the friction
//! of the robot. An arm that is faster or slower than planned also shows a difference, since
//! samples are matched by place and not by time.

mod curve;
mod deviation;
mod edge;
mod error;
mod follow;
mod line;
mod motion_deviation;
mod plan;
mod start_fit;
mod start_law;
mod torques;

use iiwa_log::JointLog;
use iiwa_program::{MotionIndex, MotionType};
use iiwa_traj::PieceKind;

use iiwa_kin::vector::{self, add_scaled, norm, sub};

use crate::noise::RecordingNoise;

use deviation::Deviations;
use edge::{Edge, PlannedStop, Side};
use follow::Followed;
use line::WeightedLine;
use plan::{PlanLeg, PlannedPiece};

pub use deviation::{Deviation, Location, TracePoint};
pub use error::CompareError;
pub use motion_deviation::MotionDeviation;
pub use plan::PlannedTrajectory;
pub use torques::TorqueDifference;

/// Result of comparing a recording with a plan.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Comparison {
    /// Time of the whole program.
    pub cycle_time: CycleTime,
    /// Time at which the robot leaves its start, in s, on the recording's clock.
    pub departure_s: f64,
    /// Time at which the robot arrives at its end, in s, on the recording's clock.
    pub arrival_s: f64,
    /// Motions of the program, in order.
    pub motions: Vec<MotionTime>,
    /// Stops between motions, in order.
    pub stops: Vec<StopTime>,
    /// Deviation from the path in joint space, in rad.
    pub joints_rad: Deviation,
    /// Deviation from the path of the flange, in m: the distance of the measured flange from the
    /// planned path, near the point that was matched in joint space.
    pub flange_m: Deviation,
    /// Largest path deviations of each motion, in order; motions without samples are omitted.
    pub motion_deviations: Vec<MotionDeviation>,
    /// Recorded torques compared with those of the plan, if the recording has any.
    pub torques: Option<TorqueDifference>,
    /// Number of samples between departure and arrival.
    pub samples: usize,
    /// Typical time between two samples, in s.
    pub step_s: f64,
    /// Noise of the recording: standard deviation of all joints together, in rad. It adds about
    /// this much to the path deviation.
    pub noise_rad: f64,
    /// Time at which a second run of the same program starts, in s, on the recording's clock.
    pub again_s: Option<f64>,
    /// Limitations and assumptions of the figures, as text for users.
    pub losses: Vec<String>,
    /// Subset of the samples, for plots.
    pub trace: Vec<TracePoint>,
}

impl Comparison {
    /// Splits the trace at its gaps: where samples are missing, or where samples at rest were left
    /// out of it. Returns the parts in order of time.
    pub fn unbroken_trace(&self) -> impl Iterator<Item = &[TracePoint]> {
        /// A step longer than this many typical steps is a gap.
        const GAP: f64 = 5.0;
        let mut steps: Vec<f64> =
            self.trace.windows(2).map(|pair| pair[1].measured_s - pair[0].measured_s).collect();
        let middle = steps.len() / 2;
        let usual_s = match steps.len() {
            0 => f64::INFINITY,
            _ => *steps.select_nth_unstable_by(middle, f64::total_cmp).1,
        };
        self.trace.chunk_by(move |a, b| b.measured_s - a.measured_s <= GAP * usual_s)
    }
}

/// Cycle time error (Larsen 2019, Eq. 40).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CycleTime {
    /// Simulated: the plan's cycle time, in s.
    pub simulated_s: f64,
    /// Real: from departure to arrival, plus [`standing_s`](Self::standing_s), in s.
    pub real_s: f64,
    /// Simulated minus real, in s.
    pub error_s: f64,
    /// Error in per cent of the real time.
    pub error_percent: f64,
    /// Planned rest at the start and at the end, in s; part of both times.
    pub standing_s: f64,
    /// Standard deviation of the real time due to the recording's noise, in s.
    pub deviation_s: f64,
}

/// Time of a motion, or of a wait.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionTime {
    /// Index in the program.
    pub motion: MotionIndex,
    /// Type of the motion; PTP if the plan does not state it.
    pub motion_type: MotionType,
    /// Planned start time, in s.
    pub planned_start_s: f64,
    /// Planned duration, in s, without the settle time.
    pub planned_s: f64,
    /// Time at which the robot passes the planned start, in s since the program's start; none if
    /// the recording does not show it.
    pub real_start_s: Option<f64>,
    /// Real duration, in s.
    pub real_s: Option<f64>,
    /// Planned minus real duration, in s.
    pub error_s: Option<f64>,
    /// Error in per cent of the real duration.
    pub error_percent: Option<f64>,
}

/// Duration of a rest between motions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StopTime {
    /// Motion before the rest.
    pub after_motion: MotionIndex,
    /// Planned: settling and waits, in s.
    pub planned_s: f64,
    /// Real: from arrival to departure, in s; none if the recording does not show it.
    pub real_s: Option<f64>,
}

/// Compares a recording with a plan. If the recording contains several runs or other motions, the
/// first complete pass along the path is evaluated.
///
/// Computing time is proportional to the number of samples, and memory is one number per sample.
///
/// # Errors
///
/// [`CompareError`] if there is nothing to compare, if the recording is of another program, or if
/// it does not contain the whole program.
pub fn compare(plan: &PlannedTrajectory, measured: &JointLog) -> Result<Comparison, CompareError> {
    let legs = plan.legs();
    if legs.is_empty() || plan.curve.length() <= 0.0 {
        return Err(CompareError::PlanWithoutMotion);
    }
    check(plan, measured)?;
    let noise = RecordingNoise::of(measured);
    let followed = follow::find(plan, &legs, measured, &noise)?;
    let mut losses = Vec::new();
    let timing = PassingTimes::new(plan, &legs, measured, &noise, &followed, &mut losses)?;
    let (departure, arrival) = (timing.departure, timing.arrival);

    let standing_s = plan.standing_s();
    let real_s = arrival.t_s - departure.t_s + standing_s;
    let simulated_s = plan.cycle_time_s();
    let error_s = simulated_s - real_s;
    let cycle_time = CycleTime {
        simulated_s,
        real_s,
        error_s,
        error_percent: 100.0 * error_s / real_s,
        standing_s,
        deviation_s: departure.deviation_s.hypot(arrival.deviation_s),
    };

    let from = measured.t_s.partition_point(|t_s| *t_s < departure.t_s).max(followed.first);
    let to = measured.t_s.partition_point(|t_s| *t_s <= arrival.t_s);
    let to = to.min(followed.first + followed.place_s.len()).max(from + 1);
    report_gaps(measured, from..to, &noise, &mut losses);
    let places = followed.place_s.get(from - followed.first..).unwrap_or_default();
    let deviations = deviation::deviations(plan, measured, from..to, places, departure.t_s)
        .ok_or(CompareError::TooFewSamples { samples: 0 })?;
    let Deviations { joints_rad, flange_m, motions: motion_deviations, trace } = deviations;
    Ok(Comparison {
        cycle_time,
        departure_s: departure.t_s,
        arrival_s: arrival.t_s,
        motions: timing.motions(plan),
        stops: timing.stops(plan),
        joints_rad,
        flange_m,
        motion_deviations,
        torques: torques::differences(plan, measured, from..to, places),
        samples: to - from,
        step_s: noise.step_s,
        noise_rad: noise.norm_rad(),
        again_s: followed.again_s,
        losses,
        trace,
    })
}

/// Checks that a log can be compared at all.
fn check(plan: &PlannedTrajectory, log: &JointLog) -> Result<(), CompareError> {
    let samples = log.t_s.len().min(log.q_rad.len());
    if samples < 4 || log.t_s.len() != log.q_rad.len() {
        return Err(CompareError::TooFewSamples { samples });
    }
    if let Some(measured) = log.other_robot(plan.robot()) {
        let (planned, measured) = (plan.robot().name().to_owned(), measured.to_owned());
        return Err(CompareError::OtherRobot { planned, measured });
    }
    let mut before = f64::NEG_INFINITY;
    for (i, (t_s, q)) in log.t_s.iter().zip(&log.q_rad).enumerate() {
        let bad = |fault| CompareError::BadSample { index: i + 1, fault };
        if !t_s.is_finite() || q.iter().any(|v| !v.is_finite()) {
            return Err(bad("contains a value that is not finite"));
        }
        if *t_s <= before {
            return Err(bad("is not later than the one before"));
        }
        before = *t_s;
    }
    let extent_rad = log.extent_rad();
    if extent_rad < 2e-4 {
        return Err(CompareError::NoMotion { extent_rad });
    }
    Ok(())
}

/// Reports missing samples.
fn report_gaps(
    log: &JointLog,
    samples: std::ops::Range<usize>,
    noise: &RecordingNoise,
    losses: &mut Vec<String>,
) {
    let t_s = &log.t_s[samples];
    let steps = || t_s.windows(2).map(|pair| (pair[1] - pair[0], pair[0]));
    let gaps = || steps().filter(|step| step.0 > 2.5 * noise.step_s);
    if let Some((gap_s, from_s)) = gaps().max_by(|a, b| a.0.total_cmp(&b.0)) {
        let missing: f64 = gaps().map(|gap| (gap.0 / noise.step_s).round() - 1.0).sum();
        let places = match gaps().count() {
            1 => "one place".to_owned(),
            places => format!("{places} places"),
        };
        losses.push(format!(
            "about {missing} samples of the motion are missing in {places}; the longest gap lasts \
             {gap_s:.3} s and begins at {from_s:.3} s. The path in gaps is not compared"
        ));
    }
}

/// Checks an edge at which the recording shows no rest (an edge is the instant at which the arm
/// leaves a stop or arrives at one). The sample 0.1 s before the start, or after the end, must be
/// close to the plan's start or end. A recording that is cut to the motion does not contain this
/// sample, and passes.
fn check_rest(
    plan: &PlannedTrajectory,
    log: &JointLog,
    edge: &Edge,
    name: &'static str,
) -> Result<(), CompareError> {
    let (t_s, planned) = match name {
        "start" => (edge.t_s - BEYOND_S, plan.at(0.0)),
        _ => (edge.t_s + BEYOND_S, plan.at(plan.cycle_time_s())),
    };
    let after = log.t_s.partition_point(|sample_s| *sample_s < t_s);
    let Some(q) = log.q_rad.get(after).filter(|_| after > 0) else { return Ok(()) };
    let distance_rad = vector::distance(q, &planned);
    if distance_rad > edge::REST_RAD {
        return Err(CompareError::RestElsewhere { edge: name, t_s, distance_rad });
    }
    Ok(())
}

/// Error for a rest that is recorded far from the plan's start or end.
fn rests_elsewhere(unclear: &edge::Unclear, edge: &'static str) -> Option<CompareError> {
    let (t_s, distance_rad) = unclear.rest_elsewhere?;
    Some(CompareError::RestElsewhere { edge, t_s, distance_rad })
}

/// Time beyond an edge at which the position is checked, in s.
const BEYOND_S: f64 = 0.1;

/// A gap around an edge that is longer than this, in s, hides the edge.
const EDGE_GAP_S: f64 = 0.05;

/// Times at which the robot passed the planned starts and ends of motions.
struct PassingTimes {
    departure: Edge,
    arrival: Edge,
    /// Departure and arrival of each leg (the part of the plan from one stop to the next), in s, on
    /// the recording's clock.
    legs: Vec<(PlanLeg, Option<f64>, Option<f64>)>,
    /// Transitions between motions without a stop: planned and recorded time.
    passes: Vec<(f64, Option<f64>)>,
}

impl PassingTimes {
    fn new(
        plan: &PlannedTrajectory,
        legs: &[PlanLeg],
        log: &JointLog,
        noise: &RecordingNoise,
        followed: &Followed,
        losses: &mut Vec<String>,
    ) -> Result<Self, CompareError> {
        let finder = Finder::new(plan, legs, log, noise, followed);
        let last = legs.len() - 1;
        let departure = finder.edge(0, Side::Leaves).map_err(|unclear| {
            let (t_s, distance_rad) = (unclear.t_s, unclear.distance_rad);
            rests_elsewhere(&unclear, "start")
                .unwrap_or(CompareError::BeginsInMotion { t_s, distance_rad })
        })?;
        let arrival = finder.edge(last, Side::Arrives).map_err(|unclear| {
            let (t_s, distance_rad) = (unclear.t_s, unclear.distance_rad);
            rests_elsewhere(&unclear, "end")
                .unwrap_or(CompareError::DoesNotStop { t_s, distance_rad })
        })?;
        for (edge, name) in [(&departure, "start"), (&arrival, "end")] {
            let (from_s, to_s) = edge.gap_s;
            if to_s - from_s > EDGE_GAP_S.max(noise.gap_s()) {
                return Err(CompareError::GapAtEdge { edge: name, from_s, to_s });
            }
            if to_s - from_s > noise.gap_s() {
                losses.push(format!(
                    "the recording has a gap of {:.3} s at the {name} of the motion: the time of \
                     the {name} is calculated from the samples of the motion next to the gap",
                    to_s - from_s
                ));
            }
            if edge.offset_rad > edge::REST_RAD {
                losses.push(format!(
                    "the arm is at rest {:.2} deg from the plan's {name}: the time of the {name} \
                     is determined from the position of this rest, and the path deviation contains \
                     the offset",
                    edge.offset_rad.to_degrees()
                ));
            }
            if !edge.stands {
                check_rest(plan, log, edge, name)?;
                losses.push(format!(
                    "the recording does not show the arm at rest at the {name} of the motion: the \
                     arm is assumed to rest at the plan's {name}"
                ));
            }
        }
        let mut unknown = 0;
        let mut times = Vec::with_capacity(legs.len());
        for (k, leg) in legs.iter().enumerate() {
            let mut edge = |side, edge_found: Option<&Edge>| {
                if let Some(edge) = edge_found {
                    return Some(edge.t_s);
                }
                let edge = finder.edge(k, side).ok();
                let clear = edge.filter(|edge| edge.gap_s.1 - edge.gap_s.0 <= noise.gap_s());
                unknown += usize::from(clear.is_none());
                clear.map(|edge| edge.t_s)
            };
            let leaves = edge(Side::Leaves, (k == 0).then_some(&departure));
            let arrives = edge(Side::Arrives, (k == last).then_some(&arrival));
            times.push((*leg, leaves, arrives));
        }
        let passes: Vec<_> = finder.passes();
        unknown += passes.iter().filter(|pass| pass.1.is_none()).count();
        if unknown > 0 {
            losses.push(format!(
                "{unknown} of the places where motions start and end are not clear in the \
                 recording: the times of these motions are left out"
            ));
        }
        Ok(Self { departure, arrival, legs: times, passes })
    }

    /// Returns the time at which the robot was at the planned position of a piece's start or end,
    /// in s, on the recording's clock. `starts` is true for the start of a piece.
    fn at(&self, plan_s: f64, starts: bool) -> Option<f64> {
        let same = |a: f64| (a - plan_s).abs() <= 1e-9;
        if let Some(pass) = self.passes.iter().find(|pass| same(pass.0)) {
            return pass.1;
        }
        let next = self.legs.partition_point(|(leg, ..)| leg.start_s < plan_s - 1e-9);
        match (self.legs.get(next), next.checked_sub(1).map(|before| &self.legs[before])) {
            (Some((leg, leaves, _)), None) => leaves.map(|t_s| t_s + plan_s - leg.start_s),
            (Some((leg, leaves, _)), Some((before, _, arrives))) => {
                if same(leg.start_s) {
                    // Without settle time, two legs meet.
                    return if starts || !same(before.end_s) { *leaves } else { *arrives };
                }
                let t_s = (*arrives)? + plan_s - before.end_s;
                Some(leaves.map_or(t_s, |leaves| t_s.min(leaves)))
            }
            (None, Some((before, _, arrives))) => arrives.map(|t_s| t_s + plan_s - before.end_s),
            (None, None) => None,
        }
    }

    fn motions(&self, plan: &PlannedTrajectory) -> Vec<MotionTime> {
        let (first, last) = (self.legs[0].0.start_s, self.legs[self.legs.len() - 1].0.end_s);
        let row = |pieces: &[PlannedPiece]| {
            let (start, end) = (&pieces[0], &pieces[pieces.len() - 1]);
            let planned_start_s = start.start_s;
            let planned_end_s = if end.kind == PieceKind::Settle { end.start_s } else { end.end_s };
            let waits = start.kind == PieceKind::Wait;
            // Before the first departure and after the last arrival, rests of the program cannot be
            // distinguished from rests outside the program.
            let is_recorded = !waits || (planned_start_s >= first && planned_end_s < last);
            let real = self.at(planned_start_s, true).zip(self.at(planned_end_s, false));
            let real = real.filter(|_| is_recorded);
            let planned_s = planned_end_s - planned_start_s;
            let real_s = real.map(|(from, to)| to - from);
            MotionTime {
                motion: start.motion,
                motion_type: match plan.motion_type(start.motion) {
                    moving if waits && moving.moves() => MotionType::Wait,
                    motion_type => motion_type,
                },
                planned_start_s,
                planned_s,
                real_start_s: real.map(|(from, _)| from - self.departure.t_s + first),
                real_s,
                error_s: real_s.map(|real_s| planned_s - real_s),
                error_percent: real_s
                    .filter(|real_s| *real_s > 0.0)
                    .map(|real_s| 100.0 * (planned_s - real_s) / real_s),
            }
        };
        plan.pieces.chunk_by(|a, b| a.motion == b.motion).map(row).collect()
    }

    fn stops(&self, plan: &PlannedTrajectory) -> Vec<StopTime> {
        let stop = |pair: &[(PlanLeg, Option<f64>, Option<f64>)]| StopTime {
            after_motion: plan.motion_at(pair[0].0.end_s - 1e-9),
            planned_s: pair[1].0.start_s - pair[0].0.end_s,
            real_s: pair[1].1.zip(pair[0].2).map(|(leaves, arrives)| leaves - arrives),
        };
        self.legs.windows(2).map(stop).collect()
    }
}

/// Finds the times at which the robot passed planned positions.
struct Finder<'a> {
    plan: &'a PlannedTrajectory,
    legs: &'a [PlanLeg],
    log: &'a JointLog,
    noise: &'a RecordingNoise,
    followed: &'a Followed,
    /// Length of each leg, in rad.
    lengths: Vec<f64>,
}

/// The standstill of the arm is searched for within this distance from a stop, in rad.
const ABOUT_RAD: f64 = 0.05;

impl<'a> Finder<'a> {
    fn new(
        plan: &'a PlannedTrajectory,
        legs: &'a [PlanLeg],
        log: &'a JointLog,
        noise: &'a RecordingNoise,
        followed: &'a Followed,
    ) -> Self {
        let arc = |t_s| plan.curve.arc_at(t_s);
        let lengths = legs.iter().map(|leg| arc(leg.end_s) - arc(leg.start_s)).collect();
        Self { plan, legs, log, noise, followed, lengths }
    }

    /// Returns the first sample at or beyond a planned position.
    fn sample_at(&self, plan_s: f64) -> usize {
        let places = &self.followed.place_s;
        // The place of a sample is the planned time of the path point that the sample is matched
        // to. Because of noise, it may decrease slightly from one sample to the next. The index is
        // then slightly wrong, which does not matter for a search range.
        self.followed.first + places.partition_point(|place_s| *place_s < plan_s)
    }

    /// Finds the departure or arrival of a leg.
    fn edge(&self, leg: usize, side: Side) -> Result<Edge, edge::Unclear> {
        let curve = &self.plan.curve;
        let at_s = match side {
            Side::Leaves => self.legs[leg].start_s,
            Side::Arrives => self.legs[leg].end_s,
        };
        let (leg_rad, speed_rad_s) = (self.lengths[leg], self.speed(leg));
        let before = match side {
            Side::Leaves => leg.checked_sub(1),
            Side::Arrives => Some(leg),
        };
        let after = before.map_or(0, |before| before + 1);
        let end = self.followed.first + self.followed.place_s.len();
        let reach = |leg: usize| (0.4 * self.lengths[leg]).min(ABOUT_RAD);
        let from = match before {
            None => self.pause_before(),
            Some(before) => {
                let arc = curve.arc_at(self.legs[before].end_s) - reach(before);
                self.sample_at(self.time_at_arc(arc))
            }
        };
        let to = match self.legs.get(after) {
            None => end,
            Some(next) => {
                self.sample_at(self.time_at_arc(curve.arc_at(next.start_s) + reach(after)))
            }
        };
        let end_s = before.map_or(0.0, |before| self.legs[before].end_s);
        let start_s = self.legs.get(after).map_or(self.plan.cycle_time_s(), |leg| leg.start_s);
        let stop =
            PlannedStop { curve, at_s, leg_rad, speed_rad_s, stand_s: start_s - end_s, side };
        stop.find(self.log, from..to.max(from), self.noise)
    }

    /// Returns a leg's mean planned speed, in rad/s.
    fn speed(&self, leg: usize) -> f64 {
        self.lengths[leg] / (self.legs[leg].end_s - self.legs[leg].start_s)
    }

    /// Returns the first sample that may belong to the rest before the program.
    fn pause_before(&self) -> usize {
        const BEFORE_S: f64 = 2.0;
        let first = self.followed.first;
        // At the sample `first`, the robot may already be moving, but is still close to the start.
        let away = follow::LEFT_RAD + 10.0 * self.noise.norm_rad();
        let from_s = self.log.t_s[first] - BEFORE_S - 4.0 * away / self.speed(0);
        self.log.t_s.partition_point(|t_s| *t_s < from_s)
    }

    fn time_at_arc(&self, arc_rad: f64) -> f64 {
        let curve = &self.plan.curve;
        let interval = curve.interval_at_arc(arc_rad);
        let start = &curve.knots()[interval];
        let q = add_scaled(
            &start.q,
            (arc_rad - curve.arc(interval))
                / (curve.arc(interval + 1) - curve.arc(interval)).max(1e-12),
            &sub(&curve.knots()[interval + 1].q, &start.q),
        );
        curve.refine(interval, &q, arc_rad - curve.arc(interval)).t_s
    }

    /// Returns the planned and the recorded times at which the robot passes from one motion to the
    /// next without a stop.
    fn passes(&self) -> Vec<(f64, Option<f64>)> {
        let begins = |pair: &&[PlannedPiece]| {
            let moves = pair.iter().all(|piece| piece.kind.moves());
            moves && pair[0].motion != pair[1].motion
        };
        let pairs = self.plan.pieces.windows(2).filter(begins);
        pairs.map(|pair| (pair[1].start_s, self.pass(pair[1].start_s))).collect()
    }

    /// Returns the recorded time at which the robot passes the position that is planned for
    /// `plan_s`. The time is determined with a line fit: near this position, the recorded time of a
    /// sample is almost a linear function of the planned time of the path point that the sample is
    /// matched to.
    fn pass(&self, plan_s: f64) -> Option<f64> {
        const AROUND_S: f64 = 0.008;
        const AROUND: usize = 3;
        let log = self.log;
        let (first, places) = (self.followed.first, &self.followed.place_s);
        let sample = self.sample_at(plan_s);
        let before = sample.checked_sub(1).filter(|before| *before >= first)?;
        if sample >= first + places.len() || log.t_s[sample] - log.t_s[before] > self.noise.gap_s()
        {
            return None;
        }
        let leg = self.legs.iter().find(|leg| leg.start_s <= plan_s && plan_s <= leg.end_s)?;
        let near = |i: usize| {
            let place_s = places[i - first];
            let close =
                (log.t_s[i] - log.t_s[sample]).abs() <= AROUND_S || i.abs_diff(sample) <= AROUND;
            close && leg.start_s < place_s && place_s < leg.end_s
        };
        let from = (first..sample).rev().take_while(|i| near(*i)).last().unwrap_or(sample);
        let to = (sample..first + places.len())
            .take_while(|i| near(*i))
            .last()
            .map_or(sample, |i| i + 1);
        let points = (from..to).map(|i| {
            let place_s = places[i - first];
            let speed = norm(&self.plan.curve.at(place_s).1);
            (place_s - plan_s, log.t_s[i], speed * speed)
        });
        let line = WeightedLine::fit(points)?;
        // If two motions meet at a reversal, the fitted time can be outside the interval between
        // the samples before and after the position; it is limited to this interval.
        Some(line.zero.clamp(log.t_s[before], log.t_s[sample]))
    }
}
