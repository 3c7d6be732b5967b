//! A client of the drive.

use std::time::{Duration, Instant};

use bytes::Bytes;
use iiwa_path::Motion;
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
        Code, IoValue, MAX_MESSAGE_BYTES, MAX_REPLY_BYTES, Refusal, Request, Run, Sensors, Status,
    },
    security::{Endpoint, Refused},
    socket::{HUNG_UP, Remote},
    timed_joints::TimedJoints,
    transport::{self, Incoming, Wire, WireConfig, WireError},
};

/// Asks a drive, one request after the other.
pub struct Client {
    at: Endpoint,
    config: WireConfig,
    /// None before the first request, and after one that broke off.
    wire: Option<Wire>,
    runtime: Runtime,
}

impl std::fmt::Debug for Client {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Client").field("at", &self.at).finish_non_exhaustive()
    }
}

/// Why a request brought no answer.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ClientError {
    /// The drive, or the robot, says no.
    #[error("{refusal}")]
    Refused {
        /// Why.
        refusal: Refusal,
        /// What was measured until then, if it was a run.
        run: Option<Box<Run>>,
    },
    /// Nobody is there.
    #[error("no drive answers at {at}; is `iiwasim drive` running there?")]
    Nobody {
        /// The address.
        at: String,
    },
    /// The drive does not let this client in.
    #[error("the drive at {at} does not let this client in: {what}")]
    Unauthorized {
        /// The address.
        at: String,
        /// What it has against it.
        what: &'static str,
    },
    /// The connection broke off before the answer.
    #[error("the connection to the drive at {at} broke off before its answer")]
    Lost {
        /// The address.
        at: String,
    },
    /// The drive took too long.
    #[error("the drive at {at} did not answer within {} s", .after.as_secs_f64())]
    Timeout {
        /// The address.
        at: String,
        /// After this time.
        after: Duration,
    },
    /// The request is too long to be sent.
    #[error("the request is {found} bytes long, a drive takes {MAX_MESSAGE_BYTES}; divide it")]
    TooLong {
        /// Its length, in bytes.
        found: usize,
    },
    /// The answer is not understood.
    #[error("the drive's answer is not understood: {what}")]
    Answer {
        /// What is wrong with it.
        what: String,
    },
    /// The connection cannot be set up.
    #[error(transparent)]
    Link(#[from] LinkError),
}

impl ClientError {
    /// The code of the contract for it.
    #[must_use]
    pub fn code(&self) -> Code {
        match self {
            Self::Refused { refusal, .. } => refusal.code,
            Self::Unauthorized { .. } => Code::Unauthorized,
            Self::TooLong { .. } | Self::Answer { .. } => Code::BadRequest,
            _ => Code::Timeout,
        }
    }
}

/// How long a connection may take to come about.
const CONNECTED_WITHIN: Duration = Duration::from_secs(3);
/// How long an answer may take that needs no motion: the robot program is asked for some.
const ANSWERED_WITHIN: Duration = Duration::from_secs(5);
/// How long after a connection did not come about another one is tried.
const AGAIN: Duration = Duration::from_millis(50);

impl Client {
    /// A client of the drive at `at`, as `tcp://127.0.0.1:5560`. It connects by itself, and again after
    /// the connection was lost.
    ///
    /// # Errors
    ///
    /// If the address is none, or needs keys.
    pub fn new(remote: &Remote, at: &str) -> Result<Self, LinkError> {
        let (at, config) = remote.wire(SocketType::Req, at, MAX_REPLY_BYTES)?;
        let runtime = transport::runtime().map_err(|source| LinkError::Thread { source })?;
        Ok(Self { at, config, wire: None, runtime })
    }

    /// What the robot does now.
    ///
    /// # Errors
    ///
    /// Any [`ClientError`], as of all requests.
    pub fn state(&mut self) -> Result<Status, ClientError> {
        self.ask(&Request::State, Some(ANSWERED_WITHIN))
    }

    /// Runs motions, and returns when they are done; without `patience`, however long that takes.
    ///
    /// # Errors
    ///
    /// Any [`ClientError`]; of a run that broke off, with what was measured.
    pub fn run_motions(
        &mut self,
        motions: Vec<Motion>,
        patience: Option<Duration>,
    ) -> Result<Run, ClientError> {
        self.ask(&Request::RunMotions { motions }, patience)
    }

    /// Runs a trajectory, and returns when it is done; without `patience`, however long that takes.
    ///
    /// # Errors
    ///
    /// As [`run_motions`](Self::run_motions).
    pub fn run_trajectory(
        &mut self,
        trajectory: TimedJoints,
        patience: Option<Duration>,
    ) -> Result<Run, ClientError> {
        self.ask(&Request::RunTrajectory { trajectory }, patience)
    }

    /// What the last run measured.
    ///
    /// # Errors
    ///
    /// Any [`ClientError`]; that of the run, if it broke off.
    pub fn last_run(&mut self) -> Result<Run, ClientError> {
        self.ask(&Request::LastRun, Some(ANSWERED_WITHIN))
    }

    /// Reads the robot's sensors.
    ///
    /// # Errors
    ///
    /// Any [`ClientError`].
    pub fn read_sensors(&mut self) -> Result<Sensors, ClientError> {
        #[derive(Deserialize)]
        struct Answer {
            sensors: Sensors,
        }
        let Answer { sensors } = self.ask(&Request::ReadSensors, Some(ANSWERED_WITHIN))?;
        Ok(sensors)
    }

