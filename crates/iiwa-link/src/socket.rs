//! What it takes to be connected to, and to connect.

use std::{hash::BuildHasher, io};

use omq_proto::{MechanismSetup, SocketType, proto::Role};

use crate::{
    error::LinkError,
    security::{ClientSecurity, Endpoint, ServerSecurity},
    transport::{Dialer, Event, Frames, Listener, ListenerConfig, SHORT_BYTES, WireConfig},
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

    /// Whether clients need keys.
    #[must_use]
    pub fn has_keys(&self) -> bool {
        self.security.is_some()
    }

    /// A socket bound to an address.
    pub fn listen(
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

/// What a connection that is kept up is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dial {
    /// It asks, several at a time if need be.
    Dealer,
    /// It is asked.
    Rep,
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

    /// Keeps up a connection to an address, in a thread of that name. `take` gets what comes in, and says
    /// what is answered.
    ///
    /// # Errors
    ///
    /// If the address makes no sense or asks for keys, or the system starts no thread.
    pub fn dial(
        &self,
        name: &'static str,
        kind: Dial,
        at: &str,
        take: impl FnMut(Frames) -> Option<Frames> + Send + 'static,
    ) -> Result<Dialer, LinkError> {
        let kind = match kind {
            Dial::Dealer => SocketType::Dealer,
            Dial::Rep => SocketType::Rep,
        };
        let (to, wire) = self.wire(kind, at, SHORT_BYTES)?;
        Dialer::start(name, wire, to, take)
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
pub const HUNG_UP: u32 = 3;

/// Longest message where nobody has anything long to say.
pub const SHORT_MESSAGE_BYTES: usize = 1024;

/// Whether nothing has come in time.
pub fn is_timeout(error: &io::Error) -> bool {
    use io::ErrorKind::{Interrupted, TimedOut, WouldBlock};
    matches!(error.kind(), WouldBlock | TimedOut | Interrupted)
}

/// A number that nobody has drawn before.
pub fn random() -> u64 {
    // Half the bits: JSON's numbers are exact up to 53 of them.
    std::hash::RandomState::new().hash_one(std::time::Instant::now()) >> 32
}
