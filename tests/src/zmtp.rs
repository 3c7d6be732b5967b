//! Minimal ZMTP 3.1 peers without keys: they can stop at any byte, send arbitrary data, and not
//! read replies.

use std::{
    io::{self, Read, Write},
    net::{SocketAddr, TcpStream},
    time::{Duration, Instant},
};

/// Flag of all frames of a message except the last one.
pub const MORE: u8 = 1;
/// Flag of a frame with an eight-byte length.
const LONG: u8 = 2;
/// Flag of a command.
pub const COMMAND: u8 = 4;

/// Maximum accepted frame size, in bytes.
const LONGEST: u64 = 1 << 30;

/// Time limit that no handshake on an idle machine reaches.
pub const HANDSHAKE_TIMEOUT: Duration = Duration::from_secs(3);

/// Endpoint of a connection.
#[derive(Debug)]
pub struct Peer {
    /// Connection, for data other than messages.
    pub stream: TcpStream,
}

impl Peer {
    /// Connects, and sends nothing.
    ///
    /// # Errors
    ///
    /// An error if the connection is not accepted within `timeout`.
    pub fn silent(address: SocketAddr, timeout: Duration) -> io::Result<Self> {
        Ok(Self { stream: TcpStream::connect_timeout(&address, timeout)? })
    }

    /// Connects as a socket of a kind (`REQ`, `DEALER`, `SUB` ...).
    ///
    /// # Errors
    ///
    /// See [`silent`](Self::silent) and [`shake_hands`](Self::shake_hands).
    pub fn connect(address: SocketAddr, kind: &str, timeout: Duration) -> io::Result<Self> {
        Self::shake_hands(Self::silent(address, timeout)?.stream, kind, timeout)
    }

    /// Performs the handshake, on either side. Later writes have the same time-out.
    ///
    /// # Errors
    ///
    /// An error if the connection fails, the handshake takes longer than `timeout`, or the peer
    /// requires keys.
    pub fn shake_hands(mut stream: TcpStream, kind: &str, timeout: Duration) -> io::Result<Self> {
        let end = Instant::now() + timeout;
        stream.set_nodelay(true)?;
        stream.set_write_timeout(Some(timeout))?;
        stream.write_all(&greeting())?;
        let mut theirs = [0; 64];
        read_until(&mut stream, &mut theirs, end)?;
        if !theirs[12..].starts_with(b"NULL\0") {
            return Err(io::Error::other("the other side requires keys"));
        }
        let mut ready = b"\x05READY".to_vec();
        for (name, value) in [("Socket-Type", kind), ("Identity", "")] {
            ready.push(u8::try_from(name.len()).unwrap_or_default());
            ready.extend(name.as_bytes());
            ready.extend(u32::try_from(value.len()).unwrap_or_default().to_be_bytes());
            ready.extend(value.as_bytes());
        }
        stream.write_all(&frame_head(COMMAND, ready.len()))?;
        stream.write_all(&ready)?;
        let mut peer = Self { stream };
        let (flags, body) = peer.frame(end)?;
        if flags & COMMAND == 0 || !body.starts_with(b"\x05READY") {
            return Err(io::Error::other("the other side is not ready"));
        }
        Ok(peer)
    }

    /// Sends a message.
    ///
    /// # Errors
    ///
    /// An error if the connection fails.
    pub fn send(&mut self, frames: &[&[u8]]) -> io::Result<()> {
        self.stream.write_all(&message(frames))
    }

    /// Waits for the next message, and answers heartbeats meanwhile. After an error, including a
    /// time-out, the connection is unusable.
    ///
    /// # Errors
    ///
    /// An error if the connection fails, or no message arrives within `timeout`.
    pub fn receive(&mut self, timeout: Duration) -> io::Result<Vec<Vec<u8>>> {
        let end = Instant::now() + timeout;
        let mut frames = Vec::new();
        loop {
            let (flags, body) = self.frame(end)?;
            if flags & COMMAND != 0 {
                // PING: its name, a two-byte time to live, and a context to return.
                if let Some(context) = body.strip_prefix(b"\x04PING").and_then(|ping| ping.get(2..))
                {
                    let pong = [b"\x04PONG", context].concat();
                    self.stream.write_all(&frame_head(COMMAND, pong.len()))?;
                    self.stream.write_all(&pong)?;
                }
                continue;
            }
            frames.push(body);
            if flags & MORE == 0 {
                return Ok(frames);
            }
        }
    }

