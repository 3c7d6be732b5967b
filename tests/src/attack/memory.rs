//! What the programs take beside those who want much of it, and beside a robot program that lies.

use std::{
    fs,
    path::Path,
    thread,
    time::{Duration, Instant},
};

use super::{
    attackers::{Kind, Size},
    liar::Liar,
    report::Row,
    rig::{Fault, Parts, Rig},
    usage::Usage,
    work::there_and_back,
};

/// How much is attacked.
pub(super) struct MemoryExtent {
    pub(super) size: Size,
    /// How long each attack lasts.
    pub(super) time: Duration,
    /// How long the run is that is asked for again and again.
    pub(super) last_run: Duration,
}

/// Attacks that take memory, and those that fill logs.
pub(super) fn run(binary: &Path, keys: bool, extent: &MemoryExtent) -> Result<Vec<Row>, Fault> {
    let mut rows = Vec::new();
    for kind in [Kind::UnreadReplies, Kind::Topics, Kind::LongRequests] {
        // Fresh programs: what one attack has left behind is not the next one's.
        let mut rig = Rig::start(binary, Parts { twin: true, keys })?;
        if kind == Kind::UnreadReplies {
            make_last_run(&rig, extent.last_run)?;
        }
        let usage = Usage::begin(&rig);
        let attack = kind.start(&rig.at, &extent.size);
        await_until(&usage, extent.time);
        let with_keys = if keys { ", with keys" } else { "" };
        rows.push(usage.row(&(kind.name(&extent.size) + with_keys), &mut rig));
        drop(attack);
    }
    if !keys {
        rows.push(lies(binary, extent.time)?);
    }
    Ok(rows)
}

/// A run that leaves many samples.
fn make_last_run(rig: &Rig, duration: Duration) -> Result<(), Fault> {
    let from = rig.witness.position().ok_or("the witness has not seen the arm")?;
    let file = rig.folder.path().join("program.json");
    fs::write(&file, there_and_back(&from, duration))?;
    let file = file.display().to_string();
    let mut run = rig.client(&["run", file.as_str(), "--no-output"], true)?;
    let ended = run.wait(2 * duration + Duration::from_secs(10));
    match ended {
        Some(ended) if ended.well => Ok(()),
        _ => Err(format!("there is no last run: {}", run.said()).into()),
    }
}

/// A drive with a robot program that lies.
fn lies(binary: &Path, time: Duration) -> Result<Row, Fault> {
    let mut rig = Rig::new(binary, Parts::default())?;
    let liar = Liar::start(&rig.at)?;
    rig.start_drive()?;
    let since = Instant::now();
    while liar.lies() == 0 && since.elapsed() < Duration::from_secs(10) {
        thread::sleep(Duration::from_millis(10));
    }
    let usage = Usage::begin(&rig);
    await_until(&usage, time);
    let row = usage.row("a robot program that lies", &mut rig);
    let lies = liar.lies();
    Ok(Row { measured: format!("{}, {lies} lies", row.measured), met: row.met && lies > 0, ..row })
}

fn await_until(usage: &Usage, time: Duration) {
    while usage.elapsed() < time {
        thread::sleep(Duration::from_millis(20));
    }
}
