//! Payload changes and mounting: reading and writing JSON, and rejected programs.

// Test helpers may panic.
#![allow(clippy::unwrap_used)]

use iiwa_program::{
    Blend, Fault, FlangeLoad, Load, Motion, MotionIndex, MotionList, MotionType, Mount, Program,
};

fn program(keys: &str, motions: &str) -> String {
    format!(
        r#"{{ "version": 1, {keys} "start": {{ "joints_deg": [0, 30, 0, -60, 0, 90, 0] }},
            "motions": [{motions}] }}"#
    )
}

fn refused(text: &str) -> String {
    let error = Program::from_json(text).unwrap_err();
    let span = error.place().span.clone();
    format!("{} | {}", error.message(), &text[span])
}

const LOAD: &str = r#"{ "type": "load", "load": { "mass_kg": 3.5, "center_mm": [1, -2, 60.5],
    "inertia_kg_m2": [0.01, 0.02, 0.03], "abc_deg": [10, 20, 30] } }"#;
const GONE: &str = r#"{ "type": "load", "load": null }"#;
const PTP: &str = r#"{ "type": "ptp", "joints_deg": [0, 50, 0, -60, 0, 90, 0] }"#;
const GRIPPER: &str = r#"
    "tools": { "gripper": { "tcp": { "z_mm": 120 }, "load": { "mass_kg": 1.2 } } },
    "tool": "gripper","#;

