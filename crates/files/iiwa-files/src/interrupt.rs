//! Whether the process was asked to end.
//!
//! Nothing here installs a handler: the program does, and sets the flag.

use std::sync::{
    Arc, OnceLock,
    atomic::{AtomicBool, Ordering},
};

static INTERRUPTED: OnceLock<Arc<AtomicBool>> = OnceLock::new();

/// What an interrupt sets, for those who look at it by themselves.
pub fn flag() -> Arc<AtomicBool> {
    Arc::clone(INTERRUPTED.get_or_init(Arc::default))
}

/// Whether an interrupt has come.
#[must_use]
pub fn has_come() -> bool {
    INTERRUPTED.get().is_some_and(|flag| flag.load(Ordering::Relaxed))
}

/// Acts as an interrupt.
pub fn request() {
    flag().store(true, Ordering::Relaxed);
}
