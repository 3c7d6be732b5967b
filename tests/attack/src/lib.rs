//! Black-box attacks on `iiwasim cabinet`, `drive` and `twin`: processes of the command line and
//! raw sockets, judged by a witness on the FRI connection with a separate decoder.
//!
//! | part | requirement |
//! |---|---|
//! | stop | after a stop, or the loss of a client or drive, the arm does not move |
//! | load | stops are answered under floods of connections, long requests and subscribers that do not read |
//! | suspend | while drive or cabinet are suspended and resumed, commanded positions keep the acceleration limits |
//! | memory | memory and logs of the programs are bounded |

mod arrival;
mod attackers;
mod deadlines;
mod erratic_program;
mod fri_wire;
mod load;
mod memory;
mod open_files;
mod output;
mod process;
mod report;
mod request;
mod rig;
mod round;
mod stop;
mod suspend;
mod tasks;
mod usage;
mod websocket;
mod witness;

use std::{path::PathBuf, process::ExitCode, time::Duration};

use attackers::Size;
pub use load::Scenario;
use output::print;
use report::Row;
use rig::Fault;

/// Options of the attacks.
#[derive(Clone, Debug)]
pub struct Options {
    /// Path of the executable `iiwasim`.
    pub binary: PathBuf,
    /// Parts to run.
    pub part: Part,
    /// `true` for a soak test of an hour instead of two minutes.
    pub long: bool,
    /// `true` for CURVE keys between all programs, and attackers without keys.
    pub keys: bool,
    /// `true` triples all deadlines, on a machine with other load.
    pub shared: bool,
    /// Seed of the random instants.
    pub seed: u64,
}

/// Part of the attacks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// Stops at random instants.
    Stop,
    /// Stops under floods.
    Load,
    /// One scenario of stops under floods.
    Scenario(Scenario),
    /// Trajectories while programs are suspended.
    Suspend,
    /// Memory and logs.
    Memory,
    /// All parts.
    All,
}

/// Runs the attacks and prints a table of requirements and measurements. Returns exit code 0 if all
/// requirements are met, and 1 otherwise or if an attack cannot be made.
#[must_use]
pub fn run(options: &Options) -> ExitCode {
    deadlines::set_factor(if options.shared { 3 } else { 1 });
    open_files::raise_limit();
    // Fails if a handler is set already, which does not matter here.
    let _ = ctrlc::set_handler(|| {
        process::kill_all();
        std::process::exit(130);
    });
    match attack(options) {
        Ok(rows) => {
            print(&format!("\n{}", report::table(&rows)));
            if rows.iter().all(|row| row.met) { ExitCode::SUCCESS } else { ExitCode::FAILURE }
        }
        Err(fault) => {
            print(&format!("the attack cannot be made: {fault}"));
            ExitCode::FAILURE
        }
    }
}

fn attack(options: &Options) -> Result<Vec<Row>, Fault> {
    let Options { binary, part, long, keys, seed, .. } = options;
    let includes = |which: Part| [which, Part::All].contains(part);
    let seconds = |short, soak| Duration::from_secs(if *long { soak } else { short });
    // More connections at each port than a program may have open files.
    let connections = if *long { 2500 } else { 1200 };
    let size = |topics| Size { connections, handshakes: 250, topics };
    print(&format!("seed {seed}"));
    let mut rows = Vec::new();
    if includes(Part::Stop) {
        let extent = stop::StopExtent {
            rounds: 1000,
            time: seconds(35, 2 * 3600),
            longest_planning: if *long {
                Duration::from_secs(5)
            } else {
                Duration::from_millis(800)
            },
        };
        rows.extend(stop::run(binary, *seed, &extent)?);
    }
    let only = if let Part::Scenario(scenario) = *part { Some(scenario) } else { None };
    if includes(Part::Load) || only.is_some() {
        let extent = load::LoadExtent {
            size: size(if *long { 60_000_000 } else { 5_000_000 }),
            time: seconds(3, 60),
            together: seconds(6, 300),
            only,
        };
        rows.extend(load::run(binary, *seed, *keys, &extent)?);
    }
    if includes(Part::Suspend) {
        let extent = suspend::SuspendExtent { rounds: 200, time: seconds(12, 3600) };
        rows.extend(suspend::run(binary, *seed, &extent)?);
    }
    if includes(Part::Memory) {
        let extent = memory::MemoryExtent {
            size: size(60_000_000),
            time: seconds(3, 60),
            last_run: seconds(6, 60),
        };
        rows.extend(memory::run(binary, *keys, &extent)?);
    }
    Ok(rows)
}
