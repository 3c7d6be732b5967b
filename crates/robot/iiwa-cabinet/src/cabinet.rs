//! A simulated Sunrise cabinet: the controller with its FRI connection, and the robot program that
//! carries out iiwaDrive instructions (Larsen 2019, section 3.1.1).
//!
//! | thread | task |
//! |---|---|
//! | clock | moves the robot and sends an FRI message every cycle |
//! | FRI | receives the FRI client's answers |
//! | instructions | receives instructions on a REP socket and acknowledges them |
//! | planner | plans motions |
//! | state | sends state changes to iiwaDrive until they are acknowledged |

use std::{
    sync::{
        Arc, Mutex,
        atomic::{AtomicBool, Ordering},
        mpsc,
    },
    time::Duration,
};

use iiwa_fri::{ControllerConfig, Format};
use iiwa_kin::Joints;
use iiwa_link::{
    LinkError,
    message::MAX_MOTIONS_BYTES,
    socket::{SHORT_MESSAGE_BYTES, Server, random_id},
    threads::ThreadGroup,
    transport::{Event, ListenerConfig, SocketKind},
};

use crate::{
    config::{CabinetConfig, Faults},
    faulty_link::FaultyLink,
    fri,
    position_sensors::PositionSensors,
    program::{self, ProgramInput},
    report::ConnectionReport,
    shared::{CabinetState, lock},
    simulation::{EMERGENCY_STOP_HELD_S, Simulation},
    torque_sensors::TorqueSensors,
};

/// A running simulated cabinet. Dropping it shuts it down.
///
/// ```
/// use iiwa_cabinet::{Cabinet, CabinetConfig};
/// use iiwa_link::Server;
///
/// let mut config = CabinetConfig::default();
/// config.start_rad = [0.1; 7];
/// config.instructions = "tcp://127.0.0.1:*".into();
/// config.state = "tcp://127.0.0.1:*".into();
/// let cabinet = Cabinet::start(config, &Server::open())?;
/// assert_eq!(cabinet.position(), [0.1; 7]);
/// # Ok::<(), iiwa_link::LinkError>(())
/// ```
#[derive(Debug)]
pub struct Cabinet {
    shared: Arc<CabinetState>,
    instructions: String,
    state: String,
    _threads: ThreadGroup,
}

