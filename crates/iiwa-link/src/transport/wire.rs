//! One connection: bytes of a TCP stream in and out of the protocol's state machine.

use std::{
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
use crate::security::{Endpoint, Refused};

/// The frames of a message.
pub type Frames = Vec<Bytes>;

/// The right to have a long message on its way, until it is dropped.
pub type Permit = OwnedSemaphorePermit;

/// How a connection is set up.
#[derive(Clone)]
pub(crate) struct WireConfig {
    pub(crate) role: Role,
    pub(crate) kind: SocketType,
    pub(crate) mechanism: MechanismSetup,
    /// Longest message that is taken, in bytes.
    pub(crate) most_bytes: usize,
    /// Where the right to send a long message is had; without it, messages are short, or only one peer
    /// that is trusted sends them.
    pub(crate) long: Option<Arc<Semaphore>>,
}

/// Why a connection ended.
#[derive(Debug, thiserror::Error)]
pub(crate) enum WireError {
    /// The other side has closed it.
    #[error("the connection was closed")]
    Closed,
    /// The system closed it.
    #[error("{0}")]
    Io(#[from] io::Error),
    /// One side does not admit the other one.
    #[error("{}", .0.what())]
    Refused(Refused),
    /// The other side does not speak the protocol.
    #[error("{0}")]
    Protocol(ProtocolError),
    /// The other side took too long.
    #[error("no progress within {} s", .0.as_secs_f64())]
    Stalled(Duration),
}

impl From<ProtocolError> for WireError {
    fn from(error: ProtocolError) -> Self {
        match error {
            ProtocolError::HandshakeRefused(_) => Self::Refused(Refused::NotAllowed),
            ProtocolError::Closed => Self::Closed,
            error => Self::Protocol(error),
        }
    }
}

/// A message that came in.
#[derive(Debug)]
pub struct Received {
    /// Its parts.
    pub frames: Frames,
    /// Of a long one: as long as it is kept, no other long one comes in.
    pub permit: Option<Permit>,
    /// When its first bytes came.
    pub began: Instant,
}

/// What comes in.
#[derive(Debug)]
pub(crate) enum Incoming {
    Message(Received),
    /// A subscriber wants topics that begin so.
    Subscribe(Bytes),
    /// And no longer.
    Cancel(Bytes),
}

/// Longer messages than this are long ones, in bytes.
pub const SHORT_BYTES: usize = 64 << 10;

/// A handshake takes less, in bytes.
const HANDSHAKE_BYTES: usize = 4 << 10;

/// How long a long message may pause.
const PAUSE: Duration = Duration::from_secs(2);

const GREETING_BYTES: usize = 64;

/// The part of a greeting that says how the other side keeps strangers out.
const MECHANISM: std::ops::Range<usize> = 12..32;

/// Messages are short, and count as soon as they are sent; and a machine that was switched off does not say
/// so: the system asks now and then. A connection works without either.
fn set_up(stream: &TcpStream) {
    let socket = SockRef::from(stream);
    let _ = socket.set_tcp_nodelay(true);
    let often = TcpKeepalive::new()
        .with_time(Duration::from_secs(5))
        .with_interval(Duration::from_secs(1))
        .with_retries(3);
    let _ = socket.set_tcp_keepalive(&often);
    #[cfg(target_os = "linux")]
    let _ = socket.set_tcp_user_timeout(Some(Duration::from_secs(10)));
}

/// A connection.
pub(crate) struct Wire {
    stream: TcpStream,
    codec: Connection,
    config: WireConfig,
    /// The greeting, as far as it has come.
    greeting: Vec<u8>,
    /// How long the message is that is coming in.
    meter: Meter,
    /// When it began.
    began: Instant,
    permit: Option<Permit>,
    /// The payload of a long frame, and how much of it is there.
    payload: Option<(Vec<u8>, usize)>,
    buffer: BytesMut,
}

impl Wire {
    pub(crate) fn new(stream: TcpStream, config: WireConfig) -> Self {
        set_up(&stream);
        let address = stream.peer_addr().map(|at| at.to_string()).unwrap_or_default();
        let codec = Connection::new(
            ConnectionConfig::new(config.role, config.kind)
                .mechanism(config.mechanism.clone())
                .max_message_size(config.most_bytes)
                .peer_address(address),
        );
        Self {
            stream,
            codec,
            config,
            greeting: Vec::with_capacity(64),
            meter: Meter::default(),
            began: Instant::now(),
            permit: None,
            payload: None,
            buffer: BytesMut::new(),
        }
    }

    /// Connects with another socket, and shakes hands.
    ///
    /// # Errors
    ///
    /// Any [`WireError`].
    pub(crate) async fn connect(to: &Endpoint, config: &WireConfig) -> Result<Self, WireError> {
        let stream = TcpStream::connect(to.resolve()?).await?;
        let mut wire = Self::new(stream, config.clone());
        wire.shake_hands().await?;
        Ok(wire)
    }

    /// Completes the handshake; says what the peer's key is called, if it has one.
    ///
    /// # Errors
    ///
    /// Any [`WireError`]. To be called again after a time-out, it is not.
    pub(crate) async fn shake_hands(&mut self) -> Result<Option<String>, WireError> {
        let mut bytes = 0;
        loop {
            self.flush().await?;
            while let Some(event) = self.codec.poll_event() {
                if let Event::HandshakeSucceeded { peer_properties, .. } = event {
                    let user = peer_properties.authentication.user_id.as_ref();
                    return Ok(user.map(|user| String::from_utf8_lossy(user).into_owned()));
                }
            }
            // The first message may have come with the end of it.
            if bytes > HANDSHAKE_BYTES {
                return Err(WireError::Protocol(ProtocolError::Protocol(
                    "a long handshake".into(),
                )));
            }
            let chunk = match self.read().await {
                Ok(chunk) => chunk,
                // Whoever has the wrong keys is left without a word.
                Err(WireError::Closed) => return Err(WireError::Refused(Refused::HungUp)),
                Err(error) => return Err(error),
            };
            // What follows the greeting are frames; the last of them may be those of a message already.
            let greeting = GREETING_BYTES.saturating_sub(bytes).min(chunk.len());
            self.meter.read(&chunk[greeting..]);
            bytes += chunk.len();
            self.check_greeting(&chunk)?;
            if let Err(error) = self.codec.handle_input(chunk) {
                // It may hold why.
                let _ = timeout(PAUSE, self.flush()).await;
                return Err(error.into());
            }
        }
    }

    /// Whether keys are on one side only shows in the greetings.
    fn check_greeting(&mut self, chunk: &[u8]) -> Result<(), WireError> {
        let missing = MECHANISM.end.saturating_sub(self.greeting.len());
        if missing == 0 {
            return Ok(());
        }
        self.greeting.extend_from_slice(&chunk[..missing.min(chunk.len())]);
        let Some(theirs) = self.greeting.get(MECHANISM) else { return Ok(()) };
        let name = self.config.mechanism.wire_name();
        let ours = name.as_str().unwrap_or_default().as_bytes();
        let same = theirs.starts_with(ours) && theirs[ours.len()..].iter().all(|byte| *byte == 0);
        if same { Ok(()) } else { Err(WireError::Refused(Refused::KeysOnOneSide)) }
    }

    /// The next thing that comes in. Nothing is lost if it is dropped before.
    ///
    /// # Errors
    ///
    /// Any [`WireError`].
    pub(crate) async fn receive(&mut self) -> Result<Incoming, WireError> {
        loop {
            if let Some(message) = self.codec.poll_message() {
                let frames: Frames = (0..message.len())
                    .map(|frame| message.part_bytes(frame).unwrap_or_default())
                    .collect();
                if let Some(subscription) = self.subscription(&frames) {
                    return Ok(subscription);
                }
                let permit = self.permit.take();
                return Ok(Incoming::Message(Received { frames, permit, began: self.began }));
            }
            match self.codec.poll_event() {
                Some(Event::Command(Command::Subscribe(topic))) => {
                    return Ok(Incoming::Subscribe(topic));
                }
                Some(Event::Command(Command::Cancel(topic))) => {
                    return Ok(Incoming::Cancel(topic));
                }
                Some(_) => continue,
                None => {}
            }
            if self.meter.announced() == 0 {
                // It was a long command.
                self.permit = None;
            }
            // Answers to heartbeats.
            self.flush().await?;
            if self.codec.has_pending_input() {
                self.codec.resume_input()?;
                continue;
            }
            self.read_on().await?;
        }
    }

    /// Before ZMTP 3.1, subscriptions are messages.
    fn subscription(&self, frames: &[Bytes]) -> Option<Incoming> {
        let [frame] = frames else { return None };
        if !matches!(self.config.kind, SocketType::Pub | SocketType::XPub) {
            return None;
        }
        match frame.first()? {
            1 => Some(Incoming::Subscribe(frame.slice(1..))),
            0 => Some(Incoming::Cancel(frame.slice(1..))),
            _ => None,
        }
    }

    /// Reads on in the message that is coming in.
    async fn read_on(&mut self) -> Result<(), WireError> {
        if self.meter.announced() <= SHORT_BYTES as u64 {
            let chunk = self.read().await?;
            if self.meter.announced() == 0 {
                self.began = Instant::now();
            }
            self.meter.read(&chunk);
            return Ok(self.codec.handle_input(chunk)?);
        }
        if self.permit.is_none()
            && let Some(long) = &self.config.long
        {
            // Until then the sender waits, and what it has sent is in the system's buffers.
            let permit = long.clone().acquire_owned().await;
            self.permit = Some(permit.map_err(|_| WireError::Closed)?);
        }
        timeout(PAUSE, self.read_long()).await.map_err(|_| WireError::Stalled(PAUSE))?
    }

    async fn read_long(&mut self) -> Result<(), WireError> {
        self.begin_payload()?;
        if self.payload.is_none() {
            let chunk = self.read().await?;
            self.meter.read(&chunk);
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

    /// A long frame is read right into its place.
    fn begin_payload(&mut self) -> Result<(), WireError> {
        if self.payload.is_some() {
            return Ok(());
        }
        let Some(next) = self.codec.peek_next_frame_payload_size()? else { return Ok(()) };
        if next.payload_len > SHORT_BYTES {
            let mut payload = vec![0; next.payload_len];
            if let Some((_, filled)) = self.codec.begin_supplied_payload_into(&mut payload)? {
                self.payload = Some((payload, filled));
            }
        }
        Ok(())
    }

    async fn read_payload(&mut self) -> Result<(), WireError> {
        let Some((payload, filled)) = &mut self.payload else { return Ok(()) };
        while *filled < payload.len() {
            self.stream.readable().await?;
            match self.stream.try_read(&mut payload[*filled..]) {
                Ok(0) => return Err(WireError::Closed),
                Ok(count) => {
                    self.meter.read(&payload[*filled..*filled + count]);
                    *filled += count;
                    return Ok(());
                }
                Err(error) if error.kind() == io::ErrorKind::WouldBlock => {}
                Err(error) => return Err(error.into()),
            }
        }
        Ok(())
    }

    /// Some bytes.
    async fn read(&mut self) -> Result<Bytes, WireError> {
        loop {
            self.stream.readable().await?;
            self.buffer.reserve(4 << 10);
            match self.stream.try_read_buf(&mut self.buffer) {
                Ok(0) => return Err(WireError::Closed),
                Ok(_) => return Ok(self.buffer.split().freeze()),
                Err(error) if error.kind() == io::ErrorKind::WouldBlock => {}
                Err(error) => return Err(error.into()),
            }
        }
    }

    /// Puts a message into the queue of what is to be sent.
    ///
    /// # Errors
    ///
    /// The handshake is not complete.
    pub(crate) fn queue(&mut self, frames: &[Bytes]) -> Result<(), WireError> {
        Ok(self.codec.send_message(&Message::multipart(frames.iter().cloned()))?)
    }

    /// Subscribes to topics that begin so.
    ///
    /// # Errors
    ///
    /// The handshake is not complete.
    pub(crate) fn subscribe(&mut self, topic: &'static str) -> Result<(), WireError> {
        Ok(self.codec.send_command(&Command::Subscribe(Bytes::from_static(topic.as_bytes())))?)
    }

    /// Whether something is still to be sent.
    pub(crate) fn has_to_send(&self) -> bool {
        self.codec.has_pending_transmit()
    }

    /// Sends what is queued. Nothing is lost if it is dropped before.
    ///
    /// # Errors
    ///
    /// The connection is lost.
    pub(crate) async fn flush(&mut self) -> Result<(), WireError> {
        while self.codec.has_pending_transmit() {
            self.send_some().await?;
        }
        Ok(())
    }

    /// Sends some of what is queued.
    ///
    /// # Errors
    ///
    /// The connection is lost.
    pub(crate) async fn send_some(&mut self) -> Result<(), WireError> {
        self.stream.writable().await?;
        let sent = self.stream.try_write_vectored(&self.codec.transmit_chunks_capped(64));
        match sent {
            Ok(count) => self.codec.advance_transmit(count),
            Err(error) if error.kind() == io::ErrorKind::WouldBlock => {}
            Err(error) => return Err(error.into()),
        }
        Ok(())
    }
}
