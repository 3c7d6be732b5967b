//! Prints the results of `cargo bench -p iiwasim-benches`, with ratios, required figures and
//! accuracies, as Markdown tables.
//!
//! Times are those of the fastest of criterion's samples, which depend least on other load on the
//! machine.

use std::{
    env, fs,
    path::{Path as FilePath, PathBuf},
    process::ExitCode,
};

use super::no_arguments::no_arguments;
use iiwa_kin::Robot;
use iiwa_path::{BlendSearch, JointPath};
use iiwa_program::Program;
use iiwa_traj::{JerkOptions, SweepOptions, Timing, Trajectory};
use iiwasim_benches::{
    Result, machine, reference,
    topp_ra::AccelerationSamples,
    topp3::{self, PEERS},
};
use serde_json::Value;

/// Result of a bench.
struct Figure {
    name: String,
    /// Time of one run in the fastest sample.
    fastest_ns: f64,
    /// Number of elements in `fastest_ns`: poses, searches or samples.
    elements: Option<f64>,
}

impl Figure {
    fn each_ns(&self) -> f64 {
        self.fastest_ns / self.elements.unwrap_or(1.0)
    }
}

/// Results of one group of benches.
struct Group {
    title: &'static str,
    element: &'static str,
    figures: Vec<Figure>,
}

impl Group {
    /// Reads a group from the folder of `criterion`.
    fn read(
        folder: &FilePath,
        title: &'static str,
        element: &'static str,
        names: &[&str],
    ) -> Result<Self> {
        let mut figures = Vec::new();
        for bench in subfolders(&folder.join(title))? {
            let (Ok(about), Ok(samples)) =
                (json(&bench.join("new/benchmark.json")), json(&bench.join("new/sample.json")))
            else {
                continue;
            };
            let list = |key: &str| samples[key].as_array().into_iter().flatten();
            let each = list("times").zip(list("iters"));
            let fastest = each
                .filter_map(|(time_ns, runs)| Some(time_ns.as_f64()? / runs.as_f64()?))
                .min_by(f64::total_cmp)
                .ok_or_else(|| format!("{}: no samples", bench.display()))?;
            figures.push(Figure {
                name: about["function_id"].as_str().unwrap_or_default().to_owned(),
                fastest_ns: fastest,
                elements: about["throughput"]["Elements"].as_f64(),
            });
        }
        let place = |figure: &Figure| names.iter().position(|name| *name == figure.name);
        figures.retain(|figure| place(figure).is_some());
        figures.sort_by_key(place);
        Ok(Self { title, element, figures })
    }

    fn get(&self, name: &str) -> Option<&Figure> {
        self.figures.iter().find(|figure| figure.name == name)
    }

    fn count(&self, elements: f64) -> String {
        let plural = if self.element.ends_with("ch") { "es" } else { "s" };
        format!("{elements} {}{plural}", self.element)
    }

    /// Prints the group; ratios are relative to the first figure.
    fn print(&self) {
        let each = !self.element.is_empty();
        println!("\n### {}\n", self.title);
        if self.figures.is_empty() {
            println!("Not measured.");
            return;
        }
        if each {
            println!("| | time | for | time a {0} | ratio | ratio a {0} |", self.element);
            println!("|---|---:|---:|---:|---:|---:|");
        } else {
            println!("| | time |\n|---|---:|");
        }
        let first = &self.figures[0];
        for figure in &self.figures {
            print!("| {} | {} |", figure.name, time(figure.fastest_ns));
            if each {
                print!(
                    " {} | {} | {:.2} | {:.2} |",
                    self.count(figure.elements.unwrap_or(1.0)),
                    time(figure.each_ns()),
                    figure.fastest_ns / first.fastest_ns,
                    figure.each_ns() / first.each_ns(),
                );
            }
            println!();
        }
    }
}

