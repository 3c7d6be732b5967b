//! Attackers that exhaust resources; each kind runs in separate threads until it is dropped.

use std::{
    collections::VecDeque,
    io::{self, Read, Write},
    net::{SocketAddr, TcpStream},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

use super::rig::Addresses;
use iiwasim_tests::zmtp::{HANDSHAKE_TIMEOUT, Peer, frame_head, message, subscription};

/// Number of attackers and amount of data.
#[derive(Clone, Copy, Debug)]
pub(super) struct Size {
    /// Connections to each port.
    pub(super) connections: usize,
    /// Connections to each port that complete the handshake.
    pub(super) handshakes: usize,
    /// Topics of a subscriber, in bytes.
    pub(super) topics: usize,
}

/// Kind of attack.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    SilentConnections,
    HalfRequests,
    SilentHandshakes,
    LongRequests,
    StalledSubscribers,
    Topics,
    UnreadReplies,
    Pipelines,
    Trickle,
    Handshakes,
    Subscribers,
}

impl Kind {
    /// All kinds.
    pub(super) const ALL: [Self; 11] = [
        Self::SilentConnections,
        Self::HalfRequests,
        Self::SilentHandshakes,
        Self::LongRequests,
        Self::StalledSubscribers,
        Self::Topics,
        Self::UnreadReplies,
        Self::Pipelines,
        Self::Trickle,
        Self::Handshakes,
        Self::Subscribers,
    ];

    /// Name in the table.
    pub(super) fn name(self, size: &Size) -> String {
        let Size { connections, handshakes, topics } = size;
        match self {
            Self::SilentConnections => {
                format!("{} silent connections", 5 * connections)
            }
            Self::HalfRequests => format!("{HALF_REQUESTS} half requests to the twin"),
            Self::SilentHandshakes => format!("{} handshakes, then silence", 4 * handshakes),
            Self::LongRequests => format!("{LONG_REQUESTS} clients with requests of 31 and 60 MB"),
            Self::StalledSubscribers => {
                format!("{STALLED_SUBSCRIBERS} subscribers that do not read")
            }
            Self::Topics => format!("a subscriber with {} MB of topics", topics / 1_000_000),
            Self::UnreadReplies => format!("{UNREAD_CLIENTS} clients that leave `last_run` unread"),
            Self::Pipelines => format!("{CROWD} clients with 8 requests pending"),
            Self::Trickle => "a long request at a byte per 1.5 s".to_owned(),
            Self::Handshakes => format!("{HANDSHAKES_PER_S} handshakes per second"),
            Self::Subscribers => format!("{CROWD} subscribers of `state`"),
        }
    }

    /// Returns true for attacks on the stream, which must not affect trajectories.
    pub(super) fn is_subscriber(self) -> bool {
        matches!(self, Self::StalledSubscribers | Self::Topics | Self::Subscribers)
    }

