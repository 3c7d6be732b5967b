//! Inputs and outputs in programs.

use crate::{io_value::IoValue, motion_label::text_fault};

/// Longest name of an input or output, in characters.
pub const MAX_IO_NAME: usize = 200;

/// An output that the program sets, or an input that the program waits for.
///
/// ```
/// use iiwa_program::{IoEntry, IoValue, Motion, Program};
///
/// let program = Program::from_deg([0.0; 7])
///     .ptp_deg([10.0; 7])
///     .motion(Motion::Io(IoEntry::set("Gripper.Close", IoValue::Boolean(true))))
///     .motion(Motion::Io(IoEntry::wait_for("Gripper.Closed", IoValue::Boolean(true), 0.4)))
///     .build();
/// assert_eq!(program.motions[2].wait_s(), Some(0.4));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct IoEntry {
    /// Name of the input or output: on a Sunrise controller, `Group.Signal`.
    pub io: String,
    /// Value that the output gets, or that the input is to have.
    pub value: IoValue,
    /// Setting of an output, or a wait for an input.
    pub kind: IoKind,
    /// Number of preceding motions that the entry overlaps, as of a wait
    /// ([`Motion::Wait`](crate::Motion::Wait)). With 0, the robot is at rest.
    pub overlap: usize,
}

/// Kind of an entry with an input or output.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum IoKind {
    /// Sets an output, which takes no time.
    Set,
    /// Waits for an input.
    WaitFor {
        /// Assumed time until the input has the value, in s.
        seconds: f64,
    },
}

impl IoEntry {
    /// Entry that sets an output while the robot is at rest.
    #[must_use]
    pub fn set(io: impl Into<String>, value: IoValue) -> Self {
        Self { io: io.into(), value, kind: IoKind::Set, overlap: 0 }
    }

    /// Entry that waits for an input while the robot is at rest; `seconds` is the assumed time
    /// until the input has the value.
    #[must_use]
    pub fn wait_for(io: impl Into<String>, value: IoValue, seconds: f64) -> Self {
        Self { io: io.into(), value, kind: IoKind::WaitFor { seconds }, overlap: 0 }
    }

    /// Planned duration, in s: 0 for an output, the assumed time for an input.
    #[must_use]
    pub fn seconds(&self) -> f64 {
        match self.kind {
            IoKind::Set => 0.0,
            IoKind::WaitFor { seconds } => seconds,
        }
    }

    /// Key of an unsuitable name or value, with the reason.
    pub(crate) fn fault(&self) -> Option<(&'static str, String)> {
        let Self { io, value, .. } = self;
        if io.trim().is_empty() {
            return Some(("io", "`io` is empty; give the name of an input or output".to_owned()));
        }
        if io.trim() != io {
            return Some(("io", "`io` begins or ends with a space; remove the space".to_owned()));
        }
        if let Some(message) = text_fault("io", io, MAX_IO_NAME, char::is_control) {
            return Some(("io", message));
        }
        let wrong = |found: f64| {
            let message = format!("`value` is {found}; give true, false or a number");
            ("value", message)
        };
        match value {
            IoValue::Analog(found) if !found.is_finite() => Some(wrong(*found)),
            _ => None,
        }
    }
}