pub(crate) fn run(arguments: &[&str]) -> Result<ExitCode> {
    no_arguments(arguments)?;
    let folder = criterion_folder()?;
    let read = |title, element, names: &[&str]| Group::read(&folder, title, element, names);
    let forward = read(
        "forward kinematics",
        "pose",
        &[
            "iiwa-kin tcp",
            "iiwa-kin tcp_position",
            "iiwa-kin tcp_batch",
            "seven std sin_cos alone",
            "nalgebra 4x4 DH product",
            "k",
        ],
    )?;
    let inverse =
        read("inverse kinematics", "pose", &["iiwa-kin inverse", "iiwa-kin inverse_moving"])?;
    let search = read("blend search", "search", &["first crossing", "algorithm 1", "algorithm 2"])?;
    let stamps = read(
        "stamps",
        "node",
        &[
            "iiwa-traj plan",
            "iiwa-traj plan, 1000 motions",
            "copp topp2_ra, solver alone",
            "copp topp2_ra, from samples",
            "copp topp2_ra, from the path",
        ],
    )?;
    let mut names = vec!["iiwa-traj plan"];
    names.extend(PEERS.iter().filter(|peer| peer.timed).map(|peer| peer.name));
    let jerk = read("stamps, jerk", "motion", &names)?;
    let growth = read("growth, jerk", "motion", &["10 motions", "100 motions", "1000 motions"])?;
    let durations = Durations::find()?;
    let ten = read("ten motions", "", &["Program::from_json", "Path::new", "Trajectory::plan"])?;
    let command = read("command", "", &["iiwasim plan", "iiwasim --version"])?;

    let clearance =
        read("clearance", "pose", &["poses all over the ranges", "poses of the ten motions"])?;
    let planned = read("planned clearance", "", &["ten motions", "each of the ten motions"])?;

    println!(
        "On {}, {}, by {}.",
        machine::processor(),
        machine::instruction_level(),
        machine::version("rustc")
    );
    print_required(&search, &stamps, &jerk, &durations, &command, &planned);
    for group in
        [&forward, &inverse, &search, &stamps, &jerk, &growth, &ten, &command, &clearance, &planned]
    {
        group.print();
    }
    print_found_crossings()?;
    print_accuracy()?;
    durations.print();
    print_jerk_accuracy()?;
    Ok(ExitCode::SUCCESS)
}

/// Times in motion of the ten motions with jerk limits, in s.
struct Durations {
    ours: f64,
    peers: Vec<(&'static str, f64)>,
    /// Time of an independent solver.
    reference: f64,
}

/// Peer of the requirement: the one that minimises time.
const HELD_AGAINST: &str = "copp topp3_socp, 100 intervals";

impl Durations {
    fn find() -> Result<Self> {
        let program = Program::from_json(&reference::ten_motions()?)?;
        let path = JointPath::new(&program, &Robot::lbr_iiwa_7_r800())?;
        let timing = Timing::jerk_limited();
        let solve = |peer: &topp3::Peer| -> Result<_> {
            let samples = topp3::JerkSamples::new(&path, peer.intervals)?;
            Ok((peer.name, samples.solve(peer.solver)?.duration_s))
        };
        Ok(Self {
            ours: Trajectory::plan(&path, timing)?.motion_time_s(),
            peers: PEERS.iter().map(solve).collect::<Result<_>>()?,
            reference: reference::ten_motions_jerk_s()?,
        })
    }

    /// Time of the planner relative to the peer's.
    fn relative_time(&self, peer: &str) -> Option<f64> {
        let (_, theirs) = self.peers.iter().find(|(name, _)| *name == peer)?;
        Some(self.ours / theirs)
    }

