//! From the motions of a program to the steps of its path.

use std::{ops::Range, sync::Arc};

use iiwa_kin::{Joint, Joints, Robot, vector};

use crate::{
    circle::CircularBlend,
    continuity::Continuity,
    crossing::BlendSearch,
    fault::Fault,
    line::Line,
    motion_index::MotionIndex,
    options::{BlendShape, PathOptions},
    polynomial::{KAPPA_MIN_ACCELERATION, PolynomialBlend},
    program::{Motion, Program, Ptp},
    segment::Segment,
    step::{Corner, Step},
};

/// Shorter than this, in rad, is rounding and not motion: a tenth of a micrometre at the flange
/// is about a hundred times as much.
const NO_MOTION_RAD: f64 = 1e-9;

/// The steps of the path of `program`, which has been checked: those of the motions in `range`.
pub(crate) fn steps(
    program: &Program,
    robot: &Robot,
    options: PathOptions,
    range: Range<usize>,
) -> Result<Vec<Step>, Fault> {
    let mut steps = Builder { robot, steps: Vec::with_capacity(2 * range.len()) };
    // Where the last blend ended, or the arm stands.
    let mut from = begin(program, robot, options, range.start);
    // The target before, blended away or not: directions are taken between targets.
    let mut last_target = program.target_before(range.start);
    for (motion, entry) in program.entries().take(range.end).skip(range.start) {
        let ptp = match entry {
            Motion::Ptp(ptp) => ptp,
            Motion::Wait { seconds } => {
                steps.push(Step::Wait { motion, seconds: *seconds });
                continue;
            }
        };
        let after = || target_of(program, motion.index() + 1);
        let corner = RoundedCorner::new(robot, options.blend_search, &last_target, ptp, after);
        last_target = ptp.target_rad;
        if let Some(corner) = corner {
            steps.push_line(motion, from, corner.start());
            steps.push_blend(motion, &corner, options.blend_shape)?;
            from = corner.end();
        } else {
            steps.push_line(motion, from, ptp.target_rad);
            steps.push(Step::Settle { motion });
            from = ptp.target_rad;
        }
    }
    Ok(steps.steps)
}

/// The target of the motion at `index`, if it is one that has a target.
fn target_of(program: &Program, index: usize) -> Option<Joints> {
    match program.motions.get(index)? {
        Motion::Ptp(ptp) => Some(ptp.target_rad),
        Motion::Wait { .. } => None,
    }
}

/// Where the arm is when the motion at `index` begins: at the target of the one before, or where its blend ends.
fn begin(program: &Program, robot: &Robot, options: PathOptions, index: usize) -> Joints {
    let rounded = || {
        let Motion::Ptp(before) = &program.motions[index.checked_sub(1)?] else { return None };
        let from = program.target_before(index - 1);
        let after = || target_of(program, index);
        RoundedCorner::new(robot, options.blend_search, &from, before, after)
    };
    rounded().map_or_else(|| program.target_before(index), |corner| corner.end())
}

/// The steps of a path so far.
struct Builder<'a> {
    robot: &'a Robot,
    steps: Vec<Step>,
}

