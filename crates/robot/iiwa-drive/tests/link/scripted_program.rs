//! A drive with a faulty robot program: malformed states, wrong and missing acknowledgements,
//! unknown runs.

use std::{
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

use iiwa_link::{
    Client, ClientError,
    message::{Code, DriveState, IoValue, Presence, Run},
};
use iiwasim_tests::socket::{Socket, SocketType};
use serde_json::{Value, json};

use crate::link::{
    corrupted::{Field, corrupted, trajectory_to},
    rig::{LONG, Rig, free_tcp, wait_for},
};

/// Time-out of drive messages.
const ANSWER: Duration = Duration::from_secs(10);

/// A robot program that sends scripted states and acknowledgements; the controller is regular.
pub(crate) struct ScriptedProgram {
    instructions: Socket,
    state: Socket,
}

/// The envelope and body of an instruction.
type ReceivedInstruction = (Vec<Vec<u8>>, Value);

impl ScriptedProgram {
    /// Connects to a drive, in the idle state.
    pub(crate) fn new() -> (Rig, Self) {
        let mut rig = Rig::parts(5);
        rig.jar = None;
        rig.cabinet_config.instructions = free_tcp();
        rig.cabinet_config.state = free_tcp();
        rig.start_cabinet();
        let bound = |kind, address: &str| Socket::bind(kind, address).unwrap();
        let program = Self {
            instructions: bound(SocketType::Router, &rig.drive_config.cabinet_instructions),
            state: bound(SocketType::Dealer, &rig.drive_config.cabinet_state),
        };
        rig.start_drive();
        program.send_idle();
        rig.wait_until_ready();
        (rig, program)
    }

    /// Sends a state and waits for its acknowledgement.
    fn send(&self, state: &[u8]) {
        self.state.send(&[b"", state]).unwrap();
        let answer = self.state.receive(ANSWER).expect("an acknowledgement");
        assert_eq!(answer, [b"".as_slice(), br#"{"ok":true}"#]);
    }

    /// Sends a state to the drive, if it is connected, without waiting for the acknowledgement.
    pub(crate) fn send_unacknowledged(&self, state: &[u8]) {
        let _ = self.state.try_send(&[b"", state]);
    }

    fn send_idle(&self) {
        self.send(br#"{"boot": 1, "state": "idle"}"#);
    }

    /// Returns the next instruction, if it arrives within `timeout`.
    fn receive_within(&self, timeout: Duration) -> Option<ReceivedInstruction> {
        let mut frames = self.instructions.receive(timeout)?;
        let body = frames.pop().unwrap();
        Some((frames, serde_json::from_slice(&body).unwrap()))
    }

    /// Returns the next instruction.
    fn receive(&self) -> ReceivedInstruction {
        self.receive_within(ANSWER).expect("an instruction")
    }

    /// Returns true if no instruction arrives within `time`.
    fn is_left_alone(&self, time: Duration) -> bool {
        self.instructions.receive(time).is_none()
    }

    fn answer(&self, (route, _): &ReceivedInstruction, answer: &str) {
        let frames: Vec<&[u8]> =
            route.iter().map(Vec::as_slice).chain([answer.as_bytes()]).collect();
        self.instructions.send(&frames).unwrap();
    }

    /// Acknowledges an instruction, with further fields.
    fn acknowledge(&self, instruction: &ReceivedInstruction, more: &str) {
        let seq = &instruction.1["seq"];
        self.answer(instruction, &format!("{{\"seq\": {seq}{more}}}"));
    }
}

fn spawn_request<T: Send + 'static>(
    rig: &Rig,
    request: impl FnOnce(&mut Client) -> Result<T, ClientError> + Send + 'static,
) -> JoinHandle<Result<T, ClientError>> {
    let mut client = rig.client();
    thread::spawn(move || request(&mut client))
}

fn get_io(rig: &Rig) -> JoinHandle<Result<IoValue, ClientError>> {
    spawn_request(rig, |client| client.get_io("x"))
}

fn run(rig: &Rig) -> JoinHandle<Result<Run, ClientError>> {
    spawn_request(rig, |client| {
        loop {
            match client.run_trajectory(trajectory_to(5.0), Some(LONG)) {
                // The machine was suspended for some cycles.
                Err(error) if error.to_string().contains("not good enough") => {
                    thread::sleep(Duration::from_millis(50));
                }
                other => return other,
            }
        }
    })
}

#[test]
fn malformed_states_are_ignored() {
    use crate::link::corrupted::Requirement::{Optional, Required};

    let (rig, program) = ScriptedProgram::new();
    let good = json!({"boot": 1, "state": "idle", "run": 3, "outcome":
        {"run": 2, "start_s": 1.0, "end_s": 2.0, "error": {"code": "robot", "message": "m"}},
        "hello": {"protocol": 1, "program": "p", "sunrise": "1.16.2.16", "robot": {
            "model": "lbr_iiwa_7_r800",
            "lengths_mm": {"base": 340, "upper_arm": 400, "forearm": 400, "flange": 152}}},
        "conditions": {
            "operation_mode": "t1", "override": 0.5, "safety_stop": false, "tool": "t"}});
    let fields = [
        Field("/boot", Required, &["3"]),
        Field("/state", Required, &[]),
        Field("/run", Optional, &["3", "null"]),
        Field("/outcome", Optional, &["null"]),
        Field("/outcome/run", Required, &["3"]),
        Field("/outcome/start_s", Optional, &["3", "-0.5", "null"]),
        Field("/outcome/end_s", Optional, &["3", "-0.5", "null"]),
        Field("/outcome/error", Optional, &["null"]),
        Field("/outcome/error/code", Required, &[]),
        Field("/outcome/error/message", Required, &["\"x\""]),
        Field("/hello", Optional, &["null"]),
        Field("/hello/protocol", Required, &["3"]),
        Field("/hello/program", Required, &["\"x\""]),
        Field("/hello/sunrise", Optional, &["null", "\"x\""]),
        Field("/hello/robot", Optional, &["null"]),
        Field("/hello/robot/model", Required, &["\"x\""]),
        Field("/hello/robot/lengths_mm", Required, &[]),
        Field("/conditions", Optional, &["null", "{}"]),
        // Any string is a valid mode name.
        Field("/conditions/operation_mode", Optional, &["null", "\"x\""]),
        Field("/conditions/override", Optional, &["3", "-0.5", "null"]),
        Field("/conditions/safety_stop", Optional, &["true", "null"]),
        Field("/conditions/tool", Optional, &["null", "\"x\""]),
    ];
    let states = corrupted(&good, &fields).into_iter();
    let mut garbage: Vec<_> = states.map(|row| row.message.to_string().into_bytes()).collect();
    garbage.extend(["", "{}", "[1, \"running_motion\"]", "null"].map(Into::into));
    garbage.push(vec![b'['; 50_000]);
    garbage.push(vec![0xff; 10]);
    garbage.push(br#"{"boot": 1, "state": "running_motion", "state": "idle"}"#.to_vec());
    for state in &garbage {
        program.send(state);
    }
    program.state.send(&["", "{}", "{}"]).unwrap();
    program.state.receive(ANSWER).expect("an acknowledgement");
    // Well-formed outcomes of unknown runs, at impossible times.
    program.send(good.to_string().as_bytes());
    program.send(
        br#"{"boot": 1, "state": "idle",
             "outcome": {"run": 9, "start_s": 1e308, "end_s": -1e308}}"#,
    );
    let status = rig.client().state().unwrap();
    assert_eq!((status.state, status.robot_program), (DriveState::Idle, Presence::Connected));
    // Malformed states do not keep the connection alive.
    let silent = || {
        program.send(b"{}");
        rig.client().state().unwrap().robot_program == Presence::Silent
    };
    wait_for("silence", silent);
    program.send(br#"{"boot": 1, "state": "running_motion", "run": 5}"#);
    let state = || rig.client().state().unwrap().state;
    wait_for("the state", || state() == DriveState::RunningMotion);
    assert_eq!(rig.client().get_io("x").unwrap_err().code(), Code::NotIdle);
    program.send_idle();
    wait_for("the state", || state() == DriveState::Idle);
}

#[test]
fn only_matching_acknowledgements_count() {
    let (rig, program) = ScriptedProgram::new();
    let client = get_io(&rig);
    let instruction = program.receive();
    assert_eq!((&instruction.1["type"], &instruction.1["name"]), (&json!("get_io"), &json!("x")));
    let seq = instruction.1["seq"].as_u64().unwrap();
    for wrong in [
        String::new(),
        "{}".to_owned(),
        "[]".to_owned(),
        "x".repeat(50_000),
        format!(r#"{{"seq": {}, "value": 1}}"#, seq + 1),
        format!(r#"{{"seq": {}, "value": 1}}"#, seq - 1),
        format!(r#"{{"seq": "{seq}", "value": 1}}"#),
        format!(r#"{{"seq": {seq}.0, "value": 1}}"#),
        format!(r#"{{"seq": {seq}, "value": "1"}}"#),
        format!(r#"{{"seq": {seq}, "value": [1]}}"#),
        format!(r#"{{"seq": {seq}, "seq": {seq}, "value": 1}}"#),
        format!(r#"{{"seq": {seq}, "error": {{"code": "odd", "message": ""}}}}"#),
        format!(r#"{{"seq": {seq}, "error": true}}"#),
        format!(r#"{{"seq": {seq}, "sensors": {{}}}}"#),
        r#"{"seq": null, "value": 1}"#.to_owned(),
    ] {
        program.answer(&instruction, &wrong);
    }
    program.acknowledge(&instruction, r#", "value": 7, "more": 1"#);
    // A second acknowledgement is ignored.
    program.acknowledge(&instruction, r#", "value": 8"#);
    assert_eq!(client.join().unwrap().unwrap(), IoValue::Digital(7));

    // An acknowledgement without the requested value is an error.
    for more in ["", r#", "sensors": null"#] {
        let client = get_io(&rig);
        program.acknowledge(&program.receive(), more);
        let error = client.join().unwrap().unwrap_err();
        assert_eq!(error.code(), Code::Robot, "{error}");
    }
    let client = get_io(&rig);
    program.acknowledge(&program.receive(), r#", "error": {"code": "limit", "message": "so"}"#);
    assert_eq!(client.join().unwrap().unwrap_err().to_string(), "so");
}

#[test]
fn missing_acknowledgements_are_reported_in_time() {
    let (rig, program) = ScriptedProgram::new();
    let first = get_io(&rig);
    let late = program.receive();
    // These requests wait in the backlog.
    let others = [get_io(&rig), get_io(&rig), get_io(&rig)];
    for client in others.into_iter().chain([first]) {
        let error = client.join().unwrap().unwrap_err();
        let ClientError::Refused { refusal, .. } = error else { panic!("{error}") };
        assert_eq!(refusal.code, Code::Timeout);
    }
    // One of the requests was sent; the others are withdrawn.
    let second = program.receive();
    // Late acknowledgements do not arrive over the new connection.
    let client = get_io(&rig);
    let instruction = program.receive();
    for late in [late, second] {
        assert_ne!(instruction.0[0], late.0[0]);
        program.acknowledge(&late, r#", "value": 1"#);
    }
    program.acknowledge(&instruction, r#", "value": 2"#);
    assert_eq!(client.join().unwrap().unwrap(), IoValue::Digital(2));
    assert!(program.is_left_alone(Duration::from_millis(300)));
}

#[test]
fn a_run_that_is_not_acknowledged_is_ended_if_it_begins() {
    let (rig, program) = ScriptedProgram::new();
    let client = run(&rig);
    let late = program.receive();
    assert_eq!(late.1["type"], "run_trajectory");
    let error = client.join().unwrap().unwrap_err();
    assert_eq!(error.code(), Code::Timeout, "{error}");
    program.send_idle();
    program.acknowledge(&late, "");
    assert_eq!(rig.client().state().unwrap().state, DriveState::Idle);
    // The run has begun after all: the drive ends it, and repeats the instruction until it has
    // ended.
    let run = &late.1["run"];
    let running = format!(r#"{{"boot": 1, "state": "running_trajectory", "run": {run}}}"#);
    for _ in 0..2 {
        // A state may overtake the acknowledgement of the previous state and is not new then.
        let instruction = (0..20).find_map(|_| {
            program.send(running.as_bytes());
            program.receive_within(Duration::from_millis(500))
        });
        let instruction = instruction.expect("an instruction");
        assert_eq!(instruction.1["type"], "end_trajectory");
        program.acknowledge(&instruction, "");
    }
    assert_eq!(rig.cabinet().position(), [0.0; 7]);
}

/// Abandons a run that waited behind a query when the robot program became silent.
#[test]
fn an_abandoned_run_in_the_backlog_does_not_begin() {
    let (rig, program) = ScriptedProgram::new();
    program.send_idle();
    thread::sleep(Duration::from_millis(1500));
    let pending = get_io(&rig);
    assert_eq!(program.receive().1["type"], "get_io");
    let error = run(&rig).join().unwrap().unwrap_err();
    assert_eq!(error.code(), Code::Robot, "{error}");
    assert_eq!(pending.join().unwrap().unwrap_err().code(), Code::Timeout);
    program.send_idle();
    assert!(program.is_left_alone(Duration::from_millis(500)));
}

/// A run that the robot program acknowledges but does not know ends with an error.
#[test]
fn a_run_unknown_to_the_robot_program_ends() {
    let (rig, program) = ScriptedProgram::new();
    let client = run(&rig);
    program.acknowledge(&program.receive(), "");
    let since = Instant::now();
    while !client.is_finished() {
        assert!(since.elapsed() < LONG);
        program.send(br#"{"boot": 1, "state": "idle", "outcome": {"run": 0, "end_s": 1.0}}"#);
        thread::sleep(Duration::from_millis(100));
    }
    let error = client.join().unwrap().unwrap_err();
    assert_eq!(error.code(), Code::Robot, "{error}");
    assert_eq!(rig.client().state().unwrap().state, DriveState::Idle);
}

/// For a foreign run that does not end, the drive repeats the instruction, and continues to serve
/// requests.
#[test]
fn a_disobedient_robot_program_does_not_block_the_drive() {
    let (rig, program) = ScriptedProgram::new();
    for _ in 0..20 {
        program.send(br#"{"boot": 1, "state": "running_trajectory", "run": 77}"#);
    }
    let instruction = program.receive();
    assert_eq!(
        (&instruction.1["type"], &instruction.1["run"]),
        (&json!("end_trajectory"), &json!(77))
    );
    program.send_idle();
    wait_for("the state", || rig.client().state().unwrap().state == DriveState::Idle);
    let client = get_io(&rig);
    let instruction = program.receive();
    assert_eq!(instruction.1["type"], "get_io");
    program.acknowledge(&instruction, r#", "value": true"#);
    assert_eq!(client.join().unwrap().unwrap(), IoValue::Boolean(true));
}

#[test]
fn a_robot_program_with_another_protocol_is_not_instructed() {
    let (rig, program) = ScriptedProgram::new();
    program.send(
        br#"{"boot": 1, "state": "idle",
             "hello": {"protocol": 2, "program": "mine 0.2", "sunrise": "2.6"}}"#,
    );
    let status = rig.client().state().unwrap();
    let text = status.text();
    assert!(
        text.contains("mine 0.2, Sunrise 2.6, protocol 2; this is iiwasim with protocol 1"),
        "{text}"
    );
    let refused = [
        get_io(&rig).join().unwrap().map(drop),
        spawn_request(&rig, |client| client.read_sensors().map(drop)).join().unwrap(),
        run(&rig).join().unwrap().map(drop),
    ];
    for refusal in refused {
        let error = refusal.unwrap_err();
        assert_eq!(error.code(), Code::Robot, "{error}");
        let text = error.to_string();
        assert!(text.contains("version 2 of the protocol, this drive version 1"), "{text}");
        assert!(text.contains("replace iiwasim here"), "{text}");
    }
    assert!(program.is_left_alone(Duration::from_millis(300)));
    // Stops are carried out with any version.
    let stopped = spawn_request(&rig, Client::stop);
    assert!(stopped.join().unwrap().is_ok());
}

#[test]
fn conditions_are_reported_and_a_safety_stop_refuses_runs() {
    let (rig, program) = ScriptedProgram::new();
    program.send(
        br#"{"boot": 1, "state": "idle", "conditions": {"operation_mode": "krf", "override": 0.3,
            "safety_stop": true, "tool": "gripper"}}"#,
    );
    let status = rig.client().state().unwrap();
    let text = status.text();
    assert!(
        text.contains("conditions     mode krf, override 30 %, safety stop, tool gripper"),
        "{text}"
    );
    assert!(text.starts_with("state          idle, a safety stop is active"), "{text}");
    let error = run(&rig).join().unwrap().unwrap_err().to_string();
    assert!(error.contains("safety stop"), "{error}");
}

#[test]
fn sensors_without_temperatures_are_passed_on() {
    let (rig, program) = ScriptedProgram::new();
    for temperatures in ["", r#""joint_temperature_c": null, "#] {
        let pending = spawn_request(&rig, Client::read_sensors);
        let sensors = format!(
            r#", "sensors": {{{temperatures}"external_torque_nm": [1, 2, 3, 4, 5, 6, 7]}}"#
        );
        program.acknowledge(&program.receive(), &sensors);
        let sensors = pending.join().unwrap().unwrap();
        assert_eq!(sensors.joint_temperature_c, None);
        assert_eq!(sensors.external_torque_nm[6], 7.0);
    }
}
