//! Output, files and exit codes of the commands.

use std::{
    fs,
    net::TcpListener,
    thread,
    time::{Duration, Instant, SystemTime, UNIX_EPOCH},
};

use iiwa_log::JointSample;
use iiwasim_tests::{ports::free_address, realtime_guard::in_real_time};
use predicates::{
    prelude::PredicateBooleanExt,
    str::{contains, is_empty, is_match, starts_with},
};

use crate::link::rig::{LONG, Rig, wait_for};

#[test]
fn the_robot_tells_of_itself() {
    in_real_time(|| {
        let rig = Rig::new();
        rig.iiwasim("status", &[])
            .success()
            .stdout(starts_with(
                "state          idle (a simulated robot)\nrobot          lbr_iiwa_7_r800 with a \
                 flange of 152 mm\njoints           0.000    0.000 ",
            ))
            .stdout(contains("monitoring_ready, quality").and(contains("robot program  connected")))
            .stderr(is_empty());
        let status = rig.json("status", &[]);
        assert_eq!(status["state"], "idle");
        assert_eq!(status["joints_rad"].as_array().unwrap().len(), 7);
        assert!(status["t_s"].as_f64().unwrap() > 0.0);
        assert_eq!((&status["fri"]["lost"], &status["fri"]["late"]), (&0.into(), &0.into()));

        rig.iiwasim("sensors", &[]).success().stdout(contains("external torque Nm"));
        let sensors = rig.json("sensors", &[]);
        for key in ["joint_temperature_c", "external_torque_nm"] {
            assert_eq!(sensors[key].as_array().unwrap().len(), 7);
        }

        let io = |arguments: &[&str]| rig.iiwasim("io", arguments);
        io(&["list"])
            .success()
            .stdout(contains("MediaFlange.UserButton").and(contains("Simulation.AnalogOutput")));
        let listed = io(&["list", "--json"]).success();
        let listed: Vec<serde_json::Value> =
            serde_json::from_slice(&listed.get_output().stdout).unwrap();
        let led = serde_json::json!({
            "name": "MediaFlange.LEDBlue", "direction": "output", "value": false
        });
        assert!(listed.len() == 11 && listed.contains(&led), "{listed:?}");
        io(&["get", "MediaFlange.LEDBlue"]).success().stdout("false\n");
        io(&["set", "MediaFlange.LEDBlue", "true"]).success().stdout("true\n");
        io(&["get", "MediaFlange.LEDBlue"]).success().stdout("true\n");
        io(&["set", "Simulation.AnalogOutput", "-1.5"]).success().stdout("-1.5\n");
        io(&["set", "MediaFlange.LEDBlue", "7"]).code(2).stderr(contains("true or false, not 7"));
        io(&["set", "MediaFlange.LEDBlue", "on"])
            .code(2)
            .stderr(contains("`on` is not true, false"));
        io(&["set", "MediaFlange.UserButton", "true"]).code(2).stderr(contains("is an input"));
        io(&["get", "Lamp"]).code(2).stdout(is_empty()).stderr(contains("MediaFlange.LEDBlue"));
    });
}

#[test]
fn a_program_for_another_robot_is_not_run() {
    let rig = Rig::new();
    let slow = rig.slow_program();
    let text = fs::read_to_string(rig.path(slow)).unwrap();
    fs::write(rig.path("elsewhere.json"), text.replace("[0, 0, 0", "[0, 20, 0")).unwrap();
    let profile = r#"{ "version": 1, "name": "cell 3", "lengths_mm": { "flange": 126 } }"#;
    fs::write(rig.path("cell-3.json"), profile).unwrap();
    let robots = [
        ("lbr_iiwa_14_r820", "lbr_iiwa_14_r820 with a flange of 152 mm"),
        ("cell-3.json", "cell 3 with a flange of 126 mm"),
    ];
    let runs = [&[slow][..], &[slow, "--as-trajectory"], &["elsewhere.json", "--move-to-start"]];
    for (options, (robot, name)) in
        runs.iter().flat_map(|run| robots.iter().map(move |robot| (run, robot)))
    {
        let run = rig.iiwasim("run", &[options, &["--robot", robot][..]].concat()).code(2);
        run.stderr(contains(*name).and(contains("lbr_iiwa_7_r800 with a flange of 152 mm")));
    }
    assert_eq!(rig.joint_1(), 0.0, "the arm has moved");
}

