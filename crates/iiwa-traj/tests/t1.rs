//! The operating mode T1: TCP and flange go at 250 mm/s at most.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use iiwa_kin::{Pose, Robot};
use iiwa_path::JointPath;
use iiwa_program::Program;
use iiwa_traj::{SweepOptions, Timing, Trajectory};

/// Motions of all kinds; with a tool so long that either may be the faster one.
const PROGRAM: &str = r#"{
    "version": 1,
    "tools": { "lance": { "tcp": { "x_mm": 300, "z_mm": 100 } } },
    "tool": "lance",
    "start": { "joints_deg": [0, 30, 0, -60, 0, 90, 0] },
    "motions": [
        { "type": "ptp", "joints_deg": [40, 20, 10, -70, 0, 80, 0], "blend": { "cart_mm": 60 } },
        { "type": "ptp", "joints_deg": [30, 35, 0, -60, 20, 60, 90] },
        { "type": "lin_rel", "offset": { "y_mm": 120, "a_deg": 40 }, "blend": { "cart_mm": 20 } },
        { "type": "lin_rel", "offset": { "z_mm": -80 }, "cart_velocity_mm_s": 100 },
        { "type": "ptp", "joints_deg": [0, 30, 0, -60, 0, 90, 0] }
    ]
}"#;

/// The greatest speeds of the TCP and of the flange, in m/s.
fn speeds(text: &str, timing: Timing) -> ([f64; 2], f64) {
    let robot = Robot::lbr_iiwa_7_r800();
    let program = Program::from_json(text).unwrap();
    let path = JointPath::new(&program, &robot).unwrap();
    let trajectory = Trajectory::plan(&path, timing).unwrap();
    let mut most = [0.0_f64; 2];
    for state in trajectory.samples(1000.0) {
        for (most, tcp) in most.iter_mut().zip([path.tcp(state.motion), &Pose::IDENTITY]) {
            *most = most.max(robot.tcp_speed_m_s(tcp, &state.q, &state.dq));
        }
    }
    (most, trajectory.motion_time_s())
}

#[test]
fn tcp_and_flange_go_slowly() {
    let test = PROGRAM.replace("\"tool\": \"lance\"", "\"tool\": \"lance\", \"mode\": \"t1\"");
    let program = Program::from_json(&test).unwrap();
    assert_eq!(
        Program::from_json(&program.to_json()).unwrap().workcell.mode,
        program.workcell.mode
    );
    for timing in [Timing::default(), Timing::Acceleration(SweepOptions::default())] {
        let (most, seconds) = speeds(&test, timing);
        assert!(most.iter().all(|most| *most < 0.2505), "{}: {most:?}", timing.name());
        assert!(most.iter().all(|most| *most > 0.2495), "{}: {most:?}", timing.name());
        let (faster, without) = speeds(PROGRAM, timing);
        assert!(faster.iter().any(|most| *most > 0.5), "{faster:?}");
        assert!(without < 0.8 * seconds, "{without} {seconds}");
    }
}
