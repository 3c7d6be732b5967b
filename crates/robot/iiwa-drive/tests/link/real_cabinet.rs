//! Differences of a real cabinet from the simulated one: without FRI clock and temperatures, FRI
//! from another address, without heartbeat replies, and switched off without closing connections.

use std::{
    io::{ErrorKind, Read},
    net::{IpAddr, Ipv4Addr, SocketAddr, TcpListener},
    thread,
    time::Duration,
};

use iiwa_kin::Joints;
use iiwa_link::{
    ClientError,
    message::{IoValue, OperationMode, Presence, TimedBy},
};
use iiwa_program::{Motion, Ptp};
use iiwasim_tests::zmtp::{HANDSHAKE_TIMEOUT, Peer};

use crate::link::{
    rig::{LONG, Rig, free_tcp, wait_for},
    runs::{motions, planned},
};

/// Starts a cabinet whose outcomes have no times, and a drive.
fn untimed_rig(period_ms: u32) -> Rig {
    let mut rig = Rig::parts(period_ms);
    rig.cabinet_config.without_times = true;
    rig.start_drive();
    rig.start_cabinet();
    rig.wait_until_ready();
    rig
}

#[test]
fn commanded_positions_determine_the_time_of_motions() {
    for period_ms in [5, 1] {
        let rig = untimed_rig(period_ms);
        let mut motions = motions();
        // Standstill at the beginning and at the end is not visible in positions.
        motions.insert(0, Motion::Wait { seconds: 0.2, overlap: 0 });
        motions.push(Motion::Wait { seconds: 0.1, overlap: 0 });
        let plan = planned(motions.clone());
        let run = rig.client().run_motions(motions, Some(LONG)).unwrap();
        assert_eq!((run.timed_by, &run.untimed_because), (Some(TimedBy::CommandedPosition), &None));
        // Planned time of the motion, from the first to the last change.
        let moves = |t_s: f64| plan.at(t_s).dq.iter().any(|dq| dq.abs() > 1e-7);
        let steps = (plan.cycle_time_s() * 1e4) as u32;
        let times_s: Vec<f64> =
            (0..=steps).map(|i| f64::from(i) * 1e-4).filter(|t_s| moves(*t_s)).collect();
        let planned_s = times_s.last().unwrap() - times_s.first().unwrap();
        assert!(plan.cycle_time_s() - planned_s > 0.3, "{planned_s} s");
        let off_s = run.cycle_time_s.unwrap() - planned_s;
        let cycle_s = f64::from(period_ms) * 1e-3;
        assert!(off_s.abs() < 2.0 * cycle_s + 1e-3, "off by {off_s} s");
        // Measured positions match the plan at the same time.
        let begins_s = times_s[0];
        for (t_s, q) in run.samples.t_s.iter().zip(&run.samples.joints_rad) {
            let expected = plan.at(t_s - run.start_s.unwrap() + begins_s).q;
            let off_rad = (0..7).map(|j| (q[j] - expected[j]).abs()).fold(0.0, f64::max);
            assert!(off_rad < 3.0 * cycle_s * 2.0, "off by {off_rad} rad");
        }
        let end_s = run.start_s.unwrap() + run.cycle_time_s.unwrap();
        assert!(*run.samples.t_s.last().unwrap() >= end_s);
        assert_eq!(rig.client().last_run().unwrap(), run);
    }
}

#[test]
fn a_run_without_motion_has_no_cycle_time() {
    let rig = untimed_rig(5);
    let run = rig
        .client()
        .run_motions(vec![Motion::Wait { seconds: 0.1, overlap: 0 }], Some(LONG))
        .unwrap();
    assert_eq!((run.cycle_time_s, run.start_s, run.timed_by), (None, None, None));
    assert!(run.untimed_because.unwrap().contains("did not change"));
}

#[test]
fn a_stopped_run_is_timed_by_commanded_positions_too() {
    let rig = untimed_rig(5);
    let mut target: Joints = [0.0; 7];
    target[0] = 1.5;
    let slow = vec![Motion::Ptp(Ptp::to(target).velocity(0.1))];
    let running = {
        let mut client = rig.client();
        thread::spawn(move || client.run_motions(slow, Some(LONG)))
    };
    wait_for("motion", || running.is_finished() || rig.cabinet().position()[0] > 0.1);
    rig.stop();
    let Err(ClientError::Refused { run: Some(run), .. }) = running.join().unwrap() else {
        panic!("the run has not been stopped")
    };
    assert_eq!((run.timed_by, &run.untimed_because), (Some(TimedBy::CommandedPosition), &None));
    assert!(run.cycle_time_s.unwrap() > 0.1);
}

