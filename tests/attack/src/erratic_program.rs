//! Erratic robot program: it sends contradictory states thousands of times per second.

use std::{
    io::{Read, Write},
    net::{TcpListener, TcpStream},
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
    thread::{self, JoinHandle},
    time::Duration,
};

use fastrand::Rng;
use serde_json::{Value, json};

use super::rig::{Addresses, Fault};
use iiwasim_tests::zmtp::{HANDSHAKE_TIMEOUT, Peer, message};

/// Interval of the shutdown check.
const POLL_INTERVAL: Duration = Duration::from_millis(50);

/// States per batch: as many as the other side receives.
const BATCH: usize = 100;
const PAUSE: Duration = Duration::from_millis(5);

/// Erratic program that listens at the addresses of a cabinet.
pub(super) struct ErraticProgram {
    shutdown: Arc<AtomicBool>,
    states: Arc<AtomicU64>,
    threads: Vec<JoinHandle<()>>,
}

impl ErraticProgram {
    /// Starts sending states to all connections.
    pub(super) fn start(addresses: &Addresses) -> Result<Self, Fault> {
        let [instructions, state] = [
            TcpListener::bind(addresses.cabinet_instructions)?,
            TcpListener::bind(addresses.cabinet_state)?,
        ];
        let shutdown = Arc::new(AtomicBool::new(false));
        let states = Arc::new(AtomicU64::new(0));
        let count = Arc::clone(&states);
        let threads = vec![
            serve(instructions, Arc::clone(&shutdown), acknowledge),
            serve(state, Arc::clone(&shutdown), move |stream, shutdown| {
                send_states(stream, &count, shutdown);
            }),
        ];
        Ok(Self { shutdown, states, threads })
    }

    /// Number of states sent.
    pub(super) fn states(&self) -> u64 {
        self.states.load(Ordering::Relaxed)
    }
}

impl Drop for ErraticProgram {
    fn drop(&mut self) {
        self.shutdown.store(true, Ordering::Relaxed);
        for thread in self.threads.drain(..) {
            let _ = thread.join();
        }
    }
}

/// Serves one connection after the other.
fn serve(
    listener: TcpListener,
    shutdown: Arc<AtomicBool>,
    mut take: impl FnMut(TcpStream, &AtomicBool) + Send + 'static,
) -> JoinHandle<()> {
    thread::spawn(move || {
        if listener.set_nonblocking(true).is_err() {
            return;
        }
        while !shutdown.load(Ordering::Relaxed) {
            match listener.accept() {
                Ok((stream, _)) if stream.set_nonblocking(false).is_ok() => take(stream, &shutdown),
                _ => thread::sleep(POLL_INTERVAL),
            }
        }
    })
}

/// Acknowledges instructions with right, wrong and missing numbers.
fn acknowledge(stream: TcpStream, shutdown: &AtomicBool) {
    let mut random = Rng::with_seed(3);
    let Ok(mut peer) = Peer::shake_hands(stream, "REP", HANDSHAKE_TIMEOUT) else { return };
    while !shutdown.load(Ordering::Relaxed) {
        let Ok(frames) = peer.receive(Duration::from_secs(1)) else { return };
        let body = frames.last().map(Vec::as_slice).unwrap_or_default();
        let instruction: Value = serde_json::from_slice(body).unwrap_or_default();
        let answer = match random.u8(..4) {
            0 => json!({ "seq": instruction["seq"] }),
            1 => json!({ "seq": instruction["seq"], "error": refusal(&mut random) }),
            2 => json!({ "seq": random.u64(..) }),
            _ => json!({ "seq": null, "value": "x" }),
        };
        if peer.send(&[b"", answer.to_string().as_bytes()]).is_err() {
            return;
        }
    }
}

/// Sends random states without pause.
fn send_states(stream: TcpStream, count: &AtomicU64, shutdown: &AtomicBool) {
    let mut random = Rng::with_seed(4);
    let Ok(peer) = Peer::shake_hands(stream, "DEALER", HANDSHAKE_TIMEOUT) else { return };
    let mut stream = peer.stream;
    let Ok(mut replies) = stream.try_clone() else { return };
    // Heartbeats are not answered either: the drive will reconnect.
    let reader = thread::spawn(move || {
        let mut buffer = vec![0; 1 << 16];
        while matches!(replies.read(&mut buffer), Ok(1..)) {}
    });
    while !shutdown.load(Ordering::Relaxed) {
        let batch: Vec<u8> = (0..BATCH)
            .flat_map(|_| message(&[b"", random_state(&mut random).to_string().as_bytes()]))
            .collect();
        if stream.write_all(&batch).is_err() {
            break;
        }
        count.fetch_add(BATCH as u64, Ordering::Relaxed);
        thread::sleep(PAUSE);
    }
    let _ = stream.shutdown(std::net::Shutdown::Both);
    let _ = reader.join();
}

fn random_state(random: &mut Rng) -> Value {
    if random.u8(..20) == 0 {
        // A malformed state.
        return json!({ "state": random.u64(..) });
    }
    let states = ["idle", "running_motion", "running_trajectory"];
    let mut state = json!({ "boot": random.u64(..), "state": states[random.usize(..3)] });
    if random.bool() {
        state["run"] = json!(random.u64(..));
    }
    if random.bool() {
        state["outcome"] = json!({
            "run": random.u64(..), "start_s": random.f64() * 1e6, "end_s": -random.f64() * 1e6,
            "error": refusal(random),
        });
    }
    state
}

fn refusal(random: &mut Rng) -> Value {
    json!({ "code": "robot", "message": "error ".repeat(random.usize(1..100)) })
}
