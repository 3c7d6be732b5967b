//! Sockets of bare peers: each connection has a receiving thread.

use std::{
    collections::{BTreeMap, VecDeque},
    io::{self, Write as _},
    net::{Shutdown, SocketAddr, TcpListener, TcpStream, ToSocketAddrs as _},
    sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError},
    thread::{self, JoinHandle, Thread},
    time::{Duration, Instant},
};

use super::{SEND_TIMEOUT, SocketType};
use crate::zmtp::{Peer, message, subscription};

/// Time between attempts to connect.
const RETRY: Duration = Duration::from_millis(20);

/// Time longer than any test.
const FOREVER: Duration = Duration::from_hours(24);

/// Socket of bare peers.
pub struct BareSocket {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
    /// Listening address, if bound.
    bound: Option<SocketAddr>,
}

/// Shared state of a socket and its threads.
struct Shared {
    kind: SocketType,
    state: Mutex<SocketState>,
    /// Signals a ready connection, a received message, or the end of the socket.
    changed: Condvar,
}

#[derive(Default)]
struct SocketState {
    is_dropped: bool,
    topics: Vec<Vec<u8>>,
    /// Connections by route; the newest is last.
    connections: BTreeMap<Vec<u8>, Arc<TcpStream>>,
    /// Number of connections so far.
    count: u32,
    inbox: VecDeque<Vec<Vec<u8>>>,
    /// Thread that waits for a message.
    receiver: Option<Thread>,
}

impl BareSocket {
    /// Creates a socket that connects to an address such as `tcp://127.0.0.1:30001`, in the
    /// background.
    ///
    /// # Errors
    ///
    /// An error if the address is invalid, or the thread cannot be started.
    pub fn connect(kind: SocketType, address: &str) -> io::Result<Self> {
        let address = parse(address)?;
        Self::start(kind, None, move |shared| shared.keep_connected(address))
    }

    /// Creates a socket that listens at an address such as `tcp://127.0.0.1:30001`.
    ///
    /// # Errors
    ///
    /// An error if the address is invalid or in use, or the thread cannot be started.
    pub fn bind(kind: SocketType, address: &str) -> io::Result<Self> {
        let listener = TcpListener::bind(parse(address)?)?;
        let bound = listener.local_addr()?;
        Self::start(kind, Some(bound), move |shared| shared.accept_all(&listener))
    }

    fn start(
        kind: SocketType,
        bound: Option<SocketAddr>,
        run: impl FnOnce(&Shared) + Send + 'static,
    ) -> io::Result<Self> {
        let state = Mutex::new(SocketState::default());
        let shared = Arc::new(Shared { kind, state, changed: Condvar::new() });
        let of_thread = Arc::clone(&shared);
        let thread = thread::Builder::new().spawn(move || run(&of_thread))?;
        Ok(Self { shared, thread: Some(thread), bound })
    }

    /// Subscribes to topics with a prefix.
    ///
    /// # Errors
    ///
    /// An error if the socket is of another type.
    pub fn subscribe(&self, topic: &[u8]) -> io::Result<()> {
        if self.shared.kind != SocketType::Sub {
            return Err(io::ErrorKind::InvalidInput.into());
        }
        let mut state = self.shared.lock();
        state.topics.push(topic.to_vec());
        state.connections.values().for_each(|stream| write(stream, &subscription(topic)));
        Ok(())
    }

    /// Sends a message, once there is a connection.
    ///
    /// # Errors
    ///
    /// An error without a connection within 10 s.
    pub fn send(&self, frames: &[impl AsRef<[u8]>]) -> io::Result<()> {
        if self.send_within(frames, SEND_TIMEOUT) {
            Ok(())
        } else {
            Err(io::ErrorKind::TimedOut.into())
        }
    }

    /// Sends a message if there is a connection; returns true if sent.
    pub fn try_send(&self, frames: &[impl AsRef<[u8]>]) -> bool {
        self.send_within(frames, Duration::ZERO)
    }

    fn send_within(&self, frames: &[impl AsRef<[u8]>], timeout: Duration) -> bool {
        let mut frames: Vec<&[u8]> = frames.iter().map(AsRef::as_ref).collect();
        let stream = if self.shared.kind == SocketType::Router && !frames.is_empty() {
            let state = self.shared.lock();
            let Some(stream) = state.connections.get(frames.remove(0)) else { return true };
            Arc::clone(stream)
        } else {
            let Some(stream) = self.shared.newest(timeout) else { return false };
            stream
        };
        if self.shared.kind == SocketType::Req {
            frames.insert(0, b"");
        }
        write(&stream, &message(&frames));
        true
    }

    /// Returns the next message, if it arrives within `timeout`.
    #[must_use]
    pub fn receive(&self, timeout: Duration) -> Option<Vec<Vec<u8>>> {
        receive_any(&[self], timeout).map(|(_, frames)| frames)
    }
}

