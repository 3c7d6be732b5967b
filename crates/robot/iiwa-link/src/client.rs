//! Drive client.

use std::{
    io,
    time::{Duration, Instant},
};

use bytes::Bytes;
use iiwa_program::MotionList;
use omq_proto::SocketType;
use serde::{Deserialize, de::DeserializeOwned};
use tokio::{
    runtime::Runtime,
    task::yield_now,
    time::{sleep, timeout},
};

use crate::{
    error::LinkError,
    message::{
        Code, DriveStatus, IoValue, MAX_MESSAGE_BYTES, MAX_REPLY_BYTES, Refusal, Request, Run,
        Sensors, Signal,
    },
    security::{ConnectionRefusal, Endpoint},
    socket::{MAX_CLOSED_HANDSHAKES, Remote},
    timed_joints::TimedJoints,
    transport::{self, ConnectionEnd, WireConfig, WireConnection, WireInput},
};

/// A client of a drive: sends one request at a time and waits for its reply.
///
/// ```no_run
/// use iiwa_link::{Client, Remote};
/// use iiwa_program::{Motion, Ptp};
///
/// let mut client = Client::new(&Remote::open(), "tcp://127.0.0.1:5560")?;
/// let run = client.run_motions(vec![Motion::Ptp(Ptp::to([0.1; 7]))], None)?;
/// println!("{} samples in {:?} s", run.samples.t_s.len(), run.cycle_time_s);
/// # Ok::<(), iiwa_link::ClientError>(())
/// ```
pub struct Client {
    endpoint: Endpoint,
    config: WireConfig,
    /// `None` before the first request and after a lost connection.
    wire: Option<WireConnection>,
    runtime: Runtime,
}

impl std::fmt::Debug for Client {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Client").field("at", &self.endpoint).finish_non_exhaustive()
    }
}

