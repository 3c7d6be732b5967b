//! What a drive publishes.

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
    message::{DriveState, from_json},
    security::{Endpoint, Refused},
    socket::{HUNG_UP, Remote, SHORT_MESSAGE_BYTES},
    transport::{self, Incoming, Wire, WireConfig, WireError},
};

/// Follows the robot.
pub struct Stream {
    at: Endpoint,
    config: WireConfig,
    connection: Connection,
    runtime: Runtime,
}

enum Connection {
    None,
    /// On its way, whoever waits for it meanwhile.
    Coming(JoinHandle<Result<Wire, Refused>>),
    Open(Box<Wire>),
}

impl std::fmt::Debug for Stream {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Stream").finish_non_exhaustive()
    }
}

/// Something that was published.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(untagged)]
#[non_exhaustive]
pub enum Published {
    /// Measured joint positions, every cycle of FRI.
    Joints {
        /// When, in s: time of the controller since the drive has first heard of it.
        t_s: f64,
        /// Where, in rad.
        joints_rad: Joints,
    },
    /// The drive's state, when it changes.
    State {
        /// When, in s.
        t_s: f64,
        /// What it is now.
        state: DriveState,
    },
}

impl Published {
    /// The topic under which it is published.
    #[must_use]
    pub fn topic(&self) -> &'static str {
        match self {
            Self::Joints { .. } => "joints",
            Self::State { .. } => "state",
        }
    }
}

/// How long after a connection was lost another one is tried.
const AGAIN: Duration = Duration::from_millis(50);

/// How long a connection may take to come about.
const WITHIN: Duration = Duration::from_secs(2);

/// How long a new stream waits for its connection, so that it misses nothing from then on.
const AT_FIRST: Duration = Duration::from_millis(200);

impl Stream {
    /// Subscribes to the drive that publishes at `at`, as `tcp://127.0.0.1:5561`. What is published
    /// before the connection has come about is not heard. What is not taken waits in the system's
    /// buffers, and for some seconds at the drive.
    ///
    /// # Errors
    ///
    /// If the address is none, or needs keys.
    pub fn new(remote: &Remote, at: &str) -> Result<Self, LinkError> {
        let (at, config) = remote.wire(SocketType::Sub, at, SHORT_MESSAGE_BYTES)?;
        let runtime = transport::runtime().map_err(|source| LinkError::Thread { source })?;
        let mut stream = Self { at, config, connection: Connection::None, runtime };
        let Self { at, config, connection, runtime } = &mut stream;
        // Why there is none, the first call of `next` says.
        let _ = runtime.block_on(async { timeout(AT_FIRST, open(at, config, connection)).await });
        Ok(stream)
    }

    /// The next thing published; none within `patience`.
    ///
    /// # Errors
    ///
    /// [`LinkError::Unauthorized`] if the drive does not let this client in.
    pub fn next(&mut self, patience: Duration) -> Result<Option<Published>, LinkError> {
        let Self { at, config, connection, runtime } = self;
        let heard = runtime.block_on(async {
            // Without it, what has come in meanwhile is not seen.
            yield_now().await;
            timeout(patience, hear(at, config, connection)).await
        });
        heard.unwrap_or(Ok(None))
    }
}

/// Goes on until something has been published. Nothing is lost if it is dropped before.
async fn hear(
    at: &Endpoint,
    config: &WireConfig,
    connection: &mut Connection,
) -> Result<Option<Published>, LinkError> {
    loop {
        open(at, config, connection).await?;
        let Connection::Open(wire) = connection else { continue };
        match wire.receive().await {
            Ok(Incoming::Message(received)) => return Ok(read(&received.frames)),
            Ok(_) => {}
            Err(_) => *connection = Connection::None,
        }
    }
}

/// Waits for the connection.
async fn open(
    at: &Endpoint,
    config: &WireConfig,
    connection: &mut Connection,
) -> Result<(), LinkError> {
    loop {
        match connection {
            Connection::Open(_) => return Ok(()),
            Connection::None => {
                let task = tokio::spawn(connect(at.clone(), config.clone()));
                *connection = Connection::Coming(task);
            }
            Connection::Coming(task) => {
                let came = task.await;
                *connection = Connection::None;
                match came {
                    Ok(Ok(wire)) => *connection = Connection::Open(Box::new(wire)),
                    Ok(Err(why)) => {
                        let at = at.to_string();
                        return Err(LinkError::Unauthorized { at, what: why.what() });
                    }
                    Err(error) => tracing::warn!("the connection's task failed: {error}"),
                }
            }
        }
    }
}

/// Tries until there is a connection, or the drive does not want this client.
async fn connect(at: Endpoint, config: WireConfig) -> Result<Wire, Refused> {
    let mut hung_up = 0;
    loop {
        match timeout(WITHIN, subscribe(&at, &config)).await {
            Ok(Ok(wire)) => return Ok(wire),
            // A drive that is just ending hangs up, too: it counts if it does so again.
            Ok(Err(WireError::Refused(Refused::HungUp))) if hung_up < HUNG_UP => hung_up += 1,
            Ok(Err(WireError::Refused(why))) => return Err(why),
            _ => {}
        }
        sleep(AGAIN).await;
    }
}

async fn subscribe(at: &Endpoint, config: &WireConfig) -> Result<Wire, WireError> {
    let mut wire = Wire::connect(at, config).await?;
    for topic in ["joints", "state"] {
        wire.subscribe(topic)?;
    }
    wire.flush().await?;
    Ok(wire)
}

fn read(frames: &[Bytes]) -> Option<Published> {
    #[derive(Deserialize)]
    struct Joints7 {
        t_s: f64,
        joints_rad: Joints,
    }
    #[derive(Deserialize)]
    struct State {
        t_s: f64,
        state: DriveState,
    }
    match frames {
        [topic, body] if topic == "joints" => {
            from_json(body).map(|Joints7 { t_s, joints_rad }| Published::Joints { t_s, joints_rad })
        }
        [topic, body] if topic == "state" => {
            from_json(body).map(|State { t_s, state }| Published::State { t_s, state })
        }
        _ => None,
    }
}