#[test]
fn anybody_can_stop_the_robot() {
    in_real_time(|| {
        let rig = Rig::new();
        let running = rig.begin("run", &[rig.slow_program()]);
        wait_for("motion", || rig.joint_1() > 0.2);
        rig.iiwasim("stop", &[]).success().stdout("The robot is at rest\n").stderr(is_empty());
        let position = rig.joint_1();
        assert!(position < 1.0);
        let ended = running.end().code(1);
        assert!(ended.stderr.contains("stopped on request at"), "{}", ended.stderr);
        rig.iiwasim("stop", &[]).success().stdout("The robot is at rest\n");
        assert_eq!(rig.joint_1(), position);
    });
}

#[test]
fn a_program_runs() {
    in_real_time(|| {
        let rig = Rig::new();
        let program = rig.slow_program();
        rig.iiwasim("run", &[program])
            .success()
            .stdout(contains("Cycle time 3.289 s").and(contains("A1 velocity")))
            .stdout(
                is_match(
                    "Measured   3\\.2[89][0-9] s, planned 3.289 s: the plan is off by [-+]?0.00",
                )
                .unwrap(),
            )
            .stdout(
                is_match(
                    "\n           3\\.2[89][0-9] s by the robot program's clock, in cycles of 5 ms",
                )
                .unwrap(),
            )
            .stdout(is_match("\n65[0-9] samples recorded in slow.measured.mcap\n").unwrap())
            .stderr(is_empty());
        let recording = rig.recording("slow.measured.mcap");
        // Recordings have stamps of the wall clock.
        let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap();
        let ago = now.checked_sub(recording.epoch).unwrap();
        assert!(ago < LONG, "{ago:?}");
        let [first, .., last] = recording.joint_states.as_slice() else { panic!("no states") };
        assert!(first.q[0].abs() < 1e-3 && (last.q[0].to_degrees() - 60.0).abs() < 1e-3);
        assert!(first.t_s < 0.01 && (last.t_s - 3.289).abs() < 0.01);
        assert_eq!(recording.attachments.len(), 3);
        let metadata = &recording.metadata["iiwasim"];
        assert_eq!(metadata["sample_count"], recording.joint_states.len().to_string());
        assert!((metadata["cycle_time_s"].parse::<f64>().unwrap() - 3.289).abs() < 0.01);

        // The arm is now at the end of the program.
        rig.iiwasim("run", &[program])
            .code(1)
            .stderr(contains("joint A1 is at 60.000 deg, the program starts at 0.000 deg"))
            .stderr(contains("--move-to-start"));
        let arguments = ["--move-to-start=100", "--as-trajectory", "--json", "-o", "again.mcap"];
        let arguments = [&arguments[..], &["--ros-names", "lbr_fri_ros2_stack"]].concat();
        let run = rig.iiwasim("run", &[&arguments[..], &[program]].concat()).success();
        let figures: serde_json::Value = serde_json::from_slice(&run.get_output().stdout).unwrap();
        let number = |key: &str| figures[key].as_f64().unwrap();
        let [planned_s, measured_s] = ["planned_cycle_time_s", "measured_cycle_time_s"].map(number);
        assert!((number("error_s") - (planned_s - measured_s)).abs() < 1e-12);
        assert!((number("error_percent") - 100.0 * number("error_s") / measured_s).abs() < 1e-12);
        assert!(number("error_s").abs() < 0.02, "{figures}");
        assert!((number("robot_program_cycle_time_s") - measured_s).abs() < 0.011, "{figures}");
        assert!((number("sample_step_s") - 0.005).abs() < 1e-6, "{figures}");
        // Same definition: `compare` and the report give the same value.
        rig.iiwasim_alone(&["plan", program, "--timing", "jerk", "-o", "plan.mcap"]).success();
        let compared =
            rig.iiwasim_alone(&["compare", "plan.mcap", "again.mcap", "--json"]).success();
        let compared: serde_json::Value =
            serde_json::from_slice(&compared.get_output().stdout).unwrap();
        let real_s = compared["cycle_time"]["real_s"].as_f64().unwrap();
        assert!((real_s - measured_s).abs() < 1e-6, "{real_s} s, {measured_s} s");
        // Recordings are not overwritten; the default name is a new one.
        rig.iiwasim("run", &["--move-to-start=100", "-o", "again.mcap", program])
            .code(2)
            .stderr(contains("again.mcap exists").and(contains("--overwrite")));
        let options = ["--move-to-start=100", "--epoch", "2024-02-29T12:00:00Z", program];
        rig.iiwasim("run", &options).success().stdout(contains("slow.measured-2.mcap"));
        assert_eq!(rig.recording("slow.measured-2.mcap").epoch.as_secs(), 1_709_208_000);
        assert!(figures["ended_after_s"].is_null());
        assert_eq!(figures["output"], "again.mcap");
        let recording = rig.recording("again.mcap");
        assert_eq!(number("samples"), recording.joint_states.len() as f64);
        assert_eq!(&*recording.tcp_poses[0].frame_id, "lbr_link_0");
        assert!((rig.joint_1().to_degrees() - 60.0).abs() < 1e-3);
    });
}

