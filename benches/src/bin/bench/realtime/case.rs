//! What is measured.

/// A row of the table.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Case {
    pub(crate) period_ms: u32,
    pub(crate) seconds: u64,
    /// Nine that follow the stream, and one that sleeps.
    pub(crate) subscribers: bool,
    /// The drive may not have real-time priority.
    pub(crate) ordinary: bool,
}

/// A case without subscribers, whose drive may have real-time priority.
pub(crate) const fn case(period_ms: u32, seconds: u64) -> Case {
    Case { period_ms, seconds, subscribers: false, ordinary: false }
}
