//! What it takes to be connected to, and to connect.

use std::{hash::BuildHasher, io};

use omq_proto::{MechanismSetup, SocketType, proto::Role};

use crate::{
    error::LinkError,
    security::{ClientSecurity, Endpoint, ServerSecurity},
    transport::{Event, Listener, ListenerConfig, WireConfig},
};

/// What it takes to let others connect.
#[derive(Clone, Debug)]
pub struct Server {
    security: Option<ServerSecurity>,
}

impl Server {
    /// Everybody on this machine may connect, and nobody else.
    #[must_use]
    pub fn open() -> Self {
        Self { security: None }
    }

    /// Those may connect whose keys are listed.
    #[must_use]
    pub fn with_keys(security: ServerSecurity) -> Self {
        Self { security: Some(security) }
    }

    pub(crate) fn has_keys(&self) -> bool {
        self.security.is_some()
    }

    /// A socket bound to an address.
    pub(crate) fn listen(
        &self,
        at: &str,
        config: ListenerConfig,
        sink: impl Fn(Event) + Send + Sync + 'static,
    ) -> Result<Listener, LinkError> {
        let endpoint: Endpoint = at.parse()?;
        endpoint.check_bind(self.has_keys())?;
        let address = endpoint
            .resolve()
            .map_err(|source| LinkError::Bind { at: endpoint.to_string(), source })?;
        let mechanism =
            self.security.as_ref().map_or(MechanismSetup::Null, ServerSecurity::mechanism);
        Listener::start(config, mechanism, address, sink)
    }
}

/// What it takes to connect to another's sockets.
#[derive(Clone, Debug)]
pub struct Remote {
    security: Option<ClientSecurity>,
}

impl Remote {
    /// Without keys: only to what is on this machine.
    #[must_use]
    pub fn open() -> Self {
        Self { security: None }
    }

    /// With keys.
    #[must_use]
    pub fn with_keys(security: ClientSecurity) -> Self {
        Self { security: Some(security) }
    }

    /// How to connect to an address.
    pub(crate) fn wire(
        &self,
        kind: SocketType,
        to: &str,
        most_bytes: usize,
    ) -> Result<(Endpoint, WireConfig), LinkError> {
        let endpoint: Endpoint = to.parse()?;
        endpoint.check_connect(self.security.is_some())?;
        let mechanism =
            self.security.as_ref().map_or(MechanismSetup::Null, ClientSecurity::mechanism);
        let config = WireConfig { role: Role::Client, kind, mechanism, most_bytes, long: None };
        Ok((endpoint, config))
    }
}

/// How often in a row a drive may hang up before it counts as its word.
pub(crate) const HUNG_UP: u32 = 3;

/// Longest message where nobody has anything long to say.
pub(crate) const SHORT_MESSAGE_BYTES: usize = 1024;

/// Whether nothing has come in time.
pub(crate) fn is_timeout(error: &io::Error) -> bool {
    use io::ErrorKind::{Interrupted, TimedOut, WouldBlock};
    matches!(error.kind(), WouldBlock | TimedOut | Interrupted)
}

/// A number that nobody has drawn before.
pub(crate) fn random() -> u64 {
    // Half the bits: JSON's numbers are exact up to 53 of them.
    std::hash::RandomState::new().hash_one(std::time::Instant::now()) >> 32
}
