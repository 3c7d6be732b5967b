//! Commands with a cabinet that has fewer capabilities than the simulated one, and the check of the
//! connection to it.

use std::{
    net::TcpListener,
    sync::atomic::{AtomicBool, Ordering},
    thread,
    time::Duration,
};

use iiwasim_tests::{
    realtime_guard::in_real_time,
    zmtp::{HANDSHAKE_TIMEOUT, Peer},
};
use predicates::{
    prelude::PredicateBooleanExt,
    str::{contains, is_empty, is_match},
};
use serde_json::Value;

use crate::link::rig::{LONG, Rig, wait_for};

/// Returns a cabinet whose robot program reports neither times nor temperatures.
fn untimed_rig() -> Rig {
    let mut rig = Rig::parts();
    rig.start_cabinet(&["--without-times"]);
    rig.start_drive(&[]);
    rig.wait_until_ready(&[]);
    rig
}

#[test]
fn runs_are_timed_by_commanded_positions() {
    in_real_time(|| {
        let rig = untimed_rig();
        let program = rig.slow_program();
        // 3.289 s including a settle time of 0.050 s.
        let stated = "3\\.2[34][0-9] s from the first to the last change of the commanded \
            positions, in cycles of 5 ms; in the plan 3.239 s, without 0.050 s of standstill \
            before and after";
        rig.iiwasim("run", &[program])
            .success()
            .stdout(
                is_match(
                    "Measured   3\\.2[89][0-9] s, planned 3.289 s: the plan is off by [-+]?0.00",
                )
                .unwrap(),
            )
            .stdout(is_match(format!("\n           {stated}\n")).unwrap())
            .stderr(is_empty());
        let recording = rig.recording("slow.measured.mcap");
        assert_eq!(recording.metadata["iiwasim"]["timed_by"], "commanded_position");
        rig.iiwasim_alone(&["plan", program, "-o", "plan.mcap"]).success();
        rig.iiwasim_alone(&[
            "compare",
            "plan.mcap",
            "slow.measured.mcap",
            "--max-error-percent",
            "0.5",
        ])
        .success()
        .stdout(is_match(stated).unwrap());
        let compared = rig.iiwasim_alone(&["compare", "plan.mcap", "slow.measured.mcap", "--json"]);
        let compared: Value = serde_json::from_slice(&compared.get_output().stdout).unwrap();
        assert_eq!(compared["cycle_time"]["timed_by"], "commanded_position");

        let options = ["--move-to-start=100", "--json", "--no-output", program];
        let run = rig.iiwasim("run", &options).success();
        let figures: Value = serde_json::from_slice(&run.get_output().stdout).unwrap();
        let commanded_s = figures["commanded_cycle_time_s"].as_f64().unwrap();
        let measured_s = figures["measured_cycle_time_s"].as_f64().unwrap();
        assert!((measured_s - commanded_s - 0.05).abs() < 0.011, "{figures}");
        assert!(figures["robot_program_cycle_time_s"].is_null(), "{figures}");
    });
}

#[test]
fn sensors_without_temperatures_are_printed() {
    let rig = untimed_rig();
    rig.iiwasim("sensors", &[])
        .success()
        .stdout(is_match("A7 +- +0.00").unwrap())
        .stdout(contains("The controller does not report the temperatures."));
    let sensors = rig.json("sensors", &[]);
    assert!(sensors["joint_temperature_c"].is_null());
    assert_eq!(sensors["external_torque_nm"].as_array().unwrap().len(), 7);
    rig.iiwasim("record", &["--sensors", "--seconds", "1.5", "-o", "sensors.mcap"]).success();
}

#[test]
fn the_status_has_versions_and_conditions() {
    let rig = untimed_rig();
    rig.iiwasim("status", &[])
        .success()
        .stdout(is_match("robot program  connected: iiwasim cabinet [0-9.]+\n").unwrap())
        .stdout(contains("conditions     mode AUT, override 100 %, no safety stop\n"));
    let status = rig.json("status", &[]);
    assert_eq!(status["hello"]["protocol"], 1);
    assert_eq!(status["conditions"]["operation_mode"], "aut");
}

#[test]
fn the_connection_is_checked() {
    in_real_time(|| {
        let mut rig = Rig::parts();
        rig.start_cabinet(&[]);
        let cabinet = rig.cabinet.as_ref().unwrap();
        wait_for("the cabinet", || cabinet.stderr().contains("Simulated cabinet"));
        let checked = rig.check_drive(&[]).code(0);
        assert!(
            checked.stdout.contains("ok      FRI session         monitoring_ready, quality"),
            "{}",
            checked.stdout
        );
        assert_eq!(checked.stdout.lines().count(), 11, "{}", checked.stdout);
        let checked = rig.check_drive(&["--json"]).code(0);
        let object: Value = serde_json::from_str(&checked.stdout).unwrap();
        assert_eq!((&object["ok"], &object["steps"][0]["result"]), (&true.into(), &"ok".into()));

        let checked = rig.check_drive(&["--fri-cabinet", "127.0.0.2"]).code(1);
        let expected = "fails   FRI messages        they come from 127.0.0.1, expected 127.0.0.2: \
            is 127.0.0.1 the controller? (--fri-cabinet)";
        assert!(checked.stdout.contains(expected), "{}", checked.stdout);
        assert!(checked.stderr.contains("the connection to the cabinet is not ready"));
    });
}

#[test]
fn the_source_of_fri_is_an_option() {
    let mut rig = Rig::parts();
    rig.start_cabinet(&[]);
    rig.check_drive(&["--fri-cabinet", "::1"]).code(2);
    rig.start_drive(&["--fri-cabinet", "127.0.0.2"]);
    wait_for("the other source", || {
        rig.json("status", &[])["fri"]["unexpected_source"] == "127.0.0.1"
    });
    rig.iiwasim("status", &[])
        .success()
        .stdout(contains("messages come from 127.0.0.1, another address than expected"));
    rig.iiwasim("run", &[rig.slow_program()])
        .code(1)
        .stderr(contains("FRI messages from 127.0.0.1").and(contains("--fri-cabinet")));
    let drive = rig.drive.take().unwrap();
    assert!(
        drive.stderr().contains("FRI messages arrive from 127.0.0.1, expected 127.0.0.2"),
        "{}",
        drive.stderr()
    );
}

/// The states come from a robot program of this test, which runs nothing.
#[test]
fn a_low_override_and_t1_are_warned_of() {
    let mut rig = Rig::parts();
    rig.start_cabinet(&[]);
    let states = TcpListener::bind("127.0.0.1:0").unwrap();
    rig.cabinet_state = states.local_addr().unwrap().to_string();
    rig.start_drive(&[]);
    let (stream, _) = states.accept().unwrap();
    let mut program = Peer::shake_hands(stream, "DEALER", HANDSHAKE_TIMEOUT).unwrap();
    let done = AtomicBool::new(false);
    thread::scope(|scope| {
        scope.spawn(|| {
            let state = br#"{"boot": 1, "state": "idle",
                "conditions": {"operation_mode": "t1", "override": 0.3}}"#;
            while !done.load(Ordering::Relaxed) {
                program.send(&[b"", state]).unwrap();
                program.receive(LONG).unwrap();
                thread::sleep(Duration::from_millis(100));
            }
        });
        rig.wait_until_ready(&[]);
        let run = rig.iiwasim("run", &[rig.slow_program(), "--no-output"]);
        done.store(true, Ordering::Relaxed);
        run.code(1).stderr(contains(
            "Warning: the override is 30 %, and the operation mode is T1, which limits velocities: \
             the program takes longer than planned",
        ));
    });
}
