//! Carries out the requests of pages: saved positions, a plan, a run.

use std::{
    path::PathBuf,
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    thread::{self, JoinHandle},
};

use iiwa_kin::Joints;
use iiwa_program::{Blend, Motion, Program, Ptp, Start, Workcell};
use iiwa_view::Extent;
use serde::Serialize;
use tokio::runtime::Handle;

use crate::failure::Failure;

use super::{
    LatestJoints, PageChannel, Setup,
    message::page_message,
    planned::Planned,
    request::PageRequest,
    run::{ProgramRun, RunOutcome},
    stop::Stopper,
};

/// Carries out requests, and holds saved positions, the plan and the run.
pub(crate) struct Dispatcher {
    setup: Arc<Setup>,
    live: Arc<LatestJoints>,
    state: Mutex<DispatcherState>,
    stopper: Stopper,
    pub(super) positions: PageChannel,
    pub(super) plan: PageChannel,
    pub(super) run: PageChannel,
}

#[derive(Default)]
struct DispatcherState {
    positions: Vec<Position>,
    /// Number of positions saved since the start, of which ids are made.
    saved: u64,
    plans: u64,
    plan: Option<Arc<Planned>>,
    running: Option<Running>,
    /// Number of stops requested: a run that was requested before the last one does not start.
    stops: u64,
    /// Whether the twin is shutting down: no run starts any more.
    shutting_down: bool,
    /// Recording of the run of this plan.
    measured: Option<PathBuf>,
}

/// A saved position of the arm.
#[derive(Clone, Serialize)]
struct Position {
    /// Unique, unlike indices, which change while other pages show the list.
    id: u64,
    name: String,
    joints_rad: Joints,
}

struct Running {
    thread: JoinHandle<()>,
    stopped: Arc<AtomicBool>,
}

/// Number of positions that are kept, at most.
const MAX_POSITIONS: usize = 1000;

impl Dispatcher {
    pub(crate) fn new(setup: Arc<Setup>, live: Arc<LatestJoints>) -> Self {
        let nothing = |kind| PageChannel::new(page_message(kind, &None::<()>));
        Self {
            stopper: Stopper::new(&setup),
            setup,
            live,
            state: Mutex::default(),
            positions: PageChannel::new(page_message("positions", &[(); 0])),
            plan: nothing("plan"),
            run: nothing("run"),
        }
    }

