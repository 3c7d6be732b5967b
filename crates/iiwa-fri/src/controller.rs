//! The controller's side of a session: it sends a message a cycle and weighs the answers.
//!
//! How KUKA's controller decides is not published. These are the rules of this one:
//!
//! | from | to | when |
//! |---|---|---|
//! | `Idle` | `MonitoringWait` | the next cycle, or when the cycles of [`Controller::drop_session`] are over; what is known of the answers is forgotten, and the quality is `Poor` |
//! | `MonitoringWait` | `MonitoringReady` | 50 answers have been expected in this state, and the quality is `Good` or better |
//! | `MonitoringReady` | `MonitoringWait` | the quality is below `Good` |
//! | `MonitoringReady` | `CommandingWait` | commanding is requested |
//! | `CommandingWait` | `CommandingActive` | five set-points in a row, none missing, were within 0.001 rad of the interpolated position at every joint |
//! | `CommandingWait`, `CommandingActive` | `MonitoringWait` | the quality is below `Good`; the request is forgotten |
//! | `CommandingWait`, `CommandingActive` | `MonitoringReady` | [`Controller::release`] |
//! | any | `Idle` | [`Controller::drop_session`] |
//!
//! The quality is the share of answers that arrived, out of the last 100 expected ones, or of as many
//! as there have been: `Excellent` from 99 %, `Good` from 95 %, `Fair` from 80 %, and `Poor` below
//! that, or as long as fewer than 50 have been expected. So the sixth missing answer among a hundred
//! ends commanding, be it in a row or not; in a young session it is the third among fifty.
//!
//! One answer is expected to every group of `receive_multiplier` messages, from the first of the
//! session on, and has the time until the second group after it begins: with a multiplier of 1,
//! until the tick after next. An answer counts once. In the commanding states it has to carry joint
//! positions. Answers that are older than one already taken, by either counter, are ignored; those
//! of a client that has started again, its counter with it, are taken.

use std::time::Duration;

use iiwa_kin::Joints;

use super::{
    Command, CommandMode, ControlMode, Drive, Format, Monitoring, OperationMode, Overlay, Quality,
    Safety, SessionState, WireError, ahead,
};

/// How many expected answers the quality is taken from.
const WINDOW: u32 = 100;
/// How many answers have to be expected before the quality says something.
const FIRST_STRETCH: u32 = 50;
/// How far a set-point may be from the interpolated position when commanding begins, in rad.
const IN_PLACE_RAD: f64 = 1e-3;
/// How many set-points in a row have to be that near.
const IN_PLACE_ROW: u32 = 5;

/// How the controller sends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ControllerConfig {
    /// Time from one message to the next, in ms, from 1 to 100.
    pub period_ms: u32,
    /// An answer is expected every so many messages, at least 1.
    pub receive_multiplier: u32,
    /// The messages' bytes.
    pub format: Format,
}

impl Default for ControllerConfig {
    /// Every 5 ms, with an answer to each message.
    fn default() -> Self {
        Self { period_ms: 5, receive_multiplier: 1, format: Format::default() }
    }
}

/// What the robot's sensors and its interpolation say in a cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reading {
    /// Measured joint positions, in rad.
    pub measured_rad: Joints,
    /// Commanded joint positions, in rad.
    pub commanded_rad: Joints,
    /// Joint positions of the controller's own interpolation, in rad. In the commanding states the
    /// commanded ones take their place when there are none.
    pub ipo_rad: Option<Joints>,
    /// Measured joint torques, in Nm.
    pub measured_torque_nm: Joints,
    /// External joint torques, in Nm.
    pub external_torque_nm: Joints,
    /// The controller's time stamp.
    pub time: Duration,
    /// What the safety controller demands.
    pub safety: Safety,
}

/// What has happened to the answers, since the controller began.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AnswerCounters {
    /// Answers that were taken.
    pub accepted: u64,
    /// Answers that were not: repeated, older than one already taken, too late to count, or to a
    /// message that was never sent in this session.
    pub ignored: u64,
    /// Datagrams that were no answer.
    pub invalid: u64,
    /// Expected answers that did not arrive in time.
    pub missed: u64,
}

