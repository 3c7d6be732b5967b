//! Who may connect: CURVE keys, the list of clients that are let in, and the rule on addresses.
//!
//! On the loopback interface keys are optional; on any other address nothing is bound and nothing
//! is connected without them. A server's sockets are [`GuardedSocket`]s, which keep both promises:
//! with keys they cannot outlive the [`Authenticator`] that checks the clients, without keys they
//! bind to loopback only.
//!
//! ```no_run
//! use std::path::Path;
//! use iiwa_link::security::{Authenticator, Endpoint, ServerSecurity};
//!
//! # fn main() -> Result<(), iiwa_link::security::SecurityError> {
//! let context = zmq::Context::new();
//! let security = ServerSecurity::read(Path::new("drive.key"), Path::new("clients"))?;
//! let authenticator = Authenticator::start(&context, security)?;
//! let requests = authenticator.socket(zmq::ROUTER)?;
//! requests.bind(&"tcp://0.0.0.0:5560".parse::<Endpoint>()?)?;
//! # Ok(())
//! # }
//! ```
//!
//! Keys and their exchange are those of ZMTP's CURVE (RFC 26), clients are checked by ZAP (RFC 27).

mod allow;
mod authenticator;
mod client;
mod endpoint;
mod error;
mod file;
mod guarded;
mod key;
mod server;
mod watched;
mod z85;
mod zap;

pub use allow::AllowList;
pub use authenticator::Authenticator;
pub use client::{ClientSecurity, connect};
pub use endpoint::Endpoint;
pub use error::{KeyTextError, SecurityError};
pub use guarded::GuardedSocket;
pub use key::{KeyPair, PublicKey, has_curve, require_curve};
pub use server::ServerSecurity;
pub use watched::{Handshake, WatchedSocket};