/// Errors of a request.
///
/// ```no_run
/// use iiwa_link::{Client, ClientError, Remote};
///
/// let mut client = Client::new(&Remote::open(), "tcp://127.0.0.1:5560")?;
/// match client.stop() {
///     Ok(()) => println!("the arm is at rest"),
///     Err(ClientError::Unreachable { address }) => println!("no drive at {address}"),
///     Err(error) => println!("{}: {error}", error.code()),
/// }
/// # Ok::<(), iiwa_link::LinkError>(())
/// ```
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ClientError {
    /// The drive or the robot has refused the request.
    #[error("{refusal}")]
    Refused {
        /// The reason.
        refusal: Refusal,
        /// The measurements up to the refusal, if the request was a run.
        run: Option<Box<Run>>,
    },
    /// No drive accepts connections at the address.
    #[error("no drive answers at {address}")]
    Unreachable {
        /// The address.
        address: String,
    },
    /// The drive has refused the connection.
    #[error("the drive at {address} refused the connection: {reason}")]
    Unauthorized {
        /// The address.
        address: String,
        /// The reason.
        reason: &'static str,
    },
    /// The connection was lost before the reply.
    #[error("the connection to the drive at {address} was lost before its reply")]
    Lost {
        /// The address.
        address: String,
    },
    /// The drive has not replied within the time-out.
    #[error("the drive at {address} did not reply within {} s", .after.as_secs_f64())]
    Timeout {
        /// The address.
        address: String,
        /// The time-out.
        after: Duration,
    },
    /// The request is longer than [`MAX_MESSAGE_BYTES`].
    #[error("the request has {found} bytes, at most {MAX_MESSAGE_BYTES} are allowed; split it")]
    TooLong {
        /// Length of the request, in bytes.
        found: usize,
    },
    /// The reply is malformed.
    #[error("invalid reply of the drive: {message}")]
    InvalidReply {
        /// The fault.
        message: String,
    },
    /// The connection cannot be set up.
    #[error(transparent)]
    Link(#[from] LinkError),
}

impl ClientError {
    /// Returns the protocol code for this error.
    #[must_use]
    pub fn code(&self) -> Code {
        match self {
            Self::Refused { refusal, .. } => refusal.code,
            Self::Unauthorized { .. } => Code::Unauthorized,
            Self::TooLong { .. } | Self::InvalidReply { .. } => Code::BadRequest,
            _ => Code::Timeout,
        }
    }
}

/// Time-out of connecting.
const CONNECT_TIMEOUT: Duration = Duration::from_secs(3);
/// Time-out of requests without motion; some are forwarded to the robot program.
const REPLY_TIMEOUT: Duration = Duration::from_secs(5);
/// Interval between connection attempts.
const RETRY_INTERVAL: Duration = Duration::from_millis(50);

/// Limits of the connection attempts.
#[derive(Clone, Copy)]
struct Patience {
    /// Time-out of all attempts together.
    total: Duration,
    /// Time-out of each attempt.
    each: Duration,
    /// Number of consecutive closed handshakes that are retried; one more counts as a refusal by
    /// the drive.
    closed_handshakes: u32,
}

impl Patience {
    /// Limits for requests that the caller may repeat.
    const USUAL: Self = Self {
        total: CONNECT_TIMEOUT,
        each: CONNECT_TIMEOUT,
        closed_handshakes: MAX_CLOSED_HANDSHAKES,
    };

    /// Limits for stops: closed handshakes are not limited, because a drive under load may close
    /// connections. Without a drive, the time-out is the usual one.
    fn of_stop(total: Duration) -> Self {
        // Within the 5 s of a stop, an attempt without an answer leaves time for another one.
        Self { total, each: Duration::from_secs(2), closed_handshakes: u32::MAX }
    }
}

impl Client {
    /// Creates a client of the drive at `address`, such as `tcp://127.0.0.1:5560`. The client connects
    /// with the first request, and again after a lost connection.
    ///
    /// # Errors
    ///
    /// The address is invalid, or requires keys.
    pub fn new(remote: &Remote, address: &str) -> Result<Self, LinkError> {
        let (endpoint, config) = remote.wire(SocketType::Req, address, MAX_REPLY_BYTES)?;
        let runtime = transport::runtime().map_err(|source| LinkError::Thread { source })?;
        Ok(Self { endpoint, config, wire: None, runtime })
    }

    /// Returns a snapshot of the drive and the robot.
    ///
    /// # Errors
    ///
    /// Any [`ClientError`].
    pub fn state(&mut self) -> Result<DriveStatus, ClientError> {
        self.request(&Request::State, Some(REPLY_TIMEOUT))
    }

    /// Runs motions and returns when they have ended; without `limit`, there is no time-out. A
    /// `Vec<Motion>` is a list of motions without tool, base or frame names.
    ///
    /// # Errors
    ///
    /// Any [`ClientError`]; the error of an aborted run contains the measurements up to the abort.
    pub fn run_motions(
        &mut self,
        motions: impl Into<MotionList>,
        limit: Option<Duration>,
    ) -> Result<Run, ClientError> {
        self.run(&Request::motions(motions), limit)
    }

    /// Runs a trajectory and returns when it has ended; without `limit`, there is no time-out.
    ///
    /// # Errors
    ///
    /// Same as [`run_motions`](Self::run_motions).
    pub fn run_trajectory(
        &mut self,
        trajectory: TimedJoints,
        limit: Option<Duration>,
    ) -> Result<Run, ClientError> {
        self.run(&Request::trajectory(trajectory), limit)
    }

    /// Sends a run request with its label, and returns when the run has ended; without `limit`,
    /// there is no time-out.
    ///
    /// # Errors
    ///
    /// Same as [`run_motions`](Self::run_motions).
    pub fn run(&mut self, request: &Request, limit: Option<Duration>) -> Result<Run, ClientError> {
        self.request(request, limit)
    }

    /// Returns the measurements of the last run.
    ///
    /// # Errors
    ///
    /// Any [`ClientError`]; the error of the run, if it was aborted.
    pub fn last_run(&mut self) -> Result<Run, ClientError> {
        self.request(&Request::LastRun, Some(REPLY_TIMEOUT))
    }

    /// Reads the robot's sensors.
    ///
    /// # Errors
    ///
    /// Any [`ClientError`].
    pub fn read_sensors(&mut self) -> Result<Sensors, ClientError> {
        #[derive(Deserialize)]
        struct SensorsReply {
            sensors: Sensors,
        }
        let SensorsReply { sensors } = self.request(&Request::ReadSensors, Some(REPLY_TIMEOUT))?;
        Ok(sensors)
    }

    /// Reads all inputs and outputs.
    ///
    /// # Errors
    ///
    /// Any [`ClientError`].
    pub fn list_io(&mut self) -> Result<Vec<Signal>, ClientError> {
        #[derive(Deserialize)]
        struct SignalsReply {
            io: Vec<Signal>,
        }
        let SignalsReply { io } = self.request(&Request::ListIo, Some(REPLY_TIMEOUT))?;
        Ok(io)
    }

    /// Reads an input or output.
    ///
    /// # Errors
    ///
    /// Any [`ClientError`].
    pub fn get_io(&mut self, name: &str) -> Result<IoValue, ClientError> {
        self.request_value(&Request::GetIo { name: name.to_owned() })
    }

    /// Sets an output and returns its new value.
    ///
    /// # Errors
    ///
    /// Any [`ClientError`].
    pub fn set_io(&mut self, name: &str, value: IoValue) -> Result<IoValue, ClientError> {
        self.request_value(&Request::SetIo { name: name.to_owned(), value })
    }

    fn request_value(&mut self, request: &Request) -> Result<IoValue, ClientError> {
        #[derive(Deserialize)]
        struct ValueReply {
            value: IoValue,
        }
        let ValueReply { value } = self.request(request, Some(REPLY_TIMEOUT))?;
        Ok(value)
    }

    /// Stops the running motion or trajectory on its path and returns when the robot is at rest.
    /// The request is repeated after a lost connection, for 5 s in total.
    ///
    /// # Errors
    ///
    /// Any [`ClientError`].
    pub fn stop(&mut self) -> Result<(), ClientError> {
        #[derive(Deserialize)]
        struct EmptyReply {}
        let request = Request::Stop;
        // Unlike other requests, a stop is repeated: sent twice, it has the same effect as once.
        let reply = self.exchange_again(&request.to_json(), REPLY_TIMEOUT)?;
        let EmptyReply {} = read_reply(&request, &reply)?;
        Ok(())
    }

    /// Sends any request and returns the drive's reply as unparsed JSON; without `limit`, there is
    /// no time-out.
    ///
    /// # Errors
    ///
    /// Any [`ClientError`] except [`ClientError::Refused`]: a refusal is a reply.
    pub fn reply(
        &mut self,
        request: &Request,
        limit: Option<Duration>,
    ) -> Result<Bytes, ClientError> {
        self.exchange(&request.to_json(), limit)
    }

    fn request<T: DeserializeOwned>(
        &mut self,
        request: &Request,
        limit: Option<Duration>,
    ) -> Result<T, ClientError> {
        read_reply(request, &self.exchange(&request.to_json(), limit)?)
    }

    /// Sends a request and waits for its reply.
    fn exchange(&mut self, request: &str, limit: Option<Duration>) -> Result<Bytes, ClientError> {
        // The drive would close the connection without a reply that names the reason.
        if request.len() > MAX_MESSAGE_BYTES {
            return Err(ClientError::TooLong { found: request.len() });
        }
        // After a time-out, the connection is dropped with the future: a late reply cannot be taken
        // for the reply to the next request.
        let wire = self.wire.take();
        let Self { endpoint, config, .. } = self;
        let exchange = exchange(wire, config, endpoint, request, Patience::USUAL);
        let result = self.runtime.block_on(async {
            match limit {
                None => exchange.await,
                Some(after) => timeout(after, exchange).await.unwrap_or_else(|_| {
                    Err(ClientError::Timeout { address: endpoint.to_string(), after })
                }),
            }
        });
        let (wire, reply) = result?;
        self.wire = Some(wire);
        Ok(reply)
    }

    /// Sends a request and waits for its reply; repeats the request after each lost connection,
    /// within `limit` in total.
    fn exchange_again(&mut self, request: &str, limit: Duration) -> Result<Bytes, ClientError> {
        let wire = self.wire.take();
        let Self { endpoint, config, .. } = self;
        let result = self.runtime.block_on(async {
            timeout(limit, repeat(wire, config, endpoint, request, limit)).await.unwrap_or_else(
                |_| Err(ClientError::Timeout { address: endpoint.to_string(), after: limit }),
            )
        });
        let (wire, reply) = result?;
        self.wire = Some(wire);
        Ok(reply)
    }
}

/// Parses the reply to a request, or the refusal in this reply.
fn read_reply<T: DeserializeOwned>(request: &Request, reply: &[u8]) -> Result<T, ClientError> {
    #[derive(Deserialize)]
    struct ReplyHead {
        error: Option<Refusal>,
        #[serde(default)]
        ok: bool,
    }
    let wrong =
        |error: &serde_json::Error| ClientError::InvalidReply { message: error.to_string() };
    let head: ReplyHead = serde_json::from_slice(reply).map_err(|error| wrong(&error))?;
    match head {
        ReplyHead { ok: true, .. } => serde_json::from_slice(reply).map_err(|error| wrong(&error)),
        ReplyHead { error: Some(refusal), .. } => {
            let is_run = matches!(
                request,
                Request::RunMotions { .. } | Request::RunTrajectory { .. } | Request::LastRun
            );
            // The reply of an aborted run contains its measurements in addition to the error.
            let run = is_run.then(|| serde_json::from_slice::<Run>(reply).ok()).flatten();
            Err(ClientError::Refused { refusal, run: run.map(Box::new) })
        }
        ReplyHead { error: None, .. } => {
            Err(ClientError::InvalidReply { message: "it has neither `ok` nor `error`".to_owned() })
        }
    }
}

/// Sends a request until its reply arrives, again after each lost connection.
async fn repeat(
    mut wire: Option<WireConnection>,
    config: &WireConfig,
    endpoint: &Endpoint,
    request: &str,
    limit: Duration,
) -> Result<(WireConnection, Bytes), ClientError> {
    let since = Instant::now();
    loop {
        let patience = Patience::of_stop(limit.saturating_sub(since.elapsed()));
        match exchange(wire.take(), config, endpoint, request, patience).await {
            // Ends before the time-out, so that the lost connection is reported instead.
            Err(ClientError::Lost { .. }) if since.elapsed() + RETRY_INTERVAL < limit => {
                sleep(RETRY_INTERVAL).await;
            }
            result => return result,
        }
    }
}

/// Sends a request and waits for its reply, over the existing connection or a new one.
async fn exchange(
    wire: Option<WireConnection>,
    config: &WireConfig,
    endpoint: &Endpoint,
    request: &str,
    patience: Patience,
) -> Result<(WireConnection, Bytes), ClientError> {
    let lost = |error: ConnectionEnd| {
        tracing::debug!("{endpoint}: {error}");
        ClientError::Lost { address: endpoint.to_string() }
    };
    let mut wire = match still_up(wire).await {
        Some(wire) => wire,
        None => connect(config, endpoint, patience).await?,
    };
    // REQ sockets send and receive an empty frame before the message (`ZeroMQ` RFC 28).
    let frames = [Bytes::new(), Bytes::copy_from_slice(request.as_bytes())];
    wire.queue(&frames).map_err(lost)?;
    wire.flush().await.map_err(lost)?;
    loop {
        // A lost connection is not retried: a restarted drive does not know the request.
        if let WireInput::Message(mut reply) = wire.receive().await.map_err(lost)? {
            return Ok((wire, reply.frames.pop().unwrap_or_default()));
        }
    }
}

/// Returns the existing connection, if it is still open.
async fn still_up(wire: Option<WireConnection>) -> Option<WireConnection> {
    let mut wire = wire?;
    // Lets the runtime poll for input that has arrived meanwhile.
    yield_now().await;
    // A message at this point would not belong to any request.
    timeout(Duration::ZERO, wire.receive()).await.is_err().then_some(wire)
}

/// Connects to a drive, with retries, because the drive may be starting.
async fn connect(
    config: &WireConfig,
    endpoint: &Endpoint,
    patience: Patience,
) -> Result<WireConnection, ClientError> {
    let refused = |reason: ConnectionRefusal| ClientError::Unauthorized {
        address: endpoint.to_string(),
        reason: reason.reason(),
    };
    let since = Instant::now();
    // A longer time-out applies as soon as a server is known to listen at the address.
    let mut total = patience.total.min(CONNECT_TIMEOUT);
    let mut closed = 0;
    loop {
        let remaining = total.saturating_sub(since.elapsed()).min(patience.each);
        let mut failure = ClientError::Unreachable { address: endpoint.to_string() };
        match timeout(remaining, WireConnection::connect(endpoint, config)).await {
            Ok(Ok(wire)) => return Ok(wire),
            Ok(Err(ConnectionEnd::Io(error))) if is_absent(&error) => {}
            // A drive that is shutting down or under load also closes connections: only repetition
            // is a refusal.
            Ok(Err(ConnectionEnd::Refused(reason @ ConnectionRefusal::Closed)))
                if closed < patience.closed_handshakes =>
            {
                closed += 1;
                total = patience.total;
                failure = refused(reason);
            }
            Ok(Err(ConnectionEnd::Refused(reason))) => return Err(refused(reason)),
            Ok(Err(ConnectionEnd::Protocol(error))) => {
                return Err(ClientError::InvalidReply { message: error.to_string() });
            }
            // A server is listening at the address.
            Ok(Err(_)) | Err(_) => total = patience.total,
        }
        if since.elapsed() + RETRY_INTERVAL > total {
            return Err(failure);
        }
        sleep(RETRY_INTERVAL).await;
    }
}

/// Returns true for errors which mean that no server is listening at the address.
fn is_absent(error: &io::Error) -> bool {
    use io::ErrorKind::{BrokenPipe, ConnectionAborted, ConnectionReset, UnexpectedEof};
    // These errors occur on connections that a server has accepted.
    !matches!(error.kind(), BrokenPipe | ConnectionAborted | ConnectionReset | UnexpectedEof)
}
