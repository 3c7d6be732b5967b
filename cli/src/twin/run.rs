//! A run of a plan on the robot.

use std::{
    fs,
    io::Write as _,
    path::PathBuf,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
};

use iiwa_kin::Joints;
use iiwa_link::{
    ClientError,
    message::{DriveState, FriStatus, Run as Measured, Status},
};
use iiwa_path::{Motion, Program, Ptp};
use iiwa_view::{Extent, Page};
use serde::Serialize;

use crate::{
    failure::Failure,
    output::Output,
    runner::{self, Line, Task, Watched},
    start::StartOffset,
};

use super::{Setup, Word, planned::Planned, word};

/// Share of the limits of velocity at which the arm moves to a program's start.
const TO_START: f64 = 0.1;

/// How far a run is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Phase {
    /// On the way to the program's start.
    ToStart,
    Running,
    Done,
    /// It broke off, or never began.
    Failed,
}

/// A run that may begin.
pub(super) struct ProgramRun {
    plan: Arc<Planned>,
    to_start: Option<Motion>,
    line: Line,
    /// Whether it was told to stop.
    stopped: Arc<AtomicBool>,
}

/// What a run brought.
pub(super) struct RunOutcome {
    pub(super) word: Word,
    /// What the robot did.
    pub(super) mcap: Option<PathBuf>,
}

impl ProgramRun {
    /// Checks a plan against where the robot is and its obstacles. Errors are for people.
    pub(super) fn new(
        plan: Arc<Planned>,
        move_to_start: bool,
        setup: &Setup,
    ) -> Result<Self, String> {
        if let Some(why) = &plan.refused {
            return Err(format!("the program is not sent: {why}"));
        }
        let mut line = setup.line().map_err(|failure| failure.what())?;
        let status = line
            .client()
            .state()
            .map_err(|error| format!("cannot ask where the robot is: {error}"))?;
        let joints_rad = standing(&status)?;
        let start_rad = plan.program.start_rad;
        let offset = StartOffset::new(&joints_rad, &start_rad);
        let to_start = if offset.is_within_tolerance() {
            None
        } else if move_to_start {
            Some(way_to(start_rad, joints_rad, setup)?)
        } else {
            return Err(format!("{offset}; have it move there first"));
        };
        Ok(Self { plan, to_start, line, stopped: Arc::default() })
    }

    /// Set it, and what has not begun does not begin, and what has begun is stopped.
    pub(super) fn stopped(&self) -> Arc<AtomicBool> {
        self.stopped.clone()
    }

    /// Has the robot run it, and returns when that is over.
    pub(super) fn carry_out(mut self, setup: &Setup, mut tell: impl FnMut(Word)) -> RunOutcome {
        let plan = self.plan.clone();
        let begun = |phase| plain(&plan, phase, None);
        let stopped =
            || RunOutcome { word: plain(&plan, Phase::Failed, Some("stopped")), mcap: None };
        if let Some(motion) = self.to_start.take() {
            tell(begun(Phase::ToStart));
            let Some(Watched { result, .. }) = self.attend(vec![motion]) else { return stopped() };
            if let Err(error) = result {
                let why = format!("the robot did not move to the start: {error}");
                return RunOutcome { word: plain(&plan, Phase::Failed, Some(&why)), mcap: None };
            }
        }
        tell(begun(Phase::Running));
        let motions = plan.program.motions.clone();
        let Some(Watched { result, seen }) = self.attend(motions) else { return stopped() };
        let (measured, error) = match result {
            Ok(measured) => (measured, None),
            Err(ClientError::Refused { refusal, run }) => {
                (run.map(|run| *run).unwrap_or_default(), Some(refusal.to_string()))
            }
            // What the stream has brought is all there is.
            Err(error) => {
                let why = format!("{error}; the robot may still be moving");
                (Measured::new(seen), Some(why))
            }
        };
        finished(&plan, &measured, error, setup)
    }

    /// Has the robot run motions; none if it was told to stop before.
    fn attend(&mut self, motions: Vec<Motion>) -> Option<Watched> {
        let to_stop = || self.stopped.load(Ordering::Relaxed);
        (!to_stop())
            .then(|| runner::attend(&mut self.line, Task::Motions(motions), to_stop, |_| ()))
    }
}

