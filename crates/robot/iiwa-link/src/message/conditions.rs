//! State of the robot program and the controller: versions, operation mode, override, safety stop,
//! tool.

use std::fmt;

use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::message::{robot_identity::RobotIdentity, text::shortened};

/// Version and robot of a robot program.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Hello {
    /// Version of the protocol between drive and robot program; see
    /// [`PROTOCOL`](crate::robot_program::PROTOCOL).
    pub protocol: u32,
    /// Name and version of the robot program.
    pub program: String,
    /// Sunrise version.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sunrise: Option<String>,
    /// The robot at the cabinet, if known to the robot program.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub robot: Option<RobotIdentity>,
}

impl Hello {
    /// Creates a description of a robot program with this protocol version.
    #[must_use]
    pub fn new(protocol: u32, program: impl Into<String>) -> Self {
        Self { protocol, program: program.into(), sunrise: None, robot: None }
    }
}

/// Controller conditions, as far as the robot program knows them.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Conditions {
    /// The operation mode.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub operation_mode: Option<OperationMode>,
    /// Velocity override of the controller, from 0 to 1.
    #[serde(default, rename = "override", skip_serializing_if = "Option::is_none")]
    pub override_rel: Option<f64>,
    /// `true` if the safety controller demands a stop.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub safety_stop: Option<bool>,
    /// Name of the attached tool.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tool: Option<String>,
}

impl Conditions {
    /// Describes the known conditions as text; empty if all are unknown.
    #[must_use]
    pub fn text(&self) -> String {
        let mode = self.operation_mode.as_ref().map(|mode| format!("mode {mode}"));
        let slowed = self.override_rel.map(|share| format!("override {}", percent(share)));
        let safety = self.safety_stop.map(|stop| {
            let text = if stop { "safety stop" } else { "no safety stop" };
            text.to_owned()
        });
        let tool = self.tool.as_ref().map(|tool| format!("tool {}", shortened(tool)));
        let parts: Vec<_> = [mode, slowed, safety, tool].into_iter().flatten().collect();
        parts.join(", ")
    }

    /// Returns the reason why runs take longer than planned under these conditions, if any.
    #[must_use]
    pub fn caution(&self) -> Option<String> {
        let slowed = self.override_rel.filter(|share| *share < 1.0);
        let slowed = slowed.map(|share| format!("the override is {}", percent(share)));
        let limited = (self.operation_mode == Some(OperationMode::T1))
            .then(|| "the operation mode is T1, which limits velocities".to_owned());
        let causes: Vec<_> = slowed.into_iter().chain(limited).collect();
        (!causes.is_empty())
            .then(|| format!("{}: the program takes longer than planned", causes.join(", and ")))
    }
}

/// Formats a share in per cent, such as `100 %`.
fn percent(share: f64) -> String {
    // At most one decimal, omitted if zero.
    format!("{} %", (share * 1e3).round() / 10.0)
}

/// Operation mode of the controller.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum OperationMode {
    /// Manual, with reduced velocity.
    T1,
    /// Manual.
    T2,
    /// Automatic.
    Aut,
    /// Another mode, by its name in the robot program.
    Other(String),
}

impl OperationMode {
    /// Returns the name in JSON.
    #[must_use]
    pub fn name(&self) -> &str {
        match self {
            Self::T1 => "t1",
            Self::T2 => "t2",
            Self::Aut => "aut",
            Self::Other(name) => name,
        }
    }
}

impl fmt::Display for OperationMode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            // The name is external text, of any length and with any characters.
            Self::Other(name) => f.pad(&shortened(name)),
            known => f.pad(&known.name().to_ascii_uppercase()),
        }
    }
}

impl Serialize for OperationMode {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

impl<'de> Deserialize<'de> for OperationMode {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let name = String::deserialize(deserializer)?;
        Ok(match name.as_str() {
            "t1" => Self::T1,
            "t2" => Self::T2,
            "aut" => Self::Aut,
            // Kept: an error would discard the whole state change for an unknown mode.
            _ => Self::Other(name),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unknown_modes_keep_their_names() {
        let conditions: Conditions =
            serde_json::from_str(r#"{"operation_mode": "krf", "override": 0.5, "more": 1}"#)
                .unwrap();
        assert_eq!(conditions.operation_mode, Some(OperationMode::Other("krf".into())));
        assert_eq!(
            serde_json::to_string(&conditions).unwrap(),
            r#"{"operation_mode":"krf","override":0.5}"#
        );
    }

    #[test]
    fn only_conditions_that_slow_the_robot_are_cautioned() {
        let caution = |text: &str| serde_json::from_str::<Conditions>(text).unwrap().caution();
        assert_eq!(caution("{}"), None);
        assert_eq!(caution(r#"{"operation_mode": "aut", "override": 1.0, "tool": "x"}"#), None);
        assert_eq!(
            caution(r#"{"operation_mode": "t1", "override": 0.305}"#).unwrap(),
            "the override is 30.5 %, and the operation mode is T1, which limits velocities: the \
             program takes longer than planned"
        );
    }
}
