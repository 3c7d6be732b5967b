//! Motions with tools, bases and frames through the simulated cabinet, which plans them.

use iiwa_kin::{Joints, Pose, Robot};
use iiwa_link::{
    ClientError,
    message::{Code, DriveState},
};
use iiwa_program::{MotionList, OperatingMode};
use serde_json::{Value, json};

use crate::link::{
    request_socket::{RequestSocket, assert_error},
    rig::{LONG, Rig, wait_for},
    runs::{assert_as_planned, planned_from},
};

const START_DEG: Joints = [0.0, 30.0, 0.0, -60.0, 0.0, 90.0, 0.0];

/// Returns a request with all kinds of motions and blends between them.
fn request(mode: Option<&str>) -> Value {
    let down = |x: f64, y: f64, z: f64| {
        json!({
            "base": "table", "x_mm": x, "y_mm": y, "z_mm": z, "a_deg": 0, "b_deg": 180, "c_deg": 0
        })
    };
    let near = json!({"cart_mm": 20});
    let mut request = json!({
        "type": "run_motions",
        "tools": {"gripper": {"tcp": {"z_mm": 120}, "tips": {"finger": {"z_mm": 140, "y_mm": 20}},
            "load": {"mass_kg": 1.5, "abc_deg": [10, 20, 30]}}},
        "bases": {"table": {"x_mm": 500, "y_mm": -150, "z_mm": 100}},
        "frames": {
            "pick": down(0.0, 0.0, 150.0), "via": down(60.0, 150.0, 150.0),
            "place": down(0.0, 300.0, 150.0)
        },
        "tool": "gripper",
        "base": "table",
        "motions": [
            {"type": "ptp", "frame": "pick", "velocity_rel": 0.5, "blend": near},
            {"type": "lin_rel", "offset": {"z_mm": -60}, "cart_velocity_mm_s": 250, "blend": near},
            {"type": "circ", "aux": "via", "frame": "place", "cart_velocity_mm_s": 300,
             "blend": near},
            {"type": "lin", "frame": "pick", "tool": "gripper/finger", "cart_velocity_mm_s": 250,
             "blend": near},
            {"type": "spline", "cart_velocity_mm_s": 250, "blend": near, "segments": [
                {"type": "spl", "frame": "via"}, {"type": "lin", "frame": "place"}]},
            {"type": "ptp", "joints_deg": START_DEG, "velocity_rel": 0.5},
            {"type": "wait", "seconds": 0.1},
        ],
    });
    if let Some(mode) = mode {
        request["mode"] = json!(mode);
    }
    request
}

fn list(request: &Value) -> MotionList {
    MotionList::from_json(&request.to_string()).unwrap()
}

fn start_rad() -> Joints {
    START_DEG.map(f64::to_radians)
}

/// Starts a cabinet and a drive, with the robot in a bent pose.
fn bent_rig() -> Rig {
    let mut rig = Rig::parts(5);
    rig.cabinet_config.start_rad = start_rad();
    rig.start_drive();
    rig.start_cabinet();
    rig.wait_until_ready();
    rig
}

#[test]
fn motions_with_frames_take_the_planned_time_and_path() {
    let rig = bent_rig();
    let mut cycle_times_s = Vec::new();
    for mode in [None, Some("t1")] {
        let motions = list(&request(mode));
        let plan = planned_from(start_rad(), motions.clone());
        assert!(plan.path().blends().count() >= 5, "blends between all of them");
        let run = rig.client().run_motions(motions, Some(LONG)).unwrap();
        assert_as_planned(&run, &plan, 0.005);
        cycle_times_s.push(run.cycle_time_s.unwrap());
    }
    // The operating mode takes effect: 225 mm/s is less than the speed of some motions.
    assert!(cycle_times_s[1] > 1.05 * cycle_times_s[0], "{cycle_times_s:?}");
}

/// JSON request, as sent by a client in another language.
#[test]
fn a_request_with_frames_is_replied_to() {
    let rig = bent_rig();
    let socket = RequestSocket::new(&rig.drive_config.instructions);
    let mut short = request(None);
    short["id"] = json!(["mine"]);
    short["motions"] = json!([
        {"type": "lin_rel", "offset": {"x_mm": 20}, "in": "pick"},
        {"type": "lin_rel", "offset": {"x_mm": -20}, "in": "pick"},
    ]);
    let answer = socket.request(&short.to_string());
    assert_eq!((&answer["ok"], &answer["id"]), (&json!(true), &json!(["mine"])), "{answer}");
    let plan = planned_from(start_rad(), list(&short));
    let late_s = answer["cycle_time_s"].as_f64().unwrap() - plan.cycle_time_s();
    assert!((-1e-6..0.005 + 1e-6).contains(&late_s), "late by {late_s} s");
}

