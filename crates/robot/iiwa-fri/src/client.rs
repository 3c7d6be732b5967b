//! Client side of a session: receives monitoring messages and answers them.
//!
//! Datagrams may be lost, duplicated, reordered or invalid, and the controller may restart. Each
//! message is compared with the latest one:
//!
//! | message | classified as |
//! |---|---|
//! | ahead of the latest one, unless restarted (below) | new; the messages in between are counted as lost |
//! | equal to the latest one in every value | repeated |
//! | behind, but with a later time stamp | restarted |
//! | more than 1000 behind | restarted |
//! | more than 20 behind, with a counter below 1000, in `Idle` or `MonitoringWait` | restarted |
//! | more than 1000 ahead, but with a counter below 1000, in `Idle` or `MonitoringWait` | restarted |
//! | the twentieth in a row behind the latest one, each ahead of its predecessor | restarted |
//! | otherwise behind, or with the same counter | late |

use iiwa_kin::Joints;

use crate::{
    counter::ahead,
    error::WireError,
    message::{Command, Monitoring, SessionState},
    wire::Format,
};

/// Maximum distance of a late message, in messages: a message further behind is from a restarted
/// controller.
const LATE_WINDOW: i32 = 1000;
/// Maximum reordering distance while a session opens, in messages.
const REORDER_WINDOW: i32 = 20;
/// Counters below this value may come from a controller that has just started.
const YOUNG_COUNTER: u32 = 1000;
/// Number of late messages in ascending order that indicate a restarted controller.
const RESTART_ROW: u32 = 20;

/// Client session.
///
/// ```
/// use iiwa_fri::{Format, FriClient, Monitoring, Received, SessionState};
///
/// let mut client = FriClient::new(Format::V1);
/// let message = Monitoring {
///     session: SessionState::CommandingActive,
///     commanded_rad: Some([0.0; 7]),
///     ..Monitoring::default()
/// };
/// let (mut datagram, mut answer) = (Vec::new(), Vec::new());
/// Format::V1.encode_monitoring(&message, &mut datagram);
///
/// assert_eq!(client.receive(&datagram)?, Received::New);
/// assert!(client.is_due());
/// assert!(client.answer(Some(&[0.001; 7]), &mut answer));
/// assert_eq!(Format::V1.decode_command(&answer)?.joints_rad, Some([0.001; 7]));
/// # Ok::<(), iiwa_fri::WireError>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct FriClient {
    format: Format,
    latest: Option<Monitoring>,
    /// `true` if the latest message has not been answered yet.
    pending: bool,
    /// Sequence counter of the last answered message.
    answered: Option<u32>,
    /// Sequence counter of the client.
    sequence: u32,
    /// The last set-point since commanding became active.
    held_rad: Option<Joints>,
    /// Sequence counter of the last late message, and the length of the ascending row.
    late_row: Option<(u32, u32)>,
    counters: Counters,
}

/// Relation of a message to the previous ones.
///
/// ```
/// use iiwa_fri::{FriClient, Monitoring, Received};
///
/// let mut client = FriClient::default();
/// let message = |sequence| Monitoring { sequence, ..Monitoring::default() };
/// assert_eq!(client.accept(message(7)), Received::New);
/// assert_eq!(client.accept(message(7)), Received::Repeated);
/// assert_eq!(client.accept(message(9)), Received::New);
/// assert_eq!(client.accept(message(8)), Received::Late);
/// assert_eq!(client.counters().lost, 1);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Received {
    /// The message is the latest so far.
    New,
    /// A later message has overtaken this message.
    Late,
    /// The message repeats the latest one.
    Repeated,
    /// The message is the first one of a restarted controller.
    Restarted,
}

impl Received {
    /// Returns true if the message is the latest one, which may require an answer.
    #[must_use]
    pub const fn is_fresh(self) -> bool {
        matches!(self, Self::New | Self::Restarted)
    }
}

/// Statistics of the received messages since the client was created.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Counters {
    /// Decoded messages.
    pub received: u64,
    /// Gaps in the controller's counter, including messages that arrived late.
    pub lost: u64,
    /// Messages that arrived after a later one.
    pub late: u64,
    /// Messages that arrived twice.
    pub repeated: u64,
    /// Datagrams that could not be decoded.
    pub invalid: u64,
    /// Answers sent.
    pub answered: u64,
}

impl FriClient {
    /// Creates a client that has not received any message.
    #[must_use]
    pub fn new(format: Format) -> Self {
        Self { format, ..Self::default() }
    }

