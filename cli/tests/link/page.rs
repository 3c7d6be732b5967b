//! Client of the twin that acts like its page.

use std::{
    collections::HashMap,
    fmt::Write as _,
    io::{Read as _, Write as _},
    net::TcpStream,
    time::{Duration, Instant},
};

use serde_json::{Value, json};
use tungstenite::{
    Message, WebSocket, client,
    client::IntoClientRequest as _,
    handshake::HandshakeError,
    http::{HeaderName, StatusCode},
};

use crate::link::rig::{LONG, Process, wait_for};

/// Address of a twin: host and port, and its token.
#[derive(Clone)]
pub(crate) struct Address {
    pub(crate) host: String,
    pub(crate) token: String,
}

impl Address {
    /// Parses the address that the twin prints.
    pub(crate) fn of(twin: &Process) -> Self {
        wait_for("address", || twin.stdout().ends_with('\n'));
        let printed = twin.stdout();
        let (host, token) = printed.trim().split_once("/?token=").unwrap();
        Self { host: host.strip_prefix("http://").unwrap().to_owned(), token: token.to_owned() }
    }

    /// Returns status and text of the answer to a request with these headers.
    pub(crate) fn get(&self, path: &str, headers: &[(&str, &str)]) -> (u16, String) {
        let mut stream = TcpStream::connect(&self.host).unwrap();
        stream.set_read_timeout(Some(LONG)).unwrap();
        let mut lines = String::new();
        for (name, value) in headers {
            let _ = write!(lines, "{name}: {value}\r\n");
        }
        write!(stream, "GET {path} HTTP/1.1\r\n{lines}Connection: close\r\n\r\n").unwrap();
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer).unwrap();
        let answer = String::from_utf8_lossy(&answer).into_owned();
        let status = answer.split(' ').nth(1).unwrap().parse().unwrap();
        (status, answer)
    }

    /// Downloads a file as the page does.
    pub(crate) fn file(&self, path: &str) -> Vec<u8> {
        let mut stream = TcpStream::connect(&self.host).unwrap();
        let Self { host, token } = self;
        write!(stream, "GET /{path}?token={token} HTTP/1.0\r\nHost: {host}\r\n\r\n").unwrap();
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer).unwrap();
        assert!(answer.starts_with(b"HTTP/1.0 200"), "{path}");
        let body = answer.windows(4).position(|bytes| bytes == b"\r\n\r\n").unwrap();
        answer.split_off(body + 4)
    }

    /// Uploads a program as the page does; the error is the reason for its rejection.
    pub(crate) fn load(&self, program: &Value) -> Result<(), String> {
        let Self { host, token } = self;
        let (name, text) = (program["name"].as_str().unwrap(), program["text"].as_str().unwrap());
        let name = name.bytes().fold(String::new(), |mut name, byte| {
            let _ = write!(name, "%{byte:02x}");
            name
        });
        let mut stream = TcpStream::connect(host).unwrap();
        let head = format!(
            "POST /program?token={token}&name={name} HTTP/1.0\r\nHost: {host}\r\n\
             Origin: http://{host}\r\nContent-Length: {}\r\n\r\n",
            text.len()
        );
        // The upload may be rejected before it is complete.
        let _ = stream.write_all(&[head.as_bytes(), text.as_bytes()].concat());
        let mut answer = String::new();
        stream.read_to_string(&mut answer).unwrap();
        let (head, body) = answer.split_once("\r\n\r\n").unwrap();
        if !head.starts_with("HTTP/1.0 200") {
            return Err(body.to_owned());
        }
        let answer: Value = serde_json::from_str(body).unwrap();
        answer["error"].as_str().map_or(Ok(()), |error| Err(error.to_owned()))
    }

    /// Connects as the page does; the error is the status of the rejection.
    pub(crate) fn connect(&self, path: &str, origin: Option<&str>) -> Result<Page, StatusCode> {
        let stream = TcpStream::connect(&self.host).unwrap();
        let mut request = format!("ws://{}{path}", self.host).into_client_request().unwrap();
        if let Some(origin) = origin {
            let name = HeaderName::from_static("origin");
            request.headers_mut().insert(name, origin.parse().unwrap());
        }
        match client(request, stream) {
            Ok((socket, _)) => {
                Ok(Page { socket, newest: HashMap::new(), answers: Vec::new(), orders: 0 })
            }
            Err(HandshakeError::Failure(tungstenite::Error::Http(answer))) => Err(answer.status()),
            Err(other) => panic!("{other}"),
        }
    }

    /// Connects as the page does.
    pub(crate) fn page(&self) -> Page {
        let path = format!("/live?token={}", self.token);
        self.connect(&path, Some(&format!("http://{}", self.host))).unwrap()
    }
}