/// A linear motion sideways and up, stopped on the way, remains on the line and keeps its
/// orientation.
#[test]
fn a_stopped_line_stays_a_line() {
    let rig = bent_rig();
    let mut long = request(None);
    long["motions"] = json!([{
        "type": "lin_rel", "offset": {"y_mm": 160, "z_mm": -50}, "cart_velocity_mm_s": 60
    }]);
    let motions = list(&long);
    let running = {
        let mut client = rig.client();
        std::thread::spawn(move || client.run_motions(motions, Some(LONG)))
    };
    let robot = Robot::default();
    let tcp = Pose { position_m: [0.0, 0.0, 0.12], ..Pose::IDENTITY };
    let pose = |q: &Joints| robot.flange_pose(q).then(&tcp);
    let from = pose(&start_rad());
    let way_m = |q: &Joints| {
        let offset: [f64; 3] = std::array::from_fn(|i| pose(q).position_m[i] - from.position_m[i]);
        offset.iter().map(|x| x * x).sum::<f64>().sqrt()
    };
    wait_for("motion", || running.is_finished() || way_m(&rig.cabinet().position()) > 0.04);
    rig.stop();
    let (refusal, run) = match running.join().unwrap() {
        Err(ClientError::Refused { refusal, run: Some(run) }) => (refusal, run),
        other => panic!("the run has not been stopped: {other:?}"),
    };
    assert_eq!(refusal.code, Code::Robot, "{refusal}");
    assert!(refusal.message.contains("stopped on request at"), "{refusal}");
    assert_eq!(rig.client().state().unwrap().state, DriveState::Idle);
    let stopped_m = way_m(&rig.cabinet().position());
    assert!((0.04..0.14).contains(&stopped_m), "{stopped_m} m of 0.168");
    // Distance of the measured positions from the planned path.
    let plan = planned_from(start_rad(), list(&long));
    let planned: Vec<Joints> =
        (0..=4000).map(|i| plan.at(plan.cycle_time_s() * f64::from(i) / 4000.0).q).collect();
    for q in &run.samples.joints_rad {
        let off_rad = |on: &Joints| (0..7).map(|j| (q[j] - on[j]).abs()).fold(0.0, f64::max);
        let off_rad = planned.iter().map(off_rad).fold(f64::MAX, f64::min);
        assert!(off_rad < 1e-4, "off by {off_rad} rad");
    }
}

