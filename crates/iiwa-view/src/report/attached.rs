//! The plan of the program that a recording holds.

use std::io::Cursor;

use iiwa_kin::Robot;
use iiwa_log::{PlanConfig, PlanFigures, PlanSize, PlanWriter, WriteError};
use iiwa_path::{JointPath, Program};
use iiwa_traj::{Planner, Timing};

use crate::{ViewError, long_duration};

use super::source::{Role, Source};

/// Bytes of that plan, which is in memory, at most: some two hours.
const MOST_BYTES: u64 = 256 << 20;

/// The plan of the program that a recording holds; none of a plan, nor of a recording without one.
pub(crate) fn plan(
    recording: &Source,
    robot: &Robot,
    interrupted: fn() -> bool,
) -> Option<Result<Source, ViewError>> {
    let text = recording.log.program.as_deref()?;
    (recording.role() == Role::Recording).then(|| made(text, robot, interrupted))
}

fn made(text: &str, robot: &Robot, interrupted: fn() -> bool) -> Result<Source, ViewError> {
    let name = || "program.json".to_owned();
    let program =
        Program::from_json(text).map_err(|error| ViewError::Program { what: error.what() })?;
    let path = JointPath::new(&program, robot)
        .map_err(|source| ViewError::Path { name: name(), source })?;
    let refuse = |source: WriteError| ViewError::Write { source };
    let timing = Timing::default();
    let mut figures = PlanFigures::new(timing, robot, 0);
    let storage = Cursor::new(Vec::new());
    let config = PlanConfig::default();
    let mut size = PlanSize::new(config.rate_hz);
    let mut writer = PlanWriter::new(storage, robot, config).map_err(refuse)?;
    for section in Planner::new(&path, timing) {
        if interrupted() {
            return Err(ViewError::Interrupted);
        }
        let section = section.map_err(|source| ViewError::Timing { name: name(), source })?;
        size.add(&section);
        if size.bytes() > MOST_BYTES {
            return Err(ViewError::TooLong { duration: long_duration(size.duration_s()) });
        }
        figures.add(&section);
        writer.section(&section).map_err(refuse)?;
    }
    let attached = ("program.json", "application/json", text.as_bytes());
    let storage = writer.finish(&figures.to_metadata(), &[attached]).map_err(refuse)?;
    Source::made("plan of its program", storage.into_inner())
}
