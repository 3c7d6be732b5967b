//! `iiwasim place`.

use iiwa_optimise::{Place, PlaceGrid};
use iiwa_report::{PlaceReport, draw_places};
use iiwa_traj::Trajectory;

use super::{PathRule, SearchedProgram};
use crate::{args::PlaceRobot, failure::Failure, output, output_kind::OutputKind, picture};

/// Prints the cycle times with the robot at other places, and writes the program for the best one.
pub(crate) fn run(options: &PlaceRobot) -> Result<(), Failure> {
    if !options.with_robot.is_empty() && options.around.scene.is_none() {
        return Err(Failure::input("--with-robot needs a scene: --scene SCENE.json"));
    }
    let scene = options.around.scene.as_deref().map(|path| ("scene", path));
    let inputs = [("program", options.input.program.as_path())].into_iter().chain(scene);
    options.found.check(inputs.clone())?;
    let grid = grid(options)?;
    if let Some(picture) = &options.picture {
        let kind = OutputKind::Picture(picture::format(picture)?);
        let written =
            options.found.output.as_deref().map(|path| ("program at the best place", path));
        output::keep_others(kind, picture, inputs.chain(written), "--picture")?;
        // A picture that cannot be written is an error before the search.
        drop(picture::output(picture)?);
        let [x, y, _] = &grid.shifts_m;
        if x.len() * y.len() == 1 {
            return Err(Failure::input(
                "--picture: a map needs several places; give a range with --x or --y",
            ));
        }
    }
    SearchedProgram::read(&options.input, |search| {
        search.in_scene(&options.around, |search| finish(options, &grid, search))
    })
}

/// Returns the grid of the options.
fn grid(options: &PlaceRobot) -> Result<PlaceGrid, Failure> {
    const MOST: usize = PlaceGrid::MOST_PLACES;

    let PlaceRobot { x, y, z, yaw, steps, .. } = options;
    let shifts_m = [x, y, z].map(|range| range.values(*steps, 1e-3));
    let grid = PlaceGrid { shifts_m, yaws_rad: yaw.values(*steps, 1_f64.to_radians()) };
    match grid.count() {
        1..=MOST => Ok(grid),
        count => Err(Failure::input(format!(
            "--steps: the grid has {count} places, and at most {MOST} are supported; give fewer \
             steps, or one value for --z or --yaw"
        ))),
    }
}

fn finish(
    options: &PlaceRobot,
    grid: &PlaceGrid,
    search: SearchedProgram<'_>,
) -> Result<(), Failure> {
    let program = &search.plan.program;
    if grid.turns_gravity(&program.workcell.mount) {
        return Err(Failure::input(
            "--yaw: the robot is not mounted upright or hanging, so that gravity turns with its \
             base; leave --yaw out, and state the other mounting in the program",
        ));
    }
    let with_robot = match search.scene {
        Some(scene) => scene.indices_of(&options.with_robot),
        None => Ok(Vec::new()),
    };
    let with_robot =
        with_robot.map_err(|error| Failure::input(format!("--with-robot: {error}")))?;
    let clearances = search.clearances;
    let keeps = |place: &Place, trajectory: &Trajectory| {
        clearances.is_none_or(|it| it.allow_elsewhere(&place.cell(), &with_robot, trajectory))
    };
    let optimiser = &search.optimiser;
    let map = search.run(|| match clearances {
        Some(_) => optimiser.place_within(program, grid, &keeps),
        None => optimiser.place(program, grid),
    })?;
    let report = PlaceReport::new(&map, grid, program.joint_targets(), clearances.is_some());
    let found = (&map.program, map.changed_cycle_time_s());
    // The program that is written has to keep the clearances at its place.
    let place = map.best.map(|best| best.place).unwrap_or_default();
    let keeps = |trajectory: &Trajectory| keeps(&place, trajectory);
    let rule: Option<PathRule<'_>> = if clearances.is_some() { Some(&keeps) } else { None };
    let mut search = search;
    search.rule = rule;
    search.finish(&options.found, found, &report, PlaceReport::text)?;
    if let Some(file) = &options.picture {
        output::write(file, &picture::content(file, draw_places(&report)?)?)?;
    }
    Ok(())
}
