//! Malformed instructions that all robot programs have to refuse: the file
//! `sunrise/conformance/bad_input.jsonl` contains the rows of the tables below.

use std::{collections::BTreeSet, env, fs};

use iiwa_kin::Robot;
use iiwa_link::robot_program::Instruction;
use iiwa_path::JointPath;
use iiwasim_tests::conformance;
use serde_json::{Value, json};

use crate::link::{
    corrupted::Corrupted,
    corrupted_motions::{corrupted_motions, with_doubled},
    instructions::{OTHER_WORDS, SEQ, corrupted_instructions, garbage},
    invalid_motions::invalid_motions,
};

/// Minimum number of malformed instructions.
const AT_LEAST: usize = 1000;

#[test]
fn the_file_of_malformed_instructions_has_the_rows_of_these_tables() {
    let path = conformance::folder().join("bad_input.jsonl");
    let rows = rows();
    let count = rows.len();
    assert!(count >= AT_LEAST, "{count}");
    let mut names = BTreeSet::new();
    for row in &rows {
        assert!(names.insert(row["name"].as_str().unwrap()), "{} is there twice", row["name"]);
    }
    let mut text = rows.iter().map(Value::to_string).collect::<Vec<_>>().join("\n");
    text.push('\n');
    if env::var_os("IIWASIM_RENEW").is_some() {
        fs::write(&path, &text).unwrap();
    }
    let Ok(stored) = fs::read_to_string(&path) else {
        println!("skipped: there is no {}", path.display());
        return;
    };
    let stored: Vec<Value> =
        stored.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let differs = rows.iter().zip(&stored).find(|(row, stored)| row != stored);
    assert!(
        differs.is_none() && stored.len() == count,
        "bad_input.jsonl has {} rows and is not that of the {count} in the tables: {differs:?}\n\
         If the tables are right, write it anew with IIWASIM_RENEW=1",
        stored.len()
    );
}

/// Returns all rows of the file.
fn rows() -> Vec<Value> {
    let mut rows = Vec::new();
    for (kind, Corrupted { message, name, change }) in corrupted_instructions() {
        let words: Vec<&str> = [name.as_str()].into_iter().chain(OTHER_WORDS).collect();
        rows.push(row(&format!("{kind}: {change}"), &message.to_string(), &words));
    }
    for (change, names, list) in corrupted_motions() {
        let others = ["column", "motion 1", "`x`", "unknown"];
        let words: Vec<&str> = names.iter().map(String::as_str).chain(others).collect();
        rows.push(row(&format!("motions, {change}"), &run_motions(&list[1..]), &words));
    }
    for (change, words, keys) in invalid_motions() {
        rows.push(row(&format!("motions, {change}"), &run_motions(&format!("{keys}}}")), words));
    }
    rows.extend(doubled_keys());
    rows.extend(no_instructions());
    let idle = json!({"state": "idle", "run": null, "outcome": null});
    rows.push(json!({"name": "nothing has run", "steps": [{"state": idle, "within_s": 10}]}));
    rows
}

