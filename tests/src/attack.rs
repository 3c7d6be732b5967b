//! Attacks on `iiwasim cabinet`, `drive` and `twin` from outside: processes of the command line and raw
//! sockets, judged by a witness on FRI's wire that decodes messages by itself.
//!
//! | part | what it shows |
//! |---|---|
//! | stop | after a stop, or the loss of a client or drive, the arm does not move any more |
//! | load | a stop is answered beside floods of connections, long requests and deaf subscribers |
//! | memory | what the programs take meanwhile, and what they log |

mod ask;
mod attackers;
mod files;
mod fri_wire;
mod liar;
mod load;
mod memory;
mod patience;
mod process;
mod report;
mod rig;
mod round;
mod stop;
mod tell;
mod usage;
mod websocket;
mod witness;
mod work;
mod zmtp;

use std::{path::PathBuf, process::ExitCode, time::Duration};

use attackers::Size;
use report::Row;
use rig::Fault;
use tell::tell;

/// What is attacked, and how.
#[derive(Clone, Debug)]
pub struct Options {
    /// The program `iiwasim`.
    pub binary: PathBuf,
    /// The parts: `stop`, `load`, `memory` or all of them.
    pub part: Part,
    /// A soak of an hour instead of two minutes.
    pub long: bool,
    /// With CURVE keys between all programs, and attackers that have none.
    pub keys: bool,
    /// Everything may take three times as long: others use the machine, too.
    pub shared: bool,
    /// Of the random instants.
    pub seed: u64,
}

/// A part of the attacks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// Stops at random instants.
    Stop,
    /// Stops beside floods.
    Load,
    /// Memory and logs.
    Memory,
    /// All of these.
    All,
}

/// Attacks, prints a table of what is required and what was measured, and says whether all was met:
/// exit code 0, or 1 where it was not, or where the attack could not be made.
#[must_use]
pub fn run(options: &Options) -> ExitCode {
    patience::set(if options.shared { 3 } else { 1 });
    files::raise_limit();
    // Twice, where the first one fails: then there is nothing to be caught.
    let _ = ctrlc::set_handler(|| {
        process::kill_all();
        std::process::exit(130);
    });
    match attack(options) {
        Ok(rows) => {
            tell(&format!("\n{}", report::table(&rows)));
            if rows.iter().all(|row| row.met) { ExitCode::SUCCESS } else { ExitCode::FAILURE }
        }
        Err(fault) => {
            tell(&format!("the attack could not be made: {fault}"));
            ExitCode::FAILURE
        }
    }
}

fn attack(options: &Options) -> Result<Vec<Row>, Fault> {
    let Options { binary, part, long, keys, seed, .. } = options;
    let includes = |which: Part| [which, Part::All].contains(part);
    let seconds = |short, soak| Duration::from_secs(if *long { soak } else { short });
    // More than the open files of a program, at each of its ports.
    let connections = if *long { 2500 } else { 1200 };
    let size = |topics| Size { connections, handshakes: 250, topics };
    tell(&format!("seed {seed}"));
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
    if includes(Part::Load) {
        let extent = load::LoadExtent {
            size: size(if *long { 60_000_000 } else { 5_000_000 }),
            time: seconds(3, 60),
            together: seconds(6, 300),
        };
        rows.extend(load::run(binary, *seed, *keys, &extent)?);
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
