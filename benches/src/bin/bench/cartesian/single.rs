//! Single motion, from its program to its path and its plan.

use iiwa_path::JointPath;
use iiwa_traj::{SweepOptions, Timing, Trajectory};
use iiwasim_benches::Result;
use iiwasim_tests::cartesian_cases::{CartesianCase, cartesian_cases};

use super::clock::{fastest_s, quantile};

/// Prints the times of the reference paths.
pub(crate) fn print() -> Result<()> {
    let cases = cartesian_cases();
    println!("### one motion\n");
    println!(
        "LIN and CIRC, the {} of `fixtures/reference/cartesian.json`, each the fastest of many \
         runs.\n",
        cases.len()
    );
    println!("| | median | worst | which | target | over it |");
    println!("|---|---:|---:|---|---:|---:|");
    row("path to 1e-9 rad", &cases, 100.0, 1e6, "us", Ok)?;
    let sweep = Timing::Acceleration(SweepOptions::default());
    row("path and plan, acceleration", &cases, 1.0, 1e3, "ms", |path| plan(&path, sweep))?;
    let jerk = Timing::jerk_limited();
    row("path and plan, jerk", &cases, 1.0, 1e3, "ms", |path| plan(&path, jerk))
}

fn plan(path: &JointPath, timing: Timing) -> Result<Trajectory> {
    Ok(Trajectory::plan(path, timing)?)
}

fn row<T>(
    label: &str,
    cases: &[CartesianCase],
    target: f64,
    per_s: f64,
    unit: &str,
    work: impl Fn(JointPath) -> Result<T>,
) -> Result<()> {
    let mut times = Vec::new();
    for case in cases {
        let time_s = fastest_s(|| work(JointPath::new(&case.program, &case.robot)?))
            .map_err(|error| format!("{label}, {}: {error}", case.id))?;
        times.push((time_s, case.id.as_str()));
    }
    times.sort_by(|a, b| a.0.total_cmp(&b.0));
    let sorted: Vec<f64> = times.iter().map(|(time_s, _)| *time_s).collect();
    let median = per_s * quantile(&sorted, 50);
    if let Some((worst_s, id)) = times.last() {
        let worst = per_s * worst_s;
        let over = sorted.iter().filter(|&&time_s| per_s * time_s > target).count();
        println!(
            "| {label} | {median:.3} {unit} | {worst:.3} {unit} | {id} | {target} {unit} | {over} \
             of {} |",
            sorted.len()
        );
    }
    Ok(())
}
