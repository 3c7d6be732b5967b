//! The robot program in Java, in front of a simulated cabinet: conformance suite, keys, cycle
//! times. These tests are skipped unless the environment names the program.

use std::{
    ffi::OsString,
    path::{Path, PathBuf},
    sync::{
        Arc,
        mpsc::{self, Receiver},
    },
    thread,
    time::Duration,
};

use bytes::Bytes;
use iiwa_cabinet::{Cabinet, CabinetConfig};
use iiwa_link::{
    Remote, Server,
    message::Presence,
    security::{ClientSecurity, KeyPair, PublicKey},
    socket::Dial,
    transport::{Dialer, Frames},
};
use iiwa_program::{MotionList, Program};
use iiwasim_tests::{
    conformance::{self, DrivePeer, Incoming, Report, ZmqPeer},
    fixture,
    ports::free_address,
    program_process::{ProgramPorts, ProgramProcess, jar_or_skip},
    realtime_guard::in_real_time,
};
use tempfile::TempDir;

use crate::link::{
    rig::{LONG, Rig, free_tcp},
    runs::{sampled, to_command_from},
};

/// Features of the program without a drive.
const HAS: [&str; 6] = ["motion", "kinematics", "no_fri", "io", "temperatures", "times"];

/// A simulated cabinet with the program in front of it; the program ends first.
struct InFront {
    _program: ProgramProcess,
    ports: ProgramPorts,
    cabinet: Cabinet,
}

/// Starts a simulated cabinet on free ports; returns it with the ports of a program in front of it.
fn cabinet_behind(fri: std::net::SocketAddr) -> (Cabinet, ProgramPorts) {
    let mut config = CabinetConfig::default();
    config.fri_client = fri;
    config.instructions = free_tcp();
    config.state = free_tcp();
    let cabinet = Cabinet::start(config, &Server::open()).unwrap();
    let ports = ProgramPorts {
        instructions: free_tcp(),
        state: free_tcp(),
        cabinet_instructions: cabinet.instructions().to_owned(),
        cabinet_state: cabinet.state().to_owned(),
    };
    (cabinet, ports)
}

fn in_front(jar: &PathBuf, options: &[OsString]) -> InFront {
    let (cabinet, ports) = cabinet_behind(free_address());
    let program = ProgramProcess::start(jar, &ports, options);
    InFront { _program: program, ports, cabinet }
}

fn assert_conforms(report: &Report, fewest: usize) {
    println!("{report}");
    assert!(report.failed.is_empty() && report.passed >= fewest);
}

/// Returns true for files of well-formed instructions. Malformed ones are refused before keys or
/// times matter; they are sent once, without either.
fn well_formed(file: &str) -> bool {
    file != "bad_input.jsonl"
}

#[test]
fn the_program_in_java_conforms() {
    let Some(jar) = jar_or_skip() else { return };
    let connect =
        |program: &InFront| ZmqPeer::connect(&program.ports.instructions, &program.ports.state);
    assert_conforms(&conformance::run(&HAS, well_formed, || in_front(&jar, &[]), connect), 200);
}

#[test]
fn malformed_instructions_move_nothing() {
    let Some(jar) = jar_or_skip() else { return };
    let program = Arc::new(in_front(&jar, &[]));
    let connect = |program: &Arc<InFront>| {
        ZmqPeer::connect(&program.ports.instructions, &program.ports.state)
    };
    let malformed = |file: &str| !well_formed(file);
    assert_conforms(&conformance::run(&HAS, malformed, || Arc::clone(&program), connect), 1700);
    assert_eq!(program.cabinet.position(), [0.0; 7]);
}

#[test]
fn the_program_in_java_conforms_without_times() {
    let Some(jar) = jar_or_skip() else { return };
    let connect =
        |program: &InFront| ZmqPeer::connect(&program.ports.instructions, &program.ports.state);
    let has = &HAS[..4];
    let start = || in_front(&jar, &["--without-times".into()]);
    assert_conforms(&conformance::run(has, well_formed, start, connect), 200);
}

