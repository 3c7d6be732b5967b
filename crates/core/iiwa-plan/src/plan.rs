//! The plan of a whole program.

use std::sync::Arc;

use iiwa_kin::Robot;
use iiwa_program::Program;
use iiwa_traj::Trajectory;

use crate::{PlanFigures, PlanOptions, warnings::warnings};

/// The plan of a whole program.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The program with the limits of the request.
    pub program: Arc<Program>,
    /// Its trajectory.
    pub trajectory: Trajectory,
    /// Options of path and timing.
    pub options: PlanOptions,
}

impl Plan {
    /// The robot that it was planned for.
    #[must_use]
    pub fn robot(&self) -> &Robot {
        self.trajectory.path().robot()
    }

    /// The figures.
    #[must_use]
    pub fn figures(&self) -> PlanFigures {
        PlanFigures::of(&self.trajectory, &self.options)
    }

    /// Warnings about the program and its torques, for people.
    #[must_use]
    pub fn warnings(&self, figures: &PlanFigures) -> Vec<String> {
        let mut all = warnings(&self.program, self.trajectory.path());
        all.extend(figures.torque_warnings());
        all
    }
}
