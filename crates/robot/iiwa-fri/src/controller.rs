//! Controller side of a session: sends one monitoring message per cycle and rates the answers.
//!
//! KUKA does not publish the rules of its controller. This controller applies these rules:
//!
//! | from | to | condition |
//! |---|---|---|
//! | `Idle` | `MonitoringWait` | the next cycle, or the cycles of [`Controller::drop_session`] have passed; the record of answers is cleared and the quality is `Poor` |
//! | `MonitoringWait` | `MonitoringReady` | 50 answers were expected in this state, and the quality is at least `Good` |
//! | `MonitoringReady` | `MonitoringWait` | the quality is below `Good` |
//! | `MonitoringReady` | `CommandingWait` | commanding is requested |
//! | `CommandingWait` | `CommandingActive` | five consecutive set-points, none missing, were within 0.001 rad of the interpolated position at every joint |
//! | `CommandingWait`, `CommandingActive` | `MonitoringWait` | the quality is below `Good`; the request is cleared |
//! | `CommandingWait`, `CommandingActive` | `MonitoringReady` | [`Controller::release`] |
//! | any | `Idle` | [`Controller::drop_session`] |
//!
//! The quality is the share of answers that arrived in time, out of the last 100 expected ones, or
//! of all if fewer were expected: `Excellent` from 99 %, `Good` from 95 %, `Fair` from 80 %, and
//! `Poor` below, or as long as fewer than 50 were expected. Thus the sixth missing answer out of a
//! hundred ends commanding, consecutive or not; in a new session, the third out of fifty does.
//!
//! One answer is expected per group of `receive_multiplier` messages, counted from the first
//! message of the session. Its deadline is the beginning of the second group after it: with a
//! multiplier of 1, the tick after next. Each answer counts once. In the commanding states an
//! answer has to contain joint positions. Answers that are older than an accepted one, by either
//! counter, are ignored; answers of a restarted client are accepted.

mod answer_window;
#[cfg(test)]
mod tests;

use std::time::Duration;

use iiwa_kin::Joints;

use self::answer_window::{AnswerWindow, MIN_EXPECTED};
use crate::{
    counter::ahead,
    error::WireError,
    message::{
        Command, CommandMode, ControlMode, Drive, Monitoring, OperationMode, Overlay, Quality,
        Safety, SessionState,
    },
    wire::Format,
};

/// Tolerance of set-points about the interpolated position at the beginning of commanding, in rad.
const IN_PLACE_RAD: f64 = 1e-3;
/// Required number of consecutive set-points within the tolerance.
const IN_PLACE_ROW: u32 = 5;

/// Configuration of a controller's FRI connection.
///
/// ```
/// use iiwa_fri::ControllerConfig;
///
/// let config = ControllerConfig { period_ms: 2, ..ControllerConfig::default() };
/// assert_eq!(config.receive_multiplier, 1);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ControllerConfig {
    /// Time between messages, in ms, from 1 to 100.
    pub period_ms: u32,
    /// Number of messages per expected answer, at least 1.
    pub receive_multiplier: u32,
    /// Wire format.
    pub format: Format,
}

impl Default for ControllerConfig {
    /// One message every 5 ms, and one answer per message.
    fn default() -> Self {
        Self { period_ms: 5, receive_multiplier: 1, format: Format::default() }
    }
}

/// Measured and commanded state of the robot in a cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reading {
    /// Measured joint positions, in rad.
    pub measured_rad: Joints,
    /// Commanded joint positions, in rad.
    pub commanded_rad: Joints,
    /// Interpolated joint positions of the controller's own motion, in rad. In the commanding
    /// states, the default is the commanded positions.
    pub ipo_rad: Option<Joints>,
    /// Measured joint torques, in Nm.
    pub measured_torque_nm: Joints,
    /// External joint torques, in Nm.
    pub external_torque_nm: Joints,
    /// Controller time stamp.
    pub time: Duration,
    /// Stop category demanded by the safety controller.
    pub safety: Safety,
}

/// Statistics of the client answers since the controller was created.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct AnswerCounters {
    /// Accepted answers.
    pub accepted: u64,
    /// Ignored answers: repeated, older than an accepted one, past their deadline, or to a message
    /// that was not sent in this session.
    pub ignored: u64,
    /// Datagrams that could not be decoded.
    pub invalid: u64,
    /// Expected answers that missed their deadline.
    pub missed: u64,
}

