//! Many other connections: a new connection is accepted, and its stop is answered.

use std::{
    io::{ErrorKind, Read, Write},
    net::{Ipv4Addr, SocketAddr, TcpListener, TcpStream},
    sync::atomic::{AtomicBool, Ordering},
    thread,
    time::{Duration, Instant},
};

use bytes::Bytes;
use iiwa_drive::Drive;
use iiwa_link::{
    Client, Published, Remote, Server,
    message::{DriveState, Request},
    security::{AllowList, ClientSecurity, KeyPair, ServerSecurity},
    socket::Dial,
};
use iiwa_program::{Motion, Ptp};
use iiwasim_tests::zmtp::{MORE, Peer, frame_head, message, subscription};

use crate::{
    link::rig::{LONG, Rig, wait_for},
    security_sockets::drive,
};

/// Number of connections, more than a socket accepts.
const CROWD: usize = 66;

const STATE: &[u8] = br#"{"type": "state"}"#;

fn address(at: &str) -> SocketAddr {
    at.trim_start_matches("tcp://").parse().unwrap()
}

/// Starts a drive without a robot, for clients with keys; returns the drive, its key pair, and the
/// key pairs of two clients.
fn keyed_drive() -> (Drive, KeyPair, [KeyPair; 2]) {
    let pair = || KeyPair::generate().unwrap();
    let (server, clients) = (pair(), [pair(), pair()]);
    let names = ["alice", "bob"].map(str::to_owned);
    let allowed: AllowList = names.into_iter().zip(clients.iter().map(KeyPair::public)).collect();
    let security = Server::with_keys(ServerSecurity::new(server.clone(), allowed));
    (drive(&security), server, clients)
}

/// Keeps as many requests pending as the drive accepts, until the connection is lost or the test
/// has ended.
fn pipeline(mut peer: Peer, over: &AtomicBool) {
    let requests = message(&[b"", STATE]).repeat(8);
    peer.stream.set_read_timeout(Some(Duration::from_millis(20))).unwrap();
    peer.stream.set_write_timeout(Some(Duration::from_millis(20))).unwrap();
    while !over.load(Ordering::Relaxed) {
        // A time-out does not matter, as long as requests are pending.
        let _ = peer.stream.write(&requests);
        if matches!(peer.stream.read(&mut [0; 1 << 14]), Ok(0)) {
            return;
        }
    }
}

/// Guard that ends the threads of a test, even if the test fails.
struct Over<'a>(&'a AtomicBool);

impl Drop for Over<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

#[test]
fn pipelines_take_neither_stops_nor_runs() {
    let rig = Rig::new(5);
    let address = address(&rig.drive_config.instructions);
    let over = AtomicBool::new(false);
    thread::scope(|scope| {
        let _over = Over(&over);
        let mut client = rig.client();
        let mut target = [0.0; 7];
        target[0] = 1.0;
        // The motion takes half a minute, so that it does not end before the stop.
        let motion = Motion::Ptp(Ptp::to(target).velocity(0.02));
        let running = scope.spawn(move || client.run_motions(vec![motion], Some(LONG)));
        let mut other = rig.client();
        wait_for("motion", || other.state().unwrap().state == DriveState::RunningMotion);
        drop(other);
        for _ in 0..CROWD {
            let peer = Peer::connect(address, "DEALER", LONG).unwrap();
            let over = &over;
            scope.spawn(move || pipeline(peer, over));
        }
        for _ in 0..10 {
            rig.stop();
        }
        // The client of the run has kept its connection.
        let error = running.join().unwrap().unwrap_err();
        assert!(error.to_string().contains("stopped on request"), "{error}");
    });
}

#[test]
fn pipelines_of_one_key_take_no_stop_of_another() {
    let (drive, server, [alice, bob]) = keyed_drive();
    let remote =
        |pair: &KeyPair| Remote::with_keys(ClientSecurity::new(pair.clone(), server.public()));
    let request = || vec![Bytes::new(), Bytes::from_static(STATE)];
    let over = AtomicBool::new(false);
    let pipelines: Vec<_> = (0..CROWD)
        .map(|_| {
            // Each reply is followed by a further request.
            let next = move |_| Some(request());
            remote(&bob).dial("bob", Dial::Dealer, drive.instructions(), next).unwrap()
        })
        .collect();
    thread::scope(|scope| {
        let _over = Over(&over);
        scope.spawn(|| {
            while !over.load(Ordering::Relaxed) {
                // Connected clients have more and more requests in transit.
                for dialer in &pipelines {
                    (0..8).for_each(|_| dialer.send(request()));
                }
                thread::sleep(Duration::from_millis(100));
            }
        });
        for _ in 0..10 {
            let client = |pair| Client::new(&remote(pair), drive.instructions()).unwrap();
            // At the first attempt, however long a loaded machine takes for it.
            let reply = client(&alice).reply(&Request::State, Some(LONG));
            reply.expect("another key is served");
            // A new connection with the crowd's own key may be evicted for the next connection of
            // the crowd.
            let served = (0..100).any(|_| client(&bob).state().is_ok());
            assert!(served, "the crowd's key is never served");
            thread::sleep(Duration::from_millis(50));
        }
    });
}

