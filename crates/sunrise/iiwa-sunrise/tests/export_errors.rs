//! Programs that cannot be exported as Sunrise projects.

use iiwa_kin::Robot;
use iiwa_program::{CartesianMotion, Course, Frame, LimitKind, Motion, TargetRef};
use iiwa_sunrise::{ExportError, ExportOptions, ExportedProject};

use crate::export::{PTP, TOOLS, exported, read, read_with, relative_lift};

#[test]
fn keys_without_a_sunrise_call_are_rejected() {
    let frame = r#"{ "x_mm": 450, "y_mm": 50, "z_mm": 400, "a_deg": 0, "b_deg": 180, "c_deg": 0 }"#;
    let other = r#"{ "x_mm": 500, "y_mm": 0, "z_mm": 400, "a_deg": 0, "b_deg": 180, "c_deg": 0 }"#;
    let cases = [
        (r#"{ "type": "lin_rel", "offset": { "z_mm": 1 }, "e1_deg": 3 }"#.to_owned(), "e1_deg"),
        (
            format!(
                r#"{{ "type": "circ", "aux": {frame}, "frame": {other},
                      "aux_orientation": "ignore" }}"#
            ),
            "aux_orientation",
        ),
        (
            format!(
                r#"{{ "type": "circ", "aux": {frame}, "frame": {other}, "circ_angle_deg": 90,
                      "end_orientation": "extrapolate" }}"#
            ),
            "end_orientation",
        ),
        (
            format!(
                r#"{{ "type": "ptp", "joints_deg": [0,0,0,0,0,0,0],
                      "blend": {{ "fraction": 0.02 }} }}, {PTP}"#
            ),
            "blend",
        ),
        (
            format!(
                r#"{{ "type": "lin", "frame": {frame}, "tool": "probe",
                      "blend": {{ "cart_mm": 20 }} }}, {}"#,
                relative_lift("gripper")
            ),
            "blend",
        ),
    ];
    for (motions, key) in cases {
        let error = exported(&read_with(TOOLS, &format!("{PTP}, {motions}"))).unwrap_err();
        let named = format!("motion 2: `{key}`: ");
        assert!(error.to_string().starts_with(&named), "{error}");
    }
    let mut limited = CartesianMotion::new(Course::Ptp { to: Frame::default().into() });
    limited.tool_limits.way[LimitKind::Velocity] = 0.1;
    let mut program = read(PTP);
    program.motions.push(Motion::Cartesian(Box::new(limited)));
    assert!(matches!(exported(&program), Err(ExportError::NotInSunrise { key: "frame", .. })));
    program.motions = vec![Motion::Cartesian(Box::new(CartesianMotion::new(Course::Lin {
        to: TargetRef::Named("nowhere".to_owned()),
    })))];
    let error = exported(&program).unwrap_err().to_string();
    assert_eq!(error, "motion 1: `frame`: unknown frame `nowhere`; the program names none");
    program.motions.clear();
    assert!(matches!(exported(&program), Err(ExportError::Fault(_))));
    let named = |class: &str| ExportOptions { name: String::new(), class: Some(class.to_owned()) };
    ExportedProject::new(&read(PTP), &Robot::default(), &named("new")).unwrap_err();
    let welding = ExportedProject::new(&read(PTP), &Robot::default(), &named("Welding")).unwrap();
    assert!(welding.java.contains("public class Welding extends"));
}

/// A motion of a repeat block has its errors and notes once, not once per round.
#[test]
fn rounds_share_errors_and_notices() {
    let repeat = |motion: &str| {
        read(&format!(r#"{PTP}, {{ "type": "repeat", "count": 5, "motions": [{motion}] }}"#))
    };
    let unnamed = repeat(r#"{ "type": "set", "io": "Close", "value": true }"#);
    assert_eq!(exported(&unnamed).unwrap_err().errors().len(), 1);
    let third = exported(&repeat(r#"{ "type": "wait", "seconds": 0.33333333333333 }"#)).unwrap();
    assert_eq!(third.notices.iter().filter(|notice| notice.key == "seconds").count(), 1);
}

/// Tests two motions without a call in Sunrise among others.
#[test]
fn all_motions_that_sunrise_lacks_are_named() {
    let program = read(
        r#"
        { "type": "ptp", "joints_deg": [0, 30, 0, -70, 0, 80, 0], "blend": { "fraction": 0.01 } },
        { "type": "ptp", "joints_deg": [0, 30, 0, -60, 0, 90, 0], "blend": { "fraction": 0.2 } },
        { "type": "ptp", "joints_deg": [0, 40, 0, -60, 0, 90, 0], "blend": { "fraction": 0.02 } },
        { "type": "ptp", "joints_deg": [0, 30, 0, -60, 0, 90, 0] }"#,
    );
    let error = exported(&program).unwrap_err();
    let numbers: Vec<_> = error
        .errors()
        .iter()
        .map(|error| match error {
            ExportError::NotInSunrise { motion, .. } => motion.number(),
            other => panic!("{other}"),
        })
        .collect();
    assert_eq!(numbers, [1, 3]);
    assert!(error.to_string().ends_with("; and one more error"), "{error}");
}