    /// Reads an input or output.
    ///
    /// # Errors
    ///
    /// Any [`ClientError`].
    pub fn get_io(&mut self, name: &str) -> Result<IoValue, ClientError> {
        self.ask_value(&Request::GetIo { name: name.to_owned() })
    }

    /// Sets an output, and returns what it is then.
    ///
    /// # Errors
    ///
    /// Any [`ClientError`].
    pub fn set_io(&mut self, name: &str, value: IoValue) -> Result<IoValue, ClientError> {
        self.ask_value(&Request::SetIo { name: name.to_owned(), value })
    }

    fn ask_value(&mut self, request: &Request) -> Result<IoValue, ClientError> {
        #[derive(Deserialize)]
        struct Answer {
            value: IoValue,
        }
        let Answer { value } = self.ask(request, Some(ANSWERED_WITHIN))?;
        Ok(value)
    }

    /// Stops what is running, on its path, and returns when the arm stands.
    ///
    /// # Errors
    ///
    /// Any [`ClientError`].
    pub fn stop(&mut self) -> Result<(), ClientError> {
        #[derive(Deserialize)]
        struct Nothing {}
        let Nothing {} = self.ask(&Request::Stop, Some(ANSWERED_WITHIN))?;
        Ok(())
    }

    fn ask<T: DeserializeOwned>(
        &mut self,
        request: &Request,
        patience: Option<Duration>,
    ) -> Result<T, ClientError> {
        #[derive(Deserialize)]
        struct Head {
            error: Option<Refusal>,
            #[serde(default)]
            ok: bool,
        }
        let answer = self.exchange(&request.to_json(), patience)?;
        let wrong = |error: &serde_json::Error| ClientError::Answer { what: error.to_string() };
        let head: Head = serde_json::from_slice(&answer).map_err(|error| wrong(&error))?;
        match head {
            Head { ok: true, .. } => serde_json::from_slice(&answer).map_err(|error| wrong(&error)),
            Head { error: Some(refusal), .. } => {
                let is_run = matches!(
                    request,
                    Request::RunMotions { .. } | Request::RunTrajectory { .. } | Request::LastRun
                );
                let run = is_run.then(|| serde_json::from_slice::<Run>(&answer).ok()).flatten();
                Err(ClientError::Refused { refusal, run: run.map(Box::new) })
            }
            Head { error: None, .. } => {
                Err(ClientError::Answer { what: "it is neither `ok` nor an `error`".to_owned() })
            }
        }
    }

    /// Sends a request and waits for its answer.
    fn exchange(
        &mut self,
        request: &str,
        patience: Option<Duration>,
    ) -> Result<Bytes, ClientError> {
        if request.len() > MAX_MESSAGE_BYTES {
            return Err(ClientError::TooLong { found: request.len() });
        }
        let wire = self.wire.take();
        let Self { at, config, .. } = self;
        let asked = ask(wire, config, at, request);
        let answered = self.runtime.block_on(async {
            match patience {
                None => asked.await,
                Some(after) => timeout(after, asked)
                    .await
                    .unwrap_or_else(|_| Err(ClientError::Timeout { at: at.to_string(), after })),
            }
        });
        let (wire, answer) = answered?;
        self.wire = Some(wire);
        Ok(answer)
    }
}

/// Sends a request and waits for its answer, over the connection that there is, or a new one.
async fn ask(
    wire: Option<Wire>,
    config: &WireConfig,
    at: &Endpoint,
    request: &str,
) -> Result<(Wire, Bytes), ClientError> {
    let lost = |error: WireError| {
        tracing::debug!("{at}: {error}");
        ClientError::Lost { at: at.to_string() }
    };
    let mut wire = match still_up(wire).await {
        Some(wire) => wire,
        None => connect(config, at).await?,
    };
    let frames = [Bytes::new(), Bytes::copy_from_slice(request.as_bytes())];
    wire.queue(&frames).map_err(lost)?;
    wire.flush().await.map_err(lost)?;
    loop {
        // It may be back within a moment, but it does not know of the request then.
        if let Incoming::Message(mut answer) = wire.receive().await.map_err(lost)? {
            return Ok((wire, answer.frames.pop().unwrap_or_default()));
        }
    }
}

/// The connection that there was, if it has lasted.
async fn still_up(wire: Option<Wire>) -> Option<Wire> {
    let mut wire = wire?;
    // Without it, what has come in meanwhile is not seen.
    yield_now().await;
    // What comes now answers nothing.
    timeout(Duration::ZERO, wire.receive()).await.is_err().then_some(wire)
}

/// Connects with a drive. It may just be starting.
async fn connect(config: &WireConfig, at: &Endpoint) -> Result<Wire, ClientError> {
    let since = Instant::now();
    let mut hung_up = 0;
    loop {
        let left = CONNECTED_WITHIN.saturating_sub(since.elapsed());
        match timeout(left, Wire::connect(at, config)).await {
            Ok(Ok(wire)) => return Ok(wire),
            // A drive that is just ending hangs up, too: it counts if it does so again.
            Ok(Err(WireError::Refused(Refused::HungUp))) if hung_up < HUNG_UP => hung_up += 1,
            Ok(Err(WireError::Refused(why))) => {
                return Err(ClientError::Unauthorized { at: at.to_string(), what: why.what() });
            }
            Ok(Err(WireError::Protocol(error))) => {
                return Err(ClientError::Answer { what: error.to_string() });
            }
            Ok(Err(_)) | Err(_) => {}
        }
        if since.elapsed() + AGAIN > CONNECTED_WITHIN {
            return Err(ClientError::Nobody { at: at.to_string() });
        }
        sleep(AGAIN).await;
    }
}
