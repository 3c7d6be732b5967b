//! Client library of iiwaDrive, the network interface of the KUKA LBR iiwa: messages, requests, the
//! measurement stream, and CURVE keys. The library contains neither a planner nor a drive.
//!
//! A drive connects the robot to any number of clients. A [`Client`] sends requests, such as to run
//! motions and trajectories; a [`Stream`] receives the robot's measurements. Messages are JSON over
//! `ZeroMQ` (ZMTP 3.1). Joint positions are `[f64; 7]`, A1 to A7, in rad; times are in s.
//!
//! ```text
//! clients                    drive
//! Client  REQ  --requests--> ROUTER
//! Stream  SUB  <--joints---- PUB
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
//! Trajectories can be checked before they are sent:
//!
//! ```
//! use iiwa_kin::Robot;
//! use iiwa_link::{TimedJoints, message::Code};
//!
//! // A step of 0.1 rad within 10 ms.
//! let trajectory =
//!     TimedJoints { t_s: vec![0.0, 0.01], joints_rad: vec![[0.0; 7], [0.1; 7]] };
//! let refusal = trajectory.check(Robot::default().limits(), &[0.0; 7]).unwrap_err();
//! assert_eq!(refusal.code, Code::Limit);
//! ```
//!
//! Source: C. Larsen, *Including a Collaborative Robot in Digital Twin Manufacturing Systems*,
//! Chalmers 2019, chapter 3, cited as "Larsen 2019".

mod client;
mod error;
mod lag;
pub mod message;
pub mod robot_program;
pub mod security;
pub mod socket;
mod start_offset;
mod stream;
pub mod threads;
mod timed_joints;
mod torques;
pub mod transport;

pub use client::{Client, ClientError};
pub use error::LinkError;
pub use lag::Lag;
pub use socket::{Remote, Server};
pub use start_offset::StartOffset;
pub use stream::{Published, Stream};
pub use timed_joints::{MARGINS, MAX_POINTS, MAX_STEP_S, START_TOLERANCE_RAD, TimedJoints};
pub use torques::Torques;

/// Default TCP port of a drive for requests.
pub const INSTRUCTIONS_PORT: u16 = 5560;
/// Default TCP port of a drive for its stream.
pub const STREAM_PORT: u16 = 5561;
/// Default UDP port of a drive for FRI: the first port that KUKA reserves for FRI.
pub const FRI_PORT: u16 = 30200;
/// Default TCP port of a robot program for instructions.
pub const CABINET_INSTRUCTIONS_PORT: u16 = 30001;
/// Default TCP port of a robot program for state changes.
pub const CABINET_STATE_PORT: u16 = 30002;
