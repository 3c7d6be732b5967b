//! JSON messages between clients and iiwaDrive.

pub(crate) mod conditions;
pub(crate) mod io;
pub(crate) mod refusal;
pub(crate) mod reply;
pub(crate) mod request;
pub(crate) mod robot_identity;
pub(crate) mod run_event;
pub(crate) mod run_label;
pub(crate) mod status_text;
pub(crate) mod text;

pub use conditions::{Conditions, Hello, OperationMode};
pub use io::{Direction, IoValue, Signal};
pub use refusal::{Code, Refusal};
pub use reply::{
    DriveState, DriveStatus, FriStatus, MeasuredPositions, Presence, Reply, ReplyBody, Run,
    Sensors, TimedBy,
};
pub use request::{Id, Request, RequestHead};
pub use robot_identity::{LengthsMm, RobotIdentity};
pub use run_event::{RunEnd, RunEvent};
pub use run_label::{BindingLimit, MAX_LABEL_BYTES, RunLabel, RunPlan};
pub use status_text::Degrees;
pub use text::{Figures, bad_json, from_json, shortened, to_json};

/// Maximum length of a request, in bytes: a trajectory of 200 000 points at full precision. A peer
/// that sends a longer request is disconnected.
pub const MAX_MESSAGE_BYTES: usize = 32 << 20;

/// Maximum length of a reply, in bytes: the reply of a run with [`MAX_SAMPLES`].
pub const MAX_REPLY_BYTES: usize = 64 << 20;

/// Maximum number of samples stored per run: five minutes at 1 ms, 25 minutes at 5 ms. The stream
/// is not limited.
pub const MAX_SAMPLES: usize = 300_000;

/// Maximum length of a request other than a trajectory or a list of motions, in bytes.
pub const MAX_SHORT_REQUEST_BYTES: usize = 64 << 10;

/// Maximum length of a list of motions, in bytes.
pub const MAX_MOTIONS_BYTES: usize = 4 << 20;

/// Maximum number of motions per request.
pub const MAX_MOTIONS: usize = 5000;
