//! Random programs with TCP paths: both time parameterisations keep all limits.

use std::{collections::BTreeMap, sync::Arc};

use iiwa_kin::{Joints, Pose, Robot, vector};
use iiwa_path::{JointPath, Segment, Step};
use iiwa_program::{
    CartesianMotion, Course, Frame, LimitKind, Motion, OrientationType, PathBlend, Program,
    SegmentCourse, Sources, SplineSegment, Start, TargetRef, ToolLimits, Workcell,
};
use iiwa_traj::{SweepOptions, Timing, Trajectory};
use iiwasim_tests::{
    differences::ratios,
    tcp_limits::{tcp_difference_ratios, tcp_ratios},
    tcp_programs::{ROOT, TcpProgram, single_path, tcp_program},
};

/// Tolerances of limit ratios: 1 % for velocity and acceleration, 5 % for jerk.
const ALLOWED: [f64; 3] = [1.01, 1.01, 1.05];

/// Returns the faults of a program's plans.
fn faults(TcpProgram { robot, program, .. }: &TcpProgram) -> Vec<String> {
    let path = match JointPath::new(program, robot) {
        Ok(path) => path,
        Err(fault) => return vec![fault.to_string()],
    };
    let mut faults = Vec::new();
    for timing in [Timing::jerk_limited(), Timing::Acceleration(SweepOptions::default())] {
        let kinds = if matches!(timing, Timing::Jerk(_)) { 3 } else { 2 };
        let trajectory = match Trajectory::plan(&path, timing) {
            Ok(trajectory) => trajectory,
            Err(error) => {
                faults.push(format!("{}: {error}", timing.name()));
                continue;
            }
        };
        for rate_hz in [1000.0, 250.0] {
            let exceeded = |quantity: &str, ratios: &[f64]| -> Vec<String> {
                let is_too_much = |i: usize| ratios[i] > ALLOWED[i] || ratios[i].is_nan();
                (0..ratios.len().min(kinds))
                    .filter(|i| is_too_much(*i))
                    .map(|i| {
                        let order = i + 1;
                        let ratio = ratios[i];
                        format!(
                            "{} at {rate_hz} Hz: {quantity}, order {order}: {ratio:.4}",
                            timing.name()
                        )
                    })
                    .collect()
            };
            faults.extend(exceeded("joints by differences", &ratios(&trajectory, rate_hz)));
            let mut joints = [0.0_f64; 3];
            for state in trajectory.samples(rate_hz) {
                let limits = path.limits_of(state.step);
                let all = [
                    (&state.dq, limits.velocity_rad_s()),
                    (&state.ddq, limits.acceleration_rad_s2()),
                    (&state.dddq, limits.jerk_rad_s3()),
                ];
                for (worst, (values, limits)) in joints.iter_mut().zip(all) {
                    *worst = worst.max(iiwasim_tests::differences::ratio(values, limits));
                }
            }
            faults.extend(exceeded("joints", &joints));
            let [way, turn] = tcp_ratios(robot, program, &trajectory, rate_hz);
            faults.extend(exceeded("way", &way));
            faults.extend(exceeded("turn", &turn));
        }
        // Differences are along chords: at a lower rate they would cut the corners of small blends.
        let [way, turn] = tcp_difference_ratios(robot, program, &trajectory, 4000.0);
        for (quantity, ratios) in [("way", way), ("turn", turn)] {
            if !(ratios[0] <= 1.01 && ratios[1] <= 1.03) {
                faults.push(format!("{} by differences: {quantity}: {ratios:?}", timing.name()));
            }
        }
    }
    faults
}

#[test]
fn all_limits_are_kept() {
    let count = if std::env::var_os("IIWASIM_LONG").is_some() { 2000 } else { 30 };
    let mut refused = BTreeMap::<_, usize>::new();
    let mut wrong = 0;
    for index in 0..count {
        let drawn = tcp_program(1, index);
        for (cause, times) in &drawn.refused {
            *refused.entry(*cause).or_default() += times;
        }
        let faults = faults(&drawn);
        if !faults.is_empty() {
            wrong += 1;
            println!("program {index}: {faults:#?}");
            println!("{} with d7 = {} m", drawn.robot.name(), drawn.robot.lengths().flange_m);
            println!("{}", drawn.program.to_json());
        }
    }
    println!("refused: {refused:?}");
    assert_eq!(wrong, 0, "of {count} programs");
}