    fn print(&self) {
        println!("\n### durations, jerk\n");
        println!(
            "Time in motion of the ten motions, and how much longer it is than the reference.\n"
        );
        println!("| | time in motion | over the reference |\n|---|---:|---:|");
        let ours = ("iiwa-traj plan", self.ours);
        for (name, time_s) in [ours].iter().chain(&self.peers) {
            let excess_percent = 100.0 * (time_s / self.reference - 1.0);
            println!("| {name} | {time_s:.6} s | {excess_percent:+.3} % |");
        }
        println!("| reference: an independent solver, from below | {:.6} s | |", self.reference);
    }
}

/// Formats a figure for a table.
type Format<'a> = &'a dyn Fn(f64) -> String;

/// Prints ratios and times, with their upper bounds.
fn print_required(
    search: &Group,
    stamps: &Group,
    jerk: &Group,
    durations: &Durations,
    command: &Group,
    planned: &Group,
) {
    let each = |group: &Group, name: &str| group.get(name).map(Figure::each_ns);
    let ratio = |a: Option<f64>, b: Option<f64>| Some(a? / b?);
    let sweep = each(stamps, "iiwa-traj plan");
    let copp = each(stamps, "copp topp2_ra, solver alone");
    let share = |value: f64| format!("1/{:.1}", 1.0 / value);
    let times = |value: f64| time(value);
    let plain = |value: f64| format!("{value:.4}");
    let run = |name: &str| jerk.get(name).map(|figure| figure.fastest_ns);
    let ours = run("iiwa-traj plan");
    let rows: [(&str, Option<f64>, f64, Format<'_>); 8] = [
        (
            "blend search: first crossing over algorithm 2",
            ratio(each(search, "first crossing"), each(search, "algorithm 2")),
            1.0 / 5.0,
            &share,
        ),
        ("stamps, path included: time a node of the sweep", sweep, 70.0, &times),
        (
            "stamps: time a node, over that of copp's solver alone",
            ratio(sweep, copp),
            1.0 / 8.0,
            &share,
        ),
        ("stamps of ten blended motions, jerk-limited", ours, 10e6, &times),
        (
            "the same over the time of copp's topp3_socp at 100 intervals a segment",
            ratio(ours, run(HELD_AGAINST)),
            1.0 / 300.0,
            &share,
        ),
        (
            "the same: time in motion, over that by copp's topp3_socp",
            durations.relative_time(HELD_AGAINST),
            1.0,
            &plain,
        ),
        (
            "`iiwasim plan`, ten motions, process and MCAP",
            each(command, "iiwasim plan"),
            30e6,
            &times,
        ),
        (
            "clearance of ten motions from ten obstacles, to 0.1 mm",
            each(planned, "ten motions"),
            50e6,
            &times,
        ),
    ];
    println!("\n### required\n\n| | at most | measured | |\n|---|---:|---:|---|");
    for (quantity, value, limit, format) in rows {
        let (shown, verdict) = match value {
            Some(value) => (format(value), if value <= limit { "kept" } else { "**missed**" }),
            None => ("not measured".to_owned(), ""),
        };
        println!("| {quantity} | {} | {shown} | {verdict} |", format(limit));
    }
}

/// Prints the results of the searches in the bench.
fn print_found_crossings() -> Result<()> {
    let robot = Robot::lbr_iiwa_7_r800();
    println!("\n### crossings found\n");
    println!("| | found | none in the half | farther out than the first crossing by > 0.001 |");
    println!("|---|---:|---:|---:|");
    let searches = reference::searches()?;
    for (name, kind) in [
        ("first crossing", BlendSearch::FirstCrossing),
        ("algorithm 1", BlendSearch::Algorithm1),
        ("algorithm 2", BlendSearch::Algorithm2),
    ] {
        let minima: Vec<_> = searches.iter().map(|search| search.run(kind, &robot)).collect();
        let misses = searches.iter().zip(&minima).filter(|(search, minimum)| {
            let first = search.run(BlendSearch::FirstCrossing, &robot);
            first.is_some_and(|first| minimum.is_none_or(|minimum| minimum > first + 0.001 + 1e-9))
        });
        let some = minima.iter().flatten().count();
        println!("| {name} | {some} | {} | {} |", minima.len() - some, misses.count());
    }
    Ok(())
}

/// Prints errors of the time in motion of the first reference program.
fn print_accuracy() -> Result<()> {
    const FINE: usize = 20_000;
    let program = Program::from_json(&reference::ten_motions()?)?;
    let path = JointPath::new(&program, &Robot::lbr_iiwa_7_r800())?;
    let ours = |samples: usize| -> Result<f64> {
        let timing = Timing::Acceleration(SweepOptions { samples });
        Ok(Trajectory::plan(&path, timing)?.motion_time_s())
    };
    let theirs = |intervals: usize| -> Result<f64> {
        Ok(AccelerationSamples::new(&path, intervals)?.problem()?.solve()?)
    };
    let exact = ours(FINE)?;
    println!("\n### accuracy\n");
    println!("Time in motion of the ten motions; its error against iiwa-traj at N = {FINE}.\n");
    println!("| intervals a segment | iiwa-traj | error | copp | error |");
    println!("|---:|---:|---:|---:|---:|");
    for n in [25, 50, 100, 200, 400, 1000, 4000] {
        let (a, b) = (ours(n)?, theirs(n)?);
        let error = |time_s: f64| format!("{:+.5} %", 100.0 * (time_s / exact - 1.0));
        println!("| {n} | {a:.6} s | {} | {b:.6} s | {} |", error(a), error(b));
    }
    println!("| {FINE} | {exact:.6} s | | | |");
    Ok(())
}

/// Prints the dependence of the time in motion of the ten motions on the cell size, with jerk
/// limits.
fn print_jerk_accuracy() -> Result<()> {
    const FINEST: f64 = 8.0;
    let program = Program::from_json(&reference::ten_motions()?)?;
    let path = JointPath::new(&program, &Robot::lbr_iiwa_7_r800())?;
    let plan = |refinement: f64| -> Result<f64> {
        let timing = Timing::Jerk(JerkOptions { refinement, ..JerkOptions::default() });
        Ok(Trajectory::plan(&path, timing)?.motion_time_s())
    };
    let finest = plan(FINEST)?;
    println!("\n### accuracy, jerk\n");
    println!("Time in motion of the ten motions, and how much longer it is than at the finest.\n");
    println!("| refinement | iiwa-traj | over the finest |\n|---:|---:|---:|");
    for refinement in [1.0, 2.0, 4.0] {
        let time_s = plan(refinement)?;
        let excess_percent = 100.0 * (time_s / finest - 1.0);
        println!("| {refinement} | {time_s:.6} s | {excess_percent:+.4} % |");
    }
    println!("| {FINEST} | {finest:.6} s | |");
    Ok(())
}

/// Formats a time with three digits.
fn time(ns: f64) -> String {
    let (value, unit) = match ns {
        ns if ns < 1e3 => (ns, "ns"),
        ns if ns < 1e6 => (ns * 1e-3, "us"),
        ns if ns < 1e9 => (ns * 1e-6, "ms"),
        ns => (ns * 1e-9, "s"),
    };
    let digits = if value < 10.0 { 2 } else { usize::from(value < 100.0) };
    format!("{value:.digits$} {unit}")
}

/// Returns the folder of criterion's results.
fn criterion_folder() -> Result<PathBuf> {
    let folder = match env::var_os("CRITERION_HOME") {
        Some(home) => home.into(),
        // target/release/bench, with target/criterion beside it.
        None => env::current_exe()?
            .ancestors()
            .nth(2)
            .ok_or("where are the figures?")?
            .join("criterion"),
    };
    if !folder.is_dir() {
        let missing = folder.display();
        return Err(format!("{missing} is missing: run `cargo bench -p iiwasim-benches`").into());
    }
    Ok(folder)
}

fn subfolders(folder: &FilePath) -> Result<Vec<PathBuf>> {
    match fs::read_dir(folder) {
        Ok(entries) => Ok(entries.map(|e| Ok(e?.path())).collect::<std::io::Result<_>>()?),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(Vec::new()),
        Err(error) => Err(format!("{}: {error}", folder.display()).into()),
    }
}

fn json(file: &FilePath) -> Result<Value> {
    Ok(serde_json::from_str(&fs::read_to_string(file)?)?)
}
