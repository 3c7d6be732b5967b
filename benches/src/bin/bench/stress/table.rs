//! Pieces of one program, and their limit ratios.

use iiwa_kin::Robot;
use iiwa_path::JointPath;
use iiwa_program::Program;
use iiwa_traj::{SweepOptions, Timing, Trajectory};
use iiwasim_benches::Result;
use iiwasim_tests::extremes::{Extremes, Peak, extremes, piece_extremes};

/// Prints a table of the pieces with either time parameterisation.
pub(crate) fn print_table(program: &Program) -> Result<()> {
    let path = JointPath::new(program, &Robot::default())?;
    for timing in [Timing::Acceleration(SweepOptions::default()), Timing::default()] {
        let trajectory = match Trajectory::plan(&path, timing) {
            Ok(trajectory) => trajectory,
            Err(error) => {
                println!("{}: {error}\n", timing.name());
                continue;
            }
        };
        let worst = extremes(&trajectory, timing);
        println!(
            "{}: {:.6} s in motion; velocity jumps by {:.1e}, acceleration by {:.1e}, backwards at \
             {:.1e}",
            timing.name(),
            trajectory.motion_time_s(),
            worst.jumps[0],
            worst.jumps[1],
            worst.backwards
        );
        println!(
            "{:>6} {:>6} {:>6} {:>12} {:>12} {:>5}  {:<34} {:<34} {:<34}",
            "step",
            "motion",
            "kind",
            "start s",
            "takes s",
            "nodes",
            "velocity",
            "acceleration",
            "jerk"
        );
        let mut step = 0;
        for section in trajectory.sections() {
            for piece in section.pieces() {
                let nodes = section.nodes(piece);
                let extremes =
                    piece_extremes(&trajectory, section, piece, timing, &Extremes::default());
                let [velocity, acceleration, jerk] = shown(&extremes);
                println!(
                    "{step:>6} {:>6} {:>6} {:>12.6} {:>12.3e} {:>5}  {velocity:<34} \
                     {acceleration:<34} {jerk:<34}",
                    piece.motion.to_string(),
                    piece.kind.name(),
                    piece.start_s,
                    piece.duration_s,
                    nodes.len()
                );
                step += 1;
            }
        }
        println!();
    }
    println!(
        "ratio (~ where rounding shows), joint @ node + share of the interval after it, p, length \
         of the interval in s"
    );
    Ok(())
}

fn shown(extremes: &Extremes) -> [String; 3] {
    std::array::from_fn(|kind| {
        let peak = extremes.peaks()[kind];
        let Some(joint) = peak.joint else { return "-".to_owned() };
        let Peak { ratio, node, share, p, interval_s, .. } = peak;
        let mark = if peak == extremes.blurred[kind] { "~" } else { "" };
        format!("{mark}{ratio:.4} {joint} @{node}+{share:.2} {p:.5} {interval_s:.0e}")
    })
}
