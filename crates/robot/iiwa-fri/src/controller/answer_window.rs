//! Record of expected answers, from which the quality is computed.

use crate::message::Quality;

/// Number of expected answers in the record.
const WINDOW: u32 = 100;
/// Number of expected answers before the quality can be better than poor.
pub(super) const MIN_EXPECTED: u32 = 50;

/// Arrival flags of the last expected answers: one bit each, the latest in the lowest bit.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct AnswerWindow {
    bits: u128,
    expected: u32,
}

impl AnswerWindow {
    /// Records an expected answer.
    pub(super) const fn push(&mut self, arrived: bool) {
        self.bits = (self.bits << 1 | arrived as u128) & ((1 << WINDOW) - 1);
        if self.expected < WINDOW {
            self.expected += 1;
        }
    }

    /// Returns the quality from the share of received answers.
    pub(super) const fn quality(self) -> Quality {
        if self.expected < MIN_EXPECTED {
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
