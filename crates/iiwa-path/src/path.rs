//! From a program to the path it takes.

use std::sync::Arc;

use iiwa_kin::{Joints, Robot};

use crate::{
    circle::CircularBlend,
    crossing::BlendSearch,
    fault::Fault,
    line::Line,
    polynomial::{Continuity, KAPPA_MIN_ACCELERATION, PolynomialBlend},
    program::{Motion, Program, Ptp},
    segment::Segment,
    vector,
};

/// Shorter than this, in rad, is rounding and not motion: a tenth of a micrometre at the flange
/// is about a hundred times as much.
const NO_MOTION_RAD: f64 = 1e-9;

/// The curve of a blend.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum BlendShape {
    /// Larsen 2019, Eq. 39 with the robot's kappa(gamma), by default that of Eq. 38: what the LBR iiwa
    /// does.
    Iiwa,
    /// Larsen 2019, Eq. 13.
    Alpha(Continuity),
    /// Larsen 2019, Eq. 26 with k = 15/2.
    MinAcceleration,
    /// Larsen 2019, Eq. 32.
    Circle,
}

/// How blends are made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathOptions {
    /// Their curve.
    pub blend_shape: BlendShape,
    /// How Cartesian blends find their start and end.
    pub blend_search: BlendSearch,
}

impl Default for PathOptions {
    fn default() -> Self {
        Self { blend_shape: BlendShape::Iiwa, blend_search: BlendSearch::FirstCrossing }
    }
}

/// The path of a motion program: what the arm does, in order, without time.
///
/// ```
/// use iiwa_kin::Robot;
/// use iiwa_path::{Blend, Motion, Path, Program, Ptp};
///
/// let corner = Ptp::to([0.5, 0.3, 0.0, -1.0, 0.0, 0.7, 0.0]).blend(Blend::Fraction(0.25));
/// let end = Ptp::to([0.0, 0.6, 0.0, -1.2, 0.0, 0.4, 0.0]);
/// let program = Program {
///     robot: None,
///     start_rad: [0.0; 7],
///     motions: vec![Motion::Ptp(corner), Motion::Ptp(end)],
/// };
/// let path = Path::new(&program, &Robot::lbr_iiwa_7_r800())?;
/// assert_eq!(path.blends().count(), 1);
/// # Ok::<(), iiwa_path::Fault>(())
/// ```
///
/// A clone shares the steps: it costs next to nothing.
#[derive(Clone, Debug)]
pub struct Path {
    robot: Arc<Robot>,
    start: Joints,
    steps: Arc<Vec<Step>>,
    limits: Arc<Vec<MotionLimits>>,
}

/// One thing that the arm does. Motions count from 0.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
#[expect(clippy::large_enum_variant, reason = "nearly all steps are of the large kind")]
pub enum Step {
    /// It moves, within the limits of `motion`.
    Move {
        /// The motion whose limits hold. In a blend it is the following one: so it is for speed
        /// (Larsen 2019, Appendix B), and taken to be for the others.
        motion: usize,
        /// Where it moves.
        segment: Segment,
        /// The corner, if this is a blend.
        blend: Option<Corner>,
    },
    /// It stops and goes on at once: a corner that no blend rounds.
    Corner,
    /// It stands until it has settled, at the end of `motion` (Larsen 2019, Appendix C).
    Settle {
        /// The motion that has ended.
        motion: usize,
    },
    /// It waits.
    Wait {
        /// The wait's place in the program.
        motion: usize,
        /// For how long, in s.
        seconds: f64,
    },
}

/// What a blend rounds off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corner {
    /// The motion whose target is blended away, from 0.
    pub motion: usize,
    /// Angle between the two directions in joint space, in degrees: 0 straight on, 180 turned back
    /// (Larsen 2019, Eq. 28).
    pub gamma_deg: f64,
}

/// A motion's limits: the robot's, times the motion's shares (Larsen 2019, Eq. 33, and 35 for the
/// share of speed).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionLimits {
    /// In rad/s.
    pub velocity_rad_s: Joints,
    /// In rad/s^2.
    pub acceleration_rad_s2: Joints,
    /// In rad/s^3.
    pub jerk_rad_s3: Joints,
}

impl Path {
    /// The path of `program` on `robot`, with blends as the LBR iiwa makes them.
    ///
    /// # Errors
    ///
    /// If the program asks for something that this robot cannot do.
    pub fn new(program: &Program, robot: &Robot) -> Result<Self, Fault> {
        Self::with_options(program, robot, PathOptions::default())
    }

    /// The path of `program` on `robot`, with blends as `options` say.
    ///
    /// # Errors
    ///
    /// If the program asks for something that this robot cannot do.
    pub fn with_options(
        program: &Program,
        robot: &Robot,
        options: PathOptions,
    ) -> Result<Self, Fault> {
        program.check(robot.limits())?;
        let mut steps = Builder { robot, steps: Vec::with_capacity(2 * program.motions.len()) };
        // Where the last blend ended, or the arm stands.
        let mut from = program.start_rad;
        // The target before, blended away or not: directions are taken between targets.
        let mut last_target = program.start_rad;
        for (motion, entry) in program.motions.iter().enumerate() {
            let ptp = match entry {
                Motion::Ptp(ptp) => ptp,
                Motion::Wait { seconds } => {
                    steps.push(Step::Wait { motion, seconds: *seconds });
                    continue;
                }
            };
            let corner =
                Turn::new(robot, options.blend_search, &last_target, ptp, || {
                    match program.motions.get(motion + 1) {
                        Some(Motion::Ptp(next)) => Some(next.target_rad),
                        _ => None,
                    }
                });
            last_target = ptp.target_rad;
            if let Some(turn) = corner {
                steps.push_line(motion, from, turn.start());
                steps.push_blend(motion, &turn, options.blend_shape)?;
                from = turn.end();
            } else {
                steps.push_line(motion, from, ptp.target_rad);
                steps.push(Step::Settle { motion });
                from = ptp.target_rad;
            }
        }
        Ok(Self {
            robot: Arc::new(robot.clone()),
            start: program.start_rad,
            steps: Arc::new(steps.steps),
            limits: Arc::new(
                program.motions.iter().map(|motion| limits_of(robot, motion)).collect(),
            ),
        })
    }

