//! Durations of random LINs compared with a single trapezoid.

use iiwa_path::{JointPath, Step};
use iiwa_program::{ByKind, Motion, ToolLimits};
use iiwa_traj::{SweepOptions, Timing, Trajectory};
use iiwasim_benches::Result;
use iiwasim_tests::tcp_programs::single_path;
use rayon::prelude::*;

use super::{
    clock::quantile,
    rival::{PILZ_ACCELERATION_M_S2, PILZ_SPEED_M_S, PILZ_TURN_RAD_S, RIVALS, durations_s},
    straight::Straight,
};

const SEED: u64 = 1;
/// Required median ratio of the duration of Pilz' motion with its default limits to the planner's.
const MIN_ADVANTAGE: f64 = 1.25;
/// Largest deviation between both joint paths, in rad.
const SAME_PATH_RAD: f64 = 1e-6;
/// Smallest accepted ratio: the best trapezoid obeys the same limits on the same path, so it cannot
/// be faster than the time-optimal motion, except for violations between its samples.
const MIN_RATIO: f64 = 0.995;

/// Length above which LINs have additional rows, in m: short LINs are nearly straight in joint
/// space, where a trapezoid is optimal.
const LONG_M: f64 = 0.3;

/// LIN with the durations of its rivals relative to the planner's.
struct Compared {
    way_m: f64,
    ratios: [f64; 3],
}

/// Prints ratios for the first feasible LINs of a seed; returns true if the planner is as far ahead
/// as required.
pub(crate) fn print(lines: u64) -> Result<bool> {
    println!("### against one trapezoid\n");
    println!(
        "The peer: TCP and orientation go by one s(t) from 0 to 1, the position straight, the \
         orientation about one fixed axis, A3 evenly, as the LIN does. ds/dt is a symmetric \
         trapezoid from rest to rest. Joints come by inverse kinematics at 1 kHz; differences of \
         them, with the arm at rest before and after, have to keep each joint's velocity and \
         acceleration. Best: the fastest of all trapezoids that do (over both s'max and s''max). \
         One factor: {PILZ_SPEED_M_S} m/s, {PILZ_ACCELERATION_M_S2} m/s^2 and {PILZ_TURN_RAD_S} \
         rad/s of the TCP (defaults of Pilz), speed and acceleration times the same factor, the \
         largest; or the largest up to 1.\n"
    );
    let compared = (0..lines)
        .into_par_iter()
        .map(|index| compare(index).map_err(|error| error.to_string()))
        .filter_map(std::result::Result::transpose)
        .collect::<std::result::Result<Vec<_>, String>>()?;
    println!(
        "{} of {lines} random LINs (the others are refused); their duration over that of the \
         planner, acceleration limits:\n",
        compared.len()
    );
    println!("| | least | quartile | median | quartile | most |");
    println!("|---|---:|---:|---:|---:|---:|");
    let mut rows = Vec::new();
    for (from, least_m) in [("", 0.0), (", 300 mm and more", LONG_M)] {
        for (i, rival) in RIVALS.iter().enumerate() {
            let lines = compared.iter().filter(|line| line.way_m >= least_m);
            let mut ratios: Vec<f64> = lines.map(|line| line.ratios[i]).collect();
            if ratios.is_empty() {
                return Err("none of the LINs can be done".into());
            }
            ratios.sort_by(f64::total_cmp);
            let quantiles = [0, 25, 50, 75, 100].map(|percent| quantile(&ratios, percent));
            let cells = quantiles.map(|ratio| format!("{ratio:.3}")).join(" | ");
            println!("| {rival}{from} ({}) | {cells} |", ratios.len());
            rows.push(quantiles);
        }
    }
    let (lowest, median) = (rows[0][0], rows[2][2]);
    println!(
        "\nRequired: {MIN_ADVANTAGE} in the median with one factor up to 1; {MIN_RATIO} at least \
         with the best, which keeps the same limits on the same path."
    );
    Ok(median >= MIN_ADVANTAGE && lowest >= MIN_RATIO)
}

/// Compares a LIN of the seed; `None` if it is infeasible.
fn compare(index: u64) -> Result<Option<Compared>> {
    let (robot, mut program) = single_path(SEED, index, false);
    let Some(Motion::Cartesian(motion)) = program.motions.first_mut() else {
        return Err("no LIN".into());
    };
    motion.shares = ByKind::from_fn(|_| [1.0; 7]);
    motion.tool_limits = ToolLimits::NONE;
    let tcp = program.workcell.tcp(motion_tool(&program.motions))?;
    let Ok(path) = JointPath::new(&program, &robot) else { return Ok(None) };
    let segment = path.steps().iter().find_map(|step| match step {
        Step::Move { segment, .. } => Some(segment),
        _ => None,
    });
    let segment = segment.ok_or("a LIN that does not move")?;
    let line = Straight::new(&robot, &tcp, path.start_rad(), &segment.at(1.0).q);
    for i in 0..=10 {
        let s = f64::from(i) / 10.0;
        let (q, ours) = (line.joints(s)?, segment.at(s).q);
        let off_rad = q.iter().zip(&ours).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        if off_rad > SAME_PATH_RAD {
            return Err(format!("LIN {index}: at s = {s} it is {off_rad:.1e} rad off").into());
        }
    }
    let timing = Timing::Acceleration(SweepOptions::default());
    let ours_s = Trajectory::plan(&path, timing)?.motion_time_s();
    let [way_m, _] = line.way();
    let ratios = durations_s(&line, &robot)?.map(|rival_s| rival_s / ours_s);
    Ok(Some(Compared { way_m, ratios }))
}

/// Returns the tool of a program's only motion.
fn motion_tool(motions: &[Motion]) -> Option<&str> {
    match motions {
        [Motion::Cartesian(motion)] => motion.tool.as_deref(),
        _ => None,
    }
}
