//! Planning section by section.

use std::sync::{Arc, atomic::AtomicBool};

use iiwa_kin::Robot;
use iiwa_path::JointPath;
use iiwa_program::Sources;
use iiwa_traj::{Planner, Section};

use crate::{Error, PlanFigures, PlanOptions, ProgramText};

/// Iterator that plans a program section by section and keeps the figures up to date. It stores the
/// path and the figures, and of the sections only a few that are planned ahead.
///
/// ```
/// use iiwa_plan::{PlanRequest, ProgramSource};
///
/// let text = r#"{ "version": 1, "start": { "joints_deg": [-20, 0, 0, 0, 0, 0, 0] },
///     "motions": [{ "type": "ptp", "joints_deg": [20, 0, 0, 0, 0, 0, 0] }] }"#;
/// let mut planning = PlanRequest::default().begin(&ProgramSource::from_json(text)?)?;
/// while let Some(section) = planning.next() {
///     // Write, send or drop the section.
///     section?;
/// }
/// assert!((planning.figures().cycle_time_s - 0.798).abs() < 1e-3);
/// # Ok::<(), iiwa_plan::Error>(())
/// ```
#[derive(Debug)]
pub struct Planning {
    planner: Planner,
    figures: PlanFigures,
    /// Warnings about the program.
    warnings: Vec<String>,
    text: ProgramText,
    sources: Sources,
}

impl Planning {
    pub(crate) fn new(
        path: &JointPath,
        options: &PlanOptions,
        warnings: Vec<String>,
        text: ProgramText,
        sources: Sources,
    ) -> Self {
        Self {
            planner: Planner::new(path, options.timing),
            figures: PlanFigures::new(options.timing, path.robot(), options.samples),
            warnings,
            text,
            sources,
        }
    }

    /// Makes the planning end with an [interrupt error](Error::is_interrupt) soon after `stop` is
    /// set.
    #[must_use]
    pub fn interrupted_by(self, stop: Arc<AtomicBool>) -> Self {
        Self { planner: self.planner.interrupted_by(stop), ..self }
    }

    /// Sets the number of threads for long programs; by default, all cores plan them.
    #[must_use]
    pub fn with_threads(self, threads: usize) -> Self {
        Self { planner: self.planner.with_threads(threads), ..self }
    }

    /// Path of the program.
    #[must_use]
    pub fn path(&self) -> &JointPath {
        self.planner.path()
    }

    /// Robot for which the program is planned.
    #[must_use]
    pub fn robot(&self) -> &Robot {
        self.path().robot()
    }

    /// Text of the program.
    #[must_use]
    pub fn text(&self) -> &ProgramText {
        &self.text
    }

    /// Figures of all sections returned so far. Times of groups and repeat blocks, and warnings,
    /// are added after the last section.
    #[must_use]
    pub fn figures(&self) -> &PlanFigures {
        &self.figures
    }

    /// Figures so far, as a mutable reference: the caller can add values that only the caller
    /// knows, such as clearances.
    pub fn figures_mut(&mut self) -> &mut PlanFigures {
        &mut self.figures
    }

    /// Final figures. They include the warnings about the program and about its torques, as
    /// messages for the user.
    #[must_use]
    pub fn finish(mut self) -> PlanFigures {
        self.add_warnings();
        self.figures
    }

    fn add_warnings(&mut self) {
        let torque_warnings = self.figures.torque_warnings();
        self.figures.warnings.clone_from(&self.warnings);
        self.figures.warnings.extend(torque_warnings);
    }

    /// Share of the program in the sections returned so far, 0 to 1.
    #[must_use]
    pub fn progress(&self) -> f64 {
        self.planner.progress()
    }
}

impl Iterator for Planning {
    type Item = Result<Section, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        let Some(section) = self.planner.next() else {
            self.figures.add_groups(self.planner.path());
            self.add_warnings();
            return None;
        };
        if let Ok(section) = &section {
            self.figures.add(section);
        }
        Some(section.map_err(|error| Error::plan(error.into(), &self.sources, self.text.as_read())))
    }
}
