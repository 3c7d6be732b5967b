//! TCP limits in JSON.

use std::fmt::Write as _;

use iiwa_program::Program;

/// Every limit is written with digits that read back to the same limit.
#[test]
fn limits_are_written_as_they_are_read() {
    let mut motions = String::new();
    for number in (10..20_000).map(|tenths| 0.1 * f64::from(tenths)) {
        let separator = if motions.is_empty() { "" } else { ",\n" };
        write!(
            motions,
            r#"{separator}{{ "type": "lin_rel", "offset": {{ "z_mm": 1 }},
            "cart_velocity_mm_s": {number}, "cart_acceleration_mm_s2": {number},
            "cart_jerk_mm_s3": {number},
            "orientation_velocity_deg_s": {number}, "orientation_acceleration_deg_s2": {number},
            "orientation_jerk_deg_s3": {number} }}"#
        )
        .unwrap();
    }
    let text = format!(
        r#"{{ "version": 1, "start": {{ "joints_deg": [0, 30, 0, -60, 0, 90, 0] }},
            "motions": [{motions}] }}"#
    );
    let program = Program::from_json(&text).unwrap();
    let again = Program::from_json(&program.to_json()).unwrap();
    assert_eq!(again.motions.len(), 19_990);
    for (motion, again) in program.motions.iter().zip(&again.motions) {
        assert_eq!(motion, again);
    }
}

#[test]
fn torque_limits_are_read_as_shares() {
    for (key, expected) in [
        ("", None),
        (r#""limit_torque_percent": 100,"#, Some(1.0)),
        (r#""limit_torque_percent": 37.5,"#, Some(0.375)),
    ] {
        let text = format!(
            r#"{{ "version": 1, {key} "start": {{ "joints_deg": [0, 30, 0, -60, 0, 90, 0] }},
                "motions": [{{ "type": "ptp", "joints_deg": [9, 30, 0, -60, 0, 90, 0] }}] }}"#
        );
        let program = Program::from_json(&text).unwrap();
        assert_eq!(program.workcell.torque_limit_rel, expected);
        let again = Program::from_json(&program.to_json()).unwrap();
        assert_eq!(again.workcell.torque_limit_rel, expected);
    }
}
