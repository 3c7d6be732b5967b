//! Faults: afterwards the state is correct, the next request works, and the received samples are
//! returned or stored.

use std::{
    io::Write,
    net::TcpStream,
    thread,
    time::{Duration, Instant},
};

use iiwa_cabinet::Faults;
use iiwa_link::{
    ClientError, Remote, Server, TimedJoints,
    message::{Code, DriveState, MAX_SHORT_REQUEST_BYTES, Presence, Refusal, Run},
};
use iiwa_program::{Motion, Ptp};
use iiwasim_tests::{
    realtime_guard::in_real_time,
    socket::{Socket, SocketType},
};

use crate::link::{
    rig::{LONG, Rig, wait_for},
    runs::{planned, sampled, to_command},
};

/// Returns a motion of joint 1 to `deg`, slowly enough for faults: 40 deg take 2 s.
pub(crate) fn slowly_to(deg: f64) -> Vec<Motion> {
    let mut target = [0.0; 7];
    target[0] = deg.to_radians();
    vec![Motion::Ptp(Ptp::to(target).velocity(0.2))]
}

fn trajectory_to(deg: f64) -> TimedJoints {
    sampled(&to_command(slowly_to(deg)), 0.004)
}

/// Waits until the drive is in this state.
fn wait_for_state(rig: &Rig, state: DriveState) {
    let mut client = rig.client();
    wait_for(state.name(), || client.state().is_ok_and(|status| status.state == state));
}

/// Begins a run in the background, and waits until the robot moves.
fn begin(
    rig: &Rig,
    run: impl FnOnce(&mut iiwa_link::Client) -> Result<Run, ClientError> + Send + 'static,
) -> thread::JoinHandle<Result<Run, ClientError>> {
    let mut client = rig.client();
    let before = rig.cabinet().position();
    let running = thread::spawn(move || run(&mut client));
    let moved = || (0..7).any(|j| (rig.cabinet().position()[j] - before[j]).abs() > 0.02);
    wait_for("motion", moved);
    running
}

fn begin_motion(rig: &Rig) -> thread::JoinHandle<Result<Run, ClientError>> {
    begin(rig, |client| client.run_motions(slowly_to(40.0), Some(LONG)))
}

fn begin_trajectory(rig: &Rig) -> thread::JoinHandle<Result<Run, ClientError>> {
    begin(rig, |client| client.run_trajectory(trajectory_to(40.0), Some(LONG)))
}

fn refused(result: Result<Run, ClientError>) -> (Refusal, Run) {
    match result {
        Err(ClientError::Refused { refusal, run: Some(run) }) => (refusal, *run),
        other => panic!("{other:?}"),
    }
}

/// Asserts that both kinds of runs work, from the current position.
fn assert_works(rig: &Rig) {
    let run = (0..20).find_map(|_| {
        rig.wait_until_ready();
        let back = rig.client().run_motions(slowly_to(0.0), Some(LONG)).unwrap();
        assert!(back.cycle_time_s.is_some());
        rig.wait_until_ready();
        match rig.client().run_trajectory(trajectory_to(5.0), Some(LONG)) {
            Ok(run) => Some(run),
            // The machine was suspended for some cycles.
            Err(error) if error.to_string().contains("quality") => None,
            Err(error) => panic!("{error}"),
        }
    });
    assert!(run.unwrap().samples.t_s.len() > 10);
    rig.client().run_motions(slowly_to(0.0), Some(LONG)).unwrap();
    assert_eq!(rig.client().state().unwrap().state, DriveState::Idle);
}

#[test]
fn a_restarted_cabinet_ends_the_run() {
    in_real_time(|| {
        for begin in [begin_motion, begin_trajectory] {
            let mut rig = Rig::new(5);
            let running = begin(&rig);
            rig.cabinet = None;
            rig.start_cabinet();
            let (refusal, run) = refused(running.join().unwrap());
            assert_eq!(refusal.code, Code::Robot);
            assert!(run.samples.t_s.len() > 10);
            assert_works(&rig);
        }
    });
}