/// A program too close to a scene does not start.
#[test]
fn a_scene_is_checked_before_a_run() {
    in_real_time(|| {
        let rig = Rig::new();
        let scene = r#"{ "version": 1, "obstacles": [
            { "name": "shelf", "type": "box", "center_mm": [0, 0, 1350], "size_mm": [100, 100, 60] }
        ] }"#;
        std::fs::write(rig.path("shelf.json"), scene).unwrap();
        let program = rig.slow_program();
        let before = rig.joint_1();
        rig.iiwasim("run", &["--scene", "shelf.json", "--min-clearance", "100", program])
            .code(3)
            .stdout(contains("Clearance").and(contains("shelf")))
            .stderr(contains("shelf").and(contains("it was not run")));
        assert_eq!(rig.joint_1(), before);
        assert!(!rig.path("slow.measured.mcap").exists());
    });
}

/// The error names the other run, not the position of the arm.
#[test]
fn a_robot_that_runs_is_busy() {
    in_real_time(|| {
        let rig = Rig::new();
        let program = rig.slow_program();
        let running = rig.begin("run", &[program]);
        wait_for("motion", || rig.joint_1() > 0.2);
        rig.iiwasim("run", &[program]).code(1).stderr(contains("the robot is busy"));
        running.end().code(0);
    });
}

/// Settings provide the addresses.
#[test]
fn addresses_are_settings() {
    in_real_time(|| {
        let rig = Rig::new();
        rig.write_settings("iiwasim.toml");
        rig.iiwasim_alone(&["status"]).success().stdout(starts_with("state          idle"));
        rig.iiwasim_alone(&["record", "-o", "a.mcap", "--seconds", "0.5"]).success();
        rig.iiwasim_alone(&["record", "-o", "a.mcap", "--seconds", "0.5"])
            .code(2)
            .stderr(contains("a.mcap exists"));
        rig.iiwasim_alone(&["record", "-o", "a.mcap", "--overwrite", "--seconds", "0.5"]).success();
        let nobody = free_address().to_string();
        // A file is not overwritten if no samples arrive.
        let before = std::fs::read(rig.path("a.mcap")).unwrap();
        let silent =
            ["record", "-o", "a.mcap", "--overwrite", "--seconds", "0.5", "--stream", &nobody];
        rig.iiwasim_alone(&silent).code(1).stderr(contains("nothing was recorded"));
        assert_eq!(std::fs::read(rig.path("a.mcap")).unwrap(), before);
        rig.iiwasim_alone(&["status", "--drive", &nobody]).code(1).stderr(contains(nobody));
    });
}

