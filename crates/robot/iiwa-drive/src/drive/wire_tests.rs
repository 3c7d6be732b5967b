//! Drive output on the wire under network faults, judged by the datagrams only.
//!
//! A simulated controller sends messages and receives answers over a network that loses,
//! duplicates, delays and reorders them. The sequence of answers sent during active commanding must
//! satisfy bounds on these quantities:
//!
//! - velocity: the position difference of two answers over the time between the answered messages,
//!   by
//!   the controller's cycles;
//! - acceleration: the difference of two such velocities over the mean of their times. Before the
//!   first answer, the robot is at rest at the position in the first message. Where messages are
//!   missing, the times between answers are longer, because the controller extrapolates the motion;
//! - position: within the joint range;
//! - jump: the distance between the position of an answer and the robot position in the answered
//!   message.
//!
//! While set-points are missing, a controller moves the robot on its own: some controllers
//! extrapolate the motion, others stop it. If the distance from the commanded position becomes too
//! large, the first answer afterwards may restart at the robot position, with its mean velocity
//! since the previous message; these restarts are counted.
//!
//! An ordinary test makes 200 runs; with `IIWASIM_LONG=1`, it makes 1000.

#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::needless_range_loop,
    reason = "counts are small, and joints index several arrays"
)]

mod cell;
mod judge;
mod network;
mod trajectories;

use std::{
    collections::HashMap,
    net::SocketAddr,
    time::{Duration, Instant},
};

use fastrand::Rng;
use iiwa_fri::{Controller, Format, SessionState};
use iiwa_kin::Robot;
use iiwa_link::TimedJoints;
use iiwa_program::{Motion, Program, Ptp, Sources, Start, Workcell};

use self::{
    cell::{CABINET, Cell, Missing},
    trajectories::{sampled, trajectories},
};
use super::responder::Reception;

/// Number of successful runs, reasons of failures, maximum values on the wire, and restarts.
#[derive(Debug, Default)]
struct Tally {
    successful: u32,
    reasons: HashMap<String, u32>,
    worst: [f64; 3],
    restarts: u32,
}

/// Makes one run with random faults and, in half of the cases, a stop.
fn run(seed: u64, trajectory: &TimedJoints, tally: &mut Tally) {
    let mut random = Rng::with_seed(seed);
    let period_ms = [1, 5, 10][random.usize(0..3)];
    let multiplier = random.u32(1..6);
    let missing = [Missing::Extrapolate, Missing::Stop][random.usize(0..2)];
    let mut start = trajectory.joints_rad[0];
    if random.bool() {
        let range = Robot::default().limits().upper_rad;
        for j in 0..7 {
            start[j] = (start[j] + 0.008 * (2.0 * random.f64() - 1.0)).clamp(-range[j], range[j]);
        }
    }
    let mut cell = Cell::new(seed, period_ms, multiplier, missing, start);
    cell.begin(trajectory);
    // Up to losses that end a session, and beyond.
    let share = |random: &mut Rng| [0.0, 0.005, 0.02][random.usize(0..3)];
    let (down, up) = (&mut cell.down, &mut cell.up);
    (down.loss, up.loss) = (share(&mut random), share(&mut random));
    (down.doubled, up.doubled) = (10.0 * share(&mut random), 10.0 * share(&mut random));
    (down.delayed, up.delayed) = (share(&mut random), share(&mut random));
    cell.forges = random.f64() < 0.3;
    let duration = trajectory.duration_s() / cell.period_s();
    let stop_at = random.bool().then(|| cell.cycle + (duration * random.f64()) as u64);
    let set_at = (random.f64() < 0.2).then(|| cell.cycle + (duration * random.f64()) as u64);
    let begun = cell.cycle;
    let max_cycles = (duration as u64) + (4.0 / cell.period_s()) as u64;
    while cell.end.is_none() {
        assert!(cell.cycle < begun + max_cycles, "seed {seed}: the run never ends");
        // An interval in which all datagrams are lost.
        if random.f64() < 0.15 * cell.period_s() {
            let until = cell.cycle + random.u64(1..=5) * u64::from(multiplier);
            match random.u32(0..3) {
                0 => cell.down.dead_until = until,
                1 => cell.up.dead_until = until,
                _ => (cell.down.dead_until, cell.up.dead_until) = (until, until),
            }
        }
        if stop_at == Some(cell.cycle) {
            cell.responder.stop(true);
        }
        if set_at == Some(cell.cycle) {
            cell.clock_ahead += random.u64(1..100_000);
        }
        cell.tick();
    }
    cell.finish();
    let case = format!("seed {seed}, {period_ms} ms, every {multiplier}, {missing:?}");
    let (worst, restarts) = cell.judge();
    tally.restarts += restarts;
    for (worst_so_far, share) in tally.worst.iter_mut().zip(worst) {
        *worst_so_far = worst_so_far.max(share);
    }
    let ended = cell.end.and_then(|end| end.error).map(|error| error.message);
    assert!(
        worst[0] <= 1.02 && worst[1] <= 1.3 && worst[2] <= 1.0 + 1e-9,
        "{case}: {worst:?}, {ended:?}"
    );
    match ended {
        None => tally.successful += 1,
        Some(reason) => {
            let words = reason.chars().filter(|c| !c.is_ascii_digit() && *c != '.').collect();
            *tally.reasons.entry(words).or_default() += 1;
        }
    }
}

