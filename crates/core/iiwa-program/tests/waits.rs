//! Waits that overlap motions, and the sources of motions, in JSON.

#![expect(clippy::unwrap_used, clippy::panic, reason = "a test fails by it")]

use iiwa_kin::Robot;
use iiwa_program::{
    Blend, Fault, MAX_OVERLAP, Motion, MotionIndex, MotionList, Program, Ptp, Source,
};

const FIRST: &str =
    r#"{ "type": "ptp", "joints_deg": [10, 0, 0, 0, 0, 0, 0], "blend": { "fraction": 0.2 } }"#;
const NEXT: &str = r#"{ "type": "ptp", "joints_deg": [20, 0, 0, 9, 0, 0, 0] }"#;

fn text(motions: &[&str]) -> String {
    let motions = motions.join(",\n");
    format!(
        r#"{{ "version": 1, "start": {{ "joints_deg": [0, 0, 0, 0, 0, 0, 0] }}, "motions": [
{motions} ] }}"#
    )
}

fn overlap_of(wait: &str) -> usize {
    let program = Program::from_json(&text(&[FIRST, FIRST, wait, NEXT])).unwrap();
    let Motion::Wait { overlap, .. } = program.motions[2] else { panic!("it is a wait") };
    overlap
}

fn error(motions: &[&str]) -> (String, usize, String) {
    let text = text(motions);
    let error = Program::from_json(&text).unwrap_err();
    let place = error.place();
    (error.message(), place.line - 1, text[place.span.clone()].to_owned())
}