/// The controller's session.
#[derive(Clone, Debug)]
pub struct Controller {
    config: ControllerConfig,
    state: SessionState,
    /// Cycles to stay idle for, and whether the client has been told.
    idle_cycles: u64,
    told_idle: bool,
    /// The counter of the next message.
    sequence: u32,
    /// Counters of the answer taken last: the client's own, and the reflected one.
    accepted: Option<(u32, u32)>,
    /// Messages sent in this session.
    sent: u64,
    /// Whether the answers to this group of messages and to the one before have arrived.
    arrived: [bool; 2],
    window: Window,
    /// Expected answers in this state, while it is `MonitoringWait`.
    waited: u32,
    missed: u32,
    requested: bool,
    lost_commanding: bool,
    /// The first message of the commanding states.
    commanding_from: u32,
    in_place: u32,
    /// The interpolated position that was sent last.
    ipo_rad: Joints,
    /// The set-point that came since the last tick, the one in force, and the latter's age in
    /// cycles.
    next_setpoint: Option<Joints>,
    setpoint: Option<Joints>,
    setpoint_age: u32,
    counters: AnswerCounters,
}

impl Default for Controller {
    fn default() -> Self {
        Self::new(ControllerConfig::default())
    }
}

impl Controller {
    /// A controller that has sent nothing. A configuration out of its bounds is moved to them.
    #[must_use]
    pub fn new(config: ControllerConfig) -> Self {
        Self {
            config: ControllerConfig {
                period_ms: config.period_ms.clamp(1, 100),
                receive_multiplier: config.receive_multiplier.max(1),
                ..config
            },
            state: SessionState::Idle,
            idle_cycles: 0,
            told_idle: false,
            sequence: 0,
            accepted: None,
            sent: 0,
            arrived: [false; 2],
            window: Window::default(),
            waited: 0,
            missed: 0,
            requested: false,
            lost_commanding: false,
            commanding_from: 0,
            in_place: 0,
            ipo_rad: [0.0; 7],
            next_setpoint: None,
            setpoint: None,
            setpoint_age: 0,
            counters: AnswerCounters::default(),
        }
    }

    /// One cycle begins: takes account of the answers since the last one, and moves the session's
    /// state. Then the robot moves, and [`message`](Self::message) tells the client.
    pub fn advance(&mut self) {
        self.lost_commanding = false;
        if self.state == SessionState::Idle {
            if self.idle_cycles > 0 {
                self.idle_cycles -= 1;
                return;
            }
            self.open();
        }
        self.take_setpoint();
        self.weigh();
        self.step();
    }

    /// Writes the cycle's message in place of what `out` holds. `false`, and nothing in `out`, when
    /// the session is idle and the client has been told so.
    pub fn message(&mut self, reading: &Reading, out: &mut Vec<u8>) -> bool {
        out.clear();
        if self.state != SessionState::Idle {
            self.send(reading, out);
            self.sent += 1;
            return true;
        }
        if self.told_idle {
            return false;
        }
        self.told_idle = true;
        self.send(reading, out);
        true
    }

    /// A whole cycle of a robot that stands at `reading`: [`advance`](Self::advance) and
    /// [`message`](Self::message).
    pub fn tick(&mut self, reading: &Reading, out: &mut Vec<u8>) -> bool {
        self.advance();
        self.message(reading, out)
    }

    /// Takes an answer of the client.
    ///
    /// # Errors
    ///
    /// When it is none. It is counted, and the session goes on.
    pub fn receive(&mut self, datagram: &[u8]) -> Result<(), WireError> {
        let command = self.config.format.decode_command(datagram).inspect_err(|_| {
            self.counters.invalid += 1;
        })?;
        match self.group(&command) {
            Some(group) => self.accept(&command, group),
            None => self.counters.ignored += 1,
        }
        Ok(())
    }

    /// How far the session has come.
    #[must_use]
    pub const fn state(&self) -> SessionState {
        self.state
    }

    /// How well the answers arrive.
    #[must_use]
    pub fn quality(&self) -> Quality {
        self.window.quality()
    }

    /// Asks for the client's set-points, from the next tick in `MonitoringReady` on.
    pub const fn request_commanding(&mut self) {
        self.requested = true;
    }

    /// Goes back to monitoring, and asks no longer for set-points.
    pub fn release(&mut self) {
        self.requested = false;
        if self.state.commands() {
            self.stop_commanding(SessionState::MonitoringReady);
        }
    }

    /// Drops the session. It stays idle for `cycles`, in the first of which the client is told, and
    /// then opens again.
    pub fn drop_session(&mut self, cycles: u64) {
        self.stop_commanding(SessionState::Idle);
        self.requested = false;
        self.window = Window::default();
        self.missed = 0;
        self.sent = 0;
        self.idle_cycles = cycles;
        self.told_idle = false;
    }

