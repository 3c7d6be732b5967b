//! The robot brakes for any end of the set-points, checked on the commanded positions of each
//! cycle.

#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::needless_range_loop,
    reason = "counts are small, and joints index several arrays"
)]

use iiwa_fri::{Format, FriClient};

use super::*;

/// A cabinet with a client whose set-points move joint 1 at full speed, and joint 7 at half speed.
struct SimulationScene {
    simulation: Simulation,
    client: FriClient,
    at_rad: Joints,
    speed_rad_s: Joints,
    /// `true` if the client answers.
    answers: bool,
    /// Commanded positions, cycle by cycle.
    trace: Vec<Joints>,
    period_s: f64,
}

const RUN: RunId = 4;

impl SimulationScene {
    /// Creates a scene with the robot at rest at `start_rad` and a commanding session.
    fn new(period_ms: u32, receive_multiplier: u32, start_rad: Joints) -> Self {
        let config = ControllerConfig { period_ms, receive_multiplier, format: Format::V1 };
        let mut scene = Self {
            simulation: Simulation::new(Robot::default(), start_rad, config, 1),
            client: FriClient::default(),
            at_rad: start_rad,
            speed_rad_s: [0.0; 7],
            answers: true,
            trace: Vec::new(),
            period_s: f64::from(period_ms) * 1e-3,
        };
        while scene.simulation.fri().state() != SessionState::MonitoringReady {
            scene.tick();
        }
        scene.instruct(Instruction::RunTrajectory { run: RUN });
        while scene.simulation.fri().state() != SessionState::CommandingActive {
            scene.tick();
        }
        scene
    }

    fn instruct(&mut self, instruction: Instruction) {
        self.simulation.carry_out(instruction).unwrap();
    }

    fn tick(&mut self) {
        let (mut message, mut answer) = (Vec::new(), Vec::new());
        let is_sent = self.simulation.tick(&mut message);
        self.trace.push(*self.simulation.position());
        if !is_sent || !self.answers {
            return;
        }
        self.client.receive(&message).unwrap();
        let latest = self.client.latest().unwrap();
        let step_s = f64::from(latest.receive_multiplier) * self.period_s;
        let active = latest.session == SessionState::CommandingActive;
        let next = std::array::from_fn(|j| self.at_rad[j] + self.speed_rad_s[j] * step_s);
        if self.client.answer(active.then_some(&next), &mut answer) {
            if active {
                self.at_rad = next;
            }
            self.simulation.fri().receive(&answer).unwrap();
        }
    }

    /// Accelerates to full speed and continues for a while.
    fn speed_up(&mut self) {
        let limits = *Robot::default().limits();
        let cycles = (0.3 / self.period_s).round() as u32;
        for cycle in 0..=cycles {
            let share = f64::from(cycle) / f64::from(cycles);
            self.speed_rad_s[0] = limits.velocity_rad_s[0] * share;
            self.speed_rad_s[6] = limits.velocity_rad_s[6] * share / 2.0;
            self.tick();
        }
        (0..(0.1 / self.period_s) as u32).for_each(|_| self.tick());
    }

    fn is_braking(&self) -> bool {
        matches!(self.simulation.activity, ProgramActivity::Braking(_))
    }

    /// Runs until the robot program has ended the run; asserts that the robot came to rest
    /// smoothly, in time and within its range.
    fn assert_brakes(&mut self, label: &str) {
        let limits = *Robot::default().limits();
        let begin = self.trace.len() - 3;
        let mut braked_s = 0.0;
        for _ in 0..10_000 {
            if self.simulation.state().state == DriveState::Idle {
                break;
            }
            self.tick();
            braked_s += if self.is_braking() { self.period_s } else { 0.0 };
        }
        (0..5).for_each(|_| self.tick());
        assert_eq!(self.simulation.state().state, DriveState::Idle, "{label}");
        assert!(self.simulation.outcome.as_ref().is_some_and(|it| it.error.is_some()), "{label}");
        assert!(braked_s <= EMERGENCY_STOP_S + 1e-9, "{label}: {braked_s} s");
        let mut worst = 0.0_f64;
        for three in self.trace[begin..].windows(3) {
            for j in 0..7 {
                let bend = (three[2][j] - 2.0 * three[1][j] + three[0][j]) / self.period_s.powi(2);
                worst = worst.max(bend.abs() / limits.acceleration_rad_s2[j]);
                assert!(three[2][j].abs() <= limits.upper_rad[j], "{label}: joint {}", j + 1);
            }
        }
        println!("{label}: {braked_s:.3} s, {worst:.3} of the acceleration limits");
        assert!(worst <= 1.3, "{label}: {worst} of the acceleration limits");
        let [.., before, last] = self.trace.as_slice() else { unreachable!() };
        assert_eq!(before, last, "{label}");
    }
}

type End = fn(&mut SimulationScene);

/// All ways in which set-points end during motion.
const ENDS: [(&str, End); 7] = [
    ("no more answers", |scene| scene.answers = false),
    ("the session is released", |scene| scene.simulation.fri().release()),
    ("the session is dropped", |scene| scene.simulation.drop_session(0.3)),
    ("the trajectory is ended", |scene| {
        scene.instruct(Instruction::EndTrajectory { run: RUN });
    }),
    ("a stop", |scene| scene.instruct(Instruction::Stop)),
    ("an emergency stop", |scene| scene.simulation.press_emergency_stop(1.0)),
    ("a set-point too far away", |scene| scene.at_rad[0] += 0.5),
];

