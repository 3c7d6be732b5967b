//! Runs of the command in a folder, and the resulting files.

#![expect(clippy::unwrap_used, reason = "a failed test panics")]

use std::fs;

use assert_cmd::{assert::Assert, cargo::cargo_bin_cmd};
use tempfile::TempDir;

pub(crate) fn iiwasim(folder: &TempDir, arguments: &[&str]) -> Assert {
    let mut command = cargo_bin_cmd!("iiwasim");
    // The width of tables.
    command.env_remove("COLUMNS");
    command.current_dir(folder).args(arguments).assert()
}

pub(crate) fn files(folder: &TempDir) -> Vec<String> {
    let names = fs::read_dir(folder).unwrap();
    let mut names: Vec<_> =
        names.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}
