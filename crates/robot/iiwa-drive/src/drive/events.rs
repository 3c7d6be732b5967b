//! Messages between the FRI thread and the dispatcher.

use std::{fmt, net::IpAddr, time::Instant};

use iiwa_fri::{Quality, Safety, SessionState};
use iiwa_kin::Joints;
use iiwa_link::{TimedJoints, message::DriveState, robot_program::RunId};

use super::setpoints::{TrajectoryEnd, TrajectoryTask};

/// A command to the FRI thread.
pub(super) enum FriCommand {
    /// Run this trajectory once the session commands.
    Run(RunId, Box<TimedJoints>),
    /// Stop the trajectory on its path.
    Stop,
    /// Discard the trajectory; if the robot moves, after a stop on its path.
    Release,
    /// Publish a state.
    Publish(DriveState),
}

/// An event of the FRI thread.
#[expect(
    clippy::large_enum_variant,
    reason = "nearly all events are observations, and the real-time thread does not allocate"
)]
pub(super) enum FriEvent {
    /// A message of the controller has arrived.
    Observed(Observation),
    /// A message has arrived from an unexpected address, while none arrives from the controller
    /// address.
    Unexpected(UnexpectedSource),
    /// The trajectory has ended.
    Ended(TrajectoryEnd),
    /// A trajectory was discarded by a stop before it began.
    Discarded,
    /// A finished task, to be freed outside the real-time thread.
    Freed(#[expect(dead_code, reason = "it is freed")] TrajectoryTask),
}

/// The source address of FRI messages that do not come from the controller address.
#[derive(Clone, Copy, Debug)]
pub(super) struct UnexpectedSource {
    pub(super) from: IpAddr,
    pub(super) expected: IpAddr,
    /// Arrival time of the message.
    pub(super) at: Instant,
}

impl fmt::Display for UnexpectedSource {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { from, expected, .. } = self;
        write!(f, "from {from}, expected {expected} (setting fri-cabinet of the drive)")
    }
}

/// State of the robot and the connection in a controller message.
#[derive(Clone, Copy, Debug)]
pub(super) struct Observation {
    /// Stream time, in s.
    pub(super) t_s: f64,
    /// Lead of the controller clock over the stream time, in s.
    pub(super) clock_ahead_s: f64,
    /// Measured joint positions, in rad.
    pub(super) joints_rad: Joints,
    /// Commanded joint positions, in rad, if the controller sends them.
    pub(super) commanded_rad: Option<Joints>,
    /// Measured and external torques, in Nm, if the controller sends them.
    pub(super) torques_nm: Option<[Joints; 2]>,
    pub(super) session: SessionState,
    pub(super) quality: Quality,
    pub(super) safety: Safety,
    /// Number of lost messages so far.
    pub(super) lost: u64,
    /// Number of late messages so far.
    pub(super) late: u64,
    /// Arrival time of the message.
    pub(super) at: Instant,
}