    fn state(&self) -> MutexGuard<'_, DispatcherState> {
        // The state is consistent whenever the lock is released.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Carries out a request. Errors are shown on the page.
    pub(super) fn carry_out(self: &Arc<Self>, request: PageRequest) -> Result<(), String> {
        match request {
            PageRequest::SavePosition { name } => self.save_position(&name),
            PageRequest::RemovePosition { position } => {
                let mut state = self.state();
                state.positions.retain(|kept| kept.id != position);
                self.publish_positions(&state);
                Ok(())
            }
            PageRequest::MakeProgram { velocity_percent, blend_mm } => {
                let text = self.program_of_positions(velocity_percent, blend_mm)?;
                self.load("positions.json", text)
            }
            PageRequest::ClearProgram => {
                let mut state = self.state();
                not_running(&state)?;
                state.plan = None;
                self.discard_run(&mut state);
                self.plan.send_replace(page_message("plan", &None::<()>));
                Ok(())
            }
            PageRequest::Send { plan, move_to_start } => self.send(plan, move_to_start),
            PageRequest::Stop => Handle::current().block_on(self.stop()),
            PageRequest::SetIo { name, value } => {
                let mut client = self.setup.client().map_err(|failure| failure.what())?;
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
        let mut state = self.state();
        let count = state.positions.len();
        if count >= MAX_POSITIONS {
            return Err(format!(
                "there are {MAX_POSITIONS} positions already, which is the most; remove some first"
            ));
        }
        let name = match name.trim() {
            "" => format!("P{}", count + 1),
            name => name.chars().take(100).collect(),
        };
        state.saved += 1;
        let id = state.saved;
        state.positions.push(Position { id, name, joints_rad });
        self.publish_positions(&state);
        Ok(())
    }

    fn publish_positions(&self, state: &DispatcherState) {
        self.positions.send_replace(page_message("positions", &state.positions));
    }

    fn program_of_positions(&self, velocity_percent: f64, blend_mm: f64) -> Result<String, String> {
        let velocity_rel = velocity_percent / 100.0;
        if !(velocity_rel > 0.0 && velocity_rel <= 1.0) {
            return Err(format!(
                "the velocity is {velocity_percent} %; it has to be above 0 and at most 100 %"
            ));
        }
        if !(0.0..=1e4).contains(&blend_mm) {
            return Err(format!("the blend radius is {blend_mm} mm; it has to be 0 to 10000 mm"));
        }
        let state = self.state();
        let [start, targets @ .., last] = state.positions.as_slice() else {
            return Err("a program needs at least two positions: the start and a target".into());
        };
        let ptp = |to: &Position| Ptp::to(to.joints_rad).velocity(velocity_rel);
        let blended =
            |ptp: Ptp| if blend_mm > 0.0 { ptp.blend(Blend::CartMm(blend_mm)) } else { ptp };
        let inner = targets.iter().map(|to| blended(ptp(to)));
        let motions = inner.chain([ptp(last)]).map(Motion::Ptp).collect();
        let robot = Some(self.setup.robot.name().to_owned());
        Ok(Program {
            robot,
            start: Start::Joints(start.joints_rad),
            motions,
            workcell: Workcell::default(),
        }
        .to_json())
    }

    /// Plans a program and shows it. Errors are shown on the page.
    pub(super) fn load(&self, name: &str, text: String) -> Result<(), String> {
        let id = {
            let mut state = self.state();
            not_running(&state)?;
            state.plans += 1;
            state.plans
        };
        // Planning may take long: the lock is not held meanwhile.
        let plan = Planned::new(id, name, text, &self.setup)?;
        let mut state = self.state();
        not_running(&state)?;
        // A program that was loaded later may have been planned faster.
        if state.plan.as_ref().is_none_or(|shown| shown.id < id) {
            self.plan.send_replace(plan.message.clone());
            state.plan = Some(Arc::new(plan));
            self.discard_run(&mut state);
        }
        Ok(())
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
        // The drive is asked without the lock: a stop must not wait for that.
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
        state.running = Some(Running { thread, stopped });
        Ok(())
    }

    /// Stops the robot, whichever client started the motion, and every run that was requested before. Resolves
    /// to the answer of the drive.
    pub(super) fn stop(&self) -> impl Future<Output = Result<(), String>> + use<> {
        {
            let mut state = self.state();
            state.stops += 1;
            if let Some(running) = &state.running {
                running.stopped.store(true, Ordering::Relaxed);
            }
        }
        self.stopper.stop()
    }

    /// Stops the run that was started here, if any, and waits for its end.
    pub(crate) fn end(&self) {
        let running = {
            let mut state = self.state();
            state.shutting_down = true;
            state.running.take()
        };
        let Some(Running { thread, stopped }) = running else { return };
        stopped.store(true, Ordering::Relaxed);
        if let Ok(mut client) = self.setup.client()
            && client.stop().is_ok()
        {
            let _ = thread.join();
        }
    }

    /// The path of a file of the plan: the program, the plan or the recording of its run.
    pub(super) fn file(&self, name: &str) -> Option<PathBuf> {
        let state = self.state();
        let plan = state.plan.as_ref()?;
        match name {
            "program.json" => Some(plan.mcap.with_extension("json")),
            "plan.mcap" => Some(plan.mcap.clone()),
            "measured.mcap" => state.measured.clone(),
            _ => None,
        }
    }

    /// The page that `iiwasim report` makes of the plan and the recording of its run.
    pub(super) fn report(&self) -> Option<Result<String, Failure>> {
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
