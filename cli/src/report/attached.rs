//! The plan of the program that a recording holds.

use std::io::Cursor;

use iiwa_kin::Robot;
use iiwa_log::{PlanConfig, PlanSize, PlanWriter, WriteError};
use iiwa_path::{JointPath, Program};
use iiwa_traj::{Planner, Timing};

use crate::{
    failure::{Failure, chain},
    figures::{Figures, lasting},
    output,
};

use super::source::{Role, Source};

/// Bytes of that plan, which is in memory, at most: some two hours.
const MOST_BYTES: u64 = 256 << 20;

/// The plan of the program that a recording holds; none of a plan, nor of a recording without one.
pub(crate) fn plan(recording: &Source, robot: &Robot) -> Option<Result<Source, Failure>> {
    let text = recording.log.program.as_deref()?;
    (recording.role() == Role::Recording).then(|| made(text, robot))
}

fn made(text: &str, robot: &Robot) -> Result<Source, Failure> {
    let program = Program::from_json(text).map_err(|error| Failure::input(error.what()))?;
    let path =
        JointPath::new(&program, robot).map_err(|fault| Failure::input(fault.to_string()))?;
    let refuse = |error: WriteError| Failure::run("cannot hold the plan of its program", &error);
    let timing = Timing::default();
    let mut figures = Figures::new(timing, robot, 0);
    let storage = Cursor::new(Vec::new());
    let config = PlanConfig::default();
    let mut size = PlanSize::new(config.rate_hz);
    let mut writer = PlanWriter::new(storage, robot, config).map_err(refuse)?;
    for section in Planner::new(&path, timing) {
        output::check_interrupt()?;
        let section = section.map_err(|error| Failure::input(chain(&error)))?;
        size.add(&section);
        if size.bytes() > MOST_BYTES {
            let long = lasting(size.duration_s());
            return Err(Failure::input(format!("it takes {long} or more, too long to be drawn")));
        }
        figures.add(&section);
        writer.section(&section).map_err(refuse)?;
    }
    let attached = ("program.json", "application/json", text.as_bytes());
    let storage = writer.finish(&figures.metadata(), &[attached]).map_err(refuse)?;
    Source::made("plan of its program", storage.into_inner())
}
