//! iiwaDrive, a server process (not a servo drive): connects the KUKA LBR iiwa, or a simulated one,
//! to clients.
//!
//! A [`Drive`] serves clients over the network; the crate `iiwa-link` contains these clients. The
//! drive talks to the Sunrise controller over FRI, and to the robot program, the Java application
//! of the folder `sunrise` that runs on the controller. The simulated cabinet of the crate
//! `iiwa-cabinet` replaces both.
//!
//! Clients, drive and robot program are connected by `ZeroMQ` sockets (REQ, ROUTER and so on), the
//! controller by UDP:
//!
//! ```text
//! clients                    drive                        cabinet
//! Client  REQ  --requests--> ROUTER      DEALER --instructions--> REP   robot program
//! Stream  SUB  <--joints---- PUB            REP <--state changes- DEALER
//!                                           UDP <------FRI------> UDP   controller
//! ```
//!
//! A drive without keys (`open`), for this machine only; its address for requests is called
//! `instructions`:
//!
//! ```no_run
//! use iiwa_drive::{Drive, DriveConfig};
//! use iiwa_link::{Remote, Server};
//!
//! let drive = Drive::start(DriveConfig::default(), &Server::open(), &Remote::open())?;
//! println!("requests at {}", drive.instructions());
//! # Ok::<(), iiwa_link::LinkError>(())
//! ```
//!
//! A drive with a simulated cabinet, on free ports:
//!
//! ```
//! use iiwa_cabinet::{Cabinet, CabinetConfig};
//! use iiwa_drive::{Drive, DriveConfig};
//! use iiwa_link::{Remote, Server};
//!
//! let any = || "tcp://127.0.0.1:*".to_owned();
//! # let udp = std::net::UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
//! let mut config = CabinetConfig::default();
//! config.fri_client = udp; // a free UDP address
//! config.instructions = any();
//! config.state = any();
//! let cabinet = Cabinet::start(config, &Server::open())?;
//!
//! let mut config = DriveConfig::default();
//! config.instructions = any();
//! config.stream = any();
//! config.fri = udp;
//! config.cabinet_instructions = cabinet.instructions().to_owned();
//! config.cabinet_state = cabinet.state().to_owned();
//! let drive = Drive::start(config, &Server::open(), &Remote::open())?;
//! assert_eq!(drive.fri(), udp);
//! # Ok::<(), iiwa_link::LinkError>(())
//! ```
//!
//! Source: C. Larsen, *Including a Collaborative Robot in Digital Twin Manufacturing Systems*,
//! Chalmers 2019, chapter 3, cited as "Larsen 2019".

mod drive;

pub use drive::{AnswerLatency, CheckStep, Drive, DriveConfig, LinkCheck, StepResult};
