//! Carries out the requests of pages: saved positions, a plan, a run.

use std::{
    path::PathBuf,
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    thread::{self, JoinHandle},
};

use iiwa_page::Extent;
use tokio::runtime::Handle;

use crate::{
    Setup, TwinError,
    follow::LatestJoints,
    jog::jog,
    message::{PageChannel, page_message},
    planned::PlanFiles,
    positions::PositionList,
    request::PageRequest,
    run::{ProgramRun, RunOutcome},
    stop::Stopper,
};

/// Carries out requests, and holds saved positions, the plan and the run.
pub(crate) struct TwinDispatcher {
    setup: Arc<Setup>,
    live: Arc<LatestJoints>,
    state: Mutex<DispatcherState>,
    stopper: Stopper,
    positions: Mutex<PositionList>,
    pub(crate) positions_channel: PageChannel,
    pub(crate) plan: PageChannel,
    pub(crate) run: PageChannel,
}

#[derive(Default)]
struct DispatcherState {
    plans: u64,
    plan: Option<Arc<PlanFiles>>,
    running: Option<RunningProgram>,
    /// Number of stop requests: a run that was requested before the last stop does not start.
    stops: u64,
    /// `true` if the twin is shutting down: runs no longer start.
    shutting_down: bool,
    /// Recording of the run of this plan.
    measured: Option<PathBuf>,
}

struct RunningProgram {
    thread: JoinHandle<()>,
    stopped: Arc<AtomicBool>,
}

impl TwinDispatcher {
    /// Creates a dispatcher with the saved positions.
    pub(crate) fn new(setup: Arc<Setup>, live: Arc<LatestJoints>) -> Result<Self, TwinError> {
        let nothing = |kind| PageChannel::new(page_message(kind, &None::<()>));
        let positions = PositionList::read(&setup.positions, &setup.robot, setup.wording.error)?;
        Ok(Self {
            stopper: Stopper::new(&setup),
            setup,
            live,
            state: Mutex::default(),
            positions_channel: PageChannel::new(page_message("positions", &positions.all())),
            positions: Mutex::new(positions),
            plan: nothing("plan"),
            run: nothing("run"),
        })
    }

    fn state(&self) -> MutexGuard<'_, DispatcherState> {
        // The state is consistent whenever the lock is released.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Carries out a request. Errors are shown on the page.
    pub(crate) fn carry_out(self: &Arc<Self>, request: PageRequest) -> Result<(), String> {
        match request {
            PageRequest::SavePosition { name } => self.save_position(&name),
            PageRequest::RemovePosition { position } => {
                self.change_positions(|positions| positions.remove(position))
            }
            PageRequest::RenamePosition { position, name } => {
                self.change_positions(|positions| positions.rename(position, &name))
            }
            PageRequest::MovePosition { position, by } => {
                self.change_positions(|positions| positions.shift(position, by))
            }
            PageRequest::MakeProgram { velocity_percent, blend_mm } => {
                let program = self.positions().program(velocity_percent, blend_mm)?;
                self.load("positions.json", program.to_json())
            }
            PageRequest::ClearProgram => {
                let mut state = self.state();
                not_running(&state)?;
                self.discard_plan(&mut state);
                Ok(())
            }
            PageRequest::Send { plan, move_to_start } => self.send(plan, move_to_start),
            PageRequest::Jog { joint, step_deg } => {
                let stops = {
                    let state = self.state();
                    not_running(&state)?;
                    state.stops
                };
                jog(joint, step_deg, &self.setup, || self.state().stops != stops)
            }
            PageRequest::Stop => Handle::current().block_on(self.stop()),
            PageRequest::SetIo { name, value } => {
                let mut client = self.setup.client().map_err(|error| self.setup.words(&error))?;
                client.set_io(&name, value).map(drop).map_err(|error| error.to_string())
            }
        }
    }

    fn save_position(&self, name: &str) -> Result<(), String> {
        let Some(joints_rad) = self.live.now() else {
            return Err(
                "the position of the robot is unknown: nothing is received from the drive".into()
            );
        };
        self.change_positions(|positions| positions.save(name, joints_rad))
    }

    fn change_positions(
        &self,
        change: impl FnOnce(&mut PositionList) -> Result<(), String>,
    ) -> Result<(), String> {
        // The positions have a separate lock: their file may be on a slow disk.
        let mut positions = self.positions();
        change(&mut positions)?;
        self.positions_channel.send_replace(page_message("positions", &positions.all()));
        Ok(())
    }

