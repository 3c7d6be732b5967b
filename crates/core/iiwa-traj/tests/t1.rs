//! Operating mode T1: TCP and flange move at 225 mm/s at most.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use fastrand::Rng;
use iiwa_kin::{Pose, Robot};
use iiwa_path::JointPath;
use iiwa_program::{Blend, Motion, OperatingMode, Program, Ptp};
use iiwa_traj::{Limit, LimitKind, Limited, SweepOptions, Timing, Trajectory};

/// Motions of all kinds, with a tool so long that TCP or flange may be the faster one.
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

/// Returns the largest TCP and flange speeds, in m/s.
fn speeds(text: &str, timing: Timing) -> ([f64; 2], f64) {
    let robot = Robot::lbr_iiwa_7_r800();
    let program = Program::from_json(text).unwrap();
    let path = JointPath::new(&program, &robot).unwrap();
    let trajectory = Trajectory::plan(&path, timing).unwrap();
    let mut max_m_s = [0.0_f64; 2];
    for state in trajectory.samples(1000.0) {
        for (max_m_s, tcp) in max_m_s.iter_mut().zip([path.tcp(state.motion), &Pose::IDENTITY]) {
            *max_m_s = max_m_s.max(robot.tcp_speed_m_s(tcp, &state.q, &state.dq));
        }
    }
    (max_m_s, trajectory.motion_time_s())
}

#[test]
fn tcp_and_flange_go_slowly() {
    let test = PROGRAM.replace("\"tool\": \"lance\"", "\"tool\": \"lance\", \"mode\": \"t1\"");
    let program = Program::from_json(&test).unwrap();
    assert_eq!(
        Program::from_json(&program.to_json()).unwrap().workcell.mode,
        program.workcell.mode
    );
    for timing in
        [Timing::default(), Timing::jerk_limited(), Timing::Acceleration(SweepOptions::default())]
    {
        let (max_m_s, seconds) = speeds(&test, timing);
        assert!(max_m_s.iter().all(|max_m_s| *max_m_s < 0.2255), "{}: {max_m_s:?}", timing.name());
        assert!(max_m_s.iter().all(|max_m_s| *max_m_s > 0.2245), "{}: {max_m_s:?}", timing.name());
        let (faster, without) = speeds(PROGRAM, timing);
        assert!(faster.iter().any(|max_m_s| *max_m_s > 0.5), "{faster:?}");
        assert!(without < 0.8 * seconds, "{without} {seconds}");
    }
}

/// The controller holds the speed during execution; motions start and stop as in any other mode.
#[test]
fn ramps_are_not_changed() {
    let plan = |mode: &str| {
        let text = format!(
            r#"{{ "version": 1, {mode} "start": {{ "joints_deg": [0, 30, 0, -60, 0, 90, 0] }},
                "motions": [{{ "type": "ptp", "joints_deg": [60, 50, 10, -90, 10, 40, 0] }}] }}"#
        );
        let robot = Robot::lbr_iiwa_7_r800();
        let path = JointPath::new(&Program::from_json(&text).unwrap(), &robot).unwrap();
        (robot, Trajectory::plan(&path, Timing::default()).unwrap())
    };
    let (robot, test) = plan(r#""mode": "t1","#);
    let (_, automatic) = plan("");
    let speed =
        |state: &iiwa_traj::State| robot.tcp_speed_m_s(&Pose::IDENTITY, &state.q, &state.dq);
    let (mut held_s, mut last) = (0.0, f64::NEG_INFINITY);
    for state in test.samples(1000.0) {
        assert!(speed(&state) < 0.225 * (1.0 + 1e-4), "{} m/s at {} s", speed(&state), state.t_s);
        assert!(state.t_s > last);
        last = state.t_s;
        held_s += if speed(&state) > 0.225 * (1.0 - 1e-4) { 1e-3 } else { 0.0 };
        let before = automatic.at(state.t_s);
        if (0.0..0.1).contains(&state.t_s) && speed(&before) < 0.22 {
            let off = (0..7).map(|j| (before.q[j] - state.q[j]).abs()).fold(0.0, f64::max);
            assert!(off < 1e-9, "{off} rad at {} s", state.t_s);
        }
    }
    let [slow, fast] = [&test, &automatic].map(Trajectory::motion_time_s);
    assert!(held_s > 0.8 * slow && slow > 1.5 * fast, "{held_s} of {slow} s, {fast} s");
    // Apart from the ramps, the way is the speed times the time for which it is held.
    println!("{slow:.4} s, held for {held_s:.3} s; {fast:.4} s in other modes");
}

