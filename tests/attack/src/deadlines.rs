//! Scaling of deadlines on a machine with other load.

use std::{sync::OnceLock, time::Duration};

static FACTOR: OnceLock<u32> = OnceLock::new();

/// Multiplies all deadlines.
pub(super) fn set_factor(factor: u32) {
    let _ = FACTOR.set(factor);
}

/// Returns the scaled deadline.
pub(super) fn scaled(time: Duration) -> Duration {
    time * FACTOR.get().copied().unwrap_or(1)
}