/// The controller also plans motions to frames; as a trajectory the path is the same.
#[test]
fn a_program_with_frames_runs() {
    in_real_time(|| {
        let rig = Rig::new();
        let text = r#"{
            "version": 1,
            "tools": { "gripper": { "tcp": { "z_mm": 120 } } },
            "tool": "gripper",
            "start": { "joints_deg": [0, 30, 0, -60, 0, 60, 0] },
            "motions": [
                { "type": "lin_rel", "offset": { "y_mm": 150 }, "cart_velocity_mm_s": 150 },
                { "type": "lin_rel", "offset": { "y_mm": -150 }, "cart_velocity_mm_s": 150 }
            ]
        }"#;
        std::fs::write(rig.path("lin.json"), text).unwrap();
        rig.iiwasim("run", &["lin.json"])
            .code(1)
            .stderr(contains("the program starts at").and(contains("--move-to-start")));
        let mut first_cycle_time_s = None;
        // The second run starts at the end of the first.
        for (state, options) in [
            ("running_trajectory", &["--as-trajectory", "--move-to-start=50"][..]),
            ("running_motion", &[]),
        ] {
            let running = rig.begin("run", &[&["lin.json"], options].concat());
            wait_for(state, || rig.json("status", &[])["state"] == state);
            let ended = running.end().code(0);
            for printed in ["lin_rel", "cart velocity"] {
                assert!(ended.stdout.contains(printed), "{}", ended.stdout);
            }

            let recording = rig.recording("lin.measured.mcap");
            let robot = iiwa_kin::Robot::default();
            let tcp = iiwa_kin::Pose { position_m: [0.0, 0.0, 0.12], ..iiwa_kin::Pose::IDENTITY };
            let place = |q: &iiwa_kin::Joints| robot.flange_pose(q).then(&tcp).position_m;
            let places: Vec<_> = recording.joint_states.iter().map(|it| place(&it.q)).collect();
            let first = places[0];
            let off = |axis: usize| {
                places.iter().map(|place| (place[axis] - first[axis]).abs()).fold(0.0, f64::max)
            };
            // The tool's y axis is parallel to that of the base, up to its sign: back and forth on
            // a straight line.
            assert!(off(0) < 1e-3 && off(2) < 1e-3, "{} {}", off(0), off(2));
            assert!((off(1) - 0.15).abs() < 1e-3, "{}", off(1));
            torques_are_of_their_samples(&recording.joint_states);
            let cycle_time_s: f64 = recording.metadata["iiwasim"]["cycle_time_s"].parse().unwrap();
            let first = *first_cycle_time_s.get_or_insert(cycle_time_s);
            assert!((cycle_time_s - first).abs() < 0.02, "{cycle_time_s} s, {first} s");
        }

        // An infeasible program is rejected before the robot receives it.
        let far = text.replace("\"y_mm\": 150", "\"y_mm\": 1500");
        std::fs::write(rig.path("far.json"), far).unwrap();
        rig.iiwasim("run", &["far.json"]).code(2).stderr(contains("motion 1"));
    });
}

/// Checks that most samples have torques: those of the simulated cabinet, which move the arm at the
/// sample's positions and hold its weight, with the sign of KUKA's controller.
fn torques_are_of_their_samples(states: &[JointSample]) {
    let known: Vec<_> = states.iter().filter_map(|it| Some((it.q, it.torques_nm?))).collect();
    assert!(2 * known.len() > states.len(), "{} of {}", known.len(), states.len());
    let (_, first) = known[0];
    let dynamics = iiwa_kin::Robot::default().dynamics();
    for (q, torques_nm) in &known {
        // The torque for the motion is a fraction of the holding torque.
        let holding_nm = dynamics.gravity_torques(q);
        let moving = |j: usize| (torques_nm[j] + holding_nm[j]).abs();
        assert!((0..7).all(|j| moving(j) < 0.5 * holding_nm[1].abs()), "{torques_nm:?}");
    }
    // Back and forth: the arm returns to its start, and is elsewhere in between.
    let (_, last) = known[known.len() - 1];
    let apart = |other: &iiwa_kin::Joints| {
        first.iter().zip(other).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    assert!(apart(&last) < 0.02, "{first:?} {last:?}");
    assert!(known.iter().any(|(_, torques_nm)| apart(torques_nm) > 0.2), "{first:?}");
}

/// Motions that the drive does not support can still be sent as a trajectory.
#[test]
fn motions_that_are_not_understood_come_with_advice() {
    in_real_time(|| {
        let rig = Rig::new();
        let wait = r#"{"type": "wait", "seconds": 0}"#;
        let text = format!(
            r#"{{"version": 1, "start": {{"joints_deg": [0, 0, 0, 0, 0, 0, 0]}},
                "motions": [{}]}}"#,
            vec![wait; 5001].join(",")
        );
        std::fs::write(rig.path("many.json"), text).unwrap();
        rig.iiwasim("run", &["many.json", "--no-output"])
            .code(2)
            .stderr(contains("5001 motions").and(contains("--as-")));
    });
}

