//! Sequence counters, which wrap around.

/// How far a 32-bit sequence counter is ahead of an earlier value; negative when it is behind.
///
/// Valid as long as the two are less than half the range of the counter apart.
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
