//! A simulated Sunrise cabinet: the controller with its FRI connection, and the robot program that
//! takes iiwaDrive's instructions (Larsen 2019, section 3.1.1).
//!
//! | thread | what it does |
//! |---|---|
//! | clock | moves the robot and sends a message of FRI every cycle |
//! | FRI | takes the client's answers |
//! | instructions | a REP socket; plans motions with this project's planner |
//! | state | tells iiwaDrive the state, again until it is acknowledged |

mod io;
mod latency;
mod noise;
mod sensors;
mod simulation;

use std::{
    net::{SocketAddr, UdpSocket},
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

use iiwa_kin::{Joints, Robot};

use crate::{
    cabinet::simulation::{EMERGENCY_STOP_HELD_S, Simulation, plan},
    error::LinkError,
    fri::{ControllerConfig, Format, Quality, SessionState},
    message::{MAX_MESSAGE_BYTES, to_json},
    robot_program::{Acknowledgement, Instruction, STATE_EVERY_MS, StateChange},
    socket::{Server, is_timeout, random},
};

pub use latency::{Late, Latency};

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

struct Shared {
    simulation: Mutex<Simulation>,
    network: Mutex<Network>,
    over: AtomicBool,
    /// Up to when nothing gets through, in ms since the start.
    silent_until_ms: AtomicU64,
    started: Instant,
}

impl std::fmt::Debug for Shared {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Shared").field("over", &self.over).finish_non_exhaustive()
    }
}

