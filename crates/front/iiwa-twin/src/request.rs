//! Requests of a page, as JSON. Programs are uploaded over HTTP instead, since they may be long.

use iiwa_link::message::IoValue;
use serde::Deserialize;

/// Request with a number, which its answer repeats.
#[derive(Debug, Deserialize)]
pub(crate) struct NumberedRequest {
    pub(crate) id: u64,
    #[serde(flatten)]
    pub(crate) request: PageRequest,
}

#[derive(Debug, Deserialize)]
#[serde(tag = "do", rename_all = "snake_case")]
pub(crate) enum PageRequest {
    /// Saves the current position of the arm.
    SavePosition { name: String },
    /// Removes the saved position with this id.
    RemovePosition { position: u64 },
    /// Renames the saved position with this id.
    RenamePosition { position: u64, name: String },
    /// Moves the saved position with this id by a number of places; down if positive.
    MovePosition { position: u64, by: i64 },
    /// Creates a program from the saved positions, from the first to the last, and plans it.
    MakeProgram {
        velocity_percent: f64,
        /// Blend radius at intermediate targets; with 0 the arm stops at each.
        blend_mm: f64,
    },
    /// Removes the plan.
    ClearProgram,
    /// Runs the plan with this id on the robot, if it is still the current one.
    Send { plan: u64, move_to_start: bool },
    /// Turns a joint of a simulated robot, 1 to 7.
    Jog { joint: usize, step_deg: f64 },
    /// Stops the robot on its path, whichever client started the motion.
    Stop,
    /// Sets an output.
    SetIo { name: String, value: IoValue },
}

impl PageRequest {
    /// Returns true for planning requests, which need much memory.
    pub(crate) fn is_heavy(&self) -> bool {
        matches!(self, Self::MakeProgram { .. })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn requests_are_parsed() {
        let read = serde_json::from_str::<NumberedRequest>;
        let sent = read(r#"{"id": 7, "do": "send", "plan": 3, "move_to_start": true}"#).unwrap();
        assert_eq!(sent.id, 7);
        assert!(matches!(sent.request, PageRequest::Send { plan: 3, move_to_start: true }));
        let set = read(r#"{"id": 8, "do": "set_io", "name": "a", "value": true}"#).unwrap();
        assert!(matches!(set.request, PageRequest::SetIo { value: IoValue::Boolean(true), .. }));
        for text in ["", "{}", "[]", r#"{"id": 1, "do": "jump"}"#, r#"{"id": 1, "do": "send"}"#] {
            read(text).unwrap_err();
        }
    }
}
