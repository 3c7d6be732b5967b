//! Pipes as input files.

#![cfg(target_os = "linux")]

use std::{
    fs,
    path::Path,
    process::{Command, Stdio},
    thread,
    time::Duration,
};

use assert_cmd::{
    assert::Assert,
    cargo::{cargo_bin, cargo_bin_cmd},
};
use predicates::str::contains;
use tempfile::{TempDir, tempdir};

use crate::helpers::fixture;
use crate::run::iiwasim;

/// Runs a command whose standard input is a pipe with this content.
fn piped(folder: &TempDir, arguments: &[&str], content: &[u8]) -> Assert {
    let mut command = cargo_bin_cmd!("iiwasim");
    command.current_dir(folder.path()).args(arguments).write_stdin(content).assert()
}

#[test]
fn a_pipe_is_read_like_a_file() {
    let folder = tempdir().unwrap();
    let program = fixture("appendix-b.json");
    let text = fs::read(&program).unwrap();
    piped(&folder, &["plan", "/dev/stdin", "-o", "stdin"], &text).success();
    let plan = fs::read(folder.path().join("stdin")).unwrap();
    piped(&folder, &["report", "/dev/stdin", "-o", "a.html"], &plan).success();
    iiwasim(&folder, &["report", "stdin", "-o", "b.html"]).success();
    let page = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
    assert_eq!(page("a.html"), page("b.html"));
    for files in [["/dev/stdin", "stdin"], ["stdin", "/dev/stdin"]] {
        piped(&folder, &[&["compare"], &files[..]].concat(), &plan)
            .success()
            .stdout(contains("planned, 8.927 s measured"));
    }
    let planned = ["plan", program.to_str().unwrap(), "--no-output"];
    let profile = br#"{ "version": 1, "name": "from a pipe" }"#;
    piped(&folder, &[&planned[..], &["--robot", "/dev/stdin"]].concat(), profile)
        .success()
        .stdout(contains("Planned for from a pipe"));
    piped(&folder, &[&planned[..], &["--robot", "/dev/stdin"]].concat(), b"")
        .code(2)
        .stderr(contains("/dev/stdin, line 1"));
}

#[test]
fn devices_are_refused() {
    let folder = tempdir().unwrap();
    let program = fixture("appendix-b.json");
    let planned = ["plan", program.to_str().unwrap(), "--no-output", "--scene", "/dev/zero"];
    for command in [&["plan", "/dev/zero"][..], &["report", "/dev/zero"], &planned] {
        iiwasim(&folder, command).code(2).stderr(contains("it is a device or a socket"));
    }
}

/// Returns true if a process has opened a file.
fn has_opened(process: &str, file: &Path) -> bool {
    let opened = fs::read_dir(format!("/proc/{process}/fd")).into_iter().flatten().flatten();
    opened.map(|entry| fs::read_link(entry.path())).any(|path| path.is_ok_and(|path| path == file))
}

/// A termination signal ends the wait for a missing writer.
#[test]
fn a_named_pipe_without_a_writer_can_be_interrupted() {
    let folder = tempdir().unwrap();
    assert!(Command::new("mkfifo").arg(folder.path().join("pipe")).status().unwrap().success());
    let mut waiting = Command::new(cargo_bin!("iiwasim"))
        .current_dir(folder.path())
        .args(["report", "pipe"])
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let id = waiting.id().to_string();
    let pipe = folder.path().canonicalize().unwrap().join("pipe");
    for _ in 0..6000 {
        if has_opened(&id, &pipe) {
            break;
        }
        thread::sleep(Duration::from_millis(10));
    }
    assert!(Command::new("kill").args(["-TERM", &id]).status().unwrap().success());
    // No code: the signal ended the process.
    assert_eq!(waiting.wait().unwrap().code(), Some(1));
}
