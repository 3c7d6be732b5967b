//! Measured cases.

/// Row of the table.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Case {
    pub(crate) period_ms: u32,
    pub(crate) seconds: u64,
    /// Nine subscribers that follow the stream, and one that sleeps.
    pub(crate) subscribers: bool,
    /// `true` if the drive must not have real-time priority.
    pub(crate) ordinary: bool,
}

/// Returns a case without subscribers, whose drive may have real-time priority.
pub(crate) const fn case(period_ms: u32, seconds: u64) -> Case {
    Case { period_ms, seconds, subscribers: false, ordinary: false }
}