impl Cabinet {
    /// Starts a cabinet.
    ///
    /// # Errors
    ///
    /// An address is invalid, requires keys or cannot be bound, the initial position is outside the
    /// joint ranges, a signal is unknown, or a thread cannot be started.
    pub fn start(config: CabinetConfig, security: &Server) -> Result<Self, LinkError> {
        config.robot.limits().check(&config.start_rad).map_err(|outside| LinkError::Config {
            message: format!("start position: {outside}"),
        })?;
        let (inputs, inputs_in) = mpsc::channel();
        let instructions = {
            let max_bytes = MAX_MOTIONS_BYTES + SHORT_MESSAGE_BYTES;
            let socket = ListenerConfig::new("cabinet requests", SocketKind::Rep, max_bytes);
            let inputs = inputs.clone();
            security.listen(&config.instructions, socket, move |event| {
                // The receiver outlives the socket.
                let _ = inputs.send(ProgramInput::Socket(event));
            })?
        };
        let acknowledged = Arc::new(AtomicBool::new(false));
        let state = {
            // Without a backlog, because only the latest state matters.
            let socket =
                ListenerConfig::new("cabinet state", SocketKind::Dealer, SHORT_MESSAGE_BYTES);
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
        let mut simulation = Simulation::new(config.robot, config.start_rad, fri, random_id());
        simulation.position_sensors = PositionSensors::new(
            f64::from(config.period_ms) * 1e-3,
            config.lag_s,
            config.vibration_rad,
            config.noise_rad,
        );
        simulation.torque_sensors =
            TorqueSensors::new(&robot, config.load, config.mount, config.torque_noise_nm);
        if config.without_times {
            simulation.leave_out_times();
        }
        for (name, value) in &config.signals {
            simulation
                .set_signal(name, *value)
                .map_err(|refusal| LinkError::Config { message: refusal.message })?;
        }
        simulation.press_emergency_stop_at(config.faults.emergency_stop_at);
        let period =
            Duration::from_millis(u64::from(config.period_ms)).div_f64(config.speed.max(1e-3));
        let shared = Arc::new(CabinetState {
            simulation: Mutex::new(simulation),
            link: Mutex::new(FaultyLink::new(config.faults, period)),
        });
        let client = config.fri_client;
        let addresses = [instructions.address(), state.address()].map(str::to_owned);
        let mut threads = ThreadGroup::default();
        let robot_state = Arc::clone(&shared);
        threads.spawn("cabinet clock", move |shutdown| {
            fri::run_clock(&robot_state, &udp, client, period, shutdown);
        })?;
        let robot_state = Arc::clone(&shared);
        threads.spawn("cabinet FRI", move |shutdown| {
            fri::receive_answers(&robot_state, &answers, client, shutdown);
        })?;
        let (jobs, jobs_in) = mpsc::channel();
        // This thread ends with the instruction thread, which sends its jobs.
        threads.spawn("cabinet planner", move |_| {
            program::plan_motions(&robot, &jobs_in, |planned| {
                let _ = inputs.send(ProgramInput::Planned(planned));
            });
        })?;
        let robot_state = Arc::clone(&shared);
        threads.spawn("cabinet instructions", move |shutdown| {
            program::RobotProgram::new(&robot_state, instructions, jobs).run(&inputs_in, shutdown);
        })?;
        let robot_state = Arc::clone(&shared);
        threads.spawn("cabinet state", move |shutdown| {
            program::send_states(&robot_state, &state, &acknowledged, shutdown);
        })?;
        let [instructions, state] = addresses;
        Ok(Self { shared, instructions, state, _threads: threads })
    }

    /// Returns the bound address for instructions, such as `tcp://127.0.0.1:30001`.
    #[must_use]
    pub fn instructions(&self) -> &str {
        &self.instructions
    }

    /// Returns the bound address for state changes.
    #[must_use]
    pub fn state(&self) -> &str {
        &self.state
    }

    /// Sets the simulated faults.
    pub fn set_faults(&self, faults: Faults) {
        lock(&self.shared.link).faults = faults;
        lock(&self.shared.simulation).press_emergency_stop_at(faults.emergency_stop_at);
    }

    /// Drops all FRI datagrams for `duration`.
    pub fn silence(&self, duration: Duration) {
        lock(&self.shared.link).silence(duration);
    }

    /// Presses the emergency stop for two seconds of controller time.
    pub fn press_emergency_stop(&self) {
        lock(&self.shared.simulation).press_emergency_stop(EMERGENCY_STOP_HELD_S);
    }

    /// Drops the FRI session, which opens again after a number of seconds of controller time.
    pub fn drop_session(&self, seconds: f64) {
        lock(&self.shared.simulation).drop_session(seconds);
    }

    /// Returns the current joint positions, in rad.
    #[must_use]
    pub fn position(&self) -> Joints {
        *lock(&self.shared.simulation).position()
    }

    /// Returns the statistics of the FRI connection so far.
    #[must_use]
    pub fn report(&self) -> ConnectionReport {
        let (session, quality) = {
            let mut simulation = lock(&self.shared.simulation);
            (simulation.fri().state(), simulation.fri().quality())
        };
        let link = lock(&self.shared.link);
        ConnectionReport {
            cycles: link.cycles,
            delayed_cycles: link.delayed_cycles,
            real_time: link.real_time,
            latency: link.monitor.latency().clone(),
            late: link.monitor.late().to_vec(),
            unanswered: link.monitor.unanswered(),
            session,
            quality,
        }
    }
}
