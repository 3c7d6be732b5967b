//! iiwaDrive: monitor and command the KUKA LBR iiwa, or a simulated one, over the network.
//!
//! A [`Drive`] stands between the robot and any number of clients. The robot is a Sunrise cabinet with
//! its FRI connection and a robot program, or a simulated [`Cabinet`]. A [`Client`] asks the drive to
//! run motions and trajectories; a [`Stream`] follows the robot.
//!
//! ```text
//! clients                    drive                        cabinet
//! Client  REQ  --requests--> ROUTER      DEALER --instructions--> REP   robot program
//! Stream  SUB  <--joints---- PUB            REP <--state changes- DEALER
//!                                           UDP <------FRI------> UDP   controller
//! ```
//!
//! ```no_run
//! use iiwa_link::{Client, Remote};
//!
//! let mut client = Client::new(&Remote::open(), "tcp://127.0.0.1:5560")?;
//! println!("the robot is {}", client.state()?.state);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Source: C. Larsen, *Including a Collaborative Robot in Digital Twin Manufacturing Systems*,
//! Chalmers 2019, chapter 3, cited as "Larsen 2019".

mod braking;
mod cabinet;
mod client;
mod drive;
mod error;
pub mod fri;
pub mod message;
mod playback;
mod priority;
mod robot_program;
pub mod security;
mod socket;
mod stream;
mod timed_joints;
mod transport;

pub use cabinet::{Cabinet, CabinetConfig, Faults, Late, Latency, Report};
pub use client::{Client, ClientError};
pub use drive::{Drive, DriveConfig, Punctuality};
pub use error::LinkError;
pub use socket::{Remote, Server};
pub use stream::{Published, Stream};
pub use timed_joints::{MARGINS, MAX_POINTS, MAX_STEP_S, START_TOLERANCE_RAD, TimedJoints};

/// Where a drive takes requests.
pub const INSTRUCTIONS_PORT: u16 = 5560;
/// Where a drive publishes.
pub const STREAM_PORT: u16 = 5561;
/// Where a drive listens to FRI, over UDP: the first of those that KUKA sets aside.
pub const FRI_PORT: u16 = 30200;
/// Where a robot program takes instructions.
pub const CABINET_INSTRUCTIONS_PORT: u16 = 30001;
/// Where a robot program tells its state.
pub const CABINET_STATE_PORT: u16 = 30002;
