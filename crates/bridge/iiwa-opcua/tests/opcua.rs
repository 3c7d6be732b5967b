//! The OPC UA server with a client that shares no code with it: the script `tests/opcua/check.py`
//! of the workspace. It requires a Python with the packages of `tests/opcua/requirements.txt`, at
//! the path in `IIWASIM_PYTHON`; otherwise these tests are skipped.
#![cfg(feature = "server")]
#![expect(
    clippy::unwrap_used,
    clippy::print_stderr,
    reason = "a failed test is a panic; tests that are left out say so"
)]

use std::{
    collections::BTreeMap,
    env,
    ffi::OsString,
    fs,
    net::{Ipv4Addr, SocketAddr},
    path::{Path, PathBuf},
    process::Command,
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicUsize, Ordering},
    },
    thread,
    time::{Duration, SystemTime, UNIX_EPOCH},
};

use iiwa_bridge::{
    Credentials, Message, Sink,
    message::{Content, CycleSample, Timestamp, VERSION},
};
use iiwa_kin::{Load, Robot};
use iiwa_opcua::{
    BridgedArm, OpcUa, OpcUaError, OpcUaOptions, ServedRobot, StopFailure, StopRobot,
};
use serde_json::{Value, json};
use tempfile::TempDir;

/// Joint oscillation: joint j is at `AMPLITUDE_RAD * sin(RAD_PER_S * t + j)`.
const AMPLITUDE_RAD: f64 = 0.5;
const RAD_PER_S: f64 = 1.5;
/// Duration of a stop.
const STOP_TAKES: Duration = Duration::from_millis(200);

const TASK: &str = "Controllers/I:Controller/TaskControls/I:Task";
const SAFETY: &str = "SafetyStates/I:SafetyState/D:ParameterSet";

/// Counts stops.
struct CountedStops(Arc<AtomicUsize>);

impl StopRobot for CountedStops {
    fn stop(&self) -> Result<(), StopFailure> {
        thread::sleep(STOP_TAKES);
        self.0.fetch_add(1, Ordering::SeqCst);
        Ok(())
    }
}

/// A server with two robots: the left one runs a program, the right one has an active safety stop.
struct Rig {
    folder: TempDir,
    server: Arc<OpcUa>,
    since: f64,
    stops: Arc<AtomicUsize>,
    ended: Arc<AtomicBool>,
    feed: Option<thread::JoinHandle<()>>,
}

impl Rig {
    fn start(adjust: impl FnOnce(&mut OpcUaOptions), folder: TempDir, stop: bool) -> Self {
        let stops = Arc::new(AtomicUsize::new(0));
        let robots = [("left", Robot::lbr_iiwa_7_r800()), ("right", Robot::lbr_iiwa_14_r820())];
        let load = Load { mass_kg: 1.5, center_mm: [1.0, 2.0, 30.0], ..Load::default() };
        let robots = robots.map(|(name, model)| ServedRobot {
            name: name.to_owned(),
            arm: BridgedArm { model, load: Some(load) },
            stop: stop.then(|| Arc::new(CountedStops(Arc::clone(&stops))) as Arc<dyn StopRobot>),
        });
        let mut options = options_in(folder.path());
        adjust(&mut options);
        let server = Arc::new(OpcUa::serve(&options, robots.into()).unwrap());
        let since = now_s().floor();
        let ended = Arc::new(AtomicBool::new(false));
        let feed = thread::spawn({
            let (server, ended) = (Arc::clone(&server), Arc::clone(&ended));
            move || feed(&server, since, &ended)
        });
        Self { folder, server, since, stops, ended, feed: Some(feed) }
    }

    /// Writes the values that the script expects to a file.
    fn expected(&self, stop: &str) -> PathBuf {
        let robots = [("left", Robot::lbr_iiwa_7_r800()), ("right", Robot::lbr_iiwa_14_r820())];
        let robots = robots.map(|(name, model)| {
            let limits = model.limits();
            let both = |limits: &[f64; 7]| limits.map(|limit| [-limit, limit]);
            let positions: [[f64; 2]; 7] =
                std::array::from_fn(|joint| [limits.lower_rad[joint], limits.upper_rad[joint]]);
            json!({
                "name": name,
                "since": self.since,
                "amplitude_rad": AMPLITUDE_RAD,
                "rad_per_s": RAD_PER_S,
                "ranges": [
                    positions,
                    both(&limits.velocity_rad_s),
                    both(&limits.acceleration_rad_s2),
                ],
                "center_m": [0.001, 0.002, 0.03],
                "stop": stop,
                "stop_takes_s": STOP_TAKES.as_secs_f64(),
                "values": values(name == "left"),
                "statuses": statuses(name == "left"),
            })
        });
        let file = self.folder.path().join("expected.json");
        fs::write(&file, json!({ "robots": robots }).to_string()).unwrap();
        file
    }

