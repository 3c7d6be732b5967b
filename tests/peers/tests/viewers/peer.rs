//! A viewer that shares no code with this program: the script `tests/foxglove/check.py` of the
//! workspace. It needs a Python with what `tests/requirements.txt` names, at the path in
//! `IIWASIM_PYTHON`; without it this test is left out.

use std::{
    env,
    path::Path,
    process::{Command, Stdio},
    thread,
    time::{Duration, Instant, SystemTime},
};

use iiwa_link::message::IoValue;
use iiwasim_tests::child_processes;
use serde_json::{Value, json};

use super::{JOINTS, listen, status};

#[test]
fn a_client_in_python_reads_everything() {
    let Some(python) = env::var_os("IIWASIM_PYTHON") else {
        eprintln!("left out: IIWASIM_PYTHON names no Python for check.py");
        return;
    };
    let mut viewers = listen();
    viewers.drive_state(SystemTime::now(), &status());
    viewers.inputs_outputs(SystemTime::now(), &[("gripper_closed", IoValue::Boolean(true))]);
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/foxglove/check.py");
    let mut command = Command::new(python);
    command
        .arg("-B")
        .arg(script)
        .arg(format!("ws://{}", viewers.address()))
        .arg("--json")
        .stdout(Stdio::piped());
    let mut client = child_processes::start(&mut command).unwrap();

    // The arm turns about all axes at once: each joint is where this one joint is, but for an
    // offset.
    let started = Instant::now();
    while client.try_wait().unwrap().is_none() && started.elapsed() < Duration::from_mins(1) {
        let now = SystemTime::now();
        let turned = started.elapsed().as_secs_f64();
        viewers.joints(now, &JOINTS.map(|joint| joint + 0.1 * turned)).unwrap();
        thread::sleep(Duration::from_millis(2));
    }
    // It may hang.
    let _ = client.kill();
    let output = client.wait_with_output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success(), "{text}");

    let result: Value = serde_json::from_str(text.lines().last().unwrap()).unwrap();
    let states = result["joint_states"].as_array().unwrap();
    assert!(states.len() >= 20, "{result}");
    for state in states {
        let positions: Vec<f64> = serde_json::from_value(state["position"].clone()).unwrap();
        let velocities: Vec<f64> = serde_json::from_value(state["velocity"].clone()).unwrap();
        let turned = positions[0] - JOINTS[0];
        assert!((0.0..6.0).contains(&turned), "{state}");
        for (joint, position) in positions.iter().enumerate() {
            assert!((position - JOINTS[joint] - turned).abs() < 1e-12, "{state}");
            assert!((velocities[joint] - 0.1).abs() < 0.05, "{state}");
        }
    }
    assert_eq!(result["drive_state"], serde_json::to_value(status()).unwrap());
    let expected = json!({ "values": [{ "name": "gripper_closed", "value": 1 }] });
    assert_eq!(result["inputs_outputs"], expected);
    assert_eq!(result["sensors"], Value::Null);
}