#[test]
fn the_wire_keeps_the_limits_on_any_network() {
    let (runs, plans) =
        if std::env::var_os("IIWASIM_LONG").is_some() { (1000, 60) } else { (200, 20) };
    let begun = Instant::now();
    let trajectories = trajectories(plans);
    let planned = begun.elapsed();
    let mut tally = Tally::default();
    for seed in 0..runs {
        run(seed, &trajectories[seed as usize % plans], &mut tally);
    }
    println!("{runs} runs, planned in {planned:?}, {:?} in all: {tally:#?}", begun.elapsed());
    assert!(u64::from(tally.successful) > runs / 8, "too few runs are successful");
    assert!(tally.worst[0] > 0.98 && tally.worst[1] > 0.9, "the limits are not reached");
}

/// Forged datagrams of a sender without access to the network traffic do not affect a run.
#[test]
fn forged_datagrams_do_not_end_a_run() {
    let trajectory = &trajectories(1)[0];
    for seed in 0..20 {
        let mut cell = Cell::new(seed, 5, 1, Missing::Stop, trajectory.joints_rad[0]);
        cell.begin(trajectory);
        cell.forges = true;
        let begun = cell.cycle;
        cell.until(2000, |cell| cell.end.is_some());
        let end = cell.end.take().unwrap();
        assert_eq!(end.error, None);
        let took_s = (cell.cycle - begun) as f64 * cell.period_s();
        assert!((took_s - trajectory.duration_s()).abs() < 0.02, "{took_s} s");
        assert!(cell.responder.ignored() > 3, "{} ignored", cell.responder.ignored());
        cell.finish();
        let ([velocity, acceleration, jump], _) = cell.judge();
        assert!(velocity < 1.01 && acceleration < 1.1 && jump <= 1.0);
    }
}

/// A restarted controller, with another counter and clock, is detected within some cycles.
#[test]
fn a_restarted_controller_is_detected() {
    let trajectory = &trajectories(1)[0];
    for moves in [false, true] {
        let mut cell = Cell::new(1, 5, 1, Missing::Extrapolate, trajectory.joints_rad[0]);
        if moves {
            cell.begin(trajectory);
            (0..30).for_each(|_| cell.tick());
        } else {
            cell.until(2000, |cell| cell.controller.state() == SessionState::MonitoringReady);
        }
        cell.controller = Controller::new(cell.config);
        cell.clock_ahead = 1_000_000;
        cell.sent.clear();
        cell.until(10, |cell| cell.accepted[0].is_some_and(|counter| counter < 10));
        (0..3).for_each(|_| cell.tick());
        let error = cell.end.take().map(|end| end.error.unwrap().message);
        assert_eq!(error.is_some(), moves, "{error:?}");
        assert!(error.is_none_or(|error| error.contains("restarted")));
        // The next run works.
        cell.begin(&sampled(&Program {
            robot: None,
            start: Start::Joints(cell.q),
            motions: vec![Motion::Ptp(Ptp::to([0.0; 7]))],
            workcell: Workcell::default(),
            sources: Sources::default(),
        }));
        cell.until(5000, |cell| cell.end.is_some());
        assert_eq!(cell.end.take().unwrap().error, None);
    }
}

/// Any number of consistent datagrams between two messages of the controller is ignored.
#[test]
fn a_burst_between_two_messages_is_ignored() {
    let trajectory = &trajectories(1)[0];
    let mut cell = Cell::new(1, 5, 1, Missing::Extrapolate, trajectory.joints_rad[0]);
    cell.begin(trajectory);
    (0..30).for_each(|_| cell.tick());
    let mut datagram = Vec::new();
    for i in 0..50 {
        let forged = iiwa_fri::Monitoring {
            sequence: 1_000_000 + i,
            session: SessionState::MonitoringWait,
            send_period_ms: 5,
            ..iiwa_fri::Monitoring::default()
        };
        Format::V1.encode_monitoring(&forged, &mut datagram);
        cell.deliver(&datagram);
    }
    assert_eq!(cell.responder.ignored(), 50);
    cell.until(5000, |cell| cell.end.is_some());
    assert_eq!(cell.end.unwrap().error, None);
}

/// Messages from another port are ignored, unless the session is silent.
#[test]
fn another_port_is_ignored_while_the_session_is_active() {
    let mut cell = Cell::new(1, 5, 1, Missing::Stop, [0.0; 7]);
    cell.until(2000, |cell| cell.controller.state() == SessionState::MonitoringReady);
    let mut datagram = Vec::new();
    for silent in [false, true] {
        let next = iiwa_fri::Monitoring {
            sequence: cell.accepted[0].unwrap() + 1,
            session: SessionState::MonitoringReady,
            send_period_ms: 5,
            ..iiwa_fri::Monitoring::default()
        };
        Format::V1.encode_monitoring(&next, &mut datagram);
        let from = SocketAddr::new(CABINET, 40_000);
        let now = cell.now() + Duration::from_secs(u64::from(silent));
        let reception = cell.responder.receive(&datagram, from, now, &mut Vec::new());
        assert_eq!(reception != Reception::Ignored, silent);
    }
}