/// Where the robot stands, ready for a run.
fn standing(status: &Status) -> Result<Joints, String> {
    if status.state != DriveState::Idle {
        return Err(format!("the robot is busy: {}", status.state));
    }
    status.joints_rad.filter(|_| status.fri.session != FriStatus::SILENT).ok_or_else(|| {
        "it is not known where the robot is: the drive does not hear the controller".into()
    })
}

/// The slow motion to a program's start, if nothing stands in the way.
fn way_to(start_rad: Joints, joints_rad: Joints, setup: &Setup) -> Result<Motion, String> {
    let motion = Motion::Ptp(Ptp::to(start_rad).velocity(TO_START));
    let program = Program { robot: None, start_rad: joints_rad, motions: vec![motion.clone()] };
    let plan = setup.plan(&program)?;
    match setup.too_near(setup.nearest_of(&plan).as_ref()) {
        None => Ok(motion),
        Some(why) => Err(format!("the robot does not move to the program's start: {why}")),
    }
}

/// A run of which there is nothing to see.
fn plain(plan: &Planned, phase: Phase, error: Option<&str>) -> Word {
    word("run", &RunForPage { plan: plan.id, phase, error, cycle_time_s: None, sketch: None::<()> })
}

/// The word for pages.
#[derive(Serialize)]
struct RunForPage<'a, S> {
    /// Which plan it runs.
    plan: u64,
    phase: Phase,
    error: Option<&'a str>,
    cycle_time_s: Option<f64>,
    /// What the robot did beside the plan.
    sketch: Option<S>,
}

/// Writes down what the robot did, and shows it beside the plan.
fn finished(
    plan: &Planned,
    measured: &Measured,
    error: Option<String>,
    setup: &Setup,
) -> RunOutcome {
    let phase = if error.is_some() { Phase::Failed } else { Phase::Done };
    let samples = runner::since_start(measured);
    if samples.is_empty() {
        return RunOutcome { word: plain(plan, phase, error.as_deref()), mcap: None };
    }
    let kept = runner::recording(&samples, measured.cycle_time_s, &setup.robot, &plan.text)
        .and_then(|bytes| kept(&bytes, plan, setup));
    let (mcap, elsewhere) = match kept {
        Ok((mcap, elsewhere)) => (Some(mcap), elsewhere),
        Err(failure) => (None, Some(failure.what())),
    };
    let page = |mcap| setup.page(&plan.mcap, Some(mcap), Extent::Sketch);
    let page = mcap.as_deref().map(page);
    let (page, unseen) = match page.transpose() {
        Ok(page) => (page, None),
        Err(failure) => (None, Some(failure.what())),
    };
    let errors: Vec<String> = [error, elsewhere, unseen].into_iter().flatten().collect();
    let word = word(
        "run",
        &RunForPage {
            plan: plan.id,
            phase,
            error: (!errors.is_empty()).then(|| errors.join("; ")).as_deref(),
            cycle_time_s: measured.cycle_time_s,
            sketch: page.as_ref().map(Page::sketch),
        },
    );
    RunOutcome { word, mcap }
}

/// Where a recording was written, and why not in the folder, if it was not: there is no other.
fn kept(bytes: &[u8], plan: &Planned, setup: &Setup) -> Result<(PathBuf, Option<String>), Failure> {
    let in_folder = || {
        let [mcap] = setup.new_files(&plan.stem, [".measured.mcap"])?;
        let write = || {
            let file = Output::new(&mcap)?;
            file.write(bytes)?;
            file.complete_always()
        };
        // The name was taken by an empty file.
        write().inspect_err(|_| drop(fs::remove_file(&mcap)))?;
        Ok(mcap)
    };
    let elsewhere = || {
        let mut file =
            tempfile::Builder::new().prefix("iiwasim-").suffix(".measured.mcap").tempfile().ok()?;
        file.write_all(bytes).ok()?;
        file.keep().ok().map(|(_, path)| path)
    };
    in_folder().map(|mcap| (mcap, None)).or_else(|failure: Failure| {
        let Some(mcap) = elsewhere() else { return Err(failure) };
        let why = format!("{}; what the robot did is in {}", failure.what(), mcap.display());
        Ok((mcap, Some(why)))
    })
}
