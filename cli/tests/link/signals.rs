//! Runs of programs with inputs and outputs.

use std::fs;

use iiwasim_tests::realtime_guard::in_real_time;
use predicates::{prelude::PredicateBooleanExt, str::contains};

use crate::link::rig::{Rig, wait_for};

fn program(motions: &str) -> String {
    format!(
        r#"{{ "version": 1, "start": {{ "joints_deg": [0, 0, 0, 0, 0, 0, 0] }}, "motions": [
            {{ "type": "set", "io": "MediaFlange.LEDBlue", "value": true }},
            {{ "type": "ptp", "joints_deg": [4, 0, 0, 0, 0, 0, 0] }},
            {motions},
            {{ "type": "ptp", "joints_deg": [0, 0, 0, 0, 0, 0, 0] }} ] }}"#
    )
}

fn wait(io: &str, value: &str) -> String {
    format!(r#"{{ "type": "wait_for", "io": "{io}", "value": {value}, "seconds": 0.2 }}"#)
}

#[test]
fn outputs_are_set_and_inputs_are_awaited() {
    in_real_time(|| {
        let mut rig = Rig::parts();
        rig.start_cabinet(&["--signal", "MediaFlange.UserButton=true"]);
        rig.start_drive(&[]);
        rig.wait_until_ready(&[]);
        let write = |name: &str, motions: &str| {
            fs::write(rig.path(name), program(motions)).unwrap();
        };
        // The input has its value already.
        write("go.json", &wait("MediaFlange.UserButton", "true"));
        rig.iiwasim("run", &["go.json"])
            .success()
            .stderr(contains("Waiting until MediaFlange.UserButton is true"));
        rig.iiwasim("io", &["get", "MediaFlange.LEDBlue"]).success().stdout("true\n");
        assert!(rig.path("go.measured.mcap").exists());

        // Rejected before the robot moves.
        rig.iiwasim("io", &["set", "MediaFlange.LEDBlue", "false"]).success();
        for (motion, reason) in [
            (wait("Nope.X", "true"), "motion 3: unknown input or output `Nope.X`"),
            (wait("MediaFlange.UserButton", "3"), "is true, and can never be 3"),
            (wait("Simulation.DigitalInput", "2.5"), "is 0, and can never be 2.5"),
            (
                r#"{ "type": "set", "io": "MediaFlange.UserButton", "value": true }"#.to_owned(),
                "motion 3: `MediaFlange.UserButton` is an input, which cannot be set",
            ),
            (
                wait("MediaFlange.UserButton", "true, \"overlap\": true"),
                "motion 3 uses `MediaFlange.UserButton` while the robot moves",
            ),
        ] {
            write("wrong.json", &motion);
            rig.iiwasim("run", &["wrong.json"]).code(2).stderr(contains(reason));
        }
        rig.iiwasim("run", &["go.json", "--as-trajectory"])
            .code(2)
            .stderr(contains("which a trajectory lacks"));
        rig.iiwasim("io", &["get", "MediaFlange.LEDBlue"]).success().stdout("false\n");

        // A wait ends by an interrupt, at rest.
        write("stuck.json", &wait("MediaFlange.UserButton", "false"));
        let run = rig.begin("run", &["stuck.json"]);
        wait_for("wait", || run.stderr().contains("Waiting until"));
        run.signal("INT");
        let ended = run.end();
        let message = "motion 3: interrupted while `MediaFlange.UserButton` is true, not false";
        assert!(!ended.status.success() && ended.stderr.contains(message), "{}", ended.stderr);
        rig.iiwasim("status", &[]).success().stdout(contains("idle").and(contains("4.000")));
    });
}