    /// Decodes and accepts a controller datagram.
    ///
    /// # Errors
    ///
    /// Any [`WireError`]. The datagram is counted as invalid and the session continues.
    pub fn receive(&mut self, datagram: &[u8]) -> Result<Received, WireError> {
        self.decode(datagram).map(|message| self.accept(message))
    }

    /// Decodes a datagram without accepting its message; see [`accept`](Self::accept).
    ///
    /// # Errors
    ///
    /// Any [`WireError`]. The datagram is counted as invalid and the session continues.
    pub fn decode(&mut self, datagram: &[u8]) -> Result<Monitoring, WireError> {
        let message = self.format.decode_monitoring(datagram);
        message.inspect_err(|_| self.counters.invalid += 1)
    }

    /// Accepts a controller message.
    pub fn accept(&mut self, message: Monitoring) -> Received {
        let received = self.classify(&message);
        match received {
            Received::New => {
                let by = self.latest.as_ref().map_or(1, |it| ahead(message.sequence, it.sequence));
                self.counters.lost += u64::from(by.unsigned_abs()) - 1;
                self.keep(message);
            }
            Received::Restarted => self.restart(message),
            Received::Late => {
                self.late_row = Some((message.sequence, self.row(&message)));
                self.counters.late += 1;
                self.counters.received += 1;
            }
            Received::Repeated => {
                self.counters.repeated += 1;
                self.counters.received += 1;
            }
        }
        received
    }

    /// Accepts a message as the first one of a restarted controller, for any counter.
    pub fn restart(&mut self, message: Monitoring) {
        self.answered = None;
        self.keep(message);
    }

    fn keep(&mut self, message: Monitoring) {
        self.counters.received += 1;
        self.late_row = None;
        self.pending = true;
        self.latest = Some(message);
    }

    /// Returns the length of the row of late messages in ascending order, including this message.
    fn row(&self, message: &Monitoring) -> u32 {
        match self.late_row {
            Some((last, row)) if ahead(message.sequence, last) > 0 => row + 1,
            _ => 1,
        }
    }

    /// Returns the classification of `message` by [`accept`](Self::accept), without accepting it.
    #[must_use]
    pub fn classify(&self, message: &Monitoring) -> Received {
        let Some(latest) = &self.latest else { return Received::New };
        let by = ahead(message.sequence, latest.sequence);
        let opening =
            message.session <= SessionState::MonitoringWait && message.sequence < YOUNG_COUNTER;
        if by > 0 {
            if opening && by > LATE_WINDOW {
                return Received::Restarted;
            }
            return Received::New;
        }
        if message == latest {
            return Received::Repeated;
        }
        let is_later = message.time.zip(latest.time).is_some_and(|(time, latest)| time > latest);
        let is_row = self.row(message) >= RESTART_ROW;
        if is_later || by < -LATE_WINDOW || (opening && by < -REORDER_WINDOW) || is_row {
            return Received::Restarted;
        }
        Received::Late
    }

    /// Returns true if an answer to the latest message is due: the message has not been answered
    /// yet, the session is not idle, and the last answered message is at least `receive_multiplier`
    /// messages ago.
    #[must_use]
    pub fn is_due(&self) -> bool {
        let Some(latest) = self.latest.as_ref().filter(|_| self.pending) else { return false };
        let since = self.answered.map(|answered| latest.sequence.wrapping_sub(answered));
        latest.session != SessionState::Idle
            && since.is_none_or(|messages| messages >= latest.receive_multiplier)
    }

    /// Encodes the answer to the latest message into `out`, whose content is replaced.
    ///
    /// | session state | with a finite `setpoint_rad` (rad) | without set-point |
    /// |---|---|---|
    /// | monitoring | the commanded position of the message | the commanded position of the message |
    /// | commanding, waiting | the set-point | the interpolated position, or else the commanded one |
    /// | commanding, active | the set-point | the last set-point since it became active, or else the commanded position |
    ///
    /// Returns `false` and leaves `out` empty if no answer [is due](Self::is_due).
    pub fn answer(&mut self, setpoint_rad: Option<&Joints>, out: &mut Vec<u8>) -> bool {
        out.clear();
        let Some(latest) = self.latest.as_ref().filter(|_| self.is_due()) else { return false };
        let commands = latest.session.commands();
        let setpoint_rad =
            setpoint_rad.filter(|joints| commands && joints.iter().all(|q| q.is_finite())).copied();
        self.held_rad = setpoint_rad
            .or(self.held_rad)
            .filter(|_| latest.session == SessionState::CommandingActive);
        let held = match latest.session {
            SessionState::CommandingActive => {
                self.held_rad.or(latest.commanded_rad).or(latest.ipo_rad)
            }
            _ => latest.ipo_rad.filter(|_| commands),
        };
        let command = Command {
            sequence: self.sequence,
            reflected: latest.sequence,
            joints_rad: setpoint_rad.or(held).or(latest.commanded_rad),
        };
        self.format.encode_command(&command, out);
        self.answered = Some(latest.sequence);
        self.pending = false;
        self.sequence = self.sequence.wrapping_add(1);
        self.counters.answered += 1;
        true
    }