/// Returns the program with other joint positions.
fn with_joints(program: &Program, joints: impl Fn(Joints) -> Joints) -> Program {
    let mut program = program.clone();
    if let Start::Joints(start_rad) = &mut program.start {
        *start_rad = joints(*start_rad);
    }
    for motion in &mut program.motions {
        if let Motion::Ptp(ptp) = motion {
            ptp.target_rad = joints(ptp.target_rad);
        }
    }
    program
}

fn seconds(path: &JointPath, timing: Timing) -> f64 {
    Trajectory::plan(path, timing).map_or(f64::NAN, |trajectory| trajectory.motion_time_s())
}

fn timings() -> [Timing; 2] {
    [Timing::jerk_limited(), Timing::Acceleration(SweepOptions::default())]
}

/// Turned about the robot's first axis together with joint A1, the program takes the same time: all
/// frames are in one base.
#[test]
fn turned_about_the_first_axis_it_takes_as_long() {
    let mut compared = 0;
    for index in 0..60 {
        let TcpProgram { robot, program, .. } = tcp_program(2, index);
        for angle in [0.7, -0.9] {
            let mut turned = with_joints(&program, |mut q| {
                q[0] += angle;
                q
            });
            let root = turned.workcell.bases.get_mut(ROOT).unwrap();
            root.frame = Frame { xyz_mm: [0.0; 3], abc_rad: [angle, 0.0, 0.0] };
            let Ok(turned_path) = JointPath::new(&turned, &robot) else { continue };
            let path = JointPath::new(&program, &robot).unwrap();
            for timing in timings() {
                // Where cells slightly exceed a limit, rounding decides which cells are lowered
                // before the jerk limits apply.
                let allowed = if matches!(timing, Timing::Jerk(_)) { 1e-3 } else { 1e-6 };
                let off = seconds(&turned_path, timing) / seconds(&path, timing) - 1.0;
                assert!(off.abs() < allowed, "program {index} by {}: {off:e}", timing.name());
            }
            compared += 1;
        }
    }
    assert!(compared > 60, "{compared}");
}

