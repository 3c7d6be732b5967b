//! Listening sockets: accept connections within their bounds and deliver messages.
//!
//! Each socket has a thread of its own, so that the load of one does not delay another, with one task
//! per connection.

use std::{
    collections::HashMap,
    io,
    net::{IpAddr, SocketAddr},
    sync::{Arc, Mutex, MutexGuard, PoisonError},
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

use omq_proto::{MechanismSetup, SocketType, proto::Role};
use socket2::SockRef;
use tokio::{
    net::{TcpListener, TcpSocket, TcpStream},
    runtime::Runtime,
    sync::{Notify, Semaphore, mpsc},
    task::AbortHandle,
    time::{sleep, timeout},
};

use super::{
    admission::{Admission, ConnectionStatus, PeerId, Stage, admit},
    runtime::runtime,
    subscriptions::Subscriptions,
    wire::{Frames, Incoming, Received, Wire, WireConfig, WireError},
};
use crate::error::LinkError;

/// The type of a listening socket.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SocketKind {
    /// ROUTER: receives requests and sends replies.
    Router,
    /// REP: the same, announced as a socket that replies in order.
    Rep,
    /// PUB: publishes to subscribers.
    Pub,
    /// DEALER: sends messages to all peers, which acknowledge them.
    Dealer,
}

impl SocketKind {
    fn socket_type(self) -> SocketType {
        match self {
            Self::Router => SocketType::Router,
            Self::Rep => SocketType::Rep,
            Self::Pub => SocketType::Pub,
            Self::Dealer => SocketType::Dealer,
        }
    }

    fn replies(self) -> bool {
        matches!(self, Self::Router | Self::Rep)
    }
}

/// Configuration of a listening socket.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct ListenerConfig {
    /// Name of its thread.
    pub name: &'static str,
    /// Type of the socket.
    pub kind: SocketKind,
    /// Longest message, in bytes: a peer that sends a longer one is disconnected.
    pub max_bytes: usize,
    /// Largest number of messages that wait for a peer; it misses those beyond.
    pub backlog: usize,
}

impl ListenerConfig {
    /// A socket whose thread has this name and that accepts messages of at most `max_bytes`. No messages wait
    /// for a peer.
    #[must_use]
    pub fn new(name: &'static str, kind: SocketKind, max_bytes: usize) -> Self {
        Self { name, kind, max_bytes, backlog: 0 }
    }

    /// With at most so many messages that wait for a peer.
    #[must_use]
    pub fn with_backlog(self, backlog: usize) -> Self {
        Self { backlog, ..self }
    }
}

/// An event of a socket.
pub enum Event {
    /// A message from a peer.
    Message(PeerId, Received),
    /// The peer has disconnected, or was disconnected.
    Disconnected(PeerId),
}

/// Receives the events of a socket.
type Sink = Arc<dyn Fn(Event) + Send + Sync>;

/// Time-out of a handshake.
const HANDSHAKE_TIMEOUT: Duration = Duration::from_secs(2);

/// A peer that reads nothing for so long is disconnected.
const STALL_TIMEOUT: Duration = Duration::from_secs(5);

/// A peer that reads nothing for so long may be evicted.
const STALL_GRACE: Duration = Duration::from_millis(100);

/// Largest number of pending requests per peer.
const REQUEST_QUOTA: usize = 8;

/// Size of the system's send buffer for a subscriber, in bytes: about a second at 1 ms.
const SEND_BUFFER: usize = 128 << 10;

/// The system's queue of connections to be accepted.
const ACCEPT_BACKLOG: u32 = 1024;

