//! Cabinet and drive as processes, on free ports of the loopback interface, and client commands.

use std::{
    env,
    ffi::OsStr,
    fs::{self, File},
    path::{Path, PathBuf},
    process::{Child, Command, ExitStatus},
    thread,
    time::{Duration, Instant},
};

use assert_cmd::{assert::Assert, cargo::cargo_bin};
use iiwa_log::{JointSample, Recording};
use iiwasim_tests::ports::free_address;
use serde_json::Value;
use tempfile::{TempDir, tempdir};

/// Time limit for any operation.
pub(crate) const LONG: Duration = Duration::from_mins(1);

/// Process that ends when this value is dropped, with files for its output.
pub(crate) struct Process {
    child: Child,
    name: String,
    stdout: PathBuf,
    stderr: PathBuf,
}

/// Result and output of a process.
pub(crate) struct Ended {
    pub(crate) status: ExitStatus,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

impl Process {
    fn start(folder: &Path, program: &OsStr, arguments: &[&str]) -> Self {
        let name = arguments.join(" ");
        let count = fs::read_dir(folder.join("printed")).unwrap().count();
        let file = |kind: &str| folder.join("printed").join(format!("{count}.{kind}"));
        let (stdout, stderr) = (file("stdout"), file("stderr"));
        let child = Command::new(program)
            .current_dir(folder)
            .args(arguments)
            .stdout(File::create(&stdout).unwrap())
            .stderr(File::create(&stderr).unwrap())
            .spawn()
            .unwrap();
        Self { child, name, stdout, stderr }
    }

    /// Sends a signal, such as `INT` or `KILL`.
    pub(crate) fn signal(&self, signal: &str) {
        let id = self.child.id().to_string();
        assert!(Command::new("kill").args(["-s", signal, &id]).status().unwrap().success());
    }

    /// Returns the peak memory of the process, in MB; `None` if the system does not report it.
    fn memory_mb(&self) -> Option<u64> {
        let status = fs::read_to_string(format!("/proc/{}/status", self.child.id())).ok()?;
        let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
        Some(line.trim().strip_suffix(" kB")?.parse::<u64>().ok()? / 1000)
    }

    /// Checks the peak memory, ends the process with an interrupt, and checks its exit code.
    pub(crate) fn interrupt_below(self, memory_mb: u64) {
        let found_mb = self.memory_mb();
        assert!(found_mb.is_none_or(|actual_mb| actual_mb < memory_mb), "{found_mb:?} MB");
        self.signal("INT");
        self.end().code(0);
    }

    pub(crate) fn has_ended(&mut self) -> bool {
        self.child.try_wait().unwrap().is_some()
    }

    /// Waits for the end of the process.
    pub(crate) fn end(mut self) -> Ended {
        wait_for(&format!("end of {}", self.name), || self.has_ended());
        let status = self.child.wait().unwrap();
        Ended { status, stdout: self.stdout(), stderr: self.stderr() }
    }

    pub(crate) fn stdout(&self) -> String {
        fs::read_to_string(&self.stdout).unwrap()
    }

    pub(crate) fn stderr(&self) -> String {
        fs::read_to_string(&self.stderr).unwrap()
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        // The process may have ended.
        let _ = self.child.kill();
        let _ = self.child.wait();
        if thread::panicking() {
            let printed = |path| fs::read_to_string(path).unwrap_or_default();
            eprintln!("{}:\n{}{}", self.name, printed(&self.stdout), printed(&self.stderr));
        }
    }
}

impl Ended {
    /// Fails unless the process exited with this code.
    pub(crate) fn code(self, code: i32) -> Self {
        let Self { status, stdout, stderr } = &self;
        assert_eq!(status.code(), Some(code), "{stdout}{stderr}");
        self
    }
}

/// Both sides, each of which may be missing, and a folder for files.
pub(crate) struct Rig {
    pub(crate) cabinet: Option<Process>,
    pub(crate) drive: Option<Process>,
    pub(crate) instructions: String,
    pub(crate) stream: String,
    pub(crate) fri: String,
    pub(crate) cabinet_instructions: String,
    pub(crate) cabinet_state: String,
    /// Dropped after the processes that write into it.
    folder: TempDir,
}

fn port(address: &str) -> &str {
    address.rsplit(':').next().unwrap()
}

impl Rig {
    /// Creates a rig without running processes.
    pub(crate) fn parts() -> Self {
        let folder = tempdir().unwrap();
        fs::create_dir(folder.path().join("printed")).unwrap();
        Self {
            folder,
            cabinet: None,
            drive: None,
            instructions: free_address().to_string(),
            stream: free_address().to_string(),
            fri: free_address().to_string(),
            cabinet_instructions: free_address().to_string(),
            cabinet_state: free_address().to_string(),
        }
    }

