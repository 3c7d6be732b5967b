//! From recordings to the robot: limits of its joints, the time to settle, the curve of its blends.
//!
//! A recording is followed along the path of its program, from stop to stop. What is found:
//!
//! | figure | from | how |
//! |---|---|---|
//! | speed, acceleration, jerk | motions along a line from rest to rest | the seven phases of constant jerk are fitted to all samples of the motion (Larsen 2019, Appendix A differentiates) |
//! | time to settle | stops between two such motions | from the end of one to the start of the next, both as fitted (Appendix C) |
//! | kappa(gamma) | blends | Eq. 39 is fitted to the path about each corner, whatever the time; then a polynomial to kappa over gamma (section 4.3) |
//! | equal distances | blends between motions of unequal lengths | start and end are fitted too (Algorithm 3) |
//!
//! A limit is found only where a recording shows it: a speed that was kept for a time, an acceleration that
//! was, and by a joint that must have been the one that limited the motion.

mod blends;
mod limits;
mod ramps;
mod stops;

use std::f64::consts::SQRT_2;

use iiwa_kin::{
    Joint, Joints, Robot,
    vector::{distance, dot, norm, sub, unit},
};
use iiwa_log::JointLog;
use iiwa_path::{BlendSearch, JointPath, Step};
use iiwa_program::{Fault, LimitKind, Motion, MotionIndex, Program};

use crate::{
    estimate::{Estimate, Linear, Row},
    identify::{
        blends::{BlendCurve, Corner},
        limits::Bound,
        ramps::{Observed, Ramps},
        stops::{FollowedStops, Passage},
    },
};

/// A program, and what the robot did when it ran it.
#[derive(Clone, Copy, Debug)]
pub struct Recording<'a> {
    /// The program.
    pub program: &'a Program,
    /// What was recorded; before and after the program the arm may stand or do anything else.
    pub log: &'a JointLog,
}

/// Why nothing could be identified.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum IdentifyError {
    /// The program is none for this robot.
    #[error("the program cannot be planned: {fault}")]
    Program {
        /// The recording, from 0.
        recording: usize,
        /// What is wrong.
        fault: Fault,
    },
    /// The arm is never where the program begins.
    #[error(
        "the arm is never where the program starts; the nearest it comes is {:.2} deg away: is it another \
         program's recording, another robot's, or in other units?",
        .nearest_rad.to_degrees()
    )]
    NotThere {
        /// The recording, from 0.
        recording: usize,
        /// The smallest distance from the start, the norm of the joints, in rad.
        nearest_rad: f64,
    },
    /// It stands, or leaves the program, before it has done any of it.
    #[error(
        "the arm is where the program starts, but does not do its first motion: is it another program's \
         recording, another robot's, or in other units?"
    )]
    NoMotion {
        /// The recording, from 0.
        recording: usize,
    },
}

impl IdentifyError {
    /// Which recording it is about, from 0.
    #[must_use]
    pub fn recording(&self) -> usize {
        match self {
            Self::Program { recording, .. }
            | Self::NotThere { recording, .. }
            | Self::NoMotion { recording } => *recording,
        }
    }
}

/// What is known of a robot from recordings. Angles are in rad.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct Identified {
    /// Limits of speed, in rad/s, of the joints that show theirs.
    pub velocity_rad_s: [Option<Estimate>; 7],
    /// Limits of acceleration, in rad/s^2.
    pub acceleration_rad_s2: [Option<Estimate>; 7],
    /// Limits of jerk, in rad/s^3.
    pub jerk_rad_s3: [Option<Estimate>; 7],
    /// The time to settle.
    pub settle: Option<Settle>,
    /// kappa over gamma.
    pub kappa: Option<Kappa>,
    /// By what share blends begin and end where a program without Algorithm 3 would put them: 0 if they
    /// begin and end at equal distances, 1 if they do not.
    pub unequal_share: Option<Estimate>,
    /// All motions along lines.
    pub lines: Vec<LineObservation>,
    /// All blends.
    pub blends: Vec<BlendObservation>,
    /// What the recordings have that was not used, and why.
    pub left_out: Vec<LeftOut>,
}

/// The time to settle (Larsen 2019, Table 6).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settle {
    /// Its mean, in s.
    pub mean_s: Estimate,
    /// Standard deviation of the observations, in s.
    pub deviation_s: f64,
}

