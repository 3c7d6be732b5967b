//! Planning of many programs, one per thread.

use std::{
    collections::BTreeMap,
    fmt::Write as _,
    fs,
    path::{Path, PathBuf},
    sync::{Mutex, PoisonError},
};

use iiwa_json::printable;
use iiwa_report::{PlannedTimes, Summary, SummaryRow, warning_lines};
use iiwa_scene::Scene;
use rayon::{
    ThreadPoolBuilder,
    iter::{ParallelBridge, ParallelIterator},
};

use super::{
    programs::{self, PlanJob},
    work::{FailedProgram, PlanOutcome, gates, scene, write},
};
use crate::{
    args::Plan,
    failure::{self, Failure},
    input, output,
    progress::Progress,
    terminal,
};

/// Plans all given programs, and those in the given folders.
pub(super) fn run(options: &Plan, given: &[PathBuf]) -> Result<(), Failure> {
    if options.picture.is_some() {
        return Err(Failure::input("--picture draws one program; plan that one alone"));
    }
    if options.csv.is_some() || options.parquet.is_some() {
        return Err(Failure::input("--csv and --parquet are for one program; plan that one alone"));
    }
    if options.trace {
        return Err(Failure::input("--trace shows how one program is solved; plan that one alone"));
    }
    let jobs = programs::jobs(options, given)?;
    if let Some(robot) = &options.robot {
        // Reports an invalid robot once, not for each program.
        input::find_robot(robot)?;
    }
    let scene = scene(options)?;
    if let Some(folder) = &options.output {
        make_folder(folder)?;
    }
    output::catch_interrupts();
    // 0 selects one thread per core.
    let threads = options.jobs.map_or(0, |threads| usize::from(threads).min(jobs.len()));
    let pool = ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|error| Failure::run("cannot start the threads", &error))?;

    let printer = Mutex::new(OutcomePrinter::new(jobs.len()));
    // Started in order, so that few outcomes wait for an earlier one.
    let work = jobs.iter().enumerate().par_bridge();
    let result = pool.install(|| {
        work.try_for_each(|(index, job)| {
            output::check_interrupt()?;
            let outcome = plan(options, scene.as_ref(), job, &printer);
            // An interrupt is not a failure of the program.
            output::check_interrupt()?;
            printer.lock().unwrap_or_else(PoisonError::into_inner).add(index, outcome)
        })
    });
    let OutcomePrinter { progress, summary, .. } =
        printer.into_inner().unwrap_or_else(PoisonError::into_inner);
    progress.clear();
    result?;
    report(options, &summary)
}

/// Creates the folder for the trajectories, unless it exists.
fn make_folder(folder: &Path) -> Result<(), Failure> {
    if folder == Path::new("-") {
        let message = "the trajectories cannot be written to standard output (-): name a folder";
        return Err(Failure::input(message));
    }
    if folder.exists() && !folder.is_dir() {
        return Err(Failure::input(format!(
            "{} is not a folder; of many programs, --output names one",
            folder.display()
        )));
    }
    fs::create_dir_all(folder).map_err(|error| {
        Failure::run(format!("cannot make the folder {}", folder.display()), &error)
    })
}

/// Plans one of the programs.
fn plan(
    options: &Plan,
    scene: Option<&Scene>,
    job: &PlanJob,
    printer: &Mutex<OutcomePrinter>,
) -> ProgramOutcome {
    let name = job.program.display().to_string();
    let alive = |_| {
        // The thread that holds the lock shows the progress.
        if let Ok(mut printer) = printer.try_lock() {
            printer.progress.alive();
        }
    };
    let planned = input::program(&job.program, options.robot.as_deref())
        .and_then(|input| write(options, &name, scene, input, job.target.as_deref(), alive))
        .and_then(|planned| ProgramOutcome::planned(options, &name, &planned));
    planned.unwrap_or_else(|failure| ProgramOutcome::failed(options, name, failure))
}

/// Result of a program; only `line` grows with the length of the program.
struct ProgramOutcome {
    /// Line for standard output.
    line: Option<String>,
    /// Line for standard error.
    complaint: Option<String>,
    row: SummaryRow,
}

impl ProgramOutcome {
    fn planned(options: &Plan, name: &str, planned: &PlanOutcome) -> Result<Self, Failure> {
        let gates = gates(options).judge(&planned.figures);
        let complain = |how| Failure::Gate(format!("{} {how}", printable(name))).text();
        let warnings = warning_lines(&planned.figures.warnings, Some(name));
        let complaint = warnings + &gates.complaint().map(complain).unwrap_or_default();
        Ok(Self {
            line: options.json.then(|| output::json_line(planned)).transpose()?,
            complaint: Some(complaint).filter(|complaint| !complaint.is_empty()),
            row: SummaryRow {
                program: name.to_owned(),
                times: Some(PlannedTimes::from(&planned.figures)),
                too_long: gates.too_long.is_some(),
                too_near: gates.too_near.is_some(),
                overloaded: gates.overloaded.is_some(),
            },
        })
    }

    fn failed(options: &Plan, name: String, failure: Failure) -> Self {
        let failure = failure.about(&name);
        let line =
            || output::json_line(&FailedProgram { program: &name, errors: failure.errors() });
        Self {
            // Texts and numbers can always be serialised.
            line: options.json.then(line).and_then(Result::ok),
            complaint: Some(failure.text()),
            row: SummaryRow::failed(name),
        }
    }
}

/// Prints outcomes in the order of the programs.
struct OutcomePrinter {
    progress: Progress,
    summary: Summary,
    /// Outcomes of programs after an unfinished one.
    waiting: BTreeMap<usize, ProgramOutcome>,
}

impl OutcomePrinter {
    fn new(count: usize) -> Self {
        Self {
            progress: Progress::of_programs(count),
            summary: Summary::default(),
            waiting: BTreeMap::new(),
        }
    }

    /// Adds the outcome of the program at `index`, and prints all outcomes whose predecessors are
    /// finished.
    fn add(&mut self, index: usize, outcome: ProgramOutcome) -> Result<(), Failure> {
        self.waiting.insert(index, outcome);
        while let Some(outcome) = self.waiting.remove(&self.summary.programs()) {
            let ProgramOutcome { line, complaint, row } = outcome;
            self.progress.aside(|| {
                if let Some(complaint) = complaint {
                    failure::print_note(&complaint);
                }
                line.map_or(Ok(()), |line| output::print(&line))
            })?;
            self.summary.add(row);
        }
        self.progress.show((self.summary.programs() + self.waiting.len()) as u64);
        Ok(())
    }
}

/// Prints the table; fails if programs failed or gates are violated.
fn report(options: &Plan, summary: &Summary) -> Result<(), Failure> {
    if !options.json {
        let mut text = summary.text(terminal::width());
        if summary.failed() < summary.programs() && !options.no_output {
            let folder = options.output.as_deref().unwrap_or(Path::new("the current folder"));
            let _ = writeln!(text, "Trajectories in {}", folder.display());
        }
        output::print(&text)?;
    }
    summary.complaint(&gates(options)).map_or(Ok(()), |unmet| Err(Failure::Gate(unmet)))
}
