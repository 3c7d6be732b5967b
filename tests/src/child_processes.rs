//! Starts of child processes. A child has copies of all sockets of this process until it runs its own program: what a
//! thread closes meanwhile stays open, and its port in use.

use std::{
    io,
    process::{Child, Command},
    sync::{Mutex, PoisonError},
};

static START: Mutex<()> = Mutex::new(());

/// Starts a child process; it runs its own program when this returns.
///
/// # Errors
///
/// It cannot be started.
pub fn start(command: &mut Command) -> io::Result<Child> {
    let _start = START.lock().unwrap_or_else(PoisonError::into_inner);
    command.spawn()
}

/// Waits until no child has a copy of a socket that was closed before: its port can be bound again, if all children
/// are started by [`start`].
pub fn await_all() {
    drop(START.lock().unwrap_or_else(PoisonError::into_inner));
}
