//! Loops: which end, which are the cycle of an application, and which wait for ever.

use crate::evaluation::{MOVE, first_joints, goes, import, refused};

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
        // A turn without a motion may come before one with a motion.
        ("int n = 0; double a = 0.1; while (true) { n += 1; if (n == 3) { MOVE } }", &[0.1]),
        ("double a = 0.1; MOVE while (true) { Thread.sleep(1000); }", &[0.1]),
    ];
    for (run, expected) in cases {
        let found = goes("", &with_move(run));
        assert_eq!(found.len(), expected.len(), "{run}: {found:?}");
        for (found, expected) in found.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-12, "{run}: {found}, not {expected}");
        }
    }
}

#[test]
fn a_loop_that_only_waits_is_not_the_cycle() {
    let cases = [
        ("double a = 0.1; MOVE while (!go) { Thread.sleep(100); } MOVE", "a key, a thread"),
        ("double a = 0.1; MOVE do { Thread.sleep(100); } while (!go); MOVE", "a key, a thread"),
        // Either of two inputs would end it.
        (
            "double a = 0.1; MOVE while (!cell.getLeft() && !cell.getRight()) { Thread.sleep(100); } MOVE",
            "--input Cell.Left=VALUE",
        ),
        // It is read elsewhere.
        (
            "double a = 0.1; boolean is = cell.getLeft(); while (!is) { Thread.sleep(9); is = cell.getLeft(); } MOVE",
            "--input Cell.Left=VALUE",
        ),
        // The arm moves meanwhile.
        ("double a = 0.1; while (!cell.getLeft()) { MOVE }", "--input Cell.Left=VALUE"),
    ];
    let members = "private boolean go; @Inject private CellIOGroup cell;";
    for (run, reason) in cases {
        let found = refused(members, &with_move(run));
        assert!(found.reason.contains(reason), "{run}: {}", found.reason);
    }
}

#[test]
fn an_input_that_is_waited_for_has_its_value_from_there_on() {
    let members = "@Inject private CellIOGroup cell;";
    let run = "double a = 0.1; while (cell.getOpen() == true) Thread.sleep(100);\n\
               if (cell.getOpen()) { a = 0.2; } MOVE";
    let import = import(members, &with_move(run)).unwrap();
    assert_eq!(first_joints(&import.program), [0.1]);
    let asked: Vec<_> = import.questions.iter().map(|own| (&*own.asked, &*own.answer)).collect();
    assert_eq!(asked[..2], [("Cell.Open", "false"); 2]);
    assert!(import.questions.iter().all(|own| !own.is_given));
    // Another loop that waits for the other value would wait for ever.
    let run = "double a = 0.1; while (!cell.getOpen()) Thread.sleep(100); while (cell.getOpen()) Thread.sleep(100); MOVE";
    let found = refused(members, &with_move(run));
    assert!(found.reason.contains("`Cell.Open`, which is taken as true"), "{}", found.reason);
}
