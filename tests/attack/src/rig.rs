//! System under attack: a cabinet, a drive and optionally a twin, with a witness between the first
//! two.

use std::{
    error::Error,
    fs, io,
    net::SocketAddr,
    path::{Path, PathBuf},
    thread,
    time::{Duration, Instant},
};

use serde_json::Value;
use tempfile::TempDir;

use super::{process::Process, request::request, websocket::WebSocket, witness::Witness};
use iiwasim_tests::ports::free_address;

/// Failure of the harness itself.
pub(super) type Fault = Box<dyn Error + Send + Sync>;

/// Time-out of starting and connecting the programs.
const READY_TIMEOUT: Duration = Duration::from_secs(10);

/// Limit of open files of each program: the usual limit of a login.
const FILES: u32 = 1024;

/// The lowest limit of open files with which the programs start.
const FEW_FILES: u32 = 192;

/// Optional parts of the rig.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Parts {
    pub(super) twin: bool,
    pub(super) keys: bool,
    /// `true` for a low limit of open files in the drive and the cabinet.
    pub(super) few_files: bool,
}

/// Programs and their addresses.
pub(super) struct Rig {
    pub(super) witness: Witness,
    pub(super) cabinet: Option<Process>,
    pub(super) drive: Option<Process>,
    pub(super) twin: Option<Process>,
    pub(super) addresses: Addresses,
    /// Address of the page, with its token.
    pub(super) page: String,
    pub(super) folder: TempDir,
    binary: PathBuf,
    keys: bool,
    few_files: bool,
}

/// Addresses of the programs.
#[derive(Clone, Copy, Debug)]
pub(super) struct Addresses {
    pub(super) requests: SocketAddr,
    pub(super) stream: SocketAddr,
    pub(super) cabinet_instructions: SocketAddr,
    pub(super) cabinet_state: SocketAddr,
    pub(super) fri: SocketAddr,
    pub(super) twin: SocketAddr,
}

impl Addresses {
    /// All TCP ports.
    pub(super) fn ports(&self) -> [SocketAddr; 5] {
        let Self { requests, stream, cabinet_instructions, cabinet_state, twin, .. } = *self;
        [requests, stream, cabinet_instructions, cabinet_state, twin]
    }
}

impl Rig {
    /// Starts the programs and waits until they are ready.
    pub(super) fn start(binary: &Path, parts: Parts) -> Result<Self, Fault> {
        let mut rig = Self::new(binary, parts)?;
        if parts.keys {
            rig.make_keys()?;
        }
        rig.start_cabinet()?;
        rig.start_drive()?;
        rig.await_ready()?;
        if parts.twin {
            rig.start_twin()?;
        }
        Ok(rig)
    }

    /// Creates a rig without running programs.
    pub(super) fn new(binary: &Path, parts: Parts) -> Result<Self, Fault> {
        let addresses = Addresses {
            requests: free_address(),
            stream: free_address(),
            cabinet_instructions: free_address(),
            cabinet_state: free_address(),
            fri: free_address(),
            twin: free_address(),
        };
        Ok(Self {
            witness: Witness::start(addresses.fri)?,
            cabinet: None,
            drive: None,
            twin: None,
            addresses,
            page: String::new(),
            folder: TempDir::new()?,
            binary: binary.to_owned(),
            keys: parts.keys,
            few_files: parts.few_files,
        })
    }

    /// Starts a cabinet, with the arm at its default position.
    pub(super) fn start_cabinet(&mut self) -> Result<(), Fault> {
        self.cabinet = None;
        // Waits until messages of the previous cabinet have passed.
        thread::sleep(Duration::from_millis(20));
        self.witness.forget();
        let mut arguments = named(&[
            ("--fri", self.witness.address),
            ("--instructions", self.addresses.cabinet_instructions),
            ("--state", self.addresses.cabinet_state),
        ]);
        if self.keys {
            arguments.extend(self.key_options(&[("--key", "cabinet.key"), ("--allow", "drives")]));
        }
        self.cabinet = Some(self.serve("cabinet", &arguments)?);
        Ok(())
    }

