//! Prints the time on one core of searches for faster programs, and what they find, as a Markdown
//! table.

use std::{process::ExitCode, time::Instant};

use super::no_arguments::no_arguments;
use iiwa_kin::Robot;
use iiwa_optimise::{Freedom, Optimiser, PlaceGrid};
use iiwa_plan::PlanOptions;
use iiwa_program::Program;
use iiwasim_benches::{Result, machine};
use rayon::ThreadPoolBuilder;

const PALLETISING: (&str, &str) =
    ("Palletising", include_str!("../../../../fixtures/sunrise/cell/expected.json"));
const PACK_A_BOX: (&str, &str) =
    ("pack-a-box", include_str!("../../../../fixtures/production/pack-a-box.json"));
const PICK_AND_PLACE: (&str, &str) =
    ("pick-and-place", include_str!("../../../../fixtures/pick-and-place.json"));
const SCREWS: (&str, &str) = ("screws", include_str!("../../../../fixtures/screws.json"));

/// Number of places along x, y and z.
const STEPS: usize = 10;
/// Largest shift along x, y and z, in m.
const SHIFTS_M: [f64; 3] = [0.09, 0.09, 0.045];

/// Result of a search.
struct Found {
    plans: u64,
    before_s: f64,
    after_s: f64,
    /// Lower bound of the cycle time, in s, if it is known.
    bound_s: Option<f64>,
}

pub(crate) fn run(arguments: &[&str]) -> Result<ExitCode> {
    no_arguments(arguments)?;
    println!("On {}, {}; one thread.\n", machine::processor(), machine::instruction_level());
    println!("| search | program | plans | time s | before s | after s | lower bound s |");
    println!("|---|---|---:|---:|---:|---:|---:|");
    let blends = Freedom { speeds: false, ..Freedom::MOTIONS };
    for program in [PACK_A_BOX, PALLETISING] {
        row("E1", program, |optimiser, program| changes(optimiser, program, Freedom::ELBOWS))?;
    }
    row("E1 and blends", PALLETISING, |optimiser, program| changes(optimiser, program, blends))?;
    for program in [PICK_AND_PLACE, PALLETISING] {
        row("1000 places", program, places)?;
    }
    row("order of 8 tasks", SCREWS, order)?;
    Ok(ExitCode::SUCCESS)
}

/// Runs a search on one core, and prints its row.
fn row(
    search: &str,
    (name, text): (&str, &str),
    work: impl FnOnce(&Optimiser, &Program) -> Result<Found> + Send,
) -> Result<()> {
    let program = Program::from_json(text)?;
    let robot = program.with_flange(Robot::default());
    let optimiser = Optimiser::new(robot, PlanOptions::default());
    let pool = ThreadPoolBuilder::new().num_threads(1).build()?;
    let start = Instant::now();
    let found = pool.install(|| work(&optimiser, &program).map_err(|error| error.to_string()))?;
    let time_s = start.elapsed().as_secs_f64();
    let Found { plans, before_s, after_s, bound_s } = found;
    let bound = bound_s.map_or_else(|| "-".to_owned(), |bound_s| format!("{bound_s:.3}"));
    println!(
        "| {search} | {name} | {plans} | {time_s:.2} | {before_s:.3} | {after_s:.3} | {bound} |"
    );
    Ok(())
}

fn changes(optimiser: &Optimiser, program: &Program, freedom: Freedom) -> Result<Found> {
    let found = optimiser.clone().with_freedom(freedom).optimise(program)?;
    Ok(Found {
        plans: found.plans,
        before_s: found.cycle_time_s,
        after_s: found.changed_cycle_time_s,
        bound_s: found.lower_bound.map(|bound| bound.cycle_time_s),
    })
}

fn places(optimiser: &Optimiser, program: &Program) -> Result<Found> {
    let shifts_m = SHIFTS_M.map(|most_m| PlaceGrid::axis([-most_m, most_m], STEPS));
    let map = optimiser.place(program, &PlaceGrid { shifts_m, yaws_rad: vec![0.0] })?;
    Ok(Found {
        plans: map.plans,
        before_s: map.cycle_time_s,
        after_s: map.changed_cycle_time_s(),
        bound_s: None,
    })
}

fn order(optimiser: &Optimiser, program: &Program) -> Result<Found> {
    let found = optimiser.order(program)?;
    Ok(Found {
        plans: found.plans,
        before_s: found.cycle_time_s,
        after_s: found.changed_cycle_time_s,
        bound_s: None,
    })
}
