//! A simulated controller with its robot, a network and the drive side of FRI.

use std::{
    collections::HashMap,
    net::{IpAddr, Ipv4Addr, SocketAddr},
    time::{Duration, Instant},
};

use fastrand::Rng;
use iiwa_fri::{Controller, ControllerConfig, Format, Reading, SessionState};
use iiwa_kin::{Joints, Limits, Robot};
use iiwa_link::TimedJoints;

use super::network::Network;
use crate::drive::{
    events::FriEvent,
    responder::{Reception, Responder},
    setpoints::TrajectoryEnd,
};

/// Behaviour of a controller while set-points are missing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Missing {
    Extrapolate,
    Stop,
}

/// The controller, its robot and the network.
pub(super) struct Cell {
    pub(super) random: Rng,
    pub(super) limits: Limits,
    pub(super) config: ControllerConfig,
    pub(super) controller: Controller,
    pub(super) missing: Missing,
    pub(super) cycle: u64,
    pub(super) begun: Instant,
    pub(super) q: Joints,
    pub(super) dq: Joints,
    /// The active set-point, and the number of cycles within which the robot has to reach it.
    pub(super) target: Option<(Joints, u32)>,
    pub(super) down: Network,
    pub(super) up: Network,
    pub(super) responder: Responder,
    /// Sent messages by sequence counter.
    pub(super) sent: HashMap<u32, ControllerMessage>,
    /// The last message that the drive has accepted, and the previous one.
    pub(super) accepted: [Option<u32>; 2],
    /// The last cycle in which the controller moved or stopped the robot on its own.
    pub(super) alone: u64,
    pub(super) end: Option<TrajectoryEnd>,
    /// `true` if datagrams are forged with the controller address.
    pub(super) forges: bool,
    /// Offset of the controller clock, in cycles.
    pub(super) clock_ahead: u64,
    pub(super) wire: Vec<SentSetpoint>,
}

/// A controller message.
#[derive(Clone, Copy, Debug)]
pub(super) struct ControllerMessage {
    pub(super) cycle: u64,
    pub(super) session: SessionState,
    pub(super) arm_rad: Joints,
}

/// A set-point, as read from the wire.
#[derive(Clone, Copy, Debug)]
pub(super) struct SentSetpoint {
    pub(super) t_s: f64,
    pub(super) at_rad: Joints,
    /// Robot position in the answered message.
    pub(super) arm_rad: Joints,
    /// Robot velocity since the previous message, if the controller has moved the robot on its own
    /// since the last answer.
    pub(super) restart_speed: Option<Joints>,
}

pub(super) const CABINET: IpAddr = IpAddr::V4(Ipv4Addr::LOCALHOST);

