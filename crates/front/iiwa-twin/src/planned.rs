//! Planned program and its files.

use std::{fs, path::PathBuf};

use iiwa_files::Output;
use iiwa_kin::Joints;
use iiwa_link::message::RunLabel;
use iiwa_log::{PlanConfig, PlanSize, write_plan};
use iiwa_page::{Extent, NearestPlaces};
use iiwa_plan::{PlanRequest, ProgramSource};
use iiwa_program::{MotionList, Program};
use iiwa_report::{carried, long_duration};
use iiwa_scene::CarriedBodies;
use iiwa_traj::Trajectory;
use serde::Serialize;

use crate::{
    Setup, TwinError,
    message::{PageMessage, page_message},
    runs::label,
    setup::file_stem,
};

/// Plan and its files.
#[derive(Debug)]
pub(crate) struct PlanFiles {
    /// Unique id, so that a page can only run the plan that it shows.
    pub(crate) id: u64,
    /// Motions to send to the robot.
    pub(crate) motions: MotionList,
    pub(crate) label: RunLabel,
    pub(crate) start_rad: Joints,
    pub(crate) text: String,
    /// Name of the files, without an extension.
    pub(crate) stem: String,
    pub(crate) mcap: PathBuf,
    /// Reason why the plan must not be run, if any.
    pub(crate) refused: Option<String>,
    pub(crate) message: PageMessage,
}

impl PlanFiles {
    /// Plans a program. Errors are shown on the page, with the place of the fault in the text.
    pub(crate) fn new(id: u64, name: &str, text: String, setup: &Setup) -> Result<Self, String> {
        let words = |error: TwinError| setup.words(&error);
        let to_error = |error| {
            let (name, text, error) = (name.to_owned(), text.clone(), Box::new(error));
            words(TwinError::Program { name, text, error })
        };
        let source = ProgramSource::from_json(&text).map_err(to_error)?;
        let program = &source.program;
        let motions = program.motions.len();
        if motions > MAX_MOTIONS {
            return Err(format!(
                "{name} has {motions} motions; the twin plans up to {MAX_MOTIONS}. iiwasim plan \
                 and iiwasim run have no such limit"
            ));
        }
        let robot_names = [setup.robot.name(), &setup.robot_name];
        if let Some(other) = program.robot.as_deref().filter(|other| !robot_names.contains(other)) {
            return Err(format!(
                "{name} is a program for the robot `{other}`; the twin was started for `{}`",
                robot_names[0]
            ));
        }
        let flange_m = setup.robot.lengths().flange_m;
        if let Some(other_m) = program.workcell.flange_m.filter(|other_m| *other_m != flange_m) {
            return Err(format!(
                "{name} is a program for a flange of {:.0} mm; the twin was started with one of \
                 {:.0} mm",
                1e3 * other_m,
                1e3 * flange_m
            ));
        }
        let request = PlanRequest { robot: Some(setup.robot.clone()), ..PlanRequest::default() };
        let plan = request.plan(&source).map_err(to_error)?;
        let trajectory = &plan.trajectory;
        check_size(trajectory)?;
        // As in `iiwasim plan`, the meshes have to be solid only if they are checked.
        let carried = if setup.has_scene() {
            carried(&source).map_err(to_error)?
        } else {
            CarriedBodies::default()
        };
        let nearest = setup.nearest_of(trajectory, &carried);
        let refused = uses_signal(program).or_else(|| setup.too_near(&nearest));
        let figures = plan.figures();
        let warnings = plan.warnings(&figures);

        let [json, mcap] = setup.new_files(&file_stem(name), [".json", ".mcap"]).map_err(words)?;
        let stem = json.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let write_program = || {
            let file = Output::new(&json)?;
            file.write(text.as_bytes())?;
            file.complete_always()
        };
        let write_plan = || {
            let file = Output::new(&mcap)?;
            let mut config = PlanConfig::default();
            config.file.names = setup.names.clone();
            write_plan(file.stream()?, &plan, config, &text)
                .map_err(|error| file.failure(error))?
                .into_inner()
                .map_err(|error| file.failure(error.into_error()))?;
            file.complete_always()
        };
        write_program()
            .and_then(|()| write_plan())
            // Each of the two files is useless without the other.
            .inspect_err(|_| drop(fs::remove_file(&json)))
            .map_err(|error| words(error.into()))?;
        let cycle_time_s = trajectory.cycle_time_s();
        // The page is created from the file.
        let start_rad = *trajectory.path().start_rad();
        drop(plan);
        let page = setup.page(&mcap, None, Extent::Sketch).map_err(words)?;
        let message = page_message(
            "plan",
            &PlanForPage {
                id,
                name: &stem,
                cycle_time_s,
                motions,
                start_rad: &start_rad,
                nearest,
                refused: refused.as_deref(),
                warnings: &warnings,
                sketch: page.sketch(),
            },
        );
        let (motions, label) =
            (Program::clone(&source.program).into(), label(&stem, &figures, &setup.robot));
        Ok(Self { id, motions, label, start_rad, text, stem, mcap, refused, message })
    }
}

/// Returns the reason why the twin cannot run a program with inputs or outputs: a request to a
/// drive contains motions only.
fn uses_signal(program: &Program) -> Option<String> {
    let (motion, entry) = program.entries().find_map(|(motion, it)| Some((motion, it.io()?)))?;
    let message = format!(
        "motion {motion}: the twin does not use inputs and outputs (`{}`); run the program by \
         iiwasim run",
        entry.io
    );
    Some(program.sources.in_message(&message))
}

/// Plan in page format.
#[derive(Serialize)]
struct PlanForPage<'a, S> {
    id: u64,
    name: &'a str,
    cycle_time_s: f64,
    motions: usize,
    start_rad: &'a [f64; 7],
    #[serde(flatten)]
    nearest: NearestPlaces,
    refused: Option<&'a str>,
    /// Warnings of the plan.
    warnings: &'a [String],
    sketch: S,
}

/// Maximum number of motions of a program: the whole plan is held in memory.
const MAX_MOTIONS: usize = 1000;

/// Maximum number of joint states of a plan: they are held in memory, here and in the page.
const MAX_SAMPLES: u64 = 100_000;

/// Rejects a plan that is too long to be shown.
fn check_size(plan: &Trajectory) -> Result<(), String> {
    let rate_hz = PlanConfig::default().rate_hz;
    let size = PlanSize::of(plan, rate_hz);
    if size.samples() <= MAX_SAMPLES {
        return Ok(());
    }
    Err(format!(
        "the program takes {}; the twin shows up to {}. iiwasim plan and iiwasim run have no such \
         limit",
        long_duration(size.duration_s()),
        long_duration(MAX_SAMPLES as f64 / rate_hz)
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_program_with_signals_is_shown_and_not_run() {
        let folder = tempfile::tempdir().unwrap();
        let text = r#"{
            "version": 1,
            "start": { "joints_deg": [0, 30, 0, -60, 0, 90, 0] },
            "motions": [
                { "type": "ptp", "joints_deg": [10, 30, 0, -60, 0, 90, 0] },
                { "type": "set", "io": "Gripper.Close", "value": true, "name": "close" }
            ]
        }"#;
        let setup = Setup::without_drive(folder.path());
        let plan = PlanFiles::new(1, "a.json", text.to_owned(), &setup).unwrap();
        let refused = plan.refused.unwrap_or_default();
        let expected = "motion 2 \"close\": the twin does not use inputs and outputs";
        assert!(refused.starts_with(expected), "{refused}");
    }
}
