//! Execution of work without the interpreter lock, which Ctrl-C interrupts.

use std::{
    mem,
    panic::{AssertUnwindSafe, catch_unwind, resume_unwind},
    process,
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, Ordering},
        mpsc::{self, RecvTimeoutError, Sender},
    },
    thread,
    time::Duration,
};

use pyo3::{exceptions::PyRuntimeError, prelude::*};

/// Interval of signal checks: Ctrl-C has to end the work within 0.1 s.
const TICK: Duration = Duration::from_millis(20);

type Work = Box<dyn FnOnce() + Send>;

/// Threads that wait for work, and the process that started them.
///
/// The threads are kept, because the memory of a new thread is cold: planning ten motions on it
/// takes a twelfth longer. Only holders of the interpreter lock may lock this mutex, so that a
/// process that Python forks never inherits it locked.
static WORKERS: Mutex<Workers> = Mutex::new(Workers { process: 0, idle: Vec::new() });

struct Workers {
    process: u32,
    idle: Vec<Sender<Work>>,
}

impl Workers {
    fn lock(_: Python<'_>) -> MutexGuard<'static, Self> {
        let mut workers = WORKERS.lock().unwrap_or_else(PoisonError::into_inner);
        let process = process::id();
        if mem::replace(&mut workers.process, process) != process {
            // A forked process does not have these threads, and their channels may be locked for
            // ever.
            mem::forget(mem::take(&mut workers.idle));
        }
        workers
    }

    /// Keeps an idle worker for later work.
    fn keep(py: Python<'_>, worker: Sender<Work>) {
        let processors = thread::available_parallelism().map_or(1, usize::from);
        let mut workers = Self::lock(py);
        if workers.idle.len() < processors {
            workers.idle.push(worker);
        }
    }
}

fn idle_worker(py: Python<'_>) -> PyResult<Sender<Work>> {
    if let Some(worker) = Workers::lock(py).idle.pop() {
        return Ok(worker);
    }
    let (give, tasks) = mpsc::channel::<Work>();
    thread::Builder::new()
        .name("iiwasim".to_owned())
        .spawn(move || tasks.into_iter().for_each(|task| task()))
        .map_err(|error| PyRuntimeError::new_err(format!("cannot start a thread: {error}")))?;
    Ok(give)
}

/// Runs `work` on another thread and releases the interpreter meanwhile. Each tick checks for
/// signals and calls `tick`. If either fails, the flag that `work` receives is set, and the error
/// is raised once the work has ended.
pub(crate) fn interruptible<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce(Arc<AtomicBool>) -> T + Send + 'static,
    mut tick: impl FnMut(Python<'_>) -> PyResult<()>,
) -> PyResult<T> {
    let stop = Arc::new(AtomicBool::new(false));
    let (send, receive) = mpsc::sync_channel(1);
    let flag = Arc::clone(&stop);
    let task = move || {
        // A panic is passed on to the waiting thread.
        let _ = send.send(catch_unwind(AssertUnwindSafe(|| work(flag))));
    };
    let worker = idle_worker(py)?;
    let ended = || PyRuntimeError::new_err("a thread ended without a result");
    worker.send(Box::new(task)).map_err(|_| ended())?;
    // `detach` requires `Sync` of shared values, and a receiver alone is not `Sync`.
    let receive = Mutex::new(receive);
    let result = loop {
        match py
            .detach(|| receive.lock().unwrap_or_else(PoisonError::into_inner).recv_timeout(TICK))
        {
            Ok(result) => break Ok(result),
            Err(RecvTimeoutError::Disconnected) => return Err(ended()),
            Err(RecvTimeoutError::Timeout) => {
                if let Err(error) = py.check_signals().and_then(|()| tick(py)) {
                    stop.store(true, Ordering::Relaxed);
                    let _ =
                        py.detach(|| receive.lock().unwrap_or_else(PoisonError::into_inner).recv());
                    break Err(error);
                }
            }
        }
    };
    Workers::keep(py, worker);
    result?.or_else(|panic| resume_unwind(panic))
}
