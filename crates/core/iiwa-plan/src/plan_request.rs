//! Requests for plans: the robot, its limits, and how a program is planned.

use std::sync::{Arc, atomic::AtomicBool};

use iiwa_kin::Robot;
use iiwa_path::JointPath;
use iiwa_program::Program;
use iiwa_traj::{Planner, Trajectory};

use crate::{Error, Plan, PlanOptions, Planning, ProgramSource, warnings::warnings};

/// Robot, limits and options for the plan of a program.
///
/// A program is planned for the robot that it names, unless the request has another one.
#[derive(Clone, Debug, Default)]
pub struct PlanRequest {
    /// Robot in place of the program's. A built-in model has the flange that the program states.
    pub robot: Option<Robot>,
    /// Robot of programs that name none, with the flange that they state.
    pub default_robot: Robot,
    /// Limit of torques in place of the program's, as a share of the robot's limits.
    pub torque_limit_rel: Option<f64>,
    /// Override of the controller in place of the program's, as a share.
    pub speed_override: Option<f64>,
    /// Options of path and timing.
    pub options: PlanOptions,
}

impl PlanRequest {
    /// The robot that a program is planned for.
    ///
    /// # Errors
    ///
    /// [`Error::UnknownRobot`] and [`Error::Profile`] if the program names a robot that cannot be read, and the request has none.
    pub fn robot(&self, source: &ProgramSource) -> Result<Robot, Error> {
        match &self.robot {
            Some(robot) => Ok(requested(robot, &source.program)),
            None => Ok(source
                .named_robot()?
                .unwrap_or_else(|| source.program.with_flange(self.default_robot.clone()))),
        }
    }

    /// A program with the limits of the request.
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

    /// Begins to plan a program section by section.
    ///
    /// # Errors
    ///
    /// Any [`Error`] but [`Error::File`] and [`Error::Program`].
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
    /// As of [`begin`](Self::begin).
    pub fn plan(&self, source: &ProgramSource) -> Result<Plan, Error> {
        self.plan_with(&mut None, source, &Arc::default())
    }

    /// Plans a whole program with the memory of a planner that has planned others, until `stop` is set.
    ///
    /// # Errors
    ///
    /// As of [`plan`](Self::plan).
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

/// The robot of a request. A profile says all of a robot, a built-in model nothing about its flange.
fn requested(robot: &Robot, program: &Program) -> Robot {
    if Robot::built_in(robot.name()).as_ref() == Some(robot) {
        program.with_flange(robot.clone())
    } else {
        robot.clone()
    }
}
