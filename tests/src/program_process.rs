//! Java robot program as a separate process, in front of a simulated cabinet.

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

/// Variable with the path of the program, a jar.
const VARIABLE: &str = "IIWASIM_ROBOT_PROGRAM";

/// Time limits for its start, and for its end after closing its input.
const START: Duration = Duration::from_secs(30);
const END: Duration = Duration::from_secs(5);

/// Returns the jar that the environment names.
#[must_use]
pub fn jar() -> Option<PathBuf> {
    env::var_os(VARIABLE).map(PathBuf::from)
}

/// Returns the jar; without one, prints that the test is skipped.
#[must_use]
pub fn jar_or_skip() -> Option<PathBuf> {
    if jar().is_none() {
        println!("skipped: {VARIABLE} names no robot program");
    }
    jar()
}

/// Addresses of the program, and of the cabinet behind it.
#[derive(Clone, Debug)]
pub struct ProgramPorts {
    /// Address for instructions.
    pub instructions: String,
    /// Address for states.
    pub state: String,
    /// Address of the cabinet for instructions.
    pub cabinet_instructions: String,
    /// Address of the cabinet for states.
    pub cabinet_state: String,
}

/// Running robot program. The process ends when this value is dropped.
#[derive(Debug)]
pub struct ProgramProcess {
    child: Child,
    stdin: Option<ChildStdin>,
}

impl ProgramProcess {
    /// Starts the program with further options, and waits until it is connected.
    ///
    /// # Panics
    ///
    /// Panics if the program does not start.
    #[must_use]
    pub fn start(jar: &PathBuf, ports: &ProgramPorts, options: &[OsString]) -> Self {
        let (mut program, lines) = Self::spawn(jar, ports, options);
        let line = lines.recv_timeout(START);
        assert_eq!(line.as_deref(), Ok("ready"), "{:?}", program.child.try_wait());
        program
    }

    /// Starts the program; returns the lines of its standard output.
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

    /// Ends the program; returns true if it ended by itself.
    #[must_use]
    pub fn end(mut self) -> bool {
        self.has_ended()
    }

    fn has_ended(&mut self) -> bool {
        self.stdin = None;
        let since = Instant::now();
        while since.elapsed() < END {
            if let Ok(Some(_)) = self.child.try_wait() {
                return true;
            }
            thread::sleep(Duration::from_millis(10));
        }
        // The process may have ended meanwhile.
        let _ = self.child.kill();
        let _ = self.child.wait();
        false
    }
}

impl Drop for ProgramProcess {
    fn drop(&mut self) {
        if self.stdin.is_some() && !self.has_ended() {
            println!("the robot program did not end within {END:?} and was killed");
        }
    }
}

/// Prints the first lines of its standard error: a thread that fails repeatedly would fill a disk.
fn show_errors(stderr: impl Read + Send + 'static) {
    const MAX_LINES: usize = 40;
    thread::spawn(move || {
        let lines = BufReader::new(stderr).lines().map_while(Result::ok);
        for line in lines.enumerate().filter_map(|(i, line)| (i < MAX_LINES).then_some(line)) {
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
