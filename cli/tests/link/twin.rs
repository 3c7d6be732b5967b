//! `iiwasim twin`.

use std::{
    fs,
    net::{TcpStream, UdpSocket},
    thread,
    time::Duration,
};

use iiwa_log::Recording;
use iiwasim_tests::realtime_guard::in_real_time;
use serde_json::{Value, json};

use crate::link::{
    page::{Address, Page},
    rig::{Process, Rig, wait_for},
};

/// Table that the slow program passes, and a floor plane.
const SCENE: &str = r#"{ "version": 1, "obstacles": [
    { "name": "table", "type": "box", "center_mm": [700, 0, -100], "size_mm": [500, 900, 100] },
    { "name": "floor", "type": "plane", "point_mm": [0, 0, -700], "normal": [0, 0, 1] }
] }"#;

pub(crate) fn start(rig: &Rig, options: &[&str]) -> (Process, Address) {
    fs::write(rig.path("scene.json"), SCENE).unwrap();
    let twin = rig.begin("twin", &[&["--port", "0"], options].concat());
    let address = Address::of(&twin);
    (twin, address)
}

/// Returns a program from the zero pose with these motions.
pub(crate) fn program(motions: &str) -> Value {
    let text = format!(
        r#"{{ "version": 1, "start": {{ "joints_deg": [0, 0, 0, 0, 0, 0, 0] }},
            "motions": [{motions}] }}"#
    );
    json!({ "name": "a program.json", "text": text })
}

pub(crate) const TO_60: &str =
    r#"{ "type": "ptp", "joints_deg": [60, 0, 0, 0, 0, 0, 0], "velocity_rel": 0.2 }"#;

/// Loads a program, and returns its plan.
pub(crate) fn load(address: &Address, page: &mut Page, program: &Value) -> Value {
    let before = page.wait_for("plan", |_| true)["id"].clone();
    address.load(program).unwrap();
    page.wait_for("plan", |plan| !plan.is_null() && plan["id"] != before)
}

#[test]
fn only_the_page_itself_gets_in() {
    in_real_time(|| {
        let rig = Rig::parts();
        let (twin, address) = start(&rig, &[]);
        let Address { host, token } = &address;
        let good = format!("/?token={token}");
        let own_origin = format!("http://{host}");

        let (status, page) = address.get(&good, &[("Host", host)]);
        assert_eq!(status, 200, "{page}");
        let head = page.split("\r\n\r\n").next().unwrap().to_lowercase();
        for header in
            ["cache-control: no-store", "referrer-policy: no-referrer", "frame-ancestors 'none'"]
        {
            assert!(head.contains(header), "{head}");
        }
        assert!(page.contains("</html>") && !page.contains(token.as_str()));

        let wrong = format!("/?token={}", "0".repeat(token.len()));
        for path in ["/", &wrong, "/files/plan.mcap", "/report.html", "/nothing", "/live"] {
            assert_eq!(address.get(path, &[("Host", host)]).0, 403, "{path}");
        }
        for name in ["evil.example", "evil.example:5562", "192.168.1.7"] {
            assert_eq!(address.get(&good, &[("Host", name)]).0, 403, "{name}");
        }
        for origin in ["http://evil.example", "null", "http://127.0.0.1:1"] {
            assert_eq!(
                address.get(&good, &[("Host", host), ("Origin", origin)]).0,
                403,
                "{origin}"
            );
        }
        assert_eq!(
            address.get(&format!("/files/plan.mcap?token={token}"), &[("Host", host)]).0,
            404
        );

        let live = format!("/live?token={token}");
        for (path, origin) in [
            (live.as_str(), None),
            (&live, Some("http://evil.example")),
            (&live, Some("null")),
            ("/live", Some(own_origin.as_str())),
            ("/live?token=", Some(&own_origin)),
        ] {
            assert_eq!(address.connect(path, origin).err().unwrap(), 403, "{path} from {origin:?}");
        }
        address.connect(&live, Some(&own_origin)).unwrap();

        // Other addresses of this machine are closed.
        let socket = UdpSocket::bind("0.0.0.0:0").unwrap();
        if socket.connect("192.0.2.1:9").is_ok() {
            let port: u16 = host.rsplit(':').next().unwrap().parse().unwrap();
            let elsewhere = socket.local_addr().unwrap().ip();
            if !elsewhere.is_loopback() {
                TcpStream::connect((elsewhere, port)).unwrap_err();
            }
        }
        twin.signal("INT");
        twin.end().code(0);
    });
}