    fn url(&self) -> String {
        format!("opc.tcp://{}", self.server.address())
    }
}

impl Drop for Rig {
    fn drop(&mut self) {
        self.ended.store(true, Ordering::Relaxed);
        if let Some(feed) = self.feed.take() {
            let _ = feed.join();
        }
    }
}

fn options_in(folder: &Path) -> OpcUaOptions {
    OpcUaOptions {
        listen: SocketAddr::from((Ipv4Addr::LOCALHOST, 0)),
        host: None,
        certificates: folder.join("certificates"),
        trusted: Vec::new(),
        users: vec![Credentials { user: "anna".to_owned(), password: "secret-1".to_owned() }],
        anonymous: false,
        unsecured: false,
        arms: BTreeMap::new(),
    }
}

fn values(is_left: bool) -> Value {
    let machine = format!("{TASK}/TaskControlOperation/TaskControlStateMachine");
    json!({
        format!("{SAFETY}/OperationalMode"): if is_left { 3 } else { 1 },
        format!("{SAFETY}/ProtectiveStop"): !is_left,
        format!("{SAFETY}/EmergencyStop"): !is_left,
        format!("{TASK}/D:ParameterSet/TaskProgramName"):
            if is_left { "pick and place" } else { "" },
        format!("{TASK}/D:ParameterSet/TaskProgramLoaded"): is_left,
        format!("{machine}/B:CurrentState"): if is_left { "Executing" } else { "Idle" },
        "MotionDevices/I:Arm/D:ParameterSet/SpeedOverride": if is_left { 100.0 } else { 50.0 },
        "MotionDevices/I:Arm/D:Manufacturer": "KUKA",
        "MotionDevices/I:Arm/D:Model": if is_left { "LBR iiwa 7 R800" } else { "LBR iiwa 14 R820" },
        "MotionDevices/I:Arm/MotionDeviceCategory": 1,
        "MotionDevices/I:Arm/FlangeLoad/Mass": 1.5,
        "MotionDevices/I:Arm/PowerTrains/I:A7/I:Motor/D:ParameterSet/MotorTemperature":
            is_left.then_some(37.0),
        "Controllers/I:Controller/Software/I:SystemSoftware/D:SoftwareRevision": "1.16",
        "D:ComponentName": if is_left { "left" } else { "right" },
    })
}

fn statuses(is_left: bool) -> Value {
    json!({
        // A safety stop may be an emergency stop.
        format!("{SAFETY}/EmergencyStop"): if is_left { "Good" } else { "Uncertain" },
        format!("{SAFETY}/ProtectiveStop"): "Good",
        "MotionDevices/I:Arm/PowerTrains/I:A1/I:Motor/D:ParameterSet/MotorTemperature":
            if is_left { "Good" } else { "BadWaitingForInitialData" },
    })
}

fn now_s() -> f64 {
    SystemTime::now().duration_since(UNIX_EPOCH).unwrap().as_secs_f64()
}

