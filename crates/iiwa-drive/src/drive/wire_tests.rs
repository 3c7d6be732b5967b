//! What the drive puts on the wire, whatever the network does: read from the datagrams, not from the
//! drive.
//!
//! A simulated controller sends messages and takes answers over a network that loses, doubles, delays
//! and reorders them. Of the answers that the drive has sent while commanding was active, in their
//! order, this is asked for:
//!
//! - velocity: the difference of the positions of two answers over the time between the messages that
//!   they answer, by the controller's own cycles;
//! - acceleration: the difference of two such velocities over the mean of their times. Before the first
//!   answer, the arm rests where the first message has it. Where messages are missing, the times between
//!   answers are longer: the controller goes on as the arm went;
//! - position: within the range;
//! - leap: the distance of an answer's position from where the arm is by the message that it answers.
//!
//! Where set-points are missing, a controller moves the arm by itself: one goes on as the arm went, another
//! stops it. If that is too far from what was commanded, the first answer afterwards may go on from where
//! the arm is, at its mean velocity since the message before, instead; this is counted.
//!
//! An ordinary test makes 200 runs, and 1000 with `IIWASIM_LONG=1`.

#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::needless_range_loop,
    reason = "counts are small, and seven joints go along in several arrays"
)]

use std::{
    collections::HashMap,
    net::{IpAddr, Ipv4Addr, SocketAddr},
    time::{Duration, Instant},
};

use fastrand::Rng;
use iiwa_fri::{Controller, ControllerConfig, Format, Reading, SessionState};
use iiwa_kin::{Joints, Limits, Robot};
use iiwa_link::TimedJoints;
use iiwa_path::{Blend, JointPath, Motion, Program, Ptp};
use iiwa_traj::{Timing, Trajectory};

use super::{
    answerer::{Answerer, Event, Outcome},
    setpoints::Over,
};

/// One direction of the network.
#[derive(Default)]
struct Network {
    loss: f64,
    doubled: f64,
    delayed: f64,
    /// Up to this cycle nothing arrives.
    dead_until: u64,
    under_way: Vec<(u64, Vec<u8>)>,
}

impl Network {
    fn send(&mut self, datagram: &[u8], cycle: u64, random: &mut Rng) {
        if cycle < self.dead_until || random.f64() < self.loss {
            return;
        }
        for _ in 0..if random.f64() < self.doubled { 2 } else { 1 } {
            let late = if random.f64() < self.delayed { random.u64(1..4) } else { 0 };
            self.under_way.push((cycle + late, datagram.to_vec()));
        }
    }

    /// What has arrived by `cycle`: what was sent last comes first, now and then.
    fn receive(&mut self, cycle: u64, random: &mut Rng) -> Vec<Vec<u8>> {
        let mut arrived: Vec<_> = self.under_way.extract_if(.., |(due, _)| *due <= cycle).collect();
        if self.delayed > 0.0 && random.bool() {
            arrived.reverse();
        }
        arrived.into_iter().map(|(_, datagram)| datagram).collect()
    }
}

/// What a controller does while set-points are missing.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Missing {
    GoesOn,
    Stops,
}

/// The controller, its arm and the network.
struct Cell {
    random: Rng,
    limits: Limits,
    config: ControllerConfig,
    controller: Controller,
    missing: Missing,
    cycle: u64,
    begun: Instant,
    q: Joints,
    dq: Joints,
    /// The set-point in force, and cycles within which the arm is to be there.
    target: Option<(Joints, u32)>,
    down: Network,
    up: Network,
    answerer: Answerer,
    /// By counter.
    sent: HashMap<u32, Sent>,
    /// The last message that the drive has heard, and the one before.
    heard: [Option<u32>; 2],
    /// The last cycle in which the controller moved or stopped the arm by itself.
    alone: u64,
    over: Option<Over>,
    /// Datagrams that somebody else sends from the controller's address.
    forges: bool,
    /// What the controller's clock is ahead, in cycles.
    clock_ahead: u64,
    wire: Vec<Answer>,
}