#[test]
fn a_wait_counts_the_motions_that_it_overlaps() {
    assert_eq!(overlap_of(r#"{ "type": "wait", "seconds": 1, "overlap": true }"#), 1);
    assert_eq!(overlap_of(r#"{ "type": "wait", "seconds": 1, "overlap_motions": 1 }"#), 1);
    assert_eq!(overlap_of(r#"{ "type": "wait", "seconds": 1, "overlap_motions": 2 }"#), 2);
    let plain = r#"{ "type": "ptp", "joints_deg": [9, 0, 0, 0, 0, 0, 0] }"#;
    for wait in [
        r#"{ "type": "wait", "seconds": 1, "overlap": false }"#,
        r#"{ "type": "wait", "seconds": 1 }"#,
    ] {
        let program = Program::from_json(&text(&[plain, wait])).unwrap();
        assert_eq!(program.motions[1], Motion::Wait { seconds: 1.0, overlap: 0 });
    }
}

#[test]
fn waits_and_sources_are_written_as_they_were_read() {
    let sourced = r#"{ "type": "wait", "seconds": 0.5, "overlap_motions": 2,
        "source": { "file": "A.java", "line": 7 } }"#;
    let load = r#"{ "type": "load", "load": null, "source": { "file": "B.java", "line": 8 } }"#;
    let lin = r#"{ "type": "lin_rel", "offset": { "z_mm": 5 },
        "source": { "file": "A.java", "line": 9 } }"#;
    let ptp = r#"{ "type": "ptp", "joints_deg": [2, 0, 0, 9, 0, 0, 0],
        "source": { "file": "A.java", "line": 1 } }"#;
    let overlapping = r#"{ "type": "wait", "seconds": 0.25, "overlap": true }"#;
    let program =
        Program::from_json(&text(&[FIRST, FIRST, sourced, ptp, overlapping, load, lin])).unwrap();
    let sources: Vec<_> = program
        .sources
        .iter()
        .map(|(motion, source)| (motion.index(), source.to_string()))
        .collect();
    let expected = [(2, "A.java:7"), (3, "A.java:1"), (5, "B.java:8"), (6, "A.java:9")];
    assert_eq!(sources, expected.map(|(motion, source)| (motion, source.to_owned())));

    let json = program.to_json();
    assert_eq!(Program::from_json(&json).unwrap(), program);
    let written: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(written["motions"][2]["overlap_motions"], 2);
    assert_eq!(written["motions"][4]["overlap"], true);
    assert!(written["motions"][0].get("source").is_none(), "it has none");

    let list = MotionList::from(program);
    let json = serde_json::to_string(&list).unwrap();
    assert_eq!(MotionList::from_json(&json).unwrap(), list);
}

#[test]
fn both_keys_are_refused() {
    let wait = r#"{ "type": "wait", "seconds": 1, "overlap": true, "overlap_motions": 2 }"#;
    let (message, line, place) = error(&[FIRST, FIRST, wait, NEXT]);
    assert_eq!(message, "motion 3: give either `overlap` or `overlap_motions`");
    assert_eq!((line, place.as_str()), (3, "2"));
}

#[test]
fn a_wait_that_overlaps_nothing_is_refused() {
    let wait = r#"{ "type": "wait", "seconds": 1, "overlap": true }"#;
    let (message, line, place) = error(&[wait, NEXT]);
    assert!(
        message.starts_with("motion 1 overlaps a motion, but no motion precedes it"),
        "{message}"
    );
    assert_eq!((line, place.as_str()), (1, "true"));
    // A plain wait and a payload change stop the robot.
    let plain = r#"{ "type": "wait", "seconds": 1 }"#;
    let load = r#"{ "type": "load", "load": null }"#;
    assert!(error(&[NEXT, plain, wait]).0.starts_with("motion 3 overlaps a motion"));
    assert!(error(&[NEXT, load, wait]).0.starts_with("motion 3 overlaps a motion"));
    let two = r#"{ "type": "wait", "seconds": 1, "overlap_motions": 2 }"#;
    let (message, line, place) = error(&[NEXT, wait, two]);
    assert!(message.contains("overlaps 2 motions, but only one motion precedes it"), "{message}");
    assert_eq!((line, place.as_str()), (3, "2"));
    let none = r#"{ "type": "wait", "seconds": 1, "overlap_motions": 0 }"#;
    assert_eq!(error(&[NEXT, none]).0, "motion 2: overlap_motions must be at least 1");
    let many =
        format!(r#"{{ "type": "wait", "seconds": 1, "overlap_motions": {} }}"#, MAX_OVERLAP + 1);
    assert!(error(&[NEXT, &many]).0.ends_with("it may overlap at most 1000"));
}

#[test]
fn a_blend_looks_through_overlapping_waits() {
    let wait = r#"{ "type": "wait", "seconds": 1, "overlap": true }"#;
    let plain = r#"{ "type": "wait", "seconds": 1 }"#;
    let load = r#"{ "type": "load", "load": null }"#;
    let program = Program::from_json(&text(&[FIRST, wait, wait, NEXT])).unwrap();
    assert_eq!(program.blend_at_the_end(), None);
    assert!(error(&[FIRST, wait, plain, NEXT]).0.contains("followed by a wait"));
    assert!(error(&[FIRST, wait, load, NEXT]).0.contains("followed by a change of the load"));
    let program = Program::from_json(&text(&[NEXT, FIRST, wait])).unwrap();
    assert_eq!(program.blend_at_the_end(), Some(MotionIndex::new(1)));
}

#[test]
fn errors_name_the_source() {
    let far = r#"{ "type": "ptp", "joints_deg": [20, 0, 0, 9, 0, 0, 0], "velocity_rel": 2,
        "source": { "file": "Weld.java", "line": 84 } }"#;
    let (message, line, place) = error(&[FIRST, far]);
    assert!(message.starts_with("motion 2 (Weld.java:84): velocity_rel is 2"), "{message}");
    assert_eq!((line, place.as_str()), (2, "2"));
    let unread = far.replace("joints_deg", "joints_degrees");
    assert!(error(&[FIRST, &unread]).0.starts_with("motion 2 (Weld.java:84): "));
    let zero = far.replace("84", "0");
    let (message, line, _) = error(&[FIRST, &zero]);
    assert_eq!((message.as_str(), line), ("motion 2: the first line of a source is line 1", 3));
}

#[test]
fn messages_name_each_motion_with_its_source() {
    let mut program = Program::from_deg([0.0; 7]).ptp_deg([1.0; 7]).ptp_deg([2.0; 7]).build();
    program.sources.insert(MotionIndex::new(1), Source { file: "Weld.java".to_owned(), line: 12 });
    let text =
        program.sources.in_message("motion 1 and motion 2, not motion 20; a motion, motion 2");
    assert_eq!(
        text,
        "motion 1 and motion 2 (Weld.java:12), not motion 20; a motion, motion 2 (Weld.java:12)"
    );
}

#[test]
fn a_program_made_in_code_is_checked() {
    let blended = Motion::Ptp(Ptp::to([0.1; 7]).blend(Blend::Fraction(0.2)));
    let program = Program::from_deg([0.0; 7])
        .motion(blended)
        .motion(Motion::Wait { seconds: 0.1, overlap: 2 })
        .build();
    let fault = program.check(Robot::default().limits()).unwrap_err();
    let motion = MotionIndex::new(1);
    assert_eq!(fault, Fault::NothingToOverlap { motion, found: 2, before: 1 });
}