    /// Starts a drive.
    pub(super) fn start_drive(&mut self) -> Result<(), Fault> {
        self.drive = None;
        let mut arguments = named(&[
            ("--instructions", self.addresses.requests),
            ("--stream", self.addresses.stream),
            ("--fri", self.addresses.fri),
        ]);
        for (name, address) in [
            ("--cabinet-instructions", self.addresses.cabinet_instructions),
            ("--cabinet-state", self.addresses.cabinet_state),
        ] {
            arguments.extend([name.to_owned(), address.port().to_string()]);
        }
        if self.keys {
            arguments.extend(self.key_options(&[
                ("--key", "drive.key"),
                ("--allow", "clients"),
                ("--cabinet-key", "cabinet.pub"),
            ]));
        }
        self.drive = Some(self.serve("drive", &arguments)?);
        Ok(())
    }

    fn start_twin(&mut self) -> Result<(), Fault> {
        let mut arguments = vec!["--port".to_owned(), self.addresses.twin.port().to_string()];
        // Prevents use of the user's own positions.
        let positions = self.folder.path().join("positions.json").display().to_string();
        arguments.extend(["--positions".to_owned(), positions]);
        arguments.extend(self.client_options(true));
        let twin = self.serve("twin", &arguments)?;
        self.page = twin
            .lines
            .recv_timeout(READY_TIMEOUT)
            .map_err(|_| format!("the twin prints no address: {}", twin.stderr()))?;
        self.twin = Some(twin);
        Ok(())
    }

    fn serve(&self, command: &str, arguments: &[String]) -> Result<Process, Fault> {
        let arguments: Vec<_> =
            [command].into_iter().chain(arguments.iter().map(String::as_str)).collect();
        let files = if self.few_files && command != "twin" { FEW_FILES } else { FILES };
        Ok(Process::start(&self.binary, &arguments, Some(files))?)
    }

    /// Starts a client command, with the options for its connection.
    pub(super) fn client(&self, command: &[&str], needs_stream: bool) -> Result<Process, Fault> {
        let options = self.client_options(needs_stream);
        let arguments: Vec<_> =
            command.iter().copied().chain(options.iter().map(String::as_str)).collect();
        Ok(Process::start(&self.binary, &arguments, None)?)
    }

    fn client_options(&self, needs_stream: bool) -> Vec<String> {
        let mut options = named(&[("--drive", self.addresses.requests)]);
        if needs_stream {
            options.extend(named(&[("--stream", self.addresses.stream)]));
        }
        if self.keys {
            options
                .extend(self.key_options(&[("--key", "alice.key"), ("--server-key", "drive.pub")]));
        }
        options
    }

    fn key_options(&self, options: &[(&str, &str)]) -> Vec<String> {
        let path = |file: &str| self.folder.path().join(file).display().to_string();
        options.iter().flat_map(|(name, file)| [(*name).to_owned(), path(file)]).collect()
    }

    fn make_keys(&self) -> Result<(), Fault> {
        let folder = self.folder.path();
        for name in ["cabinet", "drive", "alice"] {
            let into = folder.display().to_string();
            let mut keygen =
                Process::start(&self.binary, &["keygen", name, "--output", into.as_str()], None)?;
            if !keygen.wait(READY_TIMEOUT).is_some_and(|ended| ended.success) {
                return Err(format!("cannot make keys: {}", keygen.stderr()).into());
            }
        }
        for (who, list) in [("alice", "clients"), ("drive", "drives")] {
            fs::create_dir_all(folder.join(list))?;
            let public = format!("{who}.pub");
            fs::copy(folder.join(&public), folder.join(list).join(&public))?;
        }
        Ok(())
    }