/// A message of the controller.
#[derive(Clone, Copy, Debug)]
struct Sent {
    cycle: u64,
    session: SessionState,
    arm_rad: Joints,
}

/// An answer in commanding, as read from the wire.
#[derive(Clone, Copy, Debug)]
struct Answer {
    t_s: f64,
    at_rad: Joints,
    /// Where the arm was by the message.
    arm_rad: Joints,
    /// How fast it was since the message before, if the controller has moved it by itself since the last
    /// answer.
    anew: Option<Joints>,
}

const CABINET: IpAddr = IpAddr::V4(Ipv4Addr::LOCALHOST);

impl Cell {
    fn new(
        seed: u64,
        period_ms: u32,
        receive_multiplier: u32,
        missing: Missing,
        at: Joints,
    ) -> Self {
        let config = ControllerConfig { period_ms, receive_multiplier, format: Format::V1 };
        let limits = *Robot::default().limits();
        Self {
            random: Rng::with_seed(seed),
            limits,
            config,
            controller: Controller::new(config),
            missing,
            cycle: 0,
            begun: Instant::now(),
            q: at,
            dq: [0.0; 7],
            target: None,
            down: Network::default(),
            up: Network::default(),
            answerer: Answerer::new(CABINET, &limits),
            sent: HashMap::new(),
            heard: [None; 2],
            alone: 0,
            over: None,
            forges: false,
            clock_ahead: 0,
            wire: Vec::new(),
        }
    }

    fn period_s(&self) -> f64 {
        f64::from(self.config.period_ms) * 1e-3
    }

    fn now(&self) -> Instant {
        self.begun + Duration::from_secs_f64(self.cycle as f64 * self.period_s())
    }

    /// Moves the arm by a cycle, no faster than 1.1 of its limits.
    fn follow(&mut self) {
        let before = self.q;
        let period_s = self.period_s();
        if self.controller.state() != SessionState::CommandingActive {
            self.target = None;
        }
        let setpoint = self.controller.setpoint().copied();
        if let Some(setpoint) = setpoint
            && self.target.is_none_or(|(target, _)| target != setpoint)
        {
            self.target = Some((setpoint, self.config.receive_multiplier));
        }
        let Some((target, left)) = &mut self.target else { return };
        let step: Joints = match (setpoint, self.missing) {
            (Some(_), _) => {
                let share = 1.0 / f64::from((*left).max(1));
                std::array::from_fn(|j| (target[j] - before[j]) * share)
            }
            (None, Missing::GoesOn) => self.dq.map(|dq| dq * period_s),
            (None, Missing::Stops) => [0.0; 7],
        };
        *left = left.saturating_sub(1);
        if setpoint.is_none() {
            self.alone = self.cycle;
        }
        let Limits { velocity_rad_s, position_rad, .. } = self.limits;
        self.q = std::array::from_fn(|j| {
            let most = 1.1 * velocity_rad_s[j] * period_s;
            (before[j] + step[j].clamp(-most, most)).clamp(-position_rad[j], position_rad[j])
        });
        self.dq = std::array::from_fn(|j| (self.q[j] - before[j]) / period_s);
    }

    fn tick(&mut self) {
        self.cycle += 1;
        self.controller.advance();
        self.follow();
        let stamp = (self.cycle + self.clock_ahead) as f64 * self.period_s();
        let reading = Reading {
            measured_rad: self.q,
            commanded_rad: self.q,
            ipo_rad: Some(self.q),
            time: Duration::from_secs_f64(stamp),
            ..Reading::default()
        };
        let mut datagram = Vec::new();
        if self.controller.message(&reading, &mut datagram) {
            let message = Format::V1.decode_monitoring(&datagram).unwrap();
            let sent = Sent { cycle: self.cycle, session: message.session, arm_rad: self.q };
            self.sent.insert(message.sequence, sent);
            self.down.send(&datagram, self.cycle, &mut self.random);
            if self.forges && self.random.f64() < 0.02 {
                self.forge(&datagram);
            }
        }
        for datagram in self.down.receive(self.cycle, &mut self.random) {
            self.deliver(&datagram);
        }
        self.answerer.wait(self.now());
        self.take_events();
        for answer in self.up.receive(self.cycle, &mut self.random) {
            self.controller.receive(&answer).unwrap();
        }
    }

