//! Our own Sunrise projects, imported and compared with the stored programs and refusals.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use std::{
    fs,
    path::{Path, PathBuf},
};

use iiwa_kin::{Joints, Robot};
use iiwa_path::{JointPath, Step};
use iiwa_program::{Program, Source};
use iiwa_sunrise::{Answers, Project};
use iiwa_sunrise::{Import, ImportError, ImportOptions};
use serde::Deserialize;
use serde_json::Value;

fn fixtures() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../fixtures/sunrise")
}

/// Returns the subfolders of a folder, sorted by name.
fn folders(within: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(within).unwrap().map(|entry| entry.unwrap().path());
    let mut folders: Vec<_> =
        entries.filter(|path| path.is_dir() && !path.ends_with("refused")).collect();
    folders.sort();
    folders
}

fn options(folder: &Path) -> ImportOptions {
    let answers = fs::read_to_string(folder.join("iiwasim-answers.toml"))
        .map(|text| Answers::from_toml(&text).unwrap())
        .unwrap_or_default();
    ImportOptions { answers, ..ImportOptions::default() }
}

fn imported(folder: &Path) -> Result<Import, ImportError> {
    let project = Project::open(folder).unwrap();
    iiwa_sunrise::import(&project, None, &options(folder))
}

/// Returns the first difference between two documents. Numbers are compared to 1e-9, because sines
/// differ in the last bits between machines.
fn difference(path: &str, actual: &Value, stated: &Value) -> Option<String> {
    match (actual, stated) {
        (Value::Object(a), Value::Object(b)) => {
            let keys = a.keys().chain(b.keys());
            let null = Value::Null;
            keys.into_iter().find_map(|key| {
                let [a, b] = [a, b].map(|object| object.get(key).unwrap_or(&null));
                difference(&format!("{path}.{key}"), a, b)
            })
        }
        (Value::Array(a), Value::Array(b)) if a.len() == b.len() => {
            let pairs = a.iter().zip(b).enumerate();
            pairs.into_iter().find_map(|(i, (a, b))| difference(&format!("{path}[{i}]"), a, b))
        }
        (Value::Number(a), Value::Number(b)) => {
            let [a, b] = [a, b].map(|value| value.as_f64().unwrap());
            let is_same = (a - b).abs() <= 1e-9 * a.abs().max(b.abs()).max(1.0);
            (!is_same).then(|| format!("{path}: {a}, not {b}"))
        }
        (a, b) => (a != b).then(|| format!("{path}: {a}, not {b}")),
    }
}

fn end(program: &Program) -> Joints {
    let path = JointPath::new(program, &Robot::default()).unwrap();
    let moves = path.steps().iter().rev().find_map(|step| match step {
        Step::Move { segment, .. } => Some(segment.at(1.0).q),
        _ => None,
    });
    moves.unwrap()
}

#[test]
fn projects_are_imported_as_the_programs_that_they_are() {
    let mut wrong = Vec::new();
    let folders = folders(&fixtures());
    assert!(folders.len() >= 12);
    for folder in folders {
        let stated =
            Program::from_json(&fs::read_to_string(folder.join("expected.json")).unwrap()).unwrap();
        let name = folder.file_name().unwrap().display().to_string();
        let import = match imported(&folder) {
            Ok(import) => import,
            Err(error) => {
                wrong.push(format!("{name}: {error}"));
                continue;
            }
        };
        let [actual, expected] = [&import.program, &stated]
            .map(|program| serde_json::from_str::<Value>(&program.to_json()).unwrap());
        if let Some(difference) = difference(&name, &actual, &expected) {
            wrong.push(difference);
            continue;
        }
        for (actual, stated) in end(&import.program).into_iter().zip(end(&stated)) {
            assert!((actual - stated).abs().to_degrees() < 1e-6, "{name}");
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[derive(Deserialize)]
struct Refused {
    file: String,
    line: u32,
    reason_contains: Vec<String>,
}

#[test]
fn unknown_values_are_rejected_with_place_and_reason() {
    let mut wrong = Vec::new();
    let folders = folders(&fixtures().join("refused"));
    assert!(folders.len() >= 10);
    for folder in folders {
        let stated = fs::read_to_string(folder.join("expected.toml")).unwrap();
        let stated: Refused = toml::from_str(&stated).unwrap();
        let name = folder.file_name().unwrap().display().to_string();
        match imported(&folder) {
            Err(ImportError::Refused(refused_import)) => {
                let place = Source { file: stated.file, line: stated.line };
                if refused_import.source != place {
                    wrong.push(format!(
                        "{name}: at {}, not {place}: {}",
                        refused_import.source, refused_import.reason
                    ));
                }
                for part in stated.reason_contains {
                    if !refused_import.reason.contains(&part) {
                        wrong.push(format!("{name}: no {part:?} in {:?}", refused_import.reason));
                    }
                }
            }
            Err(error) => wrong.push(format!("{name}: {error}")),
            Ok(import) => {
                wrong.push(format!("{name}: {} motions", import.program.motions.len()));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
