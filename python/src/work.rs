//! Work without the interpreter's lock, which Ctrl-C ends.

use std::{
    panic::{AssertUnwindSafe, catch_unwind, resume_unwind},
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicBool, Ordering},
        mpsc::{self, RecvTimeoutError},
    },
    thread,
    time::Duration,
};

use pyo3::{exceptions::PyRuntimeError, prelude::*};

/// How often signals are looked at: Ctrl-C is to end the work within a tenth of a second.
const TICK: Duration = Duration::from_millis(20);

/// Does `work` on a thread of its own. The interpreter is free meanwhile; between ticks it is asked for signals, and `tick` is
/// called. Either may fail: then the flag that the work is given is set, its end is waited for, and the error is raised.
///
/// A thread for each call, and no pool that remains: threads of a pool are not there any more in a process that was forked.
pub(crate) fn interruptible<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce(Arc<AtomicBool>) -> T + Send + 'static,
    mut tick: impl FnMut(Python<'_>) -> PyResult<()>,
) -> PyResult<T> {
    let stop = Arc::new(AtomicBool::new(false));
    let (send, receive) = mpsc::sync_channel(1);
    let flag = Arc::clone(&stop);
    let worker = move || {
        // Whoever waits is told of a panic, too.
        let _ = send.send(catch_unwind(AssertUnwindSafe(|| work(flag))));
    };
    thread::Builder::new()
        .spawn(worker)
        .map_err(|error| PyRuntimeError::new_err(format!("cannot start a thread: {error}")))?;
    // Without the lock of the interpreter, threads are what they are elsewhere: receivers are for one at a time.
    let receive = Mutex::new(receive);
    loop {
        match py
            .detach(|| receive.lock().unwrap_or_else(PoisonError::into_inner).recv_timeout(TICK))
        {
            Ok(Ok(result)) => return Ok(result),
            Ok(Err(panic)) => resume_unwind(panic),
            Err(RecvTimeoutError::Disconnected) => {
                return Err(PyRuntimeError::new_err("a thread ended without a result"));
            }
            Err(RecvTimeoutError::Timeout) => {
                if let Err(error) = py.check_signals().and_then(|()| tick(py)) {
                    stop.store(true, Ordering::Relaxed);
                    let _ =
                        py.detach(|| receive.lock().unwrap_or_else(PoisonError::into_inner).recv());
                    return Err(error);
                }
            }
        }
    }
}
