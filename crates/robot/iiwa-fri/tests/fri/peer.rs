//! Tests against protobuf's own codec, and an FRI client that shares no code with this crate: the
//! scripts in `tests/fri` of the workspace. They require a Python with the packages of
//! `tests/requirements.txt`, at the path in `IIWASIM_PYTHON`; otherwise these tests are skipped.

use std::{
    env,
    fmt::Write as _,
    io::{BufRead, BufReader, Write as _},
    net::UdpSocket,
    path::Path,
    process::{Child, Command as Process, Stdio},
    thread,
    time::Duration,
};

use iiwa_fri::{Command, Controller, ControllerConfig, Format, Monitoring, Reading, SessionState};
use iiwa_kin::Joints;
use proptest::{
    strategy::{Strategy, ValueTree},
    test_runner::TestRunner,
};
use serde_json::{Map, Value, json};

use crate::messages::{any_command, any_monitoring};

const MESSAGES: usize = 500;

/// Starts a script, with pipes; `None` if Python is not available for it.
fn script(name: &str, arguments: &[&str]) -> Option<Child> {
    let Some(python) = env::var_os("IIWASIM_PYTHON") else {
        eprintln!("skipped: IIWASIM_PYTHON names no Python for {name}");
        return None;
    };
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../tests/fri");
    let child = Process::new(python)
        .arg("-B")
        .arg(folder.join(name))
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    Some(child)
}

/// Returns the codec's output for `lines`, line by line.
fn convert(arguments: &[&str], lines: Vec<String>) -> Option<Vec<String>> {
    let mut child = script("codec.py", arguments)?;
    let mut input = child.stdin.take().unwrap();
    let writer = thread::spawn(move || {
        for line in lines {
            writeln!(input, "{line}").unwrap();
        }
    });
    let output = child.wait_with_output().unwrap();
    writer.join().unwrap();
    assert!(output.status.success());
    Some(String::from_utf8(output.stdout).unwrap().lines().map(str::to_owned).collect())
}

fn some<T: std::fmt::Debug>(strategy: &impl Strategy<Value = T>) -> Vec<T> {
    let mut runner = TestRunner::deterministic();
    (0..MESSAGES).map(|_| strategy.new_tree(&mut runner).unwrap().current()).collect()
}

fn to_hex(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |mut hex, byte| {
        write!(hex, "{byte:02x}").unwrap();
        hex
    })
}

fn from_hex(hex: &str) -> Vec<u8> {
    (0..hex.len()).step_by(2).map(|i| u8::from_str_radix(&hex[i..i + 2], 16).unwrap()).collect()
}

/// Adds `value` as `object.key`, if it is given.
fn put(message: &mut Map<String, Value>, object: &str, key: &str, value: Option<Value>) {
    if let Some(value) = value {
        message.entry(object).or_insert_with(|| json!({}))[key] = value;
    }
}

fn values(joints: Option<Joints>) -> Option<Value> {
    joints.map(|joints| json!({ "value": joints }))
}

fn monitoring_json(message: &Monitoring) -> Value {
    let mut out = Map::new();
    let m = &mut out;
    put(m, "header", "messageIdentifier", Some(json!(0x0024_5142)));
    put(m, "header", "sequenceCounter", Some(json!(message.sequence)));
    put(m, "header", "reflectedSequenceCounter", Some(json!(message.reflected)));
    put(m, "connectionInfo", "sessionState", Some(json!(message.session as u8)));
    put(m, "connectionInfo", "quality", Some(json!(message.quality as u8)));
    put(m, "connectionInfo", "sendPeriod", Some(json!(message.send_period_ms)));
    put(m, "connectionInfo", "receiveMultiplier", Some(json!(message.receive_multiplier)));
    put(m, "robotInfo", "safetyState", message.safety.map(|safety| json!(safety as u8)));
    put(m, "robotInfo", "driveState", message.drive.map(|drive| json!(vec![drive as u8; 7])));
    put(m, "robotInfo", "operationMode", message.operation_mode.map(|mode| json!(mode as u8)));
    put(m, "robotInfo", "controlMode", message.control_mode.map(|mode| json!(mode as u8)));
    if m.contains_key("robotInfo") {
        put(m, "robotInfo", "numberOfJoints", Some(json!(7)));
    }
    put(m, "monitorData", "measuredJointPosition", values(message.measured_rad));
    put(m, "monitorData", "measuredTorque", values(message.measured_torque_nm));
    put(m, "monitorData", "commandedJointPosition", values(message.commanded_rad));
    put(m, "monitorData", "commandedTorque", values(message.commanded_torque_nm));
    put(m, "monitorData", "externalTorque", values(message.external_torque_nm));
    let time = message.time.map(|t| json!({ "sec": t.as_secs(), "nanosec": t.subsec_nanos() }));
    put(m, "monitorData", "timestamp", time);
    put(m, "ipoData", "jointPosition", values(message.ipo_rad));
    put(m, "ipoData", "clientCommandMode", message.command_mode.map(|mode| json!(mode as u8)));
    put(m, "ipoData", "overlayType", message.overlay.map(|overlay| json!(overlay as u8)));
    put(m, "ipoData", "trackingPerformance", message.tracking_performance.map(|p| json!(p)));
    json!({ "monitoring": out })
}

fn command_json(message: &Command) -> Value {
    let mut out = Map::new();
    let m = &mut out;
    put(m, "header", "messageIdentifier", Some(json!(0x0003_4001)));
    put(m, "header", "sequenceCounter", Some(json!(message.sequence)));
    put(m, "header", "reflectedSequenceCounter", Some(json!(message.reflected)));
    put(m, "commandData", "jointPosition", values(message.joints_rad));
    json!({ "command": out })
}

