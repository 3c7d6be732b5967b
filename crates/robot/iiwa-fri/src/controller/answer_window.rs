//! The record of expected answers that the quality is computed from.

use crate::message::Quality;

/// Number of expected answers that the quality is computed from.
const WINDOW: u32 = 100;
/// Number of expected answers before the quality can be better than poor.
pub(super) const MIN_EXPECTED: u32 = 50;

/// Which of the last expected answers arrived: one bit each, the latest lowest.
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

    /// The quality by the share of answers that arrived.
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