/// Open page.
pub(crate) struct Page {
    socket: WebSocket<TcpStream>,
    /// Latest message of each kind.
    newest: HashMap<String, Value>,
    answers: Vec<Value>,
    orders: u64,
}

impl Page {
    /// Receives the next message.
    fn take(&mut self) {
        self.socket.get_ref().set_read_timeout(Some(LONG)).unwrap();
        let Message::Text(text) = self.socket.read().unwrap() else { return };
        let word: HashMap<String, Value> = serde_json::from_str(&text).unwrap();
        for (kind, value) in word {
            match kind.as_str() {
                "answer" => self.answers.push(value),
                _ => drop(self.newest.insert(kind, value)),
            }
        }
    }

    /// Waits for a message that satisfies a predicate.
    pub(crate) fn wait_for(&mut self, kind: &str, holds: impl Fn(&Value) -> bool) -> Value {
        let since = Instant::now();
        loop {
            let newest = self.newest.get(kind).filter(|newest| holds(newest));
            if let Some(newest) = newest {
                return newest.clone();
            }
            assert!(since.elapsed() < LONG, "no such {kind}; it is {:?}", self.newest.get(kind));
            self.take();
        }
    }

    /// Counts the messages of a kind within a time.
    pub(crate) fn count(&mut self, kind: &str, during: Duration) -> u32 {
        let since = Instant::now();
        let mut count = 0;
        while since.elapsed() < during {
            self.newest.remove(kind);
            self.take();
            count += u32::from(self.newest.contains_key(kind));
        }
        count
    }

    /// Sends a request; the error is the reason for its rejection.
    pub(crate) fn order(&mut self, order: &str, parameters: Value) -> Result<(), String> {
        let id = self.begin(order, parameters);
        self.answer(id)
    }

    /// Sends a request without waiting for the answer; returns its number.
    pub(crate) fn begin(&mut self, order: &str, mut parameters: Value) -> u64 {
        self.orders += 1;
        parameters["id"] = json!(self.orders);
        parameters["do"] = json!(order);
        self.send_text(&parameters.to_string());
        self.orders
    }

    /// Waits for the answer to a request; the error is the reason for its rejection.
    pub(crate) fn answer(&mut self, id: u64) -> Result<(), String> {
        let since = Instant::now();
        loop {
            if let Some(answer) = self.answers.iter().find(|answer| answer["id"] == id) {
                return match answer["error"].as_str() {
                    None => Ok(()),
                    Some(error) => Err(error.to_owned()),
                };
            }
            assert!(since.elapsed() < LONG, "no answer to order {id}");
            self.take();
        }
    }

    /// Number of answered requests so far.
    pub(crate) fn answered(&self) -> usize {
        self.answers.len()
    }

    /// Sends any text.
    pub(crate) fn send_text(&mut self, text: &str) {
        self.socket.send(Message::text(text)).unwrap();
    }

    /// Sends a text that is too long, and waits for the disconnection.
    pub(crate) fn cut_off(&mut self, text: &str) {
        // The connection may close before the text is sent.
        let _ = self.socket.send(Message::text(text));
        while self.socket.read().is_ok() {}
    }

    /// Returns the reason for rejecting an invalid request.
    pub(crate) fn refusal(&mut self) -> String {
        while self.answers.iter().all(|answer| answer["id"] != 0) {
            self.take();
        }
        let index = self.answers.iter().position(|answer| answer["id"] == 0).unwrap();
        self.answers.remove(index)["error"].as_str().unwrap().to_owned()
    }
}
