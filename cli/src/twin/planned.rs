//! A program that was planned, and may be sent.

use std::{fs, path::PathBuf};

use iiwa_log::{PlanConfig, PlanOptions, PlanSize, write_plan};
use iiwa_path::Program;
use iiwa_traj::Trajectory;
use iiwa_view::{Extent, Nearest, long_duration};
use serde::Serialize;

use crate::{failure::Failure, output::Output};

use super::{Setup, Word, setup::stem_of, word};

/// A plan, and the files of it.
#[derive(Debug)]
pub(super) struct Planned {
    /// Another one for each plan, so that nothing is sent but what was looked at.
    pub(super) id: u64,
    pub(super) program: Program,
    pub(super) text: String,
    /// What its files are called, without an extension.
    pub(super) stem: String,
    pub(super) mcap: PathBuf,
    /// Why it is not to be sent, if it is not.
    pub(super) refused: Option<String>,
    pub(super) word: Word,
}

impl Planned {
    /// Plans a program. Errors are for people, and say where the fault is in the text.
    pub(super) fn new(id: u64, name: &str, text: String, setup: &Setup) -> Result<Self, String> {
        let what = |failure: Failure| failure.what();
        let program = Program::from_json(&text)
            .map_err(|error| what(Failure::in_text(&error.what(), error.place(), name, &text)))?;
        let motions = program.motions.len();
        if motions > MOTIONS {
            return Err(format!(
                "{name} has {motions} motions, and this page plans up to {MOTIONS}; iiwasim plan and iiwasim \
                 run take it"
            ));
        }
        let own = [setup.robot.name(), &setup.robot_name];
        if let Some(other) = program.robot.as_deref().filter(|other| !own.contains(other)) {
            return Err(format!("{name} is for the robot `{other}`, this one is `{}`", own[0]));
        }
        let how = PlanOptions::default();
        let plan = how
            .plan(&program, &setup.robot)
            .map_err(|error| what(Failure::plan(error, name, &text)))?;
        check_size(&plan)?;
        let nearest = setup.nearest_of(&plan);
        let refused = setup.too_near(nearest.as_ref());

        let [json, mcap] = setup.new_files(&stem_of(name), [".json", ".mcap"]).map_err(what)?;
        let stem = json.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let write_program = || {
            let file = Output::new(&json)?;
            file.write(text.as_bytes())?;
            file.complete_always()
        };
        let write_plan = || {
            let file = Output::new(&mcap)?;
            write_plan(file.stream()?, &plan, &how, &text)
                .map_err(|error| file.failure(&error))?
                .into_inner()
                .map_err(|error| file.failure(error.error()))?;
            file.complete_always()
        };
        write_program()
            .and_then(|()| write_plan())
            // Half of it is of no use.
            .inspect_err(|_| drop(fs::remove_file(&json)))
            .map_err(what)?;
        let cycle_time_s = plan.cycle_time_s();
        // All that is needed of it now is in the file.
        drop(plan);
        let page = setup.page(&mcap, None, Extent::Sketch).map_err(what)?;
        let word = word(
            "plan",
            &PlanForPage {
                id,
                name: &stem,
                cycle_time_s,
                motions,
                start_rad: &program.start_rad,
                nearest,
                refused: refused.as_deref(),
                sketch: page.sketch(),
            },
        );
        Ok(Self { id, program, text, stem, mcap, refused, word })
    }
}

/// The word for pages.
#[derive(Serialize)]
struct PlanForPage<'a, S> {
    id: u64,
    name: &'a str,
    cycle_time_s: f64,
    motions: usize,
    start_rad: &'a [f64; 7],
    nearest: Option<Nearest>,
    refused: Option<&'a str>,
    sketch: S,
}

/// Motions of a program at most: what they are planned with is in memory as a whole.
const MOTIONS: usize = 1000;

/// Joint states of a plan at most: what is drawn of it is in memory as a whole, on the page as well.
const SAMPLES: u64 = 100_000;

/// Refuses a plan that is too long to be shown.
fn check_size(plan: &Trajectory) -> Result<(), String> {
    let rate_hz = PlanConfig::default().rate_hz;
    let size = PlanSize::of(plan, rate_hz);
    if size.samples() <= SAMPLES {
        return Ok(());
    }
    Err(format!(
        "the program takes {}, which is too long for this page: it shows up to {}; iiwasim plan and \
         iiwasim run take it",
        long_duration(size.duration_s()),
        long_duration(SAMPLES as f64 / rate_hz)
    ))
}
