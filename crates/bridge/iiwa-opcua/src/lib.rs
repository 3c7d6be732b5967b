//! Bridged robots as an OPC UA server, according to OPC 40010-1 (OPC UA for Robotics, 1.02).
//!
//! Each robot is a `MotionDeviceSystem` in the `DeviceSet`: a motion device with seven axes, their
//! power trains and the flange load; a controller with its software and a task control; a safety
//! state. Node ids are paths, such as
//! `ns=5;s=cell-1/MotionDevices/Arm/Axes/A1/ParameterSet/ActualPosition`.
//!
//! Unlike the other sinks, the server listens: clients connect with certificates and, unless
//! configured otherwise, user names and passwords. Clients have read access; if permitted, named
//! users can stop robots.
//!
//! Without its feature `server`, the crate is empty, because the server adds two hundred crates.
#![cfg(feature = "server")]

mod arm;
mod certificates;
mod controller;
mod derivatives;
mod error;
mod load;
mod nodesets;
mod options;
mod robots;
mod safety;
mod server;
mod state;
mod stop;
mod task_state;
mod tree;
mod units;
mod users;

use std::{
    net::SocketAddr,
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    time::{Duration, Instant},
};

use iiwa_link::threads::ThreadGroup;

pub use error::OpcUaError;
pub use options::{BridgedArm, OpcUaOptions};
pub use stop::{StopFailure, StopRobot};

use controller::TaskHistory;
use iiwa_bridge::{BridgedRobot, Message, Sink};
use robots::RobotPlan;
use server::RunningServer;
use state::RobotState;

/// Interval between updates of all values.
const UPDATE_EVERY: Duration = Duration::from_millis(50);
/// Interval between checks of the rejected certificates.
const LOOK_EVERY: Duration = Duration::from_secs(2);

/// A robot to publish.
pub struct ServedRobot {
    /// Name of the robot, as in messages.
    pub name: String,
    /// Model and load.
    pub arm: BridgedArm,
    /// Stop callback; `None` if clients may not stop the robot.
    pub stop: Option<Arc<dyn StopRobot>>,
}

/// The OPC UA server. Dropping it ends the server.
pub struct OpcUa {
    robots: Arc<[(String, Mutex<RobotState>)]>,
    address: SocketAddr,
    _threads: ThreadGroup,
}

impl std::fmt::Debug for OpcUa {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("OpcUa").field("address", &self.address).finish_non_exhaustive()
    }
}

impl OpcUa {
    /// Starts the server of these robots. Clients can stop them if `allow_commands`.
    ///
    /// # Errors
    ///
    /// The server cannot listen at the address, a certificate cannot be used, login is impossible
    /// for all clients, or an arm refers to an unknown robot.
    pub fn start(
        options: &OpcUaOptions,
        robots: &[BridgedRobot],
        allow_commands: bool,
    ) -> Result<Self, OpcUaError> {
        let is_known = |name: &String| robots.iter().any(|robot| robot.name() == name);
        if let Some(name) = options.arms.keys().find(|name| !is_known(name)) {
            let message = format!("there is an arm of `{name}`, but no robot of this name");
            return Err(OpcUaError::Settings { message });
        }
        let served = robots.iter().map(|robot| ServedRobot {
            name: robot.name().to_owned(),
            arm: options.arms.get(robot.name()).cloned().unwrap_or_default(),
            stop: allow_commands.then(|| Arc::new(robot.clone()) as Arc<dyn StopRobot>),
        });
        Self::serve(options, served.collect())
    }

    /// Starts the server of robots that may be independent of a bridge; [`OpcUaOptions::arms`] is
    /// not used.
    ///
    /// # Errors
    ///
    /// Same as [`start`](Self::start), and if two robots have the same name.
    pub fn serve(options: &OpcUaOptions, robots: Vec<ServedRobot>) -> Result<Self, OpcUaError> {
        for (i, robot) in robots.iter().enumerate() {
            if robots[..i].iter().any(|other| other.name == robot.name) {
                return Err(OpcUaError::SameName { name: robot.name.clone() });
            }
        }
        let states: Arc<[_]> = robots
            .iter()
            .map(|robot| (robot.name.clone(), Mutex::new(RobotState::unheard_of(robot.arm.load))))
            .collect();
        let plans = robots.into_iter().map(|robot| {
            let ServedRobot { name, arm, stop } = robot;
            RobotPlan { name, model: arm.model, stop }
        });
        let server = RunningServer::start(options, plans.collect())?;
        let address = server.address;
        tracing::info!("OPC UA: listening at {address}");
        let mut threads = ThreadGroup::default();
        let shown = Arc::clone(&states);
        threads.spawn("OPC UA values", move |shutdown| update(server, &shown, shutdown))?;
        Ok(Self { robots: states, address, _threads: threads })
    }

    /// Returns the bound address.
    #[must_use]
    pub fn address(&self) -> SocketAddr {
        self.address
    }
}

impl Sink for OpcUa {
    fn take(&self, message: &Message) {
        let robot = self.robots.iter().find(|(name, _)| *name == message.robot);
        if let Some((_, state)) = robot {
            state.lock().unwrap_or_else(PoisonError::into_inner).take(message);
        }
    }
}

/// Publishes the robot states, and logs rejected clients.
fn update(
    mut server: RunningServer,
    robots: &[(String, Mutex<RobotState>)],
    shutdown: &AtomicBool,
) {
    let mut histories = vec![TaskHistory::default(); robots.len()];
    let mut looked = Instant::now();
    while !shutdown.load(Ordering::Relaxed) {
        let began = Instant::now();
        for (index, (_, state)) in robots.iter().enumerate() {
            // A copy, because feeds must not wait for the following operations.
            let state = state.lock().unwrap_or_else(PoisonError::into_inner).clone();
            let values = server.robots.inner().values(index, &state, &mut histories[index]);
            server.publish(&values);
        }
        if looked.elapsed() >= LOOK_EVERY {
            server.certificates.look_at_rejected();
            looked = Instant::now();
        }
        std::thread::sleep(UPDATE_EVERY.saturating_sub(began.elapsed()));
    }
}
