//! Access to a drive, and to a cabinet: each with real keys.

use std::fs;

use predicates::str::contains;

use crate::link::rig::{Rig, wait_for};

/// Creates keys for all parties; `alice` may access the drive, and the drive the cabinet.
fn rig_with_keys() -> Rig {
    let rig = Rig::parts();
    for name in ["cabinet", "drive", "alice", "mallory"] {
        rig.start(&["keygen", name, "-o", "keys"]).end().code(0);
    }
    for (folder, name) in [("clients", "alice.pub"), ("drives", "drive.pub")] {
        fs::create_dir(rig.path(folder)).unwrap();
        fs::copy(rig.path("keys").join(name), rig.path(folder).join(name)).unwrap();
    }
    rig
}

const DRIVE: [&str; 4] = ["--key", "keys/drive.key", "--allow", "clients"];
const ALICE: [&str; 4] = ["--key", "keys/alice.key", "--server-key", "keys/drive.pub"];

/// Keys of rejected clients, and the error texts.
const STRANGERS: [(&str, &[&str], &str); 3] = [
    ("no key", &[], "refused the connection: "),
    (
        "a key that is not on the list",
        &["--key", "keys/mallory.key", "--server-key", "keys/drive.pub"],
        "refused the connection: the client's key is not on the drive's list",
    ),
    (
        "a wrong server key",
        &["--key", "keys/alice.key", "--server-key", "keys/mallory.pub"],
        "is the drive's public key the right one?",
    ),
];

#[test]
fn strangers_get_nothing_and_move_nothing() {
    let mut rig = rig_with_keys();
    rig.start_cabinet(&[]);
    rig.start_drive(&DRIVE);
    rig.wait_until_ready(&ALICE);
    let program = rig.slow_program();
    for (who, keys, message) in STRANGERS {
        println!("{who}");
        let try_command = |command: &str, arguments: &[&str]| {
            rig.iiwasim(command, &[arguments, keys].concat()).code(1).stderr(contains(message));
        };
        try_command("status", &[]);
        try_command("io", &["set", "MediaFlange.LEDBlue", "true"]);
        try_command("run", &[program]);
        try_command("record", &["-o", "stolen.mcap", "--seconds", "30"]);
        assert!(!rig.path("stolen.mcap").exists() && !rig.path("slow.measured.mcap").exists());
    }
    for (who, keys, _) in STRANGERS {
        println!("{who}, in Python");
        let Some(example) = rig.example(keys) else { break };
        let ended = example.end().code(1);
        assert!(ended.stdout.is_empty(), "{}", ended.stdout);
        assert!(ended.stderr.contains("no answer"), "{}", ended.stderr);
    }
    assert_eq!(rig.json("status", &ALICE)["joints_rad"], serde_json::json!([0.0_f64; 7].to_vec()));
    rig.iiwasim("io", &[&["get", "MediaFlange.LEDBlue"], &ALICE[..]].concat()).stdout("false\n");
    let log = rig.drive.as_ref().unwrap().stderr();
    assert!(!log.contains("running"), "{log}");
}

#[test]
fn the_right_key_gets_everything() {
    let mut rig = rig_with_keys();
    rig.start_cabinet(&["--key", "keys/cabinet.key", "--allow", "drives"]);
    rig.start_drive(&[&DRIVE[..], &["--cabinet-key", "keys/cabinet.pub"]].concat());
    rig.wait_until_ready(&ALICE);
    let with_key = |arguments: &[&'static str]| [arguments, &ALICE].concat();
    let recorder = rig.begin("record", &with_key(&["-o", "r.mcap"]));
    rig.iiwasim("run", &with_key(&[rig.slow_program()])).success().stdout(contains("Measured"));
    recorder.signal("INT");
    recorder.end().code(0);
    let far = |name: &str| rig.recording(name).joint_states.last().unwrap().q[0].to_degrees();
    assert!((far("r.mcap") - 60.0).abs() < 1e-3 && (far("slow.measured.mcap") - 60.0).abs() < 1e-3);
    if let Some(example) = rig.example(&ALICE) {
        let ended = example.end().code(0);
        assert!(ended.stdout.contains("\nmeasured: "), "{}{}", ended.stdout, ended.stderr);
    }
}

#[test]
fn the_example_works_without_keys() {
    let rig = Rig::new();
    let Some(example) = rig.example(&[]) else { return };
    let ended = example.end().code(0);
    assert!(ended.stdout.starts_with("\rA1 at +0.0"), "{}", ended.stdout);
    let figures = ended.stdout.lines().last().unwrap();
    let mut numbers = figures.split(|c: char| !c.is_ascii_digit() && c != '.');
    let mut number = || numbers.find_map(|text| text.parse::<f64>().ok()).unwrap();
    let (cycle_time_s, samples) = (number(), number());
    // A sample every 5 ms, and some before the start.
    assert!(cycle_time_s > 1.0 && (samples * 5e-3 - cycle_time_s).abs() < 0.5, "{figures}");
}

#[test]
fn a_cabinet_with_keys_takes_no_other_drive() {
    let mut rig = rig_with_keys();
    rig.start_cabinet(&["--key", "keys/cabinet.key", "--allow", "drives"]);
    for keys in [
        &[][..],
        &["--key", "keys/mallory.key", "--allow", "clients", "--cabinet-key", "keys/cabinet.pub"],
        &["--key", "keys/drive.key", "--allow", "clients", "--cabinet-key", "keys/mallory.pub"],
    ] {
        rig.drive = None;
        rig.start_drive(keys);
        let server = keys.get(1).map_or("keys/drive.pub", |key| match *key {
            "keys/mallory.key" => "keys/mallory.pub",
            _ => "keys/drive.pub",
        });
        let client = ["--key", "keys/alice.key", "--server-key", server];
        let client = if keys.is_empty() { &[][..] } else { &client };
        wait_for("FRI", || {
            let status = rig.iiwasim("status", client);
            let text = String::from_utf8(status.get_output().stdout.clone()).unwrap();
            text.contains("monitoring_ready")
        });
        rig.iiwasim("run", &[&[rig.slow_program()], client].concat())
            .code(1)
            .stderr(contains("the robot program does not answer"));
        rig.iiwasim("status", client).success().stdout(contains("robot program  silent"));
    }
}
