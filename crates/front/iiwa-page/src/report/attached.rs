//! Plan of the program in a recording.

use std::io::Cursor;

use iiwa_kin::Robot;
use iiwa_log::{PlanConfig, PlanSize, PlanWriter};
use iiwa_plan::{PlanRequest, ProgramSource};

use crate::PageError;

use super::source::{PageSource, Role};

/// Maximum size of that plan in memory, in bytes: some two hours.
const MAX_BYTES: u64 = 256 << 20;

/// Plans the program in a recording; `None` for a plan, or a recording without a program.
pub(crate) fn plan(
    recording: &PageSource,
    robot: &Robot,
    interrupted: fn() -> bool,
) -> Option<Result<PageSource, PageError>> {
    let text = recording.log.program.as_deref()?;
    (recording.role() == Role::Recording).then(|| generated(text, robot, interrupted))
}

fn generated(
    text: &str,
    robot: &Robot,
    interrupted: fn() -> bool,
) -> Result<PageSource, PageError> {
    let to_error = |error| PageError::RecordedProgram { source: Box::new(error) };
    let request = PlanRequest { robot: Some(robot.clone()), ..PlanRequest::default() };
    let source = ProgramSource::from_json(text).map_err(to_error)?;
    let mut planning = request.begin(&source).map_err(to_error)?;
    let config = PlanConfig::default();
    let mut size = PlanSize::new(config.rate_hz);
    let mut writer = PlanWriter::new(Cursor::new(Vec::new()), robot, config)?;
    for section in planning.by_ref() {
        if interrupted() {
            return Err(PageError::Interrupted);
        }
        let section = section.map_err(to_error)?;
        size.add(&section);
        if size.bytes() > MAX_BYTES {
            return Err(PageError::TooLong {
                duration: iiwa_report::long_duration(size.duration_s()),
            });
        }
        writer.section(&section)?;
    }
    let stream = writer.finish(planning.figures(), Some(text))?;
    PageSource::generated("plan of its program", stream.get_ref())
}
