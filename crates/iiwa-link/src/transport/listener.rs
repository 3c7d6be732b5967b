//! A socket that others connect to: it accepts connections, keeps within its bounds, and hands over
//! messages.
//!
//! Each has a thread of its own, so that what is asked of one socket does not hold up another, and in it
//! a task a connection.

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
    admission::{PeerId, Room, Stage, Standing, room},
    subscriptions::Subscriptions,
    wire::{Frames, Incoming, Received, Wire, WireConfig, WireError},
};
use crate::error::LinkError;

/// What a socket is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Requests come in, each of which is answered.
    Router,
    /// The same; peers are told that it answers one after the other.
    Rep,
    /// Subscribers hear what is published.
    Pub,
    /// All peers are told everything, and acknowledge it.
    Dealer,
}

impl Kind {
    fn socket_type(self) -> SocketType {
        match self {
            Self::Router => SocketType::Router,
            Self::Rep => SocketType::Rep,
            Self::Pub => SocketType::Pub,
            Self::Dealer => SocketType::Dealer,
        }
    }

    fn answers(self) -> bool {
        matches!(self, Self::Router | Self::Rep)
    }
}

/// How a socket is set up.
#[derive(Clone, Copy, Debug)]
pub struct ListenerConfig {
    /// The thread's name.
    pub name: &'static str,
    /// What the socket is for.
    pub kind: Kind,
    /// Longest message that is taken, in bytes: a peer that sends a longer one is disconnected.
    pub most_bytes: usize,
    /// Most messages that wait for a peer that does not take them: it misses those beyond.
    pub backlog: usize,
}

/// What a socket tells.
pub enum Event {
    /// A message of a peer.
    Message(PeerId, Received),
    /// The peer has gone, or was cut off.
    Gone(PeerId),
}

/// Where it tells it.
type Sink = Arc<dyn Fn(Event) + Send + Sync>;

/// How long a handshake may take.
const HANDSHAKE: Duration = Duration::from_secs(2);

/// How long a peer may take nothing of what is sent to it.
const STALL: Duration = Duration::from_secs(5);

/// Who takes nothing for so long makes room for others first.
const CLOGGED: Duration = Duration::from_millis(100);

/// Requests of a peer that are handed over before their answers.
const OUTSTANDING: usize = 8;

/// What the system keeps of what is sent to a subscriber, in bytes: about a second at 1 ms.
const SEND_BUFFER: usize = 128 << 10;

/// Connections that the system keeps until they are accepted.
const PENDING: u32 = 1024;

/// A socket that others connect to. It ends when it is dropped.
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
    /// The address cannot be had, or the system starts no thread.
    pub(crate) fn start(
        config: ListenerConfig,
        mechanism: MechanismSetup,
        at: SocketAddr,
        sink: impl Fn(Event) + Send + Sync + 'static,
    ) -> Result<Self, LinkError> {
        let refuse = |source| LinkError::Bind { at: format!("tcp://{at}"), source };
        let runtime = super::runtime().map_err(|source| LinkError::Thread { source })?;
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
                most_bytes: config.most_bytes,
                long: Some(Arc::new(Semaphore::new(1))),
            },
            sink: Arc::new(sink),
            peers: Mutex::default(),
            over: Notify::new(),
        });
        let thread = {
            let shared = shared.clone();
            let run = move || run(&runtime, &shared, &listener);
            thread::Builder::new().name(name.to_owned()).spawn(run)
        };
        let thread = Some(thread.map_err(|source| LinkError::Thread { source })?);
        Ok(Self { at, shared, thread })
    }

    /// Where it is bound, as `tcp://127.0.0.1:5560`.
    pub fn at(&self) -> &str {
        &self.at
    }

    /// Sends a message to a peer, or nothing if it has gone. `hold` is kept until it is sent.
    pub fn send(&self, to: PeerId, frames: Frames, hold: Option<Box<dyn Send>>) {
        if let Some(peer) = self.shared.peers().connected.get(&to) {
            // Where there is no room, it does not read what it asked for.
            let _ = peer.inbox.try_send(Outgoing { frames, hold });
        }
    }

    /// Sends a message to all peers; to subscribers if they want its topic, the first frame.
    pub fn publish(&self, frames: &Frames) {
        for peer in self.shared.peers().connected.values() {
            if peer.standing.stage >= Stage::Clogged {
                // Who does not keep up misses it.
                let _ = peer.inbox.try_send(Outgoing { frames: frames.clone(), hold: None });
            }
        }
    }
}

