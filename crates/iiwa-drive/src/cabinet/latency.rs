//! How long the client takes to answer.

use std::time::{Duration, Instant};

use iiwa_fri::Format;

/// Times from a message to its answer.
#[derive(Clone, Debug, Default)]
pub struct Latency {
    /// In ns, in the order in which they came in.
    nanoseconds: Vec<u32>,
}

/// Most times that are kept: an hour at 1 ms.
const MOST: usize = 3_600_000;

impl Latency {
    /// How many answers were timed.
    #[must_use]
    pub fn count(&self) -> usize {
        self.nanoseconds.len()
    }

    /// The time that a share of all answers (0 to 1) did not exceed; none without answers.
    #[must_use]
    pub fn quantile(&self, share: f64) -> Option<Duration> {
        let mut sorted = self.nanoseconds.clone();
        let last = sorted.len().checked_sub(1)?;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within range")]
        let place = (share.clamp(0.0, 1.0) * last as f64).round() as usize;
        let (_, time, _) = sorted.select_nth_unstable(place);
        Some(Duration::from_nanos(u64::from(*time)))
    }
}

/// An answer that came more than a cycle after its message was sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Late {
    /// When the message was sent.
    pub sent: Instant,
    /// When the answer came.
    pub answered: Instant,
}

/// Most late answers that are kept.
const MOST_LATE: usize = 10_000;

/// Holds messages and answers together.
#[derive(Debug)]
pub(super) struct Watch {
    /// The last messages, each in the place that its counter gives it, until they are answered.
    sent: Box<[Option<Sent>]>,
    /// An answer that takes longer is late.
    cycle: Duration,
    late: Vec<Late>,
    unanswered: u64,
    latency: Latency,
}

#[derive(Clone, Copy, Debug)]
struct Sent {
    sequence: u32,
    at: Instant,
}

/// How many messages an answer may come late and still be timed: a power of two, so that counters that
/// wrap around keep their places.
const REMEMBERED: u32 = 1024;

impl Watch {
    pub(super) fn new(cycle: Duration) -> Self {
        let sent = vec![None; REMEMBERED as usize].into();
        Self { sent, cycle, late: Vec::new(), unanswered: 0, latency: Latency::default() }
    }

    pub(super) fn sent(&mut self, datagram: &[u8], now: Instant) {
        let Ok(message) = Format::V1.decode_monitoring(datagram) else { return };
        let sent = Sent { sequence: message.sequence, at: now };
        let before = self.place(message.sequence).replace(sent);
        self.unanswered += u64::from(before.is_some());
    }

    pub(super) fn answered(&mut self, datagram: &[u8], now: Instant) {
        let Ok(answer) = Format::V1.decode_command(datagram) else { return };
        let place = self.place(answer.reflected);
        let Some(sent) = place.take_if(|sent| sent.sequence == answer.reflected) else { return };
        let time = now.duration_since(sent.at);
        if time > self.cycle && self.late.len() < MOST_LATE {
            self.late.push(Late { sent: sent.at, answered: now });
        }
        if self.latency.nanoseconds.len() < MOST {
            let time = time.as_nanos();
            self.latency.nanoseconds.push(u32::try_from(time).unwrap_or(u32::MAX));
        }
    }

    fn place(&mut self, sequence: u32) -> &mut Option<Sent> {
        &mut self.sent[(sequence % REMEMBERED) as usize]
    }

    pub(super) fn latency(&self) -> &Latency {
        &self.latency
    }

    pub(super) fn late(&self) -> &[Late] {
        &self.late
    }

    pub(super) fn unanswered(&self) -> u64 {
        self.unanswered
    }
}

#[cfg(test)]
mod tests {
    use iiwa_fri::{Command, Monitoring};

    use super::*;

    #[test]
    fn tells_punctual_late_and_missing_answers_apart() {
        let mut watch = Watch::new(Duration::from_millis(10));
        let start = Instant::now();
        let ms = |ms: u64| start + Duration::from_millis(ms);
        let mut bytes = Vec::new();
        let first = u32::MAX - 1;
        for i in 0..REMEMBERED + 4 {
            let sequence = first.wrapping_add(i);
            let message = Monitoring { sequence, ..Monitoring::default() };
            Format::V1.encode_monitoring(&message, &mut bytes);
            let at = 10 * u64::from(i);
            watch.sent(&bytes, ms(at));
            // The second answer is late, the third and the last four never come; all come twice.
            let after = [4, 14].get(i as usize).copied().unwrap_or(6);
            if i == 2 || i >= REMEMBERED {
                continue;
            }
            Format::V1
                .encode_command(&Command { reflected: sequence, ..Command::default() }, &mut bytes);
            watch.answered(&bytes, ms(at + after));
            watch.answered(&bytes, ms(at + after + 1));
        }
        assert_eq!(watch.late(), [Late { sent: ms(10), answered: ms(24) }]);
        assert_eq!(watch.unanswered(), 1);
        let latency = watch.latency();
        assert_eq!(latency.count(), REMEMBERED as usize - 1);
        let quantiles = [0.0, 0.5, 1.0].map(|share| latency.quantile(share).unwrap().as_millis());
        assert_eq!(quantiles, [4, 6, 14]);
    }
}