#[test]
fn a_program_is_seen_sent_and_replayed() {
    in_real_time(|| {
        let rig = Rig::new();
        let options = ["--scene", "scene.json", "-o", "kept", "--io", "MediaFlange.LEDBlue"];
        let (twin, address) = start(&rig, &[&options[..], &["--ros-prefix", "left"]].concat());
        let mut page = address.page();

        // State of the robot.
        let health = page.wait_for("health", |health| !health["io"][0].is_null());
        assert_eq!(health["status"]["fri"]["session"], "monitoring_ready");
        assert_eq!(health["sensors"]["joint_temperature_c"].as_array().unwrap().len(), 7);
        assert_eq!(
            health["io"],
            json!([{
                "name": "MediaFlange.LEDBlue",
                "direction": "output",
                "value": false,
                "error": null
            }])
        );
        page.order("set_io", json!({ "name": "MediaFlange.LEDBlue", "value": true })).unwrap();
        page.wait_for("health", |health| health["io"][0]["value"] == true);
        let refused =
            page.order("set_io", json!({ "name": "MediaFlange.UserButton", "value": true }));
        assert!(refused.unwrap_err().contains("MediaFlange.UserButton"));

        // Position and clearance.
        let live = page.wait_for("live", |live| live["joints_rad"][0].is_number());
        assert_eq!(live["nearest"]["other"], "table");
        assert!(live["behind_ms"].as_f64().unwrap() >= 0.0);
        assert!(page.count("live", Duration::from_secs(2)) > 60);

        // Plan.
        let plan = load(&address, &mut page, &program(TO_60));
        assert_eq!((plan["name"].as_str(), plan["motions"].as_u64()), (Some("a_program"), Some(1)));
        assert_eq!(plan["refused"], Value::Null);
        assert!(plan["nearest"]["distance_mm"].as_f64().unwrap() > 10.0);
        let cycle_time_s = plan["cycle_time_s"].as_f64().unwrap();

        // Run.
        page.order("send", json!({ "plan": plan["id"], "move_to_start": false })).unwrap();
        page.wait_for("run", |run| run["phase"] == "running");
        let under_way = [
            ("send", json!({ "plan": plan["id"], "move_to_start": false })),
            ("clear_program", json!({})),
        ];
        for (order, parameters) in under_way {
            assert!(page.order(order, parameters).unwrap_err().contains("a run is under way"));
        }
        assert!(address.load(&program(TO_60)).unwrap_err().contains("a run is under way"));
        page.wait_for("live", |live| live["joints_rad"][0].as_f64() > Some(0.5));
        let run = page.wait_for("run", |run| run["phase"] == "done");
        assert!((run["cycle_time_s"].as_f64().unwrap() - cycle_time_s).abs() < 0.02, "{run}");
        assert_eq!(run["sketch"]["arms"].as_array().unwrap().len(), 2);
        let off_mm = run["sketch"]["compared"]["tcp_deviation"]["max_mm"].as_f64().unwrap();
        assert!(off_mm < 0.1, "{off_mm}");

        // A page opened later shows the same.
        let mut other = address.page();
        assert_eq!(other.wait_for("run", |run| run["phase"] == "done"), run);
        other.wait_for("plan", |other| other["id"] == plan["id"]);

        // Recorded files.
        let measured = Recording::from_bytes(&address.file("files/measured.mcap")).unwrap();
        assert!((measured.joint_states.last().unwrap().q[0].to_degrees() - 60.0).abs() < 1e-3);
        let with_torques = measured.joint_states.iter().filter(|it| it.torques_nm.is_some());
        assert!(2 * with_torques.count() > measured.joint_states.len());
        let planned = Recording::from_bytes(&address.file("files/plan.mcap")).unwrap();
        for recording in [measured, planned] {
            assert_eq!(&*recording.tcp_poses[0].frame_id, "left_link_0");
        }
        assert_eq!(
            address.file("files/program.json"),
            program(TO_60)["text"].as_str().unwrap().as_bytes()
        );
        let report = String::from_utf8(address.file("report.html")).unwrap();
        assert!(report.contains("a_program.mcap and a_program.measured.mcap"));
        for file in ["a_program.json", "a_program.mcap", "a_program.measured.mcap"] {
            assert!(rig.path("kept").join(file).is_file(), "{file}");
        }

        // The arm is now elsewhere.
        let again = page.order("send", json!({ "plan": plan["id"], "move_to_start": false }));
        assert!(
            again.unwrap_err().contains("not at the program's start: joint A1 is at 60.000 deg")
        );
        page.order("send", json!({ "plan": plan["id"], "move_to_start": true })).unwrap();
        page.wait_for("run", |run| run["phase"] == "to_start");
        page.wait_for("run", |run| run["phase"] == "done");
        assert!(rig.path("kept/a_program.measured-2.mcap").is_file());
        twin.signal("INT");
        twin.end().code(0);
    });
}