/// kappa as a polynomial of gamma (Larsen 2019, Eq. 38).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kappa {
    polynomial: Linear<3>,
    /// The smallest and the largest angle that was observed, in degrees.
    pub gamma_deg: [f64; 2],
    /// Root mean square of the observed kappa minus the polynomial's.
    pub residual: f64,
    /// Root mean square of the observed kappa minus that of Eq. 38.
    pub residual_of_model: f64,
}

impl Kappa {
    /// Coefficients for gamma in degrees, the constant first.
    #[must_use]
    pub fn coefficients(&self) -> &[f64; 3] {
        &self.polynomial.coefficients
    }

    /// kappa at an angle.
    #[must_use]
    pub fn at(&self, gamma_deg: f64) -> Estimate {
        self.polynomial.at(powers(gamma_deg))
    }
}

fn powers(gamma_deg: f64) -> [f64; 3] {
    [1.0, gamma_deg, gamma_deg * gamma_deg]
}

/// A motion along a line from rest to rest.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct LineObservation {
    /// The recording, from 0.
    pub recording: usize,
    /// The motion.
    pub motion: MotionIndex,
    /// The joint, if only one moves.
    pub joint: Option<Joint>,
    /// The way, in rad.
    pub from_rad: Joints,
    /// The way, in rad.
    pub to_rad: Joints,
    /// When it began and ended, in s of the recording.
    pub time_s: [f64; 2],
    /// Top speed along the way, in rad/s, if it was kept for a time.
    pub speed_rad_s: Option<f64>,
    /// Acceleration along the way, in rad/s^2, if it was kept for a time.
    pub acceleration_rad_s2: Option<f64>,
    /// Jerk along the way, in rad/s^3, if it shows.
    pub jerk_rad_s3: Option<f64>,
    /// Root mean square of what the seven phases leave over, in rad.
    pub residual_rad: f64,
}

/// A blend.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct BlendObservation {
    /// The recording, from 0.
    pub recording: usize,
    /// The motion whose target is blended away.
    pub motion: MotionIndex,
    /// Angle of the corner, in degrees.
    pub gamma_deg: f64,
    /// kappa and its standard deviation.
    pub kappa: (f64, f64),
    /// How far before and behind the target it begins and ends by the program (with Algorithm 3), in rad.
    pub reach_rad: f64,
    /// How far it does, in rad, if the samples tell.
    pub found_reach_rad: Option<[f64; 2]>,
    /// Root mean square of the samples' distances from the curve, in rad.
    pub residual_rad: f64,
}

/// A part of a recording that was not used.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeftOut {
    /// The recording, from 0.
    pub recording: usize,
    /// The motion.
    pub motion: MotionIndex,
    /// Why.
    pub why: Why,
}

/// Why a part of a recording was not used.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Why {
    /// The arm did not do it, nor anything of the program after it.
    NotFollowed,
    /// There are too few samples.
    TooFewSamples,
    /// The arm did not speed up and slow down as along a line from rest to rest; the distance left over,
    /// in rad.
    NoLine(f64),
    /// The arm did not round the corner as a blend does; the distance left over, in rad.
    NoBlend(f64),
}

impl std::fmt::Display for Why {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NotFollowed => f.write_str("the arm does not follow the program from here on"),
            Self::TooFewSamples => f.write_str("too few samples"),
            Self::NoLine(left) => write!(
                f,
                "no motion along a line from rest to rest: {:.3} deg are left over",
                left.to_degrees()
            ),
            Self::NoBlend(left) => {
                write!(f, "no blend of the iiwa's form: {:.3} deg are left over", left.to_degrees())
            }
        }
    }
}

/// Within what share of their largest figure joints may be the one that limits a motion: for each kind.
const TOLERANCES: [f64; 3] = [0.005, 0.02, 0.1];

/// What may be left over of a motion that is taken for one along a line, or for a blend, in rad: what
/// robots lag behind, and a share of the way.
const LEFT_RAD: f64 = 1e-3;
const LEFT_SHARE: f64 = 0.01;

/// No mean time is taken to be known better than to this share of the time between samples.
const TIME_SHARE: f64 = 0.01;

/// kappa is fitted if the angles differ by so much, in degrees.
const SPREAD_DEG: f64 = 45.0;

/// Least number of samples of a motion.
const FEWEST: usize = 20;

