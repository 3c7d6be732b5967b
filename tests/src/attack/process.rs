//! Processes of the program under attack. None outlives the harness, however that ends.

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

/// Those that run, by their ids.
static RUNNING: Mutex<Vec<u32>> = Mutex::new(Vec::new());

/// What is kept of what a process says on standard error, in bytes.
const KEPT: usize = 2000;

/// A process, which is killed when this is dropped.
pub(super) struct Process {
    child: Child,
    /// What it prints, line by line.
    pub(super) lines: Receiver<String>,
    said: Arc<Said>,
    hears: Option<JoinHandle<()>>,
}

#[derive(Default)]
struct Said {
    bytes: AtomicU64,
    start: Mutex<Vec<u8>>,
}

/// How a process has ended.
pub(super) struct Ended {
    pub(super) at: Instant,
    /// It ended with exit code 0.
    pub(super) well: bool,
}

impl Process {
    /// Starts the program with at most so many open files.
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
                    // The lines may not be of interest.
                    let _ = sender.send(line);
                }
            });
        }
        let said = Arc::new(Said::default());
        let hears = child.stderr.take().map(|mut stderr| {
            let said = Arc::clone(&said);
            thread::spawn(move || {
                let mut buffer = vec![0; 1 << 16];
                while let Ok(count @ 1..) = stderr.read(&mut buffer) {
                    said.bytes.fetch_add(count as u64, Ordering::Relaxed);
                    let mut start = said.start.lock().unwrap_or_else(PoisonError::into_inner);
                    let room = KEPT.saturating_sub(start.len()).min(count);
                    start.extend(&buffer[..room]);
                }
            })
        });
        Ok(Self { child, lines, said, hears })
    }

    /// Sends a signal, as `INT` or `KILL`.
    pub(super) fn signal(&self, name: &str) {
        send(name, self.child.id());
    }

    /// Kills it at once.
    pub(super) fn kill(&mut self) {
        let _ = self.child.kill();
    }

    /// How it has ended; none if it has not within so long.
    pub(super) fn wait(&mut self, patience: Duration) -> Option<Ended> {
        let since = Instant::now();
        loop {
            if let Ok(Some(status)) = self.child.try_wait() {
                let at = Instant::now();
                // Its last words are heard.
                if let Some(hears) = self.hears.take() {
                    let _ = hears.join();
                }
                return Some(Ended { at, well: status.success() });
            }
            if since.elapsed() > patience {
                return None;
            }
            thread::sleep(Duration::from_millis(1));
        }
    }

    /// Whether it still runs.
    pub(super) fn runs(&mut self) -> bool {
        matches!(self.child.try_wait(), Ok(None))
    }

    /// How many bytes it has written to standard error.
    pub(super) fn said_bytes(&self) -> u64 {
        self.said.bytes.load(Ordering::Relaxed)
    }

    /// The start of that.
    pub(super) fn said(&self) -> String {
        let start = self.said.start.lock().unwrap_or_else(PoisonError::into_inner);
        String::from_utf8_lossy(&start).into_owned()
    }

    /// The most memory that it has had since the last call of this kind, in MB, where the system
    /// tells it.
    pub(super) fn take_peak_memory_mb(&self) -> Option<f64> {
        let id = self.child.id();
        let status = fs::read_to_string(format!("/proc/{id}/status")).ok()?;
        let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
        let kib: f64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
        // The peak of the next time begins here; where that is refused, it is that of all times.
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

/// Kills all that run: before the harness ends in the middle.
pub(super) fn kill_all() {
    for id in list().iter() {
        send("KILL", *id);
    }
}

fn send(signal: &str, id: u32) {
    let _ = Command::new("sh").arg("-c").arg(format!("kill -{signal} {id}")).status();
}
