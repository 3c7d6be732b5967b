//! Benches that need whole runs: `bench NAME`, with the arguments of the module of that name.
//!
//! They share one executable since separate ones would take half a minute each to optimise.
#![expect(clippy::print_stdout, reason = "tables are what it is for")]

mod batch;
mod cartesian;
mod import;
mod no_arguments;
mod optimise;
#[cfg(feature = "peers")]
mod realtime;
mod recording;
mod replan;
#[cfg(feature = "peers")]
mod report;
mod scale;
mod stress;

use std::{env, process::ExitCode};

use iiwasim_benches::Result;

type Bench = fn(&[&str]) -> Result<ExitCode>;

const BENCHES: &[(&str, Bench)] = &[
    ("batch", batch::run),
    ("cartesian", cartesian::run),
    ("import", import::run),
    ("optimise", optimise::run),
    #[cfg(feature = "peers")]
    ("realtime", realtime::run),
    ("recording", recording::run),
    ("replan", replan::run),
    #[cfg(feature = "peers")]
    ("report", report::run),
    ("scale", scale::run),
    ("stress", stress::run),
];

fn main() -> Result<ExitCode> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let names: Vec<_> = BENCHES.iter().map(|(name, _)| *name).collect();
    let mut known = names.join(", ");
    if cfg!(not(feature = "peers")) {
        known.push_str("; with the feature `peers` realtime and report, too");
    }
    let (name, rest) = words.split_first().ok_or_else(|| format!("name a bench: {known}"))?;
    let bench = BENCHES.iter().find(|(bench, _)| bench == name);
    let (_, run) = bench.ok_or_else(|| format!("there is no bench {name}, but {known}"))?;
    run(rest)
}
