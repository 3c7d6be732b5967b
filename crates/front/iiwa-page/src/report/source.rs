//! Files shown on a page.

use std::{
    io::{self, Read},
    path::Path,
};

use iiwa_files::InputFile;
use iiwa_kin::Robot;
use iiwa_log::{JointLog, LogOptions, Loss, PlanRecord, PositionSource as Format};
use iiwa_program::Program;
use serde::Serialize;

use crate::PageError;

/// File that was read.
#[derive(Debug)]
pub(crate) struct PageSource {
    /// Name as given.
    pub(crate) name: String,
    /// Name without its folder: pages are shared.
    pub(crate) file: String,
    /// Joint positions.
    pub(crate) log: JointLog,
    /// Further content of a plan; of a recording, only its metadata.
    pub(crate) record: PlanRecord,
}

/// Kind of motion in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Role {
    /// Planned motion.
    Plan,
    /// Planned motion in an incomplete file: no trajectory, no figures.
    Part,
    /// Recorded motion.
    Recording,
}

impl PageSource {
    /// Reads a file up to the first damage.
    pub(crate) fn read(path: &Path, options: LogOptions) -> Result<Self, PageError> {
        let mut input = open(path)?;
        if input.is_pipe() {
            // A pipe can be read only once.
            let mut content = Vec::new();
            input.read_to_end(&mut content).map_err(|source| to_error(path, source))?;
            return Self::read_twice(path, options, || Ok(content.as_slice()));
        }
        Self::read_twice(path, options, || open(path))
    }

    /// Reads a file that `open` opens once for its joint positions, and once for the rest.
    fn read_twice<R: Read>(
        path: &Path,
        options: LogOptions,
        open: impl Fn() -> Result<R, PageError>,
    ) -> Result<Self, PageError> {
        let name = path.display().to_string();
        let log = JointLog::read_with(open()?, options)
            .and_then(|log| log.check_rate().map(|()| log))
            .map_err(|source| PageError::Recording { name: name.clone(), source })?;
        let file = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
        Self { name, file, log, record: PlanRecord::default() }.with_record(open)
    }

    /// Reads an MCAP file that was created for the page, with a name to show.
    pub(crate) fn generated(name: &str, content: &[u8]) -> Result<Self, PageError> {
        let log = JointLog::read(content)
            .map_err(|source| PageError::Recording { name: name.to_owned(), source })?;
        let [name, file] = [name, name].map(str::to_owned);
        Self { name, file, log, record: PlanRecord::default() }.with_record(|| Ok(content))
    }

    pub(crate) fn role(&self) -> Role {
        match (self.record.nodes.len(), self.record.pieces.is_empty()) {
            (2.., false) => Role::Plan,
            (_, false) => Role::Part,
            (_, true) => Role::Recording,
        }
    }

    /// Program in the file, if valid.
    pub(crate) fn program(&self) -> Option<Program> {
        self.log.program.as_deref().and_then(|text| Program::from_json(text).ok())
    }

    /// Adds the further content of a plan, up to the damage that the joint states have reported.
    fn with_record<R: Read>(
        mut self,
        open: impl FnOnce() -> Result<R, PageError>,
    ) -> Result<Self, PageError> {
        if self.log.source != Some(Format::Mcap) {
            return Ok(self);
        }
        let (record, end) = PlanRecord::read_part(open()?);
        match end {
            Some(source) if !self.is_broken_off() => {
                return Err(PageError::Plan { name: self.name, source: source.into() });
            }
            _ => self.record = record,
        }
        // Between times out of order, curves would have billions of samples.
        if let Err(source) = self.record.check_times() {
            return Err(PageError::Plan { name: self.name, source });
        }
        // Without nodes, the end of the last piece is that of the joint states.
        if let (true, Some(last), Some(end_s)) =
            (self.record.nodes.is_empty(), self.record.pieces.last_mut(), self.log.t_s.last())
        {
            last.end_s = last.start_s.max(*end_s);
        }
        Ok(self)
    }

    /// Returns true if the file is cut off or damaged.
    pub(crate) fn is_broken_off(&self) -> bool {
        self.log.losses.iter().any(|loss| matches!(loss, Loss::BrokenOff { .. }))
    }

    /// Returns the requested robot, or that of the file, or the default robot; and the assumption
    /// made, if any.
    pub(crate) fn robot(
        &self,
        asked: Option<&Robot>,
    ) -> Result<(Robot, Option<String>), PageError> {
        if let Some(robot) = asked {
            return Ok((robot.clone(), None));
        }
        let recorded = self
            .log
            .recorded_robot()
            .map_err(|source| PageError::UnknownRobot { name: self.name.clone(), source })?;
        if let Some(robot) = recorded {
            return Ok((robot, None));
        }
        let robot = Robot::default();
        let note = format!("{} names no robot: taken for {}", self.name, robot.name());
        Ok((robot, Some(note)))
    }

    /// Rejects positions that are impossible for the robot.
    pub(crate) fn check(&self, robot: &Robot) -> Result<(), PageError> {
        self.log
            .check_robot(robot)
            .map_err(|source| PageError::Recording { name: self.name.clone(), source })
    }

    /// Describes the losses of the file.
    pub(crate) fn losses(&self) -> Vec<String> {
        const SHOWN: usize = 5;
        let losses = &self.log.losses;
        let mut notes: Vec<String> =
            losses.iter().take(SHOWN).map(|loss| format!("{}: {loss}", self.name)).collect();
        if losses.len() > SHOWN {
            notes.push(format!("{}: and {} more losses", self.name, losses.len() - SHOWN));
            // The end of a damaged file is the most important loss.
            if let Some(end @ Loss::BrokenOff { .. }) = losses.last() {
                notes.push(format!("{}: {end}", self.name));
            }
        }
        notes
    }
}

/// Opens a file or a pipe.
fn open(path: &Path) -> Result<InputFile, PageError> {
    InputFile::open(path).map_err(|source| to_error(path, source))
}

fn to_error(path: &Path, source: io::Error) -> PageError {
    PageError::Open { name: path.display().to_string(), source }
}
