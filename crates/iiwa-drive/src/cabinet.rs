//! A simulated Sunrise cabinet: the controller with its FRI connection, and the robot program that
//! takes iiwaDrive's instructions (Larsen 2019, section 3.1.1).
//!
//! | thread | what it does |
//! |---|---|
//! | clock | moves the robot and sends a message of FRI every cycle |
//! | FRI | takes the client's answers |
//! | instructions | takes instructions on a REP socket, and acknowledges them |
//! | planner | plans motions with this project's planner |
//! | state | tells iiwaDrive the state, again until it is acknowledged |

mod fri;
mod io;
mod latency;
mod line;
mod noise;
mod program;
mod sensors;
mod simulation;

use std::{
    net::SocketAddr,
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, Ordering},
        mpsc,
    },
    thread::{self, JoinHandle},
    time::Duration,
};

use iiwa_fri::{ControllerConfig, Format, Quality, SessionState};
use iiwa_kin::{Joints, Robot};
use iiwa_link::{
    LinkError,
    message::MAX_MOTIONS_BYTES,
    socket::{SHORT_MESSAGE_BYTES, Server, random},
    transport::{Event, Kind, ListenerConfig},
};
pub use latency::{Late, Latency};

use crate::cabinet::{
    line::Line,
    program::Input,
    simulation::{EMERGENCY_STOP_HELD_S, Simulation},
};

/// What is simulated, and where.
#[derive(Clone, Debug)]
pub struct CabinetConfig {
    /// The robot.
    pub robot: Robot,
    /// Where the arm stands first, in rad.
    pub start_rad: Joints,
    /// Time from one message of FRI to the next, in ms: 1 to 100, and 1 to 10 for commanding.
    pub period_ms: u32,
    /// Every how many messages an answer is expected.
    pub receive_multiplier: u32,
    /// How many times as fast as real time the controller's clock goes.
    pub speed: f64,
    /// Standard deviation of measured joint positions, in rad.
    pub noise_rad: f64,
    /// Where the client of FRI listens.
    pub fri_client: SocketAddr,
    /// Where the instruction socket is bound.
    pub instructions: String,
    /// Where the state socket is bound.
    pub state: String,
    /// What goes wrong.
    pub faults: Faults,
}

impl Default for CabinetConfig {
    fn default() -> Self {
        Self {
            robot: Robot::default(),
            start_rad: [0.0; 7],
            period_ms: 5,
            receive_multiplier: 1,
            speed: 1.0,
            noise_rad: 0.0,
            fri_client: SocketAddr::from(([127, 0, 0, 1], crate::FRI_PORT)),
            instructions: format!("tcp://127.0.0.1:{}", crate::CABINET_INSTRUCTIONS_PORT),
            state: format!("tcp://127.0.0.1:{}", crate::CABINET_STATE_PORT),
            faults: Faults::default(),
        }
    }
}

/// What goes wrong in the simulation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Faults {
    /// Share of FRI's datagrams that get lost, in either direction, 0 to 1.
    pub packet_loss: f64,
    /// How late messages of FRI are, in whole cycles.
    pub delay_cycles: u32,
    /// Presses the emergency stop for two seconds once a motion has run this share of its time.
    pub emergency_stop_at: Option<f64>,
}

/// A running cabinet. It ends when it is dropped.
#[derive(Debug)]
pub struct Cabinet {
    shared: Arc<Shared>,
    instructions: String,
    state: String,
    threads: Vec<JoinHandle<()>>,
}

/// How the connection has been, as the controller sees it.
#[derive(Clone, Debug)]
pub struct Report {
    /// Messages sent.
    pub cycles: u64,
    /// Cycles in which this simulation was not on time itself, and waited with its clock.
    pub held_up: u64,
    /// Whether the system lets the simulation's clock run ahead of ordinary threads.
    pub real_time: bool,
    /// From a message to its answer.
    pub latency: Latency,
    /// Answers that came more than a cycle after their messages, the first ten thousand of them.
    pub late: Vec<Late>,
    /// Messages that were never answered: a thousand messages later, there was no answer to them. With a
    /// multiplier above 1 most need none.
    pub unanswered: u64,
    /// The session's state.
    pub session: SessionState,
    /// The connection's quality.
    pub quality: Quality,
}

/// What the threads share.
struct Shared {
    simulation: Mutex<Simulation>,
    line: Mutex<Line>,
    over: AtomicBool,
}

impl std::fmt::Debug for Shared {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Shared").field("over", &self.over).finish_non_exhaustive()
    }
}

impl Shared {
    fn is_over(&self) -> bool {
        self.over.load(Ordering::Relaxed)
    }
}

