//! Case with its processes and their measurements.

use std::{env, process::Command, time::Duration};

use iiwasim_benches::Result;

use super::{
    cabinet_side::CabinetSide,
    case::Case,
    drive_side::DriveSide,
    part::Part,
    runs::{Runs, run_trajectories},
    sockets::Sockets,
    subscribers::Subscribers,
    witness::{Section, joined, witnesses},
};

/// Result of a case.
pub(crate) struct Measured {
    pub(crate) cabinet: CabinetSide,
    pub(crate) drive: DriveSide,
    pub(crate) subscribers: Option<Subscribers>,
    pub(crate) runs: Runs,
    /// Intervals in which the machine was stalled, in us; `None` without witnesses.
    pub(crate) still: Option<Vec<Section>>,
}

impl Measured {
    /// Number of messages without any answer.
    pub(crate) fn unanswered(&self) -> u64 {
        self.cabinet.cycles - self.cabinet.answered
    }

    /// Number of cycles lost by the drive: messages that reached the drive, and were answered late
    /// or never, although the machine was not stalled.
    pub(crate) fn lost(&self) -> u64 {
        self.late_by_drive().count() as u64 + (self.drive.received - self.drive.answered)
    }

    /// Late answers that no stall explains: their latencies, and the stalled part of each, in us.
    pub(crate) fn late_by_drive(&self) -> impl Iterator<Item = [i64; 2]> {
        let still = self.still.as_deref().unwrap_or_default();
        let period_us = 1000 * i64::from(self.cabinet.period_ms);
        self.cabinet.late_us.iter().filter_map(move |late| {
            let overlap = |[from, to]: &Section| late.answered.min(*to) - late.sent.max(*from);
            let stood: i64 = still.iter().map(|section| overlap(section).max(0)).sum();
            let took = late.answered - late.sent;
            (took - stood > period_us).then_some([took, stood])
        })
    }
}

/// Runs a case; `None` if real-time priority cannot be denied to the drive.
pub(crate) fn measure(case: &Case) -> Result<Option<Measured>> {
    // Removes this capability of root: the drive then runs as an ordinary process.
    const ORDINARY: [&str; 2] = ["--bounding-set=-sys_nice", "--inh-caps=-sys_nice"];
    let sockets = Sockets::free();
    let text = serde_json::to_string(&sockets)?;
    let this = env::current_exe()?;
    let _busy = Part::start(Command::new(&this).args(["realtime", "--part", "busy"]))?;
    let witnesses = witnesses(&this)?;
    let mut drive = if case.ordinary { Command::new("setpriv") } else { Command::new(&this) };
    if case.ordinary {
        drive.args(ORDINARY).arg(&this);
    }
    let drive = Part::start(drive.args(["realtime", "--part", "drive", &text]));
    let mut drive = match drive {
        Err(_) if case.ordinary => return Ok(None),
        drive => drive?,
    };
    let mut subscribers = None;
    if case.subscribers {
        let mut command = Command::new(&this);
        subscribers = Some(Part::start(command.args([
            "realtime",
            "--part",
            "subscribers",
            &sockets.stream,
        ]))?);
    }
    // The controller starts last: each of its messages counts, beginning with the first.
    let period = case.period_ms.to_string();
    let mut cabinet =
        Part::start(Command::new(&this).args(["realtime", "--part", "cabinet", &period, &text]))?;
    let runs = run_trajectories(&sockets, Duration::from_secs(case.seconds))?;
    let cabinet = cabinet.query()?;
    let drive = drive.query()?;
    let subscribers = subscribers.map(|mut part| part.query()).transpose()?;
    let mut still = None;
    if let Some(mut witnesses) = witnesses {
        let sections: Vec<Vec<Section>> =
            witnesses.iter_mut().map(Part::query).collect::<Result<_>>()?;
        still = Some(joined(sections.concat()));
    }
    Ok(Some(Measured { cabinet, drive, subscribers, runs, still }))
}
