//! Planning a program, with its figures and the size of its file.

use std::{
    io::Write,
    sync::{Arc, atomic::AtomicBool},
};

use iiwa_kin::Robot;
use iiwa_path::JointPath;
use iiwa_program::{Fault, Program};
use iiwa_traj::{Planner, Section, TimingError, Trajectory};

use crate::{PlanConfig, PlanFigures, PlanOptions, PlanSize, PlanWriter, WriteError};

/// Plans a program section by section: an iterator that keeps the figures and the size of the file up to
/// date. It needs memory for one section and the figures.
///
/// ```
/// use std::io::Cursor;
///
/// use iiwa_kin::Robot;
/// use iiwa_log::{PlanConfig, PlanOptions, PlanRecord, PlanWriter, Planning};
/// use iiwa_program::Program;
///
/// # let text = r#"{ "version": 1, "start": { "joints_deg": [-20, 0, 0, 0, 0, 0, 0] },
/// #     "motions": [{ "type": "ptp", "joints_deg": [20, 0, 0, 0, 0, 0, 0] }] }"#;
/// let robot = Robot::lbr_iiwa_7_r800();
/// let mut planning = Planning::new(&Program::from_json(text)?, &robot, &PlanOptions::default())?;
/// let stream = Cursor::new(Vec::new());
/// let mut writer = PlanWriter::new(stream, &robot, PlanConfig::default())?;
/// while let Some(section) = planning.next() {
///     writer.section(&section?)?;
/// }
/// let file = writer.finish(planning.figures(), Some(text))?.into_inner();
///
/// let record = PlanRecord::read(&*file)?;
/// assert_eq!(record.figures().as_ref(), Some(planning.figures()));
/// assert_eq!(record.robot()?, Some(robot));
/// assert_eq!(record.program.as_deref(), Some(text));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Planning {
    planner: Planner,
    figures: PlanFigures,
    size: PlanSize,
}

impl Planning {
    /// Begins to plan a program for `robot`, whichever robot it names.
    ///
    /// # Errors
    ///
    /// [`Fault`] if the program asks for something that the robot cannot do.
    pub fn new(program: &Program, robot: &Robot, options: &PlanOptions) -> Result<Self, Fault> {
        let path = JointPath::with_options(program, robot, options.path)?;
        Ok(Self {
            planner: Planner::new(&path, options.timing),
            figures: PlanFigures::new(options.timing, robot, options.samples),
            size: PlanSize::new(PlanConfig::default().rate_hz),
        })
    }

    /// For a file with `rate_hz` joint states per second, which its size depends on.
    #[must_use]
    pub fn with_rate(self, rate_hz: f64) -> Self {
        Self { size: PlanSize::new(rate_hz), ..self }
    }

    /// Ends in [`TimingError::Interrupted`] soon after `stop` is set.
    #[must_use]
    pub fn interrupted_by(self, stop: Arc<AtomicBool>) -> Self {
        Self { planner: self.planner.interrupted_by(stop), ..self }
    }

    /// The path of the program.
    #[must_use]
    pub fn path(&self) -> &JointPath {
        self.planner.path()
    }

    /// The figures so far.
    #[must_use]
    pub fn figures(&self) -> &PlanFigures {
        &self.figures
    }

    /// The same, for what only the caller knows.
    pub fn figures_mut(&mut self) -> &mut PlanFigures {
        &mut self.figures
    }

    /// The figures, at the end.
    #[must_use]
    pub fn into_figures(self) -> PlanFigures {
        self.figures
    }

    /// The size of the file so far.
    #[must_use]
    pub fn size(&self) -> PlanSize {
        self.size
    }

    /// Share of the program that is planned, 0 to 1.
    #[must_use]
    pub fn progress(&self) -> f64 {
        self.planner.progress()
    }
}

impl Iterator for Planning {
    type Item = Result<Section, TimingError>;

    fn next(&mut self) -> Option<Self::Item> {
        let section = self.planner.next()?;
        if let Ok(section) = &section {
            self.figures.add(section);
            self.size.add(section);
        }
        Some(section)
    }
}

/// Writes a trajectory that is planned already, with its program's text, and gives the stream back.
///
/// # Errors
///
/// Any [`WriteError`].
pub fn write_plan<W: Write>(
    stream: W,
    trajectory: &Trajectory,
    options: &PlanOptions,
    config: PlanConfig,
    program: &str,
) -> Result<W, WriteError> {
    let robot = trajectory.path().robot();
    let mut writer = PlanWriter::new(stream, robot, config)?;
    for section in trajectory.sections() {
        writer.section(section)?;
    }
    writer.finish(&PlanFigures::of(trajectory, options), Some(program))
}
