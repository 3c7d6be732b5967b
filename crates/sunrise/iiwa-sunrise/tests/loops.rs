//! Loops: loops that end, the main cycle of an application, and endless waits.

use crate::evaluation::{MOVE, first_joints, import, joint_targets, refused_import};

fn with_move(run: &str) -> String {
    run.replace("MOVE", MOVE)
}

#[test]
fn a_loop_ends_when_its_condition_says_so() {
    let cases: [(&str, &[f64]); 6] = [
        ("double a = 0.1; do { MOVE } while (false); a = 0.2; MOVE", &[0.1, 0.2]),
        ("double a = 0.1; boolean on = true; do { MOVE on = false; } while (on); MOVE", &[0.1; 2]),
        ("int n = 3; double a = 0.1; do { MOVE n -= 1; } while (n > 0);", &[0.1; 3]),
        ("double a = 0.1; for (;;) { MOVE a += 0.25; if (a > 0.5) { break; } }", &[0.1, 0.35]),
        // An iteration without a motion may precede one with a motion.
        ("int n = 0; double a = 0.1; while (true) { n += 1; if (n == 3) { MOVE } }", &[0.1]),
        ("double a = 0.1; MOVE while (true) { Thread.sleep(1000); }", &[0.1]),
    ];
    for (run, expected) in cases {
        let joints = joint_targets("", &with_move(run));
        assert_eq!(joints.len(), expected.len(), "{run}: {joints:?}");
        for (actual, expected) in joints.iter().zip(expected) {
            assert!((actual - expected).abs() < 1e-12, "{run}: {actual}, not {expected}");
        }
    }
}

#[test]
fn a_loop_that_only_waits_is_not_the_cycle() {
    let cases = [
        ("double a = 0.1; MOVE while (!go) { Thread.sleep(100); } MOVE", "by a key, a thread"),
        ("double a = 0.1; MOVE do { Thread.sleep(100); } while (!go); MOVE", "by a key, a thread"),
        // Either of two inputs would end the loop.
        (
            "double a = 0.1; MOVE while (!cell.getLeft() && !cell.getRight()) \
             { Thread.sleep(100); } MOVE",
            "the input `Cell.Left`, for which no value is given",
        ),
        // The input is read in another statement.
        (
            "double a = 0.1; boolean is = cell.getLeft(); while (!is) \
             { Thread.sleep(9); is = cell.getLeft(); } MOVE",
            "the input `Cell.Left`, for which no value is given",
        ),
        // The robot moves in the loop.
        (
            "double a = 0.1; while (!cell.getLeft()) { MOVE }",
            "the input `Cell.Left`, for which no value is given",
        ),
    ];
    let members = "private boolean go; @Inject private CellIOGroup cell;";
    for (run, reason) in cases {
        let message = refused_import(members, &with_move(run));
        assert!(message.reason.contains(reason), "{run}: {}", message.reason);
    }
}

#[test]
fn an_input_that_is_waited_for_has_its_value_from_there_on() {
    let members = "@Inject private CellIOGroup cell;";
    let run = "double a = 0.1; while (cell.getOpen() == true) Thread.sleep(100);\n\
               if (cell.getOpen()) { a = 0.2; } MOVE";
    let import = import(members, &with_move(run)).unwrap();
    assert_eq!(first_joints(&import.program), [0.1]);
    let asked: Vec<_> =
        import.questions.iter().map(|question| (&*question.subject, &*question.answer)).collect();
    assert_eq!(asked[..2], [("Cell.Open", "false"); 2]);
    assert!(import.questions.iter().all(|question| !question.is_given));
    // A second loop may wait for the opposite value, which the input has from there on.
    let run = "double a = 0.1; while (!cell.getOpen()) Thread.sleep(100); while (cell.getOpen()) \
        Thread.sleep(100); if (cell.getOpen()) { a = 0.2; } MOVE";
    assert_eq!(joint_targets(members, &with_move(run)), [0.1]);
    // A loop that waits for a given value never ends.
    let run = "double a = 0.1; while (!cell.getOpen() || cell.getOpen()) Thread.sleep(100); MOVE";
    let message = refused_import(members, &with_move(run));
    assert!(message.reason.contains("`Cell.Open`, for which no value is given"), "{message:?}");
}

#[test]
fn a_loop_follows_robot_changes_of_its_iterations() {
    let members = "@Inject private CellIOGroup cell;";
    // The loop sets and reads outputs.
    let run = "cell.setLeft(0); double a = 0.1; while (cell.getLeft() < 3) \
        { MOVE cell.setLeft(cell.getLeft() + 1); }";
    assert_eq!(joint_targets(members, &with_move(run)), [0.1; 3]);
    // The loop reads the robot position.
    let run = "while (lbr.getCurrentJointPosition().get(0) < 0.45) { \
               double a = lbr.getCurrentJointPosition().get(0) + 0.2; MOVE }";
    assert_eq!(joint_targets(members, &with_move(run)).len(), 3);
    // The loop returns to its initial state.
    let run = "double a = 0; while (lbr.getCurrentJointPosition().get(0) < 0.45) { MOVE }";
    let import = import(members, &with_move(run)).unwrap();
    assert!(import.notes.iter().any(|note| note.text.contains("the loop has no end")));
}

#[test]
fn values_changed_in_a_branch_are_unknown_by_all_aliases() {
    let members = "void fill(List<Double> own) { own.add(0.5); } void plain(double own) { } \
        List<Double> all() { return all; }\n\
        private List<Double> all = new ArrayList<Double>(Arrays.asList(0.2, 0.1));";
    let cases = [
        "fill(all);",
        "Collections.sort(all);",
        "Collections.reverse(all);",
        "List<Double> other = all; other.add(0, 0.3);",
        "alias.set(0, 0.3);",
        "all.sort(null);",
        "all().add(0, 0.3);",
        "fill(all());",
    ];
    for change in cases {
        let run = format!(
            "List<Double> alias = all;\nif (System.nanoTime() > 5) {{ {change} }} double a = \
             all.get(0); MOVE"
        );
        let message = refused_import(members, &with_move(&run));
        assert!(message.reason.contains("clock"), "{change}: {}", message.reason);
    }
    let run = "if (System.nanoTime() > 5) { plain(all.get(1)); } double a = all.get(0); MOVE";
    assert_eq!(joint_targets(members, &with_move(run)), [0.2]);
}
