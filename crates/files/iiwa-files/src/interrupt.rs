//! Interrupt flag of the process.
//!
//! This module installs no signal handler: the program does, and sets the flag.

use std::sync::{
    Arc, OnceLock,
    atomic::{AtomicBool, Ordering},
};

static INTERRUPTED: OnceLock<Arc<AtomicBool>> = OnceLock::new();

/// Returns the flag that an interrupt sets, for code that polls it directly.
pub fn flag() -> Arc<AtomicBool> {
    Arc::clone(INTERRUPTED.get_or_init(Arc::default))
}

/// Returns true after an interrupt.
#[must_use]
pub fn has_come() -> bool {
    INTERRUPTED.get().is_some_and(|flag| flag.load(Ordering::Relaxed))
}

/// Sets the flag, like an interrupt.
pub fn request() {
    flag().store(true, Ordering::Relaxed);
}