    /// Whether the last tick ended commanding because too many answers were missing.
    #[must_use]
    pub const fn lost_commanding(&self) -> bool {
        self.lost_commanding
    }

    /// The counter of the message that the client answered last.
    #[must_use]
    pub fn answered(&self) -> Option<u32> {
        self.accepted.map(|(_, reflected)| reflected)
    }

    /// The set-point for the coming cycle, in rad, in `CommandingActive`: the client's latest one.
    /// `None` when the last tick was due one that had not arrived.
    #[must_use]
    pub fn setpoint(&self) -> Option<&Joints> {
        self.setpoint.as_ref().filter(|_| self.state == SessionState::CommandingActive)
    }

    /// Expected answers missing in a row. One is missing when it can no longer count.
    #[must_use]
    pub const fn missed(&self) -> u32 {
        self.missed
    }

    /// What has happened to the answers.
    #[must_use]
    pub const fn counters(&self) -> AnswerCounters {
        self.counters
    }

    fn open(&mut self) {
        self.state = SessionState::MonitoringWait;
        self.window = Window::default();
        self.arrived = [false; 2];
        self.waited = 0;
        self.missed = 0;
        self.sent = 0;
    }

    /// Puts the set-point that has arrived in force, or lets the one that is in force expire.
    fn take_setpoint(&mut self) {
        if let Some(setpoint) = self.next_setpoint.take() {
            self.setpoint = Some(setpoint);
            self.setpoint_age = 0;
        } else {
            self.setpoint_age = self.setpoint_age.saturating_add(1);
            if self.setpoint_age >= self.config.receive_multiplier {
                self.setpoint = None;
            }
        }
    }

    /// At the beginning of a group of messages, closes the books on the last but one.
    fn weigh(&mut self) {
        let multiplier = u64::from(self.config.receive_multiplier);
        if !self.sent.is_multiple_of(multiplier) {
            return;
        }
        let [this, before] = self.arrived;
        self.arrived = [false, this];
        if self.sent / multiplier < 2 {
            return;
        }
        self.window.push(before);
        self.waited = self.waited.saturating_add(1);
        if before {
            self.missed = 0;
        } else {
            self.missed = self.missed.saturating_add(1);
            self.counters.missed += 1;
            self.in_place = 0;
        }
    }

    fn step(&mut self) {
        let good = self.quality() >= Quality::Good;
        match self.state {
            SessionState::MonitoringWait if good && self.waited >= FIRST_STRETCH => {
                self.state = SessionState::MonitoringReady;
            }
            SessionState::MonitoringReady if !good => {
                self.state = SessionState::MonitoringWait;
                self.waited = 0;
            }
            SessionState::MonitoringReady if self.requested => {
                self.state = SessionState::CommandingWait;
                self.commanding_from = self.sequence;
                self.in_place = 0;
            }
            state if state.commands() && !good => {
                self.stop_commanding(SessionState::MonitoringWait);
                self.requested = false;
                self.waited = 0;
                self.lost_commanding = true;
            }
            SessionState::CommandingWait if self.in_place >= IN_PLACE_ROW => {
                self.state = SessionState::CommandingActive;
            }
            _ => {}
        }
    }

    fn stop_commanding(&mut self, state: SessionState) {
        self.state = state;
        self.next_setpoint = None;
        self.setpoint = None;
    }

    /// Which group of messages an answer is to: 0 for the latest, 1 for the one before. `None` for
    /// an answer to be ignored.
    fn group(&self, command: &Command) -> Option<usize> {
        if self.state == SessionState::Idle {
            return None;
        }
        let latest = self.sequence.wrapping_sub(1);
        let age = u64::from(u32::try_from(ahead(latest, command.reflected)).ok()?);
        let message = self.sent.checked_sub(1)?.checked_sub(age)?;
        let multiplier = u64::from(self.config.receive_multiplier);
        let group = (self.sent - 1) / multiplier - message / multiplier;
        if let Some((sequence, reflected)) = self.accepted {
            let younger = ahead(command.reflected, reflected);
            // A client's answers are in the order of what they reflect: one with a lower counter to
            // a younger message can only be of a client that counts anew.
            let in_order = match ahead(command.sequence, sequence) {
                0 => false,
                1.. => younger >= 0,
                _ => younger > 0,
            };
            if !in_order {
                return None;
            }
        }
        usize::try_from(group).ok().filter(|&group| group < 2)
    }

