//! Sunrise projects of a few lines, one per evaluation rule. Each folder of
//! `fixtures/sunrise-cases` has an `expected.toml`:
//!
//! - `motions`: the type of each motion, and values of its keys as in a program; `robot` and
//!   `flange_mm` likewise,
//! - `notes_contain`: a part of each note; an empty list for no notes,
//! - `asks`: `asked = answer` of each question in order, except for the robot, its flange and its
//!   start,
//! - or `refused`, with `file`, `line` and `reason_contains`,
//! - `application`, if the project has several,
//! - `answers`: the text of an answer file; if absent, `iiwasim-answers.toml` in the folder.
//!
//! Several runs of a project are `[[runs]]`, each with these keys.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use std::{
    fs,
    path::{Path, PathBuf},
};

use iiwa_program::Source;
use iiwa_sunrise::{Answers, Project, QuestionKind};
use iiwa_sunrise::{Import, ImportError, ImportOptions};
use serde::Deserialize;
use serde_json::Value;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Expected {
    answers: Option<String>,
    application: Option<String>,
    robot: Option<String>,
    flange_mm: Option<f64>,
    motions: Option<Vec<Value>>,
    notes_contain: Option<Vec<String>>,
    asks: Option<Vec<String>>,
    refused: Option<ExpectedRefusal>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Runs {
    runs: Vec<Expected>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ExpectedRefusal {
    file: String,
    line: u32,
    reason_contains: Vec<String>,
}

fn folders() -> Vec<PathBuf> {
    let cases = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../fixtures/sunrise-cases");
    let mut folders: Vec<_> =
        fs::read_dir(cases).unwrap().map(|entry| entry.unwrap().path()).collect();
    folders.sort();
    folders
}

/// Returns the runs of a folder: answers and expectation of each.
fn runs(folder: &Path) -> Vec<(Answers, Expected)> {
    let beside = fs::read_to_string(folder.join("iiwasim-answers.toml")).unwrap_or_default();
    let stated = fs::read_to_string(folder.join("expected.toml")).unwrap();
    let runs = if stated.contains("[[runs]]") {
        toml::from_str::<Runs>(&stated).unwrap().runs
    } else {
        vec![toml::from_str(&stated).unwrap()]
    };
    let with_answers = |expected: Expected| {
        let answers = expected.answers.as_ref().unwrap_or(&beside);
        (Answers::from_toml(answers).unwrap(), expected)
    };
    runs.into_iter().map(with_answers).collect()
}

/// Returns the first stated value that is not found. Numbers are compared to 1e-9.
fn difference(path: &str, actual: &Value, stated: &Value) -> Option<String> {
    match (actual, stated) {
        (Value::Object(actual), Value::Object(stated)) => {
            stated.iter().find_map(|(key, stated)| {
                difference(
                    &format!("{path}.{key}"),
                    actual.get(key).unwrap_or(&Value::Null),
                    stated,
                )
            })
        }
        (Value::Array(actual), Value::Array(stated)) if actual.len() == stated.len() => {
            let mut pairs = actual.iter().zip(stated).enumerate();
            pairs.find_map(|(i, (actual, stated))| {
                difference(&format!("{path}[{i}]"), actual, stated)
            })
        }
        (Value::Number(a), Value::Number(b)) => {
            let [a, b] = [a, b].map(|value| value.as_f64().unwrap());
            ((a - b).abs() > 1e-9).then(|| format!("{path}: {a}, not {b}"))
        }
        (a, b) => (a != b).then(|| format!("{path}: {a}, not {b}")),
    }
}

/// Returns the differences between an imported program and the expectation.
fn of_import(import: &Import, expected: &Expected) -> Vec<String> {
    let mut wrong = Vec::new();
    let Some(motions) = &expected.motions else {
        return vec![format!("imported, with {} motions", import.program.motions.len())];
    };
    let program: Value = serde_json::from_str(&import.program.to_json()).unwrap();
    wrong.extend(difference("motions", &program["motions"], &Value::from(motions.clone())));
    if let Some(robot) = &expected.robot {
        wrong.extend(difference("robot", &program["robot"], &Value::from(robot.clone())));
    }
    if let Some(flange_mm) = expected.flange_mm {
        wrong.extend(difference("flange_mm", &program["flange_mm"], &Value::from(flange_mm)));
    }
    let notes: Vec<_> = import.notes.iter().map(|note| note.text.as_str()).collect();
    if let Some(parts) = &expected.notes_contain {
        let is_missing = |part: &&String| !notes.iter().any(|note| note.contains(part.as_str()));
        wrong.extend(parts.iter().filter(is_missing).map(|part| format!("no note {part:?}")));
        if parts.is_empty() && !notes.is_empty() {
            wrong.push("there are notes".to_owned());
        }
    }
    let of_robot = [QuestionKind::Robot, QuestionKind::Flange, QuestionKind::Start];
    let asked = import.questions.iter().filter(|question| !of_robot.contains(&question.kind));
    let asked: Vec<_> =
        asked.map(|question| format!("{} = {}", question.subject, question.answer)).collect();
    if let Some(asks) = &expected.asks
        && *asks != asked
    {
        wrong.push(format!("asked {asked:?}, not {asks:?}"));
    }
    if !wrong.is_empty() {
        wrong.push(format!("notes: {notes:?}"));
    }
    wrong
}

/// Returns the differences between a refusal and the expectation.
fn of_refusal(error: &ImportError, expected: &Expected) -> Vec<String> {
    let (ImportError::Refused(refused), Some(stated)) = (error, &expected.refused) else {
        return vec![error.to_string()];
    };
    let mut wrong = Vec::new();
    let place = Source { file: stated.file.clone(), line: stated.line };
    if refused.source != place {
        wrong.push(format!("at {}, not {place}: {}", refused.source, refused.reason));
    }
    for part in &stated.reason_contains {
        if !refused.reason.contains(part) {
            wrong.push(format!("no {part:?} in {:?}", refused.reason));
        }
    }
    wrong
}

#[test]
fn cases_are_imported_or_refused_as_stated() {
    let mut wrong = Vec::new();
    let folders = folders();
    assert!(!folders.is_empty());
    for folder in folders {
        let project = Project::open(&folder).unwrap();
        for (number, (answers, expected)) in (1..).zip(runs(&folder)) {
            let options = ImportOptions { answers, ..ImportOptions::default() };
            let name = expected.application.as_deref();
            let import = match iiwa_sunrise::import(&project, name, &options) {
                Ok(import) => of_import(&import, &expected),
                Err(error) => of_refusal(&error, &expected),
            };
            let name = folder.file_name().unwrap().display();
            wrong.extend(
                import.into_iter().map(|difference| format!("{name}, run {number}: {difference}")),
            );
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