#[test]
fn a_lost_cabinet_ends_the_run_and_is_reported() {
    let mut rig = Rig::new(5);
    let running = begin_motion(&rig);
    rig.cabinet = None;
    let (refusal, run) = refused(running.join().unwrap());
    assert_eq!(refusal.code, Code::Robot);
    assert!(run.samples.t_s.len() > 10);

    let status = rig.client().state().unwrap();
    assert_eq!((status.state, status.robot_program), (DriveState::Idle, Presence::Silent));
    assert_eq!((status.fri.session.as_str(), status.fri.quality.as_str()), ("silent", "poor"));
    for begin in [slowly_to(1.0), slowly_to(2.0)] {
        let error = rig.client().run_motions(begin, Some(LONG)).unwrap_err();
        assert_eq!(error.code(), Code::Robot, "{error}");
    }
    let error = rig.client().read_sensors().unwrap_err();
    assert_eq!(error.code(), Code::Timeout, "{error}");
    rig.start_cabinet();
    assert_works(&rig);
}

#[test]
fn a_restarted_drive_finds_the_motion_running() {
    let mut rig = Rig::new(5);
    let running = begin_motion(&rig);
    rig.drive = None;
    assert!(matches!(running.join().unwrap(), Err(ClientError::Lost { .. })));
    rig.start_drive();
    wait_for_state(&rig, DriveState::RunningMotion);
    let error = rig.client().run_motions(slowly_to(0.0), Some(LONG)).unwrap_err();
    assert_eq!(error.code(), Code::NotIdle);
    wait_for_state(&rig, DriveState::Idle);
    assert!((rig.cabinet().position()[0].to_degrees() - 40.0).abs() < 1e-9);
    assert_works(&rig);
}

#[test]
fn a_motion_of_a_lost_drive_can_be_stopped() {
    let mut rig = Rig::new(5);
    let _ = begin_motion(&rig);
    rig.drive = None;
    rig.start_drive();
    wait_for_state(&rig, DriveState::RunningMotion);
    rig.stop();
    wait_for_state(&rig, DriveState::Idle);
    assert!(rig.cabinet().position()[0].to_degrees() < 39.0);
    assert_works(&rig);
}

#[test]
fn a_trajectory_stops_with_its_drive() {
    in_real_time(|| {
        let mut rig = Rig::new(5);
        let running = begin_trajectory(&rig);
        rig.drive = None;
        // The trajectory was stopped on its path before, without braking by the cabinet.
        let before = rig.cabinet().position()[0].to_degrees();
        assert!(matches!(running.join().unwrap(), Err(ClientError::Lost { .. })));
        rig.start_drive();
        rig.wait_until_ready();
        let after = rig.cabinet().position()[0].to_degrees();
        assert!(after < 39.0 && (after - before).abs() < 0.01, "{before} {after}");
        assert_works(&rig);
    });
}

#[test]
fn a_client_that_is_killed_leaves_the_run_and_its_samples() {
    let rig = Rig::new(5);
    let socket = Socket::connect(SocketType::Req, &rig.drive_config.instructions).unwrap();
    let request = iiwa_link::message::Request::motions(slowly_to(20.0));
    socket.send(&[request.to_json()]).unwrap();
    // During planning, the loss of the client would withdraw the motions.
    wait_for("motion", || rig.cabinet().position()[0].abs() > 0.01);
    drop(socket);
    wait_for_state(&rig, DriveState::Idle);
    let run = rig.client().last_run().unwrap();
    assert!(run.samples.t_s.len() > 100);
    let last = run.samples.joints_rad.last().unwrap();
    assert!((last[0].to_degrees() - 20.0).abs() < 1e-6);
    assert_works(&rig);
}

#[test]
fn packet_loss_costs_samples_but_no_motion() {
    in_real_time(|| {
        let rig = Rig::new(5);
        rig.set_faults(Faults::default().with_packet_loss(0.1));
        let run = rig.client().run_motions(slowly_to(40.0), Some(LONG)).unwrap();
        let planned = planned(slowly_to(40.0));
        assert!((run.cycle_time_s.unwrap() - planned.cycle_time_s()).abs() < 0.0051);
        let expected = planned.cycle_time_s() / 0.005;
        let share = run.samples.t_s.len() as f64 / expected;
        assert!((0.8..0.98).contains(&share), "{share}");
        assert!(rig.client().state().unwrap().fri.lost > 10);

        // One message in five has no answer: too many for commanding.
        rig.client().run_motions(slowly_to(0.0), Some(LONG)).unwrap();
        let error = rig.client().run_trajectory(trajectory_to(10.0), Some(LONG)).unwrap_err();
        assert_eq!(error.code(), Code::Robot, "{error}");
        rig.set_faults(Faults::default());
        assert_works(&rig);
    });
}

