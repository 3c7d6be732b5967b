//! Path steps from the motions of a program.

use std::{ops::Range, sync::Arc};

use iiwa_kin::{Joint, Joints, Pose, Robot, vector};

use crate::{
    cartesian::{corner::CurvedCorner, joint_curve::CurveInterval, leg::Leg, tcp_path::TcpPath},
    circle::CircularBlend,
    continuity::Continuity,
    crossing::{BlendSearch, HALF, tcp_distance_mm},
    joint_spline::{JointSpline, Sigma},
    legs::Legs,
    line::Line,
    options::{BlendShape, PathOptions},
    polynomial::PolynomialBlend,
    segment::Segment,
    step::{Corner, ShortenedBlend, SplineStop, Step},
    supervised::SupervisedSegment,
};
use iiwa_program::{Blend, Fault, Motion, MotionIndex, OperatingMode, Program};

/// Joint distance, in rad, below which a motion is rounding error: it moves the flange by about
/// 1 nm.
const NO_MOTION_RAD: f64 = 1e-9;

/// Returns the path steps of the motions in `range` of `program`, which has been checked, and whose
/// motions are `legs`.
pub(crate) fn steps(
    program: &Program,
    robot: &Arc<Robot>,
    options: PathOptions,
    legs: &Legs<'_>,
    range: Range<usize>,
) -> Result<Vec<Step>, Fault> {
    let is_t1 = program.workcell.mode == OperatingMode::T1;
    // T1 limits the TCP speed of all motions, also in programs without frames.
    let has_tcps = is_t1 || program.has_frames() || program.workcell.tool.is_some();
    let tcps = has_tcps.then(|| program.tcps()).transpose()?;
    let supervised = tcps.clone().filter(|_| is_t1);
    let corners = Corners { program, robot, options, legs, tcps };
    let mut steps = Builder { robot, supervised, steps: Vec::with_capacity(2 * range.len()) };
    // Part of the next motion that the blend before it does not replace. If `range` starts within
    // the program, that blend may lie before `range`.
    let mut remainder = match range.start.checked_sub(1) {
        Some(before) => corners.at_end_of(before)?.map(RoundedCorner::after),
        None => None,
    };
    for (motion, entry) in program.entries().take(range.end).skip(range.start) {
        let rest_s = match entry {
            // The motion before the wait ends in a blend, whose step is already there. The time
            // stamps decide if the robot stops before that blend, and for how long. Where it stops
            // in any case, the step is a wait of 0 s, which the time stamps extend.
            entry if entry.is_overlapping_wait() && steps.end_in_blend() => continue,
            entry if entry.is_overlapping_wait() => Some(0.0),
            Motion::Load(_) => Some(0.0),
            entry => entry.wait_s(),
        };
        if let Some(seconds) = rest_s {
            steps.push(Step::Wait { motion, seconds });
            continue;
        }
        let Some(leg) = legs.get(motion.index()) else { continue };
        let corner = corners.at_end_of(motion.index())?;
        let before = steps.steps.len();
        steps.push_leg(motion, &leg, remainder.as_ref(), corner.as_ref());
        match &corner {
            Some(RoundedCorner::InJoints(corner)) => {
                steps.push_blend([motion, corners.next(motion)], corner, options.blend_shape)?;
            }
            Some(RoundedCorner::Curved(corner, _)) => {
                let CurvedCorner { image, gamma_deg, shortened, .. } = corner;
                steps.check_image(motion, image)?;
                let blend = Some(Corner { motion, gamma_deg: *gamma_deg, shortened: *shortened });
                let segment = Arc::new(image.clone());
                steps.push(Step::Move {
                    motion: corners.next(motion),
                    segment,
                    blend,
                    limits: corner.limits.clone(),
                });
            }
            None => {
                // A motion without steps does not move, unless the blend before has used it up.
                let still = remainder.is_none() && steps.steps.len() == before;
                steps.push(Step::Settle { motion, blocking: entry.is_blocking(), still });
            }
        }
        remainder = corner.map(RoundedCorner::after);
    }
    Ok(steps.steps)
}

/// The remainder of a motion: the part that the blend before it does not replace.
enum MotionRemainder {
    /// A line from these joint positions, in rad.
    Line(Joints),
    /// The TCP path from this share of its first segment on.
    Path(f64),
}

/// Finder of the corners of a program that have a blend.
struct Corners<'a> {
    program: &'a Program,
    robot: &'a Arc<Robot>,
    options: PathOptions,
    legs: &'a Legs<'a>,
    /// TCPs of the motions; `None` outside T1 if the program has neither frames nor a tool.
    tcps: Option<Vec<Pose>>,
}