/// A listening socket. It is closed when it is dropped.
pub struct Listener {
    at: String,
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

impl Listener {
    /// Binds a socket and starts its thread.
    ///
    /// # Errors
    ///
    /// The address cannot be bound, or no thread can be started.
    pub(crate) fn start(
        config: ListenerConfig,
        mechanism: MechanismSetup,
        at: SocketAddr,
        sink: impl Fn(Event) + Send + Sync + 'static,
    ) -> Result<Self, LinkError> {
        let refuse = |source| LinkError::Bind { at: format!("tcp://{at}"), source };
        let runtime = runtime().map_err(|source| LinkError::Thread { source })?;
        let listener = {
            let _in_runtime = runtime.enter();
            bind(at).map_err(refuse)?
        };
        let at = format!("tcp://{}", listener.local_addr().map_err(refuse)?);
        let name = config.name;
        let shared = Arc::new(Shared {
            kind: config.kind,
            backlog: config.backlog,
            wire: WireConfig {
                role: Role::Server,
                kind: config.kind.socket_type(),
                mechanism,
                max_bytes: config.max_bytes,
                long: Some(Arc::new(Semaphore::new(1))),
            },
            sink: Arc::new(sink),
            peers: Mutex::default(),
            shutdown: Notify::new(),
        });
        let thread = {
            let shared = shared.clone();
            let run = move || run(&runtime, &shared, &listener);
            thread::Builder::new().name(name.to_owned()).spawn(run)
        };
        let thread = Some(thread.map_err(|source| LinkError::Thread { source })?);
        Ok(Self { at, shared, thread })
    }

    /// Its address, such as `tcp://127.0.0.1:5560`.
    #[must_use]
    pub fn at(&self) -> &str {
        &self.at
    }

    /// Sends a message to a peer, unless it has disconnected. `hold` is dropped when it is sent.
    pub fn send(&self, to: PeerId, frames: Frames, hold: Option<Box<dyn Send>>) {
        if let Some(peer) = self.shared.peers().connected.get(&to) {
            // Without space, the peer does not read the replies to its requests: they are dropped.
            let _ = peer.inbox.try_send(Outgoing { frames, hold });
        }
    }

