//! State shared by the threads of the cabinet.

use std::{
    sync::{Mutex, MutexGuard, PoisonError},
    time::Duration,
};

use crate::{faulty_link::FaultyLink, simulation::Simulation};

/// State shared by the threads.
pub(crate) struct CabinetState {
    pub(crate) simulation: Mutex<Simulation>,
    pub(crate) link: Mutex<FaultyLink>,
}

impl std::fmt::Debug for CabinetState {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Shared").finish_non_exhaustive()
    }
}

/// Interval at which waiting threads check for shutdown.
pub(crate) const POLL_INTERVAL: Duration = Duration::from_millis(50);

/// Locks a mutex.
pub(crate) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    // A panic does not leave the state inconsistent.
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
