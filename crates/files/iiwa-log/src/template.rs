//! Messages that differ in numbers only, encoded once.

use std::iter::zip;

use crate::ros::Time;

/// Encoded stamp or double.
pub(crate) type Word = [u8; 8];

/// Encoded message in which only stamps and doubles change.
#[derive(Clone, Debug)]
pub(crate) struct Template {
    names: Vec<String>,
    bytes: Vec<u8>,
    /// Offsets of the stamps and doubles, in their order.
    words: Vec<usize>,
}

impl Template {
    /// Creates the template of messages with these names. `encode` encodes a message with the same
    /// stamp and the same double everywhere.
    pub(crate) fn new<'a>(
        names: impl Iterator<Item = &'a str>,
        encode: impl Fn(&mut Vec<u8>, Time, f64) -> Result<(), cdr_encoding::Error>,
    ) -> Result<Self, cdr_encoding::Error> {
        let (mut bytes, mut other) = (Vec::new(), Vec::new());
        encode(&mut bytes, Time { sec: 0, nanosec: 0 }, 0.0)?;
        // All bits of variable bytes differ between the two messages.
        let ones = f64::from_bits(u64::MAX);
        encode(&mut other, Time { sec: -1, nanosec: u32::MAX }, ones)?;
        let mut words = Vec::new();
        let mut offset = 0;
        while offset < bytes.len() {
            let changes = bytes[offset] != other[offset];
            if changes {
                words.push(offset);
            }
            offset += if changes { size_of::<Word>() } else { 1 };
        }
        Ok(Self { names: names.map(str::to_owned).collect(), bytes, words })
    }

    /// Returns true if the messages have these names.
    pub(crate) fn has<'a>(&self, names: impl Iterator<Item = &'a str>) -> bool {
        names.eq(self.names.iter().map(String::as_str))
    }

    /// Returns the message with these stamps and doubles.
    pub(crate) fn fill(&mut self, words: &[Word]) -> &[u8] {
        for (&offset, word) in zip(&self.words, words) {
            self.bytes[offset..offset + size_of::<Word>()].copy_from_slice(word);
        }
        &self.bytes
    }
}

/// Encodes a stamp.
pub(crate) fn stamp_word(stamp: Time) -> Word {
    let mut word = [0; size_of::<Word>()];
    word[..4].copy_from_slice(&stamp.sec.to_le_bytes());
    word[4..].copy_from_slice(&stamp.nanosec.to_le_bytes());
    word
}
