//! Looks at what a recording shows in joint space: motions along lines, stops, blends.

use std::f64::consts::SQRT_2;

use iiwa_kin::{
    Joint, Joints,
    vector::{distance, dot, norm, sub, unit},
};
use iiwa_path::{BlendSearch, Step};
use iiwa_program::{LimitKind, Motion, MotionIndex};

use crate::identify::{
    blends::{BlendCurve, Corner},
    findings::Findings,
    limits::{self, Bound},
    observation::{BlendObservation, FEWEST, LEFT_SHARE, LeftOut, LineObservation, Why},
    ramps::Ramps,
    stops::Passage,
    watched::{CornerSpace, Watched},
};

/// What may be left over of a motion that is taken for one along a line, or for a blend, in rad, beside a share of the
/// way: what robots lag behind.
const LEFT_RAD: f64 = 1e-3;

/// Looks at one recording.
pub(super) struct Observer<'a> {
    pub(super) watched: &'a Watched<'a>,
    pub(super) found: &'a mut Findings,
}

impl Observer<'_> {
    pub(super) fn observe(&mut self, passages: &[Passage]) {
        let mut before: Option<(Ramps, &Passage)> = None;
        for passage in passages {
            let steps = &self.watched.path.steps()[passage.steps.clone()];
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
        let recording = self.watched.recording;
        self.found.known.left_out.push(LeftOut { recording, motion, why });
    }

    fn observe_line(&mut self, motion: MotionIndex, passage: &Passage) -> Option<Ramps> {
        if self.watched.is_course(motion) {
            return None;
        }
        let Passage { from, to, samples, .. } = passage;
        let way = sub(to, from);
        let (length, direction) = (norm(&way), unit(&way));
        let t_s = &self.watched.log.t_s[samples.clone()];
        if t_s.len() < FEWEST {
            self.leave_out(motion, Why::TooFewSamples);
            return None;
        }
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
        let ramps = Ramps::fit(t_s, &along, length);
        let left = ramps.map_or(length, |ramps| ramps.residual).hypot(beside);
        let ramps = ramps.filter(|_| left <= LEFT_RAD + LEFT_SHARE * length);
        let Some(ramps) = ramps else {
            self.leave_out(motion, Why::NoLine(left));
            return None;
        };
        let Motion::Ptp(ptp) = &self.watched.program.motions[motion.index()] else { return None };
        let shares = LimitKind::ALL.map(|kind| ptp.share(kind));
        let figures = [ramps.speed, ramps.acceleration, ramps.jerk];
        for ((bounds, along), shares) in self.found.bounds.iter_mut().zip(figures).zip(shares) {
            bounds.extend(along.map(|along| Bound::new(along, &direction, shares)));
        }
        let moving = (0..7).filter(|&j| direction[j].abs() > limits::ROUNDING);
        self.found.known.lines.push(LineObservation {
            recording: self.watched.recording,
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
            let q = &self.watched.log.q_rad[from_sample..passage.samples.end];
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

    /// Where the blend would begin and end without Algorithm 3, against where it does.
    fn observe_reach(&mut self, motion: MotionIndex, corner: [&Joints; 3], curve: &BlendCurve) {
        let [before, target, after] = corner;
        let (Some(free), Motion::Ptp(ptp)) =
            (curve.free, &self.watched.program.motions[motion.index()])
        else {
            return;
        };
        let own_reach = |end: &Joints| {
            let (robot, search) = (self.watched.path.robot(), BlendSearch::FirstCrossing);
            let tcp_m = &self.watched.path.tcp(motion).position_m;
            Some(search.share(ptp.blend?, robot, tcp_m, target, end)? * distance(target, end))
        };
        if let (Some(own_before), Some(own_after)) = (own_reach(before), own_reach(after)) {
            let by = own_after - own_before;
            // Where both are equal anyway, nothing is shown.
            if by.abs() > 0.1 * own_after.max(own_before) {
                let [found_before, found_after] = free.reach;
                let share = (found_after.0 - found_before.0) / by;
                self.found.unequal.push((share, free.difference_deviation / by.abs()));
            }
        }
    }
}
