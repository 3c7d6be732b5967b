//! Security settings of sockets that listen ([`Server`]) and connect ([`Remote`]).

use std::{hash::BuildHasher, io, time::Duration};

use omq_proto::{MechanismSetup, SocketType, proto::Role};

use crate::{
    error::LinkError,
    security::{ClientSecurity, Endpoint, ServerSecurity},
    transport::{
        self, Dialer, Event, Frames, Listener, ListenerConfig, ProbeError, SHORT_BYTES, WireConfig,
    },
};

/// Security of listening sockets: without keys on the loopback interface, or with CURVE keys.
///
/// ```
/// use iiwa_link::{
///     Server,
///     security::{AllowList, KeyPair, ServerSecurity},
/// };
///
/// let alice = KeyPair::generate()?;
/// let allowed = AllowList::from_iter([("alice".to_owned(), alice.public())]);
/// let server = Server::with_keys(ServerSecurity::new(KeyPair::generate()?, allowed));
/// assert!(server.has_keys() && !Server::open().has_keys());
/// # Ok::<(), iiwa_link::security::SecurityError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Server {
    security: Option<ServerSecurity>,
}

impl Server {
    /// Creates security without keys: every process on this machine may connect, but no other
    /// machine.
    #[must_use]
    pub fn open() -> Self {
        Self { security: None }
    }

    /// Creates security with keys: clients with a key on the list may connect.
    #[must_use]
    pub fn with_keys(security: ServerSecurity) -> Self {
        Self { security: Some(security) }
    }

    /// Returns true if clients need keys.
    #[must_use]
    pub fn has_keys(&self) -> bool {
        self.security.is_some()
    }

    /// Binds a socket. `sink` receives its events.
    ///
    /// # Errors
    ///
    /// The address is invalid, requires keys or cannot be bound, or no thread can be started.
    pub fn listen(
        &self,
        address: &str,
        config: ListenerConfig,
        sink: impl Fn(Event) + Send + Sync + 'static,
    ) -> Result<Listener, LinkError> {
        let endpoint: Endpoint = address.parse()?;
        endpoint.check_bind(self.has_keys())?;
        let address = endpoint
            .resolve()
            .map_err(|source| LinkError::Bind { address: endpoint.to_string(), source })?;
        let mechanism =
            self.security.as_ref().map_or(MechanismSetup::Null, ServerSecurity::mechanism);
        Listener::start(config, mechanism, address, sink)
    }
}

/// Socket type of a persistent connection.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dial {
    /// DEALER: sends requests without waiting for replies.
    Dealer,
    /// REP: replies to requests.
    Rep,
}

impl Dial {
    fn socket(self) -> SocketType {
        match self {
            Self::Dealer => SocketType::Dealer,
            Self::Rep => SocketType::Rep,
        }
    }
}

/// Security of connecting sockets: without keys on this machine, or with CURVE keys.
///
/// ```
/// use iiwa_link::{
///     Client, Remote,
///     security::{ClientSecurity, KeyPair},
/// };
///
/// // Connections to other machines require keys.
/// assert!(Client::new(&Remote::open(), "tcp://192.0.2.1:5560").is_err());
/// let server = KeyPair::generate()?.public();
/// let remote = Remote::with_keys(ClientSecurity::new(KeyPair::generate()?, server));
/// assert!(Client::new(&remote, "tcp://192.0.2.1:5560").is_ok());
/// # Ok::<(), iiwa_link::security::SecurityError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Remote {
    security: Option<ClientSecurity>,
}

impl Remote {
    /// Creates security without keys: connections to this machine only.
    #[must_use]
    pub fn open() -> Self {
        Self { security: None }
    }

    /// Creates security with keys.
    #[must_use]
    pub fn with_keys(security: ClientSecurity) -> Self {
        Self { security: Some(security) }
    }

    /// Maintains a connection to an address in a thread named `name`. `take` receives messages and
    /// returns replies.
    ///
    /// # Errors
    ///
    /// The address is invalid or requires keys, or no thread can be started.
    pub fn dial(
        &self,
        name: &'static str,
        kind: Dial,
        address: &str,
        take: impl FnMut(Frames) -> Option<Frames> + Send + 'static,
    ) -> Result<Dialer, LinkError> {
        let (to, wire) = self.wire(kind.socket(), address, SHORT_BYTES)?;
        Dialer::start(name, wire, to, take)
    }

    /// Probes an address: connects once and completes the handshake, each within `limit`.
    ///
    /// # Errors
    ///
    /// The obstacle to the connection.
    pub fn probe(&self, kind: Dial, address: &str, limit: Duration) -> Result<(), ProbeError> {
        let (to, wire) = self.wire(kind.socket(), address, SHORT_BYTES)?;
        transport::probe(&to, &wire, limit)
    }

    /// Returns true if keys are configured.
    #[must_use]
    pub fn has_keys(&self) -> bool {
        self.security.is_some()
    }

    /// Returns the configuration of a connection to an address.
    pub(crate) fn wire(
        &self,
        kind: SocketType,
        to: &str,
        max_bytes: usize,
    ) -> Result<(Endpoint, WireConfig), LinkError> {
        let endpoint: Endpoint = to.parse()?;
        endpoint.check_connect(self.security.is_some())?;
        let mechanism =
            self.security.as_ref().map_or(MechanismSetup::Null, ClientSecurity::mechanism);
        // The number of long messages is not limited: the client has chosen its server.
        let config = WireConfig { role: Role::Client, kind, mechanism, max_bytes, long: None };
        Ok((endpoint, config))
    }
}

/// Number of consecutive closed handshakes that are retried; one more counts as a refusal by the
/// drive.
pub(crate) const MAX_CLOSED_HANDSHAKES: u32 = 3;

/// Maximum length of a message on sockets for short messages, in bytes.
pub const SHORT_MESSAGE_BYTES: usize = 1024;

/// Returns true if a read has timed out.
#[must_use]
pub fn is_timeout(error: &io::Error) -> bool {
    use io::ErrorKind::{Interrupted, TimedOut, WouldBlock};
    matches!(error.kind(), WouldBlock | TimedOut | Interrupted)
}

/// Returns a random number, to distinguish program starts.
#[must_use]
pub fn random_id() -> u64 {
    // Half of the bits: JSON numbers are exact up to 53 bits.
    std::hash::RandomState::new().hash_one(std::time::Instant::now()) >> 32
}
