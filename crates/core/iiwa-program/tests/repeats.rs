//! Repeat blocks.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use iiwa_json::JsonStep;
use iiwa_kin::Robot;
use iiwa_program::{
    Fault, MAX_REPEAT_DEPTH, MAX_REPEATED, Motion, MotionIndex, MotionLabel, MotionList, Program,
    ProgramError, RepeatBlock, Round, Source, motion_path,
};
use serde_json::{Value, json};

fn wait(seconds: f64) -> Value {
    json!({ "type": "wait", "seconds": seconds })
}

fn repeat(count: u64, motions: &[Value]) -> Value {
    json!({ "type": "repeat", "count": count, "motions": motions })
}

fn document(motions: &[Value]) -> Value {
    json!({ "version": 1, "start": { "joints_rad": [0.0, 0.5, 0.0, -1.0, 0.0, 1.5, 0.0] },
        "motions": motions })
}

fn read(motions: &[Value]) -> Program {
    Program::from_json(&document(motions).to_string()).unwrap()
}

fn error(motions: &[Value]) -> (String, String) {
    let text = document(motions).to_string();
    let error = Program::from_json(&text).unwrap_err();
    (error.message(), text[error.place().span.clone()].to_owned())
}

fn seconds(program: &Program) -> Vec<f64> {
    let seconds = |motion: &Motion| match motion {
        Motion::Wait { seconds, .. } => *seconds,
        _ => f64::NAN,
    };
    program.motions.iter().map(seconds).collect()
}

/// The entries of the program as written.
fn written(program: &Program) -> Value {
    serde_json::from_str::<Value>(&program.to_json()).unwrap()["motions"].take()
}

#[test]
fn blocks_are_written_out_and_read_back() {
    let nested = [
        wait(1.0),
        repeat(2, &[wait(2.0), repeat(3, &[wait(3.0), wait(4.0)]), wait(5.0)]),
        repeat(1, &[wait(6.0)]),
        wait(7.0),
    ];
    let program = read(&nested);
    let round = [2.0, 3.0, 4.0, 3.0, 4.0, 3.0, 4.0, 5.0];
    let expected = [[1.0].as_slice(), &round, &round, &[6.0, 7.0]].concat();
    assert_eq!(seconds(&program), expected);
    assert_eq!(written(&program), Value::from(nested.to_vec()));
    assert_eq!(Program::from_json(&program.to_json()).unwrap(), program);
    let rounds = |index| program.sources.rounds(MotionIndex::new(index));
    assert_eq!(rounds(0), []);
    assert_eq!(rounds(1), [Round { number: 1, count: 2 }]);
    assert_eq!(rounds(12), [Round { number: 2, count: 2 }, Round { number: 2, count: 3 }]);
    assert_eq!(rounds(17), [Round { number: 1, count: 1 }]);
    assert_eq!(rounds(18), []);
}

#[test]
fn blocks_give_the_motions_of_a_program_without_blocks() {
    let program = read(&[repeat(3, &[wait(1.0), wait(2.0)])]);
    let plain = read(&[1.0, 2.0, 1.0, 2.0, 1.0, 2.0].map(wait));
    assert_eq!(program.motions, plain.motions);
    assert!(plain.sources.is_empty());
    assert!(!program.sources.is_empty());
}

#[test]
fn counts_are_bounded() {
    let (message, place) = error(&[wait(1.0), repeat(0, &[wait(1.0)])]);
    assert_eq!(message, "motion 2: the repeat block's count is 0; it must be from 1 to 100000");
    assert_eq!(place, "0");
    let (message, place) = error(&[repeat(100_001, &[wait(1.0)])]);
    let expected = "motion 1: the repeat block's count is 100001; it must be from 1 to 100000";
    assert_eq!((message.as_str(), place.as_str()), (expected, "100001"));
    for count in [json!(-1), json!(2.5), json!("2"), json!(null), json!(1e30)] {
        let block = json!({ "type": "repeat", "count": count, "motions": [wait(1.0)] });
        assert_eq!(error(&[block]).1, count.to_string());
    }
    let (message, place) = error(&[json!({ "type": "repeat", "motions": [wait(1.0)] })]);
    assert!(message.contains("`count`"), "{message}");
    assert!(place.starts_with('{'), "{place}");
    let (message, place) = error(&[repeat(2, &[])]);
    assert_eq!(message, "motion 1: the repeat block has no motions; add at least one");
    assert_eq!(place, "[]");
}

