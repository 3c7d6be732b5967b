//! What a drive publishes.

use std::time::Duration;

use iiwa_kin::Joints;
use serde::{Deserialize, Serialize};

use crate::{
    error::LinkError,
    message::{DriveState, from_json},
    security::{Handshake, WatchedSocket},
    socket::{HUNG_UP, Remote},
};

/// Follows the robot.
pub struct Stream {
    socket: WatchedSocket,
    at: String,
    /// How often in a row the drive has hung up.
    hung_up: u32,
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

/// Most messages that wait to be taken: more than a minute at 1 ms.
const BACKLOG: i32 = 100_000;

impl Stream {
    /// Subscribes to the drive that publishes at `at`, as `tcp://127.0.0.1:5561`. What is published
    /// before the connection has come about is not heard.
    ///
    /// # Errors
    ///
    /// If the address is none, or needs keys.
    pub fn new(remote: &Remote, at: &str) -> Result<Self, LinkError> {
        let socket = remote.connect_watched(zmq::SUB, at, |socket| {
            socket.set_rcvhwm(BACKLOG)?;
            socket.set_subscribe(b"joints")?;
            socket.set_subscribe(b"state")
        })?;
        Ok(Self { socket, at: at.to_owned(), hung_up: 0 })
    }

    /// The next thing published; none within `patience`.
    ///
    /// # Errors
    ///
    /// [`LinkError::Unauthorized`] if the drive does not let this client in; the library refuses.
    pub fn next(&mut self, patience: Duration) -> Result<Option<Published>, LinkError> {
        let patience_ms = i64::try_from(patience.as_millis()).unwrap_or(i64::MAX);
        match self.socket.poll(zmq::POLLIN, patience_ms) {
            Ok(0) => return self.check_let_in().map(|()| None),
            Err(zmq::Error::EINTR) => return Ok(None),
            Ok(_) => {}
            Err(error) => return Err(LinkError::socket(error)),
        }
        match self.socket.recv_multipart(zmq::DONTWAIT) {
            Ok(frames) => Ok(read(&frames)),
            Err(zmq::Error::EAGAIN | zmq::Error::EINTR) => Ok(None),
            Err(error) => Err(LinkError::socket(error)),
        }
    }

    /// Silence may mean that the drive does not want this client.
    fn check_let_in(&mut self) -> Result<(), LinkError> {
        match self.socket.handshake()? {
            None => {}
            Some(Handshake::Done | Handshake::Lost) => self.hung_up = 0,
            // A drive that is just ending does so, too: it counts if it does so again.
            Some(Handshake::HungUp) if self.hung_up < HUNG_UP => self.hung_up += 1,
            Some(refused) => {
                let at = self.at.clone();
                return Err(LinkError::Unauthorized { at, what: refused.what() });
            }
        }
        Ok(())
    }
}

fn read(frames: &[Vec<u8>]) -> Option<Published> {
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
        [topic, body] if topic == b"joints" => {
            from_json(body).map(|Joints7 { t_s, joints_rad }| Published::Joints { t_s, joints_rad })
        }
        [topic, body] if topic == b"state" => {
            from_json(body).map(|State { t_s, state }| Published::State { t_s, state })
        }
        _ => None,
    }
}
