//! Answer latency of the FRI client.

use std::time::{Duration, Instant};

use iiwa_fri::Format;

/// Latencies: times from messages to their answers.
#[derive(Clone, Debug, Default)]
pub struct Latency {
    /// Latencies in ns, in order of arrival.
    nanoseconds: Vec<u32>,
}

/// Maximum number of stored latencies: one hour at 1 ms.
const MAX_SAMPLES: usize = 3_600_000;

impl Latency {
    /// Returns the number of timed answers.
    #[must_use]
    pub fn count(&self) -> usize {
        self.nanoseconds.len()
    }

    /// Returns the quantile for a share (0 to 1) of the answers; `None` without answers.
    #[must_use]
    pub fn quantile(&self, share: f64) -> Option<Duration> {
        let mut sorted = self.nanoseconds.clone();
        let last = sorted.len().checked_sub(1)?;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within range")]
        let index = (share.clamp(0.0, 1.0) * last as f64).round() as usize;
        let (_, time, _) = sorted.select_nth_unstable(index);
        Some(Duration::from_nanos(u64::from(*time)))
    }
}

/// An answer more than one cycle after its message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct LateAnswer {
    /// Time at which the message was sent.
    pub sent: Instant,
    /// Time at which the answer arrived.
    pub answered: Instant,
}

/// Maximum number of stored late answers.
const MAX_LATE: usize = 10_000;

/// Matches answers to their messages.
#[derive(Debug)]
pub(crate) struct LatencyMonitor {
    /// The last messages without an answer, indexed by their counters.
    sent: Box<[Option<SentMessage>]>,
    /// Latency above which an answer is late.
    cycle: Duration,
    late: Vec<LateAnswer>,
    unanswered: u64,
    latency: Latency,
}

#[derive(Clone, Copy, Debug)]
struct SentMessage {
    sequence: u32,
    at: Instant,
}

/// Number of messages after which an answer is no longer timed: a power of two, so that indices
/// remain valid when counters wrap around.
const WINDOW: u32 = 1024;

impl LatencyMonitor {
    pub(crate) fn new(cycle: Duration) -> Self {
        let sent = vec![None; WINDOW as usize].into();
        Self { sent, cycle, late: Vec::new(), unanswered: 0, latency: Latency::default() }
    }

    pub(crate) fn sent(&mut self, datagram: &[u8], now: Instant) {
        let Ok(message) = Format::V1.decode_monitoring(datagram) else { return };
        let sent = SentMessage { sequence: message.sequence, at: now };
        let before = self.slot(message.sequence).replace(sent);
        self.unanswered += u64::from(before.is_some());
    }

    pub(crate) fn answered(&mut self, datagram: &[u8], now: Instant) {
        let Ok(answer) = Format::V1.decode_command(datagram) else { return };
        let slot = self.slot(answer.reflected);
        let Some(sent) = slot.take_if(|sent| sent.sequence == answer.reflected) else { return };
        let time = now.duration_since(sent.at);
        if time > self.cycle && self.late.len() < MAX_LATE {
            self.late.push(LateAnswer { sent: sent.at, answered: now });
        }
        if self.latency.nanoseconds.len() < MAX_SAMPLES {
            let time = time.as_nanos();
            self.latency.nanoseconds.push(u32::try_from(time).unwrap_or(u32::MAX));
        }
    }

    fn slot(&mut self, sequence: u32) -> &mut Option<SentMessage> {
        &mut self.sent[(sequence % WINDOW) as usize]
    }

    pub(crate) fn latency(&self) -> &Latency {
        &self.latency
    }

    pub(crate) fn late(&self) -> &[LateAnswer] {
        &self.late
    }

    pub(crate) fn unanswered(&self) -> u64 {
        self.unanswered
    }
}

#[cfg(test)]
mod tests {
    use iiwa_fri::{Command, Monitoring};

    use super::*;

    #[test]
    fn timely_late_and_missing_answers_are_distinguished() {
        let mut monitor = LatencyMonitor::new(Duration::from_millis(10));
        let start = Instant::now();
        let ms = |ms: u64| start + Duration::from_millis(ms);
        let mut bytes = Vec::new();
        let first = u32::MAX - 1;
        for i in 0..WINDOW + 4 {
            let sequence = first.wrapping_add(i);
            let message = Monitoring { sequence, ..Monitoring::default() };
            Format::V1.encode_monitoring(&message, &mut bytes);
            let time = 10 * u64::from(i);
            monitor.sent(&bytes, ms(time));
            // The second answer is late, the third and the last four are missing; all arrive twice.
            let after = [4, 14].get(i as usize).copied().unwrap_or(6);
            if i == 2 || i >= WINDOW {
                continue;
            }
            Format::V1
                .encode_command(&Command { reflected: sequence, ..Command::default() }, &mut bytes);
            monitor.answered(&bytes, ms(time + after));
            monitor.answered(&bytes, ms(time + after + 1));
        }
        assert_eq!(monitor.late(), [LateAnswer { sent: ms(10), answered: ms(24) }]);
        assert_eq!(monitor.unanswered(), 1);
        let latency = monitor.latency();
        assert_eq!(latency.count(), WINDOW as usize - 1);
        let quantiles = [0.0, 0.5, 1.0].map(|share| latency.quantile(share).unwrap().as_millis());
        assert_eq!(quantiles, [4, 6, 14]);
    }
}
