//! Limit of open files: attackers need more than the usual limit of a login.

use std::{env, fs, os::unix::process::CommandExt, process::Command};

use super::output::print;

/// Number of files needed for the connections of all attackers, and other files.
const NEEDED: u64 = 16_000;

/// Variable that marks the restarted program.
const RAISED: &str = "IIWASIM_ATTACK_FILES_RAISED";

/// Restarts this program with a higher limit if necessary and possible; otherwise returns.
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
    // `exec` returns only if it fails.
    let error = shell.exec();
    print(&format!("too few open files, {soft}: {error}"));
}

/// Returns soft and hard limit, if the system provides them.
fn limits() -> Option<[u64; 2]> {
    let text = fs::read_to_string("/proc/self/limits").ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix("Max open files"))?;
    let mut numbers = line.split_whitespace().map(|word| word.parse().unwrap_or(u64::MAX));
    Some([numbers.next()?, numbers.next()?])
}