#[test]
fn no_file_is_written_unless_it_is_asked_for() {
    in_real_time(|| {
        let rig = Rig::new();
        rig.iiwasim("run", &[rig.slow_program(), "--no-output"]).success();
        assert!(!rig.path("slow.measured.mcap").exists());
    });
}

#[test]
fn a_recording_lasts_as_long_as_asked() {
    in_real_time(|| {
        let rig = Rig::new();
        rig.iiwasim("record", &["-o", "r.mcap", "--seconds", "1", "--ros-prefix", "left"])
            .success()
            .stdout(is_match("^[0-9]+ samples over [01].[0-9]+ s in r.mcap\n$").unwrap());
        let recording = rig.recording("r.mcap");
        assert_eq!(&*recording.tcp_poses[0].frame_id, "left_link_0");
        let states = recording.joint_states;
        // 200 per second, except for the connection time.
        assert!((100..=210).contains(&states.len()), "{} samples", states.len());
        rig.iiwasim("record", &["-o", "r.mcap"]).code(2).stderr(contains("r.mcap exists"));

        let recorder = rig.begin("record", &["-o", "s.mcap"]);
        // The first second is in the file before the arm moves.
        wait_for("samples", || !rig.recording_so_far("s.mcap").is_empty());
        rig.iiwasim("run", &[rig.slow_program(), "--no-output"]).success();
        thread::sleep(Duration::from_millis(300));
        recorder.signal("INT");
        let ended = recorder.end().code(0);
        assert!(ended.stdout.contains(" samples over "), "{}", ended.stdout);
        let recording = rig.recording("s.mcap");
        let [first, .., last] = recording.joint_states.as_slice() else { panic!("no states") };
        assert!(first.q[0].abs() < 1e-3, "{first:?}");
        assert!((last.q[0].to_degrees() - 60.0).abs() < 1e-3, "{last:?}");
        assert!(ended.stdout.starts_with(&recording.joint_states.len().to_string()));
    });
}

#[test]
fn without_a_drive_it_is_said_soon() {
    in_real_time(|| {
        let rig = Rig::parts();
        let begin = Instant::now();
        let nobody =
            || contains("no drive answers at").and(contains("is `iiwasim drive` running there?"));
        rig.iiwasim("status", &[]).code(1).stdout(is_empty()).stderr(nobody());
        rig.iiwasim("run", &[rig.slow_program()]).code(1).stderr(nobody());
        assert!(!rig.path("slow.measured.mcap").exists());
        rig.iiwasim("record", &["-o", "r.mcap", "--seconds", "0.5"]).code(1).stderr(
            contains("nothing was recorded: nothing came from tcp://127.0.0.1:")
                .and(contains("is `iiwasim drive` running there?")),
        );
        assert!(!rig.path("r.mcap").exists());
        assert!(begin.elapsed() < Duration::from_mins(1), "{:?}", begin.elapsed());
    });
}