    fn positions(&self) -> MutexGuard<'_, PositionList> {
        self.positions.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Plans a program and shows it. The page shows errors; after an error, nothing can be sent:
    /// the earlier program is not the intended one.
    pub(crate) fn load(&self, name: &str, text: String) -> Result<(), String> {
        let id = {
            let mut state = self.state();
            not_running(&state)?;
            state.plans += 1;
            state.plans
        };
        // Planning may take long: the lock is released meanwhile.
        let plan = PlanFiles::new(id, name, text, &self.setup);
        let mut state = self.state();
        not_running(&state)?;
        // A program that was loaded later may have been planned faster.
        let is_newest = state.plan.as_ref().is_none_or(|shown| shown.id < id);
        let plan = plan.inspect_err(|_| {
            if is_newest {
                self.discard_plan(&mut state);
            }
        })?;
        if is_newest {
            self.plan.send_replace(plan.message.clone());
            state.plan = Some(Arc::new(plan));
            self.discard_run(&mut state);
        }
        Ok(())
    }

    fn discard_plan(&self, state: &mut DispatcherState) {
        state.plan = None;
        self.discard_run(state);
        self.plan.send_replace(page_message("plan", &None::<()>));
    }

    fn discard_run(&self, state: &mut DispatcherState) {
        state.measured = None;
        self.run.send_replace(page_message("run", &None::<()>));
    }

    fn send(self: &Arc<Self>, id: u64, move_to_start: bool) -> Result<(), String> {
        let shown = |state: &DispatcherState| {
            not_running(state)?;
            let plan = state.plan.clone().filter(|plan| plan.id == id);
            plan.ok_or_else(|| {
                format!("plan {id} is not the plan that is shown now: check that one first")
            })
        };
        let (plan, stops) = {
            let state = self.state();
            (shown(&state)?, state.stops)
        };
        // The drive is queried without the lock: a stop must not wait for this.
        let run = ProgramRun::new(plan, move_to_start, &self.setup)?;
        let mut state = self.state();
        shown(&state)?;
        if state.stops != stops || state.shutting_down {
            return Err("the program is not sent: a stop was requested meanwhile".into());
        }
        self.discard_run(&mut state);
        let stopped = run.stopped();
        let dispatcher = self.clone();
        let thread = thread::spawn(move || {
            let RunOutcome { message, mcap } = run
                .carry_out(&dispatcher.setup, |message| drop(dispatcher.run.send_replace(message)));
            let mut state = dispatcher.state();
            state.measured = mcap;
            state.running = None;
            dispatcher.run.send_replace(message);
        });
        state.running = Some(RunningProgram { thread, stopped });
        Ok(())
    }

    /// Stops the robot, whichever client started the motion, and every run that was requested
    /// before. Resolves to the answer of the drive.
    pub(crate) fn stop(&self) -> impl Future<Output = Result<(), String>> + use<> {
        {
            let mut state = self.state();
            state.stops += 1;
            if let Some(running) = &state.running {
                running.stopped.store(true, Ordering::Relaxed);
            }
        }
        self.stopper.stop()
    }

    /// Stops the current run of this twin, if any, and waits for its end.
    pub(crate) fn end(&self) {
        let running = {
            let mut state = self.state();
            state.shutting_down = true;
            state.running.take()
        };
        let Some(RunningProgram { thread, stopped }) = running else { return };
        stopped.store(true, Ordering::Relaxed);
        if let Ok(mut client) = self.setup.client()
            && client.stop().is_ok()
        {
            let _ = thread.join();
        }
    }

    /// Path of a file of the plan: the program, the plan or the recording of its run.
    pub(crate) fn file(&self, name: &str) -> Option<PathBuf> {
        let state = self.state();
        let plan = state.plan.as_ref()?;
        match name {
            "program.json" => Some(plan.mcap.with_extension("json")),
            "plan.mcap" => Some(plan.mcap.clone()),
            "measured.mcap" => state.measured.clone(),
            _ => None,
        }
    }

    /// Report of the plan and the recording of its run.
    pub(crate) fn report(&self) -> Option<Result<String, TwinError>> {
        let plan = self.file("plan.mcap")?;
        let measured = self.file("measured.mcap");
        let page = self.setup.page(&plan, measured.as_deref(), Extent::Whole);
        Some(page.and_then(|page| Ok(page.html()?)))
    }
}

fn not_running(state: &DispatcherState) -> Result<(), String> {
    match state.running {
        Some(_) => Err("a run is under way: wait for its end, or stop it".into()),
        None => Ok(()),
    }
}
