//! The client's side of a session: it listens to the controller and answers.
//!
//! Datagrams may be lost, doubled, late or garbage, and the controller may start again. A message
//! whose counter is not ahead of the youngest one is *late*, unless it shows that the counter has
//! begun anew:
//!
//! | the message | is |
//! |---|---|
//! | ahead of the youngest one | new, with a gap of `lost` messages before it |
//! | equal to the youngest one in every value | repeated |
//! | behind it, with a time stamp that is ahead of its | restarted |
//! | more than 1000 behind | restarted |
//! | more than 20 behind, with a counter below 1000, in `Idle` or `MonitoringWait` | restarted |
//! | more than 1000 ahead, with a counter below 1000, in `Idle` or `MonitoringWait`, where a counter that wraps around would not be | restarted |
//! | the twentieth of a row behind the youngest one, each ahead of the one before | restarted |
//! | any other that is behind, or has the same counter | late |

use iiwa_kin::Joints;

use super::{Command, Format, Monitoring, SessionState, WireError, ahead};

/// How far behind a message may be and still be late, in messages.
const LATE_WINDOW: i32 = 1000;
/// How far datagrams overtake each other, at most, while a session opens, in messages.
const REORDER_WINDOW: i32 = 20;
/// Counters below this one belong to a controller that has just started.
const YOUNG_COUNTER: u32 = 1000;
/// How many late messages in a row, in their order, are no longer late.
const RESTART_ROW: u32 = 20;

/// The client's session.
#[derive(Clone, Debug, Default)]
pub struct Client {
    format: Format,
    latest: Option<Monitoring>,
    /// Whether the latest message has not been answered.
    pending: bool,
    /// The controller's counter in the message answered last.
    answered: Option<u32>,
    /// The own counter.
    sequence: u32,
    /// The counter of the last late message, and how many of them came in their order.
    late_row: Option<(u32, u32)>,
    counters: Counters,
}

/// What a message was.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Received {
    /// The youngest so far.
    New,
    /// Overtaken by a younger one.
    Late,
    /// The youngest one once more.
    Repeated,
    /// The first one of a controller that has started again, its counter with it.
    Restarted,
}

/// What has happened to the messages, since the client began.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Messages that decoded, whatever became of them.
    pub received: u64,
    /// Messages missing in the controller's counter. One that comes late is among them.
    pub lost: u64,
    /// Messages that a younger one had overtaken.
    pub late: u64,
    /// Messages that came twice.
    pub repeated: u64,
    /// Datagrams that were no message.
    pub invalid: u64,
    /// Answers.
    pub answered: u64,
}

impl Client {
    /// A client that has heard nothing.
    #[must_use]
    pub fn new(format: Format) -> Self {
        Self { format, ..Self::default() }
    }

    /// Takes a datagram of the controller.
    ///
    /// # Errors
    ///
    /// When it is no message. It is counted, and the session goes on.
    pub fn receive(&mut self, datagram: &[u8]) -> Result<Received, WireError> {
        let message = self.format.decode_monitoring(datagram).inspect_err(|_| {
            self.counters.invalid += 1;
        })?;
        self.counters.received += 1;
        let received = self.judge(&message);
        match received {
            Received::New | Received::Restarted => {
                if received == Received::Restarted {
                    self.answered = None;
                }
                self.late_row = None;
                self.pending = true;
                self.latest = Some(message);
            }
            Received::Late => self.counters.late += 1,
            Received::Repeated => self.counters.repeated += 1,
        }
        Ok(received)
    }

    /// What `message` is; counts the gap before a new one.
    fn judge(&mut self, message: &Monitoring) -> Received {
        let Some(latest) = &self.latest else { return Received::New };
        let by = ahead(message.sequence, latest.sequence);
        let opening =
            message.session <= SessionState::MonitoringWait && message.sequence < YOUNG_COUNTER;
        if by > 0 {
            if opening && by > LATE_WINDOW && message.sequence < latest.sequence {
                return Received::Restarted;
            }
            self.counters.lost += u64::from(by.unsigned_abs()) - 1;
            return Received::New;
        }
        if message == latest {
            return Received::Repeated;
        }
        let younger = message.time.zip(latest.time).is_some_and(|(time, latest)| time > latest);
        let row = match self.late_row {
            Some((last, row)) if ahead(message.sequence, last) > 0 => row + 1,
            _ => 1,
        };
        self.late_row = Some((message.sequence, row));
        if younger || by < -LATE_WINDOW || (opening && by < -REORDER_WINDOW) || row >= RESTART_ROW {
            return Received::Restarted;
        }
        Received::Late
    }

    /// Writes the answer to the latest message in place of what `out` holds. In monitoring it
    /// echoes the commanded joint positions. In the commanding states it sends `setpoint_rad`, or
    /// the controller's own interpolation without one, or with one that is not finite.
    ///
    /// `false`, and nothing in `out`, when no answer is due: there is no new message, the session
    /// is idle, or the last answer is less than `receive_multiplier` messages ago.
    pub fn answer(&mut self, setpoint_rad: Option<&Joints>, out: &mut Vec<u8>) -> bool {
        out.clear();
        let Some(latest) = self.latest.as_ref().filter(|_| self.pending) else { return false };
        if latest.session == SessionState::Idle {
            return false;
        }
        let since = self.answered.map(|answered| latest.sequence.wrapping_sub(answered));
        if since.is_some_and(|messages| messages < latest.receive_multiplier) {
            return false;
        }
        let held = if latest.session.commands() { latest.ipo_rad } else { None };
        let setpoint_rad = setpoint_rad
            .filter(|joints| latest.session.commands() && joints.iter().all(|q| q.is_finite()));
        let command = Command {
            sequence: self.sequence,
            reflected: latest.sequence,
            joints_rad: setpoint_rad.copied().or(held).or(latest.commanded_rad),
        };
        self.format.encode_command(&command, out);
        self.answered = Some(latest.sequence);
        self.pending = false;
        self.sequence = self.sequence.wrapping_add(1);
        self.counters.answered += 1;
        true
    }

    /// The youngest message.
    #[must_use]
    pub const fn latest(&self) -> Option<&Monitoring> {
        self.latest.as_ref()
    }

    /// What has happened to the messages.
    #[must_use]
    pub const fn counters(&self) -> Counters {
        self.counters
    }
}
