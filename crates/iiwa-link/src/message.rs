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
pub use text::{Figures, bad_json, from_json, shortened, to_json};

/// Longest request that is taken, in bytes: a trajectory of 200 000 points with all their digits. A peer
/// that sends a longer one is disconnected.
pub const MAX_MESSAGE_BYTES: usize = 32 << 20;

/// Longest reply, in bytes: that to a run of [`MAX_SAMPLES`].
pub const MAX_REPLY_BYTES: usize = 64 << 20;

/// Most samples that are kept of a run: five minutes at 1 ms, half an hour at 5 ms. The stream has more.
pub const MAX_SAMPLES: usize = 300_000;

/// Longest request that is not a trajectory or a list of motions, in bytes.
pub const MAX_SHORT_REQUEST_BYTES: usize = 64 << 10;

/// Longest request that is not a trajectory, in bytes.
pub const MAX_MOTIONS_BYTES: usize = 4 << 20;

/// Most motions of one request.
pub const MAX_MOTIONS: usize = 5000;
