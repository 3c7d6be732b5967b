//! Blocks of LZ4 for messages that resemble earlier ones.
//!
//! Consecutive messages of a topic differ in numbers and stamps only: names, lengths and frames are
//! at the same distance from the start of each message. A search for repeated bytes, as in general
//! compressors, took more instructions than planning. Here, each message is compared only with the
//! previous message of its topic, eight bytes at a time. For a plan of ten motions, that takes a
//! third of the instructions of the search, and the file is 8 % larger.
//!
//! Format: <https://github.com/lz4/lz4/blob/dev/doc/lz4_Block_format.md>.

use std::ops::Range;

/// Start of a message in its chunk, or of other records.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MessageStart {
    pub(crate) at: usize,
    /// Start of the previous message of the topic in the chunk, if there is one.
    pub(crate) previous: Option<usize>,
}

/// Least length of a repeated part that is worth its three bytes in the block.
const MIN_REPEATED: usize = 6;

/// Length of a repeated part that is written as 0.
const LENGTH_OF_ZERO: usize = 4;

/// A repeated part starts at least this far from the end of a block.
const LAST_START: usize = 12;

/// Bytes at the end of a block that are never repeated parts.
const LAST_LITERALS: usize = 5;

/// Largest distance between a repeated part and its source.
pub(crate) const MAX_DISTANCE: usize = u16::MAX as usize;

/// Appends `data[block]` as an LZ4 block to `out`. `starts` are those in the block, in order.
pub(crate) fn put_block(
    data: &[u8],
    block: Range<usize>,
    starts: &[MessageStart],
    out: &mut Vec<u8>,
) {
    let mut writer = BlockWriter { data, literals: block.start, out };
    // Positions from which on no repeated part may start, and at which each must have ended.
    let (last_start, last_end) =
        (block.end.saturating_sub(LAST_START), block.end.saturating_sub(LAST_LITERALS));
    let mut ends = starts.iter().skip(1).map(|next| next.at);
    for start in starts {
        let end = ends.next().unwrap_or(block.end).min(last_end);
        let previous = start.previous.filter(|previous| *previous >= block.start);
        let distance = previous.map(|previous| start.at - previous);
        if let Some(distance) = distance.filter(|distance| (1..=MAX_DISTANCE).contains(distance)) {
            writer.message(start.at..end.max(start.at), distance, last_start);
        }
    }
    writer.finish(block.end);
}

/// Writer of the sequences of a block: literals, and a repeated part.
struct BlockWriter<'a> {
    data: &'a [u8],
    /// Start of the bytes that are not in `out` yet.
    literals: usize,
    out: &'a mut Vec<u8>,
}

#[expect(clippy::cast_possible_truncation, reason = "digits and distances are bounded")]
impl BlockWriter<'_> {
    /// Adds the parts of a message that equal the bytes `distance` before.
    fn message(&mut self, message: Range<usize>, distance: usize, last_start: usize) {
        let (words, rest) = self.data[message.clone()].as_chunks();
        let earlier = &self.data[message.start - distance..message.end - distance];
        let (earlier_words, earlier_rest) = earlier.as_chunks();
        // Start of the present repeated part.
        let mut from = message.start;
        let mut at = message.start;
        for (word, earlier) in words.iter().zip(earlier_words) {
            let difference = u64::from_le_bytes(*word) ^ u64::from_le_bytes(*earlier);
            if difference != 0 {
                let equal = |zeros: u32| (zeros / 8) as usize;
                let end = at + equal(difference.trailing_zeros());
                if end - from >= MIN_REPEATED {
                    self.repeat(from..end, distance, last_start);
                }
                // The last bytes of the word may begin another part.
                from = at + 8 - equal(difference.leading_zeros());
            }
            at += 8;
        }
        let equal = rest.iter().zip(earlier_rest).take_while(|(a, b)| a == b).count();
        if at + equal - from >= MIN_REPEATED {
            self.repeat(from..at + equal, distance, last_start);
        }
    }

    /// Appends a part that equals the bytes `distance` before, and the literals up to it.
    fn repeat(&mut self, part: Range<usize>, distance: usize, last_start: usize) {
        if part.start > last_start {
            return;
        }
        self.sequence(part.start, part.len() - LENGTH_OF_ZERO);
        self.out.extend_from_slice(&(distance as u16).to_le_bytes());
        self.length(part.len() - LENGTH_OF_ZERO);
        self.literals = part.end;
    }

    /// Appends the start of a sequence: the literals up to `end`, and the first digit of
    /// `repeated`, the length of the part that follows.
    fn sequence(&mut self, end: usize, repeated: usize) {
        let literals = &self.data[self.literals..end];
        let digit = |length: usize| length.min(15) as u8;
        self.out.push(digit(literals.len()) << 4 | digit(repeated));
        self.length(literals.len());
        self.out.extend_from_slice(literals);
    }

    /// Appends what the first digit of a length lacks.
    fn length(&mut self, length: usize) {
        let Some(mut rest) = length.checked_sub(15) else { return };
        while rest >= 255 {
            self.out.push(255);
            rest -= 255;
        }
        self.out.push(rest as u8);
    }

    /// Appends the literals at the end of the block.
    fn finish(mut self, end: usize) {
        self.sequence(end, 0);
    }
}

#[cfg(test)]
mod tests {
    use lz4_flex::block::decompress;
    use proptest::prelude::*;

    use super::*;

    fn round_trip(data: &[u8], block: Range<usize>, starts: &[MessageStart]) -> usize {
        let mut packed = Vec::new();
        put_block(data, block.clone(), starts, &mut packed);
        let unpacked = decompress(&packed, block.len()).unwrap();
        assert!(unpacked == data[block]);
        packed.len()
    }

    proptest! {
        /// Messages with few different bytes, of any length, one after the other.
        #[test]
        fn any_messages_are_unpacked_again(
            messages in prop::collection::vec(
                (0..3_usize, prop::collection::vec(0..3_u8, 0..200)), 1..40),
            skipped in 0..100_usize,
        ) {
            let (mut data, mut starts, mut last) = (Vec::new(), Vec::new(), [None; 3]);
            for (topic, bytes) in messages {
                let at = data.len();
                starts.push(MessageStart { at, previous: last[topic].replace(at) });
                data.extend(bytes);
            }
            round_trip(&data, 0..data.len(), &starts);
            let first = skipped.min(data.len());
            let within: Vec<_> = starts.into_iter().filter(|start| start.at >= first).collect();
            round_trip(&data, first..data.len(), &within);
        }
    }

    /// Long literals and long repeated parts have lengths of several bytes.
    #[test]
    fn long_parts_are_unpacked_again() {
        for length in [14, 15, 16, 269, 270, 271, 525, 20_000, 65_535, 65_536] {
            let mut random = fastrand::Rng::with_seed(length);
            let message: Vec<u8> = (0..length).map(|_| random.u8(..)).collect();
            let data = [&message[..], &message, &message[..message.len() / 2], b"the end"].concat();
            let at = message.len();
            let starts = [(0, None), (at, Some(0)), (2 * at, Some(at))]
                .map(|(at, previous)| MessageStart { at, previous });
            let packed = round_trip(&data, 0..data.len(), &starts);
            let found = (16..=65_535).contains(&length);
            assert_eq!(packed < at + at / 60 + 40, found || length < 16, "{length}: {packed}");
        }
    }
}
