//! What people tell the twin to do, on the page. Programs come another way: they may be long.

use iiwa_link::message::IoValue;
use serde::Deserialize;

/// An order with a number, which its answer bears, too.
#[derive(Debug, Deserialize)]
pub(super) struct Numbered {
    pub(super) id: u64,
    #[serde(flatten)]
    pub(super) order: Order,
}

#[derive(Debug, Deserialize)]
#[serde(tag = "do", rename_all = "snake_case")]
pub(super) enum Order {
    /// Where the arm is now becomes a position.
    SavePosition { name: String },
    /// Forgets a position.
    RemovePosition { position: u64 },
    /// Makes a program of the positions, from the first to the last, and plans it.
    MakeProgram {
        velocity_percent: f64,
        /// Of the targets in between; 0 stops at each.
        blend_mm: f64,
    },
    /// Forgets the plan.
    ClearProgram,
    /// Has the robot run the plan, the one that was looked at.
    Send { plan: u64, move_to_start: bool },
    /// Stops the robot on its path, whatever client made it move.
    Stop,
    /// Sets an output.
    SetIo { name: String, value: IoValue },
}

impl Order {
    /// Whether it plans.
    pub(super) fn is_heavy(&self) -> bool {
        matches!(self, Self::MakeProgram { .. })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn orders_are_read() {
        let read = serde_json::from_str::<Numbered>;
        let sent = read(r#"{"id": 7, "do": "send", "plan": 3, "move_to_start": true}"#).unwrap();
        assert_eq!(sent.id, 7);
        assert!(matches!(sent.order, Order::Send { plan: 3, move_to_start: true }));
        let set = read(r#"{"id": 8, "do": "set_io", "name": "a", "value": true}"#).unwrap();
        assert!(matches!(set.order, Order::SetIo { value: IoValue::Boolean(true), .. }));
        for text in ["", "{}", "[]", r#"{"id": 1, "do": "jump"}"#, r#"{"id": 1, "do": "send"}"#] {
            read(text).unwrap_err();
        }
    }
}
