//! Bad input: each field of each message wrong in turn, on every socket. There is an answer that says
//! what is wrong, and nothing else happens.

#![expect(clippy::unwrap_used, clippy::expect_used, reason = "a test fails by them")]

use std::{
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

use iiwa_link::{
    Client, ClientError, TimedJoints,
    message::{Code, DriveState, IoValue, Presence, Request, Run},
};
use serde_json::{Value, json};

use crate::{
    rig::{LONG, Rig, free_tcp, wait_for},
    runs::{planned, sampled},
};

/// A socket that asks, one after the other.
struct Asker {
    socket: zmq::Socket,
}

impl Asker {
    fn new(at: &str) -> Self {
        let socket = zmq::Context::new().socket(zmq::REQ).unwrap();
        socket.set_linger(0).unwrap();
        socket.set_rcvtimeo(5000).unwrap();
        socket.connect(at).unwrap();
        Self { socket }
    }

    fn ask_bytes(&self, body: &[u8]) -> String {
        self.socket.send(body, 0).unwrap();
        self.socket.recv_string(0).expect("an answer in time").expect("text")
    }

    fn ask(&self, body: &str) -> Value {
        serde_json::from_str(&self.ask_bytes(body.as_bytes())).unwrap()
    }
}

/// The message is for people: short, on one line, and it names one of these.
fn assert_told(error: &Value, code: &str, names: &[&str], request: &str) {
    let request: String = request.chars().take(300).collect();
    assert_eq!(error["code"], code, "{request}: {error}");
    let message = error["message"].as_str().expect("a message");
    assert!(!message.is_empty() && message.len() <= 500, "{request}: {message}");
    assert!(!message.contains(char::is_control), "{request}: {message:?}");
    assert!(names.iter().any(|name| message.contains(name)), "{request}: {message}");
}

/// What is wrong nearly everywhere.
fn wrong_values() -> [Value; 8] {
    [
        Value::Null,
        json!(true),
        json!(3),
        json!(-0.5),
        json!("x"),
        json!([]),
        json!({}),
        json!([[[]]]),
    ]
}

/// A field of a message: the way to it, as a JSON pointer; whether it may be left out; and those of
/// [`wrong_values`] that are right for it.
struct Field(&'static str, Left, &'static [&'static str]);

#[derive(PartialEq)]
enum Left {
    Out,
    Never,
}

const NUMBER: &[&str] = &["3", "-0.5"];

/// The messages in which each of these fields is wrong in turn, and the field's name.
fn spoilt(good: &Value, fields: &[Field]) -> Vec<(String, String)> {
    let mut messages = Vec::new();
    for Field(path, left, right) in fields {
        let (parent, name) = path.rsplit_once('/').unwrap();
        for value in wrong_values() {
            if !right.contains(&value.to_string().as_str()) {
                let mut message = good.clone();
                *message.pointer_mut(path).expect(path) = value;
                messages.push((message.to_string(), name.to_owned()));
            }
        }
        if *left == Left::Never {
            let mut message = good.clone();
            match message.pointer_mut(parent).unwrap() {
                Value::Object(object) => drop(object.remove(name)),
                Value::Array(list) => drop(list.remove(name.parse().unwrap())),
                _ => unreachable!(),
            }
            messages.push((message.to_string(), name.to_owned()));
        }
    }
    messages
}

/// Joint 1 to `deg`.
fn trajectory_to(deg: f64) -> TimedJoints {
    let mut target = [0.0; 7];
    target[0] = deg.to_radians();
    let motion = iiwa_path::Motion::Ptp(iiwa_path::Ptp::to(target));
    sampled(&planned(vec![motion]), 0.004)
}

/// A request of each type that is all right.
fn good_requests() -> Vec<Value> {
    let trajectory = trajectory_to(0.1);
    vec![
        json!({"type": "run_motions", "motions": [
            {"type": "ptp", "joints_deg": [1, 0, 0, 0, 0, 0, 0], "velocity_rel": 0.5,
             "acceleration_rel": 0.5, "jerk_rel": 0.5, "blend": {"fraction": 0.1}},
            {"type": "ptp", "joints_rad": [0, 0, 0, 0, 0, 0, 0]},
            {"type": "wait", "seconds": 0.01},
        ]}),
        json!({"type": "run_trajectory", "trajectory": trajectory}),
        json!({"type": "read_sensors"}),
        json!({"type": "get_io", "name": "MediaFlange.UserButton"}),
        json!({"type": "set_io", "name": "MediaFlange.LEDBlue", "value": true}),
        json!({"type": "state"}),
        json!({"type": "last_run"}),
        json!({"type": "stop"}),
    ]
}

fn fields_of(name: &str) -> Vec<Field> {
    use Left::{Never, Out};
    let own = match name {
        "run_motions" => vec![
            Field("/motions", Never, &[]),
            Field("/motions/0", Out, &[]),
            Field("/motions/0/type", Never, &[]),
            Field("/motions/0/joints_deg", Never, &[]),
            Field("/motions/0/joints_deg/3", Never, NUMBER),
            Field("/motions/0/velocity_rel", Out, &[]),
            Field("/motions/0/acceleration_rel", Out, &[]),
            Field("/motions/0/jerk_rel", Out, &[]),
            Field("/motions/0/blend", Out, &["null"]),
            Field("/motions/0/blend/fraction", Never, &[]),
            Field("/motions/1/joints_rad", Never, &[]),
            Field("/motions/2/type", Never, &[]),
            Field("/motions/2/seconds", Never, &["3"]),
        ],
        "run_trajectory" => vec![
            Field("/trajectory", Never, &[]),
            Field("/trajectory/t_s", Never, &[]),
            Field("/trajectory/t_s/2", Never, NUMBER),
            Field("/trajectory/joints_rad", Never, &[]),
            Field("/trajectory/joints_rad/2", Never, &[]),
            Field("/trajectory/joints_rad/2/6", Never, NUMBER),
        ],
        "get_io" => vec![Field("/name", Never, &[])],
        "set_io" => vec![Field("/name", Never, &[]), Field("/value", Never, &["true"])],
        _ => Vec::new(),
    };
    [Field("/type", Never, &[])].into_iter().chain(own).collect()
}

/// Requests of few words in which something is wrong, and what the message names.
const BAD_TEXTS: [(&str, &str); 36] = [
    ("", "too early"),
    ("null", "object"),
    ("[]", "object"),
    (r#"["state"]"#, "object"),
    (r#"{"type": "state""#, "too early"),
    (r#"{"type": "state"} x"#, "more text"),
    (r#"{"type": "STATE"}"#, "`STATE`"),
    (r#"{"type": "fly\u0007\n\u001b[2J"}"#, "fly"),
    (r#"{"type": "state", "type": "stop"}"#, "`type`"),
    (r#"{"type": "state", "id": 1, "id": 2}"#, "`id`"),
    (r#"{"type": "state", "x\u001b\n": 1}"#, "unknown key"),
    (r#"{"type": "get_io", "name": "", "value": 1}"#, "`value`"),
    (r#"{"type": "get_io", "name": ""}"#, "``"),
    (r#"{"type": "get_io", "name": "a", "name": "b"}"#, "`name`"),
    (r#"{"type": "get_io", "name": "mediaflange.userbutton"}"#, "mediaflange"),
    (r#"{"type": "get_io", "name": "\u0000\u202e\ud83d\ude00"}"#, "\\u{202e}"),
    (r#"{"type": "get_io", "name": "\ud800"}"#, "column"),
    (r#"{"type": "set_io", "name": "MediaFlange.UserButton", "value": true}"#, "input"),
    (r#"{"type": "set_io", "name": "Simulation.AnalogInput", "value": 1.0}"#, "input"),
    (r#"{"type": "set_io", "name": "MediaFlange.LEDBlue", "value": 1}"#, "true or false"),
    (r#"{"type": "set_io", "name": "MediaFlange.LEDBlue", "value": 1e300}"#, "1e300"),
    (r#"{"type": "set_io", "name": "Simulation.DigitalOutput", "value": 1.5}"#, "whole"),
    (r#"{"type": "set_io", "name": "Simulation.DigitalOutput", "value": -1}"#, "whole"),
    (r#"{"type": "set_io", "name": "Simulation.DigitalOutput", "value": true}"#, "whole"),
    (r#"{"type": "set_io", "name": "Simulation.AnalogOutput", "value": false}"#, "number"),
    (r#"{"type": "set_io", "name": "Simulation.AnalogOutput", "value": 1e999}"#, "column"),
    (r#"{"type": "set_io", "name": "Simulation.AnalogOutput", "value": NaN}"#, "column"),
    (
        r#"{"type": "set_io", "name": "Simulation.AnalogOutput", "value": null}"#,
        "expected true, false or a number, found null, at line 1, column 64",
    ),
    (r#"{"type": "run_trajectory", "trajectory": {"t_s": [], "joints_rad": []}}"#, "0 points"),
    (
        r#"{"type": "run_trajectory", "trajectory": {"t_s": [0], "joints_rad": [[0,0,0,0,0,0,0]]}}"#,
        "1 points",
    ),
    (
        r#"{"type": "run_trajectory", "trajectory": {"t_s": [0, 1e999], "joints_rad": []}}"#,
        "too large",
    ),
    (
        r#"{"type": "run_trajectory", "trajectory": {"t_s": [-Infinity], "joints_rad": []}}"#,
        "column",
    ),
    (
        r#"{"type": "run_trajectory", "trajectory": {"t_s": [], "t_s": [], "joints_rad": []}}"#,
        "`t_s`",
    ),
    (r#"{"type": "run_motions", "motions": [], "motions": []}"#, "`motions`"),
    (r#"{"type": "run_motions", "motions": []}"#, "no motions"),
    (
        r#"{"type": "run_motions", "motions": [{"type": "fly\u001b", "joints_deg": []}]}"#,
        "motion 1",
    ),
];

/// Requests in which something else is wrong, with the code and what the message names.
fn bad_requests() -> Vec<(String, &'static str, &'static str)> {
    let texts = BAD_TEXTS.map(|(request, name)| (request.to_owned(), "bad_request", name));
    let joints = |count: usize| vec![0.0; count];
    let points = |count: usize| {
        json!({"type": "run_trajectory", "trajectory":
            {"t_s": [0.0, 1.0], "joints_rad": [joints(7), joints(count)]}})
    };
    let motion = |ptp: Value| json!({"type": "run_motions", "motions": [ptp]});
    let to = |deg: f64| json!([0, 0, 0, deg, 0, 0, 0]);
    let value = |request: Value, code, name| (request.to_string(), code, name);
    let long = "x".repeat(50_000);
    let longer = "x".repeat(100_000);
    let deep = format!("{}{}", "[".repeat(10_000), "]".repeat(10_000));
    let mut bad: Vec<_> = texts.into();
    bad.extend([
        value(points(6), "bad_request", "found 6, at line 1, column"),
        value(points(8), "bad_request", "found 8, at line 1, column"),
        value(motion(json!({"type": "ptp", "joints_deg": joints(6)})), "bad_request", "motion 1"),
        value(motion(json!({"type": "ptp", "joints_deg": joints(8)})), "bad_request", "motion 1"),
        value(motion(json!({"type": "ptp", "joints_deg": to(120.1)})), "limit", "joint 4"),
        value(motion(json!({"type": "ptp", "joints_deg": to(-1e300)})), "limit", "joint 4"),
        value(
            motion(json!({"type": "ptp", "joints_deg": to(1.0), "velocity_rel": 1.1})),
            "bad_request",
            "velocity_rel",
        ),
        value(
            motion(json!({"type": "ptp", "joints_deg": to(1.0), "jerk_rel": 1e300})),
            "bad_request",
            "jerk_rel",
        ),
        value(
            motion(json!({"type": "ptp", "joints_deg": to(1.0), "blend": {"cart_mm": 50}})),
            "bad_request",
            "blend",
        ),
        value(motion(json!({"type": "wait", "seconds": 1e300})), "bad_request", "wait"),
        value(json!({"type": long}), "bad_request", "xxx..."),
        value(json!({"type": "state", long.as_str(): 1}), "bad_request", "xxx..."),
        value(json!({"type": "get_io", "name": long}), "bad_request", "xxx..."),
        value(json!({"type": "get_io", "name": "\u{10fff0}".repeat(100)}), "bad_request", "10fff0"),
        value(json!({"type": "get_io", "name": longer}), "bad_request", "too long"),
        value(motion(json!({"type": long})), "bad_request", "motion 1"),
        (format!(r#"{{"type": {deep}}}"#), "bad_request", "column"),
        (format!(r#"{{"type": "state", "x": {deep}}}"#), "bad_request", "`x`"),
        (format!(r#"{{"type": "get_io", "name": {deep}}}"#), "bad_request", "column"),
        (format!(r#"{{"type": "set_io", "name": "a", "value": {deep}}}"#), "bad_request", "column"),
        (format!(r#"{{"type": "run_motions", "motions": {deep}}}"#), "bad_request", "motion 1"),
        (format!(r#"{{"type": "run_trajectory", "trajectory": {deep}}}"#), "bad_request", "column"),
        ("[".repeat(100_000), "bad_request", "column"),
        ("{\"id\":".repeat(100_000), "bad_request", "too early"),
    ]);
    bad.extend(bad_trajectories().into_iter().map(|(trajectory, code, name)| {
        value(json!({"type": "run_trajectory", "trajectory": trajectory}), code, name)
    }));
    bad
}

/// Well-formed trajectories that no robot should follow.
fn bad_trajectories() -> Vec<(TimedJoints, &'static str, &'static str)> {
    let good = trajectory_to(20.0);
    let count = good.t_s.len();
    let with = |change: &dyn Fn(&mut TimedJoints)| {
        let mut trajectory = good.clone();
        change(&mut trajectory);
        trajectory
    };
    let faster = |times: f64| with(&|it| it.t_s.iter_mut().for_each(|t_s| *t_s /= times));
    let part = |range: std::ops::Range<usize>| TimedJoints {
        t_s: good.t_s[range.clone()].to_vec(),
        joints_rad: good.joints_rad[range].to_vec(),
    };
    // As if the robot had been there: the rest of the way, from zero.
    let from_zero = |mut it: TimedJoints| {
        let first = it.joints_rad[0][0];
        it.joints_rad.iter_mut().for_each(|q| q[0] -= first);
        it
    };
    vec![
        (with(&|it| it.t_s[9] = it.t_s[8]), "bad_request", "point 10"),
        (with(&|it| it.t_s[9] = it.t_s[7]), "bad_request", "point 10"),
        (with(&|it| it.t_s[9] = -1e300), "bad_request", "point 10"),
        (with(&|it| it.t_s.reverse()), "bad_request", "point 2"),
        (with(&|it| it.t_s.truncate(count - 1)), "bad_request", "stamps"),
        (with(&|it| it.joints_rad.truncate(count - 1)), "bad_request", "stamps"),
        (with(&|it| it.t_s[count - 1] = 1e300), "bad_request", "1.000e300 s"),
        (with(&|it| it.joints_rad[9][6] = 3.1), "limit", "point 10: joint 7"),
        (with(&|it| it.joints_rad[9][3] = -1e300), "limit", "point 10: joint 4"),
        (with(&|it| it.joints_rad[9][5] += 1e-3), "limit", "joint 6"),
        (
            with(&|it| it.joints_rad.iter_mut().for_each(|q| q[2] += 0.6_f64.to_radians())),
            "start_mismatch",
            "joint 3",
        ),
        (with(&|it| it.joints_rad[0][2] = 1e300), "start_mismatch", "joint 3"),
        (faster(3.0), "limit", "velocity of joint 1"),
        (faster(1.1), "limit", "acceleration of joint 1"),
        (part(0..count / 2), "limit", "end at rest"),
        (from_zero(part(count / 2..count)), "limit", "start at rest"),
    ]
}

#[test]
fn every_bad_request_is_answered_with_what_is_wrong_and_changes_nothing() {
    let rig = Rig::new(5);
    let asker = Asker::new(&rig.drive_config.instructions);
    let before = rig.cabinet().position();
    let assert_refused = |request: &str, code: &str, names: &[&str]| {
        let answer = asker.ask(request);
        assert_eq!(answer["ok"], false, "{request}: {answer}");
        assert_told(&answer["error"], code, names, request);
        assert_eq!(asker.ask(r#"{"type": "state"}"#)["state"], "idle", "{request}");
        assert_eq!(rig.cabinet().position().map(f64::to_bits), before.map(f64::to_bits));
    };
    let mut count = 0;
    for good in good_requests() {
        let name = good["type"].as_str().unwrap();
        let mut with_more = good.clone();
        with_more["speed"] = json!(1);
        assert_refused(&with_more.to_string(), "bad_request", &["`speed`"]);
        for (request, field) in spoilt(&good, &fields_of(name)) {
            assert_refused(
                &request,
                "bad_request",
                &[&field, "column", "motion 1", "points", "no input or output", "true or false"],
            );
            count += 1;
        }
    }
    for (request, code, name) in bad_requests() {
        assert_refused(&request, code, &[name]);
        count += 1;
    }
    for body in [b"\xff".as_slice(), b"{\"type\": \"st\xc3\"}", b"\0", b"\xef\xbb\xbf{}"] {
        let answer = asker.ask_bytes(body);
        assert!(answer.contains("bad_request"), "{answer}");
    }
    assert!(count > 200, "{count}");

    assert_refused(r#"{"type": "last_run"}"#, "bad_request", &["no run"]);
    for good in good_requests() {
        let answer = asker.ask(&good.to_string());
        assert_eq!(answer["ok"], true, "{good}: {answer}");
    }
    assert_eq!(good_requests().len(), Request::TYPES.len());
}

#[test]
fn ids_of_every_kind_come_back() {
    let rig = Rig::new(5);
    let asker = Asker::new(&rig.drive_config.instructions);
    let deep = format!("{}{}", "[".repeat(10_000), "]".repeat(10_000));
    let ids = [
        "null",
        "true",
        "-0.0",
        "12345678901234567890123",
        "1e5",
        r#""a\n\u0000""#,
        "[]",
        "[ 1,  2 ]",
        r#"{"b": {}, "a": null}"#,
        deep.as_str(),
    ];
    for id in ids {
        for rest in [
            r#""type": "state"}"#,
            r#""type": "read_sensors"}"#,
            r#""type": "get_io", "name": "x"}"#,
            r#""type": "state", "x": 1}"#,
            r#""type": "fly"}"#,
            r#""type": 3}"#,
            r#""type": "state", "type": "state"}"#,
            r#""types": []}"#,
        ] {
            let answer = asker.ask_bytes(format!("{{\"id\": {id}, {rest}").as_bytes());
            assert!(answer.contains(&format!("\"id\":{id}")), "{id}, {rest}: {answer}");
        }
    }
    for without in [r#"{"type": "state"}"#, r#"{"type": 3}"#, r#"{"id": 1"#, "{", "7"] {
        assert!(!asker.ask_bytes(without.as_bytes()).contains("\"id\""), "{without}");
    }
}

/// The robot program's socket for instructions.
#[test]
fn every_bad_instruction_is_answered_and_the_robot_program_goes_on() {
    let mut rig = Rig::parts(5);
    rig.start_cabinet();
    let asker = Asker::new(&rig.cabinet_config.instructions);
    let before = rig.cabinet().position();
    let seq = Field("/seq", Left::Never, &["3"]);
    let kind = Field("/type", Left::Never, &[]);
    let run = || Field("/run", Left::Never, &["3"]);
    let motions = good_requests()[0]["motions"].clone();
    let instructions = [
        (json!({"type": "run_motions", "run": 1, "motions": motions}), {
            let mut fields = fields_of("run_motions");
            fields.push(run());
            fields
        }),
        (json!({"type": "run_trajectory", "run": 1}), vec![run()]),
        (json!({"type": "end_trajectory", "run": 1}), vec![run()]),
        (json!({"type": "get_io", "name": "MediaFlange.LEDBlue"}), fields_of("get_io")),
        (
            json!({"type": "set_io", "name": "MediaFlange.LEDBlue", "value": true}),
            fields_of("set_io"),
        ),
        (json!({"type": "read_sensors"}), vec![kind]),
        (json!({"type": "stop"}), vec![seq]),
    ];
    for (mut good, fields) in instructions {
        good["seq"] = json!(7);
        for (instruction, field) in spoilt(&good, &fields) {
            let answer = asker.ask(&instruction);
            let names =
                [&field, "column", "motion 1", "no input or output", "true or false", "`x`"];
            assert_told(&answer["error"], "bad_request", &names, &instruction);
            let head: Value = serde_json::from_str(&instruction).unwrap();
            if head["seq"].is_u64() && head["type"].is_string() {
                assert_eq!(answer["seq"], 7, "{instruction}");
            }
        }
    }
    for garbage in [
        String::new(),
        "{}".to_owned(),
        "[]".to_owned(),
        "null".to_owned(),
        r#"{"seq": 1, "seq": 1, "type": "stop"}"#.to_owned(),
        r#"{"seq": 18446744073709551616, "type": "stop"}"#.to_owned(),
        format!(r#"{{"seq": 1, "type": "{}\u001b"}}"#, "x".repeat(10_000)),
        r#"{"seq": 1, "type": "fly\u001b"}"#.to_owned(),
        "[".repeat(100_000),
    ] {
        let answer = asker.ask(&garbage);
        assert_told(&answer["error"], "bad_request", &["column", "fly", "xxx..."], &garbage);
    }
    assert!(asker.ask_bytes(b"\xff\xfe").contains("bad_request"));
    asker.socket.send_multipart(["{}", "{}"], 0).unwrap();
    assert!(asker.socket.recv_string(0).unwrap().unwrap().contains("one frame"));
    // Requests of peers that do not speak as REQ does get no answer, and harm nobody.
    let dealer = zmq::Context::new().socket(zmq::DEALER).unwrap();
    dealer.set_linger(0).unwrap();
    dealer.connect(&rig.cabinet_config.instructions).unwrap();
    for frames in [[b"x".as_slice(), b"y"].as_slice(), &[b""], &[b"", b""], &[b"{}"]] {
        dealer.send_multipart(frames, 0).unwrap();
    }
    let outside = json!({"seq": 8, "type": "run_motions", "run": 1, "motions":
        [{"type": "ptp", "joints_deg": [171, 0, 0, 0, 0, 0, 0]}]});
    let answer = asker.ask(&outside.to_string());
    assert_told(&answer["error"], "limit", &["joint 1"], "outside");
    assert_eq!(rig.cabinet().position(), before);
    let answer = asker.ask(r#"{"seq": 9, "type": "get_io", "name": "MediaFlange.LEDBlue"}"#);
    assert_eq!((&answer["seq"], &answer["value"]), (&json!(9), &json!(false)));
    rig.start_drive();
    rig.wait_until_ready();
    rig.client().run_trajectory(trajectory_to(1.0), Some(LONG)).unwrap();
}

/// A robot program of the worst kind: it says and answers what it is told to. The controller beside it
/// is a good one.
struct Liar {
    instructions: zmq::Socket,
    state: zmq::Socket,
}

/// The way back to the drive, and the instruction.
type Told = (Vec<Vec<u8>>, Value);

impl Liar {
    /// With a drive that has heard of both, of the robot program that it is idle.
    fn new() -> (Rig, Self) {
        let mut rig = Rig::parts(5);
        rig.cabinet_config.instructions = free_tcp();
        rig.cabinet_config.state = free_tcp();
        rig.start_cabinet();
        let context = zmq::Context::new();
        let bound = |kind, at: &str| {
            let socket = context.socket(kind).unwrap();
            socket.set_linger(0).unwrap();
            socket.set_rcvtimeo(10_000).unwrap();
            socket.set_sndtimeo(10_000).unwrap();
            socket.bind(at).unwrap();
            socket
        };
        let liar = Self {
            instructions: bound(zmq::ROUTER, &rig.drive_config.cabinet_instructions),
            state: bound(zmq::DEALER, &rig.drive_config.cabinet_state),
        };
        rig.start_drive();
        liar.say_idle();
        rig.wait_until_ready();
        (rig, liar)
    }

    /// Says something of its state, and waits until that is acknowledged.
    fn say(&self, state: &[u8]) {
        self.state.send_multipart([b"".as_slice(), state], 0).unwrap();
        let answer = self.state.recv_multipart(0).expect("an acknowledgement");
        assert_eq!(answer, [b"".as_slice(), br#"{"ok":true}"#]);
    }

    fn say_idle(&self) {
        self.say(br#"{"boot": 1, "state": "idle"}"#);
    }

    /// What the drive tells it next, if it comes in that many milliseconds.
    fn hear_within(&self, timeout: i64) -> Option<Told> {
        (self.instructions.poll(zmq::POLLIN, timeout).unwrap() > 0).then(|| self.hear())
    }

    /// What the drive tells it next.
    fn hear(&self) -> Told {
        let mut frames = self.instructions.recv_multipart(0).expect("an instruction");
        let body = frames.pop().unwrap();
        (frames, serde_json::from_slice(&body).unwrap())
    }

    fn answer(&self, (route, _): &Told, answer: &str) {
        let frames = route.iter().map(Vec::as_slice).chain([answer.as_bytes()]);
        self.instructions.send_multipart(frames, 0).unwrap();
    }

    /// Answers as a good one does.
    fn acknowledge(&self, told: &Told, more: &str) {
        let seq = &told.1["seq"];
        self.answer(told, &format!("{{\"seq\": {seq}{more}}}"));
    }
}

fn ask<T: Send + 'static>(
    rig: &Rig,
    what: impl FnOnce(&mut Client) -> Result<T, ClientError> + Send + 'static,
) -> JoinHandle<Result<T, ClientError>> {
    let mut client = rig.client();
    thread::spawn(move || what(&mut client))
}

fn get_io(rig: &Rig) -> JoinHandle<Result<IoValue, ClientError>> {
    ask(rig, |client| client.get_io("x"))
}

fn run(rig: &Rig) -> JoinHandle<Result<Run, ClientError>> {
    ask(rig, |client| {
        loop {
            match client.run_trajectory(trajectory_to(5.0), Some(LONG)) {
                // The machine stood still for some cycles.
                Err(error) if error.to_string().contains("not good enough") => {
                    thread::sleep(Duration::from_millis(50));
                }
                other => return other,
            }
        }
    })
}

#[test]
fn the_drive_takes_no_harm_of_garbage_for_a_state() {
    use Left::{Never, Out};

    let (rig, liar) = Liar::new();
    let good = json!({"boot": 1, "state": "idle", "run": 3, "outcome":
        {"run": 2, "start_s": 1.0, "end_s": 2.0, "error": {"code": "robot", "message": "m"}}});
    let fields = [
        Field("/boot", Never, &["3"]),
        Field("/state", Never, &[]),
        Field("/run", Out, &["3", "null"]),
        Field("/outcome", Out, &["null"]),
        Field("/outcome/run", Never, &["3"]),
        Field("/outcome/start_s", Out, &["3", "-0.5", "null"]),
        Field("/outcome/end_s", Never, NUMBER),
        Field("/outcome/error", Out, &["null"]),
        Field("/outcome/error/code", Never, &[]),
        Field("/outcome/error/message", Never, &["\"x\""]),
    ];
    let mut garbage: Vec<_> =
        spoilt(&good, &fields).into_iter().map(|(state, _)| state.into_bytes()).collect();
    garbage.extend(["", "{}", "[1, \"running_motion\"]", "null"].map(Into::into));
    garbage.push(vec![b'['; 50_000]);
    garbage.push(vec![0xff; 10]);
    garbage.push(br#"{"boot": 1, "state": "running_motion", "state": "idle"}"#.to_vec());
    for state in &garbage {
        liar.say(state);
    }
    liar.state.send_multipart(["", "{}", "{}"], 0).unwrap();
    liar.state.recv_multipart(0).expect("an acknowledgement");
    // Odd, but well-formed: outcomes of runs that there never were, at times that there are not.
    liar.say(good.to_string().as_bytes());
    liar.say(br#"{"boot": 1, "state": "idle", "outcome": {"run": 9, "start_s": 1e308, "end_s": -1e308}}"#);
    let status = rig.client().state().unwrap();
    assert_eq!((status.state, status.robot_program), (DriveState::Idle, Presence::Connected));
    // Garbage is no sign of life.
    let silent = || {
        liar.say(b"{}");
        rig.client().state().unwrap().robot_program == Presence::Silent
    };
    wait_for("silence", silent);
    liar.say(br#"{"boot": 1, "state": "running_motion", "run": 5}"#);
    let state = || rig.client().state().unwrap().state;
    wait_for("the state", || state() == DriveState::RunningMotion);
    assert_eq!(rig.client().get_io("x").unwrap_err().code(), Code::NotIdle);
    liar.say_idle();
    wait_for("the state", || state() == DriveState::Idle);
}

#[test]
fn only_the_right_acknowledgement_counts() {
    let (rig, liar) = Liar::new();
    let client = get_io(&rig);
    let told = liar.hear();
    assert_eq!((&told.1["type"], &told.1["name"]), (&json!("get_io"), &json!("x")));
    let seq = told.1["seq"].as_u64().unwrap();
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
        liar.answer(&told, &wrong);
    }
    liar.acknowledge(&told, r#", "value": 7, "more": 1"#);
    // Once is enough.
    liar.acknowledge(&told, r#", "value": 8"#);
    assert_eq!(client.join().unwrap().unwrap(), IoValue::Digital(7));

    // What was not asked for is no answer.
    for more in ["", r#", "sensors": null"#] {
        let client = get_io(&rig);
        liar.acknowledge(&liar.hear(), more);
        let error = client.join().unwrap().unwrap_err();
        assert_eq!(error.code(), Code::Robot, "{error}");
    }
    let client = get_io(&rig);
    liar.acknowledge(&liar.hear(), r#", "error": {"code": "limit", "message": "so"}"#);
    assert_eq!(client.join().unwrap().unwrap_err().to_string(), "so (limit)");
}

#[test]
fn without_an_acknowledgement_clients_are_told_so_in_time() {
    let (rig, liar) = Liar::new();
    let first = get_io(&rig);
    let late = liar.hear();
    // These wait for their turn.
    let others = [get_io(&rig), get_io(&rig), get_io(&rig)];
    for client in others.into_iter().chain([first]) {
        let error = client.join().unwrap().unwrap_err();
        let ClientError::Refused { refusal, .. } = error else { panic!("{error}") };
        assert_eq!(refusal.code, Code::Timeout);
    }
    // The turn of one of them came; that of the others will not come behind their backs.
    let second = liar.hear();
    // The connection is another one by now, on which late answers do not arrive.
    let client = get_io(&rig);
    let told = liar.hear();
    for late in [late, second] {
        assert_ne!(told.0[0], late.0[0]);
        liar.acknowledge(&late, r#", "value": 1"#);
    }
    liar.acknowledge(&told, r#", "value": 2"#);
    assert_eq!(client.join().unwrap().unwrap(), IoValue::Digital(2));
    let nothing = liar.instructions.poll(zmq::POLLIN, 300).unwrap();
    assert_eq!(nothing, 0);
}

#[test]
fn a_run_that_is_not_acknowledged_never_began() {
    let (rig, liar) = Liar::new();
    let client = run(&rig);
    let late = liar.hear();
    assert_eq!(late.1["type"], "run_trajectory");
    let error = client.join().unwrap().unwrap_err();
    assert_eq!(error.code(), Code::Timeout, "{error}");
    liar.say_idle();
    liar.acknowledge(&late, "");
    assert_eq!(rig.client().state().unwrap().state, DriveState::Idle);
    // It has begun all the same: then it is ended, and again if that was not done.
    let run = &late.1["run"];
    let running = format!(r#"{{"boot": 1, "state": "running_trajectory", "run": {run}}}"#);
    for _ in 0..2 {
        // One word may overtake the acknowledgement before it, and then says nothing new.
        let told = (0..20).find_map(|_| {
            liar.say(running.as_bytes());
            liar.hear_within(500)
        });
        let told = told.expect("an instruction");
        assert_eq!(told.1["type"], "end_trajectory");
        liar.acknowledge(&told, "");
    }
    assert_eq!(rig.cabinet().position(), [0.0; 7]);
}

/// It waited behind a request when the robot program was missed.
#[test]
fn a_run_that_was_given_up_before_its_turn_does_not_begin() {
    let (rig, liar) = Liar::new();
    liar.say_idle();
    thread::sleep(Duration::from_millis(1500));
    let asked = get_io(&rig);
    assert_eq!(liar.hear().1["type"], "get_io");
    let error = run(&rig).join().unwrap().unwrap_err();
    assert_eq!(error.code(), Code::Robot, "{error}");
    assert_eq!(asked.join().unwrap().unwrap_err().code(), Code::Timeout);
    liar.say_idle();
    assert_eq!(liar.instructions.poll(zmq::POLLIN, 500).unwrap(), 0);
}

/// The robot program has taken on a run, and then knows nothing of it: nobody waits for ever.
#[test]
fn a_run_that_the_robot_program_forgets_ends() {
    let (rig, liar) = Liar::new();
    let client = run(&rig);
    liar.acknowledge(&liar.hear(), "");
    let since = Instant::now();
    while !client.is_finished() {
        assert!(since.elapsed() < LONG);
        liar.say(br#"{"boot": 1, "state": "idle", "outcome": {"run": 0, "end_s": 1.0}}"#);
        thread::sleep(Duration::from_millis(100));
    }
    let error = client.join().unwrap().unwrap_err();
    assert_eq!(error.code(), Code::Robot, "{error}");
    assert_eq!(rig.client().state().unwrap().state, DriveState::Idle);
}

/// A run of somebody else that will not end: the drive says so again and again, and goes on.
#[test]
fn a_robot_program_that_does_not_obey_keeps_nobody_from_the_drive() {
    let (rig, liar) = Liar::new();
    for _ in 0..20 {
        liar.say(br#"{"boot": 1, "state": "running_trajectory", "run": 77}"#);
    }
    let told = liar.hear();
    assert_eq!((&told.1["type"], &told.1["run"]), (&json!("end_trajectory"), &json!(77)));
    liar.say_idle();
    wait_for("the state", || rig.client().state().unwrap().state == DriveState::Idle);
    let client = get_io(&rig);
    let told = liar.hear();
    assert_eq!(told.1["type"], "get_io");
    liar.acknowledge(&told, r#", "value": true"#);
    assert_eq!(client.join().unwrap().unwrap(), IoValue::Boolean(true));
}
