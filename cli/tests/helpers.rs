//! Programs and plans for tests of the command.

use std::path::{Path, PathBuf};

use assert_cmd::{assert::Assert, cargo::cargo_bin_cmd};
use tempfile::TempDir;

/// Runs `iiwasim plan` in a folder.
pub(crate) fn plan(folder: &TempDir, program: &Path, arguments: &[&str]) -> Assert {
    cargo_bin_cmd!("iiwasim").current_dir(folder).arg("plan").arg(program).args(arguments).assert()
}

/// Returns the JSON output of a successful command.
#[expect(clippy::unwrap_used, reason = "a test fails by it")]
pub(crate) fn figures(assert: Assert) -> serde_json::Value {
    serde_json::from_slice(&assert.success().get_output().stdout).unwrap()
}

/// Returns the cycle time of a program, as planned in a folder.
#[expect(clippy::unwrap_used, reason = "a test fails by it")]
pub(crate) fn cycle_time(folder: &TempDir, program: &str) -> f64 {
    let planned = figures(plan(folder, Path::new(program), &["--no-output", "--json"]));
    planned["cycle_time_s"].as_f64().unwrap()
}

pub(crate) fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../fixtures").join(name)
}

pub(crate) const START: &str = r#""start": { "joints_deg": [0, 0, 0, 0, 0, 0, 0] }"#;

pub(crate) fn program(motions: &str) -> String {
    format!("{{\n  \"version\": 1,\n  {START},\n  \"motions\": [\n    {motions}\n  ]\n}}\n")
}

/// Returns a program with `count` motions back and forth, all blended.
pub(crate) fn long_program(count: usize) -> String {
    let motion = |i: usize| {
        let a = if i.is_multiple_of(2) { 10 } else { -10 };
        let blend = if i + 1 < count { r#", "blend": { "fraction": 0.25 }"# } else { "" };
        format!(r#"{{ "type": "ptp", "joints_deg": [{a}, {}, 0, -60, 0, 90, 0]{blend} }}"#, i % 7)
    };
    program(&(0..count).map(motion).collect::<Vec<_>>().join(",\n"))
}
