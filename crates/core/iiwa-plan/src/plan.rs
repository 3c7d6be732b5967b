//! Plan of a whole program.

use std::sync::Arc;

use iiwa_kin::Robot;
use iiwa_program::Program;
use iiwa_traj::Trajectory;

use crate::{LoadRecord, PlanFigures, PlanOptions, warnings::warnings};

/// Plan of a whole program.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Program with the limits of the request.
    pub program: Arc<Program>,
    /// Trajectory of the program.
    pub trajectory: Trajectory,
    /// Options of path and timing.
    pub options: PlanOptions,
}

impl Plan {
    /// Robot for which the program was planned.
    #[must_use]
    pub fn robot(&self) -> &Robot {
        self.trajectory.path().robot()
    }

    /// Figures of the plan, with its warnings.
    #[must_use]
    pub fn figures(&self) -> PlanFigures {
        let mut figures = PlanFigures::of(&self.trajectory, &self.options);
        figures.loads = LoadRecord::all(&self.program);
        figures.warnings = self.warnings(&figures);
        figures
    }

    /// Warnings about the program and its torques, as messages for the user. `figures` are those
    /// of this plan: they are passed in, so that callers that have them do not compute them twice.
    #[must_use]
    pub fn warnings(&self, figures: &PlanFigures) -> Vec<String> {
        let mut all = warnings(&self.program, self.trajectory.path());
        all.extend(figures.torque_warnings());
        all
    }
}