impl Cell {
    pub(super) fn new(
        seed: u64,
        period_ms: u32,
        receive_multiplier: u32,
        missing: Missing,
        start: Joints,
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
            q: start,
            dq: [0.0; 7],
            target: None,
            down: Network::default(),
            up: Network::default(),
            responder: Responder::new(CABINET, &limits),
            sent: HashMap::new(),
            accepted: [None; 2],
            alone: 0,
            end: None,
            forges: false,
            clock_ahead: 0,
            wire: Vec::new(),
        }
    }

    pub(super) fn period_s(&self) -> f64 {
        f64::from(self.config.period_ms) * 1e-3
    }

    pub(super) fn now(&self) -> Instant {
        self.begun + Duration::from_secs_f64(self.cycle as f64 * self.period_s())
    }

    /// Moves the robot by a cycle, at most at 1.1 of its limits.
    pub(super) fn follow(&mut self) {
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
        let Some((target, remaining)) = &mut self.target else { return };
        let step: Joints = match (setpoint, self.missing) {
            (Some(_), _) => {
                let share = 1.0 / f64::from((*remaining).max(1));
                std::array::from_fn(|j| (target[j] - before[j]) * share)
            }
            (None, Missing::Extrapolate) => self.dq.map(|dq| dq * period_s),
            (None, Missing::Stop) => [0.0; 7],
        };
        *remaining = remaining.saturating_sub(1);
        if setpoint.is_none() {
            self.alone = self.cycle;
        }
        let Limits { velocity_rad_s, lower_rad, upper_rad, .. } = self.limits;
        self.q = std::array::from_fn(|j| {
            let max_step = 1.1 * velocity_rad_s[j] * period_s;
            (before[j] + step[j].clamp(-max_step, max_step)).clamp(lower_rad[j], upper_rad[j])
        });
        self.dq = std::array::from_fn(|j| (self.q[j] - before[j]) / period_s);
    }

    pub(super) fn tick(&mut self) {
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
            let sent =
                ControllerMessage { cycle: self.cycle, session: message.session, arm_rad: self.q };
            self.sent.insert(message.sequence, sent);
            self.down.send(&datagram, self.cycle, &mut self.random);
            if self.forges && self.random.f64() < 0.02 {
                self.forge(&datagram);
            }
        }
        for datagram in self.down.receive(self.cycle, &mut self.random) {
            self.deliver(&datagram);
        }
        self.responder.check_timeouts(self.now());
        self.take_events();
        for answer in self.up.receive(self.cycle, &mut self.random) {
            self.controller.receive(&answer).unwrap();
        }
    }

    /// Forges a message, as a sender without access to the network traffic would.
    pub(super) fn forge(&mut self, datagram: &[u8]) {
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

    pub(super) fn deliver(&mut self, datagram: &[u8]) {
        let mut answer = Vec::new();
        let from = SocketAddr::new(CABINET, 30200);
        let outcome = self.responder.receive(datagram, from, self.now(), &mut answer);
        self.take_events();
        assert_eq!(outcome == Reception::Answered, !answer.is_empty());
        if outcome != Reception::Ignored {
            let message = Format::V1.decode_monitoring(datagram).unwrap();
            self.accepted = [Some(message.sequence), self.accepted[0]];
        }
        if outcome == Reception::Answered {
            self.read(&answer);
            self.up.send(&answer, self.cycle, &mut self.random);
        }
    }

    pub(super) fn take_events(&mut self) {
        for event in self.responder.take_events() {
            if let FriEvent::Ended(end) = event {
                assert!(self.end.is_none(), "a run ends once");
                self.end = Some(end);
            }
        }
    }

    /// Reads an answer from the wire.
    pub(super) fn read(&mut self, answer: &[u8]) {
        let answer = Format::V1.decode_command(answer).unwrap();
        // After a silence, a forged message may be accepted; the controller ignores the answer to
        // it.
        let Some(&ControllerMessage { cycle, session, arm_rad }) = self.sent.get(&answer.reflected)
        else {
            return;
        };
        if session != SessionState::CommandingActive {
            return;
        }
        let t_s = cycle as f64 * self.period_s();
        let last_s = self.wire.last().map_or(0.0, |last| last.t_s);
        let restart_speed =
            self.accepted[1].filter(|_| self.alone as f64 * self.period_s() > last_s);
        let restart_speed = restart_speed.and_then(|before| self.sent.get(&before)).map(|before| {
            let by_s = (cycle - before.cycle) as f64 * self.period_s();
            std::array::from_fn(|j| (arm_rad[j] - before.arm_rad[j]) / by_s)
        });
        let at_rad = answer.joints_rad.expect("positions, in commanding");
        self.wire.push(SentSetpoint { t_s, at_rad, arm_rad, restart_speed });
    }

    pub(super) fn until(&mut self, max_cycles: u32, holds: impl Fn(&Self) -> bool) {
        for _ in 0..max_cycles {
            if holds(self) {
                return;
            }
            self.tick();
        }
        panic!("not reached within {max_cycles} cycles: {:?}", self.controller.state());
    }

    /// Begins the trajectory; the session commands afterwards.
    pub(super) fn begin(&mut self, trajectory: &TimedJoints) {
        self.until(2000, |cell| cell.controller.state() == SessionState::MonitoringReady);
        let now = self.now();
        self.responder.run(1, Box::new(trajectory.clone()), now);
        self.tick();
        self.controller.request_commanding();
        self.until(2000, |cell| cell.controller.state() == SessionState::CommandingActive);
    }

    /// Ends commanding after the run, as the robot program does.
    pub(super) fn finish(&mut self) {
        (0..3).for_each(|_| self.tick());
        self.controller.release();
        (0..5).for_each(|_| self.tick());
    }
}
