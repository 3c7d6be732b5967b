//! How much longer everything may take on a machine that others use, too.

use std::{sync::OnceLock, time::Duration};

static FACTOR: OnceLock<u32> = OnceLock::new();

/// Sets the factor, once.
pub(super) fn set(factor: u32) {
    let _ = FACTOR.set(factor);
}

/// What is allowed for something that takes so long at most on a machine that is not shared.
pub(super) fn within(time: Duration) -> Duration {
    time * FACTOR.get().copied().unwrap_or(1)
}
