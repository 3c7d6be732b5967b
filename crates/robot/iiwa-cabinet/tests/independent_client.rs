//! The simulated cabinet with an FRI client that shares no code with this crate, in real time: the
//! script `tests/fri/client.py` of the workspace. It requires a Python with the packages of
//! `tests/requirements.txt`, at the path in `IIWASIM_PYTHON`; otherwise this test is skipped.

#![expect(
    clippy::unwrap_used,
    clippy::print_stderr,
    reason = "a failed test panics, and a skipped one is reported"
)]

use std::{
    env,
    io::{BufRead, BufReader},
    path::Path,
    process::{Child, ChildStdout, Command, Stdio},
    sync::mpsc::{self, Receiver},
    thread,
    time::{Duration, Instant},
};

use iiwa_cabinet::{Cabinet, CabinetConfig};
use iiwa_link::Server;
use iiwasim_tests::socket::{Socket, SocketType};
use serde_json::{Value, json};

/// Time-out of all waits.
const LONG: Duration = Duration::from_secs(20);

/// The script. Dropping this value ends it.
struct Script {
    child: Child,
    lines: Receiver<Value>,
}

impl Script {
    /// Starts the script; `None` if Python is not available for it.
    fn start() -> Option<Self> {
        let Some(python) = env::var_os("IIWASIM_PYTHON") else {
            eprintln!("skipped: IIWASIM_PYTHON names no Python for client.py");
            return None;
        };
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../tests/fri/client.py");
        let mut child = Command::new(python)
            .arg("-B")
            .arg(path)
            .args(["--bind", "127.0.0.1:0", "--command", "--seconds", "60"])
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let lines = read_lines(child.stdout.take().unwrap());
        Some(Self { child, lines })
    }

    fn line(&self) -> Value {
        self.lines.recv_timeout(LONG).unwrap()
    }

    /// Waits for the next session state and compares it.
    fn expect(&self, session: &str) {
        assert_eq!(self.line()["session"], session);
    }
}

impl Drop for Script {
    fn drop(&mut self) {
        // The script may have ended.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn read_lines(stdout: ChildStdout) -> Receiver<Value> {
    let (sender, lines) = mpsc::channel();
    thread::spawn(move || {
        for line in BufReader::new(stdout).lines() {
            // The receiver may be dropped.
            let _ = sender.send(serde_json::from_str(&line.unwrap()).unwrap());
        }
    });
    lines
}

/// Speed of the controller clock, as a multiple of real time.
const SPEED: f64 = 0.5;

/// Returns the script's offset of joint 1, in rad, after a time of commanding, in s.
fn offset_rad(t_s: f64) -> f64 {
    let share = (t_s / 2.0).min(1.0);
    0.02 * share * share * (3.0 - 2.0 * share) * (0.5 * std::f64::consts::PI * t_s).sin()
}

/// Returns the maximum, the minimum, and the time between them in s.
fn extremes(trace: &[(f64, f64)]) -> (f64, f64, f64) {
    let by_position = |a: &&(f64, f64), b: &&(f64, f64)| a.1.total_cmp(&b.1);
    let (high_s, high) = trace.iter().max_by(by_position).unwrap();
    let (low_s, low) = trace.iter().min_by(by_position).unwrap();
    (*high, *low, low_s - high_s)
}

/// Cross-validated against a client that was written without this crate: the session passes all
/// states, and the robot follows the client's set-points.
#[test]
fn an_independent_client_moves_the_arm() {
    let Some(mut script) = Script::start() else { return };
    let mut config = CabinetConfig::default();
    config.fri_client = script.line()["bound"].as_str().unwrap().parse().unwrap();
    // One cycle every 20 ms: a script has no real-time priority.
    config.period_ms = 10;
    config.speed = SPEED;
    config.instructions = "tcp://127.0.0.1:*".into();
    config.state = "tcp://127.0.0.1:*".into();
    let cabinet = Cabinet::start(config, &Server::open()).unwrap();
    let program = Socket::connect(SocketType::Req, cabinet.instructions()).unwrap();
    let instruct = |seq: u64, name: &str| {
        let instruction = json!({ "seq": seq, "type": name, "run": 7 });
        program.send(&[instruction.to_string()]).unwrap();
        let [answer] = program.receive(LONG).unwrap().try_into().unwrap();
        let answer: Value = serde_json::from_slice(&answer).unwrap();
        assert_eq!(answer, json!({ "seq": seq }));
    };

    script.expect("monitoring_wait");
    script.expect("monitoring_ready");
    assert_eq!(cabinet.position(), [0.0; 7]);
    instruct(1, "run_trajectory");
    script.expect("commanding_wait");
    script.expect("commanding_active");
    let begin = Instant::now();
    let mut trace = Vec::new();
    while begin.elapsed() < Duration::from_secs(4).div_f64(SPEED) {
        let position = cabinet.position();
        assert_eq!(position[1..], [0.0; 6]);
        trace.push((begin.elapsed().as_secs_f64() * SPEED, position[0]));
        thread::sleep(Duration::from_millis(2));
    }
    let (high, low, between_s) = extremes(&trace);
    let expected: Vec<_> =
        (0..4000).map(|i| f64::from(i) * 1e-3).map(|t| (t, offset_rad(t))).collect();
    let (expected_high, expected_low, expected_s) = extremes(&expected);
    println!(
        "{high} rad, {low} rad, {between_s} s; {expected_high} rad, {expected_low} rad, \
         {expected_s} s"
    );
    assert!((high - expected_high).abs() < 1e-4 && (low - expected_low).abs() < 1e-4);
    // The controller clock waits when this machine is busy.
    assert!((between_s - expected_s).abs() < 0.3);

    instruct(2, "end_trajectory");
    script.expect("monitoring_ready");
    cabinet.drop_session(0.2);
    script.expect("idle");
    script.expect("monitoring_wait");
    script.expect("monitoring_ready");

    let id = script.child.id().to_string();
    assert!(Command::new("kill").args(["-s", "TERM", &id]).status().unwrap().success());
    let figures = script.line();
    assert!(script.child.wait().unwrap().success());
    let report = cabinet.report();
    println!("{figures}");
    assert_eq!((&figures["invalid"], figures["states"].as_array().unwrap().len()), (&json!(0), 8));
    // From a set-point to the measurement two cycles later, at 0.03 rad/s.
    assert!(figures["largest_difference_rad"].as_f64().unwrap() < 1e-3);
    assert!(figures["messages"].as_u64().unwrap() > 450 && report.cycles > 450);
}
