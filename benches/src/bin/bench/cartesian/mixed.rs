//! Ten blended motions of all kinds.

use iiwa_kin::Robot;
use iiwa_path::JointPath;
use iiwa_program::Program;
use iiwa_traj::{SweepOptions, Timing, Trajectory};
use iiwasim_benches::Result;

use super::clock::fastest_s;

const PROGRAM: &str = include_str!("mixed.json");

/// Prints the planning time of the ten motions, and their cycle time.
pub(crate) fn print() -> Result<()> {
    let (program, robot) = (Program::from_json(PROGRAM)?, Robot::lbr_iiwa_7_r800());
    let path_s = fastest_s(|| Ok(JointPath::new(&program, &robot)?))?;
    let path = JointPath::new(&program, &robot)?;
    let moves = path.steps().iter().filter(|step| step.moves()).count();
    println!("### ten mixed motions\n");
    println!(
        "`benches/src/bin/bench/cartesian/mixed.json`: {} motions to frames and joints, LIN, CIRC, \
         spline; a tool, a base, {} blends, {moves} segments.\n",
        program.motions.len(),
        path.blends().count(),
    );
    println!("| | time | of it the path | time in motion | target |");
    println!("|---|---:|---:|---:|---:|");
    let timings =
        [(Timing::Acceleration(SweepOptions::default()), ""), (Timing::jerk_limited(), "15 ms")];
    for (timing, target) in timings {
        let whole_s = fastest_s(|| {
            let path = JointPath::new(&program, &robot)?;
            Ok(Trajectory::plan(&path, timing)?)
        })?;
        let motion_s = Trajectory::plan(&path, timing)?.motion_time_s();
        println!(
            "| path and plan, {} | {:.2} ms | {:.2} ms | {motion_s:.3} s | {target} |",
            timing.name(),
            1e3 * whole_s,
            1e3 * path_s,
        );
    }
    Ok(())
}