/// Returns an instruction to run motions with these keys, and the closing brace.
fn run_motions(keys: &str) -> String {
    let segment = r#"{"type": "spl", "frame": "pick"}"#;
    let keys = keys.replace("@21", &[segment; 21].join(", "));
    format!(r#"{{"seq": {SEQ}, "type": "run_motions", "run": 1, {keys}"#)
}

fn doubled_keys() -> Vec<Value> {
    let motions = json!([{"type": "ptp", "joints_rad": [0, 0, 0, 0, 0, 0, 0]}]);
    let mut rows = Vec::new();
    for (good, keys) in [
        (json!({"type": "run_motions", "run": 1, "motions": motions}), vec!["run", "motions"]),
        (json!({"type": "begin", "run": 1}), vec!["run"]),
        (json!({"type": "run_trajectory", "run": 1}), vec!["run"]),
        (json!({"type": "end_trajectory", "run": 1}), vec!["run"]),
        (json!({"type": "get_io", "name": "x"}), vec!["name"]),
        (json!({"type": "set_io", "name": "x", "value": true}), vec!["name", "value"]),
        (json!({"type": "stop"}), vec![]),
        (json!({"type": "read_sensors"}), vec![]),
    ] {
        let mut good = good;
        good["seq"] = json!(SEQ);
        let kind = good["type"].as_str().unwrap();
        for key in keys.into_iter().chain(["seq", "type"]) {
            let text = with_doubled(&good, "", key);
            rows.push(row(&format!("{kind}: /{key} twice"), &text, &[key, "twice", "column"]));
        }
    }
    rows
}

/// Returns texts and bytes that are not instructions.
fn no_instructions() -> Vec<Value> {
    let words = ["column", "instruction", "object", "type", "seq"];
    let mut rows = Vec::new();
    let more = [
        "{",
        "}",
        "[1",
        "true",
        "7",
        "\"stop\"",
        "nul",
        "{\"seq\": 1",
        "{\"seq\": 1,}",
        " ",
        "{\"seq\": 1, \"type\": \"stop\"} {}",
        "{\"seq\": 1, \"type\": \"stop\"},",
        "\u{feff}{\"seq\": 1, \"type\": \"stop\"}",
        "{\"seq\": -1, \"type\": \"stop\"}",
        "{\"seq\": 1.0, \"type\": \"stop\"}",
        "{\"seq\": 1e2, \"type\": \"stop\"}",
        "{\"seq\": \"1\", \"type\": \"stop\"}",
        "{\"seq\": 01, \"type\": \"stop\"}",
        "{'seq': 1, 'type': 'stop'}",
        "{seq: 1, type: \"stop\"}",
        "{\"seq\": 1, \"type\": \"stop\u{1}\"}",
        "{\"seq\": 1, \"type\": \"st\\op\"}",
        "{\"seq\": 1, \"type\": \"stop\"",
        "{\"seq\": 1, \"type\": \"Stop\"}",
        "{\"seq\": 1, \"type\": \"\"}",
        "{\"seq\": 1, \"type\": \"stop \"}",
        "{\"Seq\": 1, \"type\": \"stop\"}",
        "{\"type\": \"stop\"}",
        "[{\"seq\": 1, \"type\": \"stop\"}]",
        "{\"seq\": 1, \"type\": \"\\u001b[31mred\"}",
        "GET / HTTP/1.1\r\n\r\n",
    ];
    let texts = garbage().into_iter().chain(more.map(str::to_owned));
    for (i, text) in (1..).zip(texts.filter(|text| text.len() < 10_000)) {
        rows.push(row(&format!("no instruction {i}"), &text, &words));
    }
    let refused = json!({"seq": null, "error": {"code": "bad_request"}});
    let repeated = |text: &str| json!({"send_repeated": {"text": text, "times": 100_000}});
    for (name, send) in [
        ("100 000 brackets", repeated("[")),
        ("100 000 objects in objects", repeated("{\"a\":")),
        ("100 000 letters", repeated("x")),
        ("bytes that are no text", json!({"send_hex": "fffe"})),
        ("a byte of zero", json!({"send_hex": "00"})),
        ("half a letter", json!({"send_hex": "7b22736571223a312c2274797065223a227374c3227d"})),
        ("two frames", json!({"send_frames": ["{}", "{}"]})),
        (
            "an instruction in two frames",
            json!({"send_frames": ["{\"seq\": 1,", "\"type\": \"stop\"}"]}),
        ),
        (
            "an instruction and a frame more",
            json!({"send_frames": ["{\"seq\": 1, \"type\": \"stop\"}", ""]}),
        ),
    ] {
        rows.push(json!({"name": name, "steps": [send, {"expect": refused}]}));
    }
    let long = format!(r#"{{"seq": 1, "type": "{}\u001b"}}"#, "x".repeat(2000));
    rows.push(row("a long type", &long, &["xxx..."]));
    rows
}

/// Returns the case of a refused instruction, after a check against the parser and the planner.
fn row(name: &str, text: &str, words: &[&str]) -> Value {
    let (seq, instruction) = Instruction::from_json(text.as_bytes());
    if let Ok(Instruction::RunMotions { motions, .. }) = &instruction {
        match JointPath::new(&motions.clone().starting_at([0.0; 7]), &Robot::default()) {
            Err(fault) if !fault.is_of_the_arm() => {}
            other => panic!("{name}: {other:?}"),
        }
    } else if let Ok(instruction) = &instruction {
        // Only the cabinet knows its inputs and outputs.
        let names_something =
            matches!(instruction, Instruction::GetIo { .. } | Instruction::SetIo { .. });
        assert!(names_something, "{name}: {text}");
    }
    let send = match serde_json::from_str::<Value>(text) {
        Ok(value) if same(&value, text) => json!({"send": value}),
        _ => json!({"send_text": text}),
    };
    let message = json!({"$has_any": words});
    let answer = json!({"seq": seq, "error": {"code": "bad_request", "message": message}});
    json!({"name": name, "steps": [send, {"expect": answer}]})
}

/// Returns true if the text is equivalent to the value: `false` for duplicate keys, which the value
/// loses.
fn same(value: &Value, text: &str) -> bool {
    let bare = |text: &str| text.chars().filter(|letter| !letter.is_whitespace()).count();
    value.is_object() && bare(&value.to_string()) == bare(text)
}
