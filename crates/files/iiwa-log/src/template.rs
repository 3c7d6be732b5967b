//! Messages that differ in numbers only, encoded once.

use std::iter::zip;

use crate::ros::Time;

/// A stamp or a double, as it stands in a message.
pub(crate) type Word = [u8; 8];

/// The bytes of a message of which only stamps and doubles change from one to the next.
#[derive(Clone, Debug)]
pub(crate) struct Template {
    names: Vec<String>,
    bytes: Vec<u8>,
    /// Where the stamps and doubles are, in their order.
    words: Vec<usize>,
}

impl Template {
    /// Of messages with these names. `encode` makes one with a stamp and a double in all places.
    pub(crate) fn new<'a>(
        names: impl Iterator<Item = &'a str>,
        encode: impl Fn(&mut Vec<u8>, Time, f64) -> Result<(), cdr_encoding::Error>,
    ) -> Result<Self, cdr_encoding::Error> {
        let (mut bytes, mut other) = (Vec::new(), Vec::new());
        encode(&mut bytes, Time { sec: 0, nanosec: 0 }, 0.0)?;
        // All bits of what may change are different ones.
        let ones = f64::from_bits(u64::MAX);
        encode(&mut other, Time { sec: -1, nanosec: u32::MAX }, ones)?;
        let mut words = Vec::new();
        let mut at = 0;
        while at < bytes.len() {
            let changes = bytes[at] != other[at];
            if changes {
                words.push(at);
            }
            at += if changes { size_of::<Word>() } else { 1 };
        }
        Ok(Self { names: names.map(str::to_owned).collect(), bytes, words })
    }

    /// Whether its messages have these names.
    pub(crate) fn has<'a>(&self, names: impl Iterator<Item = &'a str>) -> bool {
        names.eq(self.names.iter().map(String::as_str))
    }

    /// The message with these stamps and doubles.
    pub(crate) fn fill(&mut self, words: &[Word]) -> &[u8] {
        for (&at, word) in zip(&self.words, words) {
            self.bytes[at..at + size_of::<Word>()].copy_from_slice(word);
        }
        &self.bytes
    }
}

/// A stamp in a message.
pub(crate) fn stamp_word(stamp: Time) -> Word {
    let mut word = [0; size_of::<Word>()];
    word[..4].copy_from_slice(&stamp.sec.to_le_bytes());
    word[4..].copy_from_slice(&stamp.nanosec.to_le_bytes());
    word
}
