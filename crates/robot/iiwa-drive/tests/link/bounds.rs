//! Stops are served under load, and all resources are bounded.

use std::{
    io::Write,
    net::SocketAddr,
    thread,
    time::{Duration, Instant},
};

use iiwa_link::{
    ClientError,
    message::{DriveState, MAX_MESSAGE_BYTES},
};
use iiwasim_tests::zmtp::{COMMAND, MORE, Peer, frame_head, message, subscription};

use crate::link::{
    faults::slowly_to,
    rig::{LONG, Rig, wait_for},
};

/// Connects a peer that sends nothing.
fn silent(endpoint: &str) -> Peer {
    Peer::silent(address(endpoint), LONG).unwrap()
}

/// Connects a peer that has completed the handshake, without keys.
fn connected(endpoint: &str, kind: &str) -> Peer {
    Peer::connect(address(endpoint), kind, LONG).unwrap()
}

fn address(at: &str) -> SocketAddr {
    at.trim_start_matches("tcp://").parse().unwrap()
}

/// Sends bytes to a drive that may disconnect.
fn send(peer: &mut Peer, bytes: &[u8]) {
    let _ = peer.stream.write_all(bytes);
}

/// Returns an empty frame, and the header of a request.
fn request(length: usize) -> Vec<u8> {
    [frame_head(MORE, 0), frame_head(0, length)].concat()
}

/// Asserts that a motion can be begun, observed and stopped.
fn assert_stops(rig: &Rig) {
    let mut client = rig.client();
    let to = if rig.cabinet().position()[0] < 0.2 { 40.0 } else { 0.0 };
    let running = std::thread::spawn(move || client.run_motions(slowly_to(to), Some(LONG)));
    let mut other = rig.client();
    wait_for("motion", || other.state().unwrap().state == DriveState::RunningMotion);
    rig.stop();
    let at_rest = rig.cabinet().position();
    let error = running.join().unwrap().unwrap_err();
    assert!(error.to_string().contains("stopped on request"), "{error}");
    assert_eq!(rig.cabinet().position(), at_rest);
}

/// Returns the number of open connections, once no more of them are closed.
fn remaining(peers: &mut Vec<Peer>) -> usize {
    let mut since = Instant::now();
    while since.elapsed() < Duration::from_millis(500) {
        let before = peers.len();
        peers.retain_mut(|peer| !peer.is_closed().unwrap());
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
        .flat_map(|address| (0..150).map(move |_| silent(address)))
        .collect();
    assert_stops(&rig);
    wait_for("all to be closed", || {
        silent.retain_mut(|peer| !peer.is_closed().unwrap());
        silent.is_empty()
    });
    assert_stops(&rig);
}

#[test]
fn idle_peers_are_evicted() {
    let rig = Rig::new(5);
    let mut idle: Vec<_> =
        (0..100).map(|_| connected(&rig.drive_config.instructions, "DEALER")).collect();
    assert_stops(&rig);
    let remaining = remaining(&mut idle);
    assert!((1..=64).contains(&remaining), "{remaining} are left");
}

#[test]
fn long_requests_are_received_one_at_a_time_and_delay_no_stop() {
    let rig = Rig::new(5);
    let address = &rig.drive_config.instructions;
    let mut senders: Vec<_> = (0..12).map(|_| connected(address, "DEALER")).collect();
    for (i, peer) in senders.iter_mut().enumerate() {
        // Some requests exceed the limit.
        let length = if i % 2 == 0 { 60_000_000 } else { MAX_MESSAGE_BYTES - 1000 };
        send(peer, &request(length));
        peer.stream.set_nonblocking(true).unwrap();
        let _ = peer.stream.write(&vec![b'['; 10_000_000]);
        peer.stream.set_nonblocking(false).unwrap();
    }
    assert_stops(&rig);
    // Peers that pause are disconnected, one after the other.
    wait_for("disconnections", || {
        senders.iter_mut().filter_map(|peer| peer.is_closed().unwrap().then_some(())).count() > 6
    });
    assert_stops(&rig);
}

#[test]
fn subscriptions_are_bounded() {
    let rig = Rig::new(5);
    let mut stream = rig.stream();
    let mut greedy = connected(&rig.drive_config.stream, "SUB");
    for i in 0..1000 {
        send(&mut greedy, &subscription(i.to_string().as_bytes()));
    }
    wait_for("the end of it", || greedy.is_closed().unwrap());
    let mut long = connected(&rig.drive_config.stream, "SUB");
    send(&mut long, &frame_head(COMMAND, 5_000_000));
    wait_for("the end of it", || long.is_closed().unwrap());
    assert!(stream.next(LONG).unwrap().is_some());
}

#[test]
fn unread_replies_are_bounded() {
    let rig = Rig::new(5);
    rig.client().run_motions(slowly_to(20.0), Some(LONG)).unwrap();
    let mut lazy = connected(&rig.drive_config.instructions, "DEALER");
    let request = message(&[b"", br#"{"type": "last_run"}"#]);
    // The peer does not read, so the drive stops reading its requests at a limit.
    lazy.stream.set_nonblocking(true).unwrap();
    let since = Instant::now();
    let (mut rest, mut last_sent) = (&*request, since);
    // A drive that is merely slow accepts more bytes within a second.
    while last_sent.elapsed() < Duration::from_secs(1) {
        assert!(since.elapsed() < LONG);
        match lazy.stream.write(rest) {
            Ok(bytes) => {
                rest = &rest[bytes..];
                last_sent = Instant::now();
            }
            Err(_) => thread::sleep(Duration::from_millis(5)),
        }
        if rest.is_empty() {
            rest = &request;
        }
    }
    assert_stops(&rig);
    lazy.stream.set_nonblocking(false).unwrap();
    // The reply is the stopped run, or the previous run if the stop preceded the beginning.
    match rig.client().last_run() {
        Ok(_) | Err(ClientError::Refused { .. }) => {}
        Err(error) => panic!("{error}"),
    }
}