    /// Returns the latest message.
    #[must_use]
    pub const fn latest(&self) -> Option<&Monitoring> {
        self.latest.as_ref()
    }

    /// Returns the statistics of the received messages.
    #[must_use]
    pub const fn counters(&self) -> Counters {
        self.counters
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use Received::{Late, New, Repeated, Restarted};
    use SessionState::{CommandingActive, CommandingWait, Idle, MonitoringReady, MonitoringWait};

    use super::*;

    const COMMANDED: Joints = [0.1; 7];
    const IPO: Joints = [0.2; 7];
    const SETPOINT: Joints = [0.3; 7];

    fn message(sequence: u32, session: SessionState) -> Monitoring {
        Monitoring {
            sequence,
            session,
            commanded_rad: Some(COMMANDED),
            ipo_rad: Some(IPO),
            ..Monitoring::default()
        }
    }

    fn give(client: &mut FriClient, message: &Monitoring) -> Received {
        let mut bytes = Vec::new();
        Format::V1.encode_monitoring(message, &mut bytes);
        client.receive(&bytes).unwrap()
    }

    fn sequence(client: &mut FriClient, sequence: u32) -> Received {
        give(client, &message(sequence, MonitoringReady))
    }

    fn answer(client: &mut FriClient, setpoint: Option<&Joints>) -> Option<Command> {
        let mut out = vec![1];
        let answered = client.answer(setpoint, &mut out);
        assert_eq!(answered, !out.is_empty());
        answered.then(|| Format::V1.decode_command(&out).unwrap())
    }

    #[test]
    fn answers_depend_on_the_session_state() {
        let mut client = FriClient::default();
        assert_eq!(answer(&mut client, Some(&SETPOINT)), None);
        let nan = [0.0, 0.0, 0.0, f64::NAN, 0.0, 0.0, 0.0];
        for (n, (session, setpoint, expected)) in (0..).zip([
            (MonitoringWait, None, COMMANDED),
            (MonitoringReady, Some(SETPOINT), COMMANDED),
            (CommandingWait, None, IPO),
            (CommandingWait, Some(SETPOINT), SETPOINT),
            (CommandingActive, None, COMMANDED),
            (CommandingActive, Some(SETPOINT), SETPOINT),
            (CommandingActive, Some(nan), SETPOINT),
            (CommandingActive, None, SETPOINT),
            (MonitoringReady, None, COMMANDED),
            (CommandingActive, None, COMMANDED),
        ]) {
            assert_eq!(give(&mut client, &message(40 + n, session)), New);
            let expected = Command { sequence: n, reflected: 40 + n, joints_rad: Some(expected) };
            assert_eq!(answer(&mut client, setpoint.as_ref()), Some(expected));
            assert_eq!(answer(&mut client, setpoint.as_ref()), None, "one answer a message");
        }
        give(&mut client, &message(50, Idle));
        assert_eq!(answer(&mut client, None), None);
        let without = Monitoring { commanded_rad: None, ..message(51, MonitoringWait) };
        give(&mut client, &without);
        let header = Command { sequence: 10, reflected: 51, joints_rad: None };
        assert_eq!(answer(&mut client, None), Some(header));
        assert_eq!(client.counters().answered, 11);
    }

    #[test]
    fn answers_follow_the_receive_multiplier() {
        let mut client = FriClient::default();
        let reflected: Vec<u32> = [0, 1, 2, 3, 4, 5, 7, 8, 9, 10, 11, 30, 31]
            .into_iter()
            .filter(|&sequence| {
                let message = message(sequence, MonitoringReady);
                give(&mut client, &Monitoring { receive_multiplier: 3, ..message });
                answer(&mut client, None).is_some()
            })
            .collect();
        assert_eq!(reflected, [0, 3, 7, 10, 30]);
    }

    #[test]
    fn counts_losses_delays_and_repetitions() {
        let mut client = FriClient::default();
        for (n, expected) in
            [(7, New), (8, New), (12, New), (10, Late), (12, Repeated), (9, Late), (13, New)]
        {
            assert_eq!(sequence(&mut client, n), expected, "{n}");
        }
        assert!(client.receive(b"garbage").is_err());
        assert_eq!(answer(&mut client, None).unwrap().reflected, 13);
        assert_eq!(sequence(&mut client, 11), Late);
        assert_eq!(answer(&mut client, None), None);
        let expected =
            Counters { received: 8, lost: 3, late: 3, repeated: 1, invalid: 1, answered: 1 };
        assert_eq!(client.counters(), expected);
    }

    #[test]
    fn both_counters_wrap_around() {
        let mut client = FriClient { sequence: u32::MAX - 1, ..FriClient::default() };
        let mut sequences = Vec::new();
        for n in [u32::MAX - 2, u32::MAX - 1, u32::MAX, 0, 2] {
            assert_eq!(sequence(&mut client, n), New);
            sequences.push(answer(&mut client, None).unwrap().sequence);
        }
        assert_eq!(sequences, [u32::MAX - 1, u32::MAX, 0, 1, 2]);
        assert_eq!(sequence(&mut client, u32::MAX), Late);
        // This also holds while the session opens.
        let mut client = FriClient::default();
        give(&mut client, &message(u32::MAX - 5, MonitoringWait));
        assert_eq!(give(&mut client, &message(5, MonitoringWait)), New);
        assert_eq!(client.counters().lost, 10);
    }

    #[test]
    fn a_restarted_controller_is_detected() {
        let after = |last: u32, next: &Monitoring| {
            let mut client = FriClient::default();
            sequence(&mut client, last);
            answer(&mut client, None);
            let received = give(&mut client, next);
            assert_eq!(answer(&mut client, None).is_some(), received == Restarted);
            assert_eq!(client.counters().lost, 0);
            received
        };
        assert_eq!(after(5000, &message(3000, MonitoringReady)), Restarted);
        assert_eq!(after(5000, &message(4000, MonitoringReady)), Late);
        assert_eq!(after(500, &message(3, MonitoringWait)), Restarted);
        assert_eq!(after(500, &message(3, MonitoringReady)), Late);
        assert_eq!(after(60, &message(49, MonitoringWait)), Late);
        // Half of the counter's range ago, and more.
        assert_eq!(after(3_000_000_000, &message(0, MonitoringWait)), Restarted);
        assert_eq!(after(2_000_000_000, &message(0, MonitoringWait)), Restarted);
    }

    #[test]
    fn restarts_are_told_from_delays_at_the_documented_distances() {
        let received = |latest, (sequence, session)| {
            let mut client = FriClient::default();
            client.accept(message(latest, MonitoringReady));
            client.classify(&message(sequence, session))
        };
        for (latest, first, second, expected) in [
            // 1000 behind, and 1001.
            (5000, (4000, MonitoringReady), (3999, MonitoringReady), Late),
            // 20 behind, and 21; in other states of the session.
            (500, (480, MonitoringWait), (479, MonitoringWait), Late),
            (500, (480, Idle), (479, Idle), Late),
            (500, (479, MonitoringReady), (479, MonitoringWait), Late),
            // A counter of 1000, and of 999.
            (1100, (1000, MonitoringWait), (999, MonitoringWait), Late),
            // 1000 ahead, and 1001.
            (u32::MAX - 500, (499, MonitoringWait), (500, MonitoringWait), New),
        ] {
            assert_eq!(received(latest, first), expected, "{first:?} after {latest}");
            assert_eq!(received(latest, second), Restarted, "{second:?} after {latest}");
        }
    }

    #[test]
    fn a_later_stamp_on_a_lower_counter_is_a_restart() {
        let at = |sequence, ms| Monitoring {
            time: Some(Duration::from_millis(ms)),
            ..message(sequence, MonitoringWait)
        };
        let mut client = FriClient::default();
        give(&mut client, &at(3, 15));
        assert_eq!(give(&mut client, &at(2, 10)), Late);
        assert_eq!(give(&mut client, &at(3, 15)), Repeated);
        assert_eq!(give(&mut client, &at(1, 9000)), Restarted);
        assert_eq!(give(&mut client, &at(1, 18_000)), Restarted);
        assert_eq!(give(&mut client, &at(2, 18_005)), New);
    }

    #[test]
    fn a_row_of_late_messages_is_a_restart() {
        let mut client = FriClient::default();
        sequence(&mut client, 100);
        for n in 0..19 {
            assert_eq!(sequence(&mut client, n), Late);
        }
        assert_eq!(sequence(&mut client, 19), Restarted);
        assert_eq!(sequence(&mut client, 20), New);
        // Late messages that are not in ascending order remain late.
        sequence(&mut client, 100);
        for n in (40..80).rev() {
            assert_eq!(sequence(&mut client, n), Late);
        }
    }
}
