//! A connection: a TCP stream and the state machine of the protocol.

use std::{
    hash::{BuildHasher, RandomState},
    io,
    sync::Arc,
    time::{Duration, Instant},
};

use bytes::{Bytes, BytesMut};
use omq_proto::{
    Error as ProtocolError, MechanismSetup, Message, SocketType,
    proto::{Command, Connection, ConnectionConfig, Event, Role},
};
use socket2::{SockRef, TcpKeepalive};
use tokio::{
    net::TcpStream,
    sync::{OwnedSemaphorePermit, Semaphore},
    time::timeout,
};

use super::meter::Meter;
use crate::security::{ConnectionRefusal, Endpoint};

/// Frames of a message.
pub type Frames = Vec<Bytes>;

/// Permission to have a long message in transit, valid until dropped.
pub type Permit = OwnedSemaphorePermit;

/// Configuration of a connection.
#[derive(Clone)]
pub(crate) struct WireConfig {
    pub(crate) role: Role,
    pub(crate) kind: SocketType,
    pub(crate) mechanism: MechanismSetup,
    /// Maximum message length, in bytes.
    pub(crate) max_bytes: usize,
    /// Limit of the number of long messages in transit; `None` if messages are short or come from
    /// one trusted peer only.
    pub(crate) long: Option<Arc<Semaphore>>,
}

/// Reason why a connection ended.
#[derive(Debug, thiserror::Error)]
pub(crate) enum ConnectionEnd {
    /// The other side has closed the connection.
    #[error("the connection was closed")]
    Closed,
    /// An I/O error.
    #[error("{0}")]
    Io(#[from] io::Error),
    /// One side has refused the other.
    #[error("{}", .0.reason())]
    Refused(ConnectionRefusal),
    /// The other side has violated the protocol.
    #[error("{0}")]
    Protocol(ProtocolError),
    /// The other side has made no progress.
    #[error("no progress within {} s", .0.as_secs_f64())]
    Stalled(Duration),
    /// A long message arrives too slowly.
    #[error("a long message arrives at less than {LONG_BYTES_PER_S} bytes per second")]
    Slow,
}

impl From<ProtocolError> for ConnectionEnd {
    fn from(error: ProtocolError) -> Self {
        match error {
            ProtocolError::HandshakeRefused(_) => Self::Refused(ConnectionRefusal::NotAllowed),
            ProtocolError::Closed => Self::Closed,
            error => Self::Protocol(error),
        }
    }
}

/// A received message.
#[derive(Debug)]
pub struct ReceivedMessage {
    /// Frames of the message.
    pub frames: Frames,
    /// The permit of a long message: until it is dropped, no other long message is received.
    pub permit: Option<Permit>,
    /// Arrival time of the first bytes.
    pub began: Instant,
}

/// Input of a connection.
#[derive(Debug)]
pub(crate) enum WireInput {
    Message(ReceivedMessage),
    /// A subscription to topics with a prefix.
    Subscribe(Bytes),
    /// The end of a subscription.
    Cancel(Bytes),
}

/// Maximum length of a short message, in bytes.
pub const SHORT_BYTES: usize = 64 << 10;

/// Maximum length of a handshake, in bytes.
const HANDSHAKE_BYTES: usize = 4 << 10;

/// Maximum pause within a long message.
const MAX_PAUSE: Duration = Duration::from_secs(2);

/// Minimum mean rate of a long message after the first [`MAX_PAUSE`], so that it ends in bounded
/// time.
const LONG_BYTES_PER_S: u64 = 1 << 20;

/// A step of the handshake, seen from the listening side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum HandshakeStep {
    /// A part of the greeting was received.
    Greeting,
    /// The greeting was received.
    Greeted,
    /// The first command was received and is valid.
    Introduced,
}

/// Arrival of a long message.
#[derive(Clone, Copy, Debug)]
struct Arrival {
    since: Instant,
    bytes: u64,
}

impl Arrival {
    /// Returns the time-out of the next bytes.
    fn patience(&self, now: Instant) -> Duration {
        let in_time = Duration::from_millis(self.bytes * 1000 / LONG_BYTES_PER_S);
        (MAX_PAUSE + in_time).saturating_sub(now - self.since).min(MAX_PAUSE)
    }
}

const GREETING_BYTES: usize = 64;

/// Position of the security mechanism within a greeting.
const MECHANISM: std::ops::Range<usize> = 12..32;

