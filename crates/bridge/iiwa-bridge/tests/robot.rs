//! A bridge, a drive and a simulated cabinet in one process: forwarded data and accepted commands.

#![expect(clippy::unwrap_used, reason = "a failed test panics")]

use std::{
    sync::{
        Arc, Mutex,
        mpsc::{Receiver, channel},
    },
    thread,
    time::{Duration, Instant},
};

use iiwa_bridge::{
    Bridge, BridgeOptions, BridgedRobot, Content, Kind, Message, Sink, Timestamp,
    commands::{CommandGate, CommandReply, MAX_COMMAND_BYTES},
    message::{CycleSample, RunPhase},
    replay::{Player, ReplayDrive},
};
use iiwa_cabinet::{Cabinet, CabinetConfig};
use iiwa_drive::{Drive, DriveConfig};
use iiwa_link::{
    Client, ClientError, Remote, Server, Stream,
    message::{DriveState, IoValue, Presence, Request, RunLabel, RunPlan},
};
use iiwa_program::{Motion, Ptp};
use iiwasim_tests::ports::free_address;

const LONG: Duration = Duration::from_mins(1);

struct Rig {
    _cabinet: Cabinet,
    drive: Drive,
}

impl Rig {
    fn new() -> Self {
        let tcp = || format!("tcp://{}", free_address());
        let (fri, instructions, state) = (free_address(), tcp(), tcp());
        let mut config = DriveConfig::default();
        config.instructions = tcp();
        config.stream = tcp();
        config.fri = fri;
        config.cabinet_instructions.clone_from(&instructions);
        config.cabinet_state.clone_from(&state);
        let drive = Drive::start(config, &Server::open(), &Remote::open()).unwrap();
        let mut config = CabinetConfig::default();
        config.fri_client = fri;
        config.instructions = instructions;
        config.state = state;
        let cabinet = Cabinet::start(config, &Server::open()).unwrap();
        let rig = Self { _cabinet: cabinet, drive };
        let mut client = rig.client();
        eventually(|| {
            let status = client.state().unwrap();
            status.robot_program == Presence::Connected
                && status.joints_rad.is_some()
                && status.fri.quality == "excellent"
        });
        rig
    }

    fn client(&self) -> Client {
        Client::new(&Remote::open(), self.drive.instructions()).unwrap()
    }

    fn robot(&self) -> BridgedRobot {
        let (drive, stream) = (self.drive.instructions(), self.drive.stream());
        BridgedRobot::new("cell-1", Remote::open(), drive, stream).unwrap()
    }
}

fn eventually(mut is_true: impl FnMut() -> bool) {
    let since = Instant::now();
    while !is_true() {
        assert!(since.elapsed() < LONG, "it does not come true");
        thread::sleep(Duration::from_millis(20));
    }
}

/// A sink that stores all messages.
#[derive(Default)]
struct Kept(Mutex<Vec<Message>>);

impl Sink for Kept {
    fn take(&self, message: &Message) {
        self.0.lock().unwrap().push(message.clone());
    }
}

impl Kept {
    fn of(&self, kind: Kind) -> Vec<Message> {
        let all = self.0.lock().unwrap();
        all.iter().filter(|message| message.kind() == kind).cloned().collect()
    }
}

fn to(a1_rad: f64) -> Vec<Motion> {
    vec![Motion::Ptp(Ptp::to([a1_rad, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]))]
}

#[test]
fn all_that_a_robot_does_is_passed_on_numbered_and_in_order() {
    let rig = Rig::new();
    let kept = Arc::new(Kept::default());
    let options = BridgeOptions { robots: vec![rig.robot()], ..BridgeOptions::default() };
    let bridge = Bridge::start(&options, vec![kept.clone()]).unwrap();
    eventually(|| {
        let kinds =
            [Kind::Joints, Kind::State, Kind::Io, Kind::Sensors, Kind::Conditions, Kind::Bridge];
        kinds.iter().all(|kind| !kept.of(*kind).is_empty())
    });
    let plan = RunPlan { cycle_time_s: 0.5, limited_by: Vec::new() };
    let label = RunLabel { program: Some("turn".to_owned()), plan: Some(plan), planned_for: None };
    let request = Request::motions(to(0.2)).labelled(label.clone());
    let run = rig.client().run(&request, Some(LONG)).unwrap();
    eventually(|| kept.of(Kind::Run).len() == 2 && kept.of(Kind::State).len() == 3);
    drop(bridge);

    for kind in Kind::ALL {
        let numbers: Vec<_> = kept.of(kind).iter().map(|message| message.seq).collect();
        assert_eq!(numbers, (0..numbers.len() as u64).collect::<Vec<_>>(), "{}", kind.name());
    }
    let runs = kept.of(Kind::Run);
    let [Content::Run(begin), Content::Run(end), ..] =
        &runs.iter().map(|message| message.content.clone()).collect::<Vec<_>>()[..]
    else {
        panic!("{runs:?}")
    };
    assert_eq!((begin.event, end.event), (RunPhase::Begin, RunPhase::End));
    assert_eq!((begin.run, &begin.label), (end.run, &label));
    assert_eq!(end.result.as_ref().unwrap().cycle_time_s, run.cycle_time_s);
    let states = kept.of(Kind::State);
    let state = |message: &Message| match message.content {
        Content::State { state, .. } => state,
        _ => panic!("{message:?}"),
    };
    assert_eq!(
        states.iter().map(state).collect::<Vec<_>>(),
        // The first state is that at the start of the bridge.
        [DriveState::Idle, DriveState::RunningMotion, DriveState::Idle]
    );
    // No sample is missing: the stamps are one cycle of 5 ms apart.
    let stamps: Vec<f64> = kept
        .of(Kind::Joints)
        .iter()
        .map(|message| match message.content {
            Content::Joints(CycleSample { t_s, .. }) => t_s,
            _ => panic!("{message:?}"),
        })
        .collect();
    assert!(stamps.windows(2).all(|pair| (pair[1] - pair[0] - 0.005).abs() < 1e-6));
    let online = kept.of(Kind::Bridge).last().map(|message| message.content.clone());
    assert!(matches!(online, Some(Content::Bridge(status)) if !status.online));
}

