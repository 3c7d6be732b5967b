//! State that the threads of the cabinet share.

use std::{
    sync::{
        Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    time::Duration,
};

use super::{faulty_link::FaultyLink, simulation::Simulation};

/// The state that the threads share.
pub(super) struct Shared {
    pub(super) simulation: Mutex<Simulation>,
    pub(super) link: Mutex<FaultyLink>,
    pub(super) shutdown: AtomicBool,
}

impl std::fmt::Debug for Shared {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Shared").field("shutdown", &self.shutdown).finish_non_exhaustive()
    }
}

impl Shared {
    pub(super) fn is_shut_down(&self) -> bool {
        self.shutdown.load(Ordering::Relaxed)
    }
}

/// How often waiting threads check for shutdown.
pub(super) const POLL_INTERVAL: Duration = Duration::from_millis(50);

/// Locks a mutex.
pub(super) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    // A panic does not leave the state inconsistent.
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
