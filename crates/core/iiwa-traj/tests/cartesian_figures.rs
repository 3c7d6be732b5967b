//! Figures of motions to frames, compared with differences of the TCP pose.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use iiwa_kin::{Robot, Status};
use iiwa_path::JointPath;
use iiwa_program::{MotionType, Program};
use iiwa_traj::{PieceKind, Timing, Trajectory};

const TEXT: &str = include_str!("../../../../fixtures/pick-and-place.json");

fn plan(text: &str) -> Trajectory {
    let path = JointPath::new(&Program::from_json(text).unwrap(), &Robot::default()).unwrap();
    Trajectory::plan(&path, Timing::jerk_limited()).unwrap()
}

#[test]
fn peaks_are_those_of_a_dense_sampling() {
    const STEP_S: f64 = 1e-4;
    let plan = plan(TEXT);
    let robot = plan.path().robot();
    let mut cartesian = 0;
    for motion in plan.motions() {
        let Some(figures) = motion.cartesian else { continue };
        cartesian += 1;
        let tcp = plan.path().tcp(motion.motion);
        let place = |t_s: f64| robot.flange_pose(&plan.at(t_s).q).then(tcp).position_m;
        let steps = ((motion.end_s - motion.start_s) / STEP_S).floor();
        let (mut peak_m_s, mut distance) = (0.0_f64, f64::MAX);
        let mut t_s = motion.start_s;
        while t_s + STEP_S <= motion.end_s {
            let [a, b] = [place(t_s), place(t_s + STEP_S)];
            let way_m = (0..3).map(|i| (b[i] - a[i]).powi(2)).sum::<f64>().sqrt();
            peak_m_s = peak_m_s.max(way_m / STEP_S);
            distance = distance.min(robot.singularity(&plan.at(t_s).q).nearest().0);
            t_s += STEP_S;
        }
        let actual = figures.tcp_speed_peak_m_s;
        assert!((actual / peak_m_s - 1.0).abs() < 2e-3, "{}: {actual} {peak_m_s}", motion.motion);
        let nearest = figures.nearest_singularity;
        assert!(
            (nearest.distance - distance).abs() < 1e-3,
            "{}: {nearest:?} {distance}",
            motion.motion
        );
        assert!(nearest.distance <= distance + 1e-6 && steps > 100.0);
        let at_time = robot.singularity(&plan.at(nearest.at_s).q).nearest();
        assert!((at_time.0 - nearest.distance).abs() < 1e-9 && at_time.1 == nearest.part);
        assert_eq!(Some(figures.status), Status::new(2));
    }
    assert_eq!(cartesian, 7);
}

#[test]
fn a_limit_of_the_tcp_is_its_top_speed() {
    let motions = plan(TEXT).motions();
    for (index, max_m_s) in [(1, 0.25), (3, 0.25), (4, 0.4), (5, 0.3)] {
        let actual = motions[index].cartesian.unwrap().tcp_speed_peak_m_s;
        assert!((actual / max_m_s - 1.0).abs() < 1e-5, "{index}: {actual}");
    }
    let kinds: Vec<_> = motions.iter().map(|motion| motion.kind.name()).collect();
    assert_eq!(kinds, ["ptp", "lin_rel", "wait", "lin_rel", "lin", "circ", "lin_rel", "ptp"]);
    // Two motions are point-to-point, and only one of them has a frame as its target.
    assert_eq!(motions[0].kind, MotionType::PtpToFrame);
    // The last motion moves the tool as well.
    assert!(motions[2].cartesian.is_none() && motions[7].cartesian.is_some());
}

#[test]
fn pieces_have_the_kind_of_the_tcp_path() {
    use PieceKind::{Blend, Circ, Lin, Line};
    let plan = plan(TEXT);
    let pieces = plan.sections().iter().flat_map(iiwa_traj::Section::pieces);
    let kinds: Vec<_> = pieces.map(|piece| piece.kind).filter(|kind| kind.moves()).collect();
    assert_eq!(kinds, [Line, Blend, Lin, Lin, Blend, Lin, Circ, Lin, Line]);
}

/// A TCP that only rotates is at rest, at any distance from the flange that moves around it, and
/// also where the arm swings about a fixed TCP.
#[test]
fn a_tcp_at_rest_has_no_speed() {
    let text = r#"{
        "version": 1,
        "tools": { "gripper": { "tcp": { "x_mm": 80, "z_mm": 200 } } },
        "tool": "gripper",
        "start": { "joints_deg": [0, 20, 0, -110, 0, -40, 90] },
        "motions": [
            { "type": "lin_rel", "offset": { "a_deg": 20, "b_deg": -15 } },
            { "type": "lin_rel", "offset": {}, "e1_deg": 40 }
        ]
    }"#;
    let motions = plan(text).motions();
    let [turn, swing] = [0, 1].map(|index: usize| motions[index].cartesian.unwrap());
    for figures in [turn, swing] {
        assert!(figures.tcp_speed_peak_m_s < 1e-6, "{figures:?}");
    }
    assert_eq!(Some(turn.status), Status::new(6));
    let e1_deg = swing.e1_rad.map(f64::to_degrees);
    assert!((e1_deg[0]).abs() < 1e-6 && (e1_deg[1] - 40.0).abs() < 1e-6, "{e1_deg:?}");
}