/// Sends a command; the receiver returns its reply.
fn send(gate: &CommandGate, topic: Option<&str>, body: &str) -> Receiver<CommandReply> {
    let (sender, receiver) = channel();
    gate.command(topic, body.as_bytes(), Box::new(move |reply| drop(sender.send(reply))));
    receiver
}

fn command(id: &str, time: Timestamp, request: &str) -> String {
    let time = serde_json::to_string(&time).unwrap();
    format!(r#"{{"version":1,"robot":"cell-1","id":"{id}","at":{time},"request":{request}}}"#)
}

fn reply(gate: &CommandGate, body: &str) -> CommandReply {
    send(gate, None, body).recv_timeout(LONG).unwrap()
}

fn ago(seconds: i64) -> Timestamp {
    let micros = i64::try_from(Timestamp::now().micros()).unwrap() - seconds * 1_000_000;
    Timestamp::from_micros(u64::try_from(micros).unwrap())
}

#[test]
fn commands_are_carried_out_once_and_replied_to() {
    let rig = Rig::new();
    let gate = CommandGate::new(&[rig.robot()], true).unwrap();
    let now = Timestamp::now;
    let set = r#"{"type": "set_io", "name": "MediaFlange.LEDBlue", "value": true}"#;
    let result = reply(&gate, &command("a", now(), set));
    assert!(result.is_ok(), "{}", result.to_json());
    assert_eq!(rig.client().get_io("MediaFlange.LEDBlue").unwrap(), IoValue::Boolean(true));
    assert_eq!((result.id.as_deref(), result.robot.as_deref()), (Some("a"), Some("cell-1")));

    let turn = r#"{"type": "run_motions", "motions": [
        {"type": "ptp", "joints_deg": [60, 0, 0, 0, 0, 0, 0], "velocity_rel": 0.2}
    ]}"#;
    let run = send(&gate, None, &command("b", now(), turn));
    let mut client = rig.client();
    eventually(|| client.state().unwrap().state == DriveState::RunningMotion);
    // A second run does not wait for the first one; a stop overtakes the run.
    let second = reply(&gate, &command("c", now(), turn));
    assert!(second.to_json().contains(r#""code":"not_idle""#), "{}", second.to_json());
    assert!(reply(&gate, &command("d", now(), r#"{"type": "stop"}"#)).is_ok());
    let stopped = run.recv_timeout(LONG).unwrap().to_json();
    assert!(stopped.contains(r#""ok":false"#) && !stopped.contains("samples\""), "{stopped}");
    eventually(|| client.state().unwrap().state == DriveState::Idle);
    // The next run is accepted.
    let short = r#"{"type": "run_motions", "motions": [{"type": "wait", "seconds": 0.01}]}"#;
    assert!(reply(&gate, &command("e", now(), short)).is_ok());
    assert_eq!((gate.counts().accepted, gate.counts().refused), (4, 1));
}

#[test]
fn rejected_commands_move_nothing() {
    let rig = Rig::new();
    let gate = CommandGate::new(&[rig.robot()], true).unwrap();
    let before = rig.client().state().unwrap().joints_rad;
    let turn = r#"{"type": "run_motions", "motions": [
        {"type": "ptp", "joints_deg": [60, 0, 0, 0, 0, 0, 0]}
    ]}"#;
    let late = command("late", ago(11), turn);
    let early = command("early", ago(-11), turn);
    let long = command("long", ago(0), &format!("{turn}{}", " ".repeat(MAX_COMMAND_BYTES)));
    let other = command("x", ago(0), turn).replace("cell-1", "cell-2");
    let bad = [
        ("", "at line 1"),
        ("nonsense", "at line 1"),
        ("[1, 2]", "at line 1"),
        ("{}", "`version` has to be 1"),
        (&command("", ago(0), turn), "`id` has to have 1 to 200 bytes"),
        (&command("f", ago(0), "{}"), "in `request`: the request has no `type`"),
        (&command("f", ago(0), r#"{"type": "fly"}"#), "unknown type `fly`"),
        (&command("f", ago(0), r#"{"type": "stop", "id": 1}"#), "`id` belongs to the command"),
        (&command("f", ago(0), turn).replace("\"at\"", "\"when\""), "unknown key `when`"),
        (&other, "`robot` has to be one of: cell-1"),
        (&late, "s ago by the bridge's clock: it is too old"),
        (&early, "s ahead of the bridge's clock"),
        (&long, "at most 4194304 are allowed"),
    ];
    for (body, reason) in &bad {
        let text = reply(&gate, body).to_json();
        let shown = &text[..text.len().min(300)];
        assert!(text.contains(r#""ok":false"#) && text.contains(reason), "{reason}: {shown}");
    }
    // The topic of another robot; a repeated command.
    let state = r#"{"type": "state"}"#;
    let elsewhere = send(&gate, Some("cell-9"), &command("g", ago(0), state));
    assert!(!elsewhere.recv_timeout(LONG).unwrap().is_ok());
    let once = command("h", ago(0), state);
    assert!(reply(&gate, &once).is_ok());
    assert!(reply(&gate, &once).to_json().contains("has been received before"));
    let counts = gate.counts();
    assert_eq!((counts.accepted, counts.refused), (1, bad.len() as u64 + 2));
    let status = rig.client().state().unwrap();
    assert_eq!((status.state, status.joints_rad), (DriveState::Idle, before));
}

#[test]
fn a_bridge_without_permission_refuses_all() {
    let rig = Rig::new();
    let gate = CommandGate::new(&[rig.robot()], false).unwrap();
    for request in [r#"{"type": "stop"}"#, r#"{"type": "state"}"#] {
        let refused = reply(&gate, &command("a", ago(0), request)).to_json();
        assert!(refused.contains("takes no commands"), "{refused}");
    }
    assert_eq!(gate.counts().accepted, 0);
}

#[test]
fn a_replay_is_followed_as_a_drive_and_moves_nothing() {
    let at = |i: u64| Timestamp::from_micros(1_000_000_000 + 5000 * i);
    let message = |seq, content| Message {
        version: 1,
        robot: "cell-1".to_owned(),
        session: 1,
        seq,
        at: at(seq),
        content,
    };
    let drive =
        ReplayDrive::start(&Server::open(), "tcp://127.0.0.1:*", "tcp://127.0.0.1:*").unwrap();
    let mut client = Client::new(&Remote::open(), drive.requests()).unwrap();
    let mut stream = Stream::new(&Remote::open(), drive.stream()).unwrap();
    assert_eq!(client.state().unwrap().joints_rad, None);
    let refused = client.run_motions(to(0.1), Some(LONG)).unwrap_err();
    assert!(matches!(refused, ClientError::Refused { .. }), "{refused}");
    // A subscription takes effect some time after it was sent: messages before are not received.
    let mut warm_up = Player::new(&drive, 100.0);
    let short = Duration::from_millis(20);
    let end = Instant::now() + LONG;
    while stream.next(short).unwrap().is_none() {
        assert!(Instant::now() < end);
        let idle = message(0, Content::State { t_s: 0.0, state: DriveState::Idle });
        assert!(warm_up.play(idle, || false).is_continue());
    }
    while stream.next(short).unwrap().is_some() {}
    let mut player = Player::new(&drive, 100.0);
    let mut next = || stream.next(Duration::from_secs(30)).unwrap();
    for seq in 0..200 {
        let sample = CycleSample {
            t_s: 0.005 * seq as f64,
            joints_rad: [seq as f64 * 1e-3; 7],
            measured_nm: None,
            external_nm: None,
        };
        assert!(player.play(message(seq, Content::Joints(sample)), || false).is_continue());
        // One at a time: a publisher drops messages for subscribers that fall behind.
        assert!(next().is_some(), "sample {seq}");
    }
    let state = Content::State { t_s: 1.0, state: DriveState::RunningMotion };
    assert!(player.play(message(200, state), || false).is_continue());
    assert!(next().is_some());
    let status = client.state().unwrap();
    assert_eq!((status.state, status.joints_rad), (DriveState::RunningMotion, Some([0.199; 7])));
    // The replay ends on request.
    let late = message(1_000_000, Content::State { t_s: 2.0, state: DriveState::Idle });
    assert!(player.play(late, || true).is_break());
}

#[test]
fn names_that_topics_or_folders_cannot_have_are_refused() {
    let named = |name: &str| BridgedRobot::new(name, Remote::open(), "tcp://127.0.0.1:1", "x");
    let long = "x".repeat(65);
    for name in [
        "", ".", "..", "...", "cell.1", "../cell", "a/b", "a\\b", "a b", "a\0", "ä", "+", "#",
        &long,
    ] {
        let error = named(name).unwrap_err().to_string();
        let expected = "use 1 to 64 letters, digits, `-` and `_`";
        assert_eq!(error, format!("invalid robot name `{name}`: {expected}"));
    }
    for name in ["iiwa", "cell-1", "Cell_2", "7", &"x".repeat(64)] {
        assert_eq!(named(name).unwrap().name(), name);
    }
}