/// Identifies the robot that did what the recordings show. `model` is the robot that it is taken for: its
/// lengths and joint ranges hold.
///
/// # Errors
///
/// If a program cannot be planned for `model`, or a recording shows nothing of its program.
pub fn identify(recordings: &[Recording<'_>], model: &Robot) -> Result<Identified, IdentifyError> {
    let mut found = Findings::default();
    for (recording, Recording { program, log }) in recordings.iter().enumerate() {
        let path = JointPath::new(program, model)
            .map_err(|fault| IdentifyError::Program { recording, fault })?;
        let Some(mut followed) = stops::follow(&path, log, 0) else {
            let from_start = log.q_rad.iter().map(|q| distance(q, path.start_rad()));
            let nearest_rad = from_start.fold(f64::INFINITY, f64::min);
            return Err(IdentifyError::NotThere { recording, nearest_rad });
        };
        if followed.passages.is_empty() {
            return Err(IdentifyError::NoMotion { recording });
        }
        found.period_s = found.period_s.max(log.period_s().unwrap_or_default());
        // The program may have been run again and again.
        loop {
            let FollowedStops { passages, lost_in } = &followed;
            Observer { recording, program, path: &path, log, found: &mut found }.observe(passages);
            if let Some(motion) = *lost_in {
                found.known.left_out.push(LeftOut { recording, motion, why: Why::NotFollowed });
                break;
            }
            let from = passages.last().map_or(log.q_rad.len(), |last| last.arrives);
            match stops::follow(&path, log, from) {
                Some(again) if !again.passages.is_empty() => followed = again,
                _ => break,
            }
        }
    }
    Ok(found.conclude(model))
}

/// Observations so far.
#[derive(Default)]
struct Findings {
    known: Identified,
    bounds: [Vec<Bound>; 3],
    settles: Vec<Observed>,
    unequal: Vec<Observed>,
    /// The longest time between samples of a recording, in s.
    period_s: f64,
}

impl Findings {
    fn conclude(self, model: &Robot) -> Identified {
        let [speed, acceleration, jerk] = &self.bounds;
        let kappa = fit_kappa(&self.known.blends, model);
        Identified {
            velocity_rad_s: limits::estimate(speed, TOLERANCES[0]),
            acceleration_rad_s2: limits::estimate(acceleration, TOLERANCES[1]),
            jerk_rad_s3: limits::estimate(jerk, TOLERANCES[2]),
            settle: settle(&self.settles, self.period_s),
            kappa,
            unequal_share: Estimate::mean(&self.unequal),
            ..self.known
        }
    }
}

fn settle(observations: &[Observed], period_s: f64) -> Option<Settle> {
    let mut mean_s = Estimate::mean(observations)?;
    mean_s.uncertainty = mean_s.uncertainty.hypot(TIME_SHARE * period_s);
    let count = observations.len() as f64;
    let mean = observations.iter().map(|(seconds, _)| seconds).sum::<f64>() / count;
    let squares: f64 = observations.iter().map(|(seconds, _)| (seconds - mean).powi(2)).sum();
    Some(Settle { mean_s, deviation_s: (squares / (count - 1.0).max(1.0)).sqrt() })
}

fn fit_kappa(blends: &[BlendObservation], model: &Robot) -> Option<Kappa> {
    let rows: Vec<_> = blends
        .iter()
        .map(|blend| {
            let (value, deviation) = blend.kappa;
            Row { by: powers(blend.gamma_deg), value, deviation }
        })
        .collect();
    let angles = || blends.iter().map(|blend| blend.gamma_deg);
    let gamma_deg = [angles().fold(f64::MAX, f64::min), angles().fold(0.0, f64::max)];
    if gamma_deg[1] - gamma_deg[0] < SPREAD_DEG {
        return None;
    }
    let polynomial = Linear::fit(&rows)?;
    let mean_square = |kappa: &dyn Fn(f64) -> f64| {
        let off = |blend: &BlendObservation| (blend.kappa.0 - kappa(blend.gamma_deg)).powi(2);
        (blends.iter().map(off).sum::<f64>() / blends.len() as f64).sqrt()
    };
    Some(Kappa {
        polynomial,
        gamma_deg,
        residual: mean_square(&|gamma| polynomial.at(powers(gamma)).value),
        residual_of_model: mean_square(&|gamma| model.kappa(gamma)),
    })
}

/// Looks at one recording.
struct Observer<'a> {
    recording: usize,
    program: &'a Program,
    path: &'a JointPath,
    log: &'a JointLog,
    found: &'a mut Findings,
}