/// Returns a unique name for a connection. The name is optional, but libraries such as `JeroMQ` 0.4
/// fail without it; and sockets that route by name refuse a second connection of the same name
/// while they keep the first.
fn identity() -> Bytes {
    format!("iiwasim-{:016x}", RandomState::new().hash_one(Instant::now())).into()
}

/// Disables Nagle's algorithm, because messages are short and urgent, and enables keep-alive
/// probes, because a machine that was switched off does not close its connections. Both are
/// optional.
fn set_options(stream: &TcpStream) {
    let socket = SockRef::from(stream);
    let _ = socket.set_tcp_nodelay(true);
    let keep_alive = TcpKeepalive::new()
        .with_time(Duration::from_secs(5))
        .with_interval(Duration::from_secs(1))
        .with_retries(3);
    let _ = socket.set_tcp_keepalive(&keep_alive);
    // Keep-alive probes are not sent while output is unacknowledged.
    #[cfg(target_os = "linux")]
    let _ = socket.set_tcp_user_timeout(Some(Duration::from_secs(10)));
}

/// A connection.
pub(crate) struct WireConnection {
    stream: TcpStream,
    codec: Connection,
    config: WireConfig,
    /// The received part of the greeting.
    greeting: Vec<u8>,
    /// Length of the incoming message.
    meter: Meter,
    /// Arrival time of the first bytes of this message.
    began: Instant,
    /// The permit of the incoming long message, and its arrival so far.
    long: Option<(Permit, Arrival)>,
    /// The payload of a long frame, and the number of bytes received.
    payload: Option<(Vec<u8>, usize)>,
    buffer: BytesMut,
}

impl WireConnection {
    pub(crate) fn new(stream: TcpStream, config: WireConfig) -> Self {
        set_options(&stream);
        let address = stream.peer_addr().map(|peer| peer.to_string()).unwrap_or_default();
        let codec = Connection::new(
            ConnectionConfig::new(config.role, config.kind)
                .identity(identity())
                .mechanism(config.mechanism.clone())
                .max_message_size(config.max_bytes)
                .peer_address(address),
        );
        Self {
            stream,
            codec,
            config,
            greeting: Vec::with_capacity(64),
            meter: Meter::default(),
            began: Instant::now(),
            long: None,
            payload: None,
            buffer: BytesMut::new(),
        }
    }

    /// Connects to another socket and completes the handshake.
    ///
    /// # Errors
    ///
    /// Any [`ConnectionEnd`].
    pub(crate) async fn connect(to: &Endpoint, config: &WireConfig) -> Result<Self, ConnectionEnd> {
        let stream = TcpStream::connect(to.resolve()?).await?;
        let mut wire = Self::new(stream, config.clone());
        wire.shake_hands(|_| {}).await?;
        Ok(wire)
    }

    /// Completes the handshake, and reports its steps. Returns the name of the peer's key, if it
    /// has one.
    ///
    /// # Errors
    ///
    /// Any [`ConnectionEnd`]. The function must not be called again after a time-out.
    pub(crate) async fn shake_hands(
        &mut self,
        mut report: impl FnMut(HandshakeStep),
    ) -> Result<Option<String>, ConnectionEnd> {
        let mut bytes = 0;
        loop {
            self.flush().await?;
            while let Some(event) = self.codec.poll_event() {
                if let Event::HandshakeSucceeded { peer_properties, .. } = event {
                    let user = peer_properties.authentication.user_id.as_ref();
                    return Ok(user.map(|user| String::from_utf8_lossy(user).into_owned()));
                }
            }
            // The first message may have arrived together with the end of the handshake.
            if bytes > HANDSHAKE_BYTES {
                return Err(ConnectionEnd::Protocol(ProtocolError::Protocol(
                    "the handshake is too long".into(),
                )));
            }
            let chunk = match self.read().await {
                Ok(chunk) => chunk,
                // A server closes the connection of a client with wrong keys without an error
                // message.
                Err(ConnectionEnd::Closed) => {
                    return Err(ConnectionEnd::Refused(ConnectionRefusal::Closed));
                }
                Err(error) => return Err(error),
            };
            // Frames follow the greeting; the last of them may already belong to a message.
            let greeting = GREETING_BYTES.saturating_sub(bytes).min(chunk.len());
            self.meter.read(&chunk[greeting..]);
            bytes += chunk.len();
            // Before the codec reads it, so that the error names the missing keys.
            self.check_greeting(&chunk)?;
            if let Err(error) = self.codec.handle_input(chunk) {
                // The pending output may contain the reason for the peer.
                let _ = timeout(MAX_PAUSE, self.flush()).await;
                return Err(error.into());
            }
            report(if bytes < GREETING_BYTES {
                HandshakeStep::Greeting
            } else if self.meter.frames() == 0 {
                HandshakeStep::Greeted
            } else {
                HandshakeStep::Introduced
            });
        }
    }

