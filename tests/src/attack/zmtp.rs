//! Minimal ZMTP 3.1 peers without keys, for attacks: they can stop at any byte, send arbitrary data, and not read
//! replies.

use std::{
    io::{self, Read, Write},
    net::{SocketAddr, TcpStream},
    time::{Duration, Instant},
};

const MORE: u8 = 1;
const LONG: u8 = 2;
const COMMAND: u8 = 4;

/// Longest accepted frame, in bytes.
const LONGEST: u64 = 1 << 30;

/// Time-out of the handshake.
const HANDSHAKE_TIMEOUT: Duration = Duration::from_secs(3);

/// One end of a connection, after the handshake.
pub(super) struct Peer {
    pub(super) stream: TcpStream,
}

impl Peer {
    /// Connects as a socket of a kind (`REQ`, `DEALER`, `SUB` ...).
    pub(super) fn connect(at: SocketAddr, kind: &str) -> io::Result<Self> {
        let stream = TcpStream::connect_timeout(&at, HANDSHAKE_TIMEOUT)?;
        Self::shake_hands(stream, kind)
    }

    /// The handshake, on either side.
    pub(super) fn shake_hands(mut stream: TcpStream, kind: &str) -> io::Result<Self> {
        let end = Instant::now() + HANDSHAKE_TIMEOUT;
        stream.set_nodelay(true)?;
        stream.set_write_timeout(Some(HANDSHAKE_TIMEOUT))?;
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
    pub(super) fn send(&mut self, frames: &[&[u8]]) -> io::Result<()> {
        self.stream.write_all(&message(frames))
    }

    /// Waits for the next message, and answers heartbeats meanwhile. After an error, including a time-out, the
    /// connection is unusable.
    pub(super) fn receive(&mut self, timeout: Duration) -> io::Result<Vec<Vec<u8>>> {
        let end = Instant::now() + timeout;
        let mut frames = Vec::new();
        loop {
            let (flags, body) = self.frame(end)?;
            if flags & COMMAND != 0 {
                // PING: its name, a time to live of two bytes, a context that comes back.
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

/// A message as bytes.
pub(super) fn message(frames: &[&[u8]]) -> Vec<u8> {
    let mut bytes = Vec::new();
    for (i, frame) in frames.iter().enumerate() {
        let more = if i + 1 < frames.len() { MORE } else { 0 };
        bytes.extend(frame_head(more, frame.len()));
        bytes.extend(*frame);
    }
    bytes
}

/// A subscription to a topic as a command of ZMTP 3.1.
pub(super) fn subscription(topic: &[u8]) -> Vec<u8> {
    let body = [b"\x09SUBSCRIBE", topic].concat();
    [frame_head(COMMAND, body.len()), body].concat()
}

/// The header of a frame.
pub(super) fn frame_head(flags: u8, length: usize) -> Vec<u8> {
    match u8::try_from(length) {
        Ok(length) => vec![flags, length],
        Err(_) => [vec![flags | LONG], (length as u64).to_be_bytes().to_vec()].concat(),
    }
}

/// Signature, version 3.1, mechanism NULL.
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
        let at = listener.local_addr().unwrap();
        let long = vec![7; 300_000];
        std::thread::scope(|scope| {
            scope.spawn(|| {
                let (stream, _) = listener.accept().unwrap();
                let mut server = Peer::shake_hands(stream, "ROUTER").unwrap();
                let frames = server.receive(HANDSHAKE_TIMEOUT).unwrap();
                // A heartbeat in between is answered and is not a message.
                let ping = b"\x04PING\0\x0acontext";
                server.stream.write_all(&frame_head(COMMAND, ping.len())).unwrap();
                server.stream.write_all(ping).unwrap();
                server.send(&[b"", &frames[1], b"end"]).unwrap();
                let (flags, pong) = server.frame(Instant::now() + HANDSHAKE_TIMEOUT).unwrap();
                assert_eq!((flags, pong.as_slice()), (COMMAND, b"\x04PONGcontext".as_slice()));
            });
            let mut client = Peer::connect(at, "REQ").unwrap();
            client.send(&[b"", &long]).unwrap();
            let frames = client.receive(HANDSHAKE_TIMEOUT).unwrap();
            assert_eq!(frames, [b"".to_vec(), long.clone(), b"end".to_vec()]);
        });
    }
}
