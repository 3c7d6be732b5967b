//! Differences of plans: matched motions, their times and paths.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use iiwa_eval::{MotionDifference, PathChange, PlanDifference, PlanVersion};
use iiwa_plan::{PlanRequest, ProgramSource};
use serde_json::{Value, json};

const FIXTURES: [&str; 4] = [
    include_str!("../../../../fixtures/appendix-b.json"),
    include_str!("../../../../fixtures/ten-motions.json"),
    include_str!("../../../../fixtures/waits-and-stops.json"),
    include_str!("../../../../fixtures/pick-and-place.json"),
];

/// Two TCP lines between PTP motions.
const LINES: &str = r#"{ "version": 1, "start": { "joints_deg": [0, 25, 0, -90, 0, 65, 0] },
    "motions": [
        { "type": "ptp", "joints_deg": [20, 25, 0, -90, 0, 65, 0] },
        { "type": "lin_rel", "offset": { "z_mm": -100 } },
        { "type": "wait", "seconds": 0.5 },
        { "type": "lin_rel", "offset": { "x_mm": 80 } },
        { "type": "ptp", "joints_deg": [0, 25, 0, -90, 0, 65, 0] }
    ] }"#;

fn version(program: &Value) -> PlanVersion {
    let source = ProgramSource::from_json(&program.to_string()).unwrap();
    PlanVersion::from(&PlanRequest::default().plan(&source).unwrap())
}

fn differences(old: &Value, new: &Value) -> Vec<MotionDifference> {
    PlanDifference::between(&version(old), &version(new)).motions
}

/// Returns the numbers of the motions in both versions.
fn numbers(all: &[MotionDifference]) -> Vec<(Option<usize>, Option<usize>)> {
    let number = |motion: &Option<iiwa_plan::MotionRecord>| motion.as_ref().map(|it| it.index);
    all.iter().map(|one| (number(&one.old), number(&one.new))).collect()
}

fn flange_m(difference: &MotionDifference) -> f64 {
    difference.path.unwrap().flange_m
}

fn lines() -> Value {
    serde_json::from_str(LINES).unwrap()
}

#[test]
fn equal_plans_do_not_differ() {
    for text in FIXTURES.iter().chain([&LINES]) {
        let program = serde_json::from_str(text).unwrap();
        for difference in differences(&program, &program) {
            assert_eq!(difference.old, difference.new);
            let PathChange { flange_m, joints_rad } = difference.path.unwrap();
            assert_eq!((flange_m, joints_rad), (0.0, 0.0));
        }
    }
}

/// A7 turns about the flange axis: the flange positions stay where they are.
#[test]
fn another_orientation_is_a_change_in_joints() {
    let old = lines();
    let mut new = old.clone();
    new["motions"][4]["joints_deg"][6] = json!(-2);
    let all = differences(&old, &new);
    let PathChange { flange_m, joints_rad } = all[4].path.unwrap();
    assert!(flange_m < 1e-3, "{flange_m}");
    // At most by the angle itself: the nearest point may be before the end.
    let angle_deg = joints_rad.to_degrees();
    assert!(angle_deg > 1.0 && angle_deg < 2.0 + 1e-9, "{angle_deg}");
}

#[test]
fn a_change_of_speed_moves_no_path() {
    for text in FIXTURES {
        let program: Value = serde_json::from_str(text).unwrap();
        let mut slow = program.clone();
        slow["override_percent"] = json!(60);
        for difference in differences(&program, &slow) {
            // The points are at equal lengths of polynomials through different instants.
            let PathChange { flange_m, joints_rad } = difference.path.unwrap();
            assert!(flange_m < 1e-4 && joints_rad < 2e-4, "{difference:?}");
        }
    }
}