/// A corner with a blend.
enum RoundedCorner {
    /// A corner between two lines in joint space.
    InJoints(JointCorner),
    /// A corner with a TCP path on at least one side, and the remainder of the next motion.
    Curved(CurvedCorner, MotionRemainder),
}

impl RoundedCorner {
    /// The remainder of the motion after the blend.
    fn after(self) -> MotionRemainder {
        match self {
            Self::InJoints(corner) => MotionRemainder::Line(corner.end()),
            Self::Curved(_, remainder) => remainder,
        }
    }
}

impl Corners<'_> {
    /// Returns the first entry after a motion, except overlapping waits.
    fn next(&self, motion: MotionIndex) -> MotionIndex {
        let after = self.program.motions.iter().skip(motion.index() + 1);
        let waits = after.take_while(|entry| entry.is_overlapping_wait()).count();
        MotionIndex::new(motion.index() + 1 + waits)
    }

    /// Returns the corner at the target of a motion, or `None` if the robot stops there.
    fn at_end_of(&self, index: usize) -> Result<Option<RoundedCorner>, Fault> {
        let motion = MotionIndex::new(index);
        let Some(leg) = self.legs.get(index) else { return Ok(None) };
        let size = self.program.motions[index].blend();
        let motions = [motion, self.next(motion)];
        let (Some(size), Some(next)) = (size, self.legs.get(motions[1].index())) else {
            return Ok(None);
        };
        // The blend at a target refers to the TCP of the motion that ends there.
        let tcp_m = self.tcps.as_ref().map_or([0.0; 3], |tcps| tcps[index].position_m);
        if leg.paths.is_empty() && next.paths.is_empty() {
            let ends = [leg.ends_rad[0], leg.ends_rad[1], next.ends_rad[1]];
            let corner = size.in_joints().and_then(|blend| {
                let search = self.options.blend_search;
                JointCorner::new(self.robot, search, &tcp_m, motions, ends, blend)
            });
            return Ok(corner.map(RoundedCorner::InJoints));
        }
        let is_still = |leg: &Leg| match leg.paths.as_slice() {
            [] => vector::distance(&leg.ends_rad[0], &leg.ends_rad[1]) <= NO_MOTION_RAD,
            paths => paths.iter().all(|path| path.rate_rad <= NO_MOTION_RAD),
        };
        // A blend needs a direction on both sides.
        if is_still(&leg) || is_still(&next) {
            return Ok(None);
        }
        let corner =
            CurvedCorner::new(self.robot, self.options, &tcp_m, motions, [&*leg, &*next], &size);
        let corner = corner.map_err(|error| Fault::Cartesian {
            motion: Some(motion),
            key: "blend",
            fault: Box::new(error.in_blend()),
        })?;
        Ok(corner.map(|corner| {
            let share = corner.shares[1];
            let remainder = if next.paths.is_empty() {
                let [from, to] = next.ends_rad;
                MotionRemainder::Line(vector::add_scaled(&from, share, &vector::sub(&to, &from)))
            } else {
                MotionRemainder::Path(share)
            };
            RoundedCorner::Curved(corner, remainder)
        }))
    }
}

/// Steps of a path, built in order.
struct Builder<'a> {
    robot: &'a Arc<Robot>,
    /// TCPs of the motions in T1, where the speed of TCP and flange is limited; `None` in other
    /// operating modes.
    supervised: Option<Vec<Pose>>,
    steps: Vec<Step>,
}

