//! A robot program that lies: it contradicts itself thousands of times a second.

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

use super::{
    rig::{Addresses, Fault},
    zmtp::{Peer, message},
};

/// How often the threads look whether they are done.
const AWAKE: Duration = Duration::from_millis(50);

/// As many as the other side takes, a hundred at a time.
const LIES_AT_A_TIME: usize = 100;
const PAUSE: Duration = Duration::from_millis(5);

/// It listens where a cabinet does.
pub(super) struct Liar {
    over: Arc<AtomicBool>,
    lies: Arc<AtomicU64>,
    threads: Vec<JoinHandle<()>>,
}

impl Liar {
    /// Begins to lie to whoever connects.
    pub(super) fn start(at: &Addresses) -> Result<Self, Fault> {
        let [instructions, state] =
            [TcpListener::bind(at.cabinet_instructions)?, TcpListener::bind(at.cabinet_state)?];
        let over = Arc::new(AtomicBool::new(false));
        let lies = Arc::new(AtomicU64::new(0));
        let count = Arc::clone(&lies);
        let threads = vec![
            serve(instructions, Arc::clone(&over), acknowledge),
            serve(state, Arc::clone(&over), move |stream, over| tell_lies(stream, &count, over)),
        ];
        Ok(Self { over, lies, threads })
    }

    /// How many lies were told.
    pub(super) fn lies(&self) -> u64 {
        self.lies.load(Ordering::Relaxed)
    }
}

impl Drop for Liar {
    fn drop(&mut self) {
        self.over.store(true, Ordering::Relaxed);
        for thread in self.threads.drain(..) {
            let _ = thread.join();
        }
    }
}

/// One connection after the other.
fn serve(
    listener: TcpListener,
    over: Arc<AtomicBool>,
    mut take: impl FnMut(TcpStream, &AtomicBool) + Send + 'static,
) -> JoinHandle<()> {
    thread::spawn(move || {
        if listener.set_nonblocking(true).is_err() {
            return;
        }
        while !over.load(Ordering::Relaxed) {
            match listener.accept() {
                Ok((stream, _)) if stream.set_nonblocking(false).is_ok() => take(stream, &over),
                _ => thread::sleep(AWAKE),
            }
        }
    })
}

/// Acknowledges instructions: its own, others, and none.
fn acknowledge(stream: TcpStream, over: &AtomicBool) {
    let mut random = Rng::with_seed(3);
    let Ok(mut peer) = Peer::shake_hands(stream, "REP") else { return };
    while !over.load(Ordering::Relaxed) {
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

/// Tells a state, and another one, and leaves no time in between.
fn tell_lies(stream: TcpStream, count: &AtomicU64, over: &AtomicBool) {
    let mut random = Rng::with_seed(4);
    let Ok(peer) = Peer::shake_hands(stream, "DEALER") else { return };
    let mut stream = peer.stream;
    let Ok(mut replies) = stream.try_clone() else { return };
    // Heartbeats are not answered either: whoever asks will drop the connection and come again.
    let reader = thread::spawn(move || {
        let mut buffer = vec![0; 1 << 16];
        while matches!(replies.read(&mut buffer), Ok(1..)) {}
    });
    while !over.load(Ordering::Relaxed) {
        let lies: Vec<u8> = (0..LIES_AT_A_TIME)
            .flat_map(|_| message(&[b"", lie(&mut random).to_string().as_bytes()]))
            .collect();
        if stream.write_all(&lies).is_err() {
            break;
        }
        count.fetch_add(LIES_AT_A_TIME as u64, Ordering::Relaxed);
        thread::sleep(PAUSE);
    }
    let _ = stream.shutdown(std::net::Shutdown::Both);
    let _ = reader.join();
}

fn lie(random: &mut Rng) -> Value {
    if random.u8(..20) == 0 {
        // Not even a lie.
        return json!({ "state": random.u64(..) });
    }
    let states = ["idle", "running_motion", "running_trajectory"];
    let mut lie = json!({ "boot": random.u64(..), "state": states[random.usize(..3)] });
    if random.bool() {
        lie["run"] = json!(random.u64(..));
    }
    if random.bool() {
        lie["outcome"] = json!({
            "run": random.u64(..), "start_s": random.f64() * 1e6, "end_s": -random.f64() * 1e6,
            "error": refusal(random),
        });
    }
    lie
}

fn refusal(random: &mut Rng) -> Value {
    json!({ "code": "robot", "message": "lie ".repeat(random.usize(1..100)) })
}