#[test]
fn the_arm_brakes_however_set_points_end() {
    let full = Robot::default().limits().velocity_rad_s[0];
    for (period_ms, multiplier) in [(1, 1), (5, 1), (10, 1), (5, 4)] {
        for (label, end) in ENDS {
            let mut scene = SimulationScene::new(period_ms, multiplier, [0.0; 7]);
            scene.speed_up();
            let speed = (scene.trace.last().unwrap()[0] - scene.trace[scene.trace.len() - 2][0])
                / scene.period_s;
            assert!((speed / full - 1.0).abs() < 1e-6, "{speed} rad/s");
            end(&mut scene);
            scene.assert_brakes(&format!("{label}, {period_ms} ms, every {multiplier}"));
        }
    }
}

/// Close to the end of its range, a joint brakes harder and remains within the range.
#[test]
fn the_arm_brakes_within_its_range() {
    let limits = *Robot::default().limits();
    for (label, end) in ENDS {
        if label == "a set-point too far away" {
            continue;
        }
        let mut start_rad = [0.0; 7];
        // Full speed for 0.25 s, and then the braking distance at the limit.
        let room = limits.velocity_rad_s[0].powi(2) / limits.acceleration_rad_s2[0] / 2.0;
        start_rad[0] = limits.upper_rad[0] - limits.velocity_rad_s[0] * 0.26 - room;
        let mut scene = SimulationScene::new(5, 1, start_rad);
        scene.speed_up();
        end(&mut scene);
        scene.assert_brakes(&format!("{label}, at the end of the range"));
    }
}

/// FRI messages have exact commanded positions, and measured positions as reported by the sensors.
#[test]
fn measured_positions_lag_and_commanded_ones_do_not() {
    let mut scene = SimulationScene::new(2, 1, [0.1; 7]);
    // A lag of whole cycles, so that the trace contains the expected positions.
    scene.simulation.position_sensors = PositionSensors::new(scene.period_s, 0.004, 0.0, 0.0);
    scene.speed_up();
    let [.., late, _, now] = scene.trace.as_slice() else { unreachable!() };
    let latest = scene.client.latest().unwrap();
    let off = |a: &Option<Joints>, b: &Joints| {
        a.unwrap().iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    assert!(off(&latest.commanded_rad, now) < 1e-15);
    assert!(off(&latest.measured_rad, late) < 1e-12);
    assert!(now[0] - late[0] > 0.006, "the arm moves");
}

/// The sensors report the torques of the motion with its payload, with the sign of KUKA's
/// controller, also during a stop; external torques are zero.
#[test]
fn measured_torques_are_those_of_the_motion_with_its_load() {
    let program = iiwa_program::Program::from_json(
        r#"{ "version": 1, "mount": { "rpy_deg": [180, 0, 0] },
            "start": { "joints_deg": [0, 30, 0, -60, 0, 90, 0] },
            "motions": [
                { "type": "load", "load": { "mass_kg": 5, "center_mm": [0, 20, 90] } },
                { "type": "ptp", "joints_deg": [60, 70, 20, -20, 10, 60, 50] }] }"#,
    )
    .unwrap();
    let robot = Robot::default();
    let start_rad = *program.start.joints_rad().unwrap();
    let config = ControllerConfig { period_ms: 1, receive_multiplier: 1, format: Format::V1 };
    let mut simulation = Simulation::new(robot.clone(), start_rad, config, 1);
    let trajectory = plan(&robot, start_rad, program.into()).unwrap();
    simulation.begin(RUN, trajectory.clone()).unwrap();
    let mut message = Vec::new();
    let mut largest = 0.0_f64;
    let ticks = |simulation: &mut Simulation, count: usize, message: &mut Vec<u8>| {
        let mut trail = Vec::new();
        for _ in 0..count {
            simulation.tick(message);
            trail.push((*simulation.position(), simulation.torques));
        }
        trail
    };
    for (i, (_, torques)) in ticks(&mut simulation, 200, &mut message).iter().enumerate() {
        let planned = trajectory.torques_at((i + 1) as f64 * 1e-3).torque_nm;
        largest = largest.max(planned[1].abs());
        for j in 0..7 {
            assert!((torques.measured_nm[j] + planned[j]).abs() < 1e-6, "{i}, A{}", j + 1);
            assert_eq!(torques.external_nm[j], 0.0);
        }
    }
    assert!(largest > 40.0, "{largest}");
    // During braking, by differences of positions.
    simulation.carry_out(Instruction::Stop).unwrap();
    let arm = trajectory.path().dynamics(iiwa_program::MotionIndex::new(1));
    for (k, three) in ticks(&mut simulation, 300, &mut message).windows(3).enumerate() {
        let [a, b, c] = [three[0].0, three[1].0, three[2].0];
        let velocity = std::array::from_fn(|j| (c[j] - a[j]) / 2e-3);
        let acceleration = std::array::from_fn(|j| (c[j] - 2.0 * b[j] + a[j]) / 1e-6);
        let expected = arm.torques(&b, &velocity, &acceleration);
        for j in 0..7 {
            let off = three[1].1.measured_nm[j] + expected[j];
            assert!(off.abs() < 0.5, "{k}, A{}: off by {off} Nm", j + 1);
        }
    }
}
