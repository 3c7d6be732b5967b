//! TCP of each motion of a program, as the path reports it.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use iiwa_kin::{Joints, Pose, Robot};
use iiwa_path::{JointPath, PathOptions};
use iiwa_program::{Motion, MotionIndex, MotionType, Program};

const TEXT: &str = include_str!("../../../../fixtures/pick-and-place.json");

fn path(program: &Program) -> JointPath {
    JointPath::new(program, &Robot::default()).unwrap()
}

fn tcps_mm(path: &JointPath, motions: usize) -> Vec<[f64; 3]> {
    let tcp = |index| path.tcp(MotionIndex::new(index)).position_m.map(|v| (1e3 * v).round());
    (0..motions).map(tcp).collect()
}

#[test]
fn a_motion_moves_the_tcp_of_its_tool() {
    let mut program = Program::from_json(TEXT).unwrap();
    let [tool, left] = [[0.0, 0.0, 120.0], [0.0, 40.0, 120.0]];
    let mut expected = vec![tool; program.motions.len()];
    // The next motion, to joint positions, has the tool of the program again.
    expected[6] = left;
    let of = path(&program);
    assert!(of.has_tools());
    assert_eq!(tcps_mm(&of, program.motions.len()), expected);

    // A wait keeps the TCP of the motion before it.
    program.motions.insert(7, Motion::Wait { seconds: 1.0, overlap: 0 });
    expected.insert(7, left);
    assert_eq!(tcps_mm(&path(&program), program.motions.len()), expected);
    program.motions.insert(0, Motion::Wait { seconds: 1.0, overlap: 0 });
    expected.insert(0, tool);
    assert_eq!(tcps_mm(&path(&program), program.motions.len()), expected);
}

#[test]
fn types_are_those_of_the_program() {
    use MotionType::{Circ, Lin, LinRel, Ptp, PtpToFrame, Wait};
    let program = Program::from_json(TEXT).unwrap();
    let path = path(&program);
    let actual: Vec<_> =
        (0..8).map(|index| path.motion_type(MotionIndex::new(index)).unwrap()).collect();
    assert_eq!(actual, [PtpToFrame, LinRel, Wait, LinRel, Lin, Circ, LinRel, Ptp]);
}

#[test]
fn without_a_tool_the_flange_is_the_tcp() {
    for fixture in [
        include_str!("../../../../fixtures/ten-motions.json"),
        include_str!("../../../../fixtures/waits-and-stops.json"),
    ] {
        let path = path(&Program::from_json(fixture).unwrap());
        assert!(!path.has_tools());
        assert_eq!(*path.tcp(MotionIndex::new(3)), Pose::IDENTITY);
        assert_eq!(path.motion_type(MotionIndex::new(3)), None);
    }
    let flange = TEXT.replace("\"tool\": \"gripper\"", "\"tool\": \"flange\"");
    let mut program = Program::from_json(&flange).unwrap();
    program.motions.truncate(1);
    program.motions.extend(Program::from_json(TEXT).unwrap().motions.pop());
    assert!(!path(&program).has_tools());
}

#[test]
fn another_tool_of_a_motion_is_another_tcp_of_the_path() {
    let mut program = Program::from_json(TEXT).unwrap();
    let mut path = path(&program);
    let Motion::Cartesian(cartesian) = &mut program.motions[6] else {
        panic!("a motion to a frame")
    };
    cartesian.tool = Some("flange".to_owned());
    path.update(&program, PathOptions::default(), MotionIndex::new(6)).unwrap();
    assert_eq!(*path.tcp(MotionIndex::new(6)), Pose::IDENTITY);
    assert!(path.has_tools());
}

#[test]
fn a_tool_that_is_not_there_is_a_fault() {
    let mut program =
        Program::from_json(include_str!("../../../../fixtures/ten-motions.json")).unwrap();
    program.workcell.tool = Some("gripper".to_owned());
    let fault = JointPath::new(&program, &Robot::default()).unwrap_err();
    assert!(fault.to_string().contains("unknown tool `gripper`"), "{fault}");
}

/// A blend radius is a distance of the TCP, also between point-to-point motions.
#[test]
fn blend_size_is_measured_at_the_tcp() {
    const RADIUS_MM: f64 = 60.0;
    let program = Program::from_json(
        r#"{ "version": 1, "tools": { "long": { "tcp": { "x_mm": 80, "z_mm": 250 } } },
             "tool": "long", "start": { "joints_deg": [0, 30, 0, -60, 0, 90, 0] },
             "motions": [
                { "type": "ptp", "joints_deg": [0, 30, 0, -60, 0, 30, 60],
                  "blend": { "cart_mm": 60 } },
                { "type": "ptp", "joints_deg": [60, 50, 0, -60, 20, 30, 0] }] }"#,
    )
    .unwrap();
    let path = path(&program);
    let (_, blend) = path.blends().next().unwrap();
    let tcp = path.tcp(MotionIndex::new(0));
    let at = |q: &Joints| path.robot().flange_pose(q).then(tcp).position_m.map(|v| 1e3 * v);
    let Motion::Ptp(ptp) = &program.motions[0] else { unreachable!() };
    let target = at(&ptp.target_rad);
    let off = [0.0, 1.0].map(|s| {
        let end = at(&blend.at(s).q);
        std::iter::zip(end, target).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
    });
    // Both sides have the joint-space length of the shorter one, whose end is on the sphere.
    assert!(off.iter().any(|mm| (mm - RADIUS_MM).abs() < 1e-6), "{off:?}");
}