    /// Starts the attack.
    pub(super) fn start(self, addresses: &Addresses, size: &Size) -> Attack {
        let mut attack = Attack::default();
        match self {
            Self::SilentConnections => {
                for to in addresses.ports() {
                    attack.hold(size.connections, move || open(to));
                }
            }
            Self::HalfRequests => {
                let to = addresses.twin;
                attack.hold(HALF_REQUESTS, move || {
                    let mut stream = open(to)?;
                    stream.write_all(b"GET /live HTTP/1.1\r\nHost: 127.0.0.1\r\nX-Half: ")?;
                    Ok(stream)
                });
            }
            Self::SilentHandshakes => {
                for (to, kind) in [
                    (addresses.requests, "DEALER"),
                    (addresses.stream, "SUB"),
                    (addresses.cabinet_instructions, "DEALER"),
                    (addresses.cabinet_state, "REP"),
                ] {
                    attack.hold(size.handshakes, move || {
                        Ok(Peer::connect(to, kind, HANDSHAKE_TIMEOUT)?.stream)
                    });
                }
            }
            Self::LongRequests => {
                let bodies = LONG_REQUEST_BYTES
                    .map(|bytes| [Arc::new(garbage(bytes)), Arc::new(trajectory(bytes))]);
                for i in 0..LONG_REQUESTS {
                    let (to, body) = (addresses.requests, Arc::clone(&bodies[i % 2][i / 2 % 2]));
                    attack.spawn(move |shutdown| long_requests(to, &body, shutdown));
                }
            }
            Self::StalledSubscribers => {
                let to = addresses.stream;
                attack.hold(STALLED_SUBSCRIBERS, move || {
                    let mut peer = Peer::connect(to, "SUB", HANDSHAKE_TIMEOUT)?;
                    peer.stream.write_all(&subscription(b""))?;
                    Ok(peer.stream)
                });
            }
            Self::Topics => {
                let (to, bytes) = (addresses.stream, size.topics);
                attack.spawn(move |shutdown| topics(to, bytes, shutdown));
            }
            Self::UnreadReplies => {
                for _ in 0..UNREAD_CLIENTS {
                    let to = addresses.requests;
                    attack.spawn(move |shutdown| unread_replies(to, shutdown));
                }
            }
            Self::Pipelines => {
                for _ in 0..CROWD {
                    let to = addresses.requests;
                    attack.spawn(move |shutdown| pipeline(to, shutdown));
                }
            }
            Self::Trickle => {
                let to = addresses.requests;
                attack.spawn(move |shutdown| trickle(to, shutdown));
            }
            Self::Handshakes => {
                let to = addresses.requests;
                attack.spawn(move |shutdown| handshakes(to, shutdown));
            }
            Self::Subscribers => {
                let to = addresses.stream;
                attack.hold(CROWD, move || {
                    let mut peer = Peer::connect(to, "SUB", HANDSHAKE_TIMEOUT)?;
                    peer.stream.write_all(&subscription(b"state"))?;
                    Ok(peer.stream)
                });
            }
        }
        attack
    }
}

const HALF_REQUESTS: usize = 1100;
const LONG_REQUESTS: usize = 12;
const STALLED_SUBSCRIBERS: usize = 3;
const UNREAD_CLIENTS: usize = 3;
const HANDSHAKES_PER_S: u32 = 1500;

/// More connections than a socket accepts.
const CROWD: usize = 66;

/// Request sizes below and above the limit of a drive, 32 MiB.
const LONG_REQUEST_BYTES: [usize; 2] = [31_000_000, 60_000_000];

/// Attack in progress.
#[derive(Default)]
pub(super) struct Attack {
    shutdown: Arc<AtomicBool>,
    threads: Vec<JoinHandle<()>>,
}

impl Attack {
    fn spawn(&mut self, work: impl FnOnce(&AtomicBool) + Send + 'static) {
        let shutdown = Arc::clone(&self.shutdown);
        self.threads.push(thread::spawn(move || {
            lower();
            work(&shutdown);
        }));
    }

    /// Keeps a number of connections open, and reopens closed ones.
    fn hold(
        &mut self,
        count: usize,
        open: impl Fn() -> io::Result<TcpStream> + Send + Copy + 'static,
    ) {
        // Several threads: when connections are no longer accepted, each attempt takes long.
        const THREADS: usize = 4;
        for i in 0..THREADS {
            let count = count / THREADS + usize::from(i < count % THREADS);
            self.spawn(move |shutdown| hold(count, open, shutdown));
        }
    }
}

impl Drop for Attack {
    fn drop(&mut self) {
        self.shutdown.store(true, Ordering::Relaxed);
        for thread in self.threads.drain(..) {
            let _ = thread.join();
        }
    }
}

/// Lowers the priority of the thread: attackers on other machines would take no processor time from
/// the programs.
fn lower() {
    #[cfg(target_os = "linux")]
    let _ = rustix::process::nice(10);
}

fn hold(count: usize, open: impl Fn() -> io::Result<TcpStream>, shutdown: &AtomicBool) {
    /// Consecutive attempts before open connections are checked.
    const AT_A_TIME: usize = 50;
    let mut streams: Vec<TcpStream> = Vec::with_capacity(count);
    while !shutdown.load(Ordering::Relaxed) {
        streams.retain(|stream| !is_closed(stream));
        for _ in 0..AT_A_TIME.min(count - streams.len()) {
            if shutdown.load(Ordering::Relaxed) {
                return;
            }
            let Ok(stream) = open() else { break };
            if stream.set_nonblocking(true).is_ok() {
                streams.push(stream);
            }
        }
        thread::sleep(Duration::from_millis(50));
    }
}

