//! Plan requests: robot, limits and planning options.

use std::sync::{Arc, atomic::AtomicBool};

use iiwa_kin::Robot;
use iiwa_path::JointPath;
use iiwa_program::Program;
use iiwa_traj::{Planner, Trajectory};

use crate::{Error, Plan, PlanOptions, Planning, ProgramSource, warnings::warnings};

/// Robot, limits and options for planning a program.
///
/// A program is planned for the robot that it names, unless the request overrides the robot.
#[derive(Clone, Debug, Default)]
pub struct PlanRequest {
    /// Robot that overrides the program's. A built-in model gets the flange length that the program
    /// states.
    pub robot: Option<Robot>,
    /// Robot for programs that name none, with the flange length that they state.
    pub default_robot: Robot,
    /// Torque limit that overrides the program's, as a share of the robot's torque limits.
    pub torque_limit_rel: Option<f64>,
    /// Override of the controller that replaces the program's, as a share.
    pub speed_override: Option<f64>,
    /// Options of path and timing.
    pub options: PlanOptions,
}

impl PlanRequest {
    /// Robot for which a program is planned.
    ///
    /// # Errors
    ///
    /// [`Error::UnknownRobot`] and [`Error::Profile`] if the program names a robot that cannot be
    /// read, and the request does not override the robot.
    pub fn robot(&self, source: &ProgramSource) -> Result<Robot, Error> {
        match &self.robot {
            Some(robot) => Ok(requested(robot, &source.program)),
            None => Ok(source
                .named_robot()?
                .unwrap_or_else(|| source.program.with_flange(self.default_robot.clone()))),
        }
    }

    /// Program with the limits of the request.
    fn limited(&self, source: &ProgramSource) -> Arc<Program> {
        let mut program = Arc::clone(&source.program);
        if self.torque_limit_rel.is_some() || self.speed_override.is_some() {
            let workcell = &mut Arc::make_mut(&mut program).workcell;
            workcell.torque_limit_rel = self.torque_limit_rel.or(workcell.torque_limit_rel);
            workcell.speed_override = self.speed_override.or(workcell.speed_override);
        }
        program
    }

    fn path(&self, source: &ProgramSource, program: &Program) -> Result<JointPath, Error> {
        let robot = self.robot(source)?;
        JointPath::on_other_robot(program, &robot, self.options.path)
            .map_err(|fault| Error::plan(fault.into(), &program.sources, source.text.as_read()))
    }

    /// Starts planning a program section by section.
    ///
    /// # Errors
    ///
    /// Any [`Error`] except [`Error::File`] and [`Error::Program`].
    pub fn begin(&self, source: &ProgramSource) -> Result<Planning, Error> {
        let program = self.limited(source);
        let path = self.path(source, &program)?;
        let warnings = warnings(&program, &path);
        let (text, sources) = (source.text.clone(), program.sources.clone());
        Ok(Planning::new(&path, &self.options, warnings, text, sources))
    }

    /// Plans a whole program.
    ///
    /// # Errors
    ///
    /// As for [`begin`](Self::begin).
    pub fn plan(&self, source: &ProgramSource) -> Result<Plan, Error> {
        self.plan_with(&mut None, source, &Arc::default())
    }

    /// Plans a whole program, reusing the memory of a planner that has planned others, until `stop`
    /// is set.
    ///
    /// # Errors
    ///
    /// As for [`plan`](Self::plan).
    pub fn plan_with(
        &self,
        planner: &mut Option<Planner>,
        source: &ProgramSource,
        stop: &Arc<AtomicBool>,
    ) -> Result<Plan, Error> {
        let program = self.limited(source);
        let path = self.path(source, &program)?;
        let planner = planner.get_or_insert_with(|| {
            Planner::new(&path, self.options.timing).interrupted_by(Arc::clone(stop))
        });
        planner.restart(&path);
        let trajectory = Trajectory::by(planner)
            .map_err(|error| Error::plan(error.into(), &program.sources, source.text.as_read()))?;
        Ok(Plan { program, trajectory, options: self.options })
    }
}

/// Robot of a request. A profile describes the whole robot, whereas a built-in model leaves the
/// flange length to the program.
fn requested(robot: &Robot, program: &Program) -> Robot {
    if Robot::built_in(robot.name()).as_ref() == Some(robot) {
        program.with_flange(robot.clone())
    } else {
        robot.clone()
    }
}
