//! Plans computed for a page.

use std::io::Cursor;

use iiwa_kin::Robot;
use iiwa_log::{PlanConfig, PlanSize, PlanWriter};
use iiwa_plan::{PlanRequest, ProgramSource};

use crate::PageError;

use super::source::{PageSource, Role};

/// Maximum size of a plan in memory, in bytes: some two hours.
const MAX_BYTES: u64 = 256 << 20;

/// Plans the program in a recording; `None` for a plan, or a recording without a program.
pub(crate) fn recorded(
    recording: &PageSource,
    robot: &Robot,
    interrupted: fn() -> bool,
) -> Option<Result<PageSource, PageError>> {
    let text = recording.log.program.as_deref()?;
    let request = PlanRequest { robot: Some(robot.clone()), ..PlanRequest::default() };
    (recording.role() == Role::Recording).then(|| {
        let source = ProgramSource::from_json(text).map_err(PageError::program)?;
        let (plan, _) = planned("plan of its program", &source, &request, interrupted)?;
        Ok(plan)
    })
}

/// Plans a program, and returns the plan with its robot.
pub(crate) fn planned(
    name: &str,
    source: &ProgramSource,
    request: &PlanRequest,
    interrupted: fn() -> bool,
) -> Result<(PageSource, Robot), PageError> {
    let mut planning = request.begin(source).map_err(PageError::program)?;
    let robot = planning.robot().clone();
    let config = PlanConfig::default();
    let mut size = PlanSize::new(config.rate_hz);
    let mut writer = PlanWriter::new(Cursor::new(Vec::new()), &robot, config)?;
    for section in planning.by_ref() {
        if interrupted() {
            return Err(PageError::Interrupted);
        }
        let section = section.map_err(PageError::program)?;
        size.add(&section);
        if size.bytes() > MAX_BYTES {
            return Err(PageError::TooLong {
                duration: iiwa_report::long_duration(size.duration_s()),
            });
        }
        writer.section(&section)?;
    }
    let stream = writer.finish(planning.figures(), Some(source.text.complete()))?;
    Ok((PageSource::generated(name, stream.get_ref())?, robot))
}