/// Blocks that do not fit are refused before their motions are written out.
#[test]
fn sizes_are_bounded() {
    assert_eq!(read(&[repeat(MAX_REPEATED as u64, &[wait(0.0)])]).motions.len(), MAX_REPEATED);
    let mut block = repeat(1000, &[wait(0.0)]);
    for _ in 0..4 {
        block = repeat(1000, &[block]);
    }
    let (message, place) = error(&[block]);
    let expected = "motion 1: written out, the repeat blocks have 1000000 motions, spline \
                    segments and load shapes; at most 100000 are allowed; repeat fewer motions or \
                    rounds";
    assert_eq!((message.as_str(), place.as_str()), (expected, "1000"));
    // The blocks of a program count together; the motions outside of blocks do not count.
    let half = repeat(60_000, &[wait(0.0)]);
    let (message, _) = error(&[half.clone(), wait(0.0), half]);
    assert!(
        message.starts_with("motion 60002: written out, the repeat blocks have 120000 motions")
    );
    let frame =
        json!({ "x_mm": 500, "y_mm": 0, "z_mm": 400, "a_deg": 0, "b_deg": 180, "c_deg": 0 });
    let segments = vec![json!({ "type": "spl", "frame": frame }); 20];
    let spline = json!({ "type": "spline", "segments": segments });
    let (message, _) = error(&[repeat(5001, &[spline])]);
    assert!(message.contains("have 100020 motions"), "{message}");
    let long = json!({ "type": "wait", "seconds": 0, "comment": "c".repeat(2000) });
    let (message, _) = error(&[repeat(8001, &[long])]);
    assert!(message.contains("16002000 bytes of names"), "{message}");
    let tool = json!({ "type": "lin_rel", "offset": { "z_mm": 1 }, "tool": "t".repeat(20_000) });
    let (message, _) = error(&[repeat(801, &[tool])]);
    assert!(message.contains("16020000 bytes of names"), "{message}");
    let source = json!({ "file": "f".repeat(4000), "line": 1 });
    let sourced = json!({ "type": "wait", "seconds": 0, "source": source });
    let (message, _) = error(&[repeat(4001, &[sourced])]);
    assert!(message.contains("16004000 bytes of names"), "{message}");
    let source = json!({ "file": "f".repeat(4097), "line": 1 });
    let (message, place) = error(&[json!({ "type": "wait", "seconds": 0, "source": source })]);
    let expected = "motion 1: `source.file` has 4097 characters; at most 4096 are allowed";
    assert_eq!(message, expected);
    assert!(place.starts_with("\"fff"), "{place}");
    // The rest of a block that is too large is not read.
    let mut long = vec![wait(0.0); MAX_REPEATED + 1];
    long.push(json!({ "type": "unknown" }));
    let (message, _) = error(&[repeat(1, &long)]);
    assert!(message.contains("have 100001 motions"), "{message}");
}

#[test]
fn errors_of_blocks_name_them() {
    for (count, motions) in [(0, vec![wait(0.0)]), (2, vec![]), (100_000, vec![wait(0.0); 2])] {
        let block =
            json!({ "type": "repeat", "count": count, "motions": motions, "name": "shake" });
        let (message, _) = error(&[block]);
        assert!(message.starts_with("motion 1 \"shake\": "), "{message}");
    }
}

#[test]
fn the_nesting_is_bounded() {
    let nested = |depth| (0..depth).fold(wait(0.0), |inner, _| repeat(1, &[inner]));
    assert_eq!(read(&[nested(MAX_REPEAT_DEPTH)]).motions.len(), 1);
    let (message, _) = error(&[nested(MAX_REPEAT_DEPTH + 1)]);
    let expected = "motion 1: repeat blocks are nested more than 8 deep; write out one";
    assert_eq!(message, expected);
    // Deeper than any reader can descend.
    let open = r#"{"type":"repeat","count":1,"motions":["#.repeat(100_000);
    let text = document(&[]).to_string();
    let text = text.replace("[]", &format!("[{open}{}]", "]}".repeat(100_000)));
    let error = Program::from_json(&text).unwrap_err();
    assert!(error.message().contains("nested more than 8 deep"), "{}", error.message());
    assert_eq!(Program::all_errors(&text, error).len(), 1);
}