    /// The robot.
    #[must_use]
    pub fn robot(&self) -> &Robot {
        &self.robot
    }

    /// Where the arm stands at first, in rad.
    #[must_use]
    pub fn start_rad(&self) -> &Joints {
        &self.start
    }

    /// What the arm does, in order.
    #[must_use]
    pub fn steps(&self) -> &[Step] {
        &self.steps
    }

    /// The limits of each entry of the program's list of motions.
    #[must_use]
    pub fn limits(&self) -> &[MotionLimits] {
        &self.limits
    }

    /// All blends, in order: the corner, and the curve that rounds it off.
    pub fn blends(&self) -> impl Iterator<Item = (&Corner, &Segment)> {
        self.steps.iter().filter_map(|step| match step {
            Step::Move { blend: Some(corner), segment, .. } => Some((corner, segment)),
            _ => None,
        })
    }
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

    fn push_line(&mut self, motion: usize, from: Joints, to: Joints) {
        let line = Line::new(from, to);
        if line.length_rad() > NO_MOTION_RAD {
            self.push(Step::Move { motion, segment: Segment::Line(line), blend: None });
        }
    }

    fn push_blend(&mut self, motion: usize, turn: &Turn, shape: BlendShape) -> Result<(), Fault> {
        let gamma_deg = turn.gamma_rad().to_degrees();
        let kappa = match shape {
            BlendShape::Iiwa => self.robot.kappa(gamma_deg),
            BlendShape::MinAcceleration => KAPPA_MIN_ACCELERATION,
            BlendShape::Alpha(_) | BlendShape::Circle => 0.0,
        };
        let continuity = match shape {
            BlendShape::Alpha(continuity) => continuity,
            _ => Continuity::Second,
        };
        let segment = if turn.is_straight() {
            Segment::Line(Line::new(turn.start(), turn.end()))
        } else if shape == BlendShape::Circle {
            Segment::Circle(CircularBlend::new(&turn.target, &turn.y0, &turn.y1, turn.reach))
        } else {
            let (d0, d1) =
                (vector::scale(turn.reach, &turn.y0), vector::scale(turn.reach, &turn.y1));
            Segment::Polynomial(PolynomialBlend::new(&turn.target, d0, &d1, kappa, continuity))
        };
        if segment.end_tangent_rad() <= NO_MOTION_RAD {
            // A circle that turns back has no radius: it stops where it starts.
            self.push(Step::Corner);
            return Ok(());
        }
        self.check_blend(motion, turn, &segment)?;
        let blend = Some(Corner { motion, gamma_deg });
        self.push(Step::Move { motion: motion + 1, segment, blend });
        Ok(())
    }

    /// A blend may swing out beyond its ends: looks for the joint that leaves its limits.
    fn check_blend(&self, motion: usize, turn: &Turn, segment: &Segment) -> Result<(), Fault> {
        let Segment::Polynomial(blend) = segment else { return Ok(()) };
        let limits = self.robot.limits();
        let corners = [turn.start(), turn.target, turn.end()];
        let at_risk = (0..7).any(|j| {
            let farthest = corners.iter().map(|q| q[j].abs()).fold(0.0, f64::max);
            farthest + blend.overshoot_bound(j) > limits.position_rad[j]
        });
        if !at_risk {
            return Ok(());
        }
        for i in 0..=SWING_SAMPLES {
            let q = blend.at(f64::from(i) / f64::from(SWING_SAMPLES)).q;
            if let Some(j) = limits.outside(&q) {
                let farthest = |farthest: f64, i| {
                    let q = blend.at(f64::from(i) / f64::from(SWING_SAMPLES)).q[j];
                    if q.abs() > farthest.abs() { q } else { farthest }
                };
                return Err(Fault::BlendOutside {
                    motion,
                    joint: j + 1,
                    found_rad: (0..=SWING_SAMPLES).fold(0.0, farthest),
                    limit_rad: limits.position_rad[j],
                });
            }
        }
        Ok(())
    }
}

/// Samples of a blend that may swing out too far. Its curve is a polynomial of degree 6 or 8, so
/// that its peak is missed by less than 1e-5 of the swing.
const SWING_SAMPLES: u32 = 1024;

fn limits_of(robot: &Robot, motion: &Motion) -> MotionLimits {
    let limits = robot.limits();
    let times = |limit: &Joints, share: &Joints| std::array::from_fn(|j| limit[j] * share[j]);
    let [velocity, acceleration, jerk] = match motion {
        Motion::Ptp(ptp) => [ptp.velocity_rel, ptp.acceleration_rel, ptp.jerk_rel],
        Motion::Wait { .. } => [[1.0; 7]; 3],
    };
    MotionLimits {
        velocity_rad_s: times(&limits.velocity_rad_s, &velocity),
        acceleration_rad_s2: times(&limits.acceleration_rad_s2, &acceleration),
        jerk_rad_s3: times(&limits.jerk_rad_s3, &jerk),
    }
}

/// A corner that is to be rounded off, and how far on either side.
struct Turn {
    target: Joints,
    y0: Joints,
    y1: Joints,
    reach: f64,
}

impl Turn {
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
