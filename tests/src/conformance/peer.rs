//! Peer of a robot program.

use std::time::Duration;

use crate::socket::{Socket, SocketType, receive_any};

/// Message from a robot program, with all its frames.
#[derive(Clone, Debug)]
pub enum Incoming {
    /// Answer on the socket for instructions.
    Answer(Vec<Vec<u8>>),
    /// Message on the socket for state changes.
    State(Vec<Vec<u8>>),
}

/// Connections to both sockets of a robot program.
pub trait DrivePeer {
    /// Sends a message to the socket for instructions.
    fn instruct(&mut self, frames: Vec<Vec<u8>>);

    /// Sends a message to the socket for state changes.
    fn acknowledge(&mut self, frames: Vec<Vec<u8>>);

    /// Returns the next message of either socket, if it arrives within `timeout`.
    fn next(&mut self, timeout: Duration) -> Option<Incoming>;
}

/// Peer with `ZeroMQ` sockets, without keys.
pub struct ZmqPeer {
    instructions: Socket,
    state: Socket,
}

impl ZmqPeer {
    /// Connects to the addresses of instructions and of state changes, such as
    /// `tcp://127.0.0.1:30001`.
    ///
    /// # Panics
    ///
    /// Panics if an address is invalid.
    #[expect(clippy::expect_used, reason = "a test fails by it")]
    #[must_use]
    pub fn connect(instructions: &str, state: &str) -> Self {
        let [instructions, state] = [instructions, state]
            .map(|address| Socket::connect(SocketType::Dealer, address).expect("an address"));
        Self { instructions, state }
    }
}

#[expect(clippy::expect_used, reason = "a test fails by it")]
impl DrivePeer for ZmqPeer {
    fn instruct(&mut self, frames: Vec<Vec<u8>>) {
        self.instructions.send(&frames).expect("a connection");
    }

    fn acknowledge(&mut self, frames: Vec<Vec<u8>>) {
        self.state.send(&frames).expect("a connection");
    }

    fn next(&mut self, timeout: Duration) -> Option<Incoming> {
        match receive_any(&[&self.instructions, &self.state], timeout)? {
            (0, frames) => Some(Incoming::Answer(frames)),
            (_, frames) => Some(Incoming::State(frames)),
        }
    }
}