    /// A message that is not the controller's, as one would send who does not hear the controller.
    fn forge(&mut self, datagram: &[u8]) {
        let mut forged = Format::V1.decode_monitoring(datagram).unwrap();
        match self.random.u32(0..6) {
            0 => forged.sequence = forged.sequence.wrapping_add(self.random.u32(2000..1 << 30)),
            1 => forged.sequence = forged.sequence.wrapping_sub(self.random.u32(2000..1 << 30)),
            2 => {
                forged.sequence = forged.sequence.wrapping_add(1);
                forged.time = forged.time.map(|time| time + Duration::from_hours(1));
            }
            3 => {
                forged.sequence = forged.sequence.wrapping_add(1);
                forged.receive_multiplier += 1;
            }
            4 => {
                forged.sequence = forged.sequence.wrapping_add(1);
                forged.commanded_rad = Some([0.9; 7]);
                forged.measured_rad = Some([-0.9; 7]);
            }
            _ => {
                forged.sequence = 3;
                forged.session = SessionState::MonitoringWait;
            }
        }
        let mut bytes = Vec::new();
        Format::V1.encode_monitoring(&forged, &mut bytes);
        self.deliver(&bytes);
    }

    fn deliver(&mut self, datagram: &[u8]) {
        let mut answer = Vec::new();
        let from = SocketAddr::new(CABINET, 30200);
        let outcome = self.answerer.receive(datagram, from, self.now(), &mut answer);
        self.take_events();
        assert_eq!(outcome == Outcome::Answered, !answer.is_empty());
        if outcome != Outcome::Nothing {
            let message = Format::V1.decode_monitoring(datagram).unwrap();
            self.heard = [Some(message.sequence), self.heard[0]];
        }
        if outcome == Outcome::Answered {
            self.read(&answer);
            self.up.send(&answer, self.cycle, &mut self.random);
        }
    }

    fn take_events(&mut self) {
        for event in self.answerer.take_events() {
            if let Event::Over(over) = event {
                assert!(self.over.is_none(), "a run ends once");
                self.over = Some(over);
            }
        }
    }

    /// Reads an answer from the wire.
    fn read(&mut self, answer: &[u8]) {
        let answer = Format::V1.decode_command(answer).unwrap();
        // After a silence, what is forged may count for once: the controller takes no answer to it.
        let Some(&Sent { cycle, session, arm_rad }) = self.sent.get(&answer.reflected) else {
            return;
        };
        if session != SessionState::CommandingActive {
            return;
        }
        let t_s = cycle as f64 * self.period_s();
        let last_s = self.wire.last().map_or(0.0, |last| last.t_s);
        let anew = self.heard[1].filter(|_| self.alone as f64 * self.period_s() > last_s);
        let anew = anew.and_then(|before| self.sent.get(&before)).map(|before| {
            let by_s = (cycle - before.cycle) as f64 * self.period_s();
            std::array::from_fn(|j| (arm_rad[j] - before.arm_rad[j]) / by_s)
        });
        let at_rad = answer.joints_rad.expect("positions, in commanding");
        self.wire.push(Answer { t_s, at_rad, arm_rad, anew });
    }

    fn until(&mut self, most: u32, holds: impl Fn(&Self) -> bool) {
        for _ in 0..most {
            if holds(self) {
                return;
            }
            self.tick();
        }
        panic!("it does not come about within {most} cycles: {:?}", self.controller.state());
    }

    /// Begins the trajectory; the session commands afterwards.
    fn begin(&mut self, trajectory: &TimedJoints) {
        self.until(2000, |cell| cell.controller.state() == SessionState::MonitoringReady);
        let now = self.now();
        self.answerer.run(1, Box::new(trajectory.clone()), now);
        self.tick();
        self.controller.request_commanding();
        self.until(2000, |cell| cell.controller.state() == SessionState::CommandingActive);
    }

