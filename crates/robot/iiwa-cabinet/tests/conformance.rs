//! The simulated robot program passes the conformance suite of robot programs,
//! `sunrise/conformance`.

#![expect(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a failed test panics, figures are printed"
)]

use std::{
    net::{SocketAddr, UdpSocket},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering::Relaxed},
    },
    thread::{self, JoinHandle},
    time::Duration,
};

use iiwa_cabinet::{Cabinet, CabinetConfig};
use iiwa_fri::{FriClient, MAX_DATAGRAM_BYTES};
use iiwa_link::Server;
use iiwasim_tests::{
    conformance::{self, ZmqPeer},
    ports::free_address,
    realtime_guard::in_real_time,
};

const MALFORMED: &str = "bad_input.jsonl";

const ALWAYS: [&str; 5] = ["motion", "kinematics", "io", "temperatures", "times"];

#[test]
fn the_simulated_robot_program_conforms() {
    assert_conforms("no_fri", |file| file != MALFORMED, |_| None);
}

#[test]
fn malformed_instructions_move_nothing() {
    if !conformance::folder().is_dir() {
        println!("skipped: there is no {}", conformance::folder().display());
        return;
    }
    let cabinet = Arc::new(Cabinet::start(config(), &Server::open()).unwrap());
    let connect =
        |cabinet: &Arc<Cabinet>| ZmqPeer::connect(cabinet.instructions(), cabinet.state());
    let is_malformed = |file: &str| file == MALFORMED;
    let report = conformance::run(&ALWAYS, is_malformed, || Arc::clone(&cabinet), connect);
    println!("{report}");
    assert!(report.failed.is_empty() && report.passed > 1700);
    assert_eq!(cabinet.position(), [0.0; 7]);
}

/// Runs the suite with an FRI client. Commanding ends if its answers are late.
#[test]
fn trajectories_with_a_client_of_fri_conform() {
    let with_client = |config: &mut CabinetConfig| {
        let client = HoldingClient::start();
        config.fri_client = client.at;
        config.period_ms = 10;
        Some(client)
    };
    in_real_time(|| {
        assert_conforms("commanding", |file| file == "trajectories.jsonl", with_client);
    });
}

/// Configures a cabinet without an FRI client.
fn config() -> CabinetConfig {
    let mut config = CabinetConfig::default();
    config.instructions = "tcp://127.0.0.1:*".into();
    config.state = "tcp://127.0.0.1:*".into();
    config.fri_client = free_address();
    config
}

fn assert_conforms(
    also_has: &str,
    wanted: impl Fn(&str) -> bool,
    fri: impl Fn(&mut CabinetConfig) -> Option<HoldingClient> + Sync,
) {
    if !conformance::folder().is_dir() {
        println!("skipped: there is no {}", conformance::folder().display());
        return;
    }
    let start = || {
        let mut config = config();
        let client = fri(&mut config);
        (Cabinet::start(config, &Server::open()).unwrap(), client)
    };
    let connect = |(cabinet, _): &(Cabinet, Option<HoldingClient>)| {
        ZmqPeer::connect(cabinet.instructions(), cabinet.state())
    };
    let has = [&ALWAYS[..], &[also_has]].concat();
    let report = conformance::run(&has, wanted, start, connect);
    println!("{report}");
    assert!(report.failed.is_empty() && report.passed > 0);
}

/// An FRI client that holds the robot position.
struct HoldingClient {
    at: SocketAddr,
    over: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl HoldingClient {
    fn start() -> Self {
        let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
        socket.set_read_timeout(Some(Duration::from_millis(20))).unwrap();
        let address = socket.local_addr().unwrap();
        let over = Arc::new(AtomicBool::new(false));
        let ended = Arc::clone(&over);
        let thread = thread::spawn(move || hold(&socket, &ended));
        Self { at: address, over, thread: Some(thread) }
    }
}

fn hold(socket: &UdpSocket, over: &AtomicBool) {
    let (mut client, mut datagram) = (FriClient::default(), [0; MAX_DATAGRAM_BYTES]);
    let mut answer = Vec::new();
    while !over.load(Relaxed) {
        let Ok((length, from)) = socket.recv_from(&mut datagram) else { continue };
        if client.receive(&datagram[..length]).is_err() {
            continue;
        }
        if client.answer(None, &mut answer) {
            // A session survives a lost answer.
            let _ = socket.send_to(&answer, from);
        }
    }
}

impl Drop for HoldingClient {
    fn drop(&mut self) {
        self.over.store(true, Relaxed);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}
