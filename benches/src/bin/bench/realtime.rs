//! Prints the answer latency of a drive towards a simulated cabinet over the loopback interface
//! while a core is busy and trajectories run, as a Markdown table with a list of further
//! observations.
//!
//! ```text
//! bench realtime                 10 s at 5 ms, 10 s at 1 ms
//! bench realtime --full          10 minutes at 5 ms, 2 minutes at 1 ms, the same with ten
//!                                subscribers, and 2 minutes of each without real-time priority for
//!                                the drive
//! bench realtime --period 1 --seconds 60 [--subscribers] [--ordinary]
//! ```
//!
//! Cabinet, drive, subscribers and the load on the core are separate processes, as in use. Each of
//! them ends when its input is closed, so none remains, however this process ends. On each core a
//! witness process of higher priority only wakes periodically: when it misses a wake-up, the
//! machine is stalled.
//!
//! A cycle is lost by the drive if its answer came more than a period after its message, after
//! subtracting the time in which the machine was stalled. Nothing else is subtracted: wake-up
//! delays of the system, and of the cabinet's own threads, count against the drive. Exits with 1 if
//! a drive with real-time priority lost more than one cycle in 10 000, or if a live subscriber
//! missed a message.

mod busy;
mod cabinet_side;
mod case;
mod clock;
mod drive_side;
mod measured;
mod part;
mod report;
mod runs;
mod sockets;
mod subscribers;
mod witness;

use std::process::ExitCode;

use iiwasim_benches::Result;

use self::{
    busy::be_busy,
    cabinet_side::be_cabinet,
    case::{Case, case},
    drive_side::be_drive,
    report::report,
    subscribers::be_subscribers,
    witness::be_witness,
};

pub(crate) fn run(arguments: &[&str]) -> Result<ExitCode> {
    match arguments {
        ["--part", "cabinet", period_ms, sockets] => {
            be_cabinet(period_ms.parse()?, &serde_json::from_str(sockets)?)?;
        }
        ["--part", "drive", sockets] => be_drive(&serde_json::from_str(sockets)?)?,
        ["--part", "subscribers", address] => be_subscribers(address)?,
        ["--part", "busy"] => be_busy()?,
        ["--part", "witness"] => be_witness()?,
        [] => return report(&[case(5, 10), case(1, 10)]),
        ["--full"] => {
            return report(&[
                case(5, 600),
                case(1, 120),
                Case { subscribers: true, ..case(1, 120) },
                Case { ordinary: true, ..case(5, 120) },
                Case { ordinary: true, ..case(1, 120) },
                Case { ordinary: true, subscribers: true, ..case(1, 120) },
            ]);
        }
        ["--period", period_ms, "--seconds", seconds, options @ ..] => {
            let mut case = case(period_ms.parse()?, seconds.parse()?);
            for option in options {
                match *option {
                    "--subscribers" => case.subscribers = true,
                    "--ordinary" => case.ordinary = true,
                    _ => return Err(format!("no such option: {option}").into()),
                }
            }
            return report(&[case]);
        }
        _ => return Err("it takes nothing, --full, or --period MS --seconds S".into()),
    }
    Ok(ExitCode::SUCCESS)
}
