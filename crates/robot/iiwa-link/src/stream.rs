//! The stream published by a drive.

use std::time::Duration;

use bytes::Bytes;
use iiwa_kin::Joints;
use omq_proto::SocketType;
use serde::{Deserialize, Serialize};
use tokio::{
    runtime::Runtime,
    task::{JoinHandle, yield_now},
    time::{sleep, timeout},
};

use crate::{
    error::LinkError,
    message::{DriveState, MAX_LABEL_BYTES, RunEvent, from_json},
    security::{ConnectionRefusal, Endpoint},
    socket::{MAX_CLOSED_HANDSHAKES, Remote, SHORT_MESSAGE_BYTES},
    transport::{self, ConnectionEnd, WireConfig, WireConnection, WireInput},
};

/// A subscription to the measurements and states published by a drive.
///
/// ```no_run
/// use std::time::Duration;
///
/// use iiwa_link::{Published, Remote, Stream};
///
/// let mut stream = Stream::new(&Remote::open(), "tcp://127.0.0.1:5561")?;
/// while let Some(published) = stream.next(Duration::from_secs(1))? {
///     if let Published::Joints { t_s, joints_rad } = published {
///         println!("A1 at {:.4} rad after {t_s:.3} s", joints_rad[0]);
///     }
/// }
/// # Ok::<(), iiwa_link::LinkError>(())
/// ```
pub struct Stream {
    endpoint: Endpoint,
    config: WireConfig,
    topics: &'static [&'static str],
    connection: StreamConnection,
    runtime: Runtime,
}

/// Source and topics of a stream.
type StreamSource<'a> = (&'a Endpoint, &'a WireConfig, &'static [&'static str]);

enum StreamConnection {
    None,
    /// A separate task is connecting.
    Pending(JoinHandle<Result<WireConnection, ConnectionRefusal>>),
    Open(Box<WireConnection>),
}

impl std::fmt::Debug for Stream {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Stream").finish_non_exhaustive()
    }
}

/// A published message.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
#[non_exhaustive]
pub enum Published {
    /// Measured joint positions, every FRI cycle.
    Joints {
        /// Time stamp, in s: the controller's time since its first message to the drive.
        t_s: f64,
        /// The positions, in rad.
        joints_rad: Joints,
    },
    /// Measured torques, every FRI cycle, before the positions of the same time; only for
    /// [subscribers that request torques](Stream::with_torques), and only if the controller
    /// measures them.
    Torques {
        /// Time stamp, in s, equal to the stamp of the positions.
        t_s: f64,
        /// Joint torques, in Nm.
        measured_nm: Joints,
        /// External joint torques, in Nm: the measured torques minus the torques due to the weight
        /// and motion of the robot.
        external_nm: Joints,
    },
    /// The new state of the drive.
    State {
        /// Time stamp, in s.
        t_s: f64,
        /// The state.
        state: DriveState,
    },
    /// The beginning or the end of a run; only for [subscribers that request
    /// runs](Stream::with_runs).
    Run(Box<RunEvent>),
}

impl Published {
    /// Returns the topic of the message.
    #[must_use]
    pub fn topic(&self) -> &'static str {
        match self {
            Self::Joints { .. } => "joints",
            Self::Torques { .. } => "torques",
            Self::State { .. } => "state",
            Self::Run(_) => "run",
        }
    }
}

/// Maximum length of a run message, in bytes: its label, and an error.
const RUN_BYTES: usize = MAX_LABEL_BYTES + (16 << 10);

/// Interval between connection attempts.
const RETRY_INTERVAL: Duration = Duration::from_millis(50);

/// Time-out of connecting.
const CONNECT_TIMEOUT: Duration = Duration::from_secs(2);

/// Initial wait of a new stream for its connection, so that it does not miss later messages.
const INITIAL_WAIT: Duration = Duration::from_millis(200);

impl Stream {
    /// Subscribes to the drive that publishes at `address`, such as `tcp://127.0.0.1:5561`. Messages
    /// published before the connection is established are missed. Unread messages wait in the
    /// system's buffers, and for some seconds at the drive.
    ///
    /// # Errors
    ///
    /// The address is invalid, or requires keys.
    pub fn new(remote: &Remote, address: &str) -> Result<Self, LinkError> {
        Self::of(remote, address, &["joints", "state"], SHORT_MESSAGE_BYTES)
    }

    /// Subscribes like [`new`](Self::new), with the measured torques.
    ///
    /// # Errors
    ///
    /// Same as [`new`](Self::new).
    pub fn with_torques(remote: &Remote, address: &str) -> Result<Self, LinkError> {
        Self::of(remote, address, &["torques", "joints", "state"], SHORT_MESSAGE_BYTES)
    }

    /// Subscribes like [`new`](Self::new), with measured torques, and run start and end events.
    ///
    /// # Errors
    ///
    /// Same as [`new`](Self::new).
    pub fn with_runs(remote: &Remote, address: &str) -> Result<Self, LinkError> {
        Self::of(remote, address, &["torques", "joints", "state", "run"], RUN_BYTES)
    }