    /// Returns the status of the drive; `None` if it does not reply.
    pub(super) fn status(&self) -> Option<Value> {
        const TIMEOUT: Duration = Duration::from_secs(3);
        if !self.keys {
            return request(self.addresses.requests, r#"{"type": "state"}"#, TIMEOUT).ok();
        }
        let mut status = self.client(&["status", "--json"], false).ok()?;
        status.wait(TIMEOUT).filter(|ended| ended.success)?;
        let lines: String = status.lines.iter().collect();
        serde_json::from_str(&lines).ok()
    }

    /// Returns true if the programs have keys.
    pub(super) fn has_keys(&self) -> bool {
        self.keys
    }

    /// Returns the reply to a request, without keys.
    pub(super) fn request(&self, body: &str) -> io::Result<Value> {
        request(self.addresses.requests, body, Duration::from_secs(30))
    }

    /// Waits until FRI and the robot program are connected.
    pub(super) fn await_ready(&mut self) -> Result<(), Fault> {
        let since = Instant::now();
        loop {
            if self.status().as_ref().is_some_and(is_ready) {
                return Ok(());
            }
            let ended = [("cabinet", &mut self.cabinet), ("drive", &mut self.drive)]
                .into_iter()
                .find_map(|(name, process)| {
                    let process = process.as_mut()?;
                    (!process.runs()).then(|| format!("the {name} has ended: {}", process.stderr()))
                });
            if let Some(ended) = ended {
                return Err(ended.into());
            }
            if since.elapsed() > READY_TIMEOUT {
                return Err("the drive is not ready in time".into());
            }
            thread::sleep(Duration::from_millis(20));
        }
    }

    /// Waits until no run is active and the arm is at rest, sending stops until then; starts
    /// programs that do not run.
    pub(super) fn await_idle(&mut self) -> Result<(), Fault> {
        const TIMEOUT: Duration = Duration::from_secs(15);
        let since = Instant::now();
        let mut stops = 0;
        loop {
            if !self.cabinet.as_mut().is_some_and(Process::runs) {
                self.start_cabinet()?;
            }
            if !self.drive.as_mut().is_some_and(Process::runs) {
                self.start_drive()?;
            }
            let status = self.status();
            let idle = status
                .as_ref()
                .is_some_and(|status| is_ready(status) && status["state"].as_str() == Some("idle"));
            if idle && self.witness.is_at_rest() {
                return Ok(());
            }
            if since.elapsed() > TIMEOUT {
                return Err(self.describe(status).into());
            }
            if since.elapsed() > Duration::from_secs(stops) {
                stops += 1;
                let mut stop = self.client(&["stop"], false)?;
                stop.wait(Duration::from_secs(8));
            }
            thread::sleep(Duration::from_millis(10));
        }
    }

    /// Restarts cabinet and drive.
    pub(super) fn restart(&mut self) -> Result<(), Fault> {
        self.drive = None;
        self.start_cabinet()?;
        self.start_drive()?;
        self.await_ready()
    }

    fn describe(&self, status: Option<Value>) -> String {
        let stderr = |process: &Option<Process>| process.as_ref().map(Process::stderr);
        format!(
            "the robot does not become idle: status {}, the arm {}; cabinet: {:?}, drive: {:?}",
            status.unwrap_or_default(),
            if self.witness.is_at_rest() { "is at rest" } else { "moves" },
            stderr(&self.cabinet),
            stderr(&self.drive),
        )
    }

    /// Connects like the page of the twin.
    pub(super) fn open_page(&self) -> Result<WebSocket, Fault> {
        let token = self.page.split_once("token=").ok_or("the twin's address has no token")?.1;
        Ok(WebSocket::connect(self.addresses.twin, &format!("/live?token={}", token.trim()))?)
    }
}

fn is_ready(status: &Value) -> bool {
    status["robot_program"].as_str() == Some("connected")
        && matches!(status["fri"]["quality"].as_str(), Some("good" | "excellent"))
}

fn named(options: &[(&str, SocketAddr)]) -> Vec<String> {
    options.iter().flat_map(|(name, address)| [(*name).to_owned(), address.to_string()]).collect()
}