/// Refused requests without motion: the change, the code, and a text in the message.
#[test]
#[expect(clippy::too_many_lines, reason = "a table of cases")]
fn impossible_programs_are_refused() {
    let rig = bent_rig();
    let socket = RequestSocket::new(&rig.drive_config.instructions);
    let before = rig.cabinet().position();
    let far = json!({"x_mm": 1500, "y_mm": 0, "z_mm": 150, "a_deg": 0, "b_deg": 180, "c_deg": 0});
    let long = "x".repeat(5000);
    let cases = [
        (
            "/tool",
            json!("griper"),
            "bad_request",
            "unknown tool `griper`; did you mean `gripper`?, at line 1, column",
        ),
        (
            "/tool",
            json!("gripper/tip"),
            "bad_request",
            "unknown tool `gripper/tip`; there are `gripper`, `gripper/finger`, at line 1, column",
        ),
        ("/tool", json!(long), "bad_request", "xxx..."),
        ("/tool", json!("\u{1b}[2J"), "bad_request", "`\\u{1b}[2J`"),
        ("/tool", json!(1), "bad_request", "column"),
        (
            "/base",
            json!("shelf"),
            "bad_request",
            "unknown base `shelf`; there is `table`, at line 1, column",
        ),
        ("/mode", json!("t3"), "bad_request", "unknown value `t3`"),
        ("/tools/gripper/tcp/z_mm", json!("120"), "bad_request", "column"),
        ("/tools/gripper/tcp", json!({"z": 120}), "bad_request", "unknown key `z`"),
        (
            "/bases/table",
            json!({"base": "table"}),
            "bad_request",
            "the base `table` refers to itself",
        ),
        ("/frames/pick/base", json!("shelf"), "bad_request", "motion 1: unknown base `shelf`"),
        (
            "/frames/pick",
            json!({"x_mm": 1}),
            "bad_request",
            "`a_deg`, `b_deg` and `c_deg` are missing",
        ),
        ("/frames/pick/status", json!(8), "bad_request", "`pick`: status is 8"),
        (
            "/motions/0/frame",
            json!("peck"),
            "bad_request",
            "motion 1: unknown frame `peck`; did you mean `pick`?, at line 1, column",
        ),
        ("/motions/2/aux", json!("vea"), "bad_request", "motion 3: unknown frame `vea`"),
        (
            "/motions/2/aux",
            json!("place"),
            "bad_request",
            "motion 3: start, auxiliary frame and end are on one line",
        ),
        ("/motions/3/tool", json!("drill"), "bad_request", "motion 4: unknown tool `drill`"),
        (
            "/motions/4/segments/0/frame",
            json!("vea"),
            "bad_request",
            "motion 5: segment 1: unknown frame `vea`",
        ),
        (
            "/motions/4/segments/1/type",
            json!("fly"),
            "bad_request",
            "motion 5: unknown value `fly`",
        ),
        (
            "/motions/1/cart_velocity_mm_s",
            json!(0),
            "bad_request",
            "motion 2: cart_velocity_mm_s is 0",
        ),
        ("/motions/0/frame", far.clone(), "limit", "motion 1: the frame is"),
        ("/motions/3/frame", far, "limit", "motion 4: the frame is"),
        (
            "/motions/1/offset",
            json!({"x_mm": -900}),
            "limit",
            "motion 2: the frame is out of reach",
        ),
        ("/motions/4/segments/0/frame/e1_deg", json!(175), "limit", "motion 5"),
        ("/motions/5/joints_deg/3", json!(120.1), "limit", "motion 6: joint A4"),
    ];
    for (path, value, code, text) in cases {
        let mut request = request(Some("t1"));
        if let Some((owner, "e1_deg")) = path.rsplit_once('/') {
            let mut frame = request["frames"]["via"].clone();
            frame["e1_deg"] = value;
            *request.pointer_mut(owner).unwrap() = frame;
        } else if path == "/frames/pick/status" {
            request["frames"]["pick"]["status"] = value;
        } else {
            *request.pointer_mut(path).expect(path) = value;
        }
        let request = request.to_string();
        let answer = socket.request(&request);
        assert_eq!(answer["ok"], false, "{path}: {answer}");
        assert_error(&answer["error"], code, &[text], &request);
        assert_eq!(rig.cabinet().position().map(f64::to_bits), before.map(f64::to_bits), "{path}");
    }
    assert_eq!(socket.request(r#"{"type": "state"}"#)["state"], "idle");
    // Refused requests do not affect the next run.
    let mut good = request(None);
    good["motions"] = json!([{"type": "lin_rel", "offset": {"z_mm": -10}}]);
    assert_eq!(list(&good).workcell.mode, OperatingMode::Automatic);
    rig.client().run_motions(list(&good), Some(LONG)).unwrap();
}

/// Bounds: spline segments count as motions, and omitted keys count as written.
#[test]
fn requests_that_grow_are_refused() {
    let rig = bent_rig();
    let socket = RequestSocket::new(&rig.drive_config.instructions);
    let mut many = request(None);
    let spline =
        json!({"type": "spline", "segments": vec![json!({"type": "spl", "frame": "pick"}); 20]});
    many["motions"] = json!(vec![spline; 251]);
    let answer = socket.request(&many.to_string());
    assert_error(
        &answer["error"],
        "bad_request",
        &["251 motions that make 5020", "at most 5000"],
        "splines",
    );
    let mut large = request(None);
    let bases =
        (0..60_000).map(|i| (i.to_string(), json!({}))).chain([("table".to_owned(), json!({}))]);
    large["bases"] = Value::Object(bases.collect());
    let large = large.to_string();
    assert!(large.len() < 1 << 20);
    let answer = socket.request(&large);
    assert_error(&answer["error"], "bad_request", &["written out in full"], "bases");
}
