//! Listening sockets: accept connections within bounds and deliver messages.
//!
//! Each socket has a separate thread, so that the load of one socket does not delay another, with
//! one task per connection.

use std::{
    collections::HashMap,
    io,
    net::{IpAddr, SocketAddr},
    sync::{Arc, Mutex, MutexGuard, PoisonError},
    thread::{self, JoinHandle},
    time::Duration,
};

use bytes::Bytes;
use omq_proto::{MechanismSetup, SocketType, proto::Role};
use socket2::SockRef;
use tokio::{
    net::{TcpListener, TcpSocket, TcpStream},
    runtime::Runtime,
    sync::{Notify, OwnedSemaphorePermit, Semaphore, mpsc},
    task::AbortHandle,
    time::{sleep, timeout},
};

use super::{
    open_files::{self, CLOSING},
    places::{Activity, ConnectionSlots, ConnectionStage, Holder, Occupant, PeerId},
    runtime::runtime,
    subscriptions::Subscriptions,
    wire::{
        ConnectionEnd, Frames, HandshakeStep, ReceivedMessage, WireConfig, WireConnection,
        WireInput,
    },
};
use crate::error::LinkError;

/// The type of a listening socket.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SocketKind {
    /// ROUTER: receives requests and sends replies.
    Router,
    /// REP: like ROUTER, announced as a socket that replies in order.
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
    /// Name of the thread.
    pub name: &'static str,
    /// Socket type.
    pub kind: SocketKind,
    /// Maximum message length, in bytes: a peer that sends a longer message is disconnected.
    pub max_bytes: usize,
    /// Maximum number of messages that wait for a peer; further messages are dropped for this peer.
    pub backlog: usize,
    /// Predicate for urgent requests: a peer that waits for the reply to an urgent request is
    /// evicted last.
    pub is_urgent: fn(&[Bytes]) -> bool,
}

impl ListenerConfig {
    /// Creates the configuration of a socket with this thread name that accepts messages of at most
    /// `max_bytes`. No messages wait for a peer.
    #[must_use]
    pub fn new(name: &'static str, kind: SocketKind, max_bytes: usize) -> Self {
        Self { name, kind, max_bytes, backlog: 0, is_urgent: |_| false }
    }

    /// Sets the maximum number of messages that wait for a peer.
    #[must_use]
    pub fn with_backlog(self, backlog: usize) -> Self {
        Self { backlog, ..self }
    }

    /// Sets the predicate for urgent requests, such as stops.
    #[must_use]
    pub fn with_urgent(self, is_urgent: fn(&[Bytes]) -> bool) -> Self {
        Self { is_urgent, ..self }
    }
}

/// An event of a socket.
pub enum Event {
    /// A message from a peer.
    Message(PeerId, ReceivedMessage),
    /// The peer has disconnected, or was disconnected.
    Disconnected(PeerId),
}

/// Callback for the events of a socket.
type EventCallback = Arc<dyn Fn(Event) + Send + Sync>;

/// Time-out of a handshake.
const HANDSHAKE_TIMEOUT: Duration = Duration::from_secs(2);

/// Time-out of a peer that reads nothing, after which it is disconnected.
const STALL_TIMEOUT: Duration = Duration::from_secs(5);

/// Time after which a peer that reads nothing may be evicted.
const STALL_GRACE: Duration = Duration::from_millis(100);

/// Maximum number of pending requests per peer.
const REQUEST_QUOTA: usize = 8;

/// Size of the system's send buffer for a subscriber, in bytes: about a second at 1 ms.
const SEND_BUFFER: usize = 128 << 10;

/// The system's queue of connections to be accepted.
const ACCEPT_BACKLOG: u32 = 1024;

/// A listening socket. Dropping it closes the socket.
pub struct Listener {
    address: String,
    shared: Arc<ListenerState>,
    thread: Option<JoinHandle<()>>,
}