/// An error of a block or in a block is reported once, where it is written.
#[test]
fn errors_have_their_places() {
    let text = r#"{ "version": 1, "start": { "joints_deg": [0, 0, 0, 0, 0, 0, 0] },
  "motions": [
    { "type": "repeat", "count": 5, "motions": [
      { "type": "wait", "seconds": 1 },
      { "type": "repeat", "count": 2, "motions": [
        { "type": "wait", "seconds": -1, "name": "short" },
        { "type": "movej" } ] },
      { "type": "wait", "second": 1 } ] },
    { "type": "repeat", "cuont": 5, "motions": [
      { "type": "wait", "seconds": -2 },
      { "type": "repeat", "count": 0, "motions": [{ "type": "lin" }] } ] },
    { "type": "loop", "count": 5, "motions": [] },
    { "type": "wait", "seconds": -3 } ] }"#;
    let first = Program::from_json(text).unwrap_err();
    let errors = Program::all_errors(text, first);
    let found: Vec<_> = errors.iter().map(|error| (error.place().line, error.message())).collect();
    let expected = [
        (
            6,
            "motion 2 \"short\" (round 1 of 5, 1 of 2): a wait of -1 s; it must be from 0 to \
             86400 s",
        ),
        (7, "motion 3: unknown type `movej`; did you mean `ptp`?"),
        (8, "motion 6: unknown key `second`; did you mean `seconds`?"),
        (9, "motion 31: unknown key `cuont`; did you mean `count`?"),
        (10, "motion 31 (round 1 of 1): a wait of -2 s; it must be from 0 to 86400 s"),
        (11, "motion 32: the repeat block's count is 0; it must be from 1 to 100000"),
        (11, "motion 32: the key `frame` is missing"),
        (12, "motion 33: unknown type `loop`; did you mean `repeat`?"),
        (13, "motion 34: a wait of -3 s; it must be from 0 to 86400 s"),
    ];
    assert_eq!(found, expected.map(|(line, message)| (line, message.to_owned())));
}

/// A syntax error is found before the motions can be counted.
#[test]
fn syntax_errors_after_a_block_have_no_motion() {
    let text = document(&[wait(1.0), repeat(2, &[wait(1.0)]), wait(5.5)]).to_string();
    let error = Program::from_json(&text.replace("5.5", "5..5")).unwrap_err();
    assert_eq!(error.motion(), None);
    let error = Program::from_json(&text.replacen("1.0", "1..0", 1)).unwrap_err();
    assert_eq!(error.motion(), Some(MotionIndex::new(0)));
}

