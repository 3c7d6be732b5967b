//! Step-by-step check of the connection to a cabinet.

use std::{
    net::{TcpListener, UdpSocket},
    time::Instant,
};

use iiwa_cabinet::Cabinet;
use iiwa_drive::{LinkCheck, StepResult};
use iiwa_link::{
    Remote, Server,
    security::{AllowList, ClientSecurity, KeyPair, ServerSecurity},
};
use iiwasim_tests::{child_processes, realtime_guard::in_real_time};

use crate::link::{
    rig::{Rig, wait_for},
    scripted_program::ScriptedProgram,
};

fn check(rig: &Rig, remote: &Remote) -> LinkCheck {
    let mut reported = Vec::new();
    // The previous check may have used the same UDP port.
    child_processes::await_all();
    let check = LinkCheck::run(&rig.drive_config, remote, |step| reported.push(step.clone()));
    assert_eq!(check.steps, reported);
    assert_eq!(check.steps.len(), 11);
    for step in &check.steps {
        println!("{}", step.line("--"));
    }
    check
}

/// Returns the result and the text of a step.
fn step<'a>(check: &'a LinkCheck, name: &str) -> (StepResult, &'a str) {
    let step = check.steps.iter().find(|step| step.step == name).expect(name);
    (step.result, &step.text)
}

fn assert_fails(check: &LinkCheck, name: &str, text: &str) {
    let (result, message) = step(check, name);
    assert_eq!(result, StepResult::Fails, "{name}: {message}");
    assert!(message.contains(text), "{name}: {message}");
    assert!(!check.ok);
}

#[test]
fn a_good_connection_passes() {
    in_real_time(|| {
        let mut rig = Rig::parts(5);
        rig.start_cabinet();
        let check = check(&rig, &Remote::open());
        assert!(check.ok);
        assert!(check.steps.iter().all(|step| step.result == StepResult::Ok));
        assert!(step(&check, "robot program").1.starts_with("iiwasim "));
        assert!(step(&check, "conditions").1.contains("mode AUT, override 100 %"));
        // The check has no lasting effect: a drive connects afterwards.
        rig.start_drive();
        rig.wait_until_ready();
    });
}

#[test]
fn without_a_cabinet_each_step_has_a_remedy() {
    let rig = Rig::parts(5);
    let since = Instant::now();
    let check = check(&rig, &Remote::open());
    println!("{:?}", since.elapsed());
    assert_fails(&check, "instruction port", "start the robot program");
    assert_fails(&check, "state port", "nothing listens");
    assert_eq!(step(&check, "keys").0, StepResult::Skipped);
    assert_eq!(step(&check, "conditions").0, StepResult::Skipped);
    assert_fails(&check, "FRI messages", "firewall");
    assert_eq!(step(&check, "FRI session").0, StepResult::Skipped);
}

/// Another program listens at the port, and sends nothing.
#[test]
fn a_port_of_another_program_is_reported() {
    let mut rig = Rig::parts(5);
    let other = TcpListener::bind("127.0.0.1:0").unwrap();
    rig.drive_config.cabinet_instructions = format!("tcp://{}", other.local_addr().unwrap());
    let check = check(&rig, &Remote::open());
    assert_fails(&check, "instruction port", "does not speak as a robot program does");
    assert_eq!(step(&check, "robot program").0, StepResult::Skipped);
}

#[test]
fn a_port_in_use_ends_the_check() {
    let rig = Rig::parts(5);
    let _other = UdpSocket::bind(rig.drive_config.fri).unwrap();
    let check = check(&rig, &Remote::open());
    assert_fails(&check, "UDP port", "in use");
    assert!(check.steps[1..].iter().all(|step| step.result == StepResult::Skipped));
}

#[test]
fn another_source_of_fri_is_named() {
    let mut rig = Rig::parts(20);
    rig.drive_config.fri_controller = "127.0.0.2".parse().unwrap();
    rig.start_cabinet();
    let check = check(&rig, &Remote::open());
    assert_fails(&check, "FRI messages", "they come from 127.0.0.1, expected 127.0.0.2");
}

#[test]
fn too_long_a_send_period_is_reported() {
    let mut rig = Rig::parts(20);
    rig.start_cabinet();
    let check = check(&rig, &Remote::open());
    assert_fails(&check, "send period", "every 20 ms");
    assert_eq!(step(&check, "FRI version").0, StepResult::Ok);
}

#[test]
fn another_version_of_fri_is_reported() {
    let rig = Rig::parts(5);
    let to = rig.drive_config.fri;
    let sender = std::thread::spawn(move || {
        let udp = UdpSocket::bind("127.0.0.1:0").unwrap();
        for _ in 0..60 {
            // The port may not be open yet.
            let _ = udp.send_to(b"FRI 2", to);
            std::thread::sleep(std::time::Duration::from_millis(100));
        }
    });
    let check = check(&rig, &Remote::open());
    assert_fails(&check, "FRI version", "FRI 1.14 to 1.16");
    assert_eq!(step(&check, "send period").0, StepResult::Skipped);
    sender.join().unwrap();
}

#[test]
fn keys_are_checked() {
    let mut rig = Rig::parts(5);
    let [cabinet, drive, other] = [(); 3].map(|()| KeyPair::generate().unwrap());
    let cabinet_key = cabinet.public();
    let remote = |keys: &KeyPair| Remote::with_keys(ClientSecurity::new(keys.clone(), cabinet_key));
    let allowed = AllowList::from_iter([("drive".to_owned(), drive.public())]);
    let server = Server::with_keys(ServerSecurity::new(cabinet, allowed));
    let secured = Cabinet::start(rig.cabinet_config.clone(), &server).unwrap();
    assert_eq!(step(&check(&rig, &remote(&drive)), "keys").0, StepResult::Ok);
    let one_sided = check(&rig, &Remote::open());
    assert_fails(&one_sided, "keys", "this side has none");
    assert_eq!(step(&one_sided, "state port").0, StepResult::Ok);
    assert_fails(&check(&rig, &remote(&other)), "keys", "key");
    drop(secured);
    // JeroMQ closes such a connection without a reason.
    rig.jar = None;
    rig.start_cabinet();
    assert_fails(&check(&rig, &remote(&drive)), "keys", "this side has keys");
}

#[test]
fn a_safety_stop_is_reported() {
    let mut rig = Rig::parts(5);
    rig.start_cabinet();
    wait_for("the emergency stop", || {
        rig.cabinet().press_emergency_stop();
        let check = check(&rig, &Remote::open());
        check.steps.iter().any(|step| step.step == "conditions" && step.text.contains("release"))
    });
}

#[test]
fn another_protocol_is_named() {
    let (mut rig, program) = ScriptedProgram::new();
    rig.drive = None;
    let hello = br#"{"boot": 1, "state": "idle", "hello": {"protocol": 9, "program": "mine 2"}}"#;
    let check = std::thread::scope(|scope| {
        let checking = scope.spawn(|| check(&rig, &Remote::open()));
        while !checking.is_finished() {
            program.send_unacknowledged(hello);
            std::thread::sleep(std::time::Duration::from_millis(100));
        }
        checking.join().unwrap()
    });
    assert_fails(&check, "robot program", "version 9 of the protocol, this drive version 1");
}
