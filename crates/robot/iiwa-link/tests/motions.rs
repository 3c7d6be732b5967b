//! Round trip of requests and instructions with motions, exact to the last bit.

use iiwa_kin::Load;
use iiwa_link::{message::Request, robot_program::Instruction};
use iiwa_program::{Blend, Motion, MotionList, OperatingMode, Program, Ptp};
use proptest::prelude::*;
use serde_json::{Value, json};

/// Messages without tools, bases, frames and mode contain no additional keys.
#[test]
fn messages_of_joint_motions_have_no_other_keys() {
    let ptp = Ptp::to([0.5, 0.0, 0.0, -1.0, 0.0, 0.25, 0.0]).blend(Blend::CartMm(50.0));
    let motions = vec![
        Motion::Wait { seconds: 2.0, overlap: 0 },
        Motion::Ptp(ptp.velocity(0.5)),
        Motion::Ptp(Ptp::to([0.5; 7])),
    ];
    let list = concat!(
        r#""motions":[{"type":"wait","seconds":2.0},"#,
        r#"{"type":"ptp","joints_rad":[0.5,0.0,0.0,-1.0,0.0,0.25,0.0],"velocity_rel":0.5,"#,
        r#""blend":{"cart_mm":50.0}},"#,
        r#"{"type":"ptp","joints_rad":[0.5,0.5,0.5,0.5,0.5,0.5,0.5]}]"#
    );
    let request = Request::motions(motions.clone());
    assert_eq!(request.to_json(), format!(r#"{{"type":"run_motions",{list}}}"#));
    let instruction = Instruction::RunMotions { run: 3, motions: motions.into() };
    let text = format!(r#"{{"seq":7,"type":"run_motions","run":3,{list}}}"#);
    assert_eq!(instruction.to_json(7), text);
    assert_eq!(Request::from_json(request.to_json().as_bytes()).1, Ok(request));
    assert_eq!(Instruction::from_json(text.as_bytes()), (Some(7), Ok(instruction)));
}

#[test]
fn the_keys_of_programs_come_after_the_motions() {
    let text = r#"{"type":"run_motions","motions":[{"type":"lin","frame":"p"}],
        "tools":{"t":{"tcp":{"z_mm":120}}},"bases":{"b":{}},
        "frames":{"p":{"base":"b","x_mm":1,"y_mm":2,"z_mm":3,"a_deg":0,"b_deg":0,"c_deg":0}},
        "tool":"t","base":"b","mode":"t1","mount":{"rpy_deg":[180,0,0]}}"#;
    let (_, request) = Request::from_json(text.as_bytes());
    let Ok(Request::RunMotions { motions, .. }) = request else { panic!("{request:?}") };
    assert_eq!(motions.workcell.mode, OperatingMode::T1);
    let written = Request::motions(motions.clone()).to_json();
    let places = ["motions", "tools", "bases", "frames", "tool", "base", "mode", "mount"]
        .map(|key| written.rfind(&format!("\"{key}\":")).unwrap());
    assert!(places.is_sorted(), "{written}");
    let instruction = Instruction::RunMotions { run: 1, motions };
    let sent: Value = serde_json::from_str(&instruction.to_json(2)).unwrap();
    let request: Value = serde_json::from_str(&written).unwrap();
    assert_eq!(
        Instruction::from_json(instruction.to_json(2).as_bytes()),
        (Some(2), Ok(instruction.clone()))
    );
    for key in ["motions", "tools", "bases", "frames", "tool", "base", "mode", "mount"] {
        assert_eq!(sent[key], request[key], "{key}");
    }
}

/// Program keys that are invalid in requests, and invalid values of request keys.
#[test]
fn other_keys_are_refused() {
    for (key, value) in [
        ("robot", json!("lbr_iiwa_7_r800")),
        ("start", json!({"joints_deg": [0, 0, 0, 0, 0, 0, 0]})),
        ("include", json!("cell.json")),
        ("version", json!(1)),
        ("tools", json!(null)),
        ("tools", json!([])),
        ("tools", json!({"flange": {"tcp": {}}})),
        ("bases", json!({"robot": {}})),
        ("frames", json!({"tcp": {}})),
        ("tool", json!("t")),
        ("base", json!("b")),
        ("mode", json!("aut")),
        ("mode", json!(1)),
    ] {
        let mut request =
            json!({"type": "run_motions", "motions": [{"type": "wait", "seconds": 1}]});
        assert!(Request::from_json(request.to_string().as_bytes()).1.is_ok());
        request[key] = value;
        let text = request.to_string();
        let refusal = Request::from_json(text.as_bytes()).1.unwrap_err();
        assert!(refusal.message.contains("at line 1, column"), "{text}: {refusal}");
        request["run"] = json!(1);
        request["seq"] = json!(2);
        let (seq, instruction) = Instruction::from_json(request.to_string().as_bytes());
        assert_eq!(seq, Some(2));
        assert!(instruction.unwrap_err().message.contains("column"), "{text}");
    }
}

/// Keys of the program schema that a list of motions has, too, are known to requests and
/// instructions. `null` is not valid for all of them.
#[test]
fn keys_of_motion_lists_are_known() {
    const OF_PROGRAMS: [&str; 9] = [
        "$schema",
        "version",
        "robot",
        "flange_mm",
        "include",
        "start",
        "limit_torque_percent",
        "override_percent",
        "tasks",
    ];
    let schema = Program::schema();
    let keys = schema["properties"].as_object().unwrap().keys();
    for key in keys.filter(|key| !OF_PROGRAMS.contains(&key.as_str())) {
        let mut message = json!({"type": "run_motions", "seq": 2, "run": 1,
            "motions": [{"type": "wait", "seconds": 1}]});
        if key != "motions" {
            message[key] = json!(null);
        }
        let instruction = Instruction::from_json(message.to_string().as_bytes()).1;
        let message = message.as_object_mut().unwrap();
        message.retain(|key, _| key != "seq" && key != "run");
        let request = Request::from_json(json!(message).to_string().as_bytes()).1;
        for refusal in [request.err(), instruction.err()].into_iter().flatten() {
            assert!(!refusal.message.contains("unknown"), "{key}: {refusal}");
        }
    }
}

fn number() -> impl Strategy<Value = f64> {
    prop_oneof![-400.0..400.0, -1e-9..1e-9, -1e9..1e9]
}

fn positive() -> impl Strategy<Value = f64> {
    prop_oneof![1e-3..2000.0, 1e-9..1e9]
}

fn share() -> impl Strategy<Value = f64> {
    1e-6..1.0
}

fn pose() -> BoxedStrategy<Value> {
    proptest::array::uniform6(number()).prop_map(|[x, y, z, a, b, c]| {
        json!({"x_mm": x, "y_mm": y, "z_mm": z, "a_deg": a, "b_deg": b, "c_deg": c})
    })
    .boxed()
}

fn target() -> BoxedStrategy<Value> {
    let frame = (pose(), number(), 0..8_u8, 0..128_u8).prop_map(|(mut pose, e1, status, turn)| {
        pose["e1_deg"] = json!(e1);
        pose["status"] = json!(status);
        pose["turn"] = json!(turn);
        pose["base"] = json!("table");
        pose
    });
    prop_oneof![Just(json!("pick")), frame].boxed()
}

/// Returns a motion, written as in a program.
fn motion() -> BoxedStrategy<Value> {
    let limits = (positive(), positive(), positive(), share(), 0.0..180.0);
    let course = prop_oneof![
        target().prop_map(|to| json!({"type": "ptp", "frame": to})),
        target().prop_map(|to| json!({"type": "lin", "frame": to})),
        target().prop_map(|to| json!({"type": "spl", "frame": to})),
        (pose(), number())
            .prop_map(|(by, e1)| json!({"type": "lin_rel", "offset": by, "e1_deg": e1})),
        (target(), target(), 1.0..360.0).prop_map(|(aux, to, angle)| {
            json!({"type": "circ", "aux": aux, "frame": to, "circ_angle_deg": angle})
        }),
        proptest::collection::vec(target(), 1..5).prop_map(|to| {
            let segment = |to| json!({"type": "spl", "frame": to});
            json!({"type": "spline", "segments": to.into_iter().map(segment).collect::<Vec<_>>()})
        }),
    ];
    let to_frame = (course, limits).prop_map(|(mut motion, (v, j, turn, share, blend))| {
        motion["velocity_rel"] = json!(share);
        if motion["type"] == "ptp" {
            motion["blend"] = json!({"cart_mm": v});
        } else {
            motion["cart_velocity_mm_s"] = json!(v);
            motion["cart_jerk_mm_s3"] = json!(j);
            motion["orientation_acceleration_deg_s2"] = json!(turn);
            motion["blend"] = json!({"ori_deg": blend});
            motion["tool"] = json!("gripper/finger");
        }
        motion
    });
    let joints = proptest::array::uniform7(number());
    prop_oneof![
        to_frame,
        (joints, share())
            .prop_map(|(q, v)| json!({"type": "ptp", "joints_deg": q, "velocity_rel": v})),
    ]
    .boxed()
}

fn request() -> impl Strategy<Value = Value> {
    let motions = proptest::collection::vec(motion(), 1..6);
    let load = (
        0.0..Load::MAX_MASS_KG,
        proptest::array::uniform3(-Load::MAX_CENTER_MM..Load::MAX_CENTER_MM),
    );
    (motions, pose(), pose(), pose(), load, any::<bool>()).prop_map(
        |(mut motions, tcp, tip, base, (mass, abc), slow)| {
            motions.push(json!({"type": "ptp", "joints_deg": [0, 0, 0, 0, 0, 0, 0]}));
            motions.push(json!({"type": "load", "load": {"mass_kg": mass, "center_mm": abc}}));
            let mut pick = tcp.clone();
            pick["base"] = json!("table");
            let mut request = json!({
                "type": "run_motions", "motions": motions,
                "tools": {"gripper": {"tcp": tcp, "tips": {"finger": tip},
                    "load": {"mass_kg": mass, "abc_deg": abc}}},
                "bases": {"table": base}, "frames": {"pick": pick},
                "tool": "gripper", "base": "table",
            });
            if slow {
                request["mode"] = json!("t1");
                request["mount"] = json!({"rpy_deg": abc});
            }
            request
        },
    )
}

proptest! {
    #[test]
    fn requests_and_instructions_read_back(request in request()) {
        let (_, read) = Request::from_json(request.to_string().as_bytes());
        let Ok(Request::RunMotions { motions, .. }) = read.clone() else {
            return Err(TestCaseError::fail(format!("{read:?}: {request}")));
        };
        let again = Request::from_json(read.unwrap().to_json().as_bytes()).1;
        prop_assert_eq!(again, Ok(Request::motions(motions.clone())));
        let instruction = Instruction::RunMotions { run: u64::MAX, motions: motions.clone() };
        let text = instruction.to_json(5);
        prop_assert_eq!(Instruction::from_json(text.as_bytes()), (Some(5), Ok(instruction)));
        prop_assert_eq!(MotionList::from_json(&text).unwrap(), motions);
    }
}
