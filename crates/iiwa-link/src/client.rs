//! A client of the drive.

use std::time::{Duration, Instant};

use iiwa_path::Motion;
use serde::{Deserialize, de::DeserializeOwned};

use crate::{
    error::LinkError,
    message::{Code, IoValue, MAX_MESSAGE_BYTES, Refusal, Request, Run, Sensors, Status},
    security::{Handshake, WatchedSocket},
    socket::{HUNG_UP, Remote},
    timed_joints::TimedJoints,
};

/// Asks a drive, one request after the other.
pub struct Client {
    remote: Remote,
    at: String,
    /// None after a request that broke off: a REQ socket cannot go on then.
    socket: Option<WatchedSocket>,
    connected: bool,
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
/// How often the connection is looked at while an answer is waited for, in ms.
const LOOK_MS: i64 = 50;

impl Client {
    /// A client of the drive at `at`, as `tcp://127.0.0.1:5560`. It connects by itself, and again after
    /// the connection was lost.
    ///
    /// # Errors
    ///
    /// If the address is none, or needs keys.
    pub fn new(remote: &Remote, at: &str) -> Result<Self, LinkError> {
        let mut client =
            Self { remote: remote.clone(), at: at.to_owned(), socket: None, connected: false };
        client.socket = Some(client.connect()?);
        Ok(client)
    }

    fn connect(&self) -> Result<WatchedSocket, LinkError> {
        self.remote.connect_watched(zmq::REQ, &self.at, |_| Ok(()))
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
    ) -> Result<Vec<u8>, ClientError> {
        if request.len() > MAX_MESSAGE_BYTES {
            return Err(ClientError::TooLong { found: request.len() });
        }
        let socket = if let Some(socket) = self.socket.take() {
            socket
        } else {
            self.connected = false;
            self.connect()?
        };
        let at = || self.at.clone();
        let failed = |source| ClientError::Link(LinkError::socket(source));
        match socket.handshake().map_err(LinkError::from)? {
            Some(Handshake::Done) => self.connected = true,
            // Since the last request: another connection is on its way.
            Some(Handshake::Lost) => self.connected = false,
            // It was not let in, and does not try again.
            Some(refused) if refused != Handshake::HungUp => {
                return Err(ClientError::Unauthorized { at: at(), what: refused.what() });
            }
            _ => {}
        }
        socket.send(request, zmq::DONTWAIT).map_err(failed)?;
        let since = Instant::now();
        let mut hung_up = 0;
        loop {
            if socket.poll(zmq::POLLIN, LOOK_MS).map_err(failed)? > 0 {
                let answer = socket.recv_bytes(zmq::DONTWAIT).map_err(failed)?;
                self.connected = true;
                self.socket = Some(socket);
                return Ok(answer);
            }
            match socket.handshake().map_err(LinkError::from)? {
                // It may be back within a moment, but it does not know of the request then.
                Some(Handshake::Done | Handshake::Lost) if self.connected => {
                    return Err(ClientError::Lost { at: at() });
                }
                Some(Handshake::Done) => self.connected = true,
                None | Some(Handshake::Lost) => {}
                // A drive that is just ending does so, too: it counts if it does so again.
                Some(Handshake::HungUp) if hung_up < HUNG_UP => hung_up += 1,
                Some(refused) => {
                    return Err(ClientError::Unauthorized { at: at(), what: refused.what() });
                }
            }
            let waited = since.elapsed();
            if !self.connected && waited > CONNECTED_WITHIN {
                return Err(ClientError::Nobody { at: at() });
            }
            if let Some(after) = patience.filter(|patience| waited > *patience) {
                return Err(ClientError::Timeout { at: at(), after });
            }
        }
    }
}