    fn accept(&mut self, command: &Command, group: usize) {
        self.counters.accepted += 1;
        self.accepted = Some((command.sequence, command.reflected));
        let commanding =
            self.state.commands() && ahead(command.reflected, self.commanding_from) >= 0;
        if !commanding {
            self.arrived[group] = true;
            return;
        }
        let Some(joints) = &command.joints_rad else { return };
        self.arrived[group] = true;
        self.next_setpoint = Some(*joints);
        let near = joints.iter().zip(&self.ipo_rad).all(|(q, ipo)| (q - ipo).abs() <= IN_PLACE_RAD);
        self.in_place = if near { self.in_place.saturating_add(1) } else { 0 };
    }

    fn send(&mut self, reading: &Reading, out: &mut Vec<u8>) {
        let commands = self.state.commands();
        let ipo_rad = reading.ipo_rad.or(commands.then_some(reading.commanded_rad));
        if let Some(ipo_rad) = ipo_rad {
            self.ipo_rad = ipo_rad;
        }
        let normal = reading.safety == Safety::Normal;
        let message = Monitoring {
            sequence: self.sequence,
            reflected: self.accepted.map_or(0, |(sequence, _)| sequence),
            session: self.state,
            quality: self.quality(),
            send_period_ms: self.config.period_ms,
            receive_multiplier: self.config.receive_multiplier,
            safety: Some(reading.safety),
            operation_mode: Some(OperationMode::Automatic),
            drive: Some(if normal { Drive::Active } else { Drive::Off }),
            control_mode: Some(ControlMode::Position),
            measured_rad: Some(reading.measured_rad),
            measured_torque_nm: Some(reading.measured_torque_nm),
            commanded_rad: Some(reading.commanded_rad),
            commanded_torque_nm: None,
            external_torque_nm: Some(reading.external_torque_nm),
            ipo_rad,
            command_mode: Some(if commands { CommandMode::Position } else { CommandMode::None }),
            overlay: Some(if commands { Overlay::Joint } else { Overlay::None }),
            tracking_performance: None,
            time: Some(reading.time),
        };
        self.config.format.encode_monitoring(&message, out);
        self.sequence = self.sequence.wrapping_add(1);
    }
}

/// Which of the last expected answers arrived: a bit each, the last one lowest.
#[derive(Clone, Copy, Debug, Default)]
struct Window {
    bits: u128,
    expected: u32,
}

impl Window {
    const fn push(&mut self, arrived: bool) {
        self.bits = (self.bits << 1 | arrived as u128) & ((1 << WINDOW) - 1);
        if self.expected < WINDOW {
            self.expected += 1;
        }
    }

    const fn quality(self) -> Quality {
        if self.expected < FIRST_STRETCH {
            return Quality::Poor;
        }
        let hundredfold = 100 * self.bits.count_ones();
        if hundredfold >= 99 * self.expected {
            Quality::Excellent
        } else if hundredfold >= 95 * self.expected {
            Quality::Good
        } else if hundredfold >= 80 * self.expected {
            Quality::Fair
        } else {
            Quality::Poor
        }
    }
}

#[cfg(test)]
mod tests {
    use SessionState::{CommandingActive, CommandingWait, Idle, MonitoringReady, MonitoringWait};

    use super::*;

    fn tick(controller: &mut Controller) -> Monitoring {
        let mut out = Vec::new();
        assert!(controller.tick(&Reading::default(), &mut out));
        Format::V1.decode_monitoring(&out).unwrap()
    }

    /// Answers with the joints all at 0, where the robot is. Whether the answer was taken.
    fn answer(controller: &mut Controller, sequence: u32, reflected: u32) -> bool {
        give(controller, &Command { sequence, reflected, joints_rad: Some([0.0; 7]) })
    }

    fn give(controller: &mut Controller, command: &Command) -> bool {
        let mut bytes = Vec::new();
        Format::V1.encode_command(command, &mut bytes);
        let before = controller.counters().accepted;
        controller.receive(&bytes).unwrap();
        controller.counters().accepted > before
    }

    /// Runs the session for `n` cycles, answering those for which `answers` is true.
    fn run(controller: &mut Controller, n: u32, answers: impl Fn(u32) -> bool) {
        for i in 0..n {
            let message = tick(controller);
            if answers(i) {
                let next = controller.accepted.map_or(0, |(sequence, _)| sequence.wrapping_add(1));
                assert!(answer(controller, next, message.sequence));
            }
        }
    }

