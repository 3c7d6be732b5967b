//! What a client of a drive for the KUKA LBR iiwa needs: messages, requests, the stream, keys. It holds no
//! planner and moves no robot: that is what the drive is for.
//!
//! A drive stands between the robot and any number of clients. A [`Client`] asks it to run motions and
//! trajectories; a [`Stream`] follows the robot.
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
//! Source: C. Larsen, *Including a Collaborative Robot in Digital Twin Manufacturing Systems*,
//! Chalmers 2019, chapter 3, cited as "Larsen 2019".

mod client;
mod error;
pub mod message;
pub mod security;
pub mod socket;
mod stream;
mod timed_joints;
pub mod transport;

pub use client::{Client, ClientError};
pub use error::LinkError;
pub use socket::{Remote, Server};
pub use stream::{Published, Stream};
pub use timed_joints::{MARGINS, MAX_POINTS, MAX_STEP_S, START_TOLERANCE_RAD, TimedJoints};

/// Where a drive takes requests.
pub const INSTRUCTIONS_PORT: u16 = 5560;
/// Where a drive publishes.
pub const STREAM_PORT: u16 = 5561;
