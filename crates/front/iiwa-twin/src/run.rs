//! Run of a plan on the robot.

use std::{
    fs,
    io::Write as _,
    path::PathBuf,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    time::Duration,
};

use iiwa_files::Output;
use iiwa_kin::Joints;
use iiwa_link::{
    ClientError, StartOffset,
    message::{DriveState, DriveStatus, Request, Run as Measured, RunLabel},
};
use iiwa_log::{Config, JointLog};
use iiwa_page::{Extent, Page};
use iiwa_program::{Motion, Program, Ptp, Sources, Start, Workcell};
use iiwa_scene::CarriedBodies;
use serde::Serialize;

use crate::{
    Setup, TwinError,
    message::{PageMessage, page_message},
    planned::PlanFiles,
    runs::{self, DriveConnection, ExecutedRun},
};

/// Velocity of motions outside programs, relative to the limits.
const SLOW_VELOCITY_REL: f64 = 0.1;

/// State of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum RunState {
    /// Motion to the start of the program.
    ToStart,
    Running,
    Done,
    /// The run failed to start, or was interrupted.
    Failed,
}

/// Run that passed its checks, ready to start.
pub(crate) struct ProgramRun {
    plan: Arc<PlanFiles>,
    to_start: Option<Motion>,
    connection: DriveConnection,
    /// `true` after a stop request.
    stopped: Arc<AtomicBool>,
}

/// Result of a run.
pub(crate) struct RunOutcome {
    pub(crate) message: PageMessage,
    /// Recording, if anything was recorded.
    pub(crate) mcap: Option<PathBuf>,
}

impl ProgramRun {
    /// Checks that the plan may run from the robot's position, clear of obstacles. Errors are shown
    /// on the page.
    pub(crate) fn new(
        plan: Arc<PlanFiles>,
        move_to_start: bool,
        setup: &Setup,
    ) -> Result<Self, String> {
        if let Some(why) = &plan.refused {
            return Err(format!("the program is not sent: {why}"));
        }
        check_recording(&plan, setup, runs::now())?;
        let mut connection = setup.connection().map_err(|error| setup.words(&error))?;
        let status = connection
            .client()
            .state()
            .map_err(|error| format!("cannot ask for the position of the robot: {error}"))?;
        let joints_rad = position_when_idle(&status, setup)?;
        let start_rad = plan.start_rad;
        let offset = StartOffset::new(&joints_rad, &start_rad);
        let to_start = if offset.is_within_tolerance() {
            None
        } else if move_to_start {
            let to_error = |why| format!("the robot does not move to the program's start: {why}");
            Some(motion_to(start_rad, joints_rad, setup).map_err(to_error)?)
        } else {
            return Err(format!("{offset}; let it move there first"));
        };
        Ok(Self { plan, to_start, connection, stopped: Arc::default() })
    }

    /// Flag that stops the run, or prevents its start.
    pub(crate) fn stopped(&self) -> Arc<AtomicBool> {
        self.stopped.clone()
    }

    /// Runs the program on the robot; returns at its end.
    pub(crate) fn carry_out(
        mut self,
        setup: &Setup,
        mut publish: impl FnMut(PageMessage),
    ) -> RunOutcome {
        let plan = self.plan.clone();
        let begun = |phase| without_recording(&plan, phase, None);
        let failed = |why: &str| {
            let message = without_recording(&plan, RunState::Failed, Some(why));
            RunOutcome { message, mcap: None }
        };
        if let Some(motion) = self.to_start.take() {
            publish(begun(RunState::ToStart));
            let Some(run) = self.execute(
                &Request::motions(vec![motion]).labelled(RunLabel::of_robot(&setup.robot)),
            ) else {
                return failed("stopped");
            };
            if let Err(error) = run.result {
                return failed(&format!("the robot did not move to the start: {error}"));
            }
        }
        publish(begun(RunState::Running));
        let request = Request::motions(plan.motions.clone()).labelled(plan.label.clone());
        let Some(run) = self.execute(&request) else { return failed("stopped") };
        let ExecutedRun { result, streamed, torques } = run;
        let (measured, error) = match result {
            Ok(measured) => (measured, None),
            Err(ClientError::Refused { refusal, run }) => {
                let why = format!("{refusal}{}", (setup.wording.refusal)(&refusal));
                (run.map(|run| *run).unwrap_or_default(), Some(why))
            }
            // The samples of the stream are the only ones.
            Err(error) => {
                let why = format!("{error}; the robot may still be moving");
                (Measured::new(streamed), Some(why))
            }
        };
        let recorded = runs::since_start(&measured, &torques);
        finish(&plan, &recorded, error, setup)
    }

    /// Sends a request to the robot; `None` if a stop was requested before.
    fn execute(&mut self, request: &Request) -> Option<ExecutedRun> {
        let to_stop = || self.stopped.load(Ordering::Relaxed);
        (!to_stop()).then(|| runs::execute(&mut self.connection, request, to_stop, |_| ()))
    }
}

/// Rejects a plan whose run, starting `now`, could not be recorded.
fn check_recording(plan: &PlanFiles, setup: &Setup, now: Duration) -> Result<(), String> {
    let planned_s = plan.label.plan.as_ref().map_or(0.0, |plan| plan.cycle_time_s);
    runs::longest_log(planned_s)
        .to_mcap(file_config(now, setup), &setup.robot, &plan.text)
        .map(drop)
        .map_err(|error| {
            let why = setup.words(&error.into());
            format!("the program is not sent, because its run could not be recorded: {why}")
        })
}

