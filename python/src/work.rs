//! Work without the interpreter's lock, which Ctrl-C ends.

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

/// How often signals are looked at: Ctrl-C is to end the work within a tenth of a second.
const TICK: Duration = Duration::from_millis(20);

type Task = Box<dyn FnOnce() + Send>;

/// Threads that wait for work, and the process that started them.
///
/// They are kept, since the memory of a new thread is cold: planning ten motions on one takes a twelfth longer. Only who holds
/// the interpreter's lock may lock this: a process that Python forks then never inherits it locked.
static WORKERS: Mutex<Workers> = Mutex::new(Workers { process: 0, idle: Vec::new() });

struct Workers {
    process: u32,
    idle: Vec<Sender<Task>>,
}

impl Workers {
    fn lock(_: Python<'_>) -> MutexGuard<'static, Self> {
        let mut workers = WORKERS.lock().unwrap_or_else(PoisonError::into_inner);
        let process = process::id();
        if mem::replace(&mut workers.process, process) != process {
            // Threads are not there any more in a process that was forked. Their channels may be locked for ever.
            mem::forget(mem::take(&mut workers.idle));
        }
        workers
    }

    /// Keeps a worker that has nothing to do, if it may be wanted again.
    fn keep(py: Python<'_>, worker: Sender<Task>) {
        let most = thread::available_parallelism().map_or(1, usize::from);
        let mut workers = Self::lock(py);
        if workers.idle.len() < most {
            workers.idle.push(worker);
        }
    }
}

fn idle_worker(py: Python<'_>) -> PyResult<Sender<Task>> {
    if let Some(worker) = Workers::lock(py).idle.pop() {
        return Ok(worker);
    }
    let (give, tasks) = mpsc::channel::<Task>();
    thread::Builder::new()
        .name("iiwasim".to_owned())
        .spawn(move || tasks.into_iter().for_each(|task| task()))
        .map_err(|error| PyRuntimeError::new_err(format!("cannot start a thread: {error}")))?;
    Ok(give)
}

/// Does `work` on another thread. The interpreter is free meanwhile; between ticks it is asked for signals, and `tick` is
/// called. Either may fail: then the flag that the work is given is set, its end is waited for, and the error is raised.
pub(crate) fn interruptible<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce(Arc<AtomicBool>) -> T + Send + 'static,
    mut tick: impl FnMut(Python<'_>) -> PyResult<()>,
) -> PyResult<T> {
    let stop = Arc::new(AtomicBool::new(false));
    let (send, receive) = mpsc::sync_channel(1);
    let flag = Arc::clone(&stop);
    let task = move || {
        // Whoever waits is told of a panic, too.
        let _ = send.send(catch_unwind(AssertUnwindSafe(|| work(flag))));
    };
    let worker = idle_worker(py)?;
    let ended = || PyRuntimeError::new_err("a thread ended without a result");
    worker.send(Box::new(task)).map_err(|_| ended())?;
    // Without the lock of the interpreter, threads are what they are elsewhere: receivers are for one at a time.
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
