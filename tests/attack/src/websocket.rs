//! Client of the twin's page that presses its stop button.

use std::{
    io::{self, BufRead, BufReader, Read, Write},
    net::{SocketAddr, TcpStream},
    sync::mpsc::{self, Receiver},
    thread,
    time::{Duration, Instant},
};

use serde_json::Value;

/// Connection to the twin. Input is read at once, as by a browser.
pub(super) struct WebSocket {
    stream: TcpStream,
    answers: Receiver<Value>,
    commands: u64,
}

impl WebSocket {
    /// Connects to a path with a token.
    pub(super) fn connect(address: SocketAddr, path: &str) -> io::Result<Self> {
        const TIMEOUT: Duration = Duration::from_secs(5);
        let mut stream = TcpStream::connect_timeout(&address, TIMEOUT)?;
        stream.set_nodelay(true)?;
        stream.set_read_timeout(Some(TIMEOUT))?;
        stream.set_write_timeout(Some(TIMEOUT))?;
        let request = format!(
            "GET {path} HTTP/1.1\r\nHost: {address}\r\nOrigin: http://{address}\r\nConnection: Upgrade\r\n\
             Upgrade: websocket\r\nSec-WebSocket-Version: 13\r\n\
             Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n"
        );
        stream.write_all(request.as_bytes())?;
        let mut reader = BufReader::new(stream.try_clone()?);
        let mut status = String::new();
        reader.read_line(&mut status)?;
        if !status.contains(" 101 ") {
            return Err(io::Error::other(format!("the twin refuses: {}", status.trim())));
        }
        let mut line = status;
        while line.trim() != "" {
            line.clear();
            reader.read_line(&mut line)?;
        }
        stream.set_read_timeout(None)?;
        let (sender, answers) = mpsc::channel();
        thread::spawn(move || {
            while let Ok(text) = read_frame(&mut reader) {
                if let Ok(mut message) = serde_json::from_slice::<Value>(&text)
                    && let Some(answer) = message.get_mut("answer")
                    && sender.send(answer.take()).is_err()
                {
                    return;
                }
            }
        });
        Ok(Self { stream, answers, commands: 0 })
    }

    /// Presses the stop button. Returns the arrival time of the answer, and its error.
    pub(super) fn stop(&mut self, timeout: Duration) -> io::Result<(Instant, Option<String>)> {
        let end = Instant::now() + timeout;
        self.commands += 1;
        let command = serde_json::json!({ "id": self.commands, "do": "stop" }).to_string();
        self.send(command.as_bytes())?;
        loop {
            let left = end.saturating_duration_since(Instant::now());
            let answer = self.answers.recv_timeout(left).map_err(io::Error::other)?;
            if answer["id"].as_u64() == Some(self.commands) {
                return Ok((Instant::now(), answer["error"].as_str().map(str::to_owned)));
            }
        }
    }

    /// Sends a text in one frame, with a length of two bytes and the mask 0.
    fn send(&mut self, text: &[u8]) -> io::Result<()> {
        let length = u16::try_from(text.len()).map_err(io::Error::other)?;
        let mut frame = vec![0x81, 0xfe];
        frame.extend(length.to_be_bytes());
        frame.extend([0; 4]);
        frame.extend(text);
        self.stream.write_all(&frame)
    }
}

impl Drop for WebSocket {
    fn drop(&mut self) {
        // Ends the reading thread.
        let _ = self.stream.shutdown(std::net::Shutdown::Both);
    }
}

fn read_frame(reader: &mut impl Read) -> io::Result<Vec<u8>> {
    let mut head = [0; 2];
    reader.read_exact(&mut head)?;
    let length = match head[1] & 0x7f {
        126 => {
            let mut length = [0; 2];
            reader.read_exact(&mut length)?;
            u64::from(u16::from_be_bytes(length))
        }
        127 => {
            let mut length = [0; 8];
            reader.read_exact(&mut length)?;
            u64::from_be_bytes(length)
        }
        short => u64::from(short),
    };
    let mut body = vec![0; usize::try_from(length).map_err(io::Error::other)?];
    reader.read_exact(&mut body)?;
    Ok(body)
}