/// Faults of later rounds, such as a blend before the wait that begins the next round.
#[test]
fn faults_between_rounds_are_found() {
    let ptp = |a1_deg: f64, blend| {
        let joints_deg = [a1_deg, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        json!({ "type": "ptp", "joints_deg": joints_deg, "blend": blend })
    };
    let blend = json!({ "fraction": 0.2 });
    let blended = [ptp(10.0, blend.clone()), ptp(0.0, blend.clone())];
    assert_eq!(read(&[repeat(3, &blended)]).blend_at_the_end(), Some(MotionIndex::new(5)));
    let before_wait = [wait(1.0), ptp(10.0, json!(null)), ptp(0.0, blend)];
    assert_eq!(read(&[repeat(1, &before_wait)]).motions.len(), 3);
    let (message, place) = error(&[repeat(2, &before_wait)]);
    assert!(message.starts_with("motion 3 (round 1 of 2) is followed by a wait"), "{message}");
    assert_eq!(place, r#"{"fraction":0.2}"#);
    // In the first round, too few motions precede the wait.
    let overlap = |motions| json!({ "type": "wait", "seconds": 1, "overlap_motions": motions });
    let round = |motions| [ptp(10.0, json!(null)), overlap(motions), ptp(0.0, json!(null))];
    let program = read(&[ptp(5.0, json!(null)), repeat(4, &round(2))]);
    let waits = program.overlapping_waits();
    assert_eq!(waits.iter().map(|it| it.since.index()).collect::<Vec<_>>(), [0, 3, 6, 9]);
    let (message, place) = error(&[repeat(4, &round(2))]);
    assert!(message.starts_with("motion 2 (round 1 of 4) overlaps 2 motions"), "{message}");
    assert_eq!(place, "2");
}

#[test]
fn motions_without_a_group_get_the_group_of_the_block() {
    let group = |mut entry: Value, group: &str| {
        entry["group"] = json!(group);
        entry
    };
    let inner = group(repeat(2, &[wait(3.0)]), "inner");
    let block = group(repeat(2, &[wait(1.0), group(wait(2.0), "own"), inner, wait(4.0)]), "stack");
    let motions = [block, wait(5.0)];
    let program = read(&motions);
    let groups = (0..program.motions.len()).map(|index| {
        let label = program.sources.label(MotionIndex::new(index));
        label.and_then(|label| label.group.as_deref())
    });
    let round = ["stack", "own", "inner", "inner", "stack"].map(Some);
    assert_eq!(groups.collect::<Vec<_>>(), [round.as_slice(), &round, &[None]].concat());
    assert_eq!(written(&program), Value::from(motions.to_vec()));
}

#[test]
fn labels_of_blocks_are_checked_and_kept() {
    let mut block = repeat(2, &[wait(1.0)]);
    block["name"] = json!("stack");
    block["comment"] = json!("two parts");
    let program = read(std::slice::from_ref(&block));
    assert_eq!(program.sources.repeats()[0].label.name.as_deref(), Some("stack"));
    assert_eq!(written(&program), json!([block]));
    block["name"] = json!("");
    assert_eq!(error(&[block]).0, "motion 1: `name` is empty");
}

/// Changed programs are written with the motions that they have.
#[test]
fn blocks_with_different_rounds_are_written_out() {
    let motions = [repeat(2, &[wait(1.0), repeat(2, &[wait(2.0)])]), wait(9.0)];
    let program = read(&motions);
    let mut changed = program.clone();
    changed.motions[3] = Motion::Wait { seconds: 5.0, overlap: 0 };
    let inner = repeat(2, &[wait(2.0)]);
    let expected = json!([wait(1.0), inner, wait(5.0), inner, wait(9.0)]);
    assert_eq!(written(&changed), expected);
    let mut labelled = program.clone();
    let source = Source { file: "A.java".to_owned(), line: 3 };
    labelled.sources.insert(MotionIndex::new(3), source);
    assert_eq!(written(&labelled).as_array().unwrap().len(), 5);
    // Whatever is done to the motions, the text has the same ones.
    let mut random = fastrand::Rng::with_seed(3);
    for _ in 0..300 {
        let mut edited = program.clone();
        for _ in 0..random.usize(1..4) {
            let index = random.usize(0..edited.motions.len());
            match random.u8(0..3) {
                0 => drop(edited.motions.remove(index)),
                1 => edited.motions.insert(index, edited.motions[0].clone()),
                _ => edited.motions.swap(0, index),
            }
        }
        let read = Program::from_json(&edited.to_json()).unwrap();
        assert_eq!(read.motions, edited.motions);
    }
    let emptied = Program { motions: Vec::new(), ..program };
    assert_eq!(written(&emptied), json!([]));
}

/// Motion lists are sent to robot programs, which know no blocks.
#[test]
fn motion_lists_are_written_out() {
    let text = json!({ "motions": [repeat(2, &[wait(1.0), wait(2.0)])] }).to_string();
    let list = MotionList::from_json(&text).unwrap();
    let written = serde_json::to_value(&list).unwrap();
    let expected = [1.0, 2.0, 1.0, 2.0].map(wait);
    assert_eq!(written, json!({ "motions": expected }));
}

#[test]
fn paths_lead_into_blocks() {
    let motions = [wait(1.0), repeat(2, &[wait(2.0), repeat(3, &[wait(3.0)])]), wait(4.0)];
    let text = document(&motions).to_string();
    let steps = |motion: usize| {
        let path = motion_path(&text, MotionIndex::new(motion));
        let index = |step: &JsonStep<'_>| match step {
            JsonStep::Index(index) => Some(*index),
            JsonStep::Key(_) => None,
        };
        path.iter().filter_map(index).collect::<Vec<_>>()
    };
    let places: Vec<_> = (0..11).map(steps).collect();
    let expected: [&[usize]; 11] = [
        &[0],
        &[1, 0],
        &[1, 1, 0],
        &[1, 1, 0],
        &[1, 1, 0],
        &[1, 0],
        &[1, 1, 0],
        &[1, 1, 0],
        &[1, 1, 0],
        &[2],
        &[10],
    ];
    assert_eq!(places, expected);
}

#[test]
fn unknown_names_in_blocks_have_one_error() {
    let frame = json!({ "x_mm": 500, "y_mm": 0, "z_mm": 400, "a_deg": 0, "b_deg": 180, "c_deg": 0,
        "base": "nowhere" });
    let lin = json!({ "type": "lin", "frame": frame });
    let offset = json!({ "type": "lin_rel", "offset": { "z_mm": 1 }, "tool": "pen" });
    let text = document(&[wait(1.0), repeat(50, &[lin, repeat(2, &[offset])])]).to_string();
    let program = Program::from_json(&text).unwrap();
    let faults = program.faults(&Robot::default());
    let places = faults.iter().map(|fault| &text[fault.place_in(&text).span]);
    assert_eq!(places.collect::<Vec<_>>(), ["\"nowhere\"", "\"pen\""]);
}

/// In the first round the motion before the block is overlapped, in later rounds none is.
#[test]
fn faults_of_later_rounds_are_found() {
    let ptp = json!({ "type": "ptp", "joints_deg": [1, 0, 0, 0, 0, 0, 0] });
    let over = json!({ "type": "wait", "seconds": 1, "overlap": true });
    let mut program = read(&[ptp.clone(), over.clone(), wait(1.0)]);
    let text = document(&[ptp, repeat(3, &[over, wait(1.0)])]).to_string();
    let error = Program::from_json(&text).unwrap_err();
    assert_eq!(error.motion(), Some(MotionIndex::new(3)));
    let (before, round) = program.motions.split_at(1);
    program.motions = [before, round, round, round].concat();
    let label = MotionLabel::default();
    let block = RepeatBlock { first: 1, motions: 2, count: 3, label, inner: Vec::new() };
    program.sources.set_repeats(vec![block]);
    let faults = program.faults(&Robot::default());
    let motions: Vec<_> = faults.iter().filter_map(Fault::motion).collect();
    assert_eq!(motions, [MotionIndex::new(3)]);
}

/// A block with a fault in each round does not hide later faults.
#[test]
fn faults_in_blocks_count_once() {
    let text = document(&[repeat(100, &[wait(-1.0)]), wait(-2.0)]).to_string();
    let error = Program::from_json(&text).unwrap_err();
    let motions = Program::all_errors(&text, error).iter().map(ProgramError::motion).collect();
    let motions: Vec<_> = motions;
    assert_eq!(motions, [0, 100].map(|index| Some(MotionIndex::new(index))));
}

#[test]
fn builders_repeat() {
    let program = Program::from_deg([0.0; 7])
        .wait_s(1.0)
        .repeat(2, |round| round.wait_s(2.0).repeat(2, |inner| inner.wait_s(3.0)))
        .repeat(0, |round| round.wait_s(9.0))
        .repeat(2, |round| round)
        .wait_s(4.0)
        .build();
    assert_eq!(seconds(&program), [1.0, 2.0, 3.0, 3.0, 2.0, 3.0, 3.0, 4.0]);
    let expected = [wait(1.0), repeat(2, &[wait(2.0), repeat(2, &[wait(3.0)])]), wait(4.0)];
    assert_eq!(written(&program), Value::from(expected.to_vec()));
    // Another builder than the one that the closure receives.
    let other = Program::from_deg([0.0; 7]).repeat(2, |round| round.wait_s(1.0));
    let replaced = Program::from_deg([0.0; 7]).wait_s(5.0).repeat(2, |_| other).build();
    assert_eq!(seconds(&replaced), [1.0; 3]);
    // A block that the reader would refuse is written out.
    let large =
        Program::from_deg([0.0; 7]).repeat(MAX_REPEATED + 1, |round| round.wait_s(0.0)).build();
    assert_eq!(written(&large).as_array().unwrap().len(), MAX_REPEATED + 1);
}