    /// Starts both sides and waits for a good connection.
    pub(crate) fn new() -> Self {
        let mut rig = Self::parts();
        rig.start_cabinet(&[]);
        rig.start_drive(&[]);
        rig.wait_until_ready(&[]);
        rig
    }

    pub(crate) fn start_cabinet(&mut self, options: &[&str]) {
        let instructions = self.cabinet_instructions.clone();
        let mut arguments = vec!["cabinet", "--fri", &self.fri, "--instructions", &instructions];
        arguments.extend(["--state", &self.cabinet_state]);
        arguments.extend(options);
        self.cabinet = Some(self.start(&arguments));
    }

    pub(crate) fn start_drive(&mut self, options: &[&str]) {
        self.drive = Some(self.start(&[&self.drive_arguments()[..], options].concat()));
    }

    /// Starts a drive in a prepared shell.
    pub(crate) fn begin_drive_in(&self, shell: &str) -> Process {
        self.start_in(shell, &self.drive_arguments())
    }

    /// Runs the check of the connection to the cabinet.
    pub(crate) fn check_drive(&self, options: &[&str]) -> Ended {
        self.start(&[&self.drive_arguments()[..], &["--check"], options].concat()).end()
    }

    fn drive_arguments(&self) -> Vec<&str> {
        let mut arguments = vec!["drive", "--fri", &self.fri, "--instructions", &self.instructions];
        arguments.extend(["--stream", &self.stream]);
        arguments.extend(["--cabinet-instructions", port(&self.cabinet_instructions)]);
        arguments.extend(["--cabinet-state", port(&self.cabinet_state)]);
        arguments
    }

    /// Waits until FRI is ready to command, and requests reach the robot program.
    pub(crate) fn wait_until_ready(&self, keys: &[&str]) {
        wait_for("good connection", || {
            let output = self.command("status", &[&["--json"], keys].concat()).output().unwrap();
            output.status.success() && {
                let status = serde_json::from_slice::<Value>(&output.stdout).unwrap();
                let quality = status["fri"]["quality"].as_str().unwrap();
                status["fri"]["session"] == "monitoring_ready"
                    && ["good", "excellent"].contains(&quality)
                    && status["robot_program"] == "connected"
                    && status["state"] == "idle"
            }
        });
    }

    /// Returns the drive addresses that a command needs, and the file of positions.
    fn addresses(&self, command: &str) -> Vec<&str> {
        let (drive, stream) = (["--drive", &self.instructions], ["--stream", &self.stream]);
        match command {
            "record" => stream.to_vec(),
            // Prevents use of the tester's own positions.
            "twin" => [drive, stream, ["--positions", "positions.json"]].concat(),
            "run" | "experiment" => [drive, stream].concat(),
            _ => drive.to_vec(),
        }
    }

    fn command(&self, command: &str, arguments: &[&str]) -> assert_cmd::Command {
        let mut process = assert_cmd::Command::new(cargo_bin!("iiwasim"));
        let addresses = self.addresses(command);
        process.current_dir(&self.folder).arg(command).args(arguments).args(addresses);
        process.timeout(LONG);
        process
    }

    /// Runs a command without addresses.
    pub(crate) fn iiwasim_alone(&self, arguments: &[&str]) -> Assert {
        let mut process = assert_cmd::Command::new(cargo_bin!("iiwasim"));
        process.current_dir(&self.folder).args(arguments).timeout(LONG).assert()
    }

    /// Writes the addresses into a settings file.
    pub(crate) fn write_settings(&self, name: &str) {
        let Self { instructions, stream, .. } = self;
        let text = format!("drive = \"{instructions}\"\nstream = \"{stream}\"\n");
        fs::write(self.path(name), text).unwrap();
    }

    /// Runs a client command of the drive.
    pub(crate) fn iiwasim(&self, command: &str, arguments: &[&str]) -> Assert {
        self.command(command, arguments).assert()
    }