    /// The robot program ends commanding once the run is over.
    fn finish(&mut self) {
        (0..3).for_each(|_| self.tick());
        self.controller.release();
        (0..5).for_each(|_| self.tick());
    }

    /// The largest velocity, acceleration and leap, each as a share of what it may be, and how often an
    /// answer began anew from where the arm was.
    fn judge(&self) -> ([f64; 3], u32) {
        let Limits { velocity_rad_s, acceleration_rad_s2, position_rad, .. } = self.limits;
        let step_s = f64::from(self.config.receive_multiplier) * self.period_s();
        let away = velocity_rad_s.map(|speed| speed * (0.03 + 3.0 * step_s));
        let (mut worst, mut begun_anew) = ([0.0_f64; 3], 0);
        let Some(first) = self.wire.first() else { return (worst, 0) };
        let mut before =
            History { t_s: first.t_s - step_s, at_rad: first.arm_rad, ..History::default() };
        before.step_s = step_s;
        for answer in &self.wire {
            let share = |history: &History| {
                let (now, bend) = history.to(answer);
                let most = |found: Joints, limits: Joints| {
                    (0..7).map(|j| found[j].abs() / limits[j]).fold(0.0, f64::max)
                };
                [most(now, velocity_rad_s), most(bend, acceleration_rad_s2)]
            };
            let mut found = share(&before);
            let mut next = before.next(answer);
            if let Some(speed) = answer.anew {
                let anew =
                    History { t_s: answer.t_s - step_s, at_rad: answer.arm_rad, speed, step_s };
                if found[0] > 1.02 || found[1] > 1.3 {
                    begun_anew += 1;
                    (found, next) = (share(&anew), anew.next(answer));
                }
            }
            let leap = (0..7).map(|j| (answer.at_rad[j] - answer.arm_rad[j]).abs() / away[j]);
            let found = [found[0], found[1], leap.fold(0.0, f64::max)];
            worst = std::array::from_fn(|i| worst[i].max(found[i]));
            for j in 0..7 {
                assert!(answer.at_rad[j].abs() <= position_rad[j] + 1e-9, "joint {}", j + 1);
            }
            before = next;
        }
        (worst, begun_anew)
    }
}

/// The answers up to one.
#[derive(Default)]
struct History {
    t_s: f64,
    at_rad: Joints,
    /// Velocity since the answer before, and the time from there.
    speed: Joints,
    step_s: f64,
}

impl History {
    /// Velocity and acceleration up to the next answer.
    fn to(&self, next: &Answer) -> (Joints, Joints) {
        let step_s = next.t_s - self.t_s;
        let speed: Joints = std::array::from_fn(|j| (next.at_rad[j] - self.at_rad[j]) / step_s);
        let span_s = 0.5 * (step_s + self.step_s);
        (speed, std::array::from_fn(|j| (speed[j] - self.speed[j]) / span_s))
    }

    fn next(&self, next: &Answer) -> Self {
        let (speed, _) = self.to(next);
        Self { t_s: next.t_s, at_rad: next.at_rad, speed, step_s: next.t_s - self.t_s }
    }
}

/// Full speed between places anywhere in the range, its ends among them.
fn program(random: &mut Rng) -> Program {
    let range = Robot::default().limits().position_rad;
    loop {
        let mut place = || range.map(|q| q * (2.6 * random.f64() - 1.3).clamp(-1.0, 1.0));
        let start_rad = place();
        let targets = [place(), place(), place()];
        let mut motions: Vec<_> = targets.map(Ptp::to).into();
        let blend = random.f64() < 0.7;
        for ptp in &mut motions[..2] {
            ptp.blend = blend.then(|| Blend::Fraction(0.5 * random.f64()));
        }
        let motions = motions.into_iter().map(Motion::Ptp).collect();
        let program = Program { robot: None, start_rad, motions };
        if JointPath::new(&program, &Robot::default()).is_ok() {
            return program;
        }
    }
}

