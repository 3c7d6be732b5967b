//! Sockets of `ZeroMQ`, with keys where they are needed.

use std::{hash::BuildHasher, io};

use crate::{
    error::LinkError,
    security::{
        Authenticator, ClientSecurity, Endpoint, GuardedSocket, SecurityError, ServerSecurity,
        WatchedSocket, connect,
    },
};

/// What it takes to let others connect.
#[derive(Clone)]
pub struct Server {
    context: zmq::Context,
    authenticator: Option<Authenticator>,
}

impl std::fmt::Debug for Server {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Server").field("has_keys", &self.has_keys()).finish_non_exhaustive()
    }
}

impl Server {
    /// Everybody on this machine may connect, and nobody else.
    #[must_use]
    pub fn open() -> Self {
        Self { context: zmq::Context::new(), authenticator: None }
    }

    /// Those may connect whose keys are listed.
    ///
    /// # Errors
    ///
    /// If the libzmq of this build has no CURVE, or refuses.
    pub fn with_keys(security: ServerSecurity) -> Result<Self, SecurityError> {
        let context = zmq::Context::new();
        let authenticator = Authenticator::start(&context, security)?;
        Ok(Self { context, authenticator: Some(authenticator) })
    }

    pub(crate) fn has_keys(&self) -> bool {
        self.authenticator.is_some()
    }

    /// A socket bound to an address, and the address that it got; `set` sets what it needs before.
    pub(crate) fn bind(
        &self,
        kind: zmq::SocketType,
        at: &str,
        set: impl FnOnce(&zmq::Socket) -> zmq::Result<()>,
    ) -> Result<(GuardedSocket, String), LinkError> {
        let socket = match &self.authenticator {
            Some(authenticator) => authenticator.socket(kind)?,
            None => GuardedSocket::open(&self.context, kind)?,
        };
        prepare(&socket).and_then(|()| set(&socket)).map_err(LinkError::socket)?;
        let bound = socket.bind(&at.parse::<Endpoint>()?)?;
        Ok((socket, bound))
    }
}

/// What it takes to connect to another's sockets.
#[derive(Clone)]
pub struct Remote {
    context: zmq::Context,
    security: Option<ClientSecurity>,
}

impl std::fmt::Debug for Remote {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Remote").field("security", &self.security).finish_non_exhaustive()
    }
}

impl Remote {
    /// Without keys: only to what is on this machine.
    #[must_use]
    pub fn open() -> Self {
        Self { context: zmq::Context::new(), security: None }
    }

    /// With keys.
    #[must_use]
    pub fn with_keys(security: ClientSecurity) -> Self {
        Self { context: zmq::Context::new(), security: Some(security) }
    }

    /// A socket connected to an address. Whether anybody is there shows later.
    pub(crate) fn connect(
        &self,
        kind: zmq::SocketType,
        to: &str,
        set: impl FnOnce(&zmq::Socket) -> zmq::Result<()>,
    ) -> Result<zmq::Socket, LinkError> {
        let socket = self.context.socket(kind).map_err(LinkError::socket)?;
        self.connect_it(&socket, to, set)?;
        Ok(socket)
    }

    /// The same, and its connection can be asked about.
    pub(crate) fn connect_watched(
        &self,
        kind: zmq::SocketType,
        to: &str,
        set: impl FnOnce(&zmq::Socket) -> zmq::Result<()>,
    ) -> Result<WatchedSocket, LinkError> {
        let socket = WatchedSocket::new(&self.context, kind)?;
        self.connect_it(&socket, to, set)?;
        Ok(socket)
    }

    fn connect_it(
        &self,
        socket: &zmq::Socket,
        to: &str,
        set: impl FnOnce(&zmq::Socket) -> zmq::Result<()>,
    ) -> Result<(), LinkError> {
        prepare(socket)
            .and_then(|()| socket.set_reconnect_ivl(RECONNECT_MS))
            .and_then(|()| set(socket))
            .map_err(LinkError::socket)?;
        connect(socket, &to.parse()?, self.security.as_ref())?;
        Ok(())
    }
}

/// How often in a row a drive may hang up before it counts as its word.
pub(crate) const HUNG_UP: u32 = 3;
/// How long after a connection was lost another one is tried, in ms.
const RECONNECT_MS: i32 = 50;
/// How often a silent connection is tried, and how long it may keep silent then, in ms.
const HEARTBEAT_MS: [i32; 2] = [1000, 3000];

fn prepare(socket: &zmq::Socket) -> zmq::Result<()> {
    let [interval_ms, timeout_ms] = HEARTBEAT_MS;
    // Nothing is held back for those who are gone.
    socket.set_linger(0)?;
    socket.set_heartbeat_ivl(interval_ms)?;
    socket.set_heartbeat_timeout(timeout_ms)
}

/// Longest message where nobody has anything long to say.
pub(crate) const SHORT_MESSAGE_BYTES: usize = 1024;

/// Closes the connection to whoever sends a longer message.
pub(crate) fn limit_messages(socket: &zmq::Socket, bytes: usize) -> zmq::Result<()> {
    socket.set_maxmsgsize(i64::try_from(bytes).unwrap_or(i64::MAX))
}

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
