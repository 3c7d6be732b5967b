//! Arm that runs the programs of an experiment.

use iiwa_eval::experiment::Trial;
use iiwa_kin::Robot;
use iiwa_link::{
    ClientError,
    message::{MeasuredPositions, Request},
};
use iiwa_log::JointLog;
use iiwa_plan::{PlanFigures, PlanOptions};
use iiwa_report::VirtualArm;
use iiwa_twin::runs::{DriveConnection, label};

use crate::{
    connection,
    failure::{Failure, print_note},
    output,
    progress::Progress,
    runner::{execute_with_progress, go_to_start},
};

/// Virtual robot, or a robot behind a drive.
pub(crate) enum ExperimentArm {
    Virtual(Box<VirtualArm>),
    Real {
        line: Box<DriveConnection>,
        /// Velocity of motions to the start of a program, in per cent of the limits.
        to_start: f64,
    },
}

impl ExperimentArm {
    /// Runs a program of the robot `model` and returns the measured joint positions.
    pub(crate) fn run(&mut self, trial: &Trial, model: &Robot) -> Result<JointLog, Failure> {
        output::check_interrupt()?;
        match self {
            Self::Virtual(arm) => Ok(arm.run(trial)?),
            Self::Real { line, to_start } => run_real(line, *to_start, trial, model),
        }
    }
}

fn run_real(
    line: &mut DriveConnection,
    to_start: f64,
    trial: &Trial,
    model: &Robot,
) -> Result<JointLog, Failure> {
    print_note(&format!("{}\n", trial.name));
    let start_rad = trial.program.start_rad(model);
    let start_rad = start_rad.map_err(|fault| Failure::input(fault.to_string()))?;
    go_to_start(line, Some(to_start), &start_rad, model)?;
    output::check_interrupt()?;
    let how = PlanOptions::default();
    let plan = how.plan(&trial.program, model);
    let plan = plan.map_err(|error| Failure::run("cannot plan the program", &error))?;
    let label = label(&trial.name, &PlanFigures::of(&plan, &how), model);
    let request = Request::motions(trial.program.clone()).labelled(label);
    let run = execute_with_progress(line, &request, plan.cycle_time_s(), Progress::of_run());
    let measured = run.result.map_err(|error| {
        let message = match error {
            ClientError::Refused { .. } => "was not run to its end",
            // A motion continues without the drive.
            _ => "broke off, the robot may still be moving",
        };
        connection::failed(&format!("{} {message}", trial.name), &error)
    })?;
    if measured.samples_left_out > 0 {
        print_note(&format!(
            "{} samples were left out: the run was too long for the drive\n",
            measured.samples_left_out
        ));
    }
    let MeasuredPositions { t_s, joints_rad, .. } = measured.samples;
    let from_s = t_s.first().copied().unwrap_or_default();
    let mut log = JointLog::new(t_s.iter().map(|t_s| t_s - from_s).collect(), joints_rad);
    log.torques_nm = run.torques.at(&t_s);
    Ok(log)
}