#[test]
fn sensors_may_have_no_temperatures() {
    let rig = untimed_rig(5);
    let sensors = rig.client().read_sensors().unwrap();
    assert_eq!((sensors.joint_temperature_c, sensors.external_torque_nm), (None, [0.0; 7]));
}

#[test]
fn fri_from_another_address_is_reported() {
    let mut rig = Rig::parts(5);
    rig.drive_config.fri_controller = IpAddr::V4(Ipv4Addr::new(127, 0, 0, 2));
    rig.start_drive();
    rig.start_cabinet();
    let mut client = rig.client();
    let localhost = IpAddr::V4(Ipv4Addr::LOCALHOST);
    wait_for("the other address", || {
        let status = client.state().unwrap();
        status.fri.unexpected_source == Some(localhost)
            && status.robot_program == Presence::Connected
    });
    let status = client.state().unwrap();
    assert!(
        status.text().contains("messages come from 127.0.0.1, another address"),
        "{}",
        status.text()
    );
    let error = client.run_motions(motions(), Some(LONG)).unwrap_err().to_string();
    assert!(
        error.contains("they come from 127.0.0.1, expected 127.0.0.2 (setting fri-cabinet"),
        "{error}"
    );
}

#[test]
fn the_robot_program_reports_itself_and_safety_stops() {
    let rig = Rig::new(5);
    let status = rig.client().state().unwrap();
    assert!(status.hello.unwrap().program.starts_with("iiwasim "));
    let conditions = status.conditions.unwrap();
    assert_eq!(conditions.operation_mode, Some(OperationMode::Aut));
    assert_eq!((conditions.override_rel, conditions.safety_stop), (Some(1.0), Some(false)));
    rig.cabinet().press_emergency_stop();
    let stopped = || {
        let status = rig.client().state().unwrap();
        status.conditions.and_then(|it| it.safety_stop) == Some(true)
    };
    wait_for("the safety stop", stopped);
    wait_for("its end", || !stopped());
}

/// Opens the instruction port of a robot program, as plain TCP.
fn instruction_port(rig: &mut Rig) -> TcpListener {
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
    rig.drive_config.cabinet_instructions = format!("tcp://{}", listener.local_addr().unwrap());
    rig.drive_config.cabinet_state = free_tcp();
    listener
}

fn accepted(listener: &TcpListener) -> Peer {
    let (stream, _) = listener.accept().unwrap();
    Peer::shake_hands(stream, "REP", HANDSHAKE_TIMEOUT).unwrap()
}

/// An idle connection transmits nothing: some libraries do not answer heartbeats.
#[test]
fn an_idle_connection_stays_silent() {
    let mut rig = Rig::parts(5);
    let listener = instruction_port(&mut rig);
    rig.start_drive();
    let mut peer = accepted(&listener);
    peer.stream.set_read_timeout(Some(Duration::from_secs(4))).unwrap();
    let error = peer.stream.read(&mut [0; 64]).expect_err("nothing is sent, and nothing closed");
    assert!(matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut), "{error}");
}

/// A cabinet without power leaves a half-open connection, which is replaced after its restart.
#[test]
fn a_restarted_robot_program_is_instructed_over_a_new_connection() {
    let mut rig = Rig::parts(5);
    let listener = instruction_port(&mut rig);
    let state_at: SocketAddr =
        rig.drive_config.cabinet_state.strip_prefix("tcp://").unwrap().parse().unwrap();
    let states = TcpListener::bind(state_at).unwrap();
    rig.start_drive();
    let _half_open = accepted(&listener);
    let mut states = {
        let (stream, _) = states.accept().unwrap();
        Peer::shake_hands(stream, "DEALER", HANDSHAKE_TIMEOUT).unwrap()
    };
    for boot in ["1", "2"] {
        let state = format!(r#"{{"boot": {boot}, "state": "idle"}}"#);
        states.send(&[b"", state.as_bytes()]).unwrap();
        states.receive(LONG).expect("an acknowledgement");
    }
    let mut program = accepted(&listener);
    let request = {
        let mut client = rig.client();
        thread::spawn(move || client.get_io("x"))
    };
    let instruction = program.receive(LONG).unwrap();
    let body: serde_json::Value = serde_json::from_slice(&instruction[1]).unwrap();
    let answer = format!(r#"{{"seq": {}, "value": 7}}"#, body["seq"]);
    program.send(&[b"", answer.as_bytes()]).unwrap();
    assert_eq!(request.join().unwrap().unwrap(), IoValue::Digital(7));
}
