//! Schemas of the JSON topics.
//!
//! Viewers support a subset of JSON Schema: every field has one type, and arrays cannot be nested.

use serde_json::{Value, json};

/// Returns the schema of `/drive_state`: iiwaDrive's reply to the request `state`.
pub(super) fn drive_state() -> Value {
    object(&json!({
        "state": { "type": "string", "description": "idle, running_motion or running_trajectory" },
        "joints_rad": joints("Measured joint positions, rad"),
        "t_s": { "type": "number", "description": "When they were measured, s" },
        "fri": object(&json!({
            "session": { "type": "string", "description": "State of the session, or silent" },
            "quality": { "type": "string", "description": "poor, fair, good or excellent" },
            "lost": { "type": "integer", "description": "Messages that did not arrive" },
            "late": { "type": "integer", "description": "Messages that came after a younger one" },
        })),
        "robot_program": { "type": "string", "description": "silent or connected" },
    }))
}

/// Returns the schema of `/sensors`.
pub(super) fn sensors() -> Value {
    object(&json!({
        "joint_temperature_c": joints("Temperatures of the joints, degrees Celsius"),
        "external_torque_nm": joints("Torques from outside, Nm"),
    }))
}

/// Returns the schema of `/inputs_outputs`.
pub(super) fn inputs_outputs() -> Value {
    object(&json!({
        "values": {
            "type": "array",
            "items": object(&json!({
                "name": { "type": "string" },
                "value": { "type": "number", "description": "0 or 1 for what is off or on" },
            })),
        },
    }))
}

fn object(properties: &Value) -> Value {
    json!({ "type": "object", "properties": properties })
}

fn joints(description: &str) -> Value {
    json!({ "type": "array", "items": { "type": "number" }, "description": description })
}
