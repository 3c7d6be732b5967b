//! Program and its plan.

use iiwa_kin::{Pose, Robot};
use iiwa_plan::{Error, Plan, PlanOptions, PlanRequest, ProgramSource};
use iiwa_program::Fault;
use iiwa_traj::{JerkOptions, PlanError, State, SweepOptions, Timing, Trajectory};
use serde::{Deserialize, Serialize};

use crate::failure::{CallFailure, FailureKind};

/// Planning options.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Choices {
    /// Set of active limits.
    pub(crate) timing: ChosenTiming,
    /// Samples per blend with acceleration limits.
    pub(crate) samples: u32,
    /// Torque limit, in percent of the robot's; `None` keeps the program's own limit.
    pub(crate) limit_torque_percent: Option<f64>,
}

/// Set of active limits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum ChosenTiming {
    Jerk,
    Acceleration,
    Sunrise,
}

/// Default planning options.
impl Default for Choices {
    fn default() -> Self {
        Self { timing: ChosenTiming::Sunrise, samples: 100, limit_torque_percent: None }
    }
}

impl Choices {
    /// Converts the options for the planner.
    fn plan_options(&self) -> Result<PlanOptions, CallFailure> {
        if !(2..=100_000).contains(&self.samples) {
            let samples = self.samples;
            let message = format!("{samples} samples per blend; it must be from 2 to 100000");
            return Err(CallFailure::argument(message));
        }
        let timing = match self.timing {
            ChosenTiming::Jerk => Timing::jerk_limited(),
            ChosenTiming::Sunrise => Timing::Sunrise(JerkOptions::default()),
            ChosenTiming::Acceleration => {
                Timing::Acceleration(SweepOptions { samples: self.samples as usize })
            }
        };
        Ok(PlanOptions { samples: self.samples, ..PlanOptions::with_timing(timing) })
    }
}

/// Program and its plan.
#[derive(Debug)]
pub(crate) struct PlannedProgram {
    /// Complete text of the program.
    pub(crate) program: String,
    pub(crate) choices: Choices,
    plan: Plan,
}

impl PlannedProgram {
    /// Plans a program for `robot`, or for the robot that the program names.
    pub(crate) fn new(
        source: &ProgramSource,
        robot: Option<Robot>,
        choices: Choices,
    ) -> Result<Self, CallFailure> {
        let request = PlanRequest {
            robot,
            torque_limit_rel: choices.limit_torque_percent.map(|percent| percent / 100.0),
            options: choices.plan_options()?,
            ..PlanRequest::default()
        };
        let plan = request.plan(source).map_err(|error| match &error {
            // The torque limit was given as an option, not by the program.
            Error::Plan { error: plan, message, .. }
                if choices.limit_torque_percent.is_some() && is_torque_limit(plan) =>
            {
                CallFailure::argument(message.clone())
            }
            _ => error.into(),
        })?;
        Ok(Self { program: source.text.complete().to_owned(), choices, plan })
    }

    pub(crate) fn trajectory(&self) -> &Trajectory {
        &self.plan.trajectory
    }

    pub(crate) fn robot(&self) -> &Robot {
        self.plan.robot()
    }

    /// Figures as a JSON object, with the warnings.
    pub(crate) fn figures_json(&self) -> Result<String, CallFailure> {
        to_json(&self.plan.figures())
    }

    /// TCP pose in the robot's base frame, for the tool of the state's motion.
    pub(crate) fn tcp(&self, state: &State) -> Pose {
        self.robot().flange_pose(&state.q).then(self.trajectory().path().tcp(state.motion))
    }
}

fn is_torque_limit(error: &PlanError) -> bool {
    matches!(error, PlanError::Fault(Fault::TorqueLimit { .. }))
}

/// Converts a value to JSON.
pub(crate) fn to_json(value: &impl Serialize) -> Result<String, CallFailure> {
    serde_json::to_string(value)
        .map_err(|error| CallFailure::new(FailureKind::Internal, error.to_string()))
}