impl Drop for BareSocket {
    fn drop(&mut self) {
        let mut state = self.shared.lock();
        state.is_dropped = true;
        for stream in state.connections.values() {
            // The peer may have closed the connection.
            let _ = stream.shutdown(Shutdown::Both);
        }
        drop(state);
        self.shared.changed.notify_all();
        // A thread that waits for connections ends with the next one. The thread may have ended
        // already.
        let _ = self.bound.map(TcpStream::connect);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// Returns the next message of several sockets with the index of its socket, if it arrives within
/// `timeout`.
#[must_use]
pub fn receive_any(sockets: &[&BareSocket], timeout: Duration) -> Option<(usize, Vec<Vec<u8>>)> {
    let end = Instant::now() + timeout;
    loop {
        for (place, socket) in sockets.iter().enumerate() {
            let mut state = socket.shared.lock();
            if let Some(frames) = state.inbox.pop_front() {
                socket.shared.changed.notify_all();
                return Some((place, frames));
            }
            state.receiver = Some(thread::current());
        }
        let left = end.saturating_duration_since(Instant::now());
        if left.is_zero() {
            return None;
        }
        thread::park_timeout(left);
    }
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, SocketState> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Connects repeatedly, until the socket is dropped.
    fn keep_connected(&self, address: SocketAddr) {
        loop {
            if let Ok(peer) = Peer::silent(address, SEND_TIMEOUT) {
                // The next iteration reconnects.
                let _ = self.serve(peer.stream);
            }
            let state = self.lock();
            let wait = self.changed.wait_timeout_while(state, RETRY, |state| !state.is_dropped);
            if wait.unwrap_or_else(PoisonError::into_inner).0.is_dropped {
                return;
            }
        }
    }

    /// Accepts connections until the socket is dropped.
    fn accept_all(&self, listener: &TcpListener) {
        thread::scope(|scope| {
            loop {
                let accepted = listener.accept();
                if self.lock().is_dropped {
                    return;
                }
                if let Ok((stream, _)) = accepted {
                    // The peer reconnects.
                    scope.spawn(|| drop(self.serve(stream)));
                }
            }
        });
    }

    /// Performs the handshake, and receives messages until the connection ends.
    fn serve(&self, stream: TcpStream) -> io::Result<()> {
        let mut peer = Peer::shake_hands(stream, name(self.kind), SEND_TIMEOUT)?;
        let mut state = self.lock();
        if state.is_dropped {
            return Ok(());
        }
        state.topics.iter().for_each(|topic| write(&peer.stream, &subscription(topic)));
        state.count += 1;
        // Format of `libzmq`: a zero and four bytes.
        let route = [&[0], state.count.to_be_bytes().as_slice()].concat();
        state.connections.insert(route.clone(), Arc::new(peer.stream.try_clone()?));
        drop(state);
        self.changed.notify_all();
        let end = self.receive_all(&mut peer, &route);
        self.lock().connections.remove(&route);
        end
    }

    fn receive_all(&self, peer: &mut Peer, route: &[u8]) -> io::Result<()> {
        loop {
            let mut frames = peer.receive(FOREVER)?;
            match self.kind {
                SocketType::Router => frames.insert(0, route.to_vec()),
                // A message without the empty frame is invalid.
                SocketType::Req if !frames.remove(0).is_empty() => continue,
                _ => {}
            }
            self.deliver(frames);
        }
    }

    /// Queues a message, once there is room.
    fn deliver(&self, frames: Vec<Vec<u8>>) {
        let room = if self.kind == SocketType::Sub { 1 } else { 1000 };
        let is_full = |state: &mut SocketState| state.inbox.len() >= room && !state.is_dropped;
        let wait = self.changed.wait_while(self.lock(), is_full);
        let mut state = wait.unwrap_or_else(PoisonError::into_inner);
        state.inbox.push_back(frames);
        if let Some(receiver) = state.receiver.take() {
            receiver.unpark();
        }
    }

    /// Returns the newest connection, once there is one.
    fn newest(&self, timeout: Duration) -> Option<Arc<TcpStream>> {
        let is_alone = |state: &mut SocketState| state.connections.is_empty();
        let wait = self.changed.wait_timeout_while(self.lock(), timeout, is_alone);
        let state = wait.unwrap_or_else(PoisonError::into_inner).0;
        state.connections.values().next_back().map(Arc::clone)
    }
}

/// Returns the name of a socket type in the handshake.
fn name(kind: SocketType) -> &'static str {
    match kind {
        SocketType::Req => "REQ",
        SocketType::Dealer => "DEALER",
        SocketType::Router => "ROUTER",
        SocketType::Sub => "SUB",
    }
}

/// Writes to a connection, and closes it after a failure.
fn write(mut stream: &TcpStream, bytes: &[u8]) {
    if stream.write_all(bytes).is_err() {
        // The receiving thread then ends.
        let _ = stream.shutdown(Shutdown::Both);
    }
}

fn parse(address: &str) -> io::Result<SocketAddr> {
    let mut addresses = address.trim_start_matches("tcp://").to_socket_addrs()?;
    addresses.next().ok_or_else(|| io::ErrorKind::AddrNotAvailable.into())
}