#[test]
fn an_added_motion_shifts_no_other() {
    let old = lines();
    let mut new = old.clone();
    let added = json!({ "type": "ptp", "joints_deg": [10, 25, 0, -90, 0, 65, 0] });
    new["motions"].as_array_mut().unwrap().insert(1, added);
    let all = differences(&old, &new);
    let pairs = [(1, 1), (2, 3), (3, 4), (4, 5), (5, 6)].map(|(a, b)| (Some(a), Some(b)));
    let [first, rest @ ..] = pairs;
    let expected: Vec<_> = [first, (None, Some(2))].into_iter().chain(rest).collect();
    assert_eq!(numbers(&all), expected);
    // The lines start where the added motion ends.
    assert!(flange_m(&all[2]) > 0.05);
    // Reversed, it is a motion removed.
    let reversed: Vec<_> = numbers(&differences(&new, &old));
    assert_eq!(reversed, expected.iter().map(|(a, b)| (*b, *a)).collect::<Vec<_>>());
}

/// The second line ends 30 mm further on the same straight line: this is its only change.
#[test]
fn a_longer_line_changes_by_its_additional_length() {
    let old = lines();
    let mut new = old.clone();
    new["motions"][3]["offset"]["x_mm"] = json!(110);
    let all = differences(&old, &new);
    assert_eq!(numbers(&all), (1..=5).map(|n| (Some(n), Some(n))).collect::<Vec<_>>());
    for same in [0, 1, 2] {
        assert_eq!(flange_m(&all[same]), 0.0);
    }
    assert!((flange_m(&all[3]) - 0.03).abs() < 1e-5, "{:?}", all[3].path);
}

/// A smaller radius keeps the motions, and brings the path nearer to the corner: by the distance of
/// the blend's middle from the corner, at most.
#[test]
fn a_blend_changes_the_path_of_both_motions() {
    let program = |radius_mm: f64| {
        let mut program = lines();
        program["motions"][0]["blend"] = json!({ "cart_mm": radius_mm });
        program
    };
    let all = differences(&program(50.0), &program(20.0));
    for index in [0, 1] {
        let change_m = flange_m(&all[index]);
        assert!(change_m > 0.001 && change_m < 0.05, "{change_m}");
    }
    // The motion begins at another time, with other rounding.
    assert!(flange_m(&all[3]) < 1e-12);
}

/// Groups are matched by their names, wherever their motions are.
#[test]
fn groups_are_matched_by_names() {
    let with_groups = |groups: [&str; 5], wait_s: f64| {
        let mut program = lines();
        for (motion, group) in groups.into_iter().enumerate() {
            program["motions"][motion]["group"] = json!(group);
        }
        program["motions"][2]["seconds"] = json!(wait_s);
        program
    };
    let old = with_groups(["go", "work", "work", "work", "back"], 0.5);
    let new = with_groups(["work", "work", "work", "go", "home"], 0.75);
    let groups = PlanDifference::between(&version(&old), &version(&new)).groups;
    let counts: Vec<_> = groups
        .iter()
        .map(|group| {
            let count = |side: &Option<iiwa_plan::GroupRecord>| side.as_ref().map(|it| it.motions);
            (group.name.as_str(), count(&group.old), count(&group.new))
        })
        .collect();
    assert_eq!(
        counts,
        [
            ("go", Some(1), Some(1)),
            ("work", Some(3), Some(3)),
            ("back", Some(1), None),
            ("home", None, Some(1)),
        ]
    );
    let longer = with_groups(["go", "work", "work", "work", "back"], 0.75);
    let groups = PlanDifference::between(&version(&old), &version(&longer)).groups;
    let changes: Vec<f64> = groups
        .iter()
        .map(|group| {
            let duration_s =
                |side: &Option<iiwa_plan::GroupRecord>| side.as_ref().unwrap().duration_s;
            duration_s(&group.new) - duration_s(&group.old)
        })
        .collect();
    assert_eq!(changes.len(), 3);
    for (change, expected) in changes.into_iter().zip([0.0, 0.25, 0.0]) {
        assert!((change - expected).abs() < 1e-9, "{change}");
    }
    assert_eq!(differences_of_groups(&lines()), []);
}

fn differences_of_groups(program: &Value) -> Vec<iiwa_eval::GroupDifference> {
    PlanDifference::between(&version(program), &version(program)).groups
}