/// Points as clients send them: every 4 ms, and at the end.
fn sampled(program: &Program) -> TimedJoints {
    let path = JointPath::new(program, &Robot::default()).unwrap();
    let plan = Trajectory::plan(&path, Timing::default()).unwrap();
    let end_s = plan.cycle_time_s();
    let steps = (end_s / 0.004).floor();
    let mut t_s: Vec<f64> = (0..steps as u32).map(|i| f64::from(i) * 0.004).collect();
    t_s.push(end_s);
    let joints_rad = t_s.iter().map(|t_s| plan.at(*t_s).q).collect();
    let trajectory = TimedJoints { t_s, joints_rad };
    trajectory.check(Robot::default().limits(), &program.start_rad).unwrap();
    trajectory
}

fn trajectories(count: usize) -> Vec<TimedJoints> {
    let mut random = Rng::with_seed(12);
    (0..count).map(|_| sampled(&program(&mut random))).collect()
}

/// How often runs ended well, and the worst that was on the wire.
#[derive(Debug, Default)]
struct Tally {
    well: u32,
    reasons: HashMap<String, u32>,
    worst: [f64; 3],
    begun_anew: u32,
}

/// One run with random faults and, every other time, a stop.
fn run(seed: u64, trajectory: &TimedJoints, tally: &mut Tally) {
    let mut random = Rng::with_seed(seed);
    let period_ms = [1, 5, 10][random.usize(0..3)];
    let multiplier = random.u32(1..6);
    let missing = [Missing::GoesOn, Missing::Stops][random.usize(0..2)];
    let mut start = trajectory.joints_rad[0];
    if random.bool() {
        let range = Robot::default().limits().position_rad;
        for j in 0..7 {
            start[j] = (start[j] + 0.008 * (2.0 * random.f64() - 1.0)).clamp(-range[j], range[j]);
        }
    }
    let mut cell = Cell::new(seed, period_ms, multiplier, missing, start);
    cell.begin(trajectory);
    // Up to what ends a session, and more.
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
    let most = (duration as u64) + (4.0 / cell.period_s()) as u64;
    while cell.over.is_none() {
        assert!(cell.cycle < begun + most, "seed {seed}: the run never ends");
        // A section in which nothing gets through.
        if random.f64() < 0.15 * cell.period_s() {
            let until = cell.cycle + random.u64(1..=5) * u64::from(multiplier);
            match random.u32(0..3) {
                0 => cell.down.dead_until = until,
                1 => cell.up.dead_until = until,
                _ => (cell.down.dead_until, cell.up.dead_until) = (until, until),
            }
        }
        if stop_at == Some(cell.cycle) {
            cell.answerer.stop(true);
        }
        if set_at == Some(cell.cycle) {
            cell.clock_ahead += random.u64(1..100_000);
        }
        cell.tick();
    }
    cell.finish();
    let place = format!("seed {seed}, {period_ms} ms, every {multiplier}, {missing:?}");
    let (worst, begun_anew) = cell.judge();
    tally.begun_anew += begun_anew;
    for (most, found) in tally.worst.iter_mut().zip(worst) {
        *most = most.max(found);
    }
    let ended = cell.over.and_then(|over| over.error).map(|error| error.message);
    assert!(
        worst[0] <= 1.02 && worst[1] <= 1.3 && worst[2] <= 1.0 + 1e-9,
        "{place}: {worst:?}, {ended:?}"
    );
    match ended {
        None => tally.well += 1,
        Some(why) => {
            let words = why.chars().filter(|c| !c.is_ascii_digit() && *c != '.').collect();
            *tally.reasons.entry(words).or_default() += 1;
        }
    }
}

#[test]
fn the_wire_keeps_the_limits_whatever_the_network_does() {
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
    assert!(u64::from(tally.well) > runs / 8, "too few runs come to their end to say much");
    assert!(tally.worst[0] > 0.98 && tally.worst[1] > 0.9, "the limits are not reached");
}

