//! Access control: CURVE keys, the list of permitted clients, and the addresses that require keys.
//!
//! On the loopback interface, keys are optional. Without keys, no other address is bound or
//! connected to.
//!
//! ```no_run
//! use std::path::Path;
//!
//! use iiwa_link::{Server, security::ServerSecurity};
//!
//! # fn main() -> Result<(), iiwa_link::security::SecurityError> {
//! let security = ServerSecurity::read(Path::new("drive.key"), Path::new("clients"))?;
//! let server = Server::with_keys(security);
//! # Ok(())
//! # }
//! ```
//!
//! Keys and handshakes follow `CurveZMQ` (`ZeroMQ` RFC 26).

mod allow;
mod client;
mod connection_refusal;
mod endpoint;
mod error;
mod file;
mod key;
mod refusal_log;
mod server;
mod z85;

pub use allow::AllowList;
pub use client::ClientSecurity;
pub use connection_refusal::ConnectionRefusal;
pub use endpoint::Endpoint;
pub use error::{KeyTextError, SecurityError};
pub use key::{KeyPair, PublicKey};
pub use server::ServerSecurity;