    /// Compares the mechanisms of the greetings; fails if only one side has keys.
    fn check_greeting(&mut self, chunk: &[u8]) -> Result<(), ConnectionEnd> {
        let missing = MECHANISM.end.saturating_sub(self.greeting.len());
        if missing == 0 {
            return Ok(());
        }
        self.greeting.extend_from_slice(&chunk[..missing.min(chunk.len())]);
        let Some(theirs) = self.greeting.get(MECHANISM) else { return Ok(()) };
        let name = self.config.mechanism.wire_name();
        let ours = name.as_str().unwrap_or_default().as_bytes();
        let same = theirs.starts_with(ours) && theirs[ours.len()..].iter().all(|byte| *byte == 0);
        if same { Ok(()) } else { Err(ConnectionEnd::Refused(ConnectionRefusal::KeysOnOneSide)) }
    }

    /// Waits for the next input. Cancellation-safe.
    ///
    /// # Errors
    ///
    /// Any [`ConnectionEnd`].
    pub(crate) async fn receive(&mut self) -> Result<WireInput, ConnectionEnd> {
        loop {
            if let Some(message) = self.codec.poll_message() {
                let frames: Frames = (0..message.len())
                    .map(|frame| message.part_bytes(frame).unwrap_or_default())
                    .collect();
                if let Some(subscription) = self.subscription(&frames) {
                    return Ok(subscription);
                }
                let permit = self.long.take().map(|(permit, _)| permit);
                return Ok(WireInput::Message(ReceivedMessage {
                    frames,
                    permit,
                    began: self.began,
                }));
            }
            match self.codec.poll_event() {
                Some(Event::Command(Command::Subscribe(topic))) => {
                    return Ok(WireInput::Subscribe(topic));
                }
                Some(Event::Command(Command::Cancel(topic))) => {
                    return Ok(WireInput::Cancel(topic));
                }
                Some(_) => continue,
                None => {}
            }
            if self.meter.announced() == 0 {
                // The input was a long command, not a message.
                self.long = None;
            }
            // Replies to heartbeats.
            self.flush().await?;
            if self.codec.has_pending_input() {
                self.codec.resume_input()?;
                continue;
            }
            self.read_more().await?;
        }
    }

    /// Returns the subscription in a message, as sent by peers before ZMTP 3.1.
    fn subscription(&self, frames: &[Bytes]) -> Option<WireInput> {
        let [frame] = frames else { return None };
        if !matches!(self.config.kind, SocketType::Pub | SocketType::XPub) {
            return None;
        }
        match frame.first()? {
            1 => Some(WireInput::Subscribe(frame.slice(1..))),
            0 => Some(WireInput::Cancel(frame.slice(1..))),
            _ => None,
        }
    }

    /// Continues to read the incoming message.
    async fn read_more(&mut self) -> Result<(), ConnectionEnd> {
        if self.meter.announced() <= SHORT_BYTES as u64 {
            let chunk = self.read().await?;
            if self.meter.announced() == 0 {
                self.began = Instant::now();
            }
            self.meter.read(&chunk);
            return Ok(self.codec.handle_input(chunk)?);
        }
        if self.long.is_none()
            && let Some(long) = &self.config.long
        {
            // The system's buffers block the sender until the permit is acquired.
            let permit = long.clone().acquire_owned().await.map_err(|_| ConnectionEnd::Closed)?;
            self.long = Some((permit, Arrival { since: Instant::now(), bytes: 0 }));
        }
        let patience = self.long.as_ref().map_or(MAX_PAUSE, |(_, it)| it.patience(Instant::now()));
        timeout(patience, self.read_long()).await.map_err(|_| {
            // Only the minimum rate shortens the time-out.
            if patience < MAX_PAUSE {
                ConnectionEnd::Slow
            } else {
                ConnectionEnd::Stalled(MAX_PAUSE)
            }
        })?
    }

    async fn read_long(&mut self) -> Result<(), ConnectionEnd> {
        self.begin_payload()?;
        if self.payload.is_none() {
            let chunk = self.read().await?;
            self.meter.read(&chunk);
            if let Some((_, arrival)) = &mut self.long {
                arrival.bytes += chunk.len() as u64;
            }
            return Ok(self.codec.handle_input(chunk)?);
        }
        self.read_payload().await?;
        if let Some((payload, _)) =
            self.payload.take_if(|(payload, filled)| *filled == payload.len())
        {
            self.codec.supply_payload(payload.into())?;
        }
        Ok(())
    }