/// Datagrams of one who does not hear the controller do not end a run, and cost it nothing.
#[test]
fn forged_datagrams_end_nothing() {
    let trajectory = &trajectories(1)[0];
    for seed in 0..20 {
        let mut cell = Cell::new(seed, 5, 1, Missing::Stops, trajectory.joints_rad[0]);
        cell.begin(trajectory);
        cell.forges = true;
        let begun = cell.cycle;
        cell.until(2000, |cell| cell.over.is_some());
        let over = cell.over.take().unwrap();
        assert_eq!(over.error, None);
        let took_s = (cell.cycle - begun) as f64 * cell.period_s();
        assert!((took_s - trajectory.duration_s()).abs() < 0.02, "{took_s} s");
        assert!(cell.answerer.ignored() > 3, "{} ignored", cell.answerer.ignored());
        cell.finish();
        let ([velocity, acceleration, leap], _) = cell.judge();
        assert!(velocity < 1.01 && acceleration < 1.1 && leap <= 1.0);
    }
}

/// A controller that really starts again, with another counter and clock, is noticed within some cycles.
#[test]
fn a_controller_that_starts_again_is_noticed() {
    let trajectory = &trajectories(1)[0];
    for moves in [false, true] {
        let mut cell = Cell::new(1, 5, 1, Missing::GoesOn, trajectory.joints_rad[0]);
        if moves {
            cell.begin(trajectory);
            (0..30).for_each(|_| cell.tick());
        } else {
            cell.until(2000, |cell| cell.controller.state() == SessionState::MonitoringReady);
        }
        cell.controller = Controller::new(cell.config);
        cell.clock_ahead = 1_000_000;
        cell.sent.clear();
        cell.until(10, |cell| cell.heard[0].is_some_and(|counter| counter < 10));
        (0..3).for_each(|_| cell.tick());
        let error = cell.over.take().map(|over| over.error.unwrap().message);
        assert_eq!(error.is_some(), moves, "{error:?}");
        assert!(error.is_none_or(|error| error.contains("started again")));
        // And everything works afterwards.
        cell.begin(&sampled(&Program {
            robot: None,
            start_rad: cell.q,
            motions: vec![Motion::Ptp(Ptp::to([0.0; 7]))],
        }));
        cell.until(5000, |cell| cell.over.is_some());
        assert_eq!(cell.over.take().unwrap().error, None);
    }
}

/// However many datagrams agree with each other, between two messages of the controller they are not its
/// own.
#[test]
fn a_burst_between_two_messages_changes_nothing() {
    let trajectory = &trajectories(1)[0];
    let mut cell = Cell::new(1, 5, 1, Missing::GoesOn, trajectory.joints_rad[0]);
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
    assert_eq!(cell.answerer.ignored(), 50);
    cell.until(5000, |cell| cell.over.is_some());
    assert_eq!(cell.over.unwrap().error, None);
}

/// A port that is not the session's is not listened to, unless the session has been silent.
#[test]
fn another_port_is_foreign_while_the_session_lives() {
    let mut cell = Cell::new(1, 5, 1, Missing::Stops, [0.0; 7]);
    cell.until(2000, |cell| cell.controller.state() == SessionState::MonitoringReady);
    let mut datagram = Vec::new();
    for silent in [false, true] {
        let next = iiwa_fri::Monitoring {
            sequence: cell.heard[0].unwrap() + 1,
            session: SessionState::MonitoringReady,
            send_period_ms: 5,
            ..iiwa_fri::Monitoring::default()
        };
        Format::V1.encode_monitoring(&next, &mut datagram);
        let from = SocketAddr::new(CABINET, 40_000);
        let now = cell.now() + Duration::from_secs(u64::from(silent));
        let outcome = cell.answerer.receive(&datagram, from, now, &mut Vec::new());
        assert_eq!(outcome != Outcome::Nothing, silent);
    }
}
