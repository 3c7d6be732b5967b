//! Operating mode, warnings, assumptions and gates in the figures of a plan.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use iiwa_plan::{ClearanceRecord, PlanFigures, PlanGates, PlanRequest, ProgramSource};
use serde_json::{Value, json};

fn figures(keys: &str, motions: &str) -> PlanFigures {
    let text = format!(
        r#"{{ "version": 1, {keys} "start": {{ "joints_deg": [0, 30, 0, -80, 0, 60, 0] }},
            "motions": [{motions}] }}"#
    );
    PlanRequest::default().plan(&ProgramSource::from_json(&text).unwrap()).unwrap().figures()
}

const LIN: &str = r#"{ "type": "lin_rel", "offset": { "z_mm": -30 }, "name": "down" }"#;

#[test]
fn the_operating_mode_is_stated() {
    let keys = r#""mode": "t1", "override_percent": 30,"#;
    let t1 = serde_json::to_value(figures(keys, LIN)).unwrap();
    assert_eq!(
        [&t1["mode"], &t1["t1_speed_mm_s"], &t1["override_percent"]],
        [&json!("t1"), &json!(225.0), &json!(30.0)]
    );
    let default = serde_json::to_value(figures("", LIN)).unwrap();
    assert_eq!([&default["mode"], &default["override_percent"]], [&Value::Null; 2]);
    assert_eq!(default["warnings"], json!([]));
}

/// Plans of earlier versions have neither mode nor warnings, and name the minimum duration after
/// the TCP speed.
#[test]
fn figures_of_earlier_versions_are_read() {
    let mut old = serde_json::to_value(figures("", LIN)).unwrap();
    assert_eq!(old["motions"][0]["limited_by"]["kind"], "minimum_duration");
    old.as_object_mut().unwrap().remove("warnings");
    old["motions"][0]["limited_by"]["kind"] = "cart_velocity".into();
    let old: PlanFigures = serde_json::from_value(old).unwrap();
    assert!(old.warnings.is_empty() && old.mode.is_none());
    assert_eq!(old.motions[0].limited_by.as_ref().unwrap().to_string(), "cart velocity");
}

#[test]
fn shortened_blends_are_warnings() {
    let lin = |mm: i32, blend: &str| {
        format!(r#"{{ "type": "lin_rel", "offset": {{ "z_mm": {mm} }}{blend} }}"#)
    };
    let aside = r#"{ "type": "lin_rel", "offset": { "y_mm": 200 }, "name": "aside" }"#;
    let ptp = |deg: i32, blend: &str| {
        format!(r#"{{ "type": "ptp", "joints_deg": [{deg}, 30, 0, -80, 0, 60, 0]{blend} }}"#)
    };
    let on = r#"{ "type": "ptp", "joints_deg": [20, 50, 0, -80, 0, 60, 0] }"#;
    let blend = |mm: i32| format!(r#", "blend": {{ "cart_mm": {mm} }}"#);
    // The flange is about 0.65 m from A1: 3 deg are 34 mm.
    let cases = [
        (format!("{}, {aside}", lin(-60, &blend(50))), Some((1, 30.0))),
        (format!("{}, {aside}", lin(-120, &blend(50))), None),
        (format!("{}, {}", lin(-120, &blend(50)), lin(20, "")), Some((2, 10.0))),
        (format!("{}, {on}", ptp(20, &blend(50))), None),
        (format!("{}, {aside}", ptp(3, &blend(50))), Some((1, 17.0))),
    ];
    for (motions, expected) in cases {
        let figures = figures("", &motions);
        let shortened = figures.blends[0].shortened.as_ref();
        let found = shortened.map(|blend| (blend.half_of_motion, blend.used_mm));
        let is_near = match (found, expected) {
            (Some((motion, found)), Some((other, expected))) => {
                motion == other && f64::abs(found - expected) < 2.0
            }
            (found, expected) => found.is_none() && expected.is_none(),
        };
        assert!(is_near, "{motions}: {shortened:?}");
        assert_eq!(
            figures.warnings.len(),
            usize::from(expected.is_some()),
            "{:?}",
            figures.warnings
        );
    }
    let warnings = figures("", &format!("{}, {aside}", lin(-60, &blend(50)))).warnings;
    let expected = "motion 1: its blend of 50 mm is shortened to 30.0 mm: ";
    assert!(warnings[0].starts_with(expected), "{warnings:?}");
    let both = figures("", &format!("{}, {}", ptp(3, &blend(50)), ptp(40, "")));
    assert!(both.blends[0].shortened.is_some(), "{:?}", both.blends);
}

const SPLINE: &str = r#"{ "type": "spline", "segments": [
    { "type": "lin", "frame": { "x_mm": 560, "y_mm": 0, "z_mm": 480, "a_deg": 180, "b_deg": 10,
        "c_deg": 180, "e1_deg": 0 } },
    { "type": "lin", "frame": { "x_mm": 560, "y_mm": 60, "z_mm": 480, "a_deg": 180, "b_deg": 10,
        "c_deg": 180, "e1_deg": 0 } },
    { "type": "spl", "frame": { "x_mm": 560, "y_mm": 90, "z_mm": 520, "a_deg": 180, "b_deg": 10,
        "c_deg": 180, "e1_deg": 0 } }] }"#;

#[test]
fn a_stop_within_a_spline_names_its_segment() {
    let warnings = figures("", SPLINE).warnings;
    let [warning] = warnings.as_slice() else { panic!("{warnings:?}") };
    let expected = "motion 1: the TCP stops once within the spline (after segment 1): ";
    assert!(warning.starts_with(expected), "{warning}");
}

/// Neither the segments of a spline nor its parts between stops count as motions.
#[test]
fn assumptions_count_motions() {
    let motions = format!("{SPLINE}, {LIN}");
    for keys in ["", r#""mode": "t1","#, r#""mode": "t1", "override_percent": 50,"#] {
        let figures = figures(keys, &motions);
        assert!(!figures.rests_on.is_empty());
        for assumption in &figures.rests_on {
            assert!(assumption.motions <= 2, "{keys}: {assumption:?}");
            let is_of_spline = assumption.what.starts_with("splines");
            assert!(!is_of_spline || assumption.motions == 1, "{keys}: {assumption:?}");
        }
    }
}

#[test]
fn gates_have_limits_and_values() {
    let mut figures = figures("", LIN);
    let at_s = 0.5 * figures.cycle_time_s;
    let obstacle = "column".to_owned();
    figures.clearance = Some(ClearanceRecord { distance_mm: 12.0, link: 7, obstacle, at_s });
    let gates = PlanGates {
        max_cycle_time_s: Some(10.0),
        min_clearance_mm: Some(20.0),
        max_torque_percent: None,
    };
    let records = serde_json::to_value(gates.records(&figures)).unwrap();
    let expected = json!({
        "max_cycle_time_s": { "limit": 10.0, "value": figures.cycle_time_s, "met": true },
        "min_clearance_mm": { "limit": 20.0, "value": 12.0, "met": false },
    });
    assert_eq!(records, expected);
    assert_eq!(serde_json::to_value(PlanGates::default().records(&figures)).unwrap(), json!({}));
    let complaint = gates.judge(&figures).complaint().unwrap();
    assert!(complaint.ends_with(r#" s, in motion 1 "down""#), "{complaint}");
    let later = figures.place_at(figures.cycle_time_s);
    assert!(later.ends_with(r#" s, at the end of motion 1 "down""#), "{later}");
}