fn is_closed(stream: &TcpStream) -> bool {
    match stream.peek(&mut [0]) {
        Ok(count) => count == 0,
        Err(error) => error.kind() != io::ErrorKind::WouldBlock,
    }
}

fn open(to: SocketAddr) -> io::Result<TcpStream> {
    TcpStream::connect_timeout(&to, Duration::from_millis(100))
}

/// Sends a long request repeatedly, and waits a while for each reply.
fn long_requests(to: SocketAddr, body: &[u8], shutdown: &AtomicBool) {
    while !shutdown.load(Ordering::Relaxed) {
        let Ok(mut peer) = Peer::connect(to, "REQ", HANDSHAKE_TIMEOUT) else {
            thread::sleep(Duration::from_millis(100));
            continue;
        };
        // Repeats until the request is rejected, or takes too long.
        loop {
            let head = [message(&[b"", b""])[..2].to_vec(), frame_head(0, body.len())].concat();
            if push(&mut peer.stream, &head, shutdown).is_err()
                || push(&mut peer.stream, body, shutdown).is_err()
            {
                break;
            }
            let since = Instant::now();
            while !shutdown.load(Ordering::Relaxed)
                && since.elapsed() < Duration::from_secs(10)
                && peer.stream.set_nonblocking(true).is_ok()
                && peer
                    .stream
                    .peek(&mut [0])
                    .is_err_and(|error| error.kind() == io::ErrorKind::WouldBlock)
            {
                thread::sleep(Duration::from_millis(10));
            }
            if peer.stream.set_nonblocking(false).is_err()
                || peer.receive(Duration::from_secs(1)).is_err()
            {
                break;
            }
        }
    }
}

/// Returns a request with an unterminated string.
fn garbage(bytes: usize) -> Vec<u8> {
    let mut text = br#"{"type": "run_motions", "motions": ""#.to_vec();
    text.resize(bytes, b'x');
    text
}