#[test]
fn the_program_in_java_conforms_with_keys() {
    let Some(jar) = jar_or_skip() else { return };
    let keys = Keys::new();
    let connect = |program: &InFront| DialedPeer::connect(&keys.remote(), &program.ports);
    let start = || in_front(&jar, &keys.options());
    assert_conforms(&conformance::run(&HAS, well_formed, start, connect), 200);
}

/// Keys of the program, of a drive that may connect, and of a drive that may not.
struct Keys {
    folder: TempDir,
    program: KeyPair,
    drive: KeyPair,
    mallory: KeyPair,
}

impl Keys {
    fn new() -> Self {
        let pair = || KeyPair::generate().unwrap();
        let keys = Self {
            folder: tempfile::tempdir().unwrap(),
            program: pair(),
            drive: pair(),
            mallory: pair(),
        };
        let allowed = keys.folder.path().join("drives");
        std::fs::create_dir(&allowed).unwrap();
        keys.program.write(keys.folder.path(), "cabinet").unwrap();
        let (secret, _) = keys.drive.write(&allowed, "drive").unwrap();
        // The program does not have the drive's secret key.
        std::fs::remove_file(secret).unwrap();
        keys
    }

    /// Returns the program options that admit the drives of a folder.
    fn options(&self) -> Vec<OsString> {
        self.options_for(&self.folder.path().join("drives"))
    }

    /// Returns the program options with a file or folder of drives.
    fn options_for(&self, allowed: &Path) -> Vec<OsString> {
        let key = self.folder.path().join("cabinet.key");
        ["--key".into(), key.into(), "--allow".into(), allowed.as_os_str().to_owned()].into()
    }

    fn remote(&self) -> Remote {
        Self::remote_of(&self.drive, self.program.public())
    }

    fn remote_of(pair: &KeyPair, server: PublicKey) -> Remote {
        Remote::with_keys(ClientSecurity::new(pair.clone(), server))
    }
}

/// Connections with keys.
struct DialedPeer {
    instructions: Dialer,
    state: Dialer,
    incoming: Receiver<Incoming>,
}