    /// Allocates the payload of a long frame, which is read without copying.
    fn begin_payload(&mut self) -> Result<(), ConnectionEnd> {
        if self.payload.is_some() {
            return Ok(());
        }
        let Some(next) = self.codec.peek_next_frame_payload_size()? else { return Ok(()) };
        if next.payload_len > SHORT_BYTES {
            let mut payload = vec![0; next.payload_len];
            if let Some((_, filled)) = self.codec.begin_supplied_payload_into(&mut payload)? {
                // Kept in `self`: reception continues after a cancellation.
                self.payload = Some((payload, filled));
            }
        }
        Ok(())
    }

    async fn read_payload(&mut self) -> Result<(), ConnectionEnd> {
        let Some((payload, filled)) = &mut self.payload else { return Ok(()) };
        while *filled < payload.len() {
            self.stream.readable().await?;
            match self.stream.try_read(&mut payload[*filled..]) {
                Ok(0) => return Err(ConnectionEnd::Closed),
                Ok(count) => {
                    self.meter.read(&payload[*filled..*filled + count]);
                    if let Some((_, arrival)) = &mut self.long {
                        arrival.bytes += count as u64;
                    }
                    *filled += count;
                    return Ok(());
                }
                Err(error) if error.kind() == io::ErrorKind::WouldBlock => {}
                Err(error) => return Err(error.into()),
            }
        }
        Ok(())
    }

    /// Reads the available bytes.
    async fn read(&mut self) -> Result<Bytes, ConnectionEnd> {
        loop {
            self.stream.readable().await?;
            self.buffer.reserve(4 << 10);
            match self.stream.try_read_buf(&mut self.buffer) {
                Ok(0) => return Err(ConnectionEnd::Closed),
                Ok(_) => return Ok(self.buffer.split().freeze()),
                Err(error) if error.kind() == io::ErrorKind::WouldBlock => {}
                Err(error) => return Err(error.into()),
            }
        }
    }

    /// Queues a message for sending.
    ///
    /// # Errors
    ///
    /// The handshake is not complete.
    pub(crate) fn queue(&mut self, frames: &[Bytes]) -> Result<(), ConnectionEnd> {
        Ok(self.codec.send_message(&Message::multipart(frames.iter().cloned()))?)
    }

    /// Subscribes to topics with a prefix.
    ///
    /// # Errors
    ///
    /// The handshake is not complete.
    pub(crate) fn subscribe(&mut self, topic: &'static str) -> Result<(), ConnectionEnd> {
        Ok(self.codec.send_command(&Command::Subscribe(Bytes::from_static(topic.as_bytes())))?)
    }

    /// Returns true if output is pending.
    pub(crate) fn has_output(&self) -> bool {
        self.codec.has_pending_transmit()
    }

    /// Sends all pending output. Cancellation-safe.
    ///
    /// # Errors
    ///
    /// The connection is lost.
    pub(crate) async fn flush(&mut self) -> Result<(), ConnectionEnd> {
        while self.codec.has_pending_transmit() {
            self.send_some().await?;
        }
        Ok(())
    }

    /// Sends a part of the pending output.
    ///
    /// # Errors
    ///
    /// The connection is lost.
    pub(crate) async fn send_some(&mut self) -> Result<(), ConnectionEnd> {
        self.stream.writable().await?;
        let result = self.stream.try_write_vectored(&self.codec.transmit_chunks_capped(64));
        match result {
            Ok(count) => self.codec.advance_transmit(count),
            Err(error) if error.kind() == io::ErrorKind::WouldBlock => {}
            Err(error) => return Err(error.into()),
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_arrival_of_a_long_message_is_bounded() {
        let since = Instant::now();
        let patience =
            |bytes, ms| Arrival { since, bytes }.patience(since + Duration::from_millis(ms));
        let s = Duration::from_secs;
        assert_eq!(patience(0, 0), s(2));
        // Single bytes do not prevent the time-out.
        assert_eq!(patience(1, 1500), Duration::from_millis(500));
        assert_eq!(patience(2, 2500), s(0));
        // Fast messages may not pause for longer than others.
        assert_eq!(patience(20 << 20, 1000), s(2));
        assert_eq!(patience(4 << 20, 5500), Duration::from_millis(500));
        // 32 MiB take at most 34 s.
        assert_eq!(patience(32 << 20, 34_000), s(0));
    }
}