impl Builder<'_> {
    fn push(&mut self, step: Step) {
        self.steps.push(step);
    }

    fn push_line(&mut self, motion: MotionIndex, from: Joints, to: Joints) {
        let line = Line::new(from, to);
        if line.length_rad() > NO_MOTION_RAD {
            self.push(Step::Move { motion, segment: Arc::new(line), blend: None });
        }
    }

    fn push_blend(
        &mut self,
        motion: MotionIndex,
        corner: &RoundedCorner,
        shape: BlendShape,
    ) -> Result<(), Fault> {
        let gamma_deg = corner.gamma_rad().to_degrees();
        let kappa = match shape {
            BlendShape::Iiwa => self.robot.kappa(gamma_deg),
            BlendShape::MinAcceleration => KAPPA_MIN_ACCELERATION,
            BlendShape::Alpha(_) | BlendShape::Circle => 0.0,
        };
        let continuity = match shape {
            BlendShape::Alpha(continuity) => continuity,
            _ => Continuity::Second,
        };
        let segment: Arc<dyn Segment> = if corner.is_straight() {
            Arc::new(Line::new(corner.start(), corner.end()))
        } else if shape == BlendShape::Circle {
            Arc::new(CircularBlend::new(&corner.target, &corner.y0, &corner.y1, corner.reach))
        } else {
            let (d0, d1) =
                (vector::scale(corner.reach, &corner.y0), vector::scale(corner.reach, &corner.y1));
            let blend = PolynomialBlend::new(&corner.target, d0, &d1, kappa, continuity);
            self.check_position_limits(motion, corner, &blend)?;
            Arc::new(blend)
        };
        if segment.tangent_lengths_rad()[0] <= NO_MOTION_RAD {
            // A circle that turns back has no radius: it stops where it starts.
            self.push(Step::Corner { motion });
            return Ok(());
        }
        let blend = Some(Corner { motion, gamma_deg });
        self.push(Step::Move { motion: motion.next(), segment, blend });
        Ok(())
    }

    /// A blend may overshoot its ends: finds the joint that leaves its position limits.
    fn check_position_limits(
        &self,
        motion: MotionIndex,
        corner: &RoundedCorner,
        blend: &PolynomialBlend,
    ) -> Result<(), Fault> {
        let limits = self.robot.limits();
        let corners = [corner.start(), corner.target, corner.end()];
        let at_risk = Joint::ALL.into_iter().any(|joint| {
            let j = joint.index();
            let [least, greatest] =
                corners.iter().fold([f64::MAX, f64::MIN], |[least, greatest], q| {
                    [least.min(q[j]), greatest.max(q[j])]
                });
            let bound = blend.overshoot_bound(j);
            least - bound < limits.lower_rad[j] || greatest + bound > limits.upper_rad[j]
        });
        if !at_risk {
            return Ok(());
        }
        let at = |i| blend.at(f64::from(i) / f64::from(OVERSHOOT_SAMPLES)).q;
        for i in 0..=OVERSHOOT_SAMPLES {
            let Err(outside) = limits.check(&at(i)) else { continue };
            let j = outside.joint.index();
            let excess = |q: f64| (limits.lower_rad[j] - q).max(q - limits.upper_rad[j]);
            let farthest = (0..=OVERSHOOT_SAMPLES)
                .map(|i| at(i)[j])
                .fold(outside.found_rad, |a, b| if excess(b) > excess(a) { b } else { a });
            return Err(Fault::BlendOutside {
                motion,
                outside: limits.outside(outside.joint, farthest),
            });
        }
        Ok(())
    }
}

/// Samples of a blend that may overshoot. Its curve is a polynomial of degree 6 or 8, so
/// that its peak is missed by less than 1e-5 of the overshoot.
const OVERSHOOT_SAMPLES: u32 = 1024;

/// A corner that is to be rounded off, and how far on either side.
struct RoundedCorner {
    target: Joints,
    /// Unit vector of the motion into the corner (Larsen 2019, Eq. 27).
    y0: Joints,
    /// Unit vector of the motion out of the corner.
    y1: Joints,
    /// Distance in joint space from the corner to both ends of the blend, in rad.
    reach: f64,
}

impl RoundedCorner {
    /// The corner at the target of `ptp`; none if the arm stops there, because it has no blend, or
    /// one too small to count, or because one of the two motions does not move.
    fn new(
        robot: &Robot,
        search: BlendSearch,
        before: &Joints,
        ptp: &Ptp,
        after: impl FnOnce() -> Option<Joints>,
    ) -> Option<Self> {
        let blend = ptp.blend?;
        let target = ptp.target_rad;
        let after = after()?;
        let (d0, d1) = (vector::sub(&target, before), vector::sub(&after, &target));
        let (l0, l1) = (vector::norm(&d0), vector::norm(&d1));
        if l0 <= NO_MOTION_RAD || l1 <= NO_MOTION_RAD {
            return None;
        }
        let share = |other_end: &Joints| blend.share(robot, search, &target, other_end);
        // Both sides reach as far as the shorter one does (Larsen 2019, Algorithm 3).
        let reach = (share(before)? * l0).min(share(&after)? * l1);
        (reach > NO_MOTION_RAD).then(|| Self {
            target,
            y0: vector::scale(1.0 / l0, &d0),
            y1: vector::scale(1.0 / l1, &d1),
            reach,
        })
    }

    /// `theta_i0` of Larsen 2019.
    fn start(&self) -> Joints {
        vector::add_scaled(&self.target, -self.reach, &self.y0)
    }

    /// `theta_i1` of Larsen 2019.
    fn end(&self) -> Joints {
        vector::add_scaled(&self.target, self.reach, &self.y1)
    }

    fn gamma_rad(&self) -> f64 {
        vector::angle(&self.y0, &self.y1)
    }

    /// Whether the corner is none, but for rounding.
    fn is_straight(&self) -> bool {
        self.gamma_rad() <= 1e-8
    }
}
