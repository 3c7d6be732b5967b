//! What people do with the robot: positions, a plan, a run.

use std::{
    path::PathBuf,
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    thread::{self, JoinHandle},
};

use iiwa_kin::Joints;
use iiwa_path::{Blend, Motion, Program, Ptp};
use iiwa_view::Extent;
use serde::Serialize;
use tokio::runtime::Handle;

use crate::failure::Failure;

use super::{
    Live, Setup, Words,
    order::Order,
    planned::Planned,
    run::{ProgramRun, RunOutcome},
    stop::Stopper,
    word,
};

/// Keeps what people do, and carries out their orders.
pub(crate) struct Desk {
    setup: Arc<Setup>,
    live: Arc<Live>,
    state: Mutex<DeskState>,
    stopper: Stopper,
    pub(super) positions: Words,
    pub(super) plan: Words,
    pub(super) run: Words,
}

#[derive(Default)]
struct DeskState {
    positions: Vec<Position>,
    /// How many were saved so far.
    saved: u64,
    plans: u64,
    plan: Option<Arc<Planned>>,
    running: Option<Running>,
    /// How often a stop was asked for: what was sent before that does not begin.
    stops: u64,
    /// Whether the twin ends: nothing begins any more.
    ends: bool,
    /// What the robot did with the plan.
    measured: Option<PathBuf>,
}

/// A position of the arm that was saved.
#[derive(Clone, Serialize)]
struct Position {
    /// Another one for each: places in the list change while others look at it.
    id: u64,
    name: String,
    joints_rad: Joints,
}

struct Running {
    thread: JoinHandle<()>,
    stopped: Arc<AtomicBool>,
}

/// Positions at most.
const POSITIONS: usize = 1000;

impl Desk {
    pub(crate) fn new(setup: Arc<Setup>, live: Arc<Live>) -> Self {
        let nothing = |kind| Words::new(word(kind, &None::<()>));
        Self {
            stopper: Stopper::new(&setup),
            setup,
            live,
            state: Mutex::default(),
            positions: Words::new(word("positions", &[(); 0])),
            plan: nothing("plan"),
            run: nothing("run"),
        }
    }

    fn state(&self) -> MutexGuard<'_, DeskState> {
        // What is kept is whole at any time.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Carries out an order. Errors are for people.
    pub(super) fn carry_out(self: &Arc<Self>, order: Order) -> Result<(), String> {
        match order {
            Order::SavePosition { name } => self.save_position(&name),
            Order::RemovePosition { position } => {
                let mut state = self.state();
                state.positions.retain(|kept| kept.id != position);
                self.tell_positions(&state);
                Ok(())
            }
            Order::MakeProgram { velocity_percent, blend_mm } => {
                let text = self.program_of_positions(velocity_percent, blend_mm)?;
                self.load("positions.json", text)
            }
            Order::ClearProgram => {
                let mut state = self.state();
                not_running(&state)?;
                state.plan = None;
                self.discard_run(&mut state);
                self.plan.send_replace(word("plan", &None::<()>));
                Ok(())
            }
            Order::Send { plan, move_to_start } => self.send(plan, move_to_start),
            Order::Stop => Handle::current().block_on(self.stop()),
            Order::SetIo { name, value } => {
                let mut client = self.setup.client().map_err(|failure| failure.what())?;
                client.set_io(&name, value).map(drop).map_err(|error| error.to_string())
            }
        }
    }

    fn save_position(&self, name: &str) -> Result<(), String> {
        let Some(joints_rad) = self.live.now() else {
            return Err("it is not known where the robot is: nothing comes from the drive".into());
        };
        let mut state = self.state();
        let count = state.positions.len();
        if count >= POSITIONS {
            return Err(format!("{POSITIONS} positions are all that is kept"));
        }
        let name = match name.trim() {
            "" => format!("P{}", count + 1),
            name => name.chars().take(100).collect(),
        };
        state.saved += 1;
        let id = state.saved;
        state.positions.push(Position { id, name, joints_rad });
        self.tell_positions(&state);
        Ok(())
    }

    fn tell_positions(&self, state: &DeskState) {
        self.positions.send_replace(word("positions", &state.positions));
    }