#[test]
fn packet_loss_stops_a_trajectory_smoothly() {
    in_real_time(|| {
        let rig = Rig::new(5);
        let running = begin_trajectory(&rig);
        rig.set_faults(Faults::default().with_packet_loss(0.1));
        let (refusal, run) = refused(running.join().unwrap());
        assert_eq!(refusal.code, Code::Robot);
        assert!(refusal.message.contains("quality"), "{refusal}");
        assert_no_jumps(&run);
        rig.set_faults(Faults::default());
        assert_works(&rig);
    });
}

#[test]
fn delayed_messages_prevent_commanding() {
    in_real_time(|| {
        let rig = Rig::new(5);
        rig.set_faults(Faults::default().with_delay_cycles(3));
        let mut client = rig.client();
        wait_for("poor quality", || client.state().unwrap().fri.quality == "poor");
        let run = client.run_motions(slowly_to(40.0), Some(LONG)).unwrap();
        let late_s = run.cycle_time_s.unwrap() - planned(slowly_to(40.0)).cycle_time_s();
        assert!((-1e-6..0.0051).contains(&late_s), "{late_s}");
        client.run_motions(slowly_to(0.0), Some(LONG)).unwrap();
        let error = client.run_trajectory(trajectory_to(10.0), Some(LONG)).unwrap_err();
        assert!(error.to_string().contains("quality poor"), "{error}");
        rig.set_faults(Faults::default());
        assert_works(&rig);
    });
}

/// Asserts that no joint exceeds its velocity limit between samples.
fn assert_no_jumps(run: &Run) {
    let limits = iiwa_kin::Robot::default();
    let limits = limits.limits().velocity_rad_s;
    let samples = &run.samples;
    for (t, q) in samples.t_s.windows(2).zip(samples.joints_rad.windows(2)) {
        for j in 0..7 {
            let speed = (q[1][j] - q[0][j]).abs() / (t[1] - t[0]);
            assert!(speed <= 1.11 * limits[j], "joint {}: {speed} at {} s", j + 1, t[0]);
        }
    }
}

#[test]
fn fifty_milliseconds_of_silence_are_survived() {
    in_real_time(|| {
        let rig = Rig::new(5);
        let running = begin_motion(&rig);
        rig.cabinet().silence(Duration::from_millis(50));
        let run = running.join().unwrap().unwrap();
        let longest = run.samples.t_s.windows(2).map(|t| t[1] - t[0]).fold(0.0, f64::max);
        assert!((0.04..0.2).contains(&longest), "{longest}");
        rig.client().run_motions(slowly_to(0.0), Some(LONG)).unwrap();

        rig.wait_until_ready();
        let running = begin_trajectory(&rig);
        rig.cabinet().silence(Duration::from_millis(50));
        // Ten answers in a row are missing: commanding ends, and the robot brakes.
        let (refusal, run) = refused(running.join().unwrap());
        assert_eq!(refusal.code, Code::Robot);
        assert!(run.samples.t_s.len() > 10);
        assert_no_jumps(&run);
        assert_works(&rig);
    });
}

#[test]
fn a_dropped_session_is_opened_again() {
    in_real_time(|| {
        let rig = Rig::new(5);
        let running = begin_motion(&rig);
        rig.cabinet().drop_session(0.3);
        running.join().unwrap().unwrap();
        rig.wait_until_ready();
        rig.client().run_motions(slowly_to(0.0), Some(LONG)).unwrap();
        let running = begin_trajectory(&rig);
        rig.cabinet().drop_session(0.3);
        let (refusal, _) = refused(running.join().unwrap());
        assert_eq!(refusal.code, Code::Robot);
        assert_works(&rig);
    });
}

