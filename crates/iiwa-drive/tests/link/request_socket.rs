//! Raw requests.

use serde_json::Value;

use crate::rig::LONG;

/// A REQ socket: one request at a time.
pub(crate) struct RequestSocket {
    pub(crate) socket: zmq::Socket,
}

impl RequestSocket {
    pub(crate) fn new(at: &str) -> Self {
        let socket = zmq::Context::new().socket(zmq::REQ).unwrap();
        socket.set_linger(0).unwrap();
        socket.set_rcvtimeo(i32::try_from(LONG.as_millis()).unwrap()).unwrap();
        socket.connect(at).unwrap();
        Self { socket }
    }

    pub(crate) fn ask_bytes(&self, body: &[u8]) -> String {
        self.socket.send(body, 0).unwrap();
        self.socket.recv_string(0).expect("an answer in time").expect("text")
    }

    pub(crate) fn ask(&self, body: &str) -> Value {
        serde_json::from_str(&self.ask_bytes(body.as_bytes())).unwrap()
    }
}

/// The error has this code, and a short message on one line with one of these texts.
pub(crate) fn assert_error(error: &Value, code: &str, names: &[&str], request: &str) {
    let request: String = request.chars().take(300).collect();
    assert_eq!(error["code"], code, "{request}: {error}");
    let message = error["message"].as_str().expect("a message");
    assert!(!message.is_empty() && message.len() <= 500, "{request}: {message}");
    assert!(!message.contains(char::is_control), "{request}: {message:?}");
    assert!(names.iter().any(|name| message.contains(name)), "{request}: {message}");
}
