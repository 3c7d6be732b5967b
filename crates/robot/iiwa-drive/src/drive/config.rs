//! Configuration of a drive.

use std::net::{IpAddr, Ipv4Addr, SocketAddr};

use iiwa_kin::Robot;
use iiwa_link::{CABINET_INSTRUCTIONS_PORT, CABINET_STATE_PORT, FRI_PORT};

/// Addresses of a drive and the robot model. Set the fields that differ from the default:
///
/// ```
/// use iiwa_drive::DriveConfig;
///
/// let mut config = DriveConfig::default();
/// config.instructions = "tcp://127.0.0.1:*".into();
/// assert_eq!(config.stream, "tcp://127.0.0.1:5561");
/// ```
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct DriveConfig {
    /// The robot. Trajectories are checked against its limits.
    pub robot: Robot,
    /// Address for client requests, such as `tcp://127.0.0.1:5560`; the address for instructions to
    /// the robot program is `cabinet_instructions`.
    pub instructions: String,
    /// Address of the stream for subscribers.
    pub stream: String,
    /// UDP address for FRI messages.
    pub fri: SocketAddr,
    /// The controller address: FRI messages from other addresses are ignored.
    pub fri_controller: IpAddr,
    /// Address of the robot program for instructions.
    pub cabinet_instructions: String,
    /// Address of the robot program for state changes.
    pub cabinet_state: String,
}

impl Default for DriveConfig {
    fn default() -> Self {
        Self {
            robot: Robot::default(),
            instructions: format!("tcp://127.0.0.1:{}", iiwa_link::INSTRUCTIONS_PORT),
            stream: format!("tcp://127.0.0.1:{}", iiwa_link::STREAM_PORT),
            fri: SocketAddr::from(([127, 0, 0, 1], FRI_PORT)),
            fri_controller: IpAddr::V4(Ipv4Addr::LOCALHOST),
            cabinet_instructions: format!("tcp://127.0.0.1:{CABINET_INSTRUCTIONS_PORT}"),
            cabinet_state: format!("tcp://127.0.0.1:{CABINET_STATE_PORT}"),
        }
    }
}