/// Compares values with numbers as floats, because protobuf writes 1.0 as `1.0`, and counters as
/// integers.
fn same(a: &Value, b: &Value) -> bool {
    match (a, b) {
        (Value::Number(a), Value::Number(b)) => a.as_f64() == b.as_f64(),
        (Value::Array(a), Value::Array(b)) => {
            a.len() == b.len() && a.iter().zip(b).all(|(a, b)| same(a, b))
        }
        (Value::Object(a), Value::Object(b)) => {
            a.len() == b.len() && a.iter().all(|(key, a)| b.get(key).is_some_and(|b| same(a, b)))
        }
        _ => a == b,
    }
}

/// Cross-validated against protobuf's Python package: the same values, and the same bytes.
#[test]
fn both_codecs_agree() {
    let (monitoring, commands) = (some(&any_monitoring()), some(&any_command()));
    let mut expected = Vec::new();
    let mut lines = Vec::new();
    let mut bytes = Vec::new();
    for message in &monitoring {
        Format::V1.encode_monitoring(message, &mut bytes);
        lines.push(to_hex(&bytes));
        expected.push(monitoring_json(message));
    }
    for message in &commands {
        Format::V1.encode_command(message, &mut bytes);
        lines.push(to_hex(&bytes));
        expected.push(command_json(message));
    }
    let Some(decoded) = convert(&[], lines.clone()) else { return };
    assert_eq!(decoded.len(), expected.len());
    for (decoded, expected) in decoded.iter().zip(&expected) {
        let decoded: Value = serde_json::from_str(decoded).unwrap();
        assert!(same(&decoded, expected), "{decoded}\n{expected}");
    }
    let texts = expected.iter().map(Value::to_string).collect();
    let encoded = convert(&["--encode"], texts).unwrap();
    assert_eq!(encoded, lines);
}

/// Fields that this crate does not model are ignored.
#[test]
fn other_fields_are_passed_over() {
    let io = json!([{ "name": "FlexFellow.Out1", "type": 0, "direction": 1, "digitalValue": "1" }]);
    let mut monitoring = monitoring_json(&Monitoring::default());
    monitoring["monitoring"]["monitorData"] = json!({ "readIORequest": io });
    let mut command = command_json(&Command::default());
    command["command"]["commandData"] =
        json!({ "writeIORequest": io, "jointTorque": { "value": [1.0, 2.0] } });
    let lines = vec![monitoring.to_string(), command.to_string()];
    let Some(encoded) = convert(&["--encode"], lines) else { return };
    let bytes = from_hex(&encoded[0]);
    assert!(bytes.windows(4).any(|part| part == b"Flex"));
    assert_eq!(Format::V1.decode_monitoring(&bytes).unwrap(), Monitoring::default());
    let bytes = from_hex(&encoded[1]);
    assert_eq!(Format::V1.decode_command(&bytes).unwrap(), Command::default());
}

/// Tests the controller against an independent client over a socket, one message at a time.
#[test]
fn an_independent_client_commands() {
    const HOME: Joints = [0.1, -0.2, 0.3, -0.4, 0.5, -0.6, 0.7];
    let arguments = ["--bind", "127.0.0.1:0", "--command", "--seconds", "60"];
    let Some(mut client) = script("client.py", &arguments) else { return };
    let mut lines = BufReader::new(client.stdout.take().unwrap()).lines();
    let mut line = || -> Value { serde_json::from_str(&lines.next().unwrap().unwrap()).unwrap() };
    let bound = line()["bound"].as_str().unwrap().to_owned();
    let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
    socket.connect(bound).unwrap();
    socket.set_read_timeout(Some(Duration::from_secs(20))).unwrap();

    let config = ControllerConfig { receive_multiplier: 2, ..ControllerConfig::default() };
    let mut controller = Controller::new(config);
    controller.request_commanding();
    let (mut out, mut robot, mut furthest) = (Vec::new(), HOME, 0.0_f64);
    let mut answer = [0; 2048];
    for cycle in 0..2000_u32 {
        if let Some(setpoint) = controller.setpoint() {
            furthest = furthest.max((setpoint[0] - robot[0]).abs());
            robot = *setpoint;
        }
        let reading = Reading {
            measured_rad: robot,
            commanded_rad: robot,
            ipo_rad: controller.state().commands().then_some(HOME),
            time: Duration::from_millis(5) * cycle,
            ..Reading::default()
        };
        assert!(controller.tick(&reading, &mut out));
        socket.send(&out).unwrap();
        // The client answers the second of two messages.
        if cycle % 2 == 1 {
            let length = socket.recv(&mut answer).unwrap();
            controller.receive(&answer[..length]).unwrap();
        }
    }
    assert_eq!(controller.state(), SessionState::CommandingActive);
    assert_eq!(controller.counters().accepted, 1000);
    assert_eq!((controller.counters().missed, controller.counters().ignored), (0, 0));
    assert!((robot[0] - HOME[0]).abs() < 0.0201 && robot[1..] == HOME[1..]);
    // 0.02 rad at 0.25 Hz, and two cycles of 5 ms between set-points.
    assert!((2e-4..4e-4).contains(&furthest), "{furthest}");
    for state in ["monitoring_wait", "monitoring_ready", "commanding_wait", "commanding_active"] {
        let line = line();
        assert_eq!(line["session"], state);
        assert_eq!(line["quality"], if state == "monitoring_wait" { "poor" } else { "excellent" });
    }
    client.kill().unwrap();
    client.wait().unwrap();
}
