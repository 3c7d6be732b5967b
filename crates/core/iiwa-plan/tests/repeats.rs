//! Repeat blocks in figures, warnings and errors.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use iiwa_plan::{PlanFigures, PlanRequest, ProgramSource};
use iiwa_program::{Program, Round};
use serde_json::{Value, json};

fn ptp(a1_deg: f64) -> Value {
    json!({ "type": "ptp", "joints_deg": [a1_deg, 0, 0, 0, 0, 0, 0] })
}

fn text(motions: &[Value]) -> String {
    json!({ "version": 1, "start": { "joints_deg": [0, 0, 0, 0, 0, 0, 0] }, "motions": motions })
        .to_string()
}

fn figures(text: &str) -> PlanFigures {
    PlanRequest::default().plan(&ProgramSource::from_json(text).unwrap()).unwrap().figures()
}

fn nested() -> Vec<Value> {
    let inner = json!({ "type": "repeat", "count": 2, "name": "shake", "motions": [ptp(10.0),
        json!({ "type": "load", "load": null }), ptp(20.0)] });
    let outer = json!({ "type": "repeat", "count": 3, "group": "stack",
        "motions": [ptp(30.0), inner, json!({ "type": "wait", "seconds": 0.5 }), ptp(0.0)] });
    vec![ptp(5.0), outer, ptp(-5.0)]
}

#[test]
fn blocks_have_times() {
    let figures = figures(&text(&nested()));
    let start_s =
        |index: usize| figures.motions.iter().find(|motion| motion.index == index).unwrap().start_s;
    let [outer, inner] = figures.repeats.as_slice() else { panic!("{:?}", figures.repeats) };
    assert_eq!([outer.first_motion, outer.motions, outer.count, outer.depth], [2, 9, 3, 1]);
    assert_eq!([inner.first_motion, inner.motions, inner.count, inner.depth], [3, 3, 2, 2]);
    assert_eq!(inner.label.name.as_deref(), Some("shake"));
    let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-9, "{a} {b}");
    close(outer.duration_s, start_s(29) - start_s(2));
    close(outer.share, outer.duration_s / figures.cycle_time_s);
    // In the first round, the first motion is shorter.
    close(outer.min_round_s, start_s(11) - start_s(2));
    close(outer.max_round_s, start_s(20) - start_s(11));
    let of_round = |first: usize| start_s(first + 6) - start_s(first);
    close(inner.duration_s, [3, 12, 21].map(of_round).iter().sum());
    assert!(inner.min_round_s > 0.1 && inner.min_round_s <= start_s(6) - start_s(3));
    assert!(outer.min_round_s < outer.max_round_s - 1e-3);
    // The motions of the group are those of the block.
    let group = &figures.groups[0];
    assert_eq!((group.motions, group.contiguous), (21, true));
}

/// The last round ends with the program.
#[test]
fn the_last_round_ends_with_the_program() {
    let block = json!({ "type": "repeat", "count": 2, "motions": [ptp(10.0), ptp(0.0)] });
    let figures = figures(&text(&[block]));
    let repeat = &figures.repeats[0];
    assert!((repeat.duration_s - figures.cycle_time_s).abs() < 1e-9);
    assert!((repeat.max_round_s - repeat.min_round_s).abs() < 1e-9, "{repeat:?}");
}

/// An output that overlaps motions is set at the start of a motion before, in or after the block.
#[test]
fn overlapping_outputs_bound_no_rounds() {
    let set = json!({ "type": "set", "io": "Gripper.Open", "value": true, "overlap": true });
    let equal = json!({ "type": "repeat", "count": 2, "motions": [ptp(10.0), ptp(0.0)] });
    let plan = figures(&text(&[equal, set.clone(), ptp(20.0)]));
    let repeat = &plan.repeats[0];
    assert!((repeat.max_round_s - repeat.min_round_s).abs() < 1e-9, "{repeat:?}");
    assert!((repeat.duration_s - plan.motions[5].start_s).abs() < 1e-9, "{repeat:?}");

    let block = json!({ "type": "repeat", "count": 2, "motions": [set, ptp(10.0), ptp(0.0)] });
    let plan = figures(&text(&[ptp(40.0), ptp(0.0), block]));
    let repeat = &plan.repeats[0];
    assert!((repeat.max_round_s - repeat.min_round_s).abs() < 1e-9, "{repeat:?}");
    let duration_s = plan.cycle_time_s - plan.motions[3].start_s;
    assert!((repeat.duration_s - duration_s).abs() < 1e-9, "{repeat:?}");
}

/// A block plans as its motions do, one by one.
#[test]
fn blocks_plan_as_their_motions() {
    let with_blocks = text(&nested());
    let mut program = Program::from_json(&with_blocks).unwrap();
    program.sources.set_repeats(Vec::new());
    let plain = figures(&program.to_json());
    let figures = figures(&with_blocks);
    assert_eq!(plain.cycle_time_s.to_bits(), figures.cycle_time_s.to_bits());
    assert_eq!(plain.repeats, []);
    assert_eq!(plain.motions.len(), figures.motions.len());
    let mut motions = figures.motions;
    assert_eq!(motions[2].rounds.len(), 2);
    assert_eq!(motions[2].rounds[0], Round { number: 1, count: 3 });
    for motion in &mut motions {
        motion.rounds.clear();
    }
    assert_eq!(plain.motions, motions);
}

#[test]
fn figures_with_blocks_read_back_from_json() {
    let figures = figures(&text(&nested()));
    let json = serde_json::to_value(&figures).unwrap();
    assert_eq!(json["motions"][1]["rounds"], json!([{ "number": 1, "count": 3 }]));
    assert_eq!(json["motions"][0].get("rounds"), None);
    assert_eq!(json["repeats"][1]["name"], "shake");
    assert_eq!(serde_json::from_value::<PlanFigures>(json).unwrap(), figures);
}

/// Offsets add up until a round leaves the workspace; the error names the round and the place.
#[test]
fn offsets_add_up_over_rounds() {
    let offset = json!({ "type": "lin_rel", "offset": { "x_mm": 40 } });
    let block = json!({ "type": "repeat", "count": 50, "motions": [offset] });
    let text = json!({ "version": 1, "start": { "joints_deg": [0, 30, 0, -60, 0, 90, 0] },
        "motions": [block] });
    let source = ProgramSource::from_json(&text.to_string());
    let source = source.unwrap_or_else(|error| panic!("{error}"));
    let error = PlanRequest::default().plan(&source).unwrap_err();
    let motion = error.motion().unwrap();
    assert!((2..20).contains(&motion.number()), "{error}");
    let expected = format!("motion {motion} (round {motion} of 50)");
    assert!(error.to_string().starts_with(&expected), "{error}");
    let place = error.place().unwrap();
    assert!(text.to_string()[place.span.clone()].contains("40"), "{place:?}");
}