    /// Returns true if the peer has closed the connection. Data received meanwhile are dropped.
    ///
    /// # Errors
    ///
    /// An error if the time-out of the connection cannot be set.
    pub fn is_closed(&mut self) -> io::Result<bool> {
        self.stream.set_read_timeout(Some(Duration::from_millis(1)))?;
        Ok(match self.stream.read(&mut [0; 1 << 12]) {
            Ok(count) => count == 0,
            Err(error) => {
                !matches!(error.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut)
            }
        })
    }

    fn frame(&mut self, end: Instant) -> io::Result<(u8, Vec<u8>)> {
        let mut head = [0; 2];
        read_until(&mut self.stream, &mut head, end)?;
        let mut length = u64::from(head[1]);
        if head[0] & LONG != 0 {
            let mut rest = [0; 7];
            read_until(&mut self.stream, &mut rest, end)?;
            length = rest.iter().fold(length, |sum, byte| sum << 8 | u64::from(*byte));
        }
        if length > LONGEST {
            return Err(io::Error::other("the other side sends a frame that is too long"));
        }
        let mut body = vec![0; usize::try_from(length).map_err(io::Error::other)?];
        read_until(&mut self.stream, &mut body, end)?;
        Ok((head[0], body))
    }
}

/// Encodes a message.
#[must_use]
pub fn message(frames: &[&[u8]]) -> Vec<u8> {
    let mut bytes = Vec::new();
    for (i, frame) in frames.iter().enumerate() {
        let more = if i + 1 < frames.len() { MORE } else { 0 };
        bytes.extend(frame_head(more, frame.len()));
        bytes.extend(*frame);
    }
    bytes
}

/// Encodes a subscription to a topic as a ZMTP 3.1 command.
#[must_use]
pub fn subscription(topic: &[u8]) -> Vec<u8> {
    let body = [b"\x09SUBSCRIBE", topic].concat();
    [frame_head(COMMAND, body.len()), body].concat()
}

/// Encodes the header of a frame.
#[must_use]
pub fn frame_head(flags: u8, length: usize) -> Vec<u8> {
    match u8::try_from(length) {
        Ok(length) => vec![flags, length],
        Err(_) => [vec![flags | LONG], (length as u64).to_be_bytes().to_vec()].concat(),
    }
}

/// Returns the greeting: signature, version 3.1, mechanism NULL.
fn greeting() -> [u8; 64] {
    let mut greeting = [0; 64];
    greeting[0] = 0xff;
    greeting[9] = 0x7f;
    greeting[10] = 3;
    greeting[11] = 1;
    greeting[12..16].copy_from_slice(b"NULL");
    greeting
}

fn read_until(stream: &mut TcpStream, mut into: &mut [u8], end: Instant) -> io::Result<()> {
    while !into.is_empty() {
        let left = end.saturating_duration_since(Instant::now());
        if left.is_zero() {
            return Err(io::ErrorKind::TimedOut.into());
        }
        stream.set_read_timeout(Some(left))?;
        match stream.read(into) {
            Ok(0) => return Err(io::ErrorKind::UnexpectedEof.into()),
            Ok(count) => into = &mut into[count..],
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::net::{Ipv4Addr, TcpListener};

    use super::*;

    #[test]
    fn two_peers_exchange_messages_of_any_length() {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
        let address = listener.local_addr().unwrap();
        let long = vec![7; 300_000];
        std::thread::scope(|scope| {
            scope.spawn(|| {
                let (stream, _) = listener.accept().unwrap();
                let mut server = Peer::shake_hands(stream, "ROUTER", HANDSHAKE_TIMEOUT).unwrap();
                let frames = server.receive(HANDSHAKE_TIMEOUT).unwrap();
                // A heartbeat in between is answered and is not a message.
                let ping = b"\x04PING\0\x0acontext";
                server.stream.write_all(&frame_head(COMMAND, ping.len())).unwrap();
                server.stream.write_all(ping).unwrap();
                server.send(&[b"", &frames[1], b"end"]).unwrap();
                let (flags, pong) = server.frame(Instant::now() + HANDSHAKE_TIMEOUT).unwrap();
                assert_eq!((flags, pong.as_slice()), (COMMAND, b"\x04PONGcontext".as_slice()));
            });
            let mut client = Peer::connect(address, "REQ", HANDSHAKE_TIMEOUT).unwrap();
            client.send(&[b"", &long]).unwrap();
            let frames = client.receive(HANDSHAKE_TIMEOUT).unwrap();
            assert_eq!(frames, [b"".to_vec(), long.clone(), b"end".to_vec()]);
        });
    }
}
