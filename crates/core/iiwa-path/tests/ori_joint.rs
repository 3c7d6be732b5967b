//! Paths with linear wrist joints, through poses with A6 = 0.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use iiwa_kin::{Pose, Robot};
use iiwa_path::{JointPath, Segment, Step};
use iiwa_program::Program;
use serde_json::{Value, json};

fn program(motions: &Value) -> Value {
    json!({
        "version": 1,
        "tools": { "gripper": { "tcp": { "x_mm": 15, "z_mm": 120, "b_deg": 20 } } },
        "tool": "gripper",
        "start": { "joints_deg": [10, 40, 20, -70, 15, 30, 40] },
        "motions": motions
    })
}

fn plan(program: &Value) -> Result<JointPath, String> {
    let text = serde_json::to_string_pretty(program).unwrap();
    let program = Program::from_json(&text).map_err(|error| error.to_string())?;
    JointPath::new(&program, &Robot::default())
        .map_err(|fault| format!("{fault}, at {}", fault.place_in(&text)))
}

fn tcp() -> Pose {
    Pose::from_xyz_abc([0.015, 0.0, 0.12], [0.0, 20_f64.to_radians(), 0.0])
}

/// Target at joint positions in degrees.
fn target(joints_deg: [f64; 7]) -> Value {
    let joints = joints_deg.map(f64::to_radians);
    let robot = Robot::default();
    let pose = robot.flange_pose(&joints).then(&tcp());
    let [x, y, z] = pose.position_m.map(|m| 1e3 * m);
    let [a, b, c] = pose.abc_rad();
    let redundancy = robot.redundancy(&joints);
    json!({
        "x_mm": x, "y_mm": y, "z_mm": z, "a_rad": a, "b_rad": b, "c_rad": c,
        "e1_rad": redundancy.e1_rad, "status": redundancy.status.bits()
    })
}

fn only_move(path: &JointPath) -> &dyn Segment {
    let moves = path.steps().iter().find_map(|step| match step {
        Step::Move { segment, .. } => Some(segment.as_ref()),
        _ => None,
    });
    moves.unwrap()
}

/// A6 changes from 30 to -25 degrees: with the orientation law `variable`, the path would be
/// singular.
#[test]
fn a_line_passes_the_wrist_singularity() {
    let end = [16.0, 45.0, 20.0, -62.0, 5.0, -25.0, 60.0];
    let lin = |law: &str| json!([{ "type": "lin", "frame": target(end), "orientation": law }]);
    let path = plan(&program(&lin("ori_joint"))).unwrap();
    let way = only_move(&path);
    let at = |s: f64| Robot::default().flange_pose(&way.at(s).q).then(&tcp()).position_m;
    let (from, to) = (at(0.0), at(1.0));
    let start_rad = path.start_rad();
    let mut min_singularity = f64::MAX;
    for i in 0..=100 {
        let s = f64::from(i) / 100.0;
        let place = at(s);
        for k in 0..3 {
            assert!((place[k] - from[k] - s * (to[k] - from[k])).abs() < 3e-9, "{s}: {place:?}");
        }
        let q = way.at(s).q;
        for j in [2, 4, 5, 6] {
            let expected = start_rad[j] + s * (end[j].to_radians() - start_rad[j]);
            assert!((q[j] - expected).abs() < 3e-9, "{s}: A{}", j + 1);
        }
        min_singularity = min_singularity.min(Robot::default().singularity(&q).nearest().0);
    }
    assert!(min_singularity < 0.01, "{min_singularity}");
    let off = (0..7).map(|j| (way.at(1.0).q[j] - end[j].to_radians()).abs()).fold(0.0, f64::max);
    assert!(off < 1e-9, "{off}");
    // The default law keeps the status of the start, and does not end in that of the target.
    let usual = plan(&program(&lin("variable")));
    assert!(usual.is_err() || (only_move(&usual.unwrap()).at(1.0).q[5] > 0.0));
}

#[test]
fn circles_and_offsets_have_it_too() {
    let end = target([16.0, 45.0, 20.0, -62.0, 5.0, -25.0, 60.0]);
    let start = target([10.0, 40.0, 20.0, -70.0, 15.0, 30.0, 40.0]);
    let mut aux = end.clone();
    for key in ["x_mm", "y_mm", "z_mm"] {
        aux[key] = json!(0.5 * (start[key].as_f64().unwrap() + end[key].as_f64().unwrap()));
    }
    aux["z_mm"] = json!(aux["z_mm"].as_f64().unwrap() + 40.0);
    let circ = json!([{ "type": "circ", "aux": aux, "frame": end, "orientation": "ori_joint" }]);
    let path = plan(&program(&circ)).unwrap();
    assert!((only_move(&path).at(1.0).q[5].to_degrees() + 25.0).abs() < 1e-6);
    let offset = json!([
        { "type": "lin_rel", "offset": { "z_mm": 40, "b_deg": 10 }, "orientation": "ori_joint",
          "blend": { "cart_mm": 15 } },
        { "type": "lin_rel", "offset": { "x_mm": 40 } }
    ]);
    let path = plan(&program(&offset)).unwrap();
    assert_eq!(path.blends().count(), 1);
}

#[test]
fn it_reads_back_and_is_refused_where_it_cannot_be() {
    let end = [16.0, 45.0, 20.0, -62.0, 5.0, -25.0, 60.0];
    let text =
        program(&json!([{ "type": "lin", "frame": target(end), "orientation": "ori_joint" }]));
    let read = Program::from_json(&text.to_string()).unwrap();
    assert_eq!(Program::from_json(&read.to_json()).unwrap(), read);

    let mut other = target(end);
    other["status"] = json!(0);
    let cases = [
        (
            json!({ "type": "spl", "frame": target(end), "orientation": "ori_joint" }),
            "is for lin, lin_rel and circ",
        ),
        (
            json!({ "type": "lin", "frame": other, "orientation": "ori_joint" }),
            "only bit 4 may change",
        ),
    ];
    for (motion, words) in cases {
        let refused = plan(&program(&json!([motion]))).unwrap_err();
        assert!(refused.contains(words), "{refused}");
        assert!(refused.contains("at line"), "{refused}");
    }
}

/// A blend by the remaining rotation, which the wrist joints determine.
#[test]
fn blends_by_orientation_are_small() {
    let end = [16.0, 45.0, 20.0, -62.0, 5.0, -25.0, 60.0];
    let remaining = |ori_deg: f64| {
        let motions = json!([
            { "type": "lin", "frame": target(end), "orientation": "ori_joint",
              "blend": { "ori_deg": ori_deg } },
            { "type": "lin_rel", "offset": { "x_mm": 40 } }
        ]);
        let path = plan(&program(&motions)).unwrap();
        only_move(&path).at(1.0).q[5].to_degrees() - end[5]
    };
    let (little, more) = (remaining(1.0), remaining(5.0));
    assert!(little > 0.0 && little < 1.0, "{little}");
    assert!((more / little - 5.0).abs() < 1e-6, "{more} {little}");
}