impl Observer<'_> {
    fn observe(&mut self, passages: &[Passage]) {
        let mut before: Option<(Ramps, &Passage)> = None;
        for passage in passages {
            let steps = &self.path.steps()[passage.steps.clone()];
            let ramps = if let [Step::Move { motion, blend: None, .. }] = steps {
                self.observe_line(*motion, passage)
            } else {
                self.observe_blends(passage);
                None
            };
            if let (Some((last, stop)), Some(next)) = (before, ramps)
                && stop.settles > 0
            {
                let count = f64::from(stop.settles);
                let stood_s = next.start_s.0 - last.end_s.0 - stop.waits_s;
                // Ramps that are found too long make the stops at both ends of their motion too short:
                // each error counts in two of them.
                let deviation_s = SQRT_2 * next.start_s.1.hypot(last.end_s.1);
                self.found.settles.push((stood_s / count, deviation_s / count));
            }
            before = ramps.map(|ramps| (ramps, passage));
        }
    }

    fn leave_out(&mut self, motion: MotionIndex, why: Why) {
        let recording = self.recording;
        self.found.known.left_out.push(LeftOut { recording, motion, why });
    }

    fn observe_line(&mut self, motion: MotionIndex, passage: &Passage) -> Option<Ramps> {
        let Passage { from, to, samples, .. } = passage;
        let way = sub(to, from);
        let (length, direction) = (norm(&way), unit(&way));
        let t_s = &self.log.t_s[samples.clone()];
        if t_s.len() < FEWEST {
            self.leave_out(motion, Why::TooFewSamples);
            return None;
        }
        let mut beside = 0.0;
        let along: Vec<f64> = self.log.q_rad[samples.clone()]
            .iter()
            .map(|q| {
                let from_start = sub(q, from);
                let along = dot(&from_start, &direction);
                beside += (dot(&from_start, &from_start) - along * along).max(0.0);
                along
            })
            .collect();
        let beside = (beside / t_s.len() as f64).sqrt();
        let ramps = Ramps::fit(t_s, &along, length);
        let left = ramps.map_or(length, |ramps| ramps.residual).hypot(beside);
        let ramps = ramps.filter(|_| left <= LEFT_RAD + LEFT_SHARE * length);
        let Some(ramps) = ramps else {
            self.leave_out(motion, Why::NoLine(left));
            return None;
        };
        let Motion::Ptp(ptp) = &self.program.motions[motion.index()] else { return None };
        let shares = LimitKind::ALL.map(|kind| ptp.share(kind));
        let figures = [ramps.speed, ramps.acceleration, ramps.jerk];
        for ((bounds, along), shares) in self.found.bounds.iter_mut().zip(figures).zip(shares) {
            bounds.extend(along.map(|along| Bound::new(along, &direction, shares)));
        }
        let moving = (0..7).filter(|&j| direction[j].abs() > limits::ROUNDING);
        self.found.known.lines.push(LineObservation {
            recording: self.recording,
            motion,
            joint: limits::only(moving).and_then(Joint::from_index),
            from_rad: *from,
            to_rad: *to,
            time_s: [ramps.start_s.0, ramps.end_s.0],
            speed_rad_s: ramps.speed.map(|(speed, _)| speed),
            acceleration_rad_s2: ramps.acceleration.map(|(acceleration, _)| acceleration),
            jerk_rad_s3: ramps.jerk.map(|(jerk, _)| jerk),
            residual_rad: ramps.residual,
        });
        Some(ramps)
    }

    fn observe_blends(&mut self, passage: &Passage) {
        let steps = &self.path.steps()[passage.steps.clone()];
        let mut from_sample = passage.samples.start;
        for (i, step) in steps.iter().enumerate() {
            let Step::Move { segment, blend: Some(corner), .. } = step else { continue };
            let (motion, gamma_deg) = (corner.motion, corner.gamma_deg);
            let kappa = self.path.robot().kappa(gamma_deg);
            let Some([before, target, after]) = self.corner(motion) else { continue };
            let Some(corner) = Corner::new(&target, &before, &after) else { continue };
            let (start, end) = (segment.at(0.0).q, segment.at(1.0).q);
            let reach_rad = distance(&target, &start);
            // The lines on either side show where the blend begins and ends; the next blend is not to.
            let free = |line: Option<&Step>| match line {
                Some(Step::Move { segment, blend: None, .. }) => segment.tangent_lengths_rad()[0],
                _ => 0.0,
            };
            let margin = |line| reach_rad + free(line).min(0.5 * reach_rad);
            let before_rad = margin(i.checked_sub(1).and_then(|i| steps.get(i)));
            let after_rad = margin(steps.get(i + 1));
            let q = &self.log.q_rad[from_sample..passage.samples.end];
            // Nearest to the middle of the blend, of what is near it first.
            let middle = segment.at(0.5).q;
            let near = |q: &Joints| distance(q, &middle) < reach_rad;
            let Some(first) = q.iter().position(near) else { continue };
            let last = first + q[first..].iter().take_while(|q| near(q)).count();
            let nearest = |a: &usize, b: &usize| {
                distance(&q[*a], &middle).total_cmp(&distance(&q[*b], &middle))
            };
            let Some(nearest) = (first..last).min_by(nearest) else { continue };
            let first = nearest
                - q[..nearest]
                    .iter()
                    .rev()
                    .take_while(|q| distance(q, &target) < before_rad)
                    .count();
            let last = nearest
                + q[nearest..].iter().take_while(|q| distance(q, &target) < after_rad).count();
            from_sample += nearest;
            let samples: Vec<_> = q[first..last].iter().map(|q| corner.in_plane(q)).collect();
            if samples.len() < FEWEST {
                self.leave_out(motion, Why::TooFewSamples);
                continue;
            }
            let Some(curve) = BlendCurve::fit(&corner, &samples, kappa, reach_rad) else {
                continue;
            };
            if curve.residual_rad > LEFT_RAD + 5.0 * LEFT_SHARE * reach_rad {
                self.leave_out(motion, Why::NoBlend(curve.residual_rad));
                continue;
            }
            debug_assert!((corner.gamma_deg() - gamma_deg).abs() < 1e-6);
            debug_assert!((distance(&target, &end) / reach_rad - 1.0).abs() < 1e-6);
            self.observe_reach(motion, [&before, &target, &after], &curve);
            self.found.known.blends.push(BlendObservation {
                recording: self.recording,
                motion,
                gamma_deg,
                kappa: curve.kappa,
                reach_rad,
                found_reach_rad: curve.reach_rad.map(|ends| ends.map(|(reach, _)| reach)),
                residual_rad: curve.residual_rad,
            });
        }
    }

    /// Where the blend would begin and end without Algorithm 3, against where it does.
    fn observe_reach(&mut self, motion: MotionIndex, corner: [&Joints; 3], curve: &BlendCurve) {
        let [before, target, after] = corner;
        let (Some([found_before, found_after]), Motion::Ptp(ptp)) =
            (curve.reach_rad, &self.program.motions[motion.index()])
        else {
            return;
        };
        let own_reach = |end: &Joints| {
            let (robot, search) = (self.path.robot(), BlendSearch::FirstCrossing);
            let tcp_m = &self.path.tcp(motion).position_m;
            Some(search.share(ptp.blend?, robot, tcp_m, target, end)? * distance(target, end))
        };
        if let (Some(own_before), Some(own_after)) = (own_reach(before), own_reach(after)) {
            let by = own_after - own_before;
            // Where both are equal anyway, nothing is shown.
            if by.abs() > 0.1 * own_after.max(own_before) {
                let share = (found_after.0 - found_before.0) / by;
                self.found.unequal.push((share, curve.difference_deviation_rad / by.abs()));
            }
        }
    }

    /// The targets before, at and after a corner.
    fn corner(&self, motion: MotionIndex) -> Option<[Joints; 3]> {
        let target = |index: usize| match self.program.motions.get(index)? {
            Motion::Ptp(ptp) => Some(ptp.target_rad),
            _ => None,
        };
        let index = motion.index();
        let before = (0..index).rev().find_map(target).unwrap_or(*self.path.start_rad());
        Some([before, target(index)?, target(index + 1)?])
    }
}

impl Identified {
    /// `model` with all that was found.
    #[must_use]
    pub fn robot(&self, model: &Robot) -> Robot {
        let mut limits = *model.limits();
        for (limits, found) in [
            (&mut limits.velocity_rad_s, &self.velocity_rad_s),
            (&mut limits.acceleration_rad_s2, &self.acceleration_rad_s2),
            (&mut limits.jerk_rad_s3, &self.jerk_rad_s3),
        ] {
            for (limit, found) in limits.iter_mut().zip(found) {
                *limit = found.map_or(*limit, |found| found.value);
            }
        }
        let mut robot = model.clone().with_limits(limits);
        if let Some(settle) = &self.settle {
            robot = robot.with_settle_time_s(settle.mean_s.value.max(SHORTEST_SETTLE_S));
        }
        if let Some(kappa) = &self.kappa {
            robot = robot.with_blend_kappa(*kappa.coefficients());
        }
        robot
    }
}

/// Robots that do not settle do so for this long, in s.
const SHORTEST_SETTLE_S: f64 = 0.001;