/// How often a waiting thread looks whether the cabinet is over.
const AWAKE: Duration = Duration::from_millis(50);

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    // A thread that panicked has left numbers, nothing half-done.
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Cabinet {
    /// Starts a cabinet.
    ///
    /// # Errors
    ///
    /// If an address cannot be bound, or if the configuration makes no sense.
    pub fn start(config: CabinetConfig, security: &Server) -> Result<Self, LinkError> {
        if let Some(j) = config.robot.limits().outside(&config.start_rad) {
            return Err(LinkError::Config {
                what: format!(
                    "the arm cannot start with joint {} at {} deg",
                    j + 1,
                    config.start_rad[j].to_degrees()
                ),
            });
        }
        let (asked, instructions_in) = mpsc::channel();
        let instructions = {
            let socket = ListenerConfig {
                name: "cabinet requests",
                kind: Kind::Rep,
                most_bytes: MAX_MOTIONS_BYTES + SHORT_MESSAGE_BYTES,
                backlog: 0,
            };
            let asked = asked.clone();
            security.listen(&config.instructions, socket, move |event| {
                // The other end goes away last.
                let _ = asked.send(Input::Socket(event));
            })?
        };
        let acknowledged = Arc::new(AtomicBool::new(false));
        let state = {
            let socket = ListenerConfig {
                name: "cabinet state",
                kind: Kind::Dealer,
                most_bytes: SHORT_MESSAGE_BYTES,
                // The newest state counts.
                backlog: 0,
            };
            let acknowledged = acknowledged.clone();
            security.listen(&config.state, socket, move |event| {
                if matches!(event, Event::Message(..)) {
                    acknowledged.store(true, Ordering::Relaxed);
                }
            })?
        };
        let [udp, answers] = fri::sockets(config.fri_client, security)?;
        let fri = ControllerConfig {
            period_ms: config.period_ms,
            receive_multiplier: config.receive_multiplier,
            format: Format::V1,
        };
        let robot = config.robot.clone();
        let mut simulation =
            Simulation::new(config.robot, config.start_rad, fri, config.noise_rad, random());
        simulation.press_emergency_stop_at(config.faults.emergency_stop_at);
        let period =
            Duration::from_millis(u64::from(config.period_ms)).div_f64(config.speed.max(1e-3));
        let shared = Arc::new(Shared {
            simulation: Mutex::new(simulation),
            line: Mutex::new(Line::new(config.faults, period)),
            over: AtomicBool::new(false),
        });
        let client = config.fri_client;
        let mut cabinet = Self {
            instructions: instructions.at().to_owned(),
            state: state.at().to_owned(),
            shared,
            threads: Vec::new(),
        };
        cabinet
            .spawn("cabinet clock", move |shared| fri::run_clock(shared, &udp, client, period))?;
        cabinet.spawn("cabinet FRI", move |shared| fri::take_answers(shared, &answers, client))?;
        let (jobs, jobs_in) = mpsc::channel();
        cabinet.spawn("cabinet planner", move |_| {
            program::plan_motions(&robot, &jobs_in, |planned| {
                let _ = asked.send(Input::Planned(planned));
            });
        })?;
        cabinet.spawn("cabinet instructions", move |shared| {
            program::Program::new(shared, instructions, jobs).run(&instructions_in);
        })?;
        cabinet.spawn("cabinet state", move |shared| {
            program::tell_state(shared, &state, &acknowledged);
        })?;
        Ok(cabinet)
    }

    fn spawn(
        &mut self,
        name: &str,
        work: impl FnOnce(&Shared) + Send + 'static,
    ) -> Result<(), LinkError> {
        let shared = Arc::clone(&self.shared);
        let thread = thread::Builder::new().name(name.to_owned()).spawn(move || work(&shared));
        self.threads.push(thread.map_err(|source| LinkError::Thread { source })?);
        Ok(())
    }

    /// Where instructions are taken.
    #[must_use]
    pub fn instructions(&self) -> &str {
        &self.instructions
    }

    /// Where state changes come from.
    #[must_use]
    pub fn state(&self) -> &str {
        &self.state
    }

    /// Changes what goes wrong.
    pub fn set_faults(&self, faults: Faults) {
        lock(&self.shared.line).faults = faults;
        lock(&self.shared.simulation).press_emergency_stop_at(faults.emergency_stop_at);
    }

    /// Lets nothing of FRI through for so long.
    pub fn silence(&self, duration: Duration) {
        lock(&self.shared.line).silence(duration);
    }

    /// Presses the emergency stop for two seconds of the controller's time.
    pub fn press_emergency_stop(&self) {
        lock(&self.shared.simulation).press_emergency_stop(EMERGENCY_STOP_HELD_S);
    }

    /// Ends the session of FRI; after so many seconds of the controller's time it is opened again.
    pub fn drop_session(&self, seconds: f64) {
        lock(&self.shared.simulation).drop_session(seconds);
    }

    /// Where the arm is, in rad.
    #[must_use]
    pub fn position(&self) -> Joints {
        *lock(&self.shared.simulation).position()
    }

    /// How the connection has been so far.
    #[must_use]
    pub fn report(&self) -> Report {
        let (session, quality) = {
            let mut simulation = lock(&self.shared.simulation);
            (simulation.fri().state(), simulation.fri().quality())
        };
        let line = lock(&self.shared.line);
        Report {
            cycles: line.cycles,
            held_up: line.held_up,
            real_time: line.real_time,
            latency: line.watch.latency().clone(),
            late: line.watch.late().to_vec(),
            unanswered: line.watch.unanswered(),
            session,
            quality,
        }
    }
}

impl Drop for Cabinet {
    fn drop(&mut self) {
        self.shared.over.store(true, Ordering::Relaxed);
        for thread in self.threads.drain(..) {
            let _ = thread.join();
        }
    }
}
