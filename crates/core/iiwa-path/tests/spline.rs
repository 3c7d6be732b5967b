//! TCP splines: they pass through their frames smoothly, and follow their lines and circles.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use iiwa_kin::{Joints, Pose, Robot};
use iiwa_path::{JointPath, Segment, SplineStop, Step};
use iiwa_program::{LimitKind, MotionIndex, Program};
use serde_json::{Value, json};

/// Start of the programs, with the wrist away from all singular poses.
const START_DEG: [f64; 7] = [0.0, 20.0, 0.0, -110.0, 0.0, -40.0, 90.0];

fn program(motions: &Value) -> Value {
    json!({ "version": 1, "start": { "joints_deg": START_DEG }, "motions": motions })
}

fn plan(program: &Value) -> Result<JointPath, String> {
    let text = serde_json::to_string_pretty(program).unwrap();
    let program = Program::from_json(&text).map_err(|error| error.to_string())?;
    JointPath::new(&program, &Robot::default())
        .map_err(|fault| format!("{fault}, at {}", fault.place_in(&text)))
}

/// A frame near the start: `y` and `z` in mm from it, rotated by `turn_deg` about the vertical
/// axis.
fn frame(y: f64, z: f64, turn_deg: f64) -> Value {
    let start = Robot::default().flange_pose(&START_DEG.map(f64::to_radians));
    let [x_mm, y_mm, z_mm] = start.position_m.map(|m| 1e3 * m);
    let [a, b, c] = start.abc_rad().map(f64::to_degrees);
    json!({
        "x_mm": x_mm, "y_mm": y_mm + y, "z_mm": z_mm + z,
        "a_deg": a + turn_deg, "b_deg": b, "c_deg": c
    })
}

#[expect(clippy::needless_pass_by_value, reason = "frames are made where they are used")]
fn segment(kind: &str, frame: Value) -> Value {
    json!({ "type": kind, "frame": frame })
}

fn spline(segments: &[Value]) -> Value {
    json!({ "type": "spline", "segments": segments })
}

/// Segments of motion, in order, up to the first stop.
fn moves(path: &JointPath) -> Vec<&dyn Segment> {
    let steps = path.steps().iter();
    let moves = steps.map_while(|step| match step {
        Step::Move { segment, .. } => Some(segment.as_ref()),
        _ => None,
    });
    moves.collect()
}

fn pose(q: &Joints) -> Pose {
    Robot::default().flange_pose(q)
}