#[test]
fn without_a_cabinet_it_is_said_soon() {
    in_real_time(|| {
        let mut rig = Rig::parts();
        rig.start_drive(&[]);
        wait_for("drive", || {
            rig.drive.as_ref().unwrap().stderr().contains("iiwaDrive: requests at")
        });
        rig.iiwasim("status", &[])
            .success()
            .stdout(contains("joints         unknown").and(contains("robot program  silent")));
        rig.iiwasim("run", &[rig.slow_program()])
            .code(1)
            .stderr(contains("the drive receives nothing from the controller"));
        rig.iiwasim("sensors", &[]).code(1).stderr(contains("did not answer in time"));
    });
}

#[test]
fn wrong_usage_is_refused() {
    in_real_time(|| {
        let rig = Rig::parts();
        let program = rig.slow_program();
        for (command, arguments) in [
            ("run", &[][..]),
            ("run", &[program, "--move-to-start=0"]),
            ("run", &[program, "--no-output", "-o", "x.mcap"]),
            ("run", &[program, "--key", "a.key"]),
            ("run", &["absent.json"]),
            ("record", &[]),
            ("record", &["-o", "x.mcap", "--seconds", "soon"]),
            ("io", &["get"]),
        ] {
            rig.iiwasim(command, arguments).code(2).stdout(is_empty());
        }
        // Options of drive and cabinet.
        for arguments in [
            &["drive", "--cabinet-key", "c.pub"][..],
            &["drive", "--key", "d.key"],
            &["drive", "--instructions", "127.0.0.1"],
            &["cabinet", "--period", "0"],
            &["cabinet", "--lag=1001"],
            &["cabinet", "--start-deg", "180,0,0,0,0,0,0"],
        ] {
            rig.start(arguments).end().code(2);
        }
    });
}

#[test]
fn other_machines_need_keys() {
    in_real_time(|| {
        let rig = Rig::parts();
        for arguments in [
            ["drive", "--instructions", "0.0.0.0:45560"],
            ["drive", "--stream", "*:45560"],
            ["cabinet", "--instructions", "0.0.0.0:45560"],
            ["cabinet", "--fri", "192.0.2.1:30200"],
        ] {
            let ended = rig.start(&arguments).end().code(2);
            assert!(ended.stderr.contains("key"), "{}", ended.stderr);
        }
        let ended = rig.start(&["drive", "--instructions", "0.0.0.0:45560"]).end().code(2);
        assert!(ended.stderr.contains("iiwasim keygen drive"), "{}", ended.stderr);
        let ended = rig.start(&["status", "--drive", "192.0.2.1:5560"]).end().code(2);
        assert!(ended.stderr.contains("--server-key"), "{}", ended.stderr);
    });
}

#[test]
fn a_taken_address_is_named() {
    in_real_time(|| {
        let rig = Rig::parts();
        let taken = TcpListener::bind("127.0.0.1:0").unwrap();
        let address = taken.local_addr().unwrap().to_string();
        for command in ["drive", "cabinet"] {
            let arguments = [command, "--instructions", &address, "--fri", &rig.fri];
            let ended = rig.start(&arguments).end().code(1);
            let said = format!("Error: cannot listen at tcp://{address}: ");
            assert!(ended.stderr.contains(&said), "{}", ended.stderr);
            assert!(ended.stderr.contains("another port with --instruct"), "{}", ended.stderr);
        }
    });
}

#[test]
fn an_experiment_runs() {
    in_real_time(|| {
        let rig = Rig::new();
        rig.iiwasim("experiment", &["zone-velocity", "--move-to-start=50"])
            .success()
            .stdout(contains("report in experiment-zone-velocity/report.md"))
            .stderr(contains("The arm will run programs: 1").and(contains("has to be free")));
        let folder = rig.path("experiment-zone-velocity");
        let report = std::fs::read_to_string(folder.join("report.md")).unwrap();
        assert!(
            report.contains("on the robot at tcp://127.0.0.1:") && !report.contains("virtual"),
            "{report}"
        );
        assert!(report.contains("in 3 of 3 blends"), "{report}");
        let recording = rig.recording("experiment-zone-velocity/recordings/appendix-b.mcap");
        assert!(recording.joint_states.len() > 1700);
    });
}
