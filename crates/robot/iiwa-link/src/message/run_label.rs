//! What clients state about the runs that they request.

use iiwa_kin::Robot;
use serde::{Deserialize, Serialize};

use crate::message::{refusal::Refusal, robot_identity::RobotIdentity, text::to_json};

/// Longest label, in bytes of JSON.
pub const MAX_LABEL_BYTES: usize = 16 << 10;

/// Statements of a client about a run that it requests. The drive refuses the run if it was planned for another robot than its own, and
/// publishes the rest unread.
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
    /// A label that states the robot only.
    #[must_use]
    pub fn of_robot(robot: &Robot) -> Self {
        Self { planned_for: Some(RobotIdentity::from(robot)), ..Self::default() }
    }

    /// Whether it states nothing.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// Checks the length.
    ///
    /// # Errors
    ///
    /// [`Code::BadRequest`](crate::message::Code::BadRequest) if it is longer than [`MAX_LABEL_BYTES`].
    pub(crate) fn check(self) -> Result<Self, Refusal> {
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
    /// The planned cycle time, in s.
    pub cycle_time_s: f64,
    /// The limit that binds for the longest time of each motion, where one does.
    #[serde(default)]
    pub limited_by: Vec<BindingLimit>,
}

/// A limit that binds in a motion of a plan.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BindingLimit {
    /// The motion, from 1.
    pub motion: usize,
    /// The joint, from 1; `None` for a limit of the TCP.
    pub joint: Option<usize>,
    /// The kind of limit, such as `velocity`.
    pub kind: String,
    /// The share of the motion's time for which it binds, 0 to 1.
    pub share: f64,
}
