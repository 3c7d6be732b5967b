//! Random programs of mixed PTP motions and TCP paths: both robots and flanges, tools, bases, all
//! kinds of courses, TCP limits, and blends between all of them.
//!
//! Targets are TCP poses at joint positions near the previous ones, so that most targets are
//! reachable. Rejected motions are counted by cause, and drawn again.

use std::{collections::BTreeMap, sync::Arc};

use iiwa_kin::{Joints, Pose, Robot};
use iiwa_path::{JointPath, Step};
use iiwa_program::{
    AuxOrientation, Base, Blend, ByKind, CartesianFault, CartesianMotion, Circ, Course, Fault,
    Frame, Motion, OrientationType, PathBlend, Program, Ptp, SegmentCourse, SegmentLimits, Sources,
    SplineSegment, Start, Target, TargetRef, Tool, ToolLimits, Workcell,
};

use crate::families::dice::Dice;

/// Program, its robot, and the rejected draws before it.
#[derive(Clone, Debug)]
pub struct TcpProgram {
    /// Robot model.
    pub robot: Robot,
    /// Program that is feasible for the robot.
    pub program: Program,
    /// Number of rejected motions or blends, by cause.
    pub refused: BTreeMap<&'static str, usize>,
}

/// Base of all frames and other bases.
pub const ROOT: &str = "root";
/// Another base, in [`ROOT`].
const TABLE: &str = "table";
/// Tool of the program.
const GRIPPER: &str = "gripper";
/// Another TCP of the tool.
const TIP: &str = "gripper/tip";

/// Maximum number of motions of a program.
const MAX_MOTIONS: usize = 8;

/// Returns program number `index` of a `seed`.
#[must_use]
pub fn tcp_program(seed: u64, index: u64) -> TcpProgram {
    let mut dice = Dice::new(seed, "tcp", index);
    let mut refused = BTreeMap::new();
    loop {
        let robot = robot(&mut dice);
        let program = draw(&mut dice, &robot, &mut refused);
        match JointPath::new(&program, &robot) {
            Ok(_) => return TcpProgram { robot, program, refused },
            Err(fault) => *refused.entry(cause(&fault)).or_default() += 1,
        }
    }
}

/// Returns a program with a single motion, `lin` or `circ`, which may be infeasible.
#[must_use]
pub fn single_path(seed: u64, index: u64, is_circ: bool) -> (Robot, Program) {
    let mut dice = Dice::new(seed, if is_circ { "circ" } else { "lin" }, index);
    let robot = robot(&mut dice);
    let start_rad = clear_pose(&mut dice);
    let mut program = program(&mut dice, start_rad);
    let size = dice.log(0.05, 1.5);
    let way = Way { robot: &robot, program: &program, from_rad: start_rad, size };
    let motion = if is_circ { way.circ(&mut dice) } else { way.lin(&mut dice) };
    program.motions.push(Motion::Cartesian(Box::new(motion)));
    (robot, program)
}

/// Returns a short name of the fault.
#[must_use]
pub fn cause(fault: &Fault) -> &'static str {
    match fault {
        Fault::BlendOutside { .. } => "blend outside",
        Fault::JointOutside { .. } => "target outside",
        Fault::Cartesian { fault, key, .. } => match (innermost(fault), *key) {
            (_, "blend") => "blend not reached or singular",
            (CartesianFault::Unreachable(_), _) => "target unreachable",
            (CartesianFault::Outside { .. }, _) => "frame outside",
            (CartesianFault::UnreachableOnTheWay { .. }, _) => "unreachable on the way",
            (CartesianFault::OutsideOnTheWay { .. }, _) => "outside on the way",
            (CartesianFault::Singular { .. }, _) => "singular",
            (CartesianFault::Course(_), _) => "no course",
            _ => "other",
        },
        _ => "other",
    }
}

/// Returns the fault within a spline segment, otherwise that of the motion.
fn innermost(fault: &CartesianFault) -> &CartesianFault {
    match fault {
        CartesianFault::Segment { fault, .. } => innermost(fault),
        fault => fault,
    }
}

fn robot(dice: &mut Dice) -> Robot {
    let robot = if dice.percent(50) { Robot::lbr_iiwa_7_r800() } else { Robot::lbr_iiwa_14_r820() };
    let flange_m = if dice.percent(50) { 0.126 } else { 0.152 };
    robot.clone().with_flange_m(flange_m).unwrap_or(robot)
}

