//! Evaluation of a recording in joint space: motions along lines, stops, blends.

use std::f64::consts::SQRT_2;

use iiwa_kin::{
    Joint, Joints, RampEnd,
    vector::{add_scaled, distance, dot, largest_multiple, norm, scale, sub, unit},
};
use iiwa_path::{BlendSearch, JointPath, Step};
use iiwa_program::{LimitKind, Motion, MotionIndex};
use iiwa_traj::RampStart;

use crate::identify::{
    blends::{BlendCurve, PathCorner},
    findings::Findings,
    limits::{self, Bound},
    observation::{BlendObservation, FEWEST, LEFT_SHARE, LeftOut, LineLaw, LineObservation, Why},
    ramps::{Observed, Ramps},
    soft_ramps::{SoftEnd, SoftRamps},
    soft_shape::SoftLine,
    stops::Passage,
    watched::{CornerSpace, Watched},
};

/// Share of the speed allowed by the minimum cruise time from which a top speed counts as limited
/// by that time.
const CRUISE_SHARE: f64 = 0.99;

/// Largest residual of a motion along a line, or of a blend, in rad, in addition to a share of its
/// length: the tracking error of robots.
const LEFT_RAD: f64 = 1e-3;

/// Largest residual at which constant jerk explains a motion: multiples of the noise, plus a
/// constant in rad.
const EXPLAINED_NOISE: f64 = 1.5;
const EXPLAINED_RAD: f64 = 1e-8;

/// Largest residual of ramps with constant snap, as a share of that of constant jerk, for them to
/// be accepted: filters and lag make constant jerk look softer, too.
const SNAP_SHARE: f64 = 0.5;

/// Samples of a motion along a line, with times at full override.
struct LineSamples<'a> {
    from: &'a Joints,
    direction: &'a Joints,
    motion: MotionIndex,
    t_s: &'a [f64],
    along: &'a [f64],
    length: f64,
}

impl LineSamples<'_> {
    /// Returns for both ends the direction away from rest, and the torques of an acceleration in
    /// that direction, in Nm per rad/s^2.
    fn ends(&self, path: &JointPath) -> [(RampEnd, Joints, Joints); 2] {
        let dynamics = path.dynamics(self.motion);
        [(RampEnd::Start, 1.0, 0.0), (RampEnd::Stop, -1.0, self.length)].map(|(end, sign, way)| {
            let away = scale(sign, self.direction);
            let position = add_scaled(self.from, way, self.direction);
            (end, away, dynamics.path_torques(&position, &away, &[0.0; 7]).acceleration)
        })
    }
}

/// Result of fitting a line.
struct FittedLine {
    /// Start and end times, in s.
    time_s: [Observed; 2],
    /// Top speed, acceleration and jerk, as far as the samples show them.
    figures: [Option<Observed>; 3],
    law: LineLaw,
    residual: f64,
    /// Residual of constant jerk.
    jerk_residual: f64,
    ends: Option<[SoftEnd; 2]>,
}

/// Evaluation of one recording.
pub(super) struct Observer<'a> {
    pub(super) watched: &'a Watched<'a>,
    pub(super) found: &'a mut Findings,
}

