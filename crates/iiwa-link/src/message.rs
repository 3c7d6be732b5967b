//! The messages between clients and iiwaDrive, in JSON.

mod io;
mod refusal;
mod reply;
mod request;
mod text;

pub use io::IoValue;
pub use refusal::{Code, Refusal};
pub use reply::{Body, DriveState, FriStatus, Presence, Reply, Run, Samples, Sensors, Status};
pub use request::{Id, Request};
pub(crate) use text::{Figures, bad_json, from_json, shortened, to_json};

/// Longest message that is taken, in bytes: a trajectory of some 400 000 points. A peer that sends a
/// longer one is disconnected.
pub const MAX_MESSAGE_BYTES: usize = 64 * 1024 * 1024;
