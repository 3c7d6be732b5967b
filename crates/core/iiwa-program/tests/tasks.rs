//! Tasks: their motions, other orders, and faults.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use iiwa_program::{MAX_TASKS, Motion, MotionIndex, Program, TaskFault};
use serde_json::{Value, json};

fn ptp(a1_deg: f64, group: &str) -> Value {
    json!({ "type": "ptp", "joints_deg": [a1_deg, 30, 0, -60, 0, 90, 0], "group": group })
}

fn wait(seconds: f64, group: &str) -> Value {
    json!({ "type": "wait", "seconds": seconds, "group": group })
}

fn text(tasks: &Value, motions: &[Value]) -> String {
    let start = json!({ "joints_deg": [0, 30, 0, -60, 0, 90, 0] });
    let program = json!({ "version": 1, "start": start, "tasks": tasks, "motions": motions });
    program.to_string()
}

fn read(tasks: &Value, motions: &[Value]) -> Program {
    Program::from_json(&text(tasks, motions)).unwrap()
}

/// Three tasks between two motions; the third one requires the first one.
fn three() -> Program {
    let mut home = ptp(0.0, "");
    home.as_object_mut().unwrap().remove("group");
    read(
        &json!([{ "group": "c", "after": ["a"] }, { "group": "a" }, { "group": "b" }]),
        &[
            home.clone(),
            ptp(1.0, "a"),
            wait(1.0, "a"),
            ptp(2.0, "b"),
            ptp(3.0, "c"),
            wait(3.0, "c"),
            home,
        ],
    )
}

#[test]
fn tasks_are_in_the_order_of_the_program() {
    let tasks = three().tasks().unwrap();
    let groups: Vec<_> = tasks.iter().map(|task| task.group.as_str()).collect();
    assert_eq!(groups, ["a", "b", "c"]);
    let entries: Vec<_> = tasks.iter().map(|task| task.entries.clone()).collect();
    assert_eq!(entries, [1..3, 3..4, 4..6]);
    assert_eq!(tasks.iter().map(|task| task.after.len()).collect::<Vec<_>>(), [0, 0, 1]);
    assert_eq!(tasks[2].after, [0]);
}

#[test]
fn a_program_with_tasks_reads_back() {
    let program = three();
    assert_eq!(Program::from_json(&program.to_json()).unwrap(), program);
    assert!(!program.sources.is_empty());
}

#[test]
fn another_order_moves_motions_with_their_groups() {
    let program = three();
    let (ordered, origins) = program.with_task_order(&[1, 0, 2]).unwrap();
    assert_eq!(origins, [0, 3, 1, 2, 4, 5, 6]);
    for (index, origin) in origins.iter().enumerate() {
        assert_eq!(ordered.motions[index], program.motions[*origin]);
        let label =
            |program: &Program, index| program.sources.label(MotionIndex::new(index)).cloned();
        assert_eq!(label(&ordered, index), label(&program, *origin));
    }
    assert_eq!(Program::from_json(&ordered.to_json()).unwrap(), ordered);
    // And back.
    assert_eq!(ordered.with_task_order(&[1, 0, 2]).unwrap().0, program);
    for wrong in [&[0, 1][..], &[0, 1, 1], &[0, 1, 3], &[0, 1, 2, 2]] {
        let error = program.with_task_order(wrong).unwrap_err();
        assert_eq!(error, TaskFault::Incomplete { tasks: 3 });
    }
    // The third one requires the first one.
    assert!(matches!(program.with_task_order(&[2, 0, 1]), Err(TaskFault::Order { .. })));
}

#[test]
fn blocks_within_a_task_move_with_it() {
    let block = json!({ "type": "repeat", "count": 3, "group": "b",
        "motions": [ptp(2.0, "b"), wait(2.0, "b")] });
    let tasks = json!([{ "group": "a" }, { "group": "b" }]);
    let program = read(&tasks, &[ptp(1.0, "a"), block]);
    let (ordered, _) = program.with_task_order(&[1, 0]).unwrap();
    assert_eq!(ordered.sources.repeats()[0].range(0), 0..6);
    assert!(ordered.to_json().contains("\"repeat\""));
    // Of a block around two tasks, the inner blocks are left.
    let inner = json!({ "type": "repeat", "count": 2, "motions": [ptp(1.0, "a")] });
    let block = json!({ "type": "repeat", "count": 1, "motions": [inner, ptp(2.0, "b")] });
    let program = read(&tasks, &[block, ptp(3.0, "b")]);
    let (ordered, _) = program.with_task_order(&[1, 0]).unwrap();
    let range = |program: &Program| match program.sources.repeats() {
        [block] => block.range(0),
        blocks => panic!("{blocks:?}"),
    };
    assert_eq!([range(&program), range(&ordered)], [0..3, 2..4]);
    // A block of two tasks would have to run them alternately.
    let block = json!({ "type": "repeat", "count": 2, "motions": [ptp(1.0, "a"), ptp(2.0, "b")] });
    let error = Program::from_json(&text(&tasks, &[block])).unwrap_err().to_string();
    assert!(error.contains("the motions of the task `a` do not follow each other"), "{error}");
}

