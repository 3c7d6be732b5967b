//! The plan of the program that a recording holds.

use std::io::Cursor;

use iiwa_kin::Robot;
use iiwa_log::{PlanConfig, PlanOptions, PlanWriter, Planning};
use iiwa_program::Program;
use iiwa_traj::PlanError;

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
    let refuse = |source: PlanError| ViewError::Planning { name: "program.json".into(), source };
    let program =
        Program::from_json(text).map_err(|error| ViewError::Program { what: error.what() })?;
    let mut planning = Planning::new(&program, robot, &PlanOptions::default())
        .map_err(|fault| refuse(fault.into()))?;
    let stream = Cursor::new(Vec::new());
    let mut writer = PlanWriter::new(stream, robot, PlanConfig::default())?;
    while let Some(section) = planning.next() {
        if interrupted() {
            return Err(ViewError::Interrupted);
        }
        let section = section.map_err(|error| refuse(error.into()))?;
        if planning.size().bytes() > MOST_BYTES {
            let duration = long_duration(planning.size().duration_s());
            return Err(ViewError::TooLong { duration });
        }
        writer.section(&section)?;
    }
    let stream = writer.finish(planning.figures(), Some(text))?;
    Source::made("plan of its program", stream.get_ref())
}