fn off(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Largest jumps of the path where segments meet: of q, and of its first two derivatives with
/// respect to sigma.
fn jumps(moves: &[&dyn Segment]) -> [f64; 3] {
    let mut worst = [0.0_f64; 3];
    for ends in moves.windows(2) {
        let [a, b] = [(ends[0], 1.0), (ends[1], 0.0)].map(|(segment, s)| {
            let [one, two, _] = segment.sigma_derivatives(s);
            [segment.at(s).q, one, two]
        });
        for (worst, (a, b)) in worst.iter_mut().zip(a.iter().zip(&b)) {
            *worst = worst.max(off(a, b));
        }
    }
    worst
}

/// The figure of eight of the robot examples, with a rotation along it.
fn eight() -> Vec<Value> {
    [(50, 50), (100, 0), (50, -50), (0, 0), (-50, 50), (-100, 0), (-50, -50), (0, 0)]
        .map(|(y, z)| segment("spl", frame(f64::from(y), f64::from(z), 0.1 * f64::from(y))))
        .to_vec()
}

#[test]
fn it_goes_through_its_frames_without_a_stop() {
    let segments = eight();
    let path = plan(&program(&json!([spline(&segments)]))).unwrap();
    let moves = moves(&path);
    assert_eq!(moves.len(), segments.len());
    for (way, segment) in moves.iter().zip(&segments) {
        let pose = pose(&way.at(1.0).q);
        let number = |key: &str| segment["frame"][key].as_f64().unwrap();
        let actual = pose.position_m.map(|m| 1e3 * m);
        assert!(off(&actual, &["x_mm", "y_mm", "z_mm"].map(number)) < 1e-6, "{actual:?}");
        let angles = pose.abc_rad().map(f64::to_degrees);
        assert!(off(&angles, &["a_deg", "b_deg", "c_deg"].map(number)) < 1e-6, "{angles:?}");
    }
    let [q, dq, ddq] = jumps(&moves);
    assert!(q < 2e-9 && dq < 1e-7 && ddq < 1e-5, "{q} {dq} {ddq}");
}

/// All frames are in one plane, and so is the path.
#[test]
fn it_stays_in_the_plane_of_its_frames() {
    let path = plan(&program(&json!([spline(&eight())]))).unwrap();
    let x = pose(path.start_rad()).position_m[0];
    for way in moves(&path) {
        for i in 0..=20 {
            let x_m = pose(&way.at(f64::from(i) / 20.0).q).position_m[0];
            assert!((x_m - x).abs() < 2e-9, "{x_m} {x}");
        }
    }
}

/// The same frames in reverse give the same path.
#[test]
fn backwards_it_goes_the_same_way() {
    let places = [[60.0, 40.0], [90.0, -20.0], [20.0, -60.0], [-40.0, -10.0], [0.0, 0.0]];
    let spl = |[y, z]: [f64; 2]| segment("spl", frame(y, z, 0.2 * z));
    let forth: Vec<Value> = places.map(spl).to_vec();
    let mut back = vec![spl([0.0, 0.0])];
    back.extend(places[..4].iter().rev().copied().map(spl));
    back.push(spl([0.0, 0.0]));
    let forth = plan(&program(&json!([spline(&forth)]))).unwrap();
    // The first segment in reverse has zero length and is omitted.
    let back = plan(&program(&json!([spline(&back)]))).unwrap();
    let (forth, back) = (moves(&forth), moves(&back));
    assert_eq!(forth.len(), back.len());
    for (way, other) in forth.iter().zip(back.iter().rev()) {
        for i in 0..=10 {
            let s = f64::from(i) / 10.0;
            let [a, b] = [pose(&way.at(s).q), pose(&other.at(1.0 - s).q)];
            assert!(off(&a.position_m, &b.position_m) < 1e-8);
        }
    }
}

#[test]
fn of_one_segment_it_is_a_line() {
    let to = frame(80.0, -30.0, 25.0);
    let ways = [
        json!({ "type": "spl", "frame": to }),
        spline(&[segment("spl", to.clone())]),
        spline(&[segment("lin", to.clone())]),
        json!({ "type": "lin", "frame": to }),
    ];
    let ways = ways.map(|motion| plan(&program(&json!([motion]))).unwrap());
    let line = moves(&ways[3])[0];
    for way in &ways[..3] {
        let [way] = moves(way)[..] else { panic!("one segment") };
        for i in 0..=10 {
            let s = f64::from(i) / 10.0;
            assert!(off(&way.at(s).q, &line.at(s).q) < 3e-9);
        }
    }
}

/// Next to a line or a circle, a spline continues its direction and curvature.
#[test]
fn its_neighbours_bend_to_lines_and_circles() {
    let mut circ = segment("circ", frame(-100.0, 0.0, 0.0));
    circ["aux"] = frame(-60.0, 40.0, 0.0);
    let segments = [
        segment("spl", frame(40.0, 30.0, 5.0)),
        segment("lin", frame(80.0, 30.0, 10.0)),
        segment("spl", frame(0.0, -40.0, 0.0)),
        segment("spl", frame(-60.0, -40.0, 0.0)),
        circ,
    ];
    let path = plan(&program(&json!([spline(&segments)]))).unwrap();
    let moves = moves(&path);
    assert_eq!(moves.len(), 5);
    let [q, dq, ddq] = jumps(&moves);
    assert!(q < 2e-9 && dq < 1e-7 && ddq < 1e-5, "{q} {dq} {ddq}");
    let height = pose(path.start_rad()).position_m[2] + 0.03;
    for i in 0..=20 {
        let z_m = pose(&moves[1].at(f64::from(i) / 20.0).q).position_m[2];
        assert!((z_m - height).abs() < 2e-9);
    }
    let centre =
        circle([frame(-60.0, -40.0, 0.0), frame(-60.0, 40.0, 0.0), frame(-100.0, 0.0, 0.0)]);
    let radius = distance(&pose(&moves[4].at(0.0).q), centre);
    for i in 0..=20 {
        let actual = distance(&pose(&moves[4].at(f64::from(i) / 20.0).q), centre);
        assert!((actual - radius).abs() < 2e-9, "{actual} {radius}");
    }
}

/// Centre of the circle through three points in a plane of constant x: y and z in m.
fn circle(frames: [Value; 3]) -> [f64; 2] {
    let [[ay, az], [by, bz], [cy, cz]] =
        frames.map(|frame| ["y_mm", "z_mm"].map(|key| 1e-3 * frame[key].as_f64().unwrap()));
    let d = 2.0 * (ay * (bz - cz) + by * (cz - az) + cy * (az - bz));
    let [a, b, c] = [ay * ay + az * az, by * by + bz * bz, cy * cy + cz * cz];
    [
        (a * (bz - cz) + b * (cz - az) + c * (az - bz)) / d,
        (a * (cy - by) + b * (ay - cy) + c * (by - ay)) / d,
    ]
}

fn distance(pose: &Pose, [y, z]: [f64; 2]) -> f64 {
    (pose.position_m[1] - y).hypot(pose.position_m[2] - z)
}

#[test]
fn it_stops_where_two_lines_meet_at_an_angle() {
    let corner = [segment("lin", frame(80.0, 0.0, 0.0)), segment("lin", frame(80.0, 60.0, 0.0))];
    let path = plan(&program(&json!([spline(&corner)]))).unwrap();
    let [Step::Move { .. }, Step::Corner { .. }, Step::Move { .. }, Step::Settle { .. }] =
        path.steps()
    else {
        panic!("{:?}", path.steps())
    };
    assert_eq!(path.stops_in_splines(), [(MotionIndex::new(0), vec![SplineStop::After(1)])]);
    let straight = [segment("lin", frame(30.0, 0.0, 3.0)), segment("lin", frame(80.0, 0.0, 8.0))];
    let path = plan(&program(&json!([spline(&straight)]))).unwrap();
    assert_eq!((moves(&path).len(), path.stops_in_splines()), (2, vec![]));
    let [q, dq, ddq] = jumps(&moves(&path));
    assert!(q < 2e-9 && dq < 1e-6 && ddq < 1e-5, "{q} {dq} {ddq}");
}

#[test]
fn orientations_are_kept_or_ignored() {
    let with = |kind: &str, orientation: &str, frame: Value| {
        json!({
            "type": kind, "orientation": orientation, "frame": frame
        })
    };
    let segments = [
        with("spl", "constant", frame(40.0, 30.0, 20.0)),
        with("lin", "constant", frame(80.0, 30.0, 40.0)),
        with("spl", "ignore", frame(120.0, 0.0, -70.0)),
        segment("spl", frame(120.0, -60.0, 20.0)),
    ];
    let path = plan(&program(&json!([spline(&segments)]))).unwrap();
    let moves = moves(&path);
    let start = pose(path.start_rad()).rotation;
    for way in &moves[..2] {
        for i in 0..=10 {
            let rotation = pose(&way.at(f64::from(i) / 10.0).q).rotation;
            assert!(off(rotation.as_flattened(), start.as_flattened()) < 2e-9);
        }
    }
    let turn_deg = |way: &dyn Segment| {
        let turned = pose(&way.at(1.0).q);
        (turned.abc_rad()[0] - pose(path.start_rad()).abc_rad()[0]).to_degrees()
    };
    // In between, in proportion to chord length: 50 of 110 mm.
    assert!((turn_deg(moves[2]) - 20.0 * 50.0 / 110.0).abs() < 1e-6, "{}", turn_deg(moves[2]));
    assert!((turn_deg(moves[3]) - 20.0).abs() < 1e-6);
    let [q, dq, ddq] = jumps(&moves);
    assert!(q < 2e-9 && dq < 1e-7 && ddq < 1e-5, "{q} {dq} {ddq}");
}

/// The same pose with another E1 is a motion of the elbow with the TCP at rest, also in a spline,
/// with a stop before and after.
#[test]
fn the_elbow_may_move_alone() {
    let mut elbow = frame(60.0, 0.0, 0.0);
    elbow["e1_deg"] = json!(40.0);
    let segments = [
        segment("spl", frame(60.0, 0.0, 0.0)),
        segment("lin", elbow),
        segment("spl", frame(90.0, 20.0, 0.0)),
    ];
    let path = plan(&program(&json!([spline(&segments)]))).unwrap();
    let [
        Step::Move { .. },
        Step::Corner { .. },
        Step::Move { segment: alone, .. },
        Step::Corner { .. },
        Step::Move { .. },
        Step::Settle { .. },
    ] = path.steps()
    else {
        panic!("{:?}", path.steps())
    };
    let rest = pose(&alone.at(0.0).q);
    for i in 0..=10 {
        let s = f64::from(i) / 10.0;
        let q = alone.at(s).q;
        assert!(off(&pose(&q).position_m, &rest.position_m) < 2e-9);
        assert!((q[2].to_degrees() - 40.0 * s).abs() < 1e-6);
    }
}

/// To a frame, back, and on: stops where the TCP reverses, and at the repeated frame.
#[test]
fn it_stops_at_reversals_and_repeated_points() {
    let stops = |places: &[[f64; 2]]| {
        let spl = |[y, z]: &[f64; 2]| segment("spl", frame(*y, *z, 0.1 * y));
        let segments: Vec<Value> = places.iter().map(spl).collect();
        let path = plan(&program(&json!([spline(&segments)]))).unwrap();
        path.stops_in_splines()
    };
    let in_first = |places: &[SplineStop]| vec![(MotionIndex::new(0), places.to_vec())];
    let [a, b, c, d] = [[40.0, 30.0], [80.0, -10.0], [20.0, -40.0], [-30.0, 10.0]];
    assert_eq!(stops(&[a, b, c, d]), vec![]);
    assert_eq!(stops(&[a, b, a, c, d]), in_first(&[SplineStop::After(1), SplineStop::After(2)]));
    assert_eq!(stops(&[a, [0.0, 0.0], c, d]), in_first(&[SplineStop::After(1)]));
    assert_eq!(stops(&[a, b, b, c]), in_first(&[SplineStop::After(2)]));
    assert_eq!(stops(&[[0.0, 0.0], a, b, b]), vec![]);
}

#[test]
fn a_spline_can_be_blended() {
    let motions = json!([
        { "type": "lin", "frame": frame(0.0, 60.0, 0.0), "blend": { "cart_mm": 15 } },
        {
            "type": "spline", "blend": { "cart_mm": 10, "ori_deg": 4 },
            "segments": [
                segment("spl", frame(50.0, 60.0, 10.0)), segment("spl", frame(80.0, 0.0, 0.0)),
                segment("spl", frame(60.0, -50.0, 0.0))
            ]
        },
        { "type": "ptp", "joints_deg": [10, 25, 0, -100, 0, -40, 80] }
    ]);
    let path = plan(&program(&motions)).unwrap();
    assert_eq!(path.blends().count(), 2);
    let moves = moves(&path);
    assert_eq!(moves.len(), 7);
    let [q, dq, ddq] = jumps(&moves);
    assert!(q < 3e-9 && dq < 1e-6 && ddq < 1e-4, "{q} {dq} {ddq}");
    // The first blend starts at most 15 mm before the end of the first line: both sides have equal
    // length.
    let distance_m = pose(&moves[1].at(0.0).q).position_m[2] - pose(path.start_rad()).position_m[2];
    assert!((distance_m - 0.045).abs() < 1e-8, "{distance_m}");
}

#[test]
fn it_reads_back_as_it_is() {
    let mut circ = segment("circ", frame(-100.0, 0.0, 0.0));
    circ["aux"] = frame(-60.0, 40.0, 0.0);
    circ["circ_angle_deg"] = json!(200.0);
    circ["orientation_reference"] = json!("path");
    let motions = json!([
        { "type": "spl", "frame": frame(-60.0, -40.0, 0.0) },
        { "type": "spline", "segments": [circ, segment("spl", frame(0.0, 0.0, 0.0))],
          "cart_velocity_mm_s": 100.0 }
    ]);
    let program = Program::from_json(&program(&motions).to_string()).unwrap();
    let again = Program::from_json(&program.to_json()).unwrap();
    assert_eq!(Program::from_json(&again.to_json()).unwrap(), again);
    let written: Value = serde_json::from_str(&again.to_json()).unwrap();
    assert_eq!(written["motions"][0]["type"], "spl");
    assert_eq!(
        written["motions"][1]["segments"][0]["circ_angle_deg"].as_f64().unwrap().round(),
        200.0
    );
}

#[test]
fn invalid_splines_are_refused_with_their_place() {
    let to = || frame(40.0, 30.0, 0.0);
    let far = json!({ "x_mm": 3000, "y_mm": 0, "z_mm": 300, "a_deg": 0, "b_deg": 0, "c_deg": 180 });
    let with = |mut segment: Value, key: &str, value: Value| {
        segment[key] = value;
        segment
    };
    let spl = || segment("spl", to());
    let cases = [
        (spline(&[]), vec!["motion 1", "the spline has 0 segments"]),
        (spline(&vec![spl(); 21]), vec!["motion 1", "the spline has 21 segments", "from 1 to 20"]),
        (
            spline(&[spl(), with(spl(), "blend", json!({ "cart_mm": 5 }))]),
            vec!["motion 1", "segment 2", "blend the whole spline"],
        ),
        (spline(&[segment("circ", to())]), vec!["motion 1", "segment 1", "a circle needs `aux`"]),
        (
            spline(&[spl(), with(spl(), "aux", to())]),
            vec!["segment 2", "`aux` is for segments of type `circ`"],
        ),
        (spline(&[spl(), segment("spl", far)]), vec!["motion 1", "segment 2", "mm too short"]),
        (spline(&[segment("lin", json!("home"))]), vec!["segment 1", "unknown frame `home`"]),
        (spline(&[segment("ptp", to())]), vec!["motion 1", "`ptp`"]),
        (spline(&[json!([1, 2])]), vec!["motion 1", "expected"]),
        (
            json!({ "type": "lin", "frame": to(), "orientation": "ignore" }),
            vec!["motion 1", "`ignore` is for the segments of a spline"],
        ),
        (
            spline(&[spl(), segment("spl", frame(40.0, 30.0, 180.0))]),
            vec!["motion 1", "segment 2", "half a turn"],
        ),
    ];
    for (motion, words) in cases {
        let refused = plan(&program(&json!([motion]))).expect_err(&motion.to_string());
        for word in words {
            assert!(refused.contains(word), "{motion}: {refused}");
        }
        assert!(refused.contains("at line"), "{refused}");
        assert!(!refused.contains("at line 1, column 1"), "{refused}");
    }
}

/// A rotation to a frame taught slightly beside the last one is a short segment.
#[test]
fn turns_in_place_may_be_a_little_off() {
    for (off_mm, stops) in [(0.0, 2), (1e-4, 2), (0.05, 0), (1.0, 0)] {
        let segments = [
            segment("spl", frame(60.0, 0.0, 0.0)),
            segment("spl", frame(60.0 + off_mm, 0.0, 35.0)),
            segment("spl", frame(100.0, 20.0, 35.0)),
        ];
        let path = plan(&program(&json!([spline(&segments)]))).unwrap();
        let actual: usize = path.stops_in_splines().iter().map(|(_, places)| places.len()).sum();
        assert_eq!(actual, stops, "{off_mm} mm");
        let end = path.steps().iter().rev().find_map(|step| match step {
            Step::Move { segment, .. } => Some(pose(&segment.at(1.0).q)),
            _ => None,
        });
        let turned = end.unwrap().abc_rad()[0] - pose(path.start_rad()).abc_rad()[0];
        assert!((turned.to_degrees() - 35.0).abs() < 1e-6);
    }
}

/// A single SPL is not a list of segments.
#[test]
fn a_single_spl_is_refused_at_its_frame() {
    let refused = plan(&program(&json!([{ "type": "spl", "frame": "home" }]))).unwrap_err();
    assert!(refused.starts_with("motion 1: unknown frame `home`"), "{refused}");
}

/// A segment has its own limits if they are given, otherwise those of the spline.
#[test]
fn segments_have_separate_limits() {
    let with = |mut segment: Value, limits: &Value| {
        segment.as_object_mut().unwrap().extend(limits.as_object().unwrap().clone());
        segment
    };
    let slow = json!({ "cart_velocity_mm_s": 20, "velocity_rel": 0.5 });
    let segments = [
        segment("spl", frame(50.0, 30.0, 0.0)),
        with(segment("spl", frame(100.0, 0.0, 0.0)), &slow),
        segment("lin", frame(150.0, -30.0, 0.0)),
    ];
    let whole = json!({ "cart_velocity_mm_s": 250, "acceleration_rel": 0.4 });
    let path = plan(&program(&json!([with(spline(&segments), &whole)]))).unwrap();
    let full = path.robot().limits();
    let limits = [0, 1, 2].map(|step| path.limits_of(step));
    for (limits, [speed, share]) in limits.into_iter().zip([[0.25, 1.0], [0.02, 0.5], [0.25, 1.0]])
    {
        assert!((limits.tool().way[LimitKind::Velocity] - speed).abs() < 1e-15);
        assert!((limits.velocity_rad_s()[0] - share * full.velocity_rad_s[0]).abs() < 1e-15);
        assert!(
            (limits.acceleration_rad_s2()[0] - 0.4 * full.acceleration_rad_s2[0]).abs() < 1e-15
        );
    }
    // Writing and reading keeps the program.
    let text = serde_json::to_string(&program(&json!([spline(&segments)]))).unwrap();
    let read = Program::from_json(&text).unwrap();
    assert_eq!(Program::from_json(&read.to_json()).unwrap(), read);
    for (key, value) in
        [("cart_jerk_mm_s3", json!(0)), ("jerk_rel", json!(1.5)), ("jerk_rel", json!([1, 1]))]
    {
        let segments = [with(segments[0].clone(), &json!({ key: value })), segments[1].clone()];
        let refused = plan(&program(&json!([spline(&segments)]))).unwrap_err();
        assert!(refused.contains("motion 1") && refused.contains("at line"), "{refused}");
    }
}
