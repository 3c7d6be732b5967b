//! Threads that end together; real-time priority, with the feature `real-time`.

#[cfg(feature = "real-time")]
mod priority;

use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread::{self, JoinHandle},
};

#[cfg(feature = "real-time")]
pub use priority::raise_priority;

use crate::LinkError;

/// Threads of a drive or a cabinet. Dropping the group signals them to shut down and waits for
/// them.
///
/// ```
/// use std::sync::{atomic::Ordering, mpsc};
///
/// use iiwa_link::threads::ThreadGroup;
///
/// let (sender, receiver) = mpsc::channel();
/// let mut threads = ThreadGroup::default();
/// threads.spawn("clock", move |shutdown| {
///     while !shutdown.load(Ordering::Relaxed) {
///         std::thread::yield_now();
///     }
///     sender.send("over").unwrap();
/// })?;
/// drop(threads);
/// assert_eq!(receiver.try_recv(), Ok("over"));
/// # Ok::<(), iiwa_link::LinkError>(())
/// ```
#[derive(Debug, Default)]
pub struct ThreadGroup {
    shutdown: Arc<AtomicBool>,
    threads: Vec<JoinHandle<()>>,
}

impl ThreadGroup {
    /// Starts a thread. Its work has to end soon after the flag that it receives becomes true.
    ///
    /// # Errors
    ///
    /// [`LinkError::Thread`] if the system does not start the thread.
    pub fn spawn(
        &mut self,
        name: &str,
        work: impl FnOnce(&AtomicBool) + Send + 'static,
    ) -> Result<(), LinkError> {
        let shutdown = Arc::clone(&self.shutdown);
        let thread = thread::Builder::new().name(name.to_owned()).spawn(move || work(&shutdown));
        self.threads.push(thread.map_err(|source| LinkError::Thread { source })?);
        Ok(())
    }
}

impl Drop for ThreadGroup {
    fn drop(&mut self) {
        // Relaxed: the flag does not guard other data, and `join` synchronises.
        self.shutdown.store(true, Ordering::Relaxed);
        for thread in self.threads.drain(..) {
            // A thread that has panicked has also ended.
            let _ = thread.join();
        }
    }
}
