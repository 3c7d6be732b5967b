//! Traffic between drive and cabinet, read by a relay that loses, duplicates and reorders
//! datagrams.

use std::{
    collections::HashMap,
    net::{SocketAddr, UdpSocket},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread::{self, JoinHandle},
    time::Duration,
};

use iiwa_fri::{Format, SessionState};
use iiwa_kin::{Joints, Robot};
use iiwa_link::{ClientError, TimedJoints};
use iiwa_program::{Blend, Motion, Ptp};
use iiwasim_tests::{ports::free_address, realtime_guard::in_real_time};

use crate::link::{
    rig::{LONG, Rig},
    runs::{sampled, to_command},
};

/// A relay between cabinet and drive.
struct Relay {
    over: Arc<AtomicBool>,
    thread: Option<JoinHandle<Vec<Answer>>>,
}

/// An answer in active commanding.
struct Answer {
    t_s: f64,
    at_rad: Joints,
    /// Robot position in the answered message.
    arm_rad: Joints,
}

impl Relay {
    /// Forwards datagrams that the cabinet sends to `address` to `drive`, and the answers back.
    fn start(address: SocketAddr, drive: SocketAddr, seed: u64, loss: f64) -> Self {
        let outer = UdpSocket::bind(address).unwrap();
        let inner = UdpSocket::bind("127.0.0.1:0").unwrap();
        outer.set_read_timeout(Some(Duration::from_micros(200))).unwrap();
        inner.set_read_timeout(Some(Duration::from_micros(200))).unwrap();
        let over = Arc::new(AtomicBool::new(false));
        let ends = Arc::clone(&over);
        let thread = thread::spawn(move || relay(&ends, &outer, &inner, drive, seed, loss));
        Self { over, thread: Some(thread) }
    }

    /// Stops the relay. Returns the answers in active commanding.
    fn end(mut self) -> Vec<Answer> {
        self.over.store(true, Ordering::Relaxed);
        self.thread.take().unwrap().join().unwrap()
    }
}

fn relay(
    over: &AtomicBool,
    outer: &UdpSocket,
    inner: &UdpSocket,
    drive: SocketAddr,
    seed: u64,
    loss: f64,
) -> Vec<Answer> {
    let mut random = fastrand::Rng::with_seed(seed);
    let (mut messages, mut answers) = (HashMap::new(), Vec::new());
    let mut buffer = [0; 2048];
    // The cabinet, and a message that is delayed until after the next one.
    let (mut cabinet, mut delayed) = (None, None);
    while !over.load(Ordering::Relaxed) {
        if let Ok((length, from)) = outer.recv_from(&mut buffer) {
            cabinet = Some(from);
            let datagram = buffer[..length].to_vec();
            let message = Format::V1.decode_monitoring(&datagram).unwrap();
            if message.session == SessionState::CommandingActive {
                let arm_rad = message.commanded_rad.unwrap();
                messages.insert(message.sequence, (message.time.unwrap().as_secs_f64(), arm_rad));
            }
            match random.f64() / loss {
                ..1.0 => {}
                1.0..2.0 => delayed = Some(datagram),
                2.0..3.0 => {
                    inner.send_to(&datagram, drive).unwrap();
                    inner.send_to(&datagram, drive).unwrap();
                }
                _ => {
                    inner.send_to(&datagram, drive).unwrap();
                    if let Some(late) = delayed.take() {
                        inner.send_to(&late, drive).unwrap();
                    }
                }
            }
        }
        if let Ok((length, _)) = inner.recv_from(&mut buffer) {
            let answer = Format::V1.decode_command(&buffer[..length]).unwrap();
            if let Some((t_s, arm_rad)) = messages.get(&answer.reflected).copied() {
                let at_rad = answer.joints_rad.unwrap();
                answers.push(Answer { t_s, at_rad, arm_rad });
            }
            if random.f64() > loss
                && let Some(cabinet) = cabinet
            {
                outer.send_to(&buffer[..length], cabinet).unwrap();
            }
        }
    }
    answers
}

