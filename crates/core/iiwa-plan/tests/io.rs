//! Inputs and outputs in plans: rows, times and assumptions.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use iiwa_plan::{PlanFigures, PlanOptions, PlanRequest, ProgramSource};
use iiwa_traj::Timing;

const START: &str = r#""start": { "joints_deg": [0, 30, 0, -60, 0, 90, 0] }"#;
const FIRST: &str = r#"{ "type": "ptp", "joints_deg": [40, 30, 0, -60, 0, 90, 0] }"#;
const BLENDED: &str = r#"{ "type": "ptp", "joints_deg": [40, 30, 0, -60, 0, 90, 0],
    "blend": { "fraction": 0.25 } }"#;
const NEXT: &str = r#"{ "type": "ptp", "joints_deg": [40, 50, 0, -80, 0, 50, 0] }"#;
const SET: &str = r#"{ "type": "set", "io": "A.Close", "value": true, "group": "pick" }"#;
const WAIT_FOR: &str =
    r#"{ "type": "wait_for", "io": "A.Closed", "value": true, "seconds": 0.4, "name": "closed" }"#;
const LOAD: &str = r#"{ "type": "load", "load": { "mass_kg": 2 } }"#;

fn figures_with(keys: &str, motions: &[&str], timing: Timing) -> PlanFigures {
    let motions = motions.join(", ");
    let text = format!(r#"{{ "version": 1, {keys} {START}, "motions": [{motions}] }}"#);
    let source = ProgramSource::from_json(&text).unwrap();
    let options = PlanOptions::with_timing(timing);
    let request = PlanRequest { options, ..PlanRequest::default() };
    request.plan(&source).unwrap().figures()
}

fn figures(motions: &[&str]) -> PlanFigures {
    figures_with("", motions, Timing::default())
}

fn rows(figures: &PlanFigures) -> Vec<(usize, String)> {
    figures.motions.iter().map(|row| (row.index, row.r#type.to_string())).collect()
}

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-9
}

#[test]
fn an_output_is_a_row_without_duration() {
    let plan = figures(&[SET, FIRST, SET, LOAD, SET, NEXT, SET]);
    let expected = [(1, "set"), (2, "ptp"), (3, "set"), (5, "set"), (6, "ptp"), (7, "set")];
    assert_eq!(rows(&plan), expected.map(|(index, name)| (index, name.to_owned())));
    assert!(close(plan.cycle_time_s, figures(&[FIRST, LOAD, NEXT]).cycle_time_s));
    let settled_s = plan.motions[1].end_s + 0.05;
    let times = [0.0, settled_s, settled_s, plan.cycle_time_s];
    let outputs = plan.motions.iter().filter(|row| row.io.is_some());
    for (row, at_s) in outputs.zip(times) {
        assert!(close(row.start_s, at_s) && close(row.end_s, at_s), "{row:?}, not at {at_s}");
        assert_eq!(row.io_text().as_deref(), Some("A.Close = true"));
    }
    assert!(plan.rests_on.iter().all(|assumption| !assumption.what.contains("A.Close")));
    assert_eq!((plan.groups[0].motions, plan.groups[0].duration_s), (4, 0.0));
}

#[test]
fn an_input_takes_its_assumed_time_at_any_override() {
    let wait = r#"{ "type": "wait", "seconds": 0.4 }"#;
    for timing in [Timing::default(), Timing::jerk_limited()] {
        let plan = figures_with("", &[FIRST, WAIT_FOR, NEXT, WAIT_FOR], timing);
        let plain = figures_with("", &[FIRST, wait, NEXT, wait], timing);
        assert!(close(plan.cycle_time_s, plain.cycle_time_s));
        assert!(close(plan.wait_time_s, 0.8));
        let row = &plan.motions[1];
        assert_eq!((&*row.r#type, row.label.name.as_deref()), ("wait_for", Some("closed")));
        assert!(close(row.end_s - row.start_s, 0.4));
        assert_eq!(row.io_text().as_deref(), Some("A.Closed = true"));
        let assumed = plan.rests_on.iter().find(|it| it.what.starts_with("wait_for")).unwrap();
        assert_eq!(assumed.what, "wait_for: A.Closed = true after 0.4 s");
        assert_eq!((assumed.motions, assumed.first), (2, 2));
        let slow =
            figures_with("\"override_percent\": 50,", &[FIRST, WAIT_FOR, NEXT, WAIT_FOR], timing);
        assert!(close(slow.wait_time_s, 0.8));
    }
}

#[test]
fn an_entry_that_overlaps_a_motion_keeps_the_robot_moving() {
    let set = SET.replace("true", "true, \"overlap\": true");
    let short = WAIT_FOR.replace("0.4", "0.01").replace("true", "true, \"overlap\": true");
    let plan = figures(&[BLENDED, &set, &short, NEXT]);
    assert!(close(plan.cycle_time_s, figures(&[BLENDED, NEXT]).cycle_time_s));
    assert_eq!(plan.motions.len(), 4);
    assert_eq!([1, 2].map(|row| plan.motions[row].end_s), [0.0, 0.01]);
    assert_eq!(plan.rests_on.iter().filter(|it| it.what.starts_with("wait_for")).count(), 1);

    // The next motion is known only when the input has its value: the robot stops before the blend.
    let long = short.replace("0.01", "5");
    let plan = figures(&[BLENDED, &set, &long, NEXT]);
    assert_eq!(plan.blends_too_late.len(), 1);
    assert!(close(plan.motions[2].end_s, 5.0), "{:?}", plan.motions[2]);
    assert!(plan.motions[2].start_s > 0.1);
}

/// The clock of overlapping entries runs over several stops.
#[test]
fn overlapping_entries_follow_the_motions_of_several_sections() {
    let set = SET.replace("true", "true, \"overlap\": true");
    let wait = WAIT_FOR.replace("0.4", "0.01").replace("true", "true, \"overlap\": true");
    let plan = figures(&[FIRST, &set, &wait, NEXT, &wait, &set, SET]);
    let rows: Vec<_> = plan.motions.iter().map(|row| row.end_s).collect();
    let next_s = plan.motions[3].start_s;
    assert_eq!(rows[1..3], [0.0, 0.01]);
    assert_eq!(rows[4..6], [next_s + 0.01; 2]);
    assert!(close(rows[6], plan.cycle_time_s), "{rows:?}");
}

#[test]
fn a_program_may_have_outputs_only() {
    let plan = figures(&[SET, SET]);
    assert_eq!(plan.motions.len(), 2);
    assert_eq!(plan.cycle_time_s, 0.0);
}

#[test]
fn figures_read_back() {
    let plan = figures(&[FIRST, SET, WAIT_FOR, NEXT]);
    let text = serde_json::to_string(&plan).unwrap();
    assert_eq!(serde_json::from_str::<PlanFigures>(&text).unwrap(), plan);
}