#[test]
fn nothing_can_be_sent_after_a_broken_file() {
    in_real_time(|| {
        let rig = Rig::new();
        let (_twin, address) = start(&rig, &[]);
        let mut page = address.page();
        let plan = load(&address, &mut page, &program(TO_60));
        assert_eq!(plan["warnings"], json!([]));
        address.load(&json!({ "name": "broken.json", "text": "{" })).unwrap_err();
        page.wait_for("plan", Value::is_null);
        let send = json!({ "plan": plan["id"], "move_to_start": false });
        let why = page.order("send", send).unwrap_err();
        assert!(why.contains("not the plan that is shown"), "{why}");
        // Warnings are shown.
        let odd = json!({ "name": "odd.json", "text": ODD });
        let plan = load(&address, &mut page, &odd);
        let warnings = plan["warnings"].as_array().unwrap();
        assert!(warnings[0].as_str().unwrap().contains("turn"), "{plan}");
    });
}

/// Target with a turn that differs from that of its joint positions.
const ODD: &str = r#"{ "version": 1, "start": { "joints_deg": [0, 30, 0, -60, 0, 90, 0] },
    "motions": [{ "type": "ptp", "frame": { "x_mm": 500, "y_mm": 100, "z_mm": 400,
        "a_deg": 0, "b_deg": 180, "c_deg": 0, "e1_deg": 0, "status": 2, "turn": 127 } }] }"#;

