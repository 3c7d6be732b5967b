//! A program that was planned, and may be sent.

use std::{fs, io::Cursor, path::PathBuf};

use iiwa_log::{PlanConfig, PlanWriter, WriteError};
use iiwa_path::{Path as RobotPath, Program};
use iiwa_traj::{Timing, Trajectory};
use serde::Serialize;

use crate::{
    failure::{Failure, chain},
    figures::Figures,
    output::Output,
    report::Page,
};

use super::{
    Setup, Word,
    setup::{Nearest, stem_of},
    word,
};

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
        let own = [setup.robot.name(), &setup.robot_name];
        if let Some(other) = program.robot.as_deref().filter(|other| !own.contains(other)) {
            return Err(format!("{name} is for the robot `{other}`, this one is `{}`", own[0]));
        }
        let path = RobotPath::new(&program, &setup.robot).map_err(|fault| {
            what(Failure::in_text(&fault.to_string(), &fault.place_in(&text), name, &text))
        })?;
        let timing = Timing::default();
        let plan = Trajectory::plan(&path, timing).map_err(|error| chain(&error))?;
        let nearest = setup.nearest_of(&plan);
        let refused = setup.too_near(nearest.as_ref());

        let bytes = as_mcap(&plan, timing, &text, setup).map_err(|error| chain(&error))?;
        let [json, mcap] = setup.new_files(&stem_of(name), [".json", ".mcap"]).map_err(what)?;
        let stem = json.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let write = |path: &PathBuf, bytes: &[u8]| {
            let file = Output::new(path)?;
            file.write(bytes)?;
            file.complete_always()
        };
        write(&json, text.as_bytes())
            .and_then(|()| write(&mcap, &bytes))
            // Half of it is of no use.
            .inspect_err(|_| drop(fs::remove_file(&json)))
            .map_err(what)?;
        let page = Page::of(&mcap, None, Some(&setup.robot_name)).map_err(what)?;
        let word = word(
            "plan",
            &ForPage {
                id,
                name: &stem,
                cycle_time_s: plan.cycle_time_s(),
                motions: program.motions.len(),
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
struct ForPage<'a, S> {
    id: u64,
    name: &'a str,
    cycle_time_s: f64,
    motions: usize,
    start_rad: &'a [f64; 7],
    nearest: Option<Nearest>,
    refused: Option<&'a str>,
    sketch: S,
}

/// The plan as `iiwasim plan` writes it.
fn as_mcap(
    plan: &Trajectory,
    timing: Timing,
    program: &str,
    setup: &Setup,
) -> Result<Vec<u8>, WriteError> {
    let mut figures = Figures::new(timing, &setup.robot, 0);
    let storage = Cursor::new(Vec::new());
    let mut writer = PlanWriter::new(storage, &setup.robot, PlanConfig::default())?;
    for stretch in plan.stretches() {
        figures.add(stretch);
        writer.stretch(stretch)?;
    }
    let program = ("program.json", "application/json", program.as_bytes());
    Ok(writer.finish(&figures.metadata(), &[program])?.into_inner())
}
