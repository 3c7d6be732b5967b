//! Conformance suite of robot programs: cases in `sunrise/conformance`, one per line, which define
//! the answers of a robot program to instructions. The README there defines their format.
//!
//! The runner works with any robot program behind two addresses: [`run`] starts one for each file.

mod case;
mod pattern;
mod peer;
mod session;

use std::{collections::BTreeMap, fmt, panic::resume_unwind, thread, time::Duration};

pub use case::{ConformanceCase, NEEDS, cases, folder};
pub use pattern::mismatch;
pub use peer::{DrivePeer, Incoming, ZmqPeer};

use session::Session;

/// Result of the cases.
#[derive(Clone, Debug, Default)]
pub struct Report {
    /// Number of passed cases.
    pub passed: usize,
    /// Number of skipped cases, by the capability that the program lacks.
    pub skipped: BTreeMap<String, usize>,
    /// Differences from the expected results, a line each.
    pub failed: Vec<String>,
}

impl Report {
    fn add(&mut self, of_file: Self) {
        self.passed += of_file.passed;
        self.failed.extend(of_file.failed);
        for (need, count) in of_file.skipped {
            *self.skipped.entry(need).or_default() += count;
        }
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} cases passed, {} failed", self.passed, self.failed.len())?;
        for (need, count) in &self.skipped {
            write!(f, ", {count} skipped without {need}")?;
        }
        self.failed.iter().take(MAX_SHOWN).try_for_each(|line| write!(f, "\n{line}"))?;
        if self.failed.len() > MAX_SHOWN { f.write_str("\n...") } else { Ok(()) }
    }
}

/// Maximum number of failures shown.
const MAX_SHOWN: usize = 60;

/// Time limit for a program to become idle.
const REST: Duration = Duration::from_secs(30);

/// Runs the files whose names `wanted` accepts against a robot program with the capabilities `has`.
/// `start` starts a new instance of the program for each file; its result is kept until the file is
/// done. `connect` connects to the instance. Files run in parallel, since they mostly wait.
///
/// # Panics
///
/// Panics if a file cannot be read.
pub fn run<Program, P: DrivePeer>(
    has: &[&str],
    wanted: impl Fn(&str) -> bool,
    start: impl Fn() -> Program + Sync,
    connect: impl Fn(&Program) -> P + Sync,
) -> Report {
    let files: Vec<_> = case::files().into_iter().filter(|(name, _)| wanted(name)).collect();
    thread::scope(|scope| {
        let mut running = Vec::new();
        for (file, cases) in &files {
            let (start, connect) = (&start, &connect);
            running.push(scope.spawn(move || {
                let program = start();
                run_file(has, file, cases, || connect(&program))
            }));
        }
        let mut report = Report::default();
        for of_file in running {
            match of_file.join() {
                Ok(of_file) => report.add(of_file),
                Err(panic) => resume_unwind(panic),
            }
        }
        report
    })
}

fn run_file<P: DrivePeer>(
    has: &[&str],
    file: &str,
    cases: &[ConformanceCase],
    connect: impl Fn() -> P,
) -> Report {
    let mut report = Report::default();
    let mut session = Session::new(connect());
    for case in cases {
        if let Some(need) = case.needs.iter().find(|need| !has.contains(&need.as_str())) {
            *report.skipped.entry(need.clone()).or_default() += 1;
            continue;
        }
        match session.run(case) {
            Ok(()) => report.passed += 1,
            Err(message) => {
                report.failed.push(format!("{file}:{}: {}: {message}", case.line, case.name));
                // Pending actions must not affect the next case.
                session = Session::new(connect());
                if let Err(message) = session.come_to_rest(REST) {
                    report.failed.push(format!("{file}: the rest is left out: {message}"));
                    break;
                }
            }
        }
    }
    if let Err(message) = session.come_to_rest(REST) {
        report.failed.push(format!("{file}: at its end: {message}"));
    }
    report
}