impl Observer<'_> {
    pub(super) fn observe(&mut self, passages: &[Passage]) {
        let mut before: Option<([Observed; 2], &Passage)> = None;
        for passage in passages {
            let steps = &self.watched.path.steps()[passage.steps.clone()];
            let times = if let [Step::Move { motion, blend: None, .. }] = steps {
                self.observe_line(*motion, passage)
            } else {
                self.observe_blends(passage);
                None
            };
            if let (Some(([_, last_s], stop)), Some([next_s, _])) = (before, times)
                && stop.settles > 0
            {
                let count = f64::from(stop.settles);
                let stood_s = next_s.0 - last_s.0 - stop.waits_s;
                // Ramps that are fitted too long make the stops at both ends of their motion too
                // short: each error counts in two stops.
                let deviation_s = SQRT_2 * next_s.1.hypot(last_s.1);
                self.found.settles.push((stood_s / count, deviation_s / count));
            }
            before = times.map(|times| (times, passage));
        }
    }

    fn leave_out(&mut self, motion: MotionIndex, reason: Why) {
        let recording = self.watched.recording;
        self.found.known.left_out.push(LeftOut { recording, motion, why: reason });
    }

    fn observe_line(&mut self, motion: MotionIndex, passage: &Passage) -> Option<[Observed; 2]> {
        if self.watched.is_course(motion) {
            return None;
        }
        let Passage { from, to, samples, .. } = passage;
        let way = sub(to, from);
        let (length, direction) = (norm(&way), unit(&way));
        let clock_s = &self.watched.log.t_s[samples.clone()];
        if clock_s.len() < FEWEST {
            self.leave_out(motion, Why::TooFewSamples);
            return None;
        }
        // Times at full override, from the first sample.
        let first_s = clock_s[0];
        let scaled = |at_s: &f64| (at_s - first_s) * self.watched.override_share;
        let t_s: Vec<f64> = clock_s.iter().map(scaled).collect();
        let mut beside = 0.0;
        let along: Vec<f64> = self.watched.log.q_rad[samples.clone()]
            .iter()
            .map(|q| {
                let from_start = sub(q, from);
                let along = dot(&from_start, &direction);
                beside += (dot(&from_start, &from_start) - along * along).max(0.0);
                along
            })
            .collect();
        let beside = (beside / t_s.len() as f64).sqrt();
        let line =
            LineSamples { from, direction: &direction, motion, t_s: &t_s, along: &along, length };
        let fitted = self.fit_line(&line);
        let residual = fitted.as_ref().map_or(length, |fitted| fitted.residual).hypot(beside);
        let fitted = fitted.filter(|_| residual <= LEFT_RAD + LEFT_SHARE * length);
        let Some(fitted) = fitted else {
            self.leave_out(motion, Why::NoLine(residual));
            return None;
        };
        let Motion::Ptp(ptp) = &self.watched.program.motions[motion.index()] else { return None };
        let shares = LimitKind::ALL.map(|kind| ptp.share(kind));
        let FittedLine { mut figures, law, residual, .. } = fitted;
        let min_cruise_s = self.watched.path.robot().ramp_law().least_cruise_s;
        if law == LineLaw::Snap
            && figures[0].is_some_and(|(speed, _)| speed * min_cruise_s > CRUISE_SHARE * length)
        {
            // The speed is limited by the minimum duration of the cruise, not by a joint.
            figures[0] = None;
        }
        for ((bounds, along), shares) in self.found.bounds.iter_mut().zip(figures).zip(shares) {
            bounds.extend(along.map(|along| Bound::new(along, &direction, shares)));
        }
        if let Some(ends) = fitted.ends {
            self.observe_ramps(&line, &ends);
        }
        if law == LineLaw::Snap {
            let noise_rad = self.watched.noise.along_rad(&direction);
            self.found.ramps.add_motion([residual, fitted.jerk_residual, noise_rad]);
        }
        let moving = (0..7).filter(|&j| direction[j].abs() > limits::ROUNDING);
        let real_s = |(at_s, deviation_s): Observed| {
            (
                first_s + at_s / self.watched.override_share,
                deviation_s / self.watched.override_share,
            )
        };
        let time_s = fitted.time_s.map(real_s);
        let [speed, acceleration, jerk] = figures.map(|figure| figure.map(|(value, _)| value));
        self.found.known.lines.push(LineObservation {
            recording: self.watched.recording,
            motion,
            joint: limits::only(moving).and_then(Joint::from_index),
            from_rad: *from,
            to_rad: *to,
            time_s: time_s.map(|(at_s, _)| at_s),
            speed_rad_s: speed,
            acceleration_rad_s2: acceleration,
            jerk_rad_s3: jerk,
            law,
            residual_rad: residual,
            noise_rad: self.watched.noise.along_rad(&direction),
        });
        Some(time_s)
    }

    /// Fits constant jerk to a line and, if its residual is above the noise, ramps as under
    /// Sunrise.
    fn fit_line(&self, line: &LineSamples<'_>) -> Option<FittedLine> {
        let noise_rad = self.watched.noise.along_rad(line.direction);
        let jerk = Ramps::fit(line.t_s, line.along, line.length);
        let jerk_residual = jerk.map_or(f64::INFINITY, |ramps| ramps.residual);
        let by_jerk = jerk.map(|ramps| FittedLine {
            time_s: [ramps.start_s, ramps.end_s],
            figures: [ramps.speed, ramps.acceleration, ramps.jerk],
            law: LineLaw::Jerk,
            residual: ramps.residual,
            jerk_residual,
            ends: None,
        });
        if jerk_residual <= EXPLAINED_NOISE * noise_rad + EXPLAINED_RAD {
            return by_jerk;
        }
        let (expected, middle_s) = self.expected(line, jerk.as_ref());
        let worth = SNAP_SHARE * jerk_residual;
        let enough = EXPLAINED_NOISE * noise_rad + EXPLAINED_RAD;
        let snap =
            SoftRamps::fit(line.t_s, line.along, &expected, middle_s, [enough, jerk_residual]);
        let by_snap = snap.map(|ramps| FittedLine {
            time_s: [ramps.start_s, ramps.end_s],
            figures: [ramps.speed, ramps.acceleration, None],
            law: LineLaw::Snap,
            residual: ramps.residual,
            jerk_residual,
            ends: ramps.ends,
        });
        // More parameters reduce the residual in any case.
        by_snap.filter(|fitted| fitted.residual < worth).or(by_jerk)
    }

    /// Returns the line as planned by the model with the fitted speed and acceleration, and the
    /// time of its middle.
    fn expected(&self, line: &LineSamples<'_>, fitted: Option<&Ramps>) -> (SoftLine, f64) {
        let robot = self.watched.path.robot();
        let (limits, law) = (robot.limits(), robot.ramp_law());
        let max_along = |limits| largest_multiple(line.direction, limits);
        let value_or =
            |figure: Option<Observed>, model: f64| figure.map_or(model, |(value, _)| value);
        let speed =
            value_or(fitted.and_then(|ramps| ramps.speed), max_along(&limits.velocity_rad_s));
        let speed = speed.min(line.length / law.least_cruise_s);
        let acceleration = value_or(
            fitted.and_then(|ramps| ramps.acceleration),
            max_along(&limits.acceleration_rad_s2),
        );
        let ends = line.ends(&self.watched.path).map(|(end, away, torques)| {
            RampStart::by(
                &law.limits(&away, &torques, &[1.0; 7], end),
                acceleration,
                law.width_rad_s,
            )
        });
        let width = law.width_rad_s;
        let half = line.along.iter().position(|way| *way >= 0.5 * line.length);
        let half_s = line.t_s.get(half.unwrap_or_default()).copied().unwrap_or_default();
        let middle_s = fitted.map_or(half_s, |ramps| f64::midpoint(ramps.start_s.0, ramps.end_s.0));
        (SoftLine { way: line.length, speed, acceleration, ends, width }, middle_s)
    }

    fn observe_ramps(&mut self, line: &LineSamples<'_>, line_ends: &[SoftEnd; 2]) {
        let path = &self.watched.path;
        let law = path.robot().ramp_law();
        for ((end, away, torques), line_ends) in line.ends(path).into_iter().zip(line_ends) {
            self.found.ramps.add_end(end, line_ends, &away, &torques, law);
        }
    }

    fn observe_blends(&mut self, passage: &Passage) {
        let steps = &self.watched.path.steps()[passage.steps.clone()];
        let mut from_sample = passage.samples.start;
        for (i, step) in steps.iter().enumerate() {
            let Step::Move { segment, blend: Some(corner), .. } = step else { continue };
            let (motion, gamma_deg) = (corner.motion, corner.gamma_deg);
            if self.watched.corner_space(motion) != CornerSpace::Joints {
                continue;
            }
            let kappa = self.watched.path.robot().kappa(gamma_deg);
            let Some([before, target, after]) = self.watched.corner(motion) else { continue };
            let Some(corner) = PathCorner::new(&target, &before, &after) else { continue };
            let (start, end) = (segment.at(0.0).q, segment.at(1.0).q);
            let reach_rad = distance(&target, &start);
            // The lines on either side show the start and end of the blend; the next blend must not
            // be included.
            let free = |line: Option<&Step>| match line {
                Some(Step::Move { segment, blend: None, .. }) => segment.tangent_lengths_rad()[0],
                _ => 0.0,
            };
            let margin = |line| reach_rad + free(line).min(0.5 * reach_rad);
            let before_rad = margin(i.checked_sub(1).and_then(|i| steps.get(i)));
            let after_rad = margin(steps.get(i + 1));
            let q = &self.watched.log.q_rad[from_sample..passage.samples.end];
            // The sample nearest to the middle of the blend, within the first pass near it.
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
            if curve.residual > LEFT_RAD + 5.0 * LEFT_SHARE * reach_rad {
                self.leave_out(motion, Why::NoBlend(curve.residual));
                continue;
            }
            debug_assert!((corner.gamma_deg() - gamma_deg).abs() < 1e-6);
            debug_assert!((distance(&target, &end) / reach_rad - 1.0).abs() < 1e-6);
            self.observe_reach(motion, [&before, &target, &after], &curve);
            self.found.known.blends.push(BlendObservation {
                recording: self.watched.recording,
                motion,
                gamma_deg,
                kappa: curve.kappa,
                reach_rad,
                found_reach_rad: curve.free.map(|free| free.reach.map(|(reach, _)| reach)),
                residual_rad: curve.residual,
            });
        }
    }

    /// Compares the observed start and end of a blend with those without Algorithm 3.
    fn observe_reach(&mut self, motion: MotionIndex, corner: [&Joints; 3], curve: &BlendCurve) {
        let [before, target, after] = corner;
        let (Some(free), Motion::Ptp(ptp)) =
            (curve.free, &self.watched.program.motions[motion.index()])
        else {
            return;
        };
        let planned_reach = |end: &Joints| {
            let (robot, search) = (self.watched.path.robot(), BlendSearch::FirstCrossing);
            let tcp_m = &self.watched.path.tcp(motion).position_m;
            Some(search.share(ptp.blend?, robot, tcp_m, target, end)? * distance(target, end))
        };
        if let (Some(planned_before), Some(planned_after)) =
            (planned_reach(before), planned_reach(after))
        {
            let by = planned_after - planned_before;
            // If both are equal, the observation shows nothing.
            if by.abs() > 0.1 * planned_after.max(planned_before) {
                let [fitted_before, fitted_after] = free.reach;
                let share = (fitted_after.0 - fitted_before.0) / by;
                self.found.unequal.push((share, free.difference_deviation / by.abs()));
            }
        }
    }
}