impl Listener {
    /// Binds a socket and starts its thread.
    ///
    /// # Errors
    ///
    /// The address cannot be bound, too few files may be open, or no thread can be started.
    pub(crate) fn start(
        config: ListenerConfig,
        mechanism: MechanismSetup,
        address: SocketAddr,
        sink: impl Fn(Event) + Send + Sync + 'static,
    ) -> Result<Self, LinkError> {
        let to_error = |source| LinkError::Bind { address: format!("tcp://{address}"), source };
        let places = open_files::places()?;
        let runtime = runtime().map_err(|source| LinkError::Thread { source })?;
        let listener = {
            // Sockets are registered with the runtime that is entered.
            let _in_runtime = runtime.enter();
            bind(address).map_err(to_error)?
        };
        let address = format!("tcp://{}", listener.local_addr().map_err(to_error)?);
        let name = config.name;
        let shared = Arc::new(ListenerState {
            kind: config.kind,
            backlog: config.backlog,
            is_urgent: config.is_urgent,
            places: ConnectionSlots::new(places),
            // Handshakes and established connections have `places` each.
            descriptors: Arc::new(Semaphore::new(2 * places + CLOSING)),
            wire: WireConfig {
                role: Role::Server,
                kind: config.kind.socket_type(),
                mechanism,
                max_bytes: config.max_bytes,
                // Bounds the memory of all peers together, whatever they announce.
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
        Ok(Self { address, shared, thread })
    }

    /// Returns the address, such as `tcp://127.0.0.1:5560`.
    #[must_use]
    pub fn address(&self) -> &str {
        &self.address
    }

    /// Sends a message to a peer, unless it has disconnected. `hold` is dropped once the message is
    /// sent.
    pub fn send(&self, to: PeerId, frames: Frames, hold: Option<Box<dyn Send>>) {
        // The table is locked: `try_send` does not wait for a slow peer.
        if let Some(peer) = self.shared.peers().connected.get(&to) {
            // If the inbox is full, the peer does not read the replies to its requests: they are
            // dropped.
            let _ = peer.inbox.try_send(Outgoing { frames, hold });
        }
    }

    /// Sends a message to all peers. Subscribers receive it if they have subscribed to its topic,
    /// the first frame.
    pub fn publish(&self, frames: &Frames) {
        for peer in self.shared.peers().connected.values() {
            // During a handshake, the task of the connection does not read the inbox.
            if !peer.occupant.activity.stage.is_handshake() {
                // A peer that does not keep up misses the message.
                let _ = peer.inbox.try_send(Outgoing { frames: frames.clone(), hold: None });
            }
        }
    }
}

impl Drop for Listener {
    fn drop(&mut self) {
        // Stored until it is waited for: also a thread that has just started ends.
        self.shared.shutdown.notify_one();
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

fn bind(address: SocketAddr) -> io::Result<TcpListener> {
    let socket = if address.is_ipv4() { TcpSocket::new_v4() } else { TcpSocket::new_v6() }?;
    // Connections in TIME_WAIT do not block the address.
    #[cfg(unix)]
    socket.set_reuseaddr(true)?;
    socket.bind(address)?;
    socket.listen(ACCEPT_BACKLOG)
}

struct ListenerState {
    kind: SocketKind,
    backlog: usize,
    is_urgent: fn(&[Bytes]) -> bool,
    /// Slots for handshakes, and the same number for established connections.
    places: ConnectionSlots,
    /// Permits for open connections, including connections that are being closed.
    descriptors: Arc<Semaphore>,
    wire: WireConfig,
    sink: EventCallback,
    peers: Mutex<Peers>,
    shutdown: Notify,
}

#[derive(Default)]
struct Peers {
    next: PeerId,
    connected: HashMap<PeerId, Peer>,
}

struct Peer {
    occupant: Occupant,
    inbox: mpsc::Sender<Outgoing>,
    task: Option<AbortHandle>,
}

struct Outgoing {
    frames: Frames,
    hold: Option<Box<dyn Send>>,
}

impl Peers {
    /// Makes room for a new handshake or established connection, evicting another one if necessary.
    fn make_room(&mut self, places: &ConnectionSlots, is_handshake: bool, newcomer: &Holder) {
        let occupants = self.connected.iter().map(|(id, peer)| (*id, &peer.occupant));
        let rivals = occupants.filter(|(_, it)| it.activity.stage.is_handshake() == is_handshake);
        let Some(victim) = places.victim(rivals, newcomer) else { return };
        // The task ends later, but its connection does not count from now on.
        if let Some(task) = self.connected.remove(&victim).and_then(|peer| peer.task) {
            task.abort();
        }
    }
}

impl ListenerState {
    fn peers(&self) -> MutexGuard<'_, Peers> {
        // A panic does not leave the table inconsistent.
        self.peers.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Updates the activity of a connection.
    fn update(&self, id: PeerId, activity: Activity) {
        if let Some(peer) = self.peers().connected.get_mut(&id) {
            peer.occupant.activity = activity;
        }
    }

    /// Updates the stage of a handshake.
    fn advance(&self, id: PeerId, step: HandshakeStep) {
        let stage = match step {
            HandshakeStep::Greeting => ConnectionStage::Greeting,
            HandshakeStep::Greeted => ConnectionStage::Greeted,
            HandshakeStep::Introduced => ConnectionStage::Introduced,
        };
        // Steps are reported for each read: single bytes within a step do not count as activity.
        if let Some(peer) = self.peers().connected.get_mut(&id)
            && peer.occupant.activity.stage < stage
        {
            peer.occupant.activity = Activity::now(stage);
        }
    }

    /// Moves a connection with a complete handshake to the established ones. Returns `false` if the
    /// connection has been evicted.
    fn establish(&self, id: PeerId, key: Option<String>) -> bool {
        let mut peers = self.peers();
        let Some(peer) = peers.connected.get_mut(&id) else { return false };
        if let Some(key) = key {
            peer.occupant.holder = Holder::Key(key);
        }
        let holder = peer.occupant.holder.clone();
        // Still at the stage of a handshake, so that the connection cannot evict itself.
        peers.make_room(&self.places, false, &holder);
        if let Some(peer) = peers.connected.get_mut(&id) {
            peer.occupant.activity = Activity::now(ConnectionStage::Fresh);
        }
        true
    }
}

/// Accepts connections until the listener is dropped.
fn run(runtime: &Runtime, shared: &Arc<ListenerState>, listener: &TcpListener) {
    let accept = async {
        // Evicted connections are closed by their tasks: the next connection is accepted
        // afterwards.
        while let Ok(descriptor) = shared.descriptors.clone().acquire_owned().await {
            match listener.accept().await {
                Ok((stream, from)) => self::accept(shared, stream, from.ip(), descriptor),
                Err(error) => {
                    // Usually, other parts of the process have opened too many files.
                    tracing::debug!("cannot accept a connection: {error}");
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

fn accept(
    shared: &Arc<ListenerState>,
    stream: TcpStream,
    address: IpAddr,
    descriptor: OwnedSemaphorePermit,
) {
    if shared.kind == SocketKind::Pub {
        // A small buffer: a subscriber that does not keep up misses messages early, rather than all
        // at once.
        let _ = SockRef::from(&stream).set_send_buffer_size(SEND_BUFFER);
    }
    // Room for the replies to all pending requests, at least.
    let (inbox, outgoing) = mpsc::channel(shared.backlog.max(2 * REQUEST_QUOTA));
    let id = {
        let mut peers = shared.peers();
        let holder = Holder::at(address);
        peers.make_room(&shared.places, true, &holder);
        peers.next += 1;
        let id = peers.next;
        let occupant = Occupant { holder, activity: Activity::now(ConnectionStage::Silent) };
        // Registered before its task starts: the task reports its steps to this entry.
        peers.connected.insert(id, Peer { occupant, inbox, task: None });
        id
    };
    let guard =
        ConnectionGuard { id, shared: shared.clone(), established: false, _descriptor: descriptor };
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
    shared: Arc<ListenerState>,
    /// `true` if the handshake is complete.
    established: bool,
    /// Returned when the connection is closed.
    _descriptor: OwnedSemaphorePermit,
}

impl Drop for ConnectionGuard {
    fn drop(&mut self) {
        // The lock ends with this line: the sink may send, which locks the table again.
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
) -> Result<(), ConnectionEnd> {
    let shared = guard.shared.clone();
    let (mut wire, key) = timeout(HANDSHAKE_TIMEOUT, async {
        // A peer that sends nothing does not receive protocol state.
        stream.readable().await?;
        let mut wire = WireConnection::new(stream, shared.wire.clone());
        let key = wire.shake_hands(|step| shared.advance(guard.id, step)).await?;
        Ok::<_, ConnectionEnd>((wire, key))
    })
    .await
    .map_err(|_| ConnectionEnd::Stalled(HANDSHAKE_TIMEOUT))??;
    if !shared.establish(guard.id, key) {
        return Ok(());
    }
    guard.established = true;
    let mut topics = Subscriptions::default();
    let mut activity = Activity::now(ConnectionStage::Fresh);
    // `true` if one of the pending requests is urgent.
    let mut urgent = false;
    // Dropped once all output is sent.
    let mut holds = Vec::new();
    loop {
        // Replies do not name their requests: urgency ends when no request is pending.
        urgent &= activity.pending > 0;
        if activity.pending > 0 {
            activity.stage = if urgent { ConnectionStage::Urgent } else { ConnectionStage::Busy };
        } else if activity.stage > ConnectionStage::Idle {
            activity.stage = ConnectionStage::Idle;
        }
        shared.update(guard.id, activity);
        while wire.has_output() {
            // Each part has its own time-out: a slow peer that makes progress is not disconnected.
            if let Ok(sent) = timeout(STALL_GRACE, wire.send_some()).await {
                sent?;
            } else {
                shared.update(guard.id, Activity { stage: ConnectionStage::Stalled, ..activity });
                let sent = timeout(STALL_TIMEOUT, wire.send_some()).await;
                sent.map_err(|_| ConnectionEnd::Stalled(STALL_TIMEOUT))??;
            }
        }
        holds.clear();
        tokio::select! {
            // Output first: a peer that sends without pause does not delay its own replies.
            biased;
            Some(Outgoing { frames, hold }) = outgoing.recv() => {
                if shared.kind.replies() {
                    let pending = activity.pending.saturating_sub(1);
                    activity = Activity { pending, ..Activity::now(activity.stage) };
                }
                if shared.kind != SocketKind::Pub || topics.matches(&frames[0]) {
                    wire.queue(&frames)?;
                    holds.extend(hold);
                }
            }
            // Beyond the quota, requests remain in the system's buffers, which block the peer.
            incoming = wire.receive(), if activity.pending < REQUEST_QUOTA => match incoming? {
                WireInput::Message(received) => {
                    let pending = activity.pending + usize::from(shared.kind.replies());
                    activity = Activity { pending, ..Activity::now(ConnectionStage::Idle) };
                    urgent |= (shared.is_urgent)(&received.frames);
                    (shared.sink)(Event::Message(guard.id, received));
                }
                WireInput::Subscribe(topic) if !topics.add(&topic) => {
                    tracing::warn!("a subscriber with too many topics is disconnected");
                    return Ok(());
                }
                // Further subscriptions do not extend the activity.
                WireInput::Subscribe(_) if activity.stage == ConnectionStage::Fresh => {
                    activity = Activity::now(ConnectionStage::Idle);
                }
                WireInput::Subscribe(_) => {}
                WireInput::Cancel(topic) => topics.remove(&topic),
            },
        }
    }
}
