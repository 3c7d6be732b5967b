//! Processes of the program under attack. All end with the harness, however it ends.

use std::{
    ffi::OsStr,
    fs,
    io::{self, BufRead, BufReader, Read},
    path::Path,
    process::{Child, Command, Stdio},
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicU64, Ordering},
        mpsc::{self, Receiver},
    },
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

/// Ids of running processes.
static RUNNING: Mutex<Vec<u32>> = Mutex::new(Vec::new());

/// Stored part of standard error, in bytes.
const MAX_STORED: usize = 2000;

/// Process that is killed when this value is dropped.
pub(super) struct Process {
    child: Child,
    /// Lines of standard output.
    pub(super) lines: Receiver<String>,
    stderr: Arc<StandardError>,
    reader: Option<JoinHandle<()>>,
}

#[derive(Default)]
struct StandardError {
    bytes: AtomicU64,
    start: Mutex<Vec<u8>>,
}

/// End of a process.
pub(super) struct Ended {
    pub(super) instant: Instant,
    /// `true` for exit code 0.
    pub(super) success: bool,
}

impl Process {
    /// Starts the program, with a limit of open files.
    pub(super) fn start<S: AsRef<OsStr>>(
        binary: &Path,
        arguments: &[S],
        files: Option<u32>,
    ) -> io::Result<Self> {
        let mut command = match files {
            None => Command::new(binary),
            Some(files) => {
                let mut shell = Command::new("sh");
                shell.arg("-c").arg(format!("ulimit -Sn {files}; exec \"$0\" \"$@\"")).arg(binary);
                shell
            }
        };
        command.args(arguments).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn()?;
        list().push(child.id());
        let (sender, lines) = mpsc::channel();
        if let Some(stdout) = child.stdout.take() {
            thread::spawn(move || {
                for line in BufReader::new(stdout).lines().map_while(Result::ok) {
                    // The receiver may be dropped.
                    let _ = sender.send(line);
                }
            });
        }
        let stderr = Arc::new(StandardError::default());
        let reader = child.stderr.take().map(|mut pipe| {
            let stderr = Arc::clone(&stderr);
            thread::spawn(move || {
                let mut buffer = vec![0; 1 << 16];
                while let Ok(count @ 1..) = pipe.read(&mut buffer) {
                    stderr.bytes.fetch_add(count as u64, Ordering::Relaxed);
                    let mut start = stderr.start.lock().unwrap_or_else(PoisonError::into_inner);
                    let room = MAX_STORED.saturating_sub(start.len()).min(count);
                    start.extend(&buffer[..room]);
                }
            })
        });
        Ok(Self { child, lines, stderr, reader })
    }

    /// Sends a signal, such as `INT` or `KILL`.
    pub(super) fn signal(&self, name: &str) {
        send(name, self.child.id());
    }

    /// Kills the process at once.
    pub(super) fn kill(&mut self) {
        let _ = self.child.kill();
    }

    /// Waits for the end of the process; `None` on time-out.
    pub(super) fn wait(&mut self, timeout: Duration) -> Option<Ended> {
        let since = Instant::now();
        loop {
            if let Ok(Some(status)) = self.child.try_wait() {
                let end = Instant::now();
                // Read standard error to its end.
                if let Some(reader) = self.reader.take() {
                    let _ = reader.join();
                }
                return Some(Ended { instant: end, success: status.success() });
            }
            if since.elapsed() > timeout {
                return None;
            }
            thread::sleep(Duration::from_millis(1));
        }
    }

    /// Returns true if the process still runs.
    pub(super) fn runs(&mut self) -> bool {
        matches!(self.child.try_wait(), Ok(None))
    }

    /// Number of bytes written to standard error.
    pub(super) fn stderr_bytes(&self) -> u64 {
        self.stderr.bytes.load(Ordering::Relaxed)
    }

    /// Returns the beginning of standard error.
    pub(super) fn stderr(&self) -> String {
        let start = self.stderr.start.lock().unwrap_or_else(PoisonError::into_inner);
        String::from_utf8_lossy(&start).into_owned()
    }

    /// Returns the peak memory since the last call, in MB, if the system provides it.
    pub(super) fn take_peak_memory_mb(&self) -> Option<f64> {
        let id = self.child.id();
        let status = fs::read_to_string(format!("/proc/{id}/status")).ok()?;
        let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
        let kib: f64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
        // Resets the peak; if not permitted, it is that of the whole lifetime.
        let _ = fs::write(format!("/proc/{id}/clear_refs"), "5");
        Some(kib * 1.024e-3)
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        let id = self.child.id();
        self.kill();
        let _ = self.child.wait();
        list().retain(|running| *running != id);
    }
}

fn list() -> std::sync::MutexGuard<'static, Vec<u32>> {
    RUNNING.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Kills all processes, before the harness is aborted.
pub(super) fn kill_all() {
    for id in list().iter() {
        send("KILL", *id);
    }
}

fn send(signal: &str, id: u32) {
    let _ = Command::new("sh").arg("-c").arg(format!("kill -{signal} {id}")).status();
}
