//! The other side of a robot program.

use std::time::Duration;

/// A message from a robot program, with all its frames.
#[derive(Clone, Debug)]
pub enum Incoming {
    /// On the socket for instructions.
    Answer(Vec<Vec<u8>>),
    /// On the socket for state changes.
    State(Vec<Vec<u8>>),
}

/// Connections to both sockets of a robot program.
pub trait DrivePeer {
    /// Sends a message to the socket for instructions.
    fn instruct(&mut self, frames: Vec<Vec<u8>>);

    /// Sends a message to the socket for state changes.
    fn acknowledge(&mut self, frames: Vec<Vec<u8>>);

    /// The next message of either socket, if it arrives within `timeout`.
    fn next(&mut self, timeout: Duration) -> Option<Incoming>;
}

/// The same by `libzmq`, without keys.
pub struct ZmqPeer {
    instructions: zmq::Socket,
    state: zmq::Socket,
}

impl ZmqPeer {
    /// Connects to the addresses of instructions and of state changes, such as `tcp://127.0.0.1:30001`.
    ///
    /// # Panics
    ///
    /// If an address is none.
    #[expect(clippy::expect_used, reason = "a test fails by it")]
    #[must_use]
    pub fn connect(instructions: &str, state: &str) -> Self {
        let context = zmq::Context::new();
        let [instructions, state] = [instructions, state].map(|at| {
            let socket = context.socket(zmq::DEALER).expect("a socket");
            socket.set_linger(0).expect("an option");
            socket.connect(at).expect("an address");
            socket
        });
        Self { instructions, state }
    }
}

#[expect(clippy::expect_used, reason = "a test fails by it")]
impl DrivePeer for ZmqPeer {
    fn instruct(&mut self, frames: Vec<Vec<u8>>) {
        self.instructions.send_multipart(frames, 0).expect("a connection");
    }

    fn acknowledge(&mut self, frames: Vec<Vec<u8>>) {
        self.state.send_multipart(frames, 0).expect("a connection");
    }

    fn next(&mut self, timeout: Duration) -> Option<Incoming> {
        let mut items =
            [&self.instructions, &self.state].map(|socket| socket.as_poll_item(zmq::POLLIN));
        // Rounded up, so that a short rest of a time-out is not a busy loop.
        let timeout_ms = i64::try_from(timeout.as_micros().div_ceil(1000)).unwrap_or(i64::MAX);
        zmq::poll(&mut items, timeout_ms).expect("a poll");
        let [answer, state] = items.map(|item| item.is_readable());
        if answer {
            return Some(Incoming::Answer(self.instructions.recv_multipart(0).expect("a message")));
        }
        state.then(|| Incoming::State(self.state.recv_multipart(0).expect("a message")))
    }
}
