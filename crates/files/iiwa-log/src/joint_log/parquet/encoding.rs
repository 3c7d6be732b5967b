//! Encodings of values within a page.
//!
//! Decoders produce one value at a time. They keep positions, not the bytes of the page, and return
//! `None` where the bytes end.

use super::thrift::{unzigzag, varint};

/// Decoder of small integers in runs: repeated values, and groups of eight packed values.
#[derive(Clone, Debug)]
pub(super) struct Runs {
    /// Next byte, and end.
    at: usize,
    end: usize,
    /// Number of bits of a value.
    width: u32,
    run: EncodedRun,
}

#[derive(Clone, Debug)]
enum EncodedRun {
    Repeated { value: u32, left: u64 },
    Packed { bit: usize, left: u64 },
}

impl Runs {
    /// Creates a decoder of the bytes from `at` to `end`; `width` is at most 32.
    pub(super) fn new(at: usize, end: usize, width: u32) -> Self {
        Self { at, end, width, run: EncodedRun::Repeated { value: 0, left: 0 } }
    }

    pub(super) fn next(&mut self, page: &[u8]) -> Option<u32> {
        let bytes = page.get(..self.end)?;
        loop {
            match &mut self.run {
                EncodedRun::Repeated { value, left: left @ 1.. } => {
                    *left -= 1;
                    return Some(*value);
                }
                EncodedRun::Packed { bit, left: left @ 1.. } => {
                    let value = bits(bytes, *bit, self.width)?;
                    *bit += self.width as usize;
                    *left -= 1;
                    return u32::try_from(value).ok();
                }
                _ => self.begin_run(bytes)?,
            }
        }
    }

    fn begin_run(&mut self, bytes: &[u8]) -> Option<()> {
        let (head, length) = varint(bytes.get(self.at..)?)?;
        self.at += length;
        let count = head >> 1;
        if head & 1 == 1 {
            self.run =
                EncodedRun::Packed { bit: self.at.checked_mul(8)?, left: count.checked_mul(8)? };
            let length = usize::try_from(count).ok()?.checked_mul(self.width as usize)?;
            self.at = self.at.checked_add(length)?;
        } else {
            let length = self.width.div_ceil(8) as usize;
            let value = bytes.get(self.at..self.at.checked_add(length)?)?;
            let value = value.iter().rev().fold(0, |value, byte| (value << 8) | u32::from(*byte));
            self.run = EncodedRun::Repeated { value, left: count };
            self.at += length;
        }
        Some(())
    }
}

/// Returns `width` bits, at most 64, from a bit on; the lowest bit of a byte is first.
fn bits(bytes: &[u8], bit: usize, width: u32) -> Option<u64> {
    let (start, skipped) = (bit / 8, bit % 8);
    let end = (bit.checked_add(width as usize)?).div_ceil(8);
    let bytes = bytes.get(start..end.max(start))?;
    let packed = bytes.iter().rev().fold(0_u128, |value, byte| (value << 8) | u128::from(*byte));
    let mask = (1_u128 << width) - 1;
    u64::try_from((packed >> skipped) & mask).ok()
}

/// Decoder of integers by their differences, in blocks of packed values
/// (`DELTA_BINARY_PACKED`).
#[derive(Clone, Debug)]
pub(super) struct Differences {
    at: usize,
    /// Number of values of a block, and of each of its parts.
    block: u64,
    part: u64,
    /// Values that follow, in the page, in the block and in its part.
    left: u64,
    left_in_block: u64,
    left_in_part: u64,
    value: i64,
    min_difference: i64,
    /// Place of the width of the next part.
    width_at: usize,
    width: u32,
    bit: usize,
    is_first: bool,
}

/// Largest number of values of a block; usual are 128 or 256.
const MAX_BLOCK: u64 = 1 << 16;

impl Differences {
    pub(super) fn new(page: &[u8], mut at: usize) -> Option<Self> {
        let block = next_varint(page, &mut at)?;
        let parts = next_varint(page, &mut at)?;
        let left = next_varint(page, &mut at)?;
        let value = unzigzag(next_varint(page, &mut at)?);
        let is_valid = (1..=MAX_BLOCK).contains(&block) && parts > 0 && block % parts == 0;
        // Parts are whole bytes.
        (is_valid && (block / parts) % 8 == 0).then_some(Self {
            at,
            block,
            part: block / parts,
            left,
            left_in_block: 0,
            left_in_part: 0,
            value,
            min_difference: 0,
            width_at: 0,
            width: 0,
            bit: 0,
            is_first: true,
        })
    }

    pub(super) fn next(&mut self, page: &[u8]) -> Option<i64> {
        self.left = self.left.checked_sub(1)?;
        if std::mem::take(&mut self.is_first) {
            return Some(self.value);
        }
        if self.left_in_block == 0 {
            self.min_difference = unzigzag(next_varint(page, &mut self.at)?);
            self.width_at = self.at;
            let parts = usize::try_from(self.block / self.part).ok()?;
            self.at = self.at.checked_add(parts)?;
            self.left_in_block = self.block;
            self.left_in_part = 0;
        }
        if self.left_in_part == 0 {
            self.width = u32::from(*page.get(self.width_at)?);
            if self.width > 64 {
                return None;
            }
            self.width_at += 1;
            self.bit = self.at.checked_mul(8)?;
            let length = usize::try_from(self.part / 8).ok()? * self.width as usize;
            self.at = self.at.checked_add(length)?;
            self.left_in_part = self.part;
        }
        let difference = bits(page, self.bit, self.width)?;
        self.bit += self.width as usize;
        self.left_in_part -= 1;
        self.left_in_block -= 1;
        let difference = self.min_difference.wrapping_add(difference.cast_signed());
        self.value = self.value.wrapping_add(difference);
        Some(self.value)
    }
}

fn next_varint(page: &[u8], at: &mut usize) -> Option<u64> {
    let (value, length) = varint(page.get(*at..)?)?;
    *at += length;
    Some(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_repeat_and_pack() {
        // Three times 5; then 0 to 7 in three bits each, as in the specification.
        let page = [0x06, 0x05, 0x03, 0x88, 0xc6, 0xfa];
        let mut runs = Runs::new(0, page.len(), 3);
        let values: Vec<_> = std::iter::from_fn(|| runs.next(&page)).collect();
        assert_eq!(values, [5, 5, 5, 0, 1, 2, 3, 4, 5, 6, 7]);
    }

    #[test]
    fn differences_follow_the_specification() {
        // Block of 128 values in 4 parts; 7, 5, 3, 1, 2, 3, 4, 5: differences -2 -2 -2 1 1 1 1.
        let mut page = vec![0x80, 0x01, 0x04, 0x08, 0x0e, 0x03, 2, 0, 0, 0, 0xc0, 0x3f];
        page.resize(24, 0);
        let mut differences = Differences::new(&page, 0).unwrap();
        let values: Vec<_> = std::iter::from_fn(|| differences.next(&page)).collect();
        assert_eq!(values, [7, 5, 3, 1, 2, 3, 4, 5]);
    }

    #[test]
    fn bits_end_with_the_bytes() {
        assert_eq!(bits(&[0xff; 9], 4, 64), Some(u64::MAX));
        assert_eq!(bits(&[0xff; 8], 4, 64), None);
        assert_eq!(bits(&[], 0, 0), Some(0));
    }
}
