//! iiwaDrive: the layer between the KUKA LBR iiwa, or a simulated one, and its clients.
//!
//! A [`Drive`] stands between the robot and any number of clients. The robot is a Sunrise cabinet with
//! its FRI connection and a robot program, or a simulated [`Cabinet`].
//!
//! ```text
//! clients                    drive                        cabinet
//! Client  REQ  --requests--> ROUTER      DEALER --instructions--> REP   robot program
//! Stream  SUB  <--joints---- PUB            REP <--state changes- DEALER
//!                                           UDP <------FRI------> UDP   controller
//! ```
//!
//! ```no_run
//! use iiwa_drive::{Drive, DriveConfig};
//! use iiwa_link::{Remote, Server};
//!
//! let drive = Drive::start(DriveConfig::default(), &Server::open(), &Remote::open())?;
//! println!("requests are taken at {}", drive.instructions());
//! # Ok::<(), iiwa_link::LinkError>(())
//! ```
//!
//! Source: C. Larsen, *Including a Collaborative Robot in Digital Twin Manufacturing Systems*,
//! Chalmers 2019, chapter 3, cited as "Larsen 2019".

mod braking;
mod cabinet;
mod drive;
mod playback;
mod priority;
mod robot_program;

pub use cabinet::{Cabinet, CabinetConfig, Faults, Late, Latency, Report};
pub use drive::{Drive, DriveConfig, Punctuality};

/// Where a drive listens to FRI, over UDP: the first of those that KUKA sets aside.
pub const FRI_PORT: u16 = 30200;
/// Where a robot program takes instructions.
pub const CABINET_INSTRUCTIONS_PORT: u16 = 30001;
/// Where a robot program tells its state.
pub const CABINET_STATE_PORT: u16 = 30002;
