//! How long the client takes to answer.

use std::time::{Duration, Instant};

use crate::fri::Format;

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

/// Holds messages and answers together.
#[derive(Debug)]
pub(super) struct Watch {
    /// The last messages: counter, and when they were sent, until they are answered.
    sent: [Option<(u32, Instant)>; 64],
    next: usize,
    unanswered: u64,
    latency: Latency,
}

impl Default for Watch {
    fn default() -> Self {
        Self { sent: [None; 64], next: 0, unanswered: 0, latency: Latency::default() }
    }
}

impl Watch {
    pub(super) fn sent(&mut self, datagram: &[u8], now: Instant) {
        let Ok(message) = Format::V1.decode_monitoring(datagram) else { return };
        let slot = &mut self.sent[self.next];
        self.unanswered += u64::from(slot.is_some());
        *slot = Some((message.sequence, now));
        self.next = (self.next + 1) % self.sent.len();
    }

    pub(super) fn answered(&mut self, datagram: &[u8], now: Instant) {
        let Ok(answer) = Format::V1.decode_command(datagram) else { return };
        let of = |slot: &&mut Option<(u32, Instant)>| {
            slot.is_some_and(|(sequence, _)| sequence == answer.reflected)
        };
        if let Some((_, at)) = self.sent.iter_mut().find(of).and_then(Option::take)
            && self.latency.nanoseconds.len() < MOST
        {
            let time = now.duration_since(at).as_nanos();
            self.latency.nanoseconds.push(u32::try_from(time).unwrap_or(u32::MAX));
        }
    }

    pub(super) fn latency(&self) -> &Latency {
        &self.latency
    }

    pub(super) fn unanswered(&self) -> u64 {
        self.unanswered
    }
}