    /// Returns the output of a command with `--json`.
    pub(crate) fn json(&self, command: &str, arguments: &[&str]) -> Value {
        let assert = self.iiwasim(command, &[&["--json"], arguments].concat());
        serde_json::from_slice(&assert.success().get_output().stdout).unwrap()
    }

    /// Starts a command with exactly these arguments.
    pub(crate) fn start(&self, arguments: &[&str]) -> Process {
        Process::start(self.folder.path(), cargo_bin!("iiwasim").as_os_str(), arguments)
    }

    /// Starts a client command of the drive.
    pub(crate) fn begin(&self, command: &str, arguments: &[&str]) -> Process {
        let addresses = self.addresses(command);
        self.start(&[&[command], arguments, &addresses].concat())
    }

    /// Starts a client command of the drive in a prepared shell.
    pub(crate) fn begin_in(&self, shell: &str, command: &str, arguments: &[&str]) -> Process {
        let addresses = self.addresses(command);
        self.start_in(shell, &[&[command], arguments, &addresses].concat())
    }

    fn start_in(&self, shell: &str, arguments: &[&str]) -> Process {
        let script = format!("{shell} && exec \"$0\" \"$@\"");
        let iiwasim = cargo_bin!("iiwasim").to_str().unwrap();
        let all = [&["-c", &script, iiwasim], arguments].concat();
        Process::start(self.folder.path(), OsStr::new("sh"), &all)
    }

    /// Starts the Python example; `None` without a Python interpreter.
    pub(crate) fn example(&self, keys: &[&str]) -> Option<Process> {
        let [drive, stream] =
            [&self.instructions, &self.stream].map(|address| format!("tcp://{address}"));
        let addresses = ["--drive", &drive, "--stream", &stream];
        self.script("docs/client.py", &[&addresses, keys].concat())
    }

    /// Starts a script of this workspace; `None` without a Python interpreter.
    pub(crate) fn script(&self, path: &str, arguments: &[&str]) -> Option<Process> {
        let Some(python) = env::var_os("IIWASIM_PYTHON") else {
            eprintln!("left out: IIWASIM_PYTHON names no Python for {path}");
            return None;
        };
        let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(path);
        let all = [&["-B", script.to_str().unwrap()], arguments].concat();
        Some(Process::start(self.folder.path(), &python, &all))
    }

    /// Writes a program that turns joint 1 from 0 to 60 deg, which takes 3 s.
    pub(crate) fn slow_program(&self) -> &'static str {
        let text = r#"{
            "version": 1,
            "start": { "joints_deg": [0, 0, 0, 0, 0, 0, 0] },
            "motions": [
                { "type": "ptp", "joints_deg": [60, 0, 0, 0, 0, 0, 0], "velocity_rel": 0.2 }
            ]
        }"#;
        fs::write(self.path("slow.json"), text).unwrap();
        "slow.json"
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Reads a file written by a command.
    pub(crate) fn recording(&self, name: &str) -> Recording {
        Recording::from_bytes(&fs::read(self.path(name)).unwrap()).unwrap()
    }

    /// Reads the samples of a file under construction; empty before it exists.
    pub(crate) fn recording_so_far(&self, name: &str) -> Vec<JointSample> {
        let bytes = fs::read(self.path(name)).unwrap_or_default();
        Recording::from_bytes(&bytes).map(|recording| recording.joint_states).unwrap_or_default()
    }

    /// Returns the position of joint 1, in rad; NaN while unknown.
    pub(crate) fn joint_1(&self) -> f64 {
        self.json("status", &[])["joints_rad"][0].as_f64().unwrap_or(f64::NAN)
    }

    /// Starts the slow program, and waits until the arm moves.
    pub(crate) fn begin_run(&self, arguments: &[&str]) -> Process {
        let program = self.slow_program();
        let running = self.begin("run", &[&[program], arguments].concat());
        wait_for("motion", || self.joint_1() > 0.1);
        running
    }
}

/// Polls until the condition holds.
pub(crate) fn wait_for(condition: &str, mut holds: impl FnMut() -> bool) {
    let since = Instant::now();
    while !holds() {
        assert!(since.elapsed() < LONG, "no {condition} within {LONG:?}");
        thread::sleep(Duration::from_millis(10));
    }
}