#[test]
fn loads_and_mounts_read_back() {
    let text =
        program(r#""mount": { "rpy_deg": [180, 12.3, -7] },"#, &[PTP, LOAD, PTP, GONE].join(", "));
    let read = Program::from_json(&text).unwrap();
    assert_eq!(read.workcell.mount, Mount::from_rpy_deg([180.0, 12.3, -7.0]));
    let Motion::Load(Some(FlangeLoad { load, .. })) = &read.motions[1] else {
        unreachable!("{:?}", read.motions[1])
    };
    assert_eq!((load.mass_kg, load.center_mm), (3.5, [1.0, -2.0, 60.5]));
    assert_eq!(load.abc_rad, [10.0, 20.0, 30.0].map(f64::to_radians));
    assert_eq!(read.motions[3], Motion::Load(None));
    assert_eq!(read.motions[1].motion_type(), MotionType::Load);
    assert_eq!(MotionType::from_name("load"), Some(MotionType::Load));
    assert!(!MotionType::Load.is_cartesian());
    assert_eq!(Program::from_json(&read.to_json()).unwrap(), read);

    let list = MotionList::from(read);
    let text = serde_json::to_string(&list).unwrap();
    assert_eq!(MotionList::from_json(&text).unwrap(), list);

    // The default mounting on the floor is not written.
    let floor = Program::from_json(&program(r#""mount": { "rpy_deg": [0, 0, 0] },"#, PTP)).unwrap();
    assert!(!floor.to_json().contains("mount"));
    let null = Program::from_json(&program(r#""mount": null,"#, PTP)).unwrap();
    assert_eq!(null, floor);
}

#[test]
fn invalid_loads_are_refused() {
    for (motions, expected) in [
        (r#"{ "type": "load" }"#.to_owned(), "motion 1: the key `load` is missing"),
        (
            r#"{ "type": "load", "load": { "center_mm": [0, 0, 0] } }"#.to_owned(),
            "motion 1: the key `mass_kg` is missing",
        ),
        (r#"{ "type": "load", "load": 3 }"#.to_owned(), "expected"),
        (r#"{ "type": "load", "load": null, "seconds": 1 }"#.to_owned(), "`seconds`"),
        (
            LOAD.replace("3.5", "-3.5"),
            "motion 1: the load is not physically possible: its mass must be 0 to 1000 kg, its \
             centre at most 10000 mm from the flange on each axis, and its moments of inertia 0 to \
             1000 kg m^2",
        ),
        (LOAD.replace("3.5", "3500"), "its mass must be 0 to 1000 kg"),
        (LOAD.replace("60.5", "60500"), "is not physically possible"),
        (LOAD.replace("0.02", "-0.02"), "is not physically possible"),
        (LOAD.replace("0.02", "2000"), "is not physically possible"),
    ] {
        let message = refused(&program("", &motions));
        assert!(message.contains(expected), "{message}");
    }
    let message = refused(&program("", &LOAD.replace("3.5", "-3.5")));
    assert!(message.ends_with("\"abc_deg\": [10, 20, 30] }"), "{message}");
    for (mount, expected) in [
        (r#"{ "rpy_deg": [0, 0] }"#, "three angles"),
        ("{}", "the key `rpy_deg` is missing"),
        (r#""ceiling""#, "expected"),
    ] {
        let message = refused(&program(&format!("\"mount\": {mount},"), PTP));
        assert!(message.contains(expected), "{message}");
    }
}

/// The robot is at rest during a payload change.
#[test]
fn nothing_is_blended_into_a_change_of_the_load() {
    let blended = PTP.replace(" }", r#", "blend": { "cart_mm": 30 } }"#);
    let message = refused(&program("", &[&blended, LOAD, PTP].join(", ")));
    assert_eq!(
        message,
        "motion 1 is followed by a change of the load, for which the arm stops; remove its blend \
         | { \"cart_mm\": 30 }"
    );
    let none = PTP.replace(" }", r#", "blend": { "cart_mm": 0 } }"#);
    Program::from_json(&program("", &[&none, LOAD, PTP].join(", "))).unwrap();

    let program = Program::from_deg([0.0; 7]).ptp_deg([10.0; 7]).blend(Blend::Fraction(0.2));
    let program = program.motion(Motion::Load(None)).build();
    let motion = MotionIndex::new(0);
    assert_eq!(program.check_numbers().unwrap_err(), Fault::BlendBeforeLoad { motion });
}

#[test]
fn loads_are_those_of_tools_until_something_is_picked_up() {
    let masses = |text: &str| -> Vec<f64> {
        let loads = Program::from_json(text).unwrap().loads();
        loads.iter().map(|load| load.map_or(0.0, |load| load.mass_kg)).collect()
    };
    let all = [PTP, LOAD, r#"{ "type": "wait", "seconds": 1 }"#, PTP, GONE, PTP].join(", ");
    assert_eq!(masses(&program("", &all)), [0.0, 3.5, 3.5, 3.5, 0.0, 0.0]);
    assert_eq!(masses(&program(GRIPPER, &all)), [1.2, 3.5, 3.5, 3.5, 1.2, 1.2]);

    // A motion with another tool has that tool's payload; a motion with a tool without a payload
    // has that of the tool in use.
    let more = r#""tools": { "gripper": { "tcp": { "z_mm": 120 }, "load": { "mass_kg": 1.2 } },
        "camera": { "tcp": { "x_mm": 80 }, "tips": { "left": { "x_mm": 90 } },
                    "load": { "mass_kg": 0.8 } },
        "pen": { "tcp": { "z_mm": 10 } } }, "tool": "gripper","#;
    let by = |tool: &str| {
        format!(r#"{{ "type": "lin_rel", "offset": {{ "z_mm": -5 }}, "tool": "{tool}" }}"#)
    };
    let motions = ["gripper", "camera/left", "pen", "flange"].map(by).join(", ");
    assert_eq!(masses(&program(more, &motions)), [1.2, 0.8, 1.2, 1.2]);
    let motions = [&by("camera"), r#"{ "type": "wait", "seconds": 1 }"#, PTP].join(", ");
    assert_eq!(masses(&program(more, &motions)), [0.8, 0.8, 1.2]);
}

#[test]
fn a_load_made_in_code_is_checked() {
    let load = Load { mass_kg: f64::NAN, ..Load::default() };
    let program = Program::from_deg([0.0; 7]).motion(Motion::Load(Some(load.into()))).build();
    let fault = program.check_numbers().unwrap_err();
    assert!(matches!(fault, Fault::Load { .. }) && !fault.is_of_the_arm());
}