/// The line to the client: what is on its way, and what has come back.
struct Network {
    faults: Faults,
    random: fastrand::Rng,
    /// Messages of the last cycles, which a delay keeps back.
    kept_back: std::collections::VecDeque<Vec<u8>>,
    cycles: u64,
    held_up: u64,
    real_time: bool,
    latency: latency::Watch,
}

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
        let (instructions, instructions_at) =
            security.bind(zmq::REP, &config.instructions, |socket| {
                socket.set_maxmsgsize(MAX_MESSAGE_BYTES as i64)
            })?;
        let (state, state_at) = security.bind(zmq::DEALER, &config.state, |socket| {
            socket.set_maxmsgsize(1024)?;
            // The newest state counts: old ones need not wait.
            socket.set_sndhwm(1)
        })?;
        let local = match config.fri_client {
            client if client.ip().is_loopback() => SocketAddr::new(client.ip(), 0),
            // FRI has no keys: what else leaves this machine has to have them, at least.
            _ if !security.has_keys() => {
                return Err(LinkError::Config {
                    what: format!(
                        "FRI's client {} is on another machine: that needs keys (--key, --allow)",
                        config.fri_client
                    ),
                });
            }
            SocketAddr::V4(_) => SocketAddr::from((std::net::Ipv4Addr::UNSPECIFIED, 0)),
            SocketAddr::V6(_) => SocketAddr::from((std::net::Ipv6Addr::UNSPECIFIED, 0)),
        };
        let udp = UdpSocket::bind(local)
            .map_err(|source| LinkError::Udp { address: local.to_string(), source })?;
        let answers = udp
            .try_clone()
            .and_then(|answers| {
                answers.set_read_timeout(Some(AWAKE))?;
                Ok(answers)
            })
            .map_err(|source| LinkError::Udp { address: local.to_string(), source })?;

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
            network: Mutex::new(Network {
                faults: config.faults,
                random: fastrand::Rng::with_seed(2),
                kept_back: std::collections::VecDeque::new(),
                cycles: 0,
                held_up: 0,
                real_time: false,
                latency: latency::Watch::new(period),
            }),
            over: AtomicBool::new(false),
            silent_until_ms: AtomicU64::new(0),
            started: Instant::now(),
        });
        let client = config.fri_client;
        let mut cabinet =
            Self { instructions: instructions_at, state: state_at, shared, threads: Vec::new() };
        cabinet.spawn("cabinet clock", move |shared| run_clock(shared, &udp, client, period))?;
        cabinet.spawn("cabinet FRI", move |shared| take_answers(shared, &answers, client))?;
        cabinet.spawn("cabinet instructions", move |shared| {
            take_instructions(shared, &instructions, &robot);
        })?;
        cabinet.spawn("cabinet state", move |shared| tell_state(shared, &state))?;
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
        lock(&self.shared.network).faults = faults;
        lock(&self.shared.simulation).press_emergency_stop_at(faults.emergency_stop_at);
    }

    /// Lets nothing of FRI through for so long.
    pub fn silence(&self, duration: Duration) {
        let until = millis(self.shared.started.elapsed() + duration);
        self.shared.silent_until_ms.store(until, Ordering::Relaxed);
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
        let network = lock(&self.shared.network);
        Report {
            cycles: network.cycles,
            held_up: network.held_up,
            real_time: network.real_time,
            latency: network.latency.latency().clone(),
            late: network.latency.late().to_vec(),
            unanswered: network.latency.unanswered(),
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

/// How often a waiting thread looks whether the cabinet is over.
const AWAKE: Duration = Duration::from_millis(50);
const AWAKE_MS: i64 = 50;

fn millis(duration: Duration) -> u64 {
    u64::try_from(duration.as_millis()).unwrap_or(u64::MAX)
}

impl Shared {
    fn is_over(&self) -> bool {
        self.over.load(Ordering::Relaxed)
    }

    fn is_silent(&self) -> bool {
        millis(self.started.elapsed()) < self.silent_until_ms.load(Ordering::Relaxed)
    }
}

/// The controller's clock: a cycle each `period`. When this machine holds it up for more than that, it
/// waits, as if nothing had been: robot time has no gaps.
fn run_clock(shared: &Shared, udp: &UdpSocket, client: SocketAddr, period: Duration) {
    let real_time = crate::priority::raise();
    lock(&shared.network).real_time = real_time;
    let mut next = Instant::now() + period;
    let mut message = Vec::with_capacity(1500);
    while !shared.is_over() {
        let now = Instant::now();
        if let Some(left) = next.checked_duration_since(now) {
            thread::sleep(left);
        } else if now.duration_since(next) > period {
            next = now;
            lock(&shared.network).held_up += 1;
        }
        next += period;
        let due = lock(&shared.simulation).tick(&mut message);
        let mut network = lock(&shared.network);
        let Some(datagram) = network.send(due.then_some(message.as_slice())) else { continue };
        if !shared.is_silent() {
            network.latency.sent(&datagram, Instant::now());
            drop(network);
            // Nobody may listen yet.
            let _ = udp.send_to(&datagram, client);
        }
    }
}

impl Network {
    /// What leaves the line in this cycle when `message` enters it.
    fn send(&mut self, message: Option<&[u8]>) -> Option<Vec<u8>> {
        self.cycles += u64::from(message.is_some());
        self.kept_back.push_back(message.map(<[u8]>::to_vec).unwrap_or_default());
        if self.kept_back.len() <= self.faults.delay_cycles as usize {
            return None;
        }
        while self.kept_back.len() > self.faults.delay_cycles as usize + 1 {
            self.kept_back.pop_front();
        }
        let datagram = self.kept_back.pop_front().filter(|datagram| !datagram.is_empty())?;
        (!self.loses()).then_some(datagram)
    }

    fn loses(&mut self) -> bool {
        self.faults.packet_loss > 0.0 && self.random.f64() < self.faults.packet_loss
    }
}

fn take_answers(shared: &Shared, udp: &UdpSocket, client: SocketAddr) {
    crate::priority::raise();
    let mut buffer = [0; 2048];
    while !shared.is_over() {
        let (length, from) = match udp.recv_from(&mut buffer) {
            Ok(received) => received,
            Err(error) if is_timeout(&error) => continue,
            Err(error) => {
                tracing::warn!("FRI: {error}");
                thread::sleep(AWAKE);
                continue;
            }
        };
        let now = Instant::now();
        if from.ip() != client.ip() || shared.is_silent() {
            continue;
        }
        let datagram = &buffer[..length];
        {
            let mut network = lock(&shared.network);
            if network.loses() {
                continue;
            }
            network.latency.answered(datagram, now);
        }
        if let Err(error) = lock(&shared.simulation).fri().receive(datagram) {
            tracing::debug!("FRI: {error}");
        }
    }
}

fn take_instructions(shared: &Shared, socket: &zmq::Socket, robot: &Robot) {
    while !shared.is_over() {
        match socket.poll(zmq::POLLIN, AWAKE_MS) {
            Ok(0) => continue,
            Ok(_) => {}
            Err(_) => return,
        }
        let Ok(frames) = socket.recv_multipart(0) else { continue };
        let (seq, instruction) = match frames.as_slice() {
            [body] => Instruction::from_json(body),
            _ => (None, Err(crate::message::Refusal::bad("an instruction is one frame"))),
        };
        let answer = instruction.and_then(|instruction| {
            let planned = match &instruction {
                Instruction::RunMotions { motions, .. } => {
                    let start_rad = {
                        let simulation = lock(&shared.simulation);
                        simulation.check_ready()?;
                        *simulation.position()
                    };
                    Some(plan(robot, start_rad, motions.clone())?)
                }
                _ => None,
            };
            lock(&shared.simulation).carry_out(instruction, planned)
        });
        let answer = answer
            .unwrap_or_else(|error| Acknowledgement { error: Some(error), ..Default::default() });
        let answer = to_json(&Acknowledgement { seq, ..answer });
        if let Err(error) = socket.send(&answer, 0) {
            tracing::warn!("cannot answer an instruction: {error}");
        }
    }
}

/// Tells the state when it changes, again until that is acknowledged, and now and then in any case. The
/// socket speaks as REQ does, but does not get stuck when the other side goes away.
fn tell_state(shared: &Shared, socket: &zmq::Socket) {
    const LOOK_MS: i64 = 2;
    let every = Duration::from_millis(STATE_EVERY_MS);
    let again = Duration::from_millis(100);
    let mut told: Option<(StateChange, Instant)> = None;
    let mut acknowledged = false;
    while !shared.is_over() {
        let change = {
            let mut simulation = lock(&shared.simulation);
            let wait = if acknowledged { every } else { again };
            let due = told.as_ref().is_none_or(|(_, at)| at.elapsed() >= wait);
            simulation.take_change().or_else(|| due.then(|| simulation.state()))
        };
        if let Some(change) = change {
            let text = to_json(&change);
            // Without a peer it is not sent.
            let _ = socket.send_multipart([b"".as_slice(), text.as_bytes()], zmq::DONTWAIT);
            acknowledged = false;
            told = Some((change, Instant::now()));
        }
        if let Ok(1..) = socket.poll(zmq::POLLIN, LOOK_MS) {
            acknowledged |= socket.recv_multipart(zmq::DONTWAIT).is_ok();
        }
    }
}