/// Returns a pose away from singularities.
fn clear_pose(dice: &mut Dice) -> Joints {
    let sign = |dice: &mut Dice| if dice.percent(50) { 1.0 } else { -1.0 };
    let [a2, a4, a6] = [0.15..1.2, 0.5..1.8, 0.4..1.7]
        .map(|range: std::ops::Range<f64>| sign(dice) * dice.between(range.start, range.end));
    let mut any = || dice.between(-1.6, 1.6);
    [any(), a2, 0.6 * any(), a4, any(), a6, any()]
}

fn frame(dice: &mut Dice, most_mm: f64, most_rad: f64) -> Frame {
    let mut three = |reach: f64| std::array::from_fn(|_| dice.between(-reach, reach));
    Frame { xyz_mm: three(most_mm), abc_rad: three(most_rad) }
}

/// Returns a program without motions.
fn program(dice: &mut Dice, start_rad: Joints) -> Program {
    let tcp = if dice.percent(30) { Frame::default() } else { frame(dice, 150.0, 1.5) };
    let tip = frame(dice, 100.0, 0.5);
    let tool = Tool { tcp, tips: [("tip".to_owned(), tip)].into(), load: None };
    let root = Base::default();
    let table = Base { frame: frame(dice, 600.0, 2.0), base: Some(ROOT.to_owned()) };
    Program {
        robot: None,
        start: Start::Joints(start_rad),
        motions: Vec::new(),
        workcell: Workcell {
            tools: [(GRIPPER.to_owned(), tool)].into(),
            bases: [(ROOT.to_owned(), root), (TABLE.to_owned(), table)].into(),
            tool: Some(GRIPPER.to_owned()),
            base: Some(ROOT.to_owned()),
            ..Workcell::default()
        },
        sources: Sources::default(),
    }
}

fn draw(dice: &mut Dice, robot: &Robot, refused: &mut BTreeMap<&'static str, usize>) -> Program {
    let mut at_rad = clear_pose(dice);
    let mut program = program(dice, at_rad);
    let count = dice.count(1, MAX_MOTIONS);
    while program.motions.len() < count {
        if dice.percent(3) {
            program.motions.push(Motion::Wait { seconds: dice.between(0.0, 0.5), overlap: 0 });
            continue;
        }
        let size = dice.log(0.01, 0.8);
        let way = Way { robot, program: &program, from_rad: at_rad, size };
        let motion = way.motion(dice);
        let alone = Program {
            start: Start::Joints(at_rad),
            motions: vec![motion.clone()],
            ..program.clone()
        };
        match JointPath::new(&alone, robot) {
            Ok(path) => {
                at_rad = end_rad(&path);
                program.motions.push(motion);
            }
            Err(fault) => *refused.entry(cause(&fault)).or_default() += 1,
        }
    }
    for i in 0..count {
        let goes_on =
            program.motions.get(i + 1).is_some_and(|next| !matches!(next, Motion::Wait { .. }));
        if goes_on && dice.percent(75) {
            match &mut program.motions[i] {
                Motion::Ptp(ptp) => ptp.blend = Some(joint_blend(dice)),
                Motion::Cartesian(cartesian) if cartesian.is_ptp() => {
                    cartesian.blend = Some(joint_blend(dice).into());
                }
                Motion::Cartesian(cartesian) => cartesian.blend = Some(path_blend(dice)),
                Motion::Wait { .. } | Motion::Load(_) | Motion::Io(_) => {}
            }
        }
    }
    program
}

/// Returns the end of a path, in rad.
#[must_use]
pub fn end_rad(path: &JointPath) -> Joints {
    let last = path.steps().iter().rev().find_map(|step| match step {
        Step::Move { segment, .. } => Some(Arc::clone(segment)),
        _ => None,
    });
    last.map_or(*path.start_rad(), |segment| segment.at(1.0).q)
}

fn joint_blend(dice: &mut Dice) -> Blend {
    match dice.count(0, 3) {
        0 => Blend::Fraction(0.5),
        1 => Blend::Fraction(dice.between(0.0, 0.5)),
        _ => Blend::CartMm(dice.log(2.0, 300.0)),
    }
}

fn path_blend(dice: &mut Dice) -> PathBlend {
    let cart_mm = dice.percent(70).then(|| dice.log(2.0, 300.0));
    let orientation_rad = (cart_mm.is_none() || dice.percent(25)).then(|| dice.log(0.01, 1.0));
    let sunrise_rel = dice.percent(10).then(|| dice.between(0.0, 1.0));
    PathBlend { cart_mm, orientation_rad, sunrise_rel, fraction: None }
}