/// The text of a fault, and the part of the program at its place.
fn fault(tasks: &Value, motions: &[Value]) -> (String, String) {
    let text = text(tasks, motions);
    let error = Program::from_json(&text).unwrap_err();
    (error.to_string(), text[error.place().span.clone()].to_owned())
}

#[test]
fn faults_name_the_task_and_its_place() {
    let ab = json!([{ "group": "a" }, { "group": "b" }]);
    let both = [ptp(1.0, "a"), ptp(2.0, "b")];
    let is = |(message, place): (String, String), expected: [&str; 2]| {
        assert!(message.contains(expected[0]), "{message}");
        assert!(place.contains(expected[1]), "{message}: {place}");
    };
    let c = json!([{ "group": "a" }, { "group": "c" }]);
    is(fault(&c, &both), ["no motion has the group `c`", r#""c""#]);
    let twice = json!([{ "group": "a" }, { "group": "a" }]);
    is(fault(&twice, &both), ["listed twice", r#""a""#]);
    let apart = [ptp(1.0, "a"), ptp(2.0, "b"), wait(1.0, "a")];
    is(fault(&ab, &apart), ["motion 2 does not belong to it", r#""b""#]);
    let between = [ptp(1.0, "a"), wait(1.0, "other"), ptp(2.0, "b")];
    is(fault(&ab, &between), ["motion 2 is between two tasks", "other"]);
    let line = json!({ "type": "lin_rel", "offset": { "z_mm": 50 }, "group": "b" });
    is(fault(&ab, &[ptp(1.0, "a"), line]), ["has to begin with a ptp", "lin_rel"]);
    is(fault(&ab, &[ptp(1.0, "a"), wait(1.0, "b")]), ["has to begin with a ptp", "wait"]);
    let frame = |e1_deg: Option<f64>, status: Option<u8>| {
        json!({ "type": "ptp", "group": "b", "frame": { "x_mm": 500, "y_mm": 0, "z_mm": 400,
            "a_deg": 0, "b_deg": 180, "c_deg": 0, "e1_deg": e1_deg, "status": status } })
    };
    for (e1_deg, status) in [(None, Some(2)), (Some(0.0), None)] {
        let wrong = fault(&ab, &[ptp(1.0, "a"), frame(e1_deg, status)]);
        is(wrong, ["to a frame with `e1_deg` and `status`", "frame"]);
    }
    assert!(read(&ab, &[ptp(1.0, "a"), frame(Some(0.0), Some(2))]).tasks().is_ok());
    let many: Vec<_> = (0..=MAX_TASKS).map(|task| json!({ "group": task.to_string() })).collect();
    is(fault(&json!(many), &both), ["201 tasks; at most 200", "["]);
    let overlap = json!({ "type": "wait", "seconds": 1, "overlap_motions": 2, "group": "b" });
    is(fault(&ab, &[ptp(1.0, "a"), ptp(2.0, "b"), overlap]), ["overlaps a motion before", "wait"]);
    let load = json!({ "type": "load", "load": { "mass_kg": 2 }, "group": "a" });
    let picks = [ptp(1.0, "a"), load, ptp(2.0, "b")];
    is(fault(&ab, &picks), ["ends with another payload", r#""a""#]);
    let unknown = json!([{ "group": "a" }, { "group": "b", "after": ["c"] }]);
    is(fault(&unknown, &both), ["`after` names `c`, which is not a task", r#""c""#]);
    let later = json!([{ "group": "a", "after": ["b"] }, { "group": "b" }]);
    is(fault(&later, &both), ["after `b`, which follows", r#""b""#]);
    let itself = json!([{ "group": "a", "after": ["a"] }, { "group": "b" }]);
    is(fault(&itself, &both), ["after `a`, which follows", r#""a""#]);
    is(fault(&json!([["a"]]), &both), ["expected an object", "["]);
}

#[test]
fn a_payload_that_a_task_puts_down_again_is_its_own() {
    let load = |load: Value| json!({ "type": "load", "group": "a", "load": load });
    let picked_up = load(json!({ "mass_kg": 2 }));
    let motions = [ptp(1.0, "a"), picked_up, ptp(4.0, "a"), load(Value::Null), ptp(2.0, "b")];
    let program = read(&json!([{ "group": "a" }, { "group": "b" }]), &motions);
    let (ordered, _) = program.with_task_order(&[1, 0]).unwrap();
    assert!(matches!(ordered.motions[2], Motion::Load(Some(_))));
    let masses = |program: &Program| {
        let loads = program.loads().into_iter();
        loads.map(|load| load.map_or(0.0, |load| load.mass_kg)).collect::<Vec<_>>()
    };
    assert_eq!(masses(&program), [0.0, 2.0, 2.0, 0.0, 0.0]);
    assert_eq!(masses(&ordered), [0.0, 0.0, 2.0, 2.0, 0.0]);
}
