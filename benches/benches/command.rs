//! Whole command `iiwasim plan` on ten motions: from the start of the process to the finished MCAP
//! file.
//!
//! The executable is named by the environment variable `IIWASIM`; by default it is that of `cargo
//! build --release` beside the bench.
#![expect(clippy::print_stderr, reason = "where a bench says that it cannot run")]

use std::{
    env, fs,
    path::{Path, PathBuf},
    process::{Command, Stdio},
};

use criterion::{Criterion, criterion_group, criterion_main};
use iiwasim_benches::{Result, reference};

const TEN_MOTIONS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../fixtures/ten-motions.json");

fn command(criterion: &mut Criterion) {
    if let Err(error) = run(criterion) {
        eprintln!("no figures for `iiwasim plan`: {error}");
    }
}

fn run(criterion: &mut Criterion) -> Result<()> {
    let iiwasim = binary()?;
    let folder = tempfile::tempdir()?;
    let program = folder.path().join("program.json");
    if Path::new(TEN_MOTIONS).is_file() {
        fs::copy(TEN_MOTIONS, &program)?;
    } else {
        fs::write(&program, reference::ten_motions()?)?;
    }
    let output = folder.path().join("program.mcap");
    let plan = || {
        let mut plan = Command::new(&iiwasim);
        plan.arg("plan").arg(&program).arg("-o").arg(&output);
        plan.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        plan
    };

    let first = plan().stderr(Stdio::piped()).output()?;
    if !first.status.success() {
        let says = String::from_utf8_lossy(&first.stderr).into_owned();
        return Err(format!("{} plan: {}\n{says}", iiwasim.display(), first.status).into());
    }
    if fs::metadata(&output).map_or(0, |file| file.len()) == 0 {
        return Err(format!("{} plan wrote no MCAP", iiwasim.display()).into());
    }

    let mut group = criterion.benchmark_group("command");
    group.bench_function("iiwasim plan", |bencher| bencher.iter(|| plan().status()));
    group.bench_function("iiwasim --version", |bencher| {
        bencher.iter(|| Command::new(&iiwasim).arg("--version").stdout(Stdio::null()).status());
    });
    group.finish();
    Ok(())
}

/// Returns the path of the measured executable.
fn binary() -> Result<PathBuf> {
    if let Some(path) = env::var_os("IIWASIM") {
        return Ok(path.into());
    }
    let bench = env::current_exe()?;
    // target/release/deps/command-..., with target/release/iiwasim beside it.
    let path = bench.ancestors().nth(2).unwrap_or(&bench).join("iiwasim");
    if !path.is_file() {
        let missing = path.display();
        return Err(format!(
            "{missing} is missing: run `cargo build --release`, or name it in IIWASIM"
        )
        .into());
    }
    Ok(path)
}

criterion_group!(benches, command);
criterion_main!(benches);
