//! A simulated Sunrise cabinet of the KUKA LBR iiwa: the controller with its FRI connection, and
//! the robot program that carries out the instructions of a drive. The cabinet depends only on the
//! messages exchanged with the drive, [`iiwa_link::robot_program`] and FRI, and can simulate
//! faults: lost datagrams, delays, dropped sessions, an emergency stop.
//!
//! ```
//! use iiwa_cabinet::{Cabinet, CabinetConfig, Faults};
//! use iiwa_link::Server;
//!
//! // On free ports, with a FRI client that misses every hundredth message.
//! let mut config = CabinetConfig::default();
//! config.period_ms = 10;
//! config.instructions = "tcp://127.0.0.1:*".into();
//! config.state = "tcp://127.0.0.1:*".into();
//! config.faults = Faults::default().with_packet_loss(0.01);
//! let cabinet = Cabinet::start(config, &Server::open())?;
//! println!("instructions at {}", cabinet.instructions());
//! assert_eq!(cabinet.position(), [0.0; 7]);
//! # Ok::<(), iiwa_link::LinkError>(())
//! ```
//!
//! Source: C. Larsen, *Including a Collaborative Robot in Digital Twin Manufacturing Systems*,
//! Chalmers 2019, section 3.1.1, cited as "Larsen 2019".

mod cabinet;
mod config;
mod faulty_link;
mod fri;
mod io;
mod latency;
mod noise;
mod position_sensors;
mod program;
mod repeated;
mod report;
mod shared;
mod simulation;
mod temperatures;
mod torque_sensors;

pub use cabinet::Cabinet;
pub use config::{CabinetConfig, Faults};
pub use latency::{LateAnswer, Latency};
pub use repeated::Repeated;
pub use report::ConnectionReport;
