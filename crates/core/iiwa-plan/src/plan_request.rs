//! Plan requests: robot, limits and planning options.

use std::sync::{Arc, atomic::AtomicBool};

use iiwa_kin::Robot;
use iiwa_path::JointPath;
use iiwa_program::Program;
use iiwa_traj::{Planner, Trajectory};

use crate::{Error, LoadRecord, Plan, PlanOptions, Planning, ProgramSource, warnings::warnings};

/// Robot, limits and options for planning a program.
///
/// A program is planned for the robot that it names, unless the request overrides the robot.
#[derive(Clone, Debug, Default)]
pub struct PlanRequest {
    /// Robot that overrides the program's. A built-in model gets the flange length that the program
    /// states.
    pub robot: Option<Robot>,
    /// Robot for programs that name none. A flange length that the program states replaces the
    /// robot's.
    pub default_robot: Robot,
    /// Torque limit that overrides the program's, as a share of the robot's torque limits.
    pub torque_limit_rel: Option<f64>,
    /// Speed override, the factor on the speed of the whole program, in place of the program's
    /// value. 1 is full speed.
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
            .map_err(|fault| Error::of_path(fault, program, &robot, source.text.as_read()))
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
        let mut planning = Planning::new(&path, &self.options, warnings, text, sources);
        planning.figures_mut().loads = LoadRecord::all(&program);
        Ok(planning)
    }

    /// Plans a whole program.
    ///
    /// # Errors
    ///
    /// As for [`begin`](Self::begin).
    pub fn plan(&self, source: &ProgramSource) -> Result<Plan, Error> {
        self.plan_with(&mut None, source, &Arc::default())
    }

    /// Plans a whole program, and ends with an [interrupt](Error::is_interrupt) soon after `stop`
    /// is set. `planner` keeps a planner from call to call, whose memory is reused as long as the
    /// timing is the same.
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
        let timing = self.options.timing;
        let ready = match planner.take().filter(|planner| planner.timing() == timing) {
            Some(mut reused) => {
                reused.restart(&path);
                reused
            }
            None => Planner::new(&path, timing),
        };
        let planner = planner.insert(ready.interrupted_by(Arc::clone(stop)));
        let trajectory = Trajectory::by(planner)
            .map_err(|error| Error::plan(error.into(), &program.sources, source.text.as_read()))?;
        Ok(Plan { program, trajectory, options: self.options })
    }
}

/// Robot that overrides the program's. A built-in model gets the flange length that the program
/// states; any other robot keeps its own.
fn requested(robot: &Robot, program: &Program) -> Robot {
    if Robot::built_in(robot.name()).as_ref() == Some(robot) {
        program.with_flange(robot.clone())
    } else {
        robot.clone()
    }
}