#[test]
fn an_emergency_stop_ends_motions_and_trajectories() {
    in_real_time(|| {
        for begin in [begin_motion, begin_trajectory] {
            let rig = Rig::new(5);
            let running = begin(&rig);
            rig.cabinet().press_emergency_stop();
            let (refusal, run) = refused(running.join().unwrap());
            assert_eq!(refusal.code, Code::Robot);
            assert!(refusal.message.contains("emergency stop"), "{refusal}");
            assert_no_jumps(&run);
            let error = rig.client().run_motions(slowly_to(0.0), Some(LONG)).unwrap_err();
            assert!(error.to_string().contains("safety stop"), "{error}");
            let since = Instant::now();
            while rig.client().run_motions(slowly_to(0.0), Some(LONG)).is_err() {
                assert!(since.elapsed() < LONG);
                thread::sleep(Duration::from_millis(100));
            }
            assert_works(&rig);
        }
    });
}

#[test]
fn an_emergency_stop_can_be_scheduled() {
    in_real_time(|| {
        let mut rig = Rig::parts(5);
        rig.cabinet_config.faults.emergency_stop_at = Some(0.5);
        rig.start_cabinet();
        rig.start_drive();
        rig.wait_until_ready();
        let (refusal, run) = refused(rig.client().run_motions(slowly_to(40.0), Some(LONG)));
        assert_eq!(refusal.code, Code::Robot);
        let last = run.samples.joints_rad.last().unwrap()[0].to_degrees();
        assert!((20.0..25.0).contains(&last), "{last}");
    });
}

#[test]
fn a_stop_keeps_to_the_path() {
    in_real_time(|| {
        for begin in [begin_motion, begin_trajectory] {
            let rig = Rig::new(5);
            let running = begin(&rig);
            rig.stop();
            let (refusal, run) = refused(running.join().unwrap());
            assert!(refusal.message.starts_with("stopped on request"), "{refusal}");
            assert_eq!(rig.client().state().unwrap().state, DriveState::Idle);
            let last = run.samples.joints_rad.last().unwrap();
            assert!(last[0].to_degrees() < 39.0 && last[1..].iter().all(|q| q.abs() < 1e-12));
            assert_no_jumps(&run);
            assert_works(&rig);
        }
    });
}

#[test]
fn a_stop_without_a_run_succeeds() {
    let rig = Rig::new(5);
    rig.stop();
    assert_works(&rig);
}

#[test]
fn of_two_simultaneous_runs_one_is_refused_at_once() {
    in_real_time(|| {
        let rig = Rig::new(5);
        let clients: Vec<_> = (0..2)
            .map(|_| {
                let mut client = rig.client();
                thread::spawn(move || {
                    let since = Instant::now();
                    (client.run_motions(slowly_to(20.0), Some(LONG)), since.elapsed())
                })
            })
            .collect();
        let mut results: Vec<_> =
            clients.into_iter().map(|client| client.join().unwrap()).collect();
        results.sort_by_key(|(_, after)| *after);
        let (error, after) = (results[0].0.as_ref().unwrap_err(), results[0].1);
        assert_eq!(error.code(), Code::NotIdle);
        assert!(after < results[1].1 / 2, "{after:?}");
        assert!(results[1].0.is_ok());
        assert_works(&rig);
    });
}

#[test]
fn during_a_motion_only_state_and_stop_are_served() {
    in_real_time(|| {
        let rig = Rig::new(5);
        let running = begin_motion(&rig);
        let mut other = rig.client();
        assert_eq!(other.state().unwrap().state, DriveState::RunningMotion);
        assert_eq!(other.read_sensors().unwrap_err().code(), Code::NotIdle);
        assert_eq!(other.get_io("MediaFlange.UserButton").unwrap_err().code(), Code::NotIdle);
        let error = other.run_trajectory(trajectory_to(1.0), Some(LONG)).unwrap_err();
        assert_eq!(error.code(), Code::NotIdle);
        running.join().unwrap().unwrap();
        assert_works(&rig);
    });
}

