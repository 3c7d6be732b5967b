//! Sequence counters, which wrap around.

/// Returns the lead of a 32-bit sequence counter over an earlier value; negative if it is behind.
///
/// Valid if the two values are less than half of the counter's range apart.
///
/// ```
/// use iiwa_fri::ahead;
///
/// assert_eq!(ahead(12, 10), 2);
/// assert_eq!(ahead(10, 12), -2);
/// assert_eq!(ahead(1, u32::MAX), 2);
/// ```
#[must_use]
pub fn ahead(counter: u32, of: u32) -> i32 {
    counter.wrapping_sub(of).cast_signed()
}