/// Returns the largest velocity and acceleration as a share of the limits, by differences of the
/// answers over the times of the answered messages; the robot is at rest before.
fn judge(answers: &[Answer], step_s: f64) -> [f64; 2] {
    let robot = Robot::default();
    let limits = robot.limits();
    let mut worst = [0.0_f64; 2];
    let (mut t_s, mut position) = (answers[0].t_s - step_s, answers[0].arm_rad);
    let (mut speed, mut before_s) = ([0.0; 7], step_s);
    for answer in answers {
        let dt_s = answer.t_s - t_s;
        for j in 0..7 {
            let now = (answer.at_rad[j] - position[j]) / dt_s;
            let bend = (now - speed[j]) / (0.5 * (dt_s + before_s));
            worst[0] = worst[0].max(now.abs() / limits.velocity_rad_s[j]);
            worst[1] = worst[1].max(bend.abs() / limits.acceleration_rad_s2[j]);
            speed[j] = now;
        }
        (t_s, position, before_s) = (answer.t_s, answer.at_rad, dt_s);
    }
    worst
}

/// Minimum number of answers for a judgement of the motion.
const FEWEST_ANSWERS: usize = 10;

#[test]
fn the_wire_keeps_the_limits() {
    in_real_time(|| {
        let rad = |deg: Joints| deg.map(f64::to_radians);
        let motions = vec![
            Motion::Ptp(
                Ptp::to(rad([90.0, 40.0, 0.0, -90.0, 0.0, 80.0, 0.0])).blend(Blend::Fraction(0.3)),
            ),
            Motion::Ptp(Ptp::to(rad([0.0, -40.0, 60.0, 0.0, 90.0, -80.0, 90.0]))),
        ];
        let trajectory = sampled(&to_command(motions), 0.004);
        for (period_ms, multiplier) in [(5, 1), (10, 3)] {
            let (answers, error) = (0..20)
                .map(|seed| relayed(&trajectory, period_ms, multiplier, seed))
                .find(|(answers, error)| {
                    let error = error.as_deref().unwrap_or_default();
                    // The machine was suspended for so long that the drive restarted at the robot
                    // position; or losses in a row ended the session before the robot was moving.
                    answers.len() > FEWEST_ANSWERS && !error.contains("from its set-point")
                })
                .expect("neither a machine nor a network that fails again and again");
            let step_s = f64::from(period_ms * multiplier) * 1e-3;
            let [velocity, acceleration] = judge(&answers, step_s);
            println!(
                "{period_ms} ms, every {multiplier}: {} answers, {velocity:.4} of the velocity and \
             {acceleration:.4} of the acceleration limits, {error:?}",
                answers.len()
            );
            assert!(velocity <= 1.02 && acceleration <= 1.3);
        }
    });
}

/// Runs the trajectory over a relay that loses, delays and duplicates 1 % of the datagrams each.
fn relayed(
    trajectory: &TimedJoints,
    period_ms: u32,
    multiplier: u32,
    seed: u64,
) -> (Vec<Answer>, Option<String>) {
    let mut rig = Rig::parts(period_ms);
    let between = free_address();
    rig.cabinet_config.fri_client = between;
    rig.cabinet_config.receive_multiplier = multiplier;
    let relay = Relay::start(between, rig.drive_config.fri, seed, 0.01);
    rig.start_drive();
    rig.start_cabinet();
    rig.wait_until_ready();
    let error = match rig.client().run_trajectory(trajectory.clone(), Some(LONG)) {
        Ok(_) => None,
        // The network, or the machine, was too bad.
        Err(ClientError::Refused { refusal, .. }) => Some(refusal.message),
        Err(error) => panic!("{error}"),
    };
    drop(rig);
    (relay.end(), error)
}
