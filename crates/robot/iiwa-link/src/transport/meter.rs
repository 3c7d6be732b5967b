//! Announced length of an incoming message.
//!
//! ZMTP frames (RFC 23) begin with flags and a length, unencrypted even with CURVE.

/// Bits of the frame flags.
const MORE: u8 = 0x01;
const LONG: u8 = 0x02;
const COMMAND: u8 = 0x04;

/// Overhead of a frame in memory, in bytes.
const FRAME_BYTES: u64 = 64;

/// Parses the frame headers of a byte stream.
#[derive(Debug, Default)]
pub(super) struct Meter {
    header: Vec<u8>,
    /// Missing bytes of the current frame.
    missing: u64,
    /// Bytes of all frames announced so far.
    announced: u64,
    /// Number of complete frames.
    frames: u64,
}

impl Meter {
    /// Parses the next bytes of the stream.
    pub(super) fn read(&mut self, mut bytes: &[u8]) {
        while !bytes.is_empty() {
            if self.missing > 0 {
                let count =
                    usize::try_from(self.missing).map_or(bytes.len(), |l| l.min(bytes.len()));
                self.missing -= count as u64;
                bytes = &bytes[count..];
            } else if let [byte, rest @ ..] = bytes {
                self.header.push(*byte);
                bytes = rest;
                self.begin_frame();
            }
            // Also for a frame of length zero.
            if self.missing == 0 && self.frame_has_begun() {
                self.end_frame();
            }
        }
    }

    /// Minimum length of the incoming message, in bytes; 0 between messages.
    pub(super) fn announced(&self) -> u64 {
        self.announced
    }

    /// Number of complete frames.
    pub(super) fn frames(&self) -> u64 {
        self.frames
    }

    fn frame_has_begun(&self) -> bool {
        self.header
            .first()
            .is_some_and(|flags| self.header.len() == if flags & LONG == 0 { 2 } else { 9 })
    }

    fn begin_frame(&mut self) {
        if self.frame_has_begun() {
            let length = self.header[1..].iter().fold(0, |sum, byte| sum << 8 | u64::from(*byte));
            self.missing = length;
            // Saturating, because the peer may announce any length.
            self.announced = self.announced.saturating_add(length).saturating_add(FRAME_BYTES);
        }
    }

    fn end_frame(&mut self) {
        self.frames += 1;
        // The last frame of a message, or a command, which always has one frame.
        if self.header[0] & (MORE | COMMAND) != MORE {
            self.announced = 0;
        }
        self.header.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_is_announced_by_its_frames() {
        let mut meter = Meter::default();
        let mut after = |bytes: &[u8]| {
            meter.read(bytes);
            meter.announced()
        };
        // An empty frame and a frame of 3 bytes.
        assert_eq!(after(&[MORE]), 0);
        assert_eq!(after(&[0]), 64);
        assert_eq!(after(&[0, 3, b'a']), 64 + 67);
        assert_eq!(after(b"b"), 64 + 67);
        assert_eq!(after(b"c"), 0);
        // The header announces a long frame, and also a command.
        assert_eq!(after(&[LONG, 0, 0, 0, 0, 4, 0, 0, 0]), (4 << 24) + 64);
        assert_eq!(after(&vec![0; (4 << 24) - 1]), (4 << 24) + 64);
        assert_eq!(after(&[0, COMMAND, 200]), 264);
        assert_eq!(after(&[0; 200]), 0);
        assert_eq!(after(&[0, 0, MORE, 0, MORE, 0]), 128);
        assert_eq!(after(&[LONG | COMMAND, 255, 255, 255, 255, 255, 255, 255, 255]), u64::MAX);
    }

    #[test]
    fn fragmentation_does_not_matter() {
        let mut stream = Vec::new();
        for length in [0_u8, 1, 7, 255] {
            stream.extend([MORE, length]);
            stream.extend(vec![LONG; length.into()]);
        }
        for size in 1..20 {
            let mut meter = Meter::default();
            stream.chunks(size).for_each(|chunk| meter.read(chunk));
            assert_eq!(meter.announced(), 4 * 64 + 263, "{size}");
            assert_eq!(meter.frames(), 4, "{size}");
        }
    }
}