#[test]
fn a_long_request_that_trickles_blocks_no_other() {
    let rig = Rig::new(5);
    let address = address(&rig.drive_config.instructions);
    let over = AtomicBool::new(false);
    let mut slow = Peer::connect(address, "DEALER", LONG).unwrap();
    let head = [frame_head(MORE, 0), frame_head(0, 1_000_000), vec![b'['; 1000]].concat();
    slow.stream.write_all(&head).unwrap();
    thread::scope(|scope| {
        let _over = Over(&over);
        scope.spawn(|| {
            // Each byte is in time, but the whole request would take a day.
            while !over.load(Ordering::Relaxed) && slow.stream.write_all(b"[").is_ok() {
                thread::sleep(Duration::from_millis(100));
            }
        });
        let mut other = Peer::connect(address, "DEALER", LONG).unwrap();
        let long = [b"[".repeat(100_000), b"]".repeat(100_000)].concat();
        other.send(&[b"", &long]).unwrap();
        let reply = other.receive(LONG).unwrap();
        assert!(String::from_utf8_lossy(&reply[1]).contains("bad_request"));
    });
}

#[test]
fn handshakes_with_less_progress_are_evicted_first() {
    let rig = Rig::new(5);
    let address = address(&rig.drive_config.instructions);
    let mut greeting = [0; 64];
    greeting[0] = 0xff;
    greeting[9..12].copy_from_slice(&[0x7f, 3, 1]);
    greeting[12..16].copy_from_slice(b"NULL");
    let open = |bytes: &[u8]| {
        let mut stream = TcpStream::connect(address).unwrap();
        stream.set_read_timeout(Some(LONG)).unwrap();
        stream.write_all(bytes).unwrap();
        stream
    };
    // Returns true if a connection with a complete greeting outlives more silent connections and
    // partial greetings than the socket has slots.
    let outlives = || {
        let mut newcomer = open(&greeting);
        // The command after the drive's greeting is the answer to the whole greeting.
        let mut answer = [0; 66];
        newcomer.read_exact(&mut answer).unwrap();
        newcomer.read_exact(&mut vec![0; usize::from(answer[65])]).unwrap();
        let others: Vec<_> = (0..3 * CROWD)
            .map(|i| {
                let mut stream = open(if i % 3 == 0 { b"" } else { b"\xff" });
                // The drive's greeting has arrived, or the connection has ended.
                if i % 3 > 0 {
                    let _ = stream.read(&mut [0; 1]);
                }
                stream
            })
            .collect();
        rig.stop();
        newcomer.set_nonblocking(true).unwrap();
        drop(others);
        newcomer.read(&mut [0; 100]).map_err(|error| error.kind()) == Err(ErrorKind::WouldBlock)
    };
    // On a busy machine, these steps may exceed the handshake time-out.
    wait_for("end of the others' evictions", || {
        let since = Instant::now();
        let outlives = outlives();
        assert!(outlives || since.elapsed() > Duration::from_secs(1), "the newcomer was evicted");
        outlives
    });
}

#[test]
fn subscribers_take_no_stream() {
    let rig = Rig::new(5);
    let address = address(&rig.drive_config.stream);
    let crowd: Vec<_> = (0..CROWD)
        .map(|_| {
            let mut peer = Peer::connect(address, "SUB", LONG).unwrap();
            peer.stream.write_all(&subscription(b"state")).unwrap();
            peer
        })
        .collect();
    let mut stream = rig.stream();
    wait_for("joints", || {
        matches!(stream.next(Duration::from_millis(100)), Ok(Some(Published::Joints { .. })))
    });
    drop(crowd);
}

#[test]
fn a_stop_is_repeated_after_lost_connections() {
    let drive = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
    let address = format!("tcp://{}", drive.local_addr().unwrap());
    thread::scope(|scope| {
        scope.spawn(|| {
            // More closed handshakes than are taken as a refusal for other requests.
            for _ in 0..6 {
                drop(drive.accept().unwrap());
            }
            // Requests without a reply.
            for _ in 0..3 {
                let mut peer =
                    Peer::shake_hands(drive.accept().unwrap().0, "ROUTER", LONG).unwrap();
                peer.receive(LONG).unwrap();
            }
            let mut peer = Peer::shake_hands(drive.accept().unwrap().0, "ROUTER", LONG).unwrap();
            peer.receive(LONG).unwrap();
            peer.send(&[b"", br#"{"ok": true}"#]).unwrap();
        });
        Client::new(&Remote::open(), &address).unwrap().stop().unwrap();
    });
}
