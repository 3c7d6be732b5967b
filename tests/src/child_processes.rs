//! Start of child processes. A child inherits all sockets of this process until it executes its own
//! program: sockets closed by other threads meanwhile remain open, and their ports in use.

use std::{
    io,
    process::{Child, Command},
    sync::{Mutex, PoisonError},
};

static START: Mutex<()> = Mutex::new(());

/// Starts a child process, which executes its own program when this function returns.
///
/// # Errors
///
/// An error if the process cannot be started.
pub fn start(command: &mut Command) -> io::Result<Child> {
    let _start = START.lock().unwrap_or_else(PoisonError::into_inner);
    command.spawn()
}

/// Waits until children no longer hold copies of sockets closed before, so that their ports can be
/// bound again, provided all children are started by [`start`].
pub fn await_all() {
    drop(START.lock().unwrap_or_else(PoisonError::into_inner));
}
