//! Raw requests.

use iiwasim_tests::socket::{Socket, SocketType};
use serde_json::Value;

use crate::link::rig::LONG;

/// A REQ socket: one request at a time.
pub(crate) struct RequestSocket {
    socket: Socket,
}

impl RequestSocket {
    pub(crate) fn new(address: &str) -> Self {
        Self { socket: Socket::connect(SocketType::Req, address).unwrap() }
    }

    pub(crate) fn request_bytes(&self, body: &[u8]) -> String {
        self.request_frames(&[body])
    }

    /// Returns the answer to a request of any number of frames.
    pub(crate) fn request_frames(&self, frames: &[&[u8]]) -> String {
        self.socket.send(frames).unwrap();
        let [answer] = self.socket.receive(LONG).expect("an answer in time").try_into().unwrap();
        String::from_utf8(answer).expect("text")
    }

    pub(crate) fn request(&self, body: &str) -> Value {
        serde_json::from_str(&self.request_bytes(body.as_bytes())).unwrap()
    }
}

/// Asserts that the error has this code, and a short message on one line with one of these texts.
pub(crate) fn assert_error(error: &Value, code: &str, names: &[&str], request: &str) {
    let request: String = request.chars().take(300).collect();
    assert_eq!(error["code"], code, "{request}: {error}");
    let message = error["message"].as_str().expect("a message");
    assert!(!message.is_empty() && message.len() <= 500, "{request}: {message}");
    assert!(!message.contains(char::is_control), "{request}: {message:?}");
    assert!(names.iter().any(|name| message.contains(name)), "{request}: {message}");
}