impl Drop for Listener {
    fn drop(&mut self) {
        self.shared.over.notify_one();
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

fn bind(at: SocketAddr) -> io::Result<TcpListener> {
    let socket = if at.is_ipv4() { TcpSocket::new_v4() } else { TcpSocket::new_v6() }?;
    // What is left of connections that were closed does not count.
    #[cfg(unix)]
    socket.set_reuseaddr(true)?;
    socket.bind(at)?;
    socket.listen(PENDING)
}

struct Shared {
    kind: Kind,
    backlog: usize,
    wire: WireConfig,
    sink: Sink,
    peers: Mutex<Peers>,
    over: Notify,
}

#[derive(Default)]
struct Peers {
    next: PeerId,
    connected: HashMap<PeerId, Peer>,
}

struct Peer {
    standing: Standing,
    inbox: mpsc::Sender<Outgoing>,
    task: Option<AbortHandle>,
}

struct Outgoing {
    frames: Frames,
    hold: Option<Box<dyn Send>>,
}

impl Shared {
    fn peers(&self) -> MutexGuard<'_, Peers> {
        // A task that panicked has left a table that is whole.
        self.peers.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A connection has come to another stage.
    fn set_stage(&self, id: PeerId, stage: Stage) {
        if let Some(peer) = self.peers().connected.get_mut(&id) {
            peer.standing.stage = stage;
            peer.standing.since = Instant::now();
        }
    }

    /// Makes room for one more stranger or peer. `false` if there is none.
    fn make_room(&self, stranger: bool) -> bool {
        let mut peers = self.peers();
        let standings = peers.connected.iter().map(|(id, peer)| (id, &peer.standing));
        match room(standings, stranger) {
            Room::Enough => true,
            Room::None => false,
            Room::For(id) => {
                // Its task ends later; its place is free from now on.
                if let Some(task) = peers.connected.remove(&id).and_then(|peer| peer.task) {
                    task.abort();
                }
                true
            }
        }
    }
}

/// Accepts connections until it is over.
fn run(runtime: &Runtime, shared: &Arc<Shared>, listener: &TcpListener) {
    let accept = async {
        loop {
            match listener.accept().await {
                Ok((stream, from)) => admit(shared, stream, from.ip()),
                Err(error) => {
                    // As a rule, too many files are open: somebody has to go.
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
            () = shared.over.notified() => {}
        }
    });
}

fn admit(shared: &Arc<Shared>, stream: TcpStream, address: IpAddr) {
    if !shared.make_room(true) {
        return;
    }
    if shared.kind == Kind::Pub {
        // Who does not keep up misses messages here, rather than later all at once.
        let _ = SockRef::from(&stream).set_send_buffer_size(SEND_BUFFER);
    }
    let (inbox, outgoing) = mpsc::channel(shared.backlog.max(2 * OUTSTANDING));
    let id = {
        let mut peers = shared.peers();
        peers.next += 1;
        let id = peers.next;
        let standing = Standing { address, stage: Stage::Silent, since: Instant::now() };
        peers.connected.insert(id, Peer { standing, inbox, task: None });
        id
    };
    let seat = Seat { id, shared: shared.clone(), admitted: false };
    let task = tokio::spawn(async move {
        if let Err(error) = attend(seat, stream, outgoing).await {
            tracing::debug!("connection of {address}: {error}");
        }
    });
    if let Some(peer) = shared.peers().connected.get_mut(&id) {
        peer.task = Some(task.abort_handle());
    }
}

/// A connection's place, which is free when this is dropped.
struct Seat {
    id: PeerId,
    shared: Arc<Shared>,
    admitted: bool,
}

impl Drop for Seat {
    fn drop(&mut self) {
        self.shared.peers().connected.remove(&self.id);
        if self.admitted {
            (self.shared.sink)(Event::Gone(self.id));
        }
    }
}

/// Serves a connection until it ends.
async fn attend(
    mut seat: Seat,
    stream: TcpStream,
    mut outgoing: mpsc::Receiver<Outgoing>,
) -> Result<(), WireError> {
    let shared = seat.shared.clone();
    let mut wire = timeout(HANDSHAKE, async {
        // Who sends nothing costs nothing.
        stream.readable().await?;
        shared.set_stage(seat.id, Stage::Greeting);
        let mut wire = Wire::new(stream, shared.wire.clone());
        wire.shake_hands().await.map(|_| wire)
    })
    .await
    .map_err(|_| WireError::Stalled(HANDSHAKE))??;
    if !shared.make_room(false) {
        return Ok(());
    }
    seat.admitted = true;
    let mut topics = Subscriptions::default();
    // Requests without an answer so far.
    let mut open = 0;
    // What is kept until all is sent.
    let mut holds = Vec::new();
    loop {
        let stage = match shared.kind {
            Kind::Pub => Stage::Served,
            _ if open > 0 => Stage::Served,
            _ => Stage::Idle,
        };
        shared.set_stage(seat.id, stage);
        while wire.has_to_send() {
            if let Ok(sent) = timeout(CLOGGED, wire.send_some()).await {
                sent?;
            } else {
                shared.set_stage(seat.id, Stage::Clogged);
                let sent = timeout(STALL, wire.send_some()).await;
                sent.map_err(|_| WireError::Stalled(STALL))??;
            }
        }
        holds.clear();
        tokio::select! {
            biased;
            Some(Outgoing { frames, hold }) = outgoing.recv() => {
                open = usize::saturating_sub(open, usize::from(shared.kind.answers()));
                if shared.kind != Kind::Pub || topics.want(&frames[0]) {
                    wire.queue(&frames)?;
                    holds.extend(hold);
                }
            }
            incoming = wire.receive(), if open < OUTSTANDING => match incoming? {
                Incoming::Message(received) => {
                    open += usize::from(shared.kind.answers());
                    (shared.sink)(Event::Message(seat.id, received));
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