    /// Sends a message to all peers; to subscribers if they want its topic, the first frame.
    pub fn publish(&self, frames: &Frames) {
        for peer in self.shared.peers().connected.values() {
            if peer.status.stage >= Stage::Stalled {
                // A peer that does not keep up misses it.
                let _ = peer.inbox.try_send(Outgoing { frames: frames.clone(), hold: None });
            }
        }
    }
}

impl Drop for Listener {
    fn drop(&mut self) {
        self.shared.shutdown.notify_one();
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

fn bind(at: SocketAddr) -> io::Result<TcpListener> {
    let socket = if at.is_ipv4() { TcpSocket::new_v4() } else { TcpSocket::new_v6() }?;
    // Connections in TIME_WAIT do not block the address.
    #[cfg(unix)]
    socket.set_reuseaddr(true)?;
    socket.bind(at)?;
    socket.listen(ACCEPT_BACKLOG)
}

struct Shared {
    kind: SocketKind,
    backlog: usize,
    wire: WireConfig,
    sink: Sink,
    peers: Mutex<Peers>,
    shutdown: Notify,
}

#[derive(Default)]
struct Peers {
    next: PeerId,
    connected: HashMap<PeerId, Peer>,
}

struct Peer {
    status: ConnectionStatus,
    inbox: mpsc::Sender<Outgoing>,
    task: Option<AbortHandle>,
}

struct Outgoing {
    frames: Frames,
    hold: Option<Box<dyn Send>>,
}

impl Shared {
    fn peers(&self) -> MutexGuard<'_, Peers> {
        // A panic does not leave the table inconsistent.
        self.peers.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Sets the stage of a connection.
    fn set_stage(&self, id: PeerId, stage: Stage) {
        if let Some(peer) = self.peers().connected.get_mut(&id) {
            peer.status.stage = stage;
            peer.status.since = Instant::now();
        }
    }

    /// Admits one more handshake or established connection, evicting another one if necessary.
    fn make_room(&self, is_handshake: bool) -> bool {
        let mut peers = self.peers();
        let statuses = peers.connected.iter().map(|(id, peer)| (id, &peer.status));
        match admit(statuses, is_handshake) {
            Admission::Free => true,
            Admission::Full => false,
            Admission::Evict(id) => {
                // Its task ends later; it does not count from now on.
                if let Some(task) = peers.connected.remove(&id).and_then(|peer| peer.task) {
                    task.abort();
                }
                true
            }
        }
    }
}

/// Accepts connections until the listener is dropped.
fn run(runtime: &Runtime, shared: &Arc<Shared>, listener: &TcpListener) {
    let accept = async {
        loop {
            match listener.accept().await {
                Ok((stream, from)) => self::accept(shared, stream, from.ip()),
                Err(error) => {
                    // Usually, too many files are open: evict a connection.
                    tracing::debug!("cannot accept a connection: {error}");
                    shared.make_room(true);
                    sleep(Duration::from_millis(10)).await;
                }
            }
        }
    };
    runtime.block_on(async {
        tokio::select! {
            () = accept => {}
            () = shared.shutdown.notified() => {}
        }
    });
}

fn accept(shared: &Arc<Shared>, stream: TcpStream, address: IpAddr) {
    if !shared.make_room(true) {
        return;
    }
    if shared.kind == SocketKind::Pub {
        // A small buffer: a subscriber that does not keep up misses messages early, rather than all at once.
        let _ = SockRef::from(&stream).set_send_buffer_size(SEND_BUFFER);
    }
    let (inbox, outgoing) = mpsc::channel(shared.backlog.max(2 * REQUEST_QUOTA));
    let id = {
        let mut peers = shared.peers();
        peers.next += 1;
        let id = peers.next;
        let status = ConnectionStatus { address, stage: Stage::Silent, since: Instant::now() };
        peers.connected.insert(id, Peer { status, inbox, task: None });
        id
    };
    let guard = ConnectionGuard { id, shared: shared.clone(), established: false };
    let task = tokio::spawn(async move {
        if let Err(error) = serve(guard, stream, outgoing).await {
            tracing::debug!("connection of {address}: {error}");
        }
    });
    if let Some(peer) = shared.peers().connected.get_mut(&id) {
        peer.task = Some(task.abort_handle());
    }
}

/// Unregisters a connection when it is dropped.
struct ConnectionGuard {
    id: PeerId,
    shared: Arc<Shared>,
    /// Whether the handshake is complete.
    established: bool,
}

impl Drop for ConnectionGuard {
    fn drop(&mut self) {
        self.shared.peers().connected.remove(&self.id);
        if self.established {
            (self.shared.sink)(Event::Disconnected(self.id));
        }
    }
}

/// Serves a connection until it ends.
async fn serve(
    mut guard: ConnectionGuard,
    stream: TcpStream,
    mut outgoing: mpsc::Receiver<Outgoing>,
) -> Result<(), WireError> {
    let shared = guard.shared.clone();
    let mut wire = timeout(HANDSHAKE_TIMEOUT, async {
        // A peer that sends nothing gets no protocol state.
        stream.readable().await?;
        shared.set_stage(guard.id, Stage::Handshake);
        let mut wire = Wire::new(stream, shared.wire.clone());
        wire.shake_hands().await.map(|_| wire)
    })
    .await
    .map_err(|_| WireError::Stalled(HANDSHAKE_TIMEOUT))??;
    if !shared.make_room(false) {
        return Ok(());
    }
    guard.established = true;
    let mut topics = Subscriptions::default();
    // Pending requests.
    let mut pending = 0;
    // Dropped when all is sent.
    let mut holds = Vec::new();
    loop {
        let stage = match shared.kind {
            SocketKind::Pub => Stage::Served,
            _ if pending > 0 => Stage::Served,
            _ => Stage::Idle,
        };
        shared.set_stage(guard.id, stage);
        while wire.has_output() {
            if let Ok(sent) = timeout(STALL_GRACE, wire.send_some()).await {
                sent?;
            } else {
                shared.set_stage(guard.id, Stage::Stalled);
                let sent = timeout(STALL_TIMEOUT, wire.send_some()).await;
                sent.map_err(|_| WireError::Stalled(STALL_TIMEOUT))??;
            }
        }
        holds.clear();
        tokio::select! {
            biased;
            Some(Outgoing { frames, hold }) = outgoing.recv() => {
                pending = usize::saturating_sub(pending, usize::from(shared.kind.replies()));
                if shared.kind != SocketKind::Pub || topics.matches(&frames[0]) {
                    wire.queue(&frames)?;
                    holds.extend(hold);
                }
            }
            incoming = wire.receive(), if pending < REQUEST_QUOTA => match incoming? {
                Incoming::Message(received) => {
                    pending += usize::from(shared.kind.replies());
                    (shared.sink)(Event::Message(guard.id, received));
                }
                Incoming::Subscribe(topic) if !topics.add(&topic) => {
                    tracing::warn!("a subscriber with too many topics is disconnected");
                    return Ok(());
                }
                Incoming::Subscribe(_) => {}
                Incoming::Cancel(topic) => topics.remove(&topic),
            },
        }
    }
}
