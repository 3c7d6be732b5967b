//! A case: its processes, and what they have measured.

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

/// What a case gave.
pub(crate) struct Measured {
    pub(crate) cabinet: CabinetSide,
    pub(crate) drive: DriveSide,
    pub(crate) subscribers: Option<Subscribers>,
    pub(crate) runs: Runs,
    /// When the machine stood still, in us; none without witnesses.
    pub(crate) still: Option<Vec<Section>>,
}

impl Measured {
    /// Messages without any answer.
    pub(crate) fn never(&self) -> u64 {
        self.cabinet.cycles - self.cabinet.answered
    }

    /// Cycles lost by the drive: messages that have reached it, and were answered too late or never,
    /// though the machine went on.
    pub(crate) fn lost(&self) -> u64 {
        self.late_by_drive().count() as u64 + (self.drive.received - self.drive.answered)
    }

    /// Late answers that no standstill explains: how long they took, and for how much of it the machine
    /// stood still, in us.
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

/// None if the drive cannot be kept from real-time priority.
pub(crate) fn measure(case: &Case) -> Result<Option<Measured>> {
    // As root has it without this capability: like anybody else.
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
    // The controller comes last: each of its messages counts, from the first one on.
    let period = case.period_ms.to_string();
    let mut cabinet =
        Part::start(Command::new(&this).args(["realtime", "--part", "cabinet", &period, &text]))?;
    let runs = run_trajectories(&sockets, Duration::from_secs(case.seconds))?;
    let cabinet = cabinet.ask()?;
    let drive = drive.ask()?;
    let subscribers = subscribers.map(|mut part| part.ask()).transpose()?;
    let mut still = None;
    if let Some(mut witnesses) = witnesses {
        let sections: Vec<Vec<Section>> =
            witnesses.iter_mut().map(Part::ask).collect::<Result<_>>()?;
        still = Some(joined(sections.concat()));
    }
    Ok(Some(Measured { cabinet, drive, subscribers, runs, still }))
}
