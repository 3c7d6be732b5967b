//! Memory and logs under attacks on memory, and with an erratic robot program.

use std::{
    fs,
    path::Path,
    thread,
    time::{Duration, Instant},
};

use super::{
    attackers::{Kind, Size},
    erratic_program::ErraticProgram,
    report::Row,
    rig::{Fault, Parts, Rig},
    tasks::there_and_back,
    usage::Usage,
};

/// Extent of the attacks.
pub(super) struct MemoryExtent {
    pub(super) size: Size,
    /// Duration of each attack.
    pub(super) time: Duration,
    /// Duration of the run whose measurements are requested repeatedly.
    pub(super) last_run: Duration,
}

/// Runs attacks that use memory, and attacks that fill logs.
pub(super) fn run(binary: &Path, keys: bool, extent: &MemoryExtent) -> Result<Vec<Row>, Fault> {
    let mut rows = Vec::new();
    for kind in [Kind::UnreadReplies, Kind::Topics, Kind::LongRequests] {
        // Restarts the programs, so that attacks do not affect each other.
        let mut rig = Rig::start(binary, Parts { twin: true, keys, ..Parts::default() })?;
        if kind == Kind::UnreadReplies {
            make_last_run(&rig, extent.last_run)?;
        }
        let usage = Usage::begin(&rig);
        let attack = kind.start(&rig.addresses, &extent.size);
        await_until(&usage, extent.time);
        let with_keys = if keys { ", with keys" } else { "" };
        rows.push(usage.row(&(kind.name(&extent.size) + with_keys), &mut rig));
        drop(attack);
    }
    if !keys {
        rows.push(erratic_program(binary, extent.time)?);
    }
    Ok(rows)
}

/// Performs a run with many samples.
fn make_last_run(rig: &Rig, duration: Duration) -> Result<(), Fault> {
    let from = rig.witness.position().ok_or("the witness has not seen the arm")?;
    let file = rig.folder.path().join("program.json");
    fs::write(&file, there_and_back(&from, duration))?;
    let file = file.display().to_string();
    let mut run = rig.client(&["run", file.as_str(), "--no-output"], true)?;
    let ended = run.wait(2 * duration + Duration::from_secs(10));
    match ended {
        Some(ended) if ended.success => Ok(()),
        _ => Err(format!("the run has failed: {}", run.stderr()).into()),
    }
}

/// Runs a drive with an erratic robot program.
fn erratic_program(binary: &Path, time: Duration) -> Result<Row, Fault> {
    let mut rig = Rig::new(binary, Parts::default())?;
    let program = ErraticProgram::start(&rig.addresses)?;
    rig.start_drive()?;
    let since = Instant::now();
    while program.states() == 0 && since.elapsed() < Duration::from_secs(10) {
        thread::sleep(Duration::from_millis(10));
    }
    let usage = Usage::begin(&rig);
    await_until(&usage, time);
    let row = usage.row("an erratic robot program", &mut rig);
    let states = program.states();
    Ok(Row {
        measured: format!("{}, {states} states", row.measured),
        met: row.met && states > 0,
        ..row
    })
}

fn await_until(usage: &Usage, time: Duration) {
    while usage.elapsed() < time {
        thread::sleep(Duration::from_millis(20));
    }
}
