//! Who may connect: CURVE keys, the list of clients that are let in, and the rule on addresses.
//!
//! On the loopback interface keys are optional; on any other address nothing is bound and nothing
//! is connected without them.
//!
//! ```no_run
//! use std::path::Path;
//! use iiwa_link::{Server, security::ServerSecurity};
//!
//! # fn main() -> Result<(), iiwa_link::security::SecurityError> {
//! let security = ServerSecurity::read(Path::new("drive.key"), Path::new("clients"))?;
//! let server = Server::with_keys(security);
//! # Ok(())
//! # }
//! ```
//!
//! Keys and their exchange are those of ZMTP's CURVE (RFC 26).

mod allow;
mod client;
mod endpoint;
mod error;
mod file;
mod key;
mod refusals;
mod refused;
mod server;
mod z85;

pub use allow::AllowList;
pub use client::ClientSecurity;
pub use endpoint::Endpoint;
pub use error::{KeyTextError, SecurityError};
pub use key::{KeyPair, PublicKey};
pub use refused::Refused;
pub use server::ServerSecurity;
