//! Processes of this executable, and their reports.

use std::{
    io::{self, BufRead, BufReader, Write},
    process::{Child, ChildStdin, Command, Stdio},
    sync::mpsc::{self, Receiver},
    thread,
    time::{Duration, Instant},
};

use iiwasim_benches::Result;
use serde::{Serialize, de::DeserializeOwned};

/// Process of this executable.
pub(crate) struct Part {
    process: Child,
    /// Input; the process ends when it is closed.
    input: Option<ChildStdin>,
    lines: Receiver<String>,
}

/// Time limit for a reply of a process.
const ANSWERED_WITHIN: Duration = Duration::from_secs(15);

impl Part {
    /// Starts a process and waits until it is ready.
    pub(crate) fn start(command: &mut Command) -> Result<Self> {
        let mut process = command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn()?;
        let input = process.stdin.take();
        let output = process.stdout.take().ok_or("no output")?;
        let (sender, lines) = mpsc::channel();
        thread::spawn(move || {
            let lines = BufReader::new(output).lines().map_while(io::Result::ok);
            lines.for_each(|line| drop(sender.send(line)));
        });
        let part = Self { process, input, lines };
        part.line()?;
        Ok(part)
    }

    fn line(&self) -> Result<String> {
        let line = self.lines.recv_timeout(ANSWERED_WITHIN);
        line.map_err(|_| "a part of the bench says nothing; see what it wrote above".into())
    }

    /// Requests the report of the process.
    pub(crate) fn query<T: DeserializeOwned>(&mut self) -> Result<T> {
        writeln!(self.input.as_mut().ok_or("no input")?)?;
        Ok(serde_json::from_str(&self.line()?)?)
    }
}

impl Drop for Part {
    fn drop(&mut self) {
        self.input = None;
        let since = Instant::now();
        while since.elapsed() < Duration::from_secs(3) {
            if matches!(self.process.try_wait(), Ok(Some(_))) {
                return;
            }
            thread::sleep(Duration::from_millis(10));
        }
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// Reports readiness, then answers each input line with `report`, until the input ends.
pub(crate) fn serve<T: Serialize>(mut report: impl FnMut() -> T) -> Result<()> {
    println!();
    for line in io::stdin().lines() {
        line?;
        println!("{}", serde_json::to_string(&report())?);
    }
    Ok(())
}