#[test]
fn invalid_programs_are_not_sent() {
    in_real_time(|| {
        let rig = Rig::new();
        let (_twin, address) = start(&rig, &["--scene", "scene.json", "--min-clearance", "0"]);
        let mut page = address.page();
        page.wait_for("live", |live| live["joints_rad"][0].is_number());
        let mut refused = |order: &str, parameters: Value, why: &str| {
            let error = page.order(order, parameters).unwrap_err();
            assert!(error.contains(why), "{error}");
        };
        refused("send", json!({ "plan": 1, "move_to_start": false }), "not the plan that is shown");
        let not_planned = |program: Value, why: &str| {
            let error = address.load(&program).unwrap_err();
            assert!(error.contains(why), "{error}");
        };
        not_planned(
            json!({ "name": "bad.json", "text": "{\n  \"version\": 1,\n  oops" }),
            "bad.json, line 3, column 3",
        );
        not_planned(json!({ "name": "", "text": "" }), "line 1");
        let outside = r#"{ "type": "ptp", "joints_deg": [600, 0, 0, 0, 0, 0, 0] }"#;
        not_planned(program(outside), "joint A1");
        let robot = |name: &str| {
            let mut other = program(TO_60);
            let text = other["text"].as_str().unwrap();
            let text = text.replacen("1,", &format!("1, \"robot\": \"{name}\","), 1);
            other["text"] = json!(text);
            other
        };
        not_planned(
            robot("lbr_iiwa_14_r820"),
            "for the robot `lbr_iiwa_14_r820`; the twin was started for `lbr_iiwa_7_r800`",
        );
        // The error does not reveal the content of a file.
        let secret = address.load(&robot("/etc/passwd")).unwrap_err();
        assert!(
            secret.contains("for the robot `/etc/passwd`") && !secret.contains("root:"),
            "{secret}"
        );
        let long = json!({ "name": "long.json", "text": " ".repeat(5 << 20) });
        not_planned(long, "longer than 4 MiB");
        // Half a turn at a millionth of the speed.
        let slow =
            r#"{ "type": "ptp", "joints_deg": [160, 0, 0, 0, 0, 0, 0], "velocity_rel": 1e-6 }"#;
        not_planned(program(slow), "the program takes 18 days");
        // Motion down to the table.
        let down = r#"{ "type": "ptp", "joints_deg": [0, 115, 0, 0, 0, 0, 0] }"#;
        let plan = load(&address, &mut page, &program(down));
        let why = plan["refused"].as_str().unwrap();
        assert!(why.contains("touches table at"), "{why}");
        let why =
            page.order("send", json!({ "plan": plan["id"], "move_to_start": true })).unwrap_err();
        assert!(why.starts_with("the program is not sent: "), "{why}");
        // Not the displayed plan.
        let newer = load(&address, &mut page, &program(TO_60));
        page.order("send", json!({ "plan": plan["id"], "move_to_start": false })).unwrap_err();
        // Invalid requests do no harm.
        for text in ["", "[]", "{\"id\": 1}", "\u{0}"] {
            page.send_text(text);
            assert!(page.refusal().contains("not a valid request"));
        }
        page.order("send", json!({ "plan": newer["id"], "move_to_start": false })).unwrap();
        page.wait_for("run", |run| run["phase"] == "running");
        page.order("stop", json!({})).unwrap();
        let run = page.wait_for("run", |run| run["phase"] == "failed");
        assert!(run["error"].as_str().unwrap().contains("stopped on request"), "{run}");
        assert_eq!(run["sketch"]["arms"].as_array().unwrap().len(), 2);
    });
}

#[test]
fn nothing_is_sent_to_another_robot() {
    in_real_time(|| {
        let rig = Rig::new();
        let profile = r#"{ "version": 1, "name": "cell 3", "lengths_mm": { "flange": 126 } }"#;
        fs::write(rig.path("cell-3.json"), profile).unwrap();
        let robots = [
            ("lbr_iiwa_14_r820", "lbr_iiwa_14_r820 with a flange of 152 mm"),
            ("cell-3.json", "cell 3 with a flange of 126 mm"),
        ];
        for (robot, name) in robots {
            let (_twin, address) = start(&rig, &["--robot", robot]);
            let mut page = address.page();
            page.wait_for("live", |live| live["joints_rad"][0].is_number());
            let plan = load(&address, &mut page, &program(TO_60));
            let order = json!({ "plan": plan["id"], "move_to_start": false });
            page.order("send", order).unwrap();
            let run = page.wait_for("run", |run| run["phase"] == "failed");
            let why = run["error"].as_str().unwrap();
            assert!(why.contains(name), "{why}");
            assert!(why.contains("lbr_iiwa_7_r800 with a flange of 152 mm"), "{why}");
            let why = page.order("jog", json!({ "joint": 1, "step_deg": 5 })).unwrap_err();
            assert!(why.contains(name), "{why}");
        }
        assert_eq!(rig.joint_1(), 0.0, "the arm has moved");
    });
}

