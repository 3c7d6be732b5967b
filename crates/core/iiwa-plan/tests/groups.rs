//! Names and groups of motions in figures, warnings and errors.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use iiwa_plan::{GroupRecord, PlanFigures, PlanRequest, ProgramSource};
use serde_json::json;

/// Program with two groups, one of which is interrupted.
const TEXT: &str = r#"{ "version": 1,
    "start": { "joints_deg": [0, 0, 0, 0, 0, 0, 0] },
    "motions": [
        { "type": "ptp", "joints_deg": [20, 0, 0, 0, 0, 0, 0], "name": "approach",
          "group": "pick", "comment": "above\nthe part" },
        { "type": "load", "load": { "mass_kg": 1 }, "name": "grip" },
        { "type": "wait", "seconds": 0.25, "group": "pick" },
        { "type": "ptp", "joints_deg": [40, 0, 0, 0, 0, 0, 0], "group": "place" },
        { "type": "ptp", "joints_deg": [0, 0, 0, 0, 0, 0, 0] },
        { "type": "ptp", "joints_deg": [20, 0, 0, 0, 0, 0, 0], "group": "place" }
    ] }"#;

fn figures(text: &str) -> PlanFigures {
    PlanRequest::default().plan(&ProgramSource::from_json(text).unwrap()).unwrap().figures()
}

#[test]
fn groups_add_up_their_motions() {
    let figures = figures(TEXT);
    let time_s = |index: usize| {
        let motion = figures.motions.iter().find(|motion| motion.index == index).unwrap();
        motion.end_s - motion.start_s
    };
    let group = |name: &str, duration_s: f64, contiguous| GroupRecord {
        name: name.to_owned(),
        motions: 2,
        duration_s,
        share: duration_s / figures.cycle_time_s,
        contiguous,
    };
    // The load change has no duration and does not interrupt the group.
    let pick = group("pick", time_s(1) + time_s(3), true);
    let place = group("place", time_s(4) + time_s(6), false);
    assert_eq!(figures.groups, [pick, place]);
    assert!(figures.groups.iter().map(|group| group.share).sum::<f64>() < 1.0);
}

#[test]
fn figures_with_groups_read_back_from_json() {
    let figures = figures(TEXT);
    let json = serde_json::to_value(&figures).unwrap();
    let first = &json["motions"][0];
    assert_eq!(first["name"], "approach");
    assert_eq!(first["comment"], "above\nthe part");
    assert_eq!(first["group"], "pick");
    assert_eq!(json["groups"][1]["contiguous"], json!(false));
    assert_eq!(serde_json::from_value::<PlanFigures>(json).unwrap(), figures);
}

#[test]
fn figures_of_unlabelled_programs_have_no_further_keys() {
    let plain = r#"{ "version": 1, "start": { "joints_deg": [0, 0, 0, 0, 0, 0, 0] },
        "motions": [{ "type": "wait", "seconds": 1 }] }"#;
    let json = serde_json::to_value(figures(plain)).unwrap();
    assert!(json.get("groups").is_none(), "{json}");
    let motion = json["motions"][0].as_object().unwrap();
    assert!(["name", "comment", "group"].iter().all(|key| !motion.contains_key(*key)), "{json}");
}

#[test]
fn groups_exist_after_the_last_section() {
    let source = ProgramSource::from_json(TEXT).unwrap();
    let mut planning = PlanRequest::default().begin(&source).unwrap();
    assert!(planning.by_ref().all(|section| section.is_ok()));
    assert_eq!(planning.figures().groups, figures(TEXT).groups);
}

#[test]
fn warnings_and_errors_contain_names() {
    let with_blend = TEXT.replace(
        r#"[20, 0, 0, 0, 0, 0, 0], "group": "place""#,
        r#"[20, 0, 0, 0, 0, 0, 0], "group": "place", "name": "last", "blend": { "fraction": 0.2 }"#,
    );
    let source = ProgramSource::from_json(&with_blend).unwrap();
    let plan = PlanRequest::default().plan(&source).unwrap();
    let warnings = plan.warnings(&plan.figures());
    assert!(warnings[0].starts_with("motion 6 \"last\" is the last one"), "{warnings:?}");

    let outstretched = TEXT
        .replace(r#""mass_kg": 1"#, r#""mass_kg": 25, "center_mm": [0, 0, 300]"#)
        .replace("[40, 0, 0, 0, 0, 0, 0]", r#"[0, 90, 0, 0, 0, 0, 0], "name": "lift""#);
    let warnings = figures(&outstretched).torque_warnings();
    assert!(warnings.iter().any(|text| text.starts_with("motion 4 \"lift\": ")), "{warnings:?}");

    let outside = TEXT.replacen("[20, 0", "[190, 0", 1);
    let source = ProgramSource::from_json(&outside).unwrap();
    let error = PlanRequest::default().plan(&source).unwrap_err();
    assert!(error.to_string().starts_with("motion 1 \"approach\": "), "{error}");
}
