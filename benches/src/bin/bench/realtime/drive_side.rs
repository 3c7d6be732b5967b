//! Drive process.

use std::{thread, time::Duration};

use iiwa_drive::{Drive, DriveConfig};
use iiwa_link::{Remote, Server};
use iiwasim_benches::{Result, machine};
use serde::{Deserialize, Serialize};

use super::{part::serve, sockets::Sockets};

/// Message counts, longest answer and memory of the drive process.
#[derive(Deserialize, Serialize)]
pub(crate) struct DriveSide {
    pub(crate) received: u64,
    pub(crate) answered: u64,
    pub(crate) behind: u64,
    pub(crate) slowest_us: f64,
    pub(crate) real_time: bool,
    /// Memory after the start, and its peak.
    pub(crate) memory_mb: [f64; 2],
}

/// Runs a drive until the input ends.
pub(crate) fn be_drive(sockets: &Sockets) -> Result<()> {
    let mut config = DriveConfig::default();
    config.instructions.clone_from(&sockets.instructions);
    config.stream.clone_from(&sockets.stream);
    config.fri = sockets.fri;
    config.cabinet_instructions.clone_from(&sockets.cabinet_instructions);
    config.cabinet_state.clone_from(&sockets.cabinet_state);
    let drive = Drive::start(config, &Server::open(), &Remote::open())?;
    let start_mb = machine::peak_memory_mb()?;
    serve(|| {
        let mut answer_latency = drive.answer_latency();
        // One message may be in process.
        for _ in 0..10 {
            if answer_latency.received == answer_latency.answered {
                break;
            }
            thread::sleep(Duration::from_micros(300));
            answer_latency = drive.answer_latency();
        }
        DriveSide {
            received: answer_latency.received,
            answered: answer_latency.answered,
            behind: answer_latency.behind,
            slowest_us: 1e6 * answer_latency.slowest.as_secs_f64(),
            real_time: answer_latency.real_time,
            memory_mb: [start_mb, machine::peak_memory_mb().unwrap_or(f64::NAN)],
        }
    })
}