impl Builder<'_> {
    fn end_in_blend(&self) -> bool {
        matches!(self.steps.last(), Some(Step::Move { blend: Some(_), .. }))
    }

    /// Adds a step. In T1, its segment also limits the speed of TCP and flange.
    fn push(&mut self, step: Step) {
        self.steps.push(match (step, &self.supervised) {
            (Step::Move { motion, segment, blend, limits }, Some(tcps)) => {
                let robot = Arc::clone(self.robot);
                let tcp = tcps[motion.index()];
                let segment = Arc::new(SupervisedSegment { inner: segment, robot, tcp });
                Step::Move { motion, segment, blend, limits }
            }
            (step, _) => step,
        });
    }

    /// Adds a motion, from the start of its remainder `before` (after a blend) to the blend at
    /// `after`.
    fn push_leg(
        &mut self,
        motion: MotionIndex,
        leg: &Leg,
        before: Option<&MotionRemainder>,
        after: Option<&RoundedCorner>,
    ) {
        let [from_rad, to_rad] = leg.ends_rad;
        if leg.paths.is_empty() {
            let from_rad = match before {
                Some(MotionRemainder::Line(from_rad)) => *from_rad,
                _ => from_rad,
            };
            let to_rad = match after {
                Some(RoundedCorner::InJoints(corner)) => corner.start(),
                Some(RoundedCorner::Curved(corner, _)) => {
                    let back = vector::sub(&leg.ends_rad[0], &to_rad);
                    vector::add_scaled(&to_rad, corner.shares[0], &back)
                }
                None => to_rad,
            };
            self.push_line(motion, from_rad, to_rad);
            return;
        }
        let last = leg.paths.len() - 1;
        for (index, path) in leg.paths.iter().enumerate() {
            let from = match before {
                // Blends reach into the first and the last segment of a spline only.
                Some(MotionRemainder::Path(share)) if index == 0 => *share,
                _ => 0.0,
            };
            let to = match after {
                Some(RoundedCorner::Curved(corner, _)) if index == last => 1.0 - corner.shares[0],
                _ => 1.0,
            };
            self.push_path(motion, path, [from, to]);
            if path.stops {
                let next = leg.paths.get(index + 1).map(|next| next.segment);
                let number = path.segment + 1;
                let place = if next == Some(path.segment) {
                    SplineStop::Within(number)
                } else {
                    SplineStop::After(number)
                };
                self.push(Step::Corner { motion, place: Some(place) });
            }
        }
    }

    /// Adds the part `range` of a TCP path, in its parameter s from 0 to 1.
    fn push_path(&mut self, motion: MotionIndex, path: &TcpPath, range: [f64; 2]) {
        let [from, to] = range;
        if (to - from) * path.rate_rad <= NO_MOTION_RAD {
            return;
        }
        let sigma = Sigma::even(path.rate_rad * (to - from));
        let image = if range == [0.0, 1.0] {
            JointSpline::clone(&path.image)
        } else {
            let curve = CurveInterval { range, curve: Arc::clone(&path.curve) };
            path.image.part(range, Arc::new(curve))
        };
        let segment = Arc::new(image.with_sigma(sigma));
        self.push(Step::Move { motion, segment, blend: None, limits: path.limits.clone() });
    }

    /// Checks a blend with a TCP path, whose curve in joint space is `image`, for joints outside
    /// their range.
    fn check_image(&self, motion: MotionIndex, image: &JointSpline) -> Result<(), Fault> {
        let limits = self.robot.limits();
        match image.outside(limits) {
            Some((joint, _, found_rad)) => {
                Err(Fault::BlendOutside { motion, outside: limits.outside(joint, found_rad) })
            }
            None => Ok(()),
        }
    }

    fn push_line(&mut self, motion: MotionIndex, from: Joints, to: Joints) {
        let line = Line::new(from, to);
        if line.length_rad() > NO_MOTION_RAD {
            self.push(Step::Move { motion, segment: Arc::new(line), blend: None, limits: None });
        }
    }

    fn push_blend(
        &mut self,
        [motion, next]: [MotionIndex; 2],
        corner: &JointCorner,
        shape: BlendShape,
    ) -> Result<(), Fault> {
        let gamma_deg = corner.gamma_rad().to_degrees();
        let kappa = shape.kappa(self.robot, gamma_deg);
        let continuity = match shape {
            BlendShape::Alpha(continuity) => continuity,
            _ => Continuity::Second,
        };
        // Straight on, the radius of a circle would be infinite.
        let segment: Arc<dyn Segment> = if corner.is_straight() {
            Arc::new(Line::new(corner.start(), corner.end()))
        } else if shape == BlendShape::Circle {
            Arc::new(CircularBlend::new(&corner.target, &corner.y0, &corner.y1, corner.reach))
        } else {
            let (d0, d1) =
                (vector::scale(corner.reach, &corner.y0), vector::scale(corner.reach, &corner.y1));
            let blend = PolynomialBlend::new(&corner.target, d0, &d1, kappa, continuity);
            // A circle needs no check: it stays in the triangle of start, target and end.
            self.check_position_limits(motion, corner, &blend)?;
            Arc::new(blend)
        };
        if segment.tangent_lengths_rad()[0] <= NO_MOTION_RAD {
            // A circular arc that turns back has radius zero: the robot stops at its start.
            self.push(Step::Corner { motion, place: None });
            return Ok(());
        }
        let blend = Some(Corner { motion, gamma_deg, shortened: corner.shortened });
        self.push(Step::Move { motion: next, segment, blend, limits: None });
        Ok(())
    }

    /// Checks a blend in joint space, which may overshoot its ends, for joints outside their range.
    fn check_position_limits(
        &self,
        motion: MotionIndex,
        corner: &JointCorner,
        blend: &PolynomialBlend,
    ) -> Result<(), Fault> {
        let limits = self.robot.limits();
        let corners = [corner.start(), corner.target, corner.end()];
        // A bound first: samples are necessary only near an end of a joint range.
        let at_risk = Joint::ALL.into_iter().any(|joint| {
            let j = joint.index();
            let [min_rad, max_rad] =
                corners.iter().fold([f64::MAX, f64::MIN], |[min_rad, max_rad], q| {
                    [min_rad.min(q[j]), max_rad.max(q[j])]
                });
            let bound = blend.overshoot_bound(j);
            min_rad - bound < limits.lower_rad[j] || max_rad + bound > limits.upper_rad[j]
        });
        if !at_risk {
            return Ok(());
        }
        let at = |i| blend.at(f64::from(i) / f64::from(OVERSHOOT_SAMPLES)).q;
        for i in 0..=OVERSHOOT_SAMPLES {
            let Err(outside) = limits.check(&at(i)) else { continue };
            let j = outside.joint.index();
            let excess = |q: f64| (limits.lower_rad[j] - q).max(q - limits.upper_rad[j]);
            // The error states the largest excess of this joint, not the first.
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

/// Samples of a blend that may overshoot. Its curve is a polynomial of degree 4, 6 or 8, so that
/// the error of the peak is less than 1e-5 of the overshoot.
const OVERSHOOT_SAMPLES: u32 = 1024;

/// A corner with a blend in joint space, and the distance that the blend reaches on either side.
struct JointCorner {
    target: Joints,
    /// Unit vector of the motion into the corner (Larsen 2019, Eq. 27).
    y0: Joints,
    /// Unit vector of the motion out of the corner.
    y1: Joints,
    /// Distance in joint space from the corner to both ends of the blend, in rad.
    reach: f64,
    shortened: Option<ShortenedBlend>,
}

impl JointCorner {
    /// Returns the corner between two motions, at the second of three targets, or `None` if the
    /// robot stops there: the blend is too small, or one of the two motions does not move.
    fn new(
        robot: &Robot,
        search: BlendSearch,
        tcp_m: &[f64; 3],
        motions: [MotionIndex; 2],
        [before, target, after]: [Joints; 3],
        blend: Blend,
    ) -> Option<Self> {
        let (d0, d1) = (vector::sub(&target, &before), vector::sub(&after, &target));
        let (l0, l1) = (vector::norm(&d0), vector::norm(&d1));
        if l0 <= NO_MOTION_RAD || l1 <= NO_MOTION_RAD {
            return None;
        }
        let share = |other_end: &Joints| search.share(blend, robot, tcp_m, &target, other_end);
        let shares = [share(&before)?, share(&after)?];
        // Both sides reach as far as the shorter one does (Larsen 2019, Algorithm 3).
        let reach = (shares[0] * l0).min(shares[1] * l1);
        let mut corner = Self {
            target,
            y0: vector::scale(1.0 / l0, &d0),
            y1: vector::scale(1.0 / l1, &d1),
            reach,
            shortened: None,
        };
        if let Blend::CartMm(asked_mm) = blend {
            let side = usize::from(shares[1] * l1 < shares[0] * l0);
            let used_mm = [corner.start(), corner.end()]
                .map(|end| tcp_distance_mm(robot, tcp_m, [&target, &end]))
                .into_iter()
                .fold(0.0, f64::max);
            corner.shortened = (shares[side] >= HALF)
                .then(|| ShortenedBlend::new(motions[side], asked_mm, used_mm))
                .flatten();
        }
        (reach > NO_MOTION_RAD).then_some(corner)
    }

    /// Start of the blend, `theta_i0` of Larsen 2019.
    fn start(&self) -> Joints {
        vector::add_scaled(&self.target, -self.reach, &self.y0)
    }

    /// End of the blend, `theta_i1` of Larsen 2019.
    fn end(&self) -> Joints {
        vector::add_scaled(&self.target, self.reach, &self.y1)
    }

    fn gamma_rad(&self) -> f64 {
        vector::angle(&self.y0, &self.y1)
    }

    /// True if the motion continues straight on, up to rounding.
    fn is_straight(&self) -> bool {
        self.gamma_rad() <= 1e-8
    }
}