/// Random motions, blended or not, near and far: stamps increase, and the speed is kept.
#[test]
fn speeds_are_held_along_random_programs() {
    let mut random = Rng::with_seed(36);
    let robot = Robot::lbr_iiwa_7_r800();
    let (mut planned, mut within_limit) = (0, 0);
    for _ in 0..60 {
        let mut pose =
            || std::array::from_fn(|j| robot.limits().upper_rad[j] * (1.6 * random.f64() - 0.8));
        let [start, first, second]: [[f64; 7]; 3] = [pose(), pose(), pose()];
        let share = if random.bool() { 1.0 } else { 1e-3 };
        let near: [f64; 7] = std::array::from_fn(|j| start[j] + share * (first[j] - start[j]));
        let mut program = Program::from_rad(start).build();
        let blend = random.bool().then(|| Blend::Fraction(0.5 * random.f64()));
        program.motions = vec![
            Motion::Ptp(Ptp { blend, ..Ptp::to(near) }),
            Motion::Ptp(Ptp::to(second).velocity(0.1 + 0.9 * random.f64())),
        ];
        program.workcell.mode = OperatingMode::T1;
        let Ok(path) = JointPath::new(&program, &robot) else { continue };
        let trajectory = Trajectory::plan(&path, Timing::default()).unwrap();
        planned += 1;
        let mut last = f64::NEG_INFINITY;
        for state in trajectory.states() {
            assert!(state.t_s > last, "{} s", state.t_s);
            last = state.t_s;
        }
        for state in trajectory.samples(1000.0) {
            let speed = robot.tcp_speed_m_s(&Pose::IDENTITY, &state.q, &state.dq);
            assert!(speed < 0.225 * (1.0 + 1e-3), "{speed} m/s at {} s", state.t_s);
            within_limit += usize::from(speed > 0.225 * (1.0 - 1e-3));
        }
    }
    assert!(planned > 40 && within_limit > 10_000, "{planned} {within_limit}");
}

/// A motion whose own limit is below that of T1 reports its own limit.
#[test]
fn the_lower_limit_is_named() {
    let cart = Limit::Motion { of: Limited::Way, kind: LimitKind::Velocity };
    let cart_acceleration = Limit::Motion { of: Limited::Way, kind: LimitKind::Acceleration };
    let slow = r#"{ "type": "lin_rel", "offset": { "y_mm": 200 }, "cart_velocity_mm_s": 100 }"#;
    let soft = r#"{ "type": "lin_rel", "offset": { "y_mm": 200 }, "cart_velocity_mm_s": 100,
        "cart_acceleration_mm_s2": 120 }"#;
    let fast = r#"{ "type": "lin_rel", "offset": { "y_mm": 200 }, "cart_velocity_mm_s": 400 }"#;
    let free = r#"{ "type": "lin_rel", "offset": { "y_mm": 200 } }"#;
    let cases = [(slow, cart), (soft, cart), (fast, Limit::T1Velocity)];
    for timing in [Timing::default(), Timing::jerk_limited()] {
        for (motion, expected) in cases.into_iter().chain([(free, Limit::T1Velocity)]) {
            let text = format!(
                r#"{{ "version": 1, "mode": "t1", "motions": [{motion}],
                    "start": {{ "joints_deg": [0, 30, 0, -60, 0, 90, 0] }} }}"#
            );
            let program = Program::from_json(&text).unwrap();
            let path = JointPath::new(&program, &Robot::default()).unwrap();
            let trajectory = Trajectory::plan(&path, timing).unwrap();
            let figures = &trajectory.motions()[0];
            // With jerk limits, the acceleration limit is active for longer.
            let is_longest = figures.limited_by == Some(expected);
            assert!(is_longest || motion == soft, "{motion}: {:?}", figures.limits);
            let named = |limit| figures.limits.iter().any(|active| active.limit == limit);
            assert!(named(expected), "{motion}: {:?}", figures.limits);
            assert!(named(cart_acceleration) == (motion == soft), "{:?}", figures.limits);
            assert!(!(named(cart) && named(Limit::T1Velocity)), "{:?}", figures.limits);
        }
    }
}

/// A PTP motion whose joint velocity is the lower limit reports the joint.
#[test]
fn a_slow_joint_is_named() {
    let text = r#"{ "version": 1, "mode": "t1",
        "start": { "joints_deg": [0, 30, 0, -60, 0, 90, 0] },
        "motions": [{ "type": "ptp", "joints_deg": [20, 30, 0, -60, 0, 90, 0],
            "velocity_rel": 0.1 }] }"#;
    let path = JointPath::new(&Program::from_json(text).unwrap(), &Robot::default()).unwrap();
    let trajectory = Trajectory::plan(&path, Timing::default()).unwrap();
    let limits = &trajectory.motions()[0].limits;
    let is_joint = |limit| matches!(limit, Limit::Motion { of: Limited::Joint(_), .. });
    assert!(!limits.is_empty() && limits.iter().all(|it| is_joint(it.limit)), "{limits:?}");
}
