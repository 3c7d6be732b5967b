//! Addresses of the processes.

use std::net::SocketAddr;

use iiwasim_tests::ports::free_address;
use serde::{Deserialize, Serialize};

/// Addresses at which the processes connect.
#[derive(Clone, Deserialize, Serialize)]
pub(crate) struct Sockets {
    pub(crate) fri: SocketAddr,
    pub(crate) instructions: String,
    pub(crate) stream: String,
    pub(crate) cabinet_instructions: String,
    pub(crate) cabinet_state: String,
}

impl Sockets {
    pub(crate) fn free() -> Self {
        let tcp = || format!("tcp://{}", free_address());
        Self {
            fri: free_address(),
            instructions: tcp(),
            stream: tcp(),
            cabinet_instructions: tcp(),
            cabinet_state: tcp(),
        }
    }
}