#[test]
fn a_way_to_the_start_that_is_too_near_is_not_taken() {
    in_real_time(|| {
        let mut rig = Rig::parts();
        // Slightly above the table on one side; the program starts upright and clear of the table,
        // except for joint 1.
        rig.start_cabinet(&["--start-deg", "-60,88,0,0,0,0,0"]);
        rig.start_drive(&[]);
        rig.wait_until_ready(&[]);
        fs::write(
            rig.path("wall.json"),
            r#"{ "version": 1, "obstacles": [
        { "name": "post", "type": "box", "center_mm": [700, 0, 400], "size_mm": [60, 60, 2000] }
    ] }"#,
        )
        .unwrap();
        let (_twin, address) = start(&rig, &["--scene", "wall.json"]);
        let mut page = address.page();
        page.wait_for("live", |live| live["joints_rad"][0].is_number());
        // From one side of the post to the other.
        let text = r#"{ "version": 1, "start": { "joints_deg": [60, 88, 0, 0, 0, 0, 0] },
            "motions": [{ "type": "ptp", "joints_deg": [70, 88, 0, 0, 0, 0, 0] }] }"#;
        let plan = load(&address, &mut page, &json!({ "name": "p.json", "text": text }));
        assert_eq!(plan["refused"], Value::Null);
        let why =
            page.order("send", json!({ "plan": plan["id"], "move_to_start": true })).unwrap_err();
        assert!(why.starts_with("the robot does not move to the program's start: link "), "{why}");
        assert!((rig.joint_1().to_degrees() + 60.0).abs() < 1e-3);
    });
}

#[test]
fn a_drive_that_goes_and_comes_back_is_found_again() {
    in_real_time(|| {
        let mut rig = Rig::new();
        let (twin, address) = start(&rig, &[]);
        let mut page = address.page();
        page.wait_for("live", |live| live["joints_rad"][0].is_number());
        for _ in 0..2 {
            rig.drive.take().unwrap().signal("KILL");
            let health = page.wait_for("health", |health| health["error"].is_string());
            assert_eq!((&health["status"], &health["sensors"]), (&Value::Null, &Value::Null));
            // Before the last position is outdated, it can still be saved.
            thread::sleep(Duration::from_millis(1100));
            let refused = page.order("save_position", json!({ "name": "" })).unwrap_err();
            assert!(refused.contains("position of the robot is unknown"), "{refused}");
            let stamp = page.wait_for("live", |_| true)["at_ms"].as_f64();
            rig.start_drive(&[]);
            page.wait_for("health", |health| {
                health["status"]["fri"]["session"] == "monitoring_ready"
            });
            page.wait_for("live", |live| live["at_ms"].as_f64() > stamp);
            page.order("save_position", json!({ "name": "" })).unwrap();
        }
        twin.signal("INT");
        twin.end().code(0);
    });
}

#[test]
fn an_interrupt_stops_a_run_that_was_begun_here() {
    in_real_time(|| {
        let rig = Rig::new();
        let (twin, address) = start(&rig, &[]);
        let mut page = address.page();
        page.wait_for("live", |live| live["joints_rad"][0].is_number());
        let plan = load(&address, &mut page, &program(TO_60));
        page.order("send", json!({ "plan": plan["id"], "move_to_start": false })).unwrap();
        page.wait_for("live", |live| live["joints_rad"][0].as_f64() > Some(0.1));
        twin.signal("INT");
        twin.end().code(0);
        wait_for("idle", || rig.json("status", &[])["state"] == "idle");
        assert!(rig.joint_1() < 1.0);
    });
}