    fn program_of_positions(&self, velocity_percent: f64, blend_mm: f64) -> Result<String, String> {
        let velocity_rel = velocity_percent / 100.0;
        if !(velocity_rel > 0.0 && velocity_rel <= 1.0) {
            return Err(format!("a velocity is above 0 and up to 100 %, not {velocity_percent}"));
        }
        if !(0.0..=1e4).contains(&blend_mm) {
            return Err(format!("a blend's radius is from 0 to 10000 mm, not {blend_mm}"));
        }
        let state = self.state();
        let [start, targets @ .., last] = state.positions.as_slice() else {
            return Err("a program needs two positions: where it starts, and where it goes".into());
        };
        let ptp = |to: &Position| Ptp::to(to.joints_rad).velocity(velocity_rel);
        let blended =
            |ptp: Ptp| if blend_mm > 0.0 { ptp.blend(Blend::CartMm(blend_mm)) } else { ptp };
        let inner = targets.iter().map(|to| blended(ptp(to)));
        let motions = inner.chain([ptp(last)]).map(Motion::Ptp).collect();
        let robot = Some(self.setup.robot.name().to_owned());
        Ok(Program { robot, start_rad: start.joints_rad, motions }.to_json())
    }

    /// Plans a program and shows it. Errors are for people.
    pub(super) fn load(&self, name: &str, text: String) -> Result<(), String> {
        let id = {
            let mut state = self.state();
            not_running(&state)?;
            state.plans += 1;
            state.plans
        };
        // This may take a while, and nothing waits for it.
        let plan = Planned::new(id, name, text, &self.setup)?;
        let mut state = self.state();
        not_running(&state)?;
        // A later one may have been faster.
        if state.plan.as_ref().is_none_or(|shown| shown.id < id) {
            self.plan.send_replace(plan.word.clone());
            state.plan = Some(Arc::new(plan));
            self.discard_run(&mut state);
        }
        Ok(())
    }

    fn discard_run(&self, state: &mut DeskState) {
        state.measured = None;
        self.run.send_replace(word("run", &None::<()>));
    }

    fn send(self: &Arc<Self>, id: u64, move_to_start: bool) -> Result<(), String> {
        let shown = |state: &DeskState| {
            not_running(state)?;
            let plan = state.plan.clone().filter(|plan| plan.id == id);
            plan.ok_or("this is not the plan that is shown now: look at it again".to_owned())
        };
        let (plan, stops) = {
            let state = self.state();
            (shown(&state)?, state.stops)
        };
        // The drive is asked meanwhile: a stop must not wait for that.
        let run = ProgramRun::new(plan, move_to_start, &self.setup)?;
        let mut state = self.state();
        shown(&state)?;
        if state.stops != stops || state.ends {
            return Err("the program is not sent: the robot was to be stopped meanwhile".into());
        }
        self.discard_run(&mut state);
        let stopped = run.stopped();
        let desk = self.clone();
        let thread = thread::spawn(move || {
            let RunOutcome { word, mcap } =
                run.carry_out(&desk.setup, |word| drop(desk.run.send_replace(word)));
            let mut state = desk.state();
            state.measured = mcap;
            state.running = None;
            desk.run.send_replace(word);
        });
        state.running = Some(Running { thread, stopped });
        Ok(())
    }

    /// Has the robot stop, whatever client made it move, and nothing begin that was sent before. The answer comes
    /// when the drive has given it.
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

    /// Stops a run that was begun here, and waits until it has ended.
    pub(crate) fn end(&self) {
        let running = {
            let mut state = self.state();
            state.ends = true;
            state.running.take()
        };
        let Some(Running { thread, stopped }) = running else { return };
        stopped.store(true, Ordering::Relaxed);
        // Notify the page that asked for the run.
        if let Ok(mut client) = self.setup.client()
            && client.stop().is_ok()
        {
            let _ = thread.join();
        }
    }

    /// The files of the plan: the program, the plan, and what the robot did.
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

    /// The page that `iiwasim report` makes of the plan and of what the robot did.
    pub(super) fn report(&self) -> Option<Result<String, Failure>> {
        let plan = self.file("plan.mcap")?;
        let measured = self.file("measured.mcap");
        let page = self.setup.page(&plan, measured.as_deref(), Extent::Whole);
        Some(page.and_then(|page| Ok(page.html()?)))
    }
}

fn not_running(state: &DeskState) -> Result<(), String> {
    match state.running {
        Some(_) => Err("a run is under way: wait for its end, or stop it".into()),
        None => Ok(()),
    }
}
