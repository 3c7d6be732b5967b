//! The robot program in Java as a process of its own, in front of a simulated cabinet.

#![expect(
    clippy::expect_used,
    clippy::print_stdout,
    reason = "a test fails by it, or shows what it prints"
)]

use std::{
    env,
    ffi::OsString,
    io::{BufRead, BufReader, Read},
    path::PathBuf,
    process::{Child, ChildStdin, Command, Stdio},
    sync::mpsc::{self, Receiver},
    thread,
    time::{Duration, Instant},
};

use crate::child_processes;

/// The program, a jar.
const VARIABLE: &str = "IIWASIM_ROBOT_PROGRAM";

/// How long it may take to start, and to end by itself.
const START: Duration = Duration::from_secs(30);
const END: Duration = Duration::from_secs(5);

/// The jar that the environment names.
#[must_use]
pub fn jar() -> Option<PathBuf> {
    env::var_os(VARIABLE).map(PathBuf::from)
}

/// The same; without one, the line that says so.
#[must_use]
pub fn jar_or_skip() -> Option<PathBuf> {
    if jar().is_none() {
        println!("skipped: {VARIABLE} names no robot program");
    }
    jar()
}

/// Where it listens, and the cabinet behind it.
#[derive(Clone, Debug)]
pub struct ProgramPorts {
    /// For instructions.
    pub instructions: String,
    /// For states.
    pub state: String,
    /// The cabinet's, for instructions.
    pub cabinet_instructions: String,
    /// The cabinet's, for states.
    pub cabinet_state: String,
}

/// A running robot program. It ends when it is dropped.
#[derive(Debug)]
pub struct ProgramProcess {
    child: Child,
    stdin: Option<ChildStdin>,
}

impl ProgramProcess {
    /// Starts it with further options, and waits until it is connected.
    ///
    /// # Panics
    ///
    /// If it does not start.
    #[must_use]
    pub fn start(jar: &PathBuf, ports: &ProgramPorts, options: &[OsString]) -> Self {
        let (mut program, lines) = Self::spawn(jar, ports, options);
        let line = lines.recv_timeout(START);
        assert_eq!(line.as_deref(), Ok("ready"), "{:?}", program.child.try_wait());
        program
    }

    /// Starts it; with the lines of its standard output.
    fn spawn(
        jar: &PathBuf,
        ports: &ProgramPorts,
        options: &[OsString],
    ) -> (Self, Receiver<String>) {
        let mut command = Command::new("java");
        command
            .arg("-jar")
            .arg(jar)
            .args(["--instructions", &ports.instructions])
            .args(["--state", &ports.state])
            .args(["--cabinet-instructions", &ports.cabinet_instructions])
            .args(["--cabinet-state", &ports.cabinet_state])
            .arg("--until-stdin-closes")
            .args(options)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        let mut child = child_processes::start(&mut command).expect("java");
        let lines = read_lines(child.stdout.take().expect("a pipe"));
        show_errors(child.stderr.take().expect("a pipe"));
        (Self { stdin: child.stdin.take(), child }, lines)
    }

    /// Ends it; whether it did so by itself.
    #[must_use]
    pub fn end(mut self) -> bool {
        self.ends()
    }

    fn ends(&mut self) -> bool {
        self.stdin = None;
        let since = Instant::now();
        while since.elapsed() < END {
            if let Ok(Some(_)) = self.child.try_wait() {
                return true;
            }
            thread::sleep(Duration::from_millis(10));
        }
        // It may have ended meanwhile.
        let _ = self.child.kill();
        let _ = self.child.wait();
        false
    }
}

impl Drop for ProgramProcess {
    fn drop(&mut self) {
        if self.stdin.is_some() && !self.ends() {
            println!("the robot program did not end within {END:?} and was killed");
        }
    }
}

/// Prints the first lines that it writes about errors: a thread of it that fails again and again would fill a disk.
fn show_errors(stderr: impl Read + Send + 'static) {
    const MOST: usize = 40;
    thread::spawn(move || {
        let lines = BufReader::new(stderr).lines().map_while(Result::ok);
        for line in lines.enumerate().filter_map(|(i, line)| (i < MOST).then_some(line)) {
            println!("robot program: {line}");
        }
    });
}

fn read_lines(stdout: impl Read + Send + 'static) -> Receiver<String> {
    let (out, lines) = mpsc::channel();
    thread::spawn(move || {
        for line in BufReader::new(stdout).lines().map_while(Result::ok) {
            // The receiver may be dropped.
            let _ = out.send(line);
        }
    });
    lines
}