    fn in_state(state: SessionState) -> Controller {
        let mut controller = Controller::default();
        if state.commands() {
            controller.request_commanding();
        }
        while controller.state() != state {
            run(&mut controller, 1, |_| true);
        }
        controller
    }

    #[test]
    fn quality_is_the_share_of_answers() {
        for (missing, expected) in [
            (0, Quality::Excellent),
            (1, Quality::Excellent),
            (2, Quality::Good),
            (5, Quality::Good),
            (6, Quality::Fair),
            (20, Quality::Fair),
            (21, Quality::Poor),
            (100, Quality::Poor),
        ] {
            let mut controller = Controller::default();
            run(&mut controller, 102, |i| i >= missing);
            assert_eq!(controller.quality(), expected, "{missing} missing");
            assert_eq!(controller.counters().missed, u64::from(missing));
        }
    }

    #[test]
    fn the_quality_says_nothing_before_the_first_section() {
        let mut controller = Controller::default();
        run(&mut controller, 51, |_| true);
        assert_eq!((controller.state(), controller.quality()), (MonitoringWait, Quality::Poor));
        run(&mut controller, 1, |_| true);
        assert_eq!(
            (controller.state(), controller.quality()),
            (MonitoringReady, Quality::Excellent)
        );
        // Three of fifty are too many, and so is a share that recovers before its time.
        let mut controller = Controller::default();
        run(&mut controller, 52, |i| i >= 3);
        assert_eq!((controller.state(), controller.quality()), (MonitoringWait, Quality::Fair));
        run(&mut controller, 10, |_| true);
        assert_eq!((controller.state(), controller.quality()), (MonitoringReady, Quality::Good));
        run(&mut controller, 5, |_| false);
        assert_eq!(controller.state(), MonitoringWait);
        run(&mut controller, 46, |_| true);
        assert_eq!(controller.state(), MonitoringWait);
    }

    #[test]
    fn an_answer_counts_until_the_tick_after_next() {
        let mut controller = Controller::default();
        for n in 0..=10 {
            tick(&mut controller);
            // Always to the message before the last one.
            if n > 0 {
                assert!(answer(&mut controller, n, n - 1));
            }
        }
        assert_eq!(controller.missed(), 0);
        tick(&mut controller);
        tick(&mut controller);
        assert_eq!(controller.missed(), 1);
        assert!(!answer(&mut controller, 50, 10), "two periods old");
        assert!(answer(&mut controller, 50, 11));
        assert!(!answer(&mut controller, 51, 13), "not sent yet");
        assert!(!answer(&mut controller, 51, 11_u32.wrapping_sub(20)), "of no session");
        tick(&mut controller);
        assert_eq!(controller.missed(), 0);
    }

    #[test]
    fn old_answers_are_ignored_and_new_clients_are_not() {
        let mut controller = Controller::default();
        run(&mut controller, 30, |_| true);
        tick(&mut controller);
        assert!(!answer(&mut controller, 29, 30), "repeated");
        assert!(answer(&mut controller, 35, 30));
        tick(&mut controller);
        assert!(!answer(&mut controller, 36, 29), "reflects an older message");
        assert!(!answer(&mut controller, 34, 30), "older by its own counter");
        assert!(answer(&mut controller, 0, 31), "a new client");
        assert!(!answer(&mut controller, 36, 30), "of the client before");
        tick(&mut controller);
        assert!(answer(&mut controller, 1, 32));
        assert_eq!(controller.counters().ignored, 4);
        assert!(controller.receive(b"garbage").is_err());
        assert_eq!(controller.counters().invalid, 1);
    }

    #[test]
    fn counters_wrap_around() {
        let mut controller = Controller { sequence: u32::MAX - 20, ..Controller::default() };
        tick(&mut controller);
        assert!(answer(&mut controller, u32::MAX - 40, u32::MAX - 20));
        run(&mut controller, 100, |_| true);
        assert_eq!(controller.counters().accepted, 101);
        assert_eq!((controller.state(), controller.missed()), (MonitoringReady, 0));
        assert_eq!(controller.sequence, 80);
        assert_eq!(controller.accepted, Some((59, 79)));
    }