/// Returns a well-formed trajectory at rest far from the arm: it is rejected after parsing.
pub(super) fn trajectory(bytes: usize) -> Vec<u8> {
    // At full precision, as programs write numbers.
    let point = b"[2.012345678901234,1.012345678901234,1.012345678901234,1.012345678901234,\
        1.012345678901234,1.012345678901234,1.012345678901234],";
    let stamp = |i: usize| format!("{:.3},", 0.004 * i as f64);
    let count = (bytes - 1000) / (point.len() + 9);
    let mut text = br#"{"type": "run_trajectory", "trajectory": {"t_s": ["#.to_vec();
    (0..count).for_each(|i| text.extend(stamp(i).as_bytes()));
    text.pop();
    text.extend(br#"], "joints_rad": ["#);
    (0..count).for_each(|_| text.extend(point));
    text.pop();
    text.extend(b"]}}");
    text
}

/// Subscribes to a large number of topics, repeatedly.
fn topics(to: SocketAddr, bytes: usize, shutdown: &AtomicBool) {
    let mut random = fastrand::Rng::with_seed(1);
    while !shutdown.load(Ordering::Relaxed) {
        if let Ok(mut peer) = Peer::connect(to, "SUB", HANDSHAKE_TIMEOUT) {
            let mut sent = 0;
            while sent < bytes {
                let mut topic = [0; 900];
                random.fill(&mut topic);
                let command = subscription(&topic);
                if push(&mut peer.stream, &command, shutdown).is_err() {
                    break;
                }
                sent += command.len();
            }
            sleep(Duration::from_millis(500), shutdown);
        } else {
            sleep(Duration::from_millis(100), shutdown);
        }
    }
}

/// Requests the last run repeatedly, without reading replies.
fn unread_replies(to: SocketAddr, shutdown: &AtomicBool) {
    let requests = message(&[b"", br#"{"type": "last_run"}"#]).repeat(100);
    while !shutdown.load(Ordering::Relaxed) {
        if let Ok(mut peer) = Peer::connect(to, "DEALER", HANDSHAKE_TIMEOUT) {
            while push(&mut peer.stream, &requests, shutdown).is_ok() {
                thread::sleep(Duration::from_millis(1));
            }
        } else {
            sleep(Duration::from_millis(100), shutdown);
        }
    }
}

/// Keeps requests pending, and connects again when it is disconnected.
fn pipeline(to: SocketAddr, shutdown: &AtomicBool) {
    let requests = message(&[b"", br#"{"type": "state"}"#]).repeat(100);
    let mut replies = vec![0; 1 << 16];
    while !shutdown.load(Ordering::Relaxed) {
        let Ok(mut peer) = Peer::connect(to, "DEALER", HANDSHAKE_TIMEOUT) else {
            sleep(Duration::from_millis(100), shutdown);
            continue;
        };
        if peer.stream.set_nonblocking(true).is_err() {
            continue;
        }
        let mut rest = &*requests;
        while !shutdown.load(Ordering::Relaxed) {
            let read = peer.stream.read(&mut replies);
            let written = peer.stream.write(rest);
            if let Ok(count) = written {
                rest = if count < rest.len() { &rest[count..] } else { &requests };
            }
            if matches!(read, Ok(0)) || is_failure(&read) || is_failure(&written) {
                break;
            }
            thread::sleep(Duration::from_millis(1));
        }
    }
}

fn is_failure(result: &io::Result<usize>) -> bool {
    result.as_ref().is_err_and(|error| error.kind() != io::ErrorKind::WouldBlock)
}

/// Sends a long request byte by byte.
fn trickle(to: SocketAddr, shutdown: &AtomicBool) {
    while !shutdown.load(Ordering::Relaxed) {
        let Ok(mut peer) = Peer::connect(to, "DEALER", HANDSHAKE_TIMEOUT) else {
            sleep(Duration::from_millis(100), shutdown);
            continue;
        };
        let head = [message(&[b"", b""])[..2].to_vec(), frame_head(0, 31_000_000)].concat();
        let mut sent = peer.stream.write_all(&head);
        while sent.is_ok() && !shutdown.load(Ordering::Relaxed) {
            sleep(Duration::from_millis(1500), shutdown);
            sent = peer.stream.write_all(b"[");
        }
    }
}

/// Opens connections at a constant rate, and begins the handshake with each.
fn handshakes(to: SocketAddr, shutdown: &AtomicBool) {
    const OPEN: usize = 200;
    let mut streams = VecDeque::with_capacity(OPEN);
    let begin = Instant::now();
    let mut count = 0;
    while !shutdown.load(Ordering::Relaxed) {
        let due = begin + Duration::from_secs(1) * count / HANDSHAKES_PER_S;
        thread::sleep(due.saturating_duration_since(Instant::now()));
        count += 1;
        if let Ok(mut stream) = open(to) {
            // Every second connection sends the whole greeting of a client with keys.
            let bytes = if count % 2 == 0 { 64 } else { 1 };
            let _ = stream.write_all(&CURVE_GREETING[..bytes]);
            streams.push_back(stream);
        }
        if streams.len() > OPEN {
            streams.pop_front();
        }
    }
}

/// Greeting: signature, version 3.1, mechanism CURVE.
const CURVE_GREETING: [u8; 64] = {
    let mut greeting = [0; 64];
    greeting[0] = 0xff;
    greeting[9] = 0x7f;
    greeting[10] = 3;
    greeting[11] = 1;
    greeting[12] = b'C';
    greeting[13] = b'U';
    greeting[14] = b'R';
    greeting[15] = b'V';
    greeting[16] = b'E';
    greeting
};

/// Sends bytes until the attack ends.
fn push(stream: &mut TcpStream, mut bytes: &[u8], shutdown: &AtomicBool) -> io::Result<()> {
    stream.set_write_timeout(Some(Duration::from_millis(100)))?;
    while !bytes.is_empty() {
        if shutdown.load(Ordering::Relaxed) {
            return Err(io::ErrorKind::Interrupted.into());
        }
        match stream.write(&bytes[..bytes.len().min(1 << 20)]) {
            Ok(0) => return Err(io::ErrorKind::WriteZero.into()),
            Ok(count) => bytes = &bytes[count..],
            Err(error)
                if matches!(error.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut) => {}
            Err(error) => return Err(error),
        }
    }
    Ok(())
}

fn sleep(duration: Duration, shutdown: &AtomicBool) {
    let since = Instant::now();
    while since.elapsed() < duration && !shutdown.load(Ordering::Relaxed) {
        thread::sleep(Duration::from_millis(20));
    }
}
