//! `iiwasim place`.

use iiwa_optimise::PlaceGrid;
use iiwa_report::{PlaceReport, draw_places};

use crate::{
    args::PlaceRobot, failure::Failure, output, output_kind::OutputKind, picture,
    search::SearchedProgram,
};

/// Prints the cycle times with the robot at other places, and writes the program for the best one.
pub(crate) fn run(options: &PlaceRobot) -> Result<(), Failure> {
    let read = ("program", options.input.program.as_path());
    options.found.check([read])?;
    let grid = grid(options)?;
    if let Some(picture) = &options.picture {
        let kind = OutputKind::Picture(picture::format(picture)?);
        let written =
            options.found.output.as_deref().map(|path| ("program at the best place", path));
        output::keep_others(kind, picture, [read].into_iter().chain(written), "--picture")?;
        // A picture that cannot be written is an error before the search.
        drop(picture::output(picture)?);
        let [x, y, _] = &grid.shifts_m;
        if x.len() * y.len() == 1 {
            return Err(Failure::input(
                "--picture: a map needs several places; give a range with --x or --y",
            ));
        }
    }
    SearchedProgram::read(&options.input, |search| finish(options, &grid, &search))
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
    search: &SearchedProgram<'_>,
) -> Result<(), Failure> {
    let program = &search.plan.program;
    if grid.turns_gravity(&program.workcell.mount) {
        return Err(Failure::input(
            "--yaw: the robot is not mounted upright or hanging, so that gravity turns with its \
             base; leave --yaw out, and state the other mounting in the program",
        ));
    }
    let map = search.run(|| search.optimiser.place(program, grid))?;
    let report = PlaceReport::new(&map, grid, program.joint_targets());
    let found = (&map.program, map.changed_cycle_time_s());
    search.finish(&options.found, found, &report, PlaceReport::text)?;
    if let Some(file) = &options.picture {
        output::write(file, &picture::content(file, draw_places(&report)?)?)?;
    }
    Ok(())
}