    #[test]
    fn commanding_takes_joints() {
        let header = |controller: &mut Controller| {
            let n = tick(controller).sequence;
            give(controller, &Command { sequence: n, reflected: n, joints_rad: None });
        };
        let mut controller = Controller::default();
        for _ in 0..110 {
            header(&mut controller);
        }
        assert_eq!((controller.state(), controller.missed()), (MonitoringReady, 0));
        controller.request_commanding();
        for _ in 0..7 {
            header(&mut controller);
        }
        assert_eq!((controller.state(), controller.missed()), (CommandingWait, 5));
        header(&mut controller);
        assert!(controller.lost_commanding());
        assert_eq!((controller.state(), controller.missed()), (MonitoringWait, 6));
    }

    #[test]
    fn a_missing_setpoint_begins_the_row_anew() {
        let mut controller = in_state(CommandingWait);
        run(&mut controller, 30, |i| i != 2 && i != 5);
        assert_eq!(controller.state(), CommandingActive);
        let mut controller = in_state(CommandingWait);
        run(&mut controller, 8, |i| i != 2);
        assert_eq!(controller.state(), CommandingWait);
    }

    #[test]
    fn a_setpoint_lasts_as_long_as_the_next_one_takes() {
        for multiplier in [1, 4] {
            let mut controller = Controller::new(ControllerConfig {
                receive_multiplier: multiplier,
                ..ControllerConfig::default()
            });
            controller.request_commanding();
            while controller.state() != CommandingActive {
                run(&mut controller, multiplier, |i| i == 0);
            }
            run(&mut controller, 1, |_| true);
            for _ in 0..multiplier {
                tick(&mut controller);
                assert!(controller.setpoint().is_some());
            }
            tick(&mut controller);
            assert!(controller.setpoint().is_none());
        }
    }

    #[test]
    fn an_idle_session_says_so_once() {
        let mut controller = in_state(CommandingActive);
        run(&mut controller, 5, |_| true);
        let sequence = controller.sequence;
        controller.drop_session(3);
        assert_eq!((controller.state(), controller.quality()), (Idle, Quality::Poor));
        assert!(!answer(&mut controller, sequence, sequence - 1));
        let message = tick(&mut controller);
        assert_eq!((message.sequence, message.session), (sequence, Idle));
        let mut out = vec![1];
        for _ in 0..2 {
            assert!(!controller.tick(&Reading::default(), &mut out));
            assert!(out.is_empty());
        }
        let message = tick(&mut controller);
        assert_eq!((message.sequence, message.session), (sequence + 1, MonitoringWait));
        assert!(!answer(&mut controller, sequence, sequence), "to the idle message");
        assert!(answer(&mut controller, sequence, sequence + 1));
        assert_eq!(message.quality, Quality::Poor);
    }

    #[test]
    fn a_configuration_keeps_to_its_bounds() {
        for (period_ms, sent) in [(0, 1), (1, 1), (100, 100), (101, 100)] {
            let config = ControllerConfig {
                period_ms,
                receive_multiplier: 0,
                ..ControllerConfig::default()
            };
            let message = tick(&mut Controller::new(config));
            assert_eq!((message.send_period_ms, message.receive_multiplier), (sent, 1));
        }
    }

    #[test]
    fn messages_say_what_the_robot_does() {
        let mut controller = in_state(MonitoringReady);
        assert_eq!(tick(&mut controller).ipo_rad, None);
        let mut controller = in_state(CommandingWait);
        let reading = Reading {
            measured_rad: [1.0; 7],
            commanded_rad: [2.0; 7],
            measured_torque_nm: [3.0; 7],
            external_torque_nm: [4.0; 7],
            time: Duration::from_secs(5),
            safety: Safety::Stop1,
            ipo_rad: None,
        };
        let mut out = Vec::new();
        assert!(controller.tick(&reading, &mut out));
        let message = Format::V1.decode_monitoring(&out).unwrap();
        assert_eq!(message.measured_rad, Some([1.0; 7]));
        assert_eq!((message.commanded_rad, message.ipo_rad), (Some([2.0; 7]), Some([2.0; 7])));
        assert_eq!(message.measured_torque_nm, Some([3.0; 7]));
        assert_eq!(message.external_torque_nm, Some([4.0; 7]));
        assert_eq!(message.time, Some(Duration::from_secs(5)));
        assert_eq!((message.safety, message.drive), (Some(Safety::Stop1), Some(Drive::Off)));
        assert_eq!(message.command_mode, Some(CommandMode::Position));
    }
}