    fn of(
        remote: &Remote,
        address: &str,
        topics: &'static [&'static str],
        max_bytes: usize,
    ) -> Result<Self, LinkError> {
        let (endpoint, config) = remote.wire(SocketType::Sub, address, max_bytes)?;
        let runtime = transport::runtime().map_err(|source| LinkError::Thread { source })?;
        let mut stream =
            Self { endpoint, config, topics, connection: StreamConnection::None, runtime };
        let Self { endpoint, config, topics, connection, runtime } = &mut stream;
        // The first call of `next` reports errors.
        let _ = runtime.block_on(async {
            timeout(INITIAL_WAIT, open((endpoint, config, topics), connection)).await
        });
        Ok(stream)
    }

    /// Returns the next message; `None` if none arrives within `limit`.
    ///
    /// # Errors
    ///
    /// [`LinkError::Unauthorized`] if the drive has refused the connection.
    pub fn next(&mut self, limit: Duration) -> Result<Option<Published>, LinkError> {
        let Self { endpoint, config, topics, connection, runtime } = self;
        let received = runtime.block_on(async {
            // Lets the runtime poll for input that has arrived meanwhile.
            yield_now().await;
            timeout(limit, receive((endpoint, config, topics), connection)).await
        });
        received.unwrap_or(Ok(None))
    }
}

/// Waits for the next message. Cancellation-safe.
async fn receive(
    source: StreamSource<'_>,
    connection: &mut StreamConnection,
) -> Result<Option<Published>, LinkError> {
    loop {
        open(source, connection).await?;
        let StreamConnection::Open(wire) = connection else { continue };
        match wire.receive().await {
            Ok(WireInput::Message(received)) => return Ok(read(&received.frames)),
            Ok(_) => {}
            Err(_) => *connection = StreamConnection::None,
        }
    }
}

/// Waits for the connection. Cancellation-safe.
async fn open(
    source: StreamSource<'_>,
    connection: &mut StreamConnection,
) -> Result<(), LinkError> {
    loop {
        match connection {
            StreamConnection::Open(_) => return Ok(()),
            StreamConnection::None => {
                let (endpoint, config, topics) = source;
                // In a separate task: a handshake cannot be resumed after a time-out of `next`.
                let task = tokio::spawn(connect(endpoint.clone(), config.clone(), topics));
                *connection = StreamConnection::Pending(task);
            }
            StreamConnection::Pending(task) => {
                let connected = task.await;
                // A task that has ended must not be awaited again.
                *connection = StreamConnection::None;
                match connected {
                    Ok(Ok(wire)) => *connection = StreamConnection::Open(Box::new(wire)),
                    Ok(Err(reason)) => {
                        let address = source.0.to_string();
                        return Err(LinkError::Unauthorized { address, reason: reason.reason() });
                    }
                    Err(error) => tracing::warn!("the task of the connection failed: {error}"),
                }
            }
        }
    }
}

/// Connects, with retries unless the drive refuses the connection.
async fn connect(
    endpoint: Endpoint,
    config: WireConfig,
    topics: &'static [&'static str],
) -> Result<WireConnection, ConnectionRefusal> {
    let mut closed = 0;
    loop {
        match timeout(CONNECT_TIMEOUT, subscribe(&endpoint, &config, topics)).await {
            Ok(Ok(wire)) => return Ok(wire),
            // A drive that is shutting down also closes connections: only repetition is a refusal.
            Ok(Err(ConnectionEnd::Refused(ConnectionRefusal::Closed)))
                if closed < MAX_CLOSED_HANDSHAKES =>
            {
                closed += 1;
            }
            Ok(Err(ConnectionEnd::Refused(reason))) => return Err(reason),
            // The drive may start later: the number of attempts is not limited.
            _ => {}
        }
        sleep(RETRY_INTERVAL).await;
    }
}

async fn subscribe(
    endpoint: &Endpoint,
    config: &WireConfig,
    topics: &[&'static str],
) -> Result<WireConnection, ConnectionEnd> {
    let mut wire = WireConnection::connect(endpoint, config).await?;
    for topic in topics {
        wire.subscribe(topic)?;
    }
    wire.flush().await?;
    Ok(wire)
}

fn read(frames: &[Bytes]) -> Option<Published> {
    #[derive(Deserialize)]
    struct JointsMessage {
        t_s: f64,
        joints_rad: Joints,
    }
    #[derive(Deserialize)]
    struct TorquesMessage {
        t_s: f64,
        measured_nm: Joints,
        external_nm: Joints,
    }
    #[derive(Deserialize)]
    struct StateMessage {
        t_s: f64,
        state: DriveState,
    }
    match frames {
        [topic, body] if topic == "joints" => from_json(body)
            .map(|JointsMessage { t_s, joints_rad }| Published::Joints { t_s, joints_rad }),
        [topic, body] if topic == "torques" => {
            from_json(body).map(|TorquesMessage { t_s, measured_nm, external_nm }| {
                Published::Torques { t_s, measured_nm, external_nm }
            })
        }
        [topic, body] if topic == "state" => {
            from_json(body).map(|StateMessage { t_s, state }| Published::State { t_s, state })
        }
        [topic, body] if topic == "run" => from_json(body).map(Box::new).map(Published::Run),
        _ => None,
    }
}