/// Sends messages like the feeds of two robots.
fn feed(server: &OpcUa, since: f64, ended: &AtomicBool) {
    let send = |robot: &str, time: Timestamp, content: Content| {
        let robot = robot.to_owned();
        server.take(&Message { version: VERSION, robot, session: 1, seq: 0, at: time, content });
    };
    let publish = |robot: &str, content: Value| {
        send(robot, Timestamp::now(), serde_json::from_value(content).unwrap());
    };
    for (robot, mode, share, stop, state) in
        [("left", "aut", 1.0, false, "running_motion"), ("right", "t1", 0.5, true, "idle")]
    {
        publish(
            robot,
            json!({
                "kind": "conditions", "drive": "connected", "state": state,
                "robot_program": "connected",
                "fri": {
                    "session": "monitoring_ready", "quality": "good", "lost": 0, "late": 0,
                    "safety_stop": stop,
                },
                "hello": {"protocol": 2, "program": "Program 1", "sunrise": "1.16"},
                "conditions": {"operation_mode": mode, "override": share},
            }),
        );
    }
    publish(
        "left",
        json!({
            "kind": "run", "t_s": 1.0, "run": 1, "event": "begin", "what": "motions",
            "program": "pick and place",
        }),
    );
    publish(
        "left",
        json!({
            "kind": "sensors", "joint_temperature_c": [31.0, 32.0, 33.0, 34.0, 35.0, 36.0, 37.0],
            "external_torque_nm": [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        }),
    );
    while !ended.load(Ordering::Relaxed) {
        let time = Timestamp::now();
        let t_s = time.micros() as f64 / 1e6 - since;
        let joints_rad =
            std::array::from_fn(|joint| AMPLITUDE_RAD * (RAD_PER_S * t_s + joint as f64).sin());
        for robot in ["left", "right"] {
            let sample = CycleSample { t_s, joints_rad, measured_nm: None, external_nm: None };
            send(robot, time, Content::Joints(sample));
        }
        thread::sleep(Duration::from_millis(5));
    }
}

/// Runs the script, and returns its last line.
fn check(python: &OsString, arguments: &[&str]) -> String {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../tests/opcua/check.py");
    let output = Command::new(python).arg("-B").arg(script).args(arguments).output().unwrap();
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{text}{errors}");
    text.lines().last().unwrap_or_default().to_owned()
}

fn python() -> Option<OsString> {
    let python = env::var_os("IIWASIM_PYTHON");
    if python.is_none() {
        eprintln!("left out: IIWASIM_PYTHON names no Python for check.py");
    }
    python
}

#[test]
fn a_client_with_certificate_and_password_reads_robots_and_stops_them() {
    let Some(python) = python() else { return };
    let folder = tempfile::tempdir().unwrap();
    let clients = folder.path().join("clients");
    let clients_text = clients.to_str().unwrap().to_owned();
    check(&python, &["certificates", &clients_text]);
    let trusted = ["trusted.der", "expired.der"].map(|name| clients.join(name)).to_vec();
    let rig = Rig::start(|options| options.trusted = trusted, folder, true);
    let expected = rig.expected("works");
    let url = rig.url();
    let last = check(&python, &["secured", &url, &clients_text, expected.to_str().unwrap()]);
    let figures: Value = serde_json::from_str(&last).unwrap();
    assert!(figures["checked"].as_u64().unwrap() > 500, "{figures}");
    // One stop per robot, and none for invalid requests.
    assert_eq!(rig.stops.load(Ordering::SeqCst), 2);
}

#[test]
fn without_security_clients_read_and_nobody_stops() {
    let Some(python) = python() else { return };
    for (stop, expected) in [(false, "absent"), (true, "refused")] {
        let folder = tempfile::tempdir().unwrap();
        let rig = Rig::start(|options| options.unsecured = true, folder, stop);
        let file = rig.expected(expected);
        check(&python, &["open", &rig.url(), file.to_str().unwrap()]);
        assert_eq!(rig.stops.load(Ordering::SeqCst), 0);
    }
}

#[test]
fn invalid_settings_are_reported() {
    let folder = tempfile::tempdir().unwrap();
    let robot =
        |name: &str| ServedRobot { name: name.to_owned(), arm: BridgedArm::default(), stop: None };
    let error = |adjust: &dyn Fn(&mut OpcUaOptions), robots: Vec<ServedRobot>| -> OpcUaError {
        let mut options = options_in(folder.path());
        adjust(&mut options);
        OpcUa::serve(&options, robots).err().unwrap()
    };
    let nobody = error(&|options| options.users.clear(), vec![robot("a")]);
    assert!(nobody.to_string().contains("no user can log in"), "{nobody}");
    let twice = error(&|_| {}, vec![robot("a"), robot("a")]);
    assert!(matches!(&twice, OpcUaError::SameName { name } if name == "a"), "{twice}");

    let first = OpcUa::serve(&options_in(folder.path()), vec![robot("a")]).unwrap();
    let address = first.address();
    let message = error(&|options| options.listen = address, vec![robot("a")]);
    assert!(message.to_string().starts_with(&format!("cannot listen at {address}")), "{message}");

    let none = folder.path().join("none.der");
    let missing = error(&|options| options.trusted = vec![none.clone()], vec![robot("a")]);
    assert!(missing.to_string().contains("none.der"), "{missing}");
}

#[test]
fn certificate_and_key_stay_the_same_and_to_themselves() {
    let folder = tempfile::tempdir().unwrap();
    let read = |file: &str| fs::read(folder.path().join("certificates").join(file)).unwrap();
    let files = ["own/cert.der", "private/private.pem"];
    drop(OpcUa::serve(&options_in(folder.path()), Vec::new()).unwrap());
    let before = files.map(read);
    drop(OpcUa::serve(&options_in(folder.path()), Vec::new()).unwrap());
    assert!(files.map(read) == before);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        let private = folder.path().join("certificates/private");
        assert_eq!(fs::metadata(private).unwrap().permissions().mode() & 0o777, 0o700);
    }
}