/// Returns random TCP limits.
fn tool_limits(dice: &mut Dice) -> ToolLimits {
    let mut any =
        |percent: u8, ranges: [[f64; 2]; 3]| {
            let limits = ranges.map(|[lower, upper]| {
                if dice.percent(percent) { dice.log(lower, upper) } else { f64::INFINITY }
            });
            ByKind::from_array(limits)
        };
    ToolLimits {
        way: any(35, [[0.02, 2.0], [0.1, 20.0], [1.0, 500.0]]),
        turn: any(20, [[0.1, 5.0], [0.5, 50.0], [5.0, 1000.0]]),
    }
}

/// Returns separate limits of a segment, with a probability of a quarter.
fn segment_limits(dice: &mut Dice) -> SegmentLimits {
    if !dice.percent(25) {
        return SegmentLimits::default();
    }
    let shares = ByKind::from_fn(|_| dice.percent(30).then(|| [dice.between(0.1, 1.0); 7]));
    SegmentLimits { shares, tool: tool_limits(dice) }
}

/// Context of a random motion, from the current pose of the arm.
struct Way<'a> {
    robot: &'a Robot,
    program: &'a Program,
    from_rad: Joints,
    /// Joint displacement, in rad.
    size: f64,
}

impl Way<'_> {
    fn motion(&self, dice: &mut Dice) -> Motion {
        let path = match dice.count(0, 99) {
            0..15 => {
                let [velocity_rel, acceleration_rel, jerk_rel] = shares(dice).into_array();
                let target_rad = self.near(dice, true);
                let ptp = Ptp { velocity_rel, acceleration_rel, jerk_rel, ..Ptp::to(target_rad) };
                return Motion::Ptp(ptp);
            }
            15..30 => {
                let mut ptp = Self::unlimited(dice);
                let to_rad = self.near(dice, true);
                ptp.course = Course::Ptp { to: self.target(dice, &ptp, &to_rad, true) };
                return Motion::Cartesian(Box::new(ptp));
            }
            30..55 => self.lin(dice),
            55..70 => self.lin_rel(dice),
            70..78 => self.null_space(dice),
            78..88 => self.circ(dice),
            _ => self.spline(dice),
        };
        Motion::Cartesian(Box::new(path))
    }

    /// Returns joint positions near the start of the motion, within the joint ranges; with the same
    /// E1 unless `swing`.
    fn near(&self, dice: &mut Dice, swing: bool) -> Joints {
        let step = dice.joints(|dice| dice.between(-1.0, 1.0));
        let near: Joints = std::array::from_fn(|j| self.from_rad[j] + self.size * step[j]);
        let mut near = self.robot.limits().clamp(&near);
        if !swing {
            near[2] = self.from_rad[2];
        }
        near
    }

    /// Returns a motion with relative limits, tool and base, without a course.
    fn unlimited(dice: &mut Dice) -> CartesianMotion {
        let tool = dice.percent(10).then(|| if dice.percent(50) { TIP } else { "flange" });
        let base = dice.percent(30).then(|| TABLE.to_owned());
        CartesianMotion {
            tool: tool.map(str::to_owned),
            base,
            shares: shares(dice),
            ..CartesianMotion::new(Course::Lin { to: Frame::default().into() })
        }
    }

    /// Returns a motion with TCP limits and a law of orientation, without a course.
    fn path(dice: &mut Dice) -> CartesianMotion {
        let tool_limits = tool_limits(dice);
        let orientation =
            if dice.percent(20) { OrientationType::Constant } else { OrientationType::Variable };
        CartesianMotion { tool_limits, orientation, ..Self::unlimited(dice) }
    }

    /// Returns the TCP of a motion at joint positions, in the robot base.
    fn tcp(&self, motion: &CartesianMotion, joints_rad: &Joints) -> Pose {
        let tcp = self.program.workcell.tcp(motion.tool.as_deref()).unwrap_or(Pose::IDENTITY);
        self.robot.flange_pose(joints_rad).then(&tcp)
    }

    /// Converts a pose in the robot base to a target in the motion's base.
    fn at(&self, motion: &CartesianMotion, pose: &Pose) -> Target {
        let base = self.program.workcell.base(motion.base.as_deref()).unwrap_or(Pose::IDENTITY);
        Target::at(Frame::from(&base.inverse().then(pose)))
    }

    /// Returns the TCP pose at joint positions, as a target.
    fn target(
        &self,
        dice: &mut Dice,
        motion: &CartesianMotion,
        joints_rad: &Joints,
        with_e1: bool,
    ) -> TargetRef {
        let target = self.at(motion, &self.tcp(motion, joints_rad));
        let redundancy = self.robot.redundancy(joints_rad);
        let settled = with_e1 || dice.percent(10);
        TargetRef::Given(Target {
            e1_rad: settled.then_some(redundancy.e1_rad),
            status: with_e1.then_some(redundancy.status),
            ..target
        })
    }

    fn lin(&self, dice: &mut Dice) -> CartesianMotion {
        let path = Self::path(dice);
        let swing = dice.percent(25);
        let to_rad = self.near(dice, swing);
        let to = self.target(dice, &path, &to_rad, swing);
        CartesianMotion { course: Course::Lin { to }, ..path }
    }

    fn lin_rel(&self, dice: &mut Dice) -> CartesianMotion {
        let path = Self::path(dice);
        let [from, to] =
            [self.from_rad, self.near(dice, false)].map(|joints| self.tcp(&path, &joints));
        let course = if dice.percent(50) {
            let offset = Frame::from(&from.inverse().then(&to));
            Course::LinRel { offset, e1_rad: None, within: None }
        } else {
            let turned = |pose: &Pose| Pose { position_m: [0.0; 3], ..*pose };
            let axes = turned(&frame(dice, 0.0, 2.0).pose());
            let by = Pose {
                position_m: std::array::from_fn(|i| to.position_m[i] - from.position_m[i]),
                rotation: turned(&to).then(&turned(&from).inverse()).rotation,
            };
            let offset = Frame::from(&axes.inverse().then(&by).then(&axes));
            let within = Some(TargetRef::Given(self.at(&path, &axes)));
            Course::LinRel { offset, e1_rad: None, within }
        };
        CartesianMotion { course, ..path }
    }

    /// Returns a null-space motion, with the TCP at rest.
    fn null_space(&self, dice: &mut Dice) -> CartesianMotion {
        let path = Self::path(dice);
        let by = self.size * dice.between(-1.0, 1.0);
        let start = self.at(&path, &self.tcp(&path, &self.from_rad));
        let to = Target { e1_rad: Some(self.from_rad[2] + by), ..start };
        CartesianMotion { course: Course::Lin { to: TargetRef::Given(to) }, ..path }
    }

    fn circ(&self, dice: &mut Dice) -> CartesianMotion {
        let path = Self::path(dice);
        let circ = self.circle(dice, &path);
        CartesianMotion { course: Course::Circ(circ), ..path }
    }

    fn circle(&self, dice: &mut Dice, path: &CartesianMotion) -> Circ {
        let [aux, to] = [0.7, 1.0].map(|share| {
            let way = Way { size: share * self.size, ..*self };
            let joints = way.near(dice, false);
            way.target(dice, path, &joints, false)
        });
        let angle_rad = dice.percent(25).then(|| {
            let sign = if dice.percent(50) { 1.0 } else { -1.0 };
            sign * dice.log(0.2, std::f64::consts::TAU)
        });
        let aux_orientation = match dice.count(0, 2) {
            0 => AuxOrientation::Consider,
            1 if angle_rad.is_none() => AuxOrientation::Interpolate,
            _ => AuxOrientation::Ignore,
        };
        Circ {
            aux,
            to,
            angle_rad,
            turns_with_path: dice.percent(30),
            aux_orientation,
            extrapolates: dice.percent(50),
        }
    }

    /// Returns a spline, mostly of SPL segments, with lines and circles among them.
    fn spline(&self, dice: &mut Dice) -> CartesianMotion {
        let path = Self::path(dice);
        let mut from_rad = self.from_rad;
        let segments = (0..dice.count(1, 6)).map(|_| {
            let way = Way { from_rad, size: 0.5 * self.size, ..*self };
            let swing = dice.percent(15);
            from_rad = way.near(dice, swing);
            let to = way.target(dice, &path, &from_rad, swing);
            let course = match dice.count(0, 9) {
                0 => SegmentCourse::Circ(way.circle(dice, &path)),
                1 | 2 => SegmentCourse::Lin { to },
                _ => SegmentCourse::Spl { to },
            };
            let orientation = match dice.count(0, 9) {
                0 => Some(OrientationType::Constant),
                1 => Some(OrientationType::Ignore),
                _ => None,
            };
            SplineSegment { course, orientation, limits: segment_limits(dice) }
        });
        CartesianMotion { course: Course::Spline(segments.collect()), ..path }
    }
}

/// Returns relative joint limits, mostly full ones.
fn shares(dice: &mut Dice) -> ByKind<Joints> {
    ByKind::from_fn(|_| match dice.count(0, 9) {
        0 => dice.joints(|dice| dice.between(0.2, 1.0)),
        1..4 => [dice.between(0.05, 1.0); 7],
        _ => [1.0; 7],
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn programs_can_be_written_and_read() {
        for index in 0..50 {
            let program = tcp_program(1, index).program;
            let again = Program::from_json(&program.to_json());
            assert_eq!(
                again.map(|program| program.motions.len()).ok(),
                Some(program.motions.len())
            );
        }
    }
}
