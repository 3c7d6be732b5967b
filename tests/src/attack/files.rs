//! Open files: the attackers need more of them than a login usually has.

use std::{env, fs, os::unix::process::CommandExt, process::Command};

/// Connections of all attackers together, and files.
const NEEDED: u64 = 16_000;

/// Set for the program that has got what there is.
const RAISED: &str = "IIWASIM_ATTACK_FILES_RAISED";

/// Starts this program anew with more open files, where it has too few; returns where it goes on as it
/// is.
pub(super) fn raise_limit() {
    let Some([soft, hard]) = limits() else { return };
    let Ok(program) = env::current_exe() else { return };
    if soft >= NEEDED || env::var_os(RAISED).is_some() {
        return;
    }
    let files = hard.min(NEEDED);
    let mut shell = Command::new("sh");
    shell
        .arg("-c")
        .arg(format!("ulimit -Sn {files}; exec \"$0\" \"$@\""))
        .arg(program)
        .args(env::args_os().skip(1))
        .env(RAISED, "1");
    // It returns only if it fails.
    let error = shell.exec();
    super::tell::tell(&format!("too few open files, {soft}: {error}"));
}

/// Soft and hard, where the system tells them.
fn limits() -> Option<[u64; 2]> {
    let text = fs::read_to_string("/proc/self/limits").ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix("Max open files"))?;
    let mut numbers = line.split_whitespace().map(|word| word.parse().unwrap_or(u64::MAX));
    Some([numbers.next()?, numbers.next()?])
}