/// Controller session.
///
/// ```
/// use iiwa_fri::{Controller, ControllerConfig, Format, Reading, SessionState};
///
/// let mut controller = Controller::new(ControllerConfig::default());
/// let mut datagram = Vec::new();
/// let reading = Reading { measured_rad: [0.1; 7], ..Reading::default() };
/// assert!(controller.tick(&reading, &mut datagram));
///
/// let message = Format::V1.decode_monitoring(&datagram)?;
/// assert_eq!(message.session, SessionState::MonitoringWait);
/// assert_eq!(message.measured_rad, Some([0.1; 7]));
/// # Ok::<(), iiwa_fri::WireError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Controller {
    config: ControllerConfig,
    state: SessionState,
    /// Number of remaining idle cycles, and `true` if the idle state has been sent to the client.
    idle_cycles: u64,
    idle_sent: bool,
    /// Sequence counter of the next message.
    sequence: u32,
    /// Sequence counters of the last accepted answer: the client's counter and the reflected one.
    accepted: Option<(u32, u32)>,
    /// Messages sent in this session.
    sent: u64,
    /// Flags of received answers to the current and to the previous group of messages.
    arrived: [bool; 2],
    window: AnswerWindow,
    /// Number of answers expected since the session entered `MonitoringWait`.
    waited: u32,
    missed: u32,
    requested: bool,
    lost_commanding: bool,
    /// Sequence counter of the first message of the commanding states.
    commanding_from: u32,
    in_place: u32,
    /// The interpolated position that was sent last, in rad.
    ipo_rad: Joints,
    /// The set-point received since the last tick, the active set-point, and the age of the active
    /// set-point in cycles.
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
    /// Creates a controller that has not sent anything. Values outside their bounds are clamped.
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
            idle_sent: false,
            sequence: 0,
            accepted: None,
            sent: 0,
            arrived: [false; 2],
            window: AnswerWindow::default(),
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

    /// Begins a cycle: evaluates the answers since the last cycle and updates the session state.
    /// The robot moves next, and [`message`](Self::message) reports its state to the client.
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
        self.close_group();
        self.update_state();
    }

    /// Encodes the message of the cycle into `out`, whose content is replaced. Returns `false` and
    /// leaves `out` empty if the session is idle and the idle state has already been sent to the
    /// client.
    pub fn message(&mut self, reading: &Reading, out: &mut Vec<u8>) -> bool {
        out.clear();
        if self.state != SessionState::Idle {
            self.encode(reading, out);
            self.sent += 1;
            return true;
        }
        if self.idle_sent {
            return false;
        }
        self.idle_sent = true;
        self.encode(reading, out);
        true
    }

    /// Performs a whole cycle of a robot at rest at `reading`: [`advance`](Self::advance) and
    /// [`message`](Self::message).
    pub fn tick(&mut self, reading: &Reading, out: &mut Vec<u8>) -> bool {
        self.advance();
        self.message(reading, out)
    }

    /// Decodes and evaluates a client answer.
    ///
    /// # Errors
    ///
    /// Any [`WireError`]. The datagram is counted as invalid and the session continues.
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

    /// Returns the session state.
    #[must_use]
    pub const fn state(&self) -> SessionState {
        self.state
    }

    /// Returns the connection quality.
    #[must_use]
    pub fn quality(&self) -> Quality {
        self.window.quality()
    }

    /// Requests commanding, which begins with the next tick in `MonitoringReady`.
    pub const fn request_commanding(&mut self) {
        self.requested = true;
    }

    /// Ends commanding, or clears the request for commanding.
    pub fn release(&mut self) {
        self.requested = false;
        if self.state.commands() {
            self.stop_commanding(SessionState::MonitoringReady);
        }
    }

    /// Drops the session. The session remains idle for `cycles`, the first of which sends the idle
    /// state to the client, and then opens again.
    pub fn drop_session(&mut self, cycles: u64) {
        self.stop_commanding(SessionState::Idle);
        self.requested = false;
        self.window = AnswerWindow::default();
        self.missed = 0;
        self.sent = 0;
        self.idle_cycles = cycles;
        self.idle_sent = false;
    }

    /// Returns true if the last tick ended commanding because of too many missing answers.
    #[must_use]
    pub const fn lost_commanding(&self) -> bool {
        self.lost_commanding
    }

    /// Returns the sequence counter of the message that the client answered last.
    #[must_use]
    pub fn answered(&self) -> Option<u32> {
        self.accepted.map(|(_, reflected)| reflected)
    }

    /// Returns the client's latest set-point, for the next cycle, in rad; in `CommandingActive`
    /// only. `None` if the set-point due at the last tick has not arrived.
    #[must_use]
    pub fn setpoint(&self) -> Option<&Joints> {
        self.setpoint.as_ref().filter(|_| self.state == SessionState::CommandingActive)
    }

    /// Returns the number of consecutive expected answers that missed their deadline.
    #[must_use]
    pub const fn missed(&self) -> u32 {
        self.missed
    }

    /// Returns the statistics of the client answers.
    #[must_use]
    pub const fn counters(&self) -> AnswerCounters {
        self.counters
    }

    fn open(&mut self) {
        self.state = SessionState::MonitoringWait;
        self.window = AnswerWindow::default();
        self.arrived = [false; 2];
        self.waited = 0;
        self.missed = 0;
        self.sent = 0;
    }

    /// Activates a received set-point, or lets the active one expire.
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

    /// Records the answer to the last but one group of messages at the beginning of a new group.
    fn close_group(&mut self) {
        let multiplier = u64::from(self.config.receive_multiplier);
        if !self.sent.is_multiple_of(multiplier) {
            return;
        }
        let [current, previous] = self.arrived;
        self.arrived = [false, current];
        if self.sent / multiplier < 2 {
            return;
        }
        self.window.push(previous);
        self.waited = self.waited.saturating_add(1);
        if previous {
            self.missed = 0;
        } else {
            self.missed = self.missed.saturating_add(1);
            self.counters.missed += 1;
            self.in_place = 0;
        }
    }

    fn update_state(&mut self) {
        let good = self.quality() >= Quality::Good;
        match self.state {
            SessionState::MonitoringWait if good && self.waited >= MIN_EXPECTED => {
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

    /// Returns the group of messages that an answer belongs to: 0 for the latest, 1 for the
    /// previous one. `None` for an answer to be ignored.
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
            let newer = ahead(command.reflected, reflected);
            // A client answers messages in order: a lower counter in an answer to a later message
            // means that the client has restarted.
            let in_order = match ahead(command.sequence, sequence) {
                0 => false,
                1.. => newer >= 0,
                _ => newer > 0,
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

    fn encode(&mut self, reading: &Reading, out: &mut Vec<u8>) {
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
