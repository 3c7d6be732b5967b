//! Labels of requested runs.

use iiwa_kin::Robot;
use serde::{Deserialize, Serialize};

use crate::message::{refusal::Refusal, robot_identity::RobotIdentity, text::to_json};

/// Maximum length of a label, in bytes of JSON.
pub const MAX_LABEL_BYTES: usize = 16 << 10;

/// Label of a requested run. The drive refuses the run if it was planned for another robot, and
/// publishes the rest of the label without interpretation.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RunLabel {
    /// Name of the program.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub program: Option<String>,
    /// The robot that the run was planned for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub planned_for: Option<RobotIdentity>,
    /// The client's plan of the run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub plan: Option<RunPlan>,
}

impl RunLabel {
    /// Creates a label that contains the robot only.
    #[must_use]
    pub fn of_robot(robot: &Robot) -> Self {
        Self { planned_for: Some(RobotIdentity::from(robot)), ..Self::default() }
    }

    /// Returns true if the label is empty.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// Checks the length.
    ///
    /// # Errors
    ///
    /// [`Code::BadRequest`](crate::message::Code::BadRequest) if the label is longer than
    /// [`MAX_LABEL_BYTES`].
    pub(crate) fn check(self) -> Result<Self, Refusal> {
        // As published: subscribers bound the length of run messages by this maximum.
        let bytes = to_json(&self).len();
        if bytes > MAX_LABEL_BYTES {
            return Err(Refusal::bad(format!(
                "the label has {bytes} bytes; at most {MAX_LABEL_BYTES} are allowed"
            )));
        }
        Ok(self)
    }
}

/// A plan of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RunPlan {
    /// Planned cycle time, in s.
    pub cycle_time_s: f64,
    /// Limit that is active for the largest share of each motion, if any.
    #[serde(default)]
    pub limited_by: Vec<BindingLimit>,
}

/// A limit that is active in a motion of a plan.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BindingLimit {
    /// Index of the motion, from 1.
    pub motion: usize,
    /// Index of the joint, from 1; `None` for a TCP limit.
    pub joint: Option<usize>,
    /// Kind of limit, such as `velocity`.
    pub kind: String,
    /// Share of the motion's duration for which the limit is active, 0 to 1.
    pub share: f64,
}
