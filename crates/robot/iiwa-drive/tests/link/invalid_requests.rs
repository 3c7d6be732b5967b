//! Invalid requests, with the error code and a text in the error message.

use iiwa_link::TimedJoints;
use serde_json::{Value, json};

use crate::link::corrupted::trajectory_to;

/// Short invalid requests, with a text in the error message.
pub(crate) const BAD_TEXTS: [(&str, &str); 36] = [
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
        r#"{"type": "run_trajectory",
            "trajectory": {"t_s": [0], "joints_rad": [[0,0,0,0,0,0,0]]}}"#,
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

/// Other invalid requests, with the error code and a text in the error message.
pub(crate) fn invalid_requests() -> Vec<(String, &'static str, &'static str)> {
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
        value(motion(json!({"type": "ptp", "joints_deg": to(120.1)})), "limit", "joint A4"),
        value(motion(json!({"type": "ptp", "joints_deg": to(-1e300)})), "limit", "joint A4"),
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
            motion(json!({"type": "ptp", "joints_deg": to(1.0), "blend": {"fraction": 0.6}})),
            "bad_request",
            "blend",
        ),
        value(motion(json!({"type": "wait", "seconds": 1e300})), "bad_request", "wait"),
        value(
            motion(json!({"type": "lin_rel", "offset": {"x_mm": 1}})),
            "limit",
            "motion 1: at 0.0 % of the way, the arm is singular",
        ),
        value(
            motion(json!({"type": "ptp", "frame": "nowhere"})),
            "bad_request",
            "motion 1: unknown frame `nowhere`; the program names none, at line 1, column",
        ),
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

/// Well-formed trajectories that are not feasible.
pub(crate) fn bad_trajectories() -> Vec<(TimedJoints, &'static str, &'static str)> {
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
    // Returns the trajectory shifted to start at zero.
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
        (with(&|it| it.joints_rad[9][6] = 3.1), "limit", "point 10: joint A7"),
        (with(&|it| it.joints_rad[9][3] = -1e300), "limit", "point 10: joint A4"),
        (with(&|it| it.joints_rad[9][5] += 1e-3), "limit", "joint A6"),
        (
            with(&|it| it.joints_rad.iter_mut().for_each(|q| q[2] += 0.6_f64.to_radians())),
            "start_mismatch",
            "joint A3",
        ),
        (with(&|it| it.joints_rad[0][2] = 1e300), "start_mismatch", "joint A3"),
        (faster(3.0), "limit", "velocity of joint A1"),
        (faster(1.1), "limit", "acceleration of joint A1"),
        (part(0..count / 2), "limit", "end at rest"),
        (from_zero(part(count / 2..count)), "limit", "start at rest"),
    ]
}