impl DialedPeer {
    fn connect(remote: &Remote, ports: &ProgramPorts) -> Self {
        let (sender, incoming) = mpsc::channel();
        let dial = |kind, address: &str, convert: fn(Vec<Vec<u8>>) -> Incoming| {
            let sender = sender.clone();
            let take = move |frames: Frames| {
                // The receiver may be dropped.
                let _ = sender.send(convert(frames.iter().map(|frame| frame.to_vec()).collect()));
                None
            };
            remote.dial("conformance", kind, address, take).unwrap()
        };
        let instructions = dial(Dial::Dealer, &ports.instructions, Incoming::Answer);
        let state = dial(Dial::Rep, &ports.state, Incoming::State);
        let mut peer = Self { instructions, state, incoming };
        // While a dialer is not connected, it keeps only the latest message.
        peer.instruct(vec![Vec::new(), br#"{"seq": 0, "type": "stop"}"#.to_vec()]);
        let answered = |peer: &mut Self| match peer.next(LONG) {
            Some(Incoming::Answer(_)) => true,
            Some(Incoming::State(frames)) => {
                peer.acknowledge(vec![frames[0].clone(), b"{}".to_vec()]);
                false
            }
            None => panic!("no answer within {LONG:?}"),
        };
        while !answered(&mut peer) {}
        peer
    }
}

fn frames(frames: Vec<Vec<u8>>) -> Frames {
    frames.into_iter().map(Bytes::from).collect()
}

impl DrivePeer for DialedPeer {
    fn instruct(&mut self, message: Vec<Vec<u8>>) {
        self.instructions.send(frames(message));
    }

    fn acknowledge(&mut self, message: Vec<Vec<u8>>) {
        self.state.send(frames(message));
    }

    fn next(&mut self, timeout: Duration) -> Option<Incoming> {
        self.incoming.recv_timeout(timeout).ok()
    }
}

/// Starts a drive and the program with the given keys.
fn rig_with(remote: Remote, options: Vec<OsString>) -> Rig {
    let mut rig = Rig::parts(5);
    rig.remote = remote;
    rig.program_options = options;
    rig.start_drive();
    rig.start_cabinet();
    rig
}

#[test]
fn a_drive_with_the_right_keys_is_connected() {
    if jar_or_skip().is_none() {
        return;
    }
    let keys = Keys::new();
    let file = keys.folder.path().join("drives").join("drive.pub");
    for options in [keys.options(), keys.options_for(&file)] {
        let rig = rig_with(keys.remote(), options);
        rig.wait_until_ready();
        rig.client().read_sensors().unwrap();
        rig.client().run_motions(crate::link::faults::slowly_to(5.0), Some(LONG)).unwrap();
    }
}

#[test]
fn a_drive_with_other_keys_gets_nothing() {
    if jar_or_skip().is_none() {
        return;
    }
    let keys = Keys::new();
    let unknown = Keys::remote_of(&keys.mallory, keys.program.public());
    let wrong_server = Keys::remote_of(&keys.drive, keys.mallory.public());
    for (remote, options) in [
        (unknown, keys.options()),
        (wrong_server, keys.options()),
        // Keys on one side only.
        (Remote::open(), keys.options()),
        (keys.remote(), Vec::new()),
    ] {
        let rig = rig_with(remote, options);
        // Longer than several connection attempts, and than the silence after which a program
        // counts as silent.
        thread::sleep(Duration::from_secs(4));
        assert_eq!(rig.client().state().unwrap().robot_program, Presence::Silent);
        assert!(rig.client().read_sensors().is_err());
        let error = rig.client().run_motions(crate::link::faults::slowly_to(5.0), Some(LONG));
        assert!(error.is_err());
        assert_eq!(rig.cabinet().position(), [0.0; 7]);
    }
}

/// Returns the cycle times of the ten motions, as motions and as a trajectory, in s.
fn cycle_times(jar: Option<&PathBuf>) -> [f64; 2] {
    let text = std::fs::read_to_string(fixture("ten-motions.json")).unwrap();
    let program = Program::from_json(&text).unwrap();
    let start_rad = *program.start.joints_rad().unwrap();
    let motions = MotionList::from(program);
    let plan = to_command_from(start_rad, motions.clone());
    let trajectory = sampled(&plan, 0.004);
    let new_rig = || {
        let mut rig = Rig::parts(PERIOD_MS);
        rig.jar = jar.cloned();
        rig.cabinet_config.start_rad = start_rad;
        rig.start_drive();
        rig.start_cabinet();
        rig.wait_until_ready();
        rig
    };
    let as_motions = new_rig().client().run_motions(motions, Some(LONG)).unwrap();
    let as_trajectory = new_rig().client().run_trajectory(trajectory, Some(LONG)).unwrap();
    [as_motions, as_trajectory].map(|run| run.cycle_time_s.unwrap())
}

const PERIOD_MS: u32 = 5;

#[test]
fn ten_motions_take_the_same_time_through_the_program_in_java() {
    let Some(jar) = jar_or_skip() else { return };
    in_real_time(|| {
        let (direct, through) = (cycle_times(None), cycle_times(Some(&jar)));
        println!(
            "motions, trajectory: {through:.3?} s; without the program in Java {direct:.3?} s"
        );
        let period_s = 1e-3 * f64::from(PERIOD_MS);
        for (direct_s, through_s) in direct.into_iter().zip(through) {
            assert!((through_s - direct_s).abs() <= period_s + 1e-6, "{through_s} {direct_s}");
        }
    });
}
