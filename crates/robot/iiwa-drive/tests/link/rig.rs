//! A drive and a simulated cabinet on free ports of the loopback interface, with the robot program
//! in Java in between if the environment names it.

use std::{
    ffi::OsString,
    ops::Deref,
    path::PathBuf,
    time::{Duration, Instant},
};

use iiwa_cabinet::{Cabinet, CabinetConfig, Faults};
use iiwa_drive::{Drive, DriveConfig};
use iiwa_link::{
    Client, ClientError, Remote, Server, Stream,
    message::{DriveState, Presence},
};
use iiwasim_tests::{
    child_processes,
    ports::free_address,
    program_process::{ProgramPorts, ProgramProcess, jar},
};

/// Time-out of all waits.
pub(crate) const LONG: Duration = Duration::from_mins(1);

/// Drive and cabinet, each of which may be stopped.
pub(crate) struct Rig {
    pub(crate) cabinet_config: CabinetConfig,
    pub(crate) drive_config: DriveConfig,
    /// The robot program in Java; if `None`, the drive connects to the simulated one.
    pub(crate) jar: Option<PathBuf>,
    /// Further options of the robot program.
    pub(crate) program_options: Vec<OsString>,
    /// Connection security of the drive towards the robot program.
    pub(crate) remote: Remote,
    pub(crate) cabinet: Option<RunningCabinet>,
    pub(crate) drive: Option<Drive>,
}

/// A simulated cabinet, and the robot program in front of it, which ends first.
pub(crate) struct RunningCabinet {
    _program: Option<ProgramProcess>,
    cabinet: Cabinet,
}

impl Deref for RunningCabinet {
    type Target = Cabinet;

    fn deref(&self) -> &Cabinet {
        &self.cabinet
    }
}

/// Returns a free ZeroMQ address.
pub(crate) fn free_tcp() -> String {
    format!("tcp://{}", free_address())
}

impl Rig {
    /// Creates a rig in which neither side is started.
    pub(crate) fn parts(period_ms: u32) -> Self {
        let fri = free_address();
        let [instructions, state] = [free_tcp(), free_tcp()];
        let mut cabinet_config = CabinetConfig::default();
        cabinet_config.period_ms = period_ms;
        cabinet_config.fri_client = fri;
        cabinet_config.instructions.clone_from(&instructions);
        cabinet_config.state.clone_from(&state);
        let mut drive_config = DriveConfig::default();
        drive_config.instructions = free_tcp();
        drive_config.stream = free_tcp();
        drive_config.fri = fri;
        drive_config.cabinet_instructions = instructions;
        drive_config.cabinet_state = state;
        Self {
            cabinet_config,
            drive_config,
            jar: jar(),
            program_options: Vec::new(),
            remote: Remote::open(),
            cabinet: None,
            drive: None,
        }
    }

    /// Creates a rig with both sides started and a good connection.
    pub(crate) fn new(period_ms: u32) -> Self {
        let mut rig = Self::parts(period_ms);
        // No message is lost in this order.
        rig.start_drive();
        rig.start_cabinet();
        rig.wait_until_ready();
        rig
    }

    pub(crate) fn start_cabinet(&mut self) {
        let mut config = self.cabinet_config.clone();
        if self.jar.is_some() {
            // Addresses behind the robot program.
            config.instructions = free_tcp();
            config.state = free_tcp();
        }
        child_processes::await_all();
        let cabinet = Cabinet::start(config, &Server::open()).unwrap();
        let ports = ProgramPorts {
            instructions: self.cabinet_config.instructions.clone(),
            state: self.cabinet_config.state.clone(),
            cabinet_instructions: cabinet.instructions().to_owned(),
            cabinet_state: cabinet.state().to_owned(),
        };
        let start = |jar| ProgramProcess::start(jar, &ports, &self.program_options);
        self.cabinet = Some(RunningCabinet { _program: self.jar.as_ref().map(start), cabinet });
    }

    pub(crate) fn start_drive(&mut self) {
        // The previous drive may have used the same ports.
        child_processes::await_all();
        let drive = Drive::start(self.drive_config.clone(), &Server::open(), &self.remote).unwrap();
        self.drive = Some(drive);
    }

    pub(crate) fn cabinet(&self) -> &Cabinet {
        self.cabinet.as_ref().unwrap()
    }

    pub(crate) fn client(&self) -> Client {
        Client::new(&Remote::open(), &self.drive_config.instructions).unwrap()
    }

    pub(crate) fn stream(&self) -> Stream {
        Stream::new(&Remote::open(), &self.drive_config.stream).unwrap()
    }

    /// Waits until FRI is ready for commanding and the robot program is connected.
    pub(crate) fn wait_until_ready(&self) {
        let mut client = self.client();
        wait_for("a good connection", || {
            let status = client.state().unwrap();
            let ready = status.fri.session == "monitoring_ready"
                && ["good", "excellent"].contains(&status.fri.quality.as_str());
            let is_connected = status.robot_program == Presence::Connected;
            ready && is_connected && status.state == DriveState::Idle
        });
    }

    /// Stops the robot, through a new client. On a busy machine, the simulated robot program may
    /// report late; the drive then answers that it does not know whether the arm is at rest.
    pub(crate) fn stop(&self) {
        wait_for("answer of the robot program to a stop", || match self.client().stop() {
            Ok(()) => true,
            Err(ClientError::Refused { refusal, .. })
                if refusal.message.starts_with("the robot program does not answer") =>
            {
                false
            }
            Err(error) => panic!("{error}"),
        });
    }

    pub(crate) fn set_faults(&self, faults: Faults) {
        self.cabinet().set_faults(faults);
    }
}

/// Polls a condition.
pub(crate) fn wait_for(event: &str, mut holds: impl FnMut() -> bool) {
    let since = Instant::now();
    while !holds() {
        assert!(since.elapsed() < LONG, "no {event} within {LONG:?}");
        std::thread::sleep(Duration::from_millis(10));
    }
}