#[test]
fn no_file_is_replaced() {
    in_real_time(|| {
        let rig = Rig::parts();
        fs::create_dir(rig.path("kept")).unwrap();
        fs::write(rig.path("kept/a_program.mcap"), "precious").unwrap();
        let (_twin, address) = start(&rig, &["-o", "kept"]);
        let mut page = address.page();
        assert_eq!(load(&address, &mut page, &program(TO_60))["name"], "a_program-2");
        assert_eq!(fs::read(rig.path("kept/a_program.mcap")).unwrap(), b"precious");
        // Also for names that are long in bytes.
        let mut long = program(TO_60);
        long["name"] = json!(format!("{}.json", "\u{20000}".repeat(80)));
        load(&address, &mut page, &long);
    });
}

#[test]
fn folders_that_are_not_kept_go() {
    in_real_time(|| {
        let rig = Rig::parts();
        let folders = || {
            let entries = fs::read_dir(rig.path("tmp")).unwrap();
            entries.map(|entry| entry.unwrap().file_name()).collect::<Vec<_>>()
        };
        let start = || {
            let shell = "mkdir -p tmp && export TMPDIR=\"$PWD/tmp\"";
            let twin = rig.begin_in(shell, "twin", &["--port", "0"]);
            let address = Address::of(&twin);
            (twin, address)
        };
        let (killed, _) = start();
        let left = folders();
        assert_eq!(left.len(), 1);
        killed.signal("KILL");
        killed.end();
        assert_eq!(folders(), left);
        // The next twin removes the leftover, but not the folder of a running one.
        let (twin, address) = start();
        let used = folders();
        assert!(used.len() == 1 && used != left);
        address.load(&program(TO_60)).unwrap();
        let (other, _) = start();
        assert_eq!(folders().len(), 2);
        assert_eq!(
            address.file("files/program.json"),
            program(TO_60)["text"].as_str().unwrap().as_bytes()
        );
        for twin in [twin, other] {
            twin.signal("INT");
            twin.end().code(0);
        }
        assert_eq!(folders().len(), 0);
    });
}

#[test]
fn robots_that_cannot_be_followed_are_reported() {
    in_real_time(|| {
        let rig = Rig::parts();
        let assert_error = |options: &[&str], code, why: &str| {
            let ended = rig.begin("twin", options).end().code(code);
            assert!(ended.stderr.contains(why), "{}", ended.stderr);
        };
        fs::write(
            rig.path("bad.json"),
            r#"{ "version": 1, "obstacles": [{ "name": "a", "type": "ball" }] }"#,
        )
        .unwrap();
        assert_error(&["--port", "0", "--scene", "bad.json"], 2, "line 1");
        assert_error(&["--port", "0", "--scene", "none.json"], 2, "none.json");
        assert_error(&["--port", "0", "--robot", "none"], 2, "no robot is called `none`");
        let (twin, address) = start(&rig, &[]);
        let port = address.host.rsplit(':').next().unwrap().to_owned();
        assert_error(&["--port", &port], 1, "cannot listen at port");
        // Without a drive, the page shows this error.
        let health = address.page().wait_for("health", |health| health["error"].is_string());
        assert!(health["error"].as_str().unwrap().contains("no drive answers at tcp://127.0.0.1:"));
        twin.signal("INT");
        twin.end().code(0);
    });
}

#[test]
fn viewers_see_the_robot() {
    in_real_time(|| {
        let rig = Rig::new();
        let (twin, _) = start(&rig, &["--foxglove=127.0.0.1:0"]);
        wait_for("address", || {
            twin.stderr().contains("open ws://") && twin.stderr().ends_with('\n')
        });
        let stderr = twin.stderr();
        let address = stderr.split_whitespace().find(|word| word.starts_with("ws://")).unwrap();
        let Some(viewer) = rig.script("tests/foxglove/check.py", &[address, "--messages", "50"])
        else {
            return;
        };
        let program = rig.slow_program();
        rig.iiwasim("run", &[program, "--no-output"]).success();
        viewer.end().code(0);
        twin.signal("INT");
        twin.end().code(0);
    });
}