#[test]
fn garbage_and_long_messages_have_no_effect() {
    let rig = Rig::new(5);
    let running = begin_motion(&rig);
    let host = |address: &str| address.trim_start_matches("tcp://").to_owned();
    for address in [&rig.drive_config.instructions, &rig.drive_config.stream] {
        for garbage in [vec![0xff_u8; 100_000], b"GET / HTTP/1.1\r\n\r\n".to_vec(), vec![0; 64]] {
            let mut socket = TcpStream::connect(host(address)).unwrap();
            let _ = socket.write_all(&garbage);
        }
    }
    let udp = std::net::UdpSocket::bind("127.0.0.1:0").unwrap();
    for length in [0, 1, 64, 1400, 9000] {
        udp.send_to(&vec![0x5a; length], rig.drive_config.fri).unwrap();
    }
    let exchange = |kind, frames: &[&[u8]]| -> Option<String> {
        let socket = Socket::connect(kind, &rig.drive_config.instructions).unwrap();
        socket.send(frames).unwrap();
        let answer = socket.receive(Duration::from_secs(2))?;
        answer.last().map(|body| String::from_utf8(body.clone()).unwrap())
    };
    let deep = vec![b'['; 100_000];
    let bodies: [&[u8]; 5] = [b"", b"\xff\xfe", b"[]", b"{\"type\": 3}", &deep];
    for body in bodies {
        let answer = exchange(SocketType::Req, &[body]).expect("an answer");
        // Long requests are not parsed during a run.
        let code = if body.len() > MAX_SHORT_REQUEST_BYTES { "not_idle" } else { "bad_request" };
        assert!(answer.contains(&format!("\"{code}\"")), "{answer}");
    }
    // More than one frame, and DEALER with and without the empty frame.
    assert!(exchange(SocketType::Req, &[b"{}", b"{}"]).expect("an answer").contains("bad_request"));
    let state = br#"{"type": "state", "id": [1, "x"]}"#;
    for frames in [[b"".as_slice(), state].as_slice(), &[state]] {
        let answer = exchange(SocketType::Dealer, frames).expect("an answer");
        assert!(answer.contains(r#""ok":true,"id":[1, "x"]"#), "{answer}");
    }
    // The message is too long: the connection is closed.
    let huge = vec![b' '; 100_000_000];
    assert_eq!(exchange(SocketType::Req, &[&huge]), None);
    running.join().unwrap().unwrap();
    let status = rig.client().state().unwrap();
    assert_eq!((status.state, status.fri.lost), (DriveState::Idle, 0));
    assert_works(&rig);
}

#[test]
fn a_slow_session_is_for_monitoring_only() {
    in_real_time(|| {
        let rig = Rig::new(20);
        rig.client().run_motions(slowly_to(10.0), Some(LONG)).unwrap();
        let error = rig.client().run_trajectory(trajectory_to(10.0), Some(LONG)).unwrap_err();
        assert_eq!(error.code(), Code::StartMismatch, "{error}");
        rig.client().run_motions(slowly_to(0.0), Some(LONG)).unwrap();
        let error = rig.client().run_trajectory(trajectory_to(10.0), Some(LONG)).unwrap_err();
        assert!(error.to_string().contains("every 20 ms"), "{error}");
        assert_eq!(rig.client().state().unwrap().state, DriveState::Idle);
    });
}

#[test]
fn a_drive_starts_without_a_cabinet() {
    let mut rig = Rig::parts(5);
    rig.start_drive();
    let status = rig.client().state().unwrap();
    assert_eq!((status.state, status.joints_rad), (DriveState::Idle, None));
    assert_eq!(status.fri.session, "silent");
    assert_eq!(rig.client().run_motions(slowly_to(1.0), None).unwrap_err().code(), Code::Robot);
    rig.start_cabinet();
    assert_works(&rig);
}

#[test]
fn a_client_without_a_drive_reports_it() {
    in_real_time(|| {
        let rig = Rig::parts(5);
        let since = Instant::now();
        let error = rig.client().state().unwrap_err();
        assert!(matches!(error, ClientError::Unreachable { .. }), "{error}");
        assert!(since.elapsed() < LONG);
    });
}

#[test]
fn two_drives_cannot_listen_at_one_address() {
    let rig = Rig::new(5);
    let second =
        iiwa_drive::Drive::start(rig.drive_config.clone(), &Server::open(), &Remote::open());
    let error = second.unwrap_err().to_string();
    assert!(error.contains(&rig.drive_config.instructions), "{error}");
    assert_works(&rig);
}
