//! Tells the program which commit it is built from.

use std::{env, path::Path, process::Command};

fn main() {
    // Distributors who build without the repository may name it.
    println!("cargo::rerun-if-env-changed=IIWASIM_COMMIT");
    let commit = env::var("IIWASIM_COMMIT").ok().or_else(commit);
    let build = commit.map_or_else(String::new, |commit| format!(" ({commit})"));
    println!("cargo::rustc-env=IIWASIM_BUILD={build}");
}

/// The commit of the repository that contains this crate, and whether files differ from it.
fn commit() -> Option<String> {
    let git = |arguments: &[&str]| {
        let output = Command::new("git").args(arguments).output().ok()?;
        let text = String::from_utf8(output.stdout).ok()?;
        output.status.success().then(|| text.trim().to_owned())
    };
    // Unpacked in another repository, this package has nothing to do with that one's commits.
    if !Path::new("../.ci").exists() {
        return None;
    }
    let log = git(&["rev-parse", "--git-path", "logs/HEAD"])?;
    println!("cargo::rerun-if-changed={log}");
    println!("cargo::rerun-if-changed=build.rs");
    git(&["rev-parse", "--short=9", "HEAD"])
}