/// File configuration of a recording that begins at `epoch`.
fn file_config(epoch: Duration, setup: &Setup) -> Config {
    Config { epoch, names: setup.names.clone(), ..Config::default() }
}

/// Returns the position of the robot, if it is idle.
pub(crate) fn position_when_idle(status: &DriveStatus, setup: &Setup) -> Result<Joints, String> {
    if status.state != DriveState::Idle {
        return Err(format!("the robot is busy: {}", status.state));
    }
    runs::position(status).ok_or_else(|| (setup.wording.unknown_position)(status))
}

/// Returns a slow motion from one position to another, if it keeps clear of obstacles.
pub(crate) fn motion_to(to_rad: Joints, from_rad: Joints, setup: &Setup) -> Result<Motion, String> {
    let motion = Motion::Ptp(Ptp::to(to_rad).velocity(SLOW_VELOCITY_REL));
    let program = Program {
        robot: None,
        start: Start::Joints(from_rad),
        motions: vec![motion.clone()],
        workcell: Workcell::default(),
        sources: Sources::default(),
    };
    let plan = setup.plan(&program)?;
    match setup.too_near(&setup.nearest_of(&plan, &CarriedBodies::default())) {
        None => Ok(motion),
        Some(why) => Err(why),
    }
}

/// Returns the state of a run without a recording.
fn without_recording(plan: &PlanFiles, phase: RunState, error: Option<&str>) -> PageMessage {
    page_message(
        "run",
        &RunForPage { plan: plan.id, phase, error, cycle_time_s: None, sketch: None::<()> },
    )
}

/// Run in page format.
#[derive(Serialize)]
struct RunForPage<'a, S> {
    /// Id of the plan.
    plan: u64,
    phase: RunState,
    error: Option<&'a str>,
    cycle_time_s: Option<f64>,
    /// Recording beside the plan.
    sketch: Option<S>,
}

/// Writes the recording, and compares it with the plan.
fn finish(plan: &PlanFiles, log: &JointLog, error: Option<String>, setup: &Setup) -> RunOutcome {
    let phase = if error.is_some() { RunState::Failed } else { RunState::Done };
    if log.t_s.is_empty() {
        return RunOutcome {
            message: without_recording(plan, phase, error.as_deref()),
            mcap: None,
        };
    }
    let saved = log
        .to_mcap(file_config(runs::began(log), setup), &setup.robot, &plan.text)
        .map_err(TwinError::from)
        .and_then(|bytes| save(&bytes, plan, setup));
    let (mcap, unwritten) = match saved {
        Ok((mcap, unwritten)) => (Some(mcap), unwritten),
        Err(error) => (None, Some(setup.words(&error))),
    };
    let page = |mcap| setup.page(&plan.mcap, Some(mcap), Extent::Sketch);
    let page = mcap.as_deref().map(page);
    let (page, not_shown) = match page.transpose() {
        Ok(page) => (page, None),
        Err(error) => (None, Some(setup.words(&error))),
    };
    let errors: Vec<String> = [error, unwritten, not_shown].into_iter().flatten().collect();
    let message = page_message(
        "run",
        &RunForPage {
            plan: plan.id,
            phase,
            error: (!errors.is_empty()).then(|| errors.join("; ")).as_deref(),
            // The measured cycle time: from the joint positions if possible, otherwise from the
            // robot program's clock.
            cycle_time_s: page.as_ref().and_then(Page::measured_cycle_time_s).or(log.cycle_time_s),
            sketch: page.as_ref().map(Page::sketch),
        },
    );
    RunOutcome { message, mcap }
}

/// Writes the recording to the twin's folder, or else to the system's temporary folder, since a run
/// cannot be recorded again. Returns its path, and the reason if it is not in the twin's folder.
fn save(
    bytes: &[u8],
    plan: &PlanFiles,
    setup: &Setup,
) -> Result<(PathBuf, Option<String>), TwinError> {
    let in_folder = || {
        let [mcap] = setup.new_files(&plan.stem, [".measured.mcap"])?;
        let write = || {
            let file = Output::new(&mcap)?;
            file.write(bytes)?;
            file.complete_always()
        };
        // `new_files` has reserved the name by an empty file.
        write().inspect_err(|_| drop(fs::remove_file(&mcap)))?;
        Ok(mcap)
    };
    let elsewhere = || {
        let mut file =
            tempfile::Builder::new().prefix("iiwasim-").suffix(".measured.mcap").tempfile().ok()?;
        file.write_all(bytes).ok()?;
        file.keep().ok().map(|(_, path)| path)
    };
    in_folder().map(|mcap| (mcap, None)).or_else(|error: TwinError| {
        let Some(mcap) = elsewhere() else { return Err(error) };
        let why = format!("{}; the recording is in {}", setup.words(&error), mcap.display());
        Ok((mcap, Some(why)))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_run_that_could_not_be_recorded_is_not_sent() {
        let folder = tempfile::tempdir().unwrap();
        let setup = Setup::without_drive(folder.path());
        let text = r#"{
            "version": 1,
            "start": { "joints_deg": [0, 30, 0, -60, 0, 90, 0] },
            "motions": [{ "type": "ptp", "joints_deg": [10, 30, 0, -60, 0, 90, 0] }]
        }"#;
        let plan = PlanFiles::new(1, "a.json", text.to_owned(), &setup).unwrap();
        check_recording(&plan, &setup, Duration::from_hours(500_000)).unwrap();
        let refusal = check_recording(&plan, &setup, Duration::from_secs(1 << 31)).unwrap_err();
        assert!(refusal.starts_with("the program is not sent"), "{refusal}");
        assert!(refusal.contains("past the year 2038"), "{refusal}");
    }
}