/// Moving the base, and the frames in it back, leaves the path unchanged.
#[test]
fn a_moved_base_and_frames_moved_back_are_the_same_path() {
    for index in 0..60 {
        let TcpProgram { robot, program, .. } = tcp_program(3, index);
        let root = Frame { xyz_mm: [300.0, -200.0, 100.0], abc_rad: [0.4, -0.3, 1.1] };
        let back = root.pose().inverse();
        let moved_back = |frame: &mut Frame| *frame = Frame::from(&back.then(&frame.pose()));
        let mut moved = program.clone();
        for (name, base) in &mut moved.workcell.bases {
            if name == ROOT {
                base.frame = root;
            } else {
                moved_back(&mut base.frame);
            }
        }
        for motion in &mut moved.motions {
            let Motion::Cartesian(cartesian) = motion else { continue };
            // Targets in another base move with that base.
            if cartesian.base.is_some() {
                continue;
            }
            let targets = match &mut cartesian.course {
                Course::Ptp { to } | Course::Lin { to } => vec![to],
                Course::LinRel { within, .. } => within.iter_mut().collect(),
                Course::Circ(circ) => vec![&mut circ.aux, &mut circ.to],
                Course::Spline(segments) => segments.iter_mut().flat_map(targets_of).collect(),
            };
            for target in targets {
                if let TargetRef::Given(target) = target {
                    moved_back(&mut target.frame);
                }
            }
        }
        let [original, moved] =
            [&program, &moved].map(|program| JointPath::new(program, &robot).unwrap());
        for (a, b) in segments(&original).iter().flatten().zip(segments(&moved).iter().flatten()) {
            for i in 0..=20 {
                let s = f64::from(i) / 20.0;
                let off = vector::distance(&a.at(s).q, &b.at(s).q);
                assert!(off < 1e-8, "program {index}: {off:e} rad");
                let [a, b] = [a, b].map(|segment| robot.flange_position(&segment.at(s).q));
                let off = (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt();
                assert!(off < 1e-8, "program {index}: {off:e} m");
            }
        }
    }
}

fn targets_of(segment: &mut SplineSegment) -> Vec<&mut TargetRef> {
    match &mut segment.course {
        SegmentCourse::Spl { to } | SegmentCourse::Lin { to } => vec![to],
        SegmentCourse::Circ(circ) => vec![&mut circ.aux, &mut circ.to],
    }
}

/// Scaling the limits of the k-th derivative by a factor to the power of -k makes the program take
/// the factor times as long.
#[test]
fn scaled_limits_scale_time() {
    const FACTOR: f64 = 1.7;
    let count = if std::env::var_os("IIWASIM_LONG").is_some() { 300 } else { 30 };
    for index in 0..count {
        let TcpProgram { robot, program, .. } = tcp_program(4, index);
        let mut slow = program.clone();
        for motion in &mut slow.motions {
            for kind in LimitKind::ALL {
                let by = FACTOR.powi(-i32::from(kind.order()));
                match motion {
                    Motion::Ptp(ptp) => ptp.share_mut(kind).iter_mut().for_each(|s| *s *= by),
                    Motion::Cartesian(cartesian) => {
                        cartesian.shares[kind].iter_mut().for_each(|share| *share *= by);
                        scale(&mut cartesian.tool_limits, kind, by);
                        let Course::Spline(segments) = &mut cartesian.course else { continue };
                        for limits in segments.iter_mut().map(|segment| &mut segment.limits) {
                            limits.shares[kind].iter_mut().flatten().for_each(|share| *share *= by);
                            scale(&mut limits.tool, kind, by);
                        }
                    }
                    Motion::Wait { .. } | Motion::Load(_) | Motion::Io(_) => {}
                }
            }
        }
        let [fast, slow] =
            [&program, &slow].map(|program| JointPath::new(program, &robot).unwrap());
        for timing in timings() {
            let off = seconds(&slow, timing) / (FACTOR * seconds(&fast, timing)) - 1.0;
            assert!(off.abs() < 1e-3, "program {index} by {}: {off:e}", timing.name());
        }
    }
}

fn scale(limits: &mut ToolLimits, kind: LimitKind, by: f64) {
    limits.way[kind] *= by;
    limits.turn[kind] *= by;
}

/// Returns the segments between stops.
fn segments(path: &JointPath) -> Vec<Vec<Arc<dyn Segment>>> {
    let parts = path.steps().split(|step| !step.moves());
    let segment = |step: &Step| match step {
        Step::Move { segment, .. } => Some(Arc::clone(segment)),
        _ => None,
    };
    parts.map(|part| part.iter().filter_map(segment).collect()).collect()
}

/// Joint positions and TCP are continuous with two derivatives with respect to the path parameter
/// wherever the arm does not stop: checked by the segments' own derivatives, and by divided
/// differences of positions.
#[test]
fn position_and_two_derivatives_go_on_across_blends() {
    let mut joins = 0;
    for index in 0..200 {
        let TcpProgram { robot, program, .. } = tcp_program(5, index);
        let path = JointPath::new(&program, &robot).unwrap();
        for pair in segments(&path).iter().flat_map(|part| part.windows(2)) {
            let [a, b] = [&pair[0], &pair[1]];
            let off = vector::distance(&a.at(1.0).q, &b.at(0.0).q);
            assert!(off < 1e-12, "program {index}: {off:e} rad");
            let [into, out] = [a.sigma_derivatives(1.0), b.sigma_derivatives(0.0)];
            let derivatives = [into, out];
            for k in 0..2 {
                let off = vector::distance(&into[k], &out[k]);
                let scale = 1.0 + vector::norm(&into[k]);
                assert!(off < 1e-6 * scale, "program {index}, derivative {}: {off:e}", k + 1);
            }
            // One-sided second-order differences, over steps that are short on both sides.
            let h = 1e-5 * a.sigma_length_rad().min(b.sigma_length_rad());
            let state_at = |segment: &Arc<dyn Segment>, way: f64| {
                segment.at(segment.s_at(way / segment.sigma_unit_rad())).q
            };
            let before = [0.0, 1.0, 2.0].map(|k| state_at(a, a.sigma_length_rad() - k * h));
            let after = [0.0, 1.0, 2.0].map(|k| state_at(b, k * h));
            let rate =
                |q: &[Joints; 3], j: usize| (4.0 * q[1][j] - 3.0 * q[0][j] - q[2][j]) / (2.0 * h);
            for j in 0..7 {
                let [into, out] = [-rate(&before, j), rate(&after, j)];
                let off = (into - out).abs();
                let third = derivatives.map(|[_, _, third]| third[j].abs());
                let tolerance = 1e-3 * (1.0 + into.abs()) + h * h * (third[0] + third[1]);
                assert!(off < tolerance, "program {index}, A{}: {off:e}", j + 1);
            }
            joins += 1;
        }
    }
    assert!(joins > 500, "{joins}");
}

/// Returns a start, and a corner of two TCP lines in one plane.
fn corner(index: u64) -> Option<(Robot, Joints, [Frame; 2])> {
    let (robot, program) = single_path(6, index, false);
    let start_rad = *program.start.joints_rad()?;
    let start = robot.flange_pose(&start_rad);
    let turned = |by: [f64; 3]| {
        let xyz = Pose { position_m: by, ..Pose::IDENTITY };
        Frame::from(&start.then(&xyz))
    };
    let angle = index as f64;
    let second = [0.1 + 0.08 * angle.cos(), 0.08 * angle.sin(), 0.0];
    Some((robot, start_rad, [turned([0.1, 0.0, 0.0]), turned(second)]))
}

fn lines(
    start_rad: Joints,
    frames: &[Frame],
    radius_mm: f64,
    orientation: OrientationType,
) -> Program {
    let count = frames.len();
    let lin = |(i, frame): (usize, &Frame)| {
        let blend = (i + 1 < count).then(|| PathBlend::cart_mm(radius_mm));
        let course = Course::Lin { to: (*frame).into() };
        let lin = CartesianMotion { orientation, blend, ..CartesianMotion::new(course) };
        Motion::Cartesian(Box::new(lin))
    };
    Program {
        robot: None,
        start: Start::Joints(start_rad),
        motions: frames.iter().enumerate().map(lin).collect(),
        workcell: Workcell::default(),
        sources: Sources::default(),
    }
}

/// Two lines in one plane without rotation: their blend stays in the plane, and does not rotate
/// either.
#[test]
fn blends_of_lines_keep_plane_and_orientation() {
    let mut compared = 0;
    for index in 0..200 {
        let Some((robot, start_rad, frames)) = corner(index) else { continue };
        let program = lines(start_rad, &frames, 30.0, OrientationType::Constant);
        let Ok(path) = JointPath::new(&program, &robot) else { continue };
        let start = robot.flange_pose(&start_rad);
        assert_eq!(path.blends().count(), 1);
        for segment in segments(&path).iter().flatten() {
            for i in 0..=200 {
                let pose = robot.flange_pose(&segment.at(f64::from(i) / 200.0).q);
                let relative = start.inverse().then(&pose);
                let height = relative.position_m[2].abs();
                assert!(height < 2e-9, "corner {index}: {height:e} m out of the plane");
                let turn = relative.to_isometry().rotation.angle();
                assert!(turn < 3e-9, "corner {index}: turned by {turn:e} rad");
            }
        }
        compared += 1;
    }
    assert!(compared > 100, "{compared}");
}

/// A line in two halves with the largest blend between them is equal to the line.
#[test]
fn a_line_in_two_halves_takes_as_long() {
    let mut compared = 0;
    for index in 0..100 {
        let Some((robot, start_rad, [half, _])) = corner(index) else { continue };
        let start = robot.flange_pose(&start_rad);
        let whole = Pose { position_m: [0.2, 0.0, 0.0], ..Pose::IDENTITY };
        let whole = Frame::from(&start.then(&whole));
        let [one, two] = [vec![whole], vec![half, whole]].map(|frames| {
            JointPath::new(&lines(start_rad, &frames, 50.0, OrientationType::Variable), &robot)
        });
        let (Ok(one), Ok(two)) = (one, two) else { continue };
        for timing in timings() {
            let off = seconds(&two, timing) / seconds(&one, timing) - 1.0;
            assert!(off.abs() < 3e-3, "line {index} by {}: {off:e}", timing.name());
        }
        compared += 1;
    }
    assert!(compared > 50, "{compared}");
}

/// A path to the current pose is not a motion: there is nothing to blend.
#[test]
fn blends_at_a_standing_target_are_stops() {
    let start_rad = [0.0, 0.5, 0.0, -1.2, 0.0, 0.9, 0.0];
    let robot = Robot::default();
    let pose = robot.flange_pose(&start_rad);
    let by = Pose { position_m: [0.05, 0.02, 0.03], ..Pose::IDENTITY };
    let moved = Frame::from(&pose.then(&by));
    let original = Frame::from(&pose);
    for frames in [vec![original, moved], vec![moved, moved], vec![original, original, moved]] {
        let program = lines(start_rad, &frames, 30.0, OrientationType::Variable);
        let path = JointPath::new(&program, &robot).unwrap();
        assert_eq!(path.blends().count(), 0);
        let alone = lines(start_rad, &[moved], 30.0, OrientationType::Variable);
        let alone = JointPath::new(&alone, &robot).unwrap();
        for timing in timings() {
            let off = seconds(&path, timing) / seconds(&alone, timing) - 1.0;
            assert!(off.abs() < 1e-9, "{off:e}");
        }
    }
}
