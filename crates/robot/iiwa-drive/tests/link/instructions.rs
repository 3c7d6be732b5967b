//! Valid instructions to the robot program, and their fields.

use serde_json::{Value, json};

use crate::link::corrupted::{Corrupted, Field, Requirement, corrupted, fields_of, good_requests};

/// Sequence number of each instruction.
pub(crate) const SEQ: u64 = 7;

/// Words that may replace the field name in messages about an invalid instruction.
pub(crate) const OTHER_WORDS: [&str; 6] =
    ["column", "motion 1", "no input or output", "true or false", "`x`", "unknown"];

/// Returns instructions with an invalid field, each with its type.
pub(crate) fn corrupted_instructions() -> Vec<(String, Corrupted)> {
    let mut all = Vec::new();
    for (mut good, fields) in good_instructions() {
        good["seq"] = json!(SEQ);
        let kind = good["type"].as_str().unwrap().to_owned();
        all.extend(corrupted(&good, &fields).into_iter().map(|row| (kind.clone(), row)));
    }
    all
}

fn good_instructions() -> Vec<(Value, Vec<Field<'static>>)> {
    let seq = Field("/seq", Requirement::Required, &["3"]);
    let kind = || Field("/type", Requirement::Required, &[]);
    let run = || Field("/run", Requirement::Required, &["3"]);
    let mut motions = good_requests().swap_remove(0);
    motions["run"] = json!(1);
    vec![
        (motions, {
            let mut fields = fields_of("run_motions");
            fields.push(run());
            fields
        }),
        (json!({"type": "begin", "run": 1}), vec![run()]),
        (json!({"type": "run_trajectory", "run": 1}), vec![run()]),
        (json!({"type": "end_trajectory", "run": 1}), vec![run()]),
        (json!({"type": "get_io", "name": "MediaFlange.LEDBlue"}), fields_of("get_io")),
        (
            json!({"type": "set_io", "name": "MediaFlange.LEDBlue", "value": true}),
            fields_of("set_io"),
        ),
        (json!({"type": "read_sensors"}), vec![kind()]),
        (json!({"type": "list_io"}), vec![kind()]),
        (json!({"type": "stop"}), vec![seq]),
    ]
}

/// Returns texts that are not instructions.
pub(crate) fn garbage() -> Vec<String> {
    vec![
        String::new(),
        "{}".to_owned(),
        "[]".to_owned(),
        "null".to_owned(),
        r#"{"seq": 1, "seq": 1, "type": "stop"}"#.to_owned(),
        r#"{"seq": 18446744073709551616, "type": "stop"}"#.to_owned(),
        format!(r#"{{"seq": 1, "type": "{}\u001b"}}"#, "x".repeat(10_000)),
        r#"{"seq": 1, "type": "fly\u001b"}"#.to_owned(),
        "[".repeat(100_000),
    ]
}
