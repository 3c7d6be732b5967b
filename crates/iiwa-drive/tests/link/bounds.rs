//! Stops are served under load, and all resources are bounded.

use std::{
    io::{ErrorKind, Read, Write},
    net::TcpStream,
    time::{Duration, Instant},
};

use iiwa_link::message::{DriveState, MAX_MESSAGE_BYTES};

use crate::{
    faults::slowly_to,
    rig::{LONG, Rig, wait_for},
};

/// A minimal peer of ZMTP 3.1.
struct Peer(TcpStream);

impl Peer {
    /// It sends nothing.
    fn silent(at: &str) -> Self {
        Self(TcpStream::connect(at.trim_start_matches("tcp://")).unwrap())
    }

    /// It has completed the handshake, without keys.
    fn new(at: &str, kind: &str) -> Self {
        let mut peer = Self::silent(at);
        let mut greeting = [0; 64];
        greeting[0] = 0xff;
        greeting[9] = 0x7f;
        greeting[10] = 3;
        greeting[11] = 1;
        greeting[12..16].copy_from_slice(b"NULL");
        peer.send(&greeting);
        let mut ready = b"\x05READY\x0bSocket-Type".to_vec();
        ready.extend(u32::try_from(kind.len()).unwrap().to_be_bytes());
        ready.extend(kind.as_bytes());
        peer.send(&frame(0x04, &ready));
        // The drive's greeting and READY command.
        let mut answer = [0; 64 + 2];
        peer.0.set_read_timeout(Some(LONG)).unwrap();
        peer.0.read_exact(&mut answer).unwrap();
        let mut rest = vec![0; answer[65].into()];
        peer.0.read_exact(&mut rest).unwrap();
        peer
    }

    fn send(&mut self, bytes: &[u8]) {
        // It may be disconnected.
        let _ = self.0.write_all(bytes);
    }

    /// Whether the other side has closed the connection.
    fn is_closed(&mut self) -> bool {
        self.0.set_read_timeout(Some(Duration::from_millis(1))).unwrap();
        match self.0.read(&mut [0; 1 << 12]) {
            Ok(count) => count == 0,
            Err(error) => !matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut),
        }
    }
}

/// A frame with these flags.
fn frame(flags: u8, body: &[u8]) -> Vec<u8> {
    let mut bytes = head(flags, body.len());
    bytes.extend(body);
    bytes
}

/// The header of a frame.
fn head(flags: u8, length: usize) -> Vec<u8> {
    match u8::try_from(length) {
        Ok(length) => vec![flags, length],
        Err(_) => [&[flags | 0x02][..], &(length as u64).to_be_bytes()].concat(),
    }
}

/// An empty frame, and the header of a request.
fn request(length: usize) -> Vec<u8> {
    [frame(0x01, b""), head(0, length)].concat()
}

/// A motion can be begun, observed and stopped.
fn assert_stops(rig: &Rig) {
    let mut client = rig.client();
    let to = if rig.cabinet().position()[0] < 0.2 { 40.0 } else { 0.0 };
    let running = std::thread::spawn(move || client.run_motions(slowly_to(to), Some(LONG)));
    let mut other = rig.client();
    wait_for("motion", || other.state().unwrap().state == DriveState::RunningMotion);
    rig.client().stop().unwrap();
    let at_rest = rig.cabinet().position();
    let error = running.join().unwrap().unwrap_err();
    assert!(error.to_string().contains("stopped on request"), "{error}");
    assert_eq!(rig.cabinet().position(), at_rest);
}

/// Number of open connections, once no more of them are closed.
fn left(peers: &mut Vec<Peer>) -> usize {
    let mut since = Instant::now();
    while since.elapsed() < Duration::from_millis(500) {
        let before = peers.len();
        peers.retain_mut(|peer| !peer.is_closed());
        if peers.len() < before {
            since = Instant::now();
        }
    }
    peers.len()
}

#[test]
fn silent_connections_are_closed() {
    let rig = Rig::new(5);
    let (requests, stream) = (&rig.drive_config.instructions, &rig.drive_config.stream);
    let cabinet = &rig.cabinet_config.instructions;
    let mut silent: Vec<_> = [requests, stream, cabinet]
        .into_iter()
        .flat_map(|at| (0..150).map(move |_| Peer::silent(at)))
        .collect();
    assert_stops(&rig);
    wait_for("all to be closed", || {
        silent.retain_mut(|peer| !peer.is_closed());
        silent.is_empty()
    });
    assert_stops(&rig);
}

#[test]
fn idle_peers_are_evicted() {
    let rig = Rig::new(5);
    let mut idle: Vec<_> =
        (0..100).map(|_| Peer::new(&rig.drive_config.instructions, "DEALER")).collect();
    assert_stops(&rig);
    let left = left(&mut idle);
    assert!((1..=64).contains(&left), "{left} are left");
}

#[test]
fn long_requests_are_received_one_at_a_time_and_delay_no_stop() {
    let rig = Rig::new(5);
    let at = &rig.drive_config.instructions;
    let mut senders: Vec<_> = (0..12).map(|_| Peer::new(at, "DEALER")).collect();
    for (i, peer) in senders.iter_mut().enumerate() {
        // Some exceed the limit.
        let length = if i % 2 == 0 { 60_000_000 } else { MAX_MESSAGE_BYTES - 1000 };
        peer.send(&request(length));
        peer.0.set_nonblocking(true).unwrap();
        let _ = peer.0.write(&vec![b'['; 10_000_000]);
        peer.0.set_nonblocking(false).unwrap();
    }
    assert_stops(&rig);
    // Those that pause are disconnected, one after the other.
    wait_for("disconnections", || {
        senders.iter_mut().filter_map(|peer| peer.is_closed().then_some(())).count() > 6
    });
    assert_stops(&rig);
}

#[test]
fn subscriptions_are_bounded() {
    let rig = Rig::new(5);
    let mut stream = rig.stream();
    let mut greedy = Peer::new(&rig.drive_config.stream, "SUB");
    for i in 0..1000 {
        greedy.send(&frame(0x04, format!("\x09SUBSCRIBE{i}").as_bytes()));
    }
    wait_for("the end of it", || greedy.is_closed());
    let mut long = Peer::new(&rig.drive_config.stream, "SUB");
    long.send(&head(0x04, 5_000_000));
    wait_for("the end of it", || long.is_closed());
    assert!(stream.next(LONG).unwrap().is_some());
}

#[test]
fn unread_replies_are_bounded() {
    let rig = Rig::new(5);
    rig.client().run_motions(slowly_to(20.0), Some(LONG)).unwrap();
    let mut lazy = Peer::new(&rig.drive_config.instructions, "DEALER");
    let ask = [frame(0x01, b""), frame(0, br#"{"type": "last_run"}"#)].concat();
    // It does not read, so its requests are not read beyond a limit.
    lazy.0.set_nonblocking(true).unwrap();
    let since = Instant::now();
    while lazy.0.write(&ask).is_ok() && since.elapsed() < LONG {}
    assert!(since.elapsed() < LONG);
    assert_stops(&rig);
    lazy.0.set_nonblocking(false).unwrap();
    rig.client().last_run().unwrap_err();
}
