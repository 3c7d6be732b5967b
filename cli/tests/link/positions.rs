//! Saved positions and jogging in `iiwasim twin`.

use std::fs;

use iiwa_log::Recording;
use iiwasim_tests::realtime_guard::in_real_time;
use serde_json::{Value, json};

use crate::link::{
    page::Page,
    rig::Rig,
    twin::{TO_60, load, program, start},
};

#[test]
fn positions_become_a_program() {
    in_real_time(|| {
        let rig = Rig::new();
        let (twin, address) = start(&rig, &[]);
        let mut page = address.page();
        page.wait_for("live", |live| live["joints_rad"][0].is_number());
        let making = json!({ "velocity_percent": 50, "blend_mm": 20 });
        let refused = page.order("make_program", making.clone()).unwrap_err();
        assert!(refused.contains("needs at least two positions"), "{refused}");
        page.order("save_position", json!({ "name": "" })).unwrap();
        rig.iiwasim("run", &[rig.slow_program(), "--no-output"]).success();
        page.wait_for("live", |live| live["joints_rad"][0].as_f64() > Some(1.04));
        // For the outstretched arm, no frame leads back to its joint positions.
        for (joint, step_deg) in [(2, 30), (4, -45), (6, 40)] {
            page.order("jog", json!({ "joint": joint, "step_deg": step_deg })).unwrap();
        }
        page.wait_for("live", |live| live["joints_rad"][5].as_f64() > Some(0.69));
        page.order("save_position", json!({ "name": "<b>there</b>" })).unwrap();
        page.order("save_position", json!({ "name": "too much" })).unwrap();
        let names = |page: &mut Page, expected: &[&str]| {
            page.wait_for("positions", |all| {
                let names = all.as_array().unwrap().iter().map(|it| it["name"].as_str().unwrap());
                names.eq(expected.iter().copied())
            })
        };
        let all = names(&mut page, &["P1", "<b>there</b>", "too much"]);
        // Names are unique and not empty.
        for (order, name) in
            [("save_position", "P1"), ("rename_position", "P1"), ("rename_position", " ")]
        {
            let wrong = json!({ "position": all[2]["id"], "name": name });
            let why = page.order(order, wrong).unwrap_err();
            assert!(why.contains("name"), "{why}");
        }
        let parameters = json!({ "position": all[2]["id"], "name": " too much " });
        page.order("rename_position", parameters).unwrap();
        for (by, expected) in [
            (-1, ["P1", "too much", "<b>there</b>"]),
            (-5, ["too much", "P1", "<b>there</b>"]),
            (9, ["P1", "<b>there</b>", "too much"]),
        ] {
            page.order("move_position", json!({ "position": all[2]["id"], "by": by })).unwrap();
            names(&mut page, &expected);
        }
        for _ in 0..2 {
            page.order("remove_position", json!({ "position": all[2]["id"] })).unwrap();
        }
        page.order("rename_position", json!({ "position": all[0]["id"], "name": "home" })).unwrap();
        names(&mut page, &["home", "<b>there</b>"]);
        for wrong in [
            json!({ "velocity_percent": 0, "blend_mm": 0 }),
            json!({ "velocity_percent": 50, "blend_mm": -1 }),
        ] {
            page.order("make_program", wrong).unwrap_err();
        }
        page.order("make_program", making).unwrap();
        let plan = page.wait_for("plan", |plan| plan["name"] == "positions");
        assert_eq!(plan["motions"], 1);
        let text = String::from_utf8(address.file("files/program.json")).unwrap();
        // Targets have the names of the positions.
        let made: Value = serde_json::from_str(&text).unwrap();
        assert_eq!(made["motions"][0]["frame"], "<b>there</b>", "{text}");
        let frame = &made["frames"]["<b>there</b>"];
        assert!(frame["status"].is_number() && frame["e1_rad"].is_number(), "{text}");
        // `iiwasim plan` accepts the program.
        fs::write(rig.path("made.json"), text).unwrap();
        assert_eq!(
            rig.start(&["plan", "made.json", "-o", "made.mcap"]).end().status.code(),
            Some(0)
        );
        let planned = Recording::from_bytes(&fs::read(rig.path("made.mcap")).unwrap()).unwrap();
        let end_deg = planned.joint_states.last().unwrap().q[0].to_degrees();
        assert!((end_deg - 60.0).abs() < 1e-3, "{end_deg}");
        twin.signal("INT");
        twin.end().code(0);

        // The next twin has the positions in the same order.
        let (twin, address) = start(&rig, &[]);
        names(&mut address.page(), &["home", "<b>there</b>"]);
        twin.signal("INT");
        twin.end().code(0);
        let kept = fs::read_to_string(rig.path("positions.json")).unwrap();
        for (from, to, why) in [
            ("\"version\": 1", "\"version\": 2", "version 1 is understood"),
            ("lbr_iiwa_7_r800", "lbr_iiwa_14_r820", "but the twin follows lbr_iiwa_7_r800"),
            ("\"home\"", "\"<b>there</b>\"", "there is a position"),
            ("\"name\"", "\"names\"", "did you mean `name`?"),
            ("{", "", "line 2"),
        ] {
            fs::write(rig.path("positions.json"), kept.replacen(from, to, 1)).unwrap();
            let ended = rig.begin("twin", &["--port", "0"]).end().code(2);
            assert!(ended.stderr.contains(why), "{}", ended.stderr);
        }
        // A change that cannot be written does not take effect.
        fs::write(rig.path("positions.json"), &kept).unwrap();
        let (_twin, address) = start(&rig, &[]);
        let mut page = address.page();
        page.wait_for("live", |live| live["joints_rad"][0].is_number());
        fs::remove_file(rig.path("positions.json")).unwrap();
        fs::create_dir(rig.path("positions.json")).unwrap();
        let why = page.order("save_position", json!({ "name": "lost" })).unwrap_err();
        assert!(why.contains("positions.json"), "{why}");
        names(&mut page, &["home", "<b>there</b>"]);
    });
}

#[test]
fn a_simulated_robot_is_turned_joint_by_joint() {
    in_real_time(|| {
        let rig = Rig::new();
        let (_twin, address) = start(&rig, &["--scene", "scene.json"]);
        let mut page = address.page();
        let health = page.wait_for("health", |health| health["status"]["state"] == "idle");
        assert_eq!(health["status"]["simulated"], true);
        let before = page.wait_for("live", |live| live["joints_rad"][0].is_number());
        page.order("jog", json!({ "joint": 3, "step_deg": 5 })).unwrap();
        page.order("jog", json!({ "joint": 1, "step_deg": -2.5 })).unwrap();
        let turned = |live: &Value, joint: usize, deg: f64| {
            let joint_deg = |live: &Value| live["joints_rad"][joint].as_f64().unwrap().to_degrees();
            (joint_deg(live) - joint_deg(&before) - deg).abs() < 0.01
        };
        page.wait_for("live", |live| turned(live, 0, -2.5) && turned(live, 2, 5.0));
        for (joint, step_deg, why) in [
            (0, 1.0, "unknown joint 0"),
            (8, 1.0, "unknown joint 8"),
            (1, 46.0, "45 deg at most"),
            (6, 45.0, ""),
            (6, 45.0, ""),
            (6, 45.0, "A6"),
        ] {
            let turn = json!({ "joint": joint, "step_deg": step_deg });
            match page.order("jog", turn) {
                Ok(()) => assert_eq!(why, ""),
                Err(error) => assert!(!why.is_empty() && error.contains(why), "{error}"),
            }
        }
        // Jogging is rejected while a program runs.
        let plan = load(&address, &mut page, &program(TO_60));
        page.order("send", json!({ "plan": plan["id"], "move_to_start": true })).unwrap();
        let why = page.order("jog", json!({ "joint": 1, "step_deg": 1 })).unwrap_err();
        assert!(why.contains("a run is under way"), "{why}");
        page.order("stop", json!({})).unwrap();
        page.wait_for("run", |run| run["phase"] == "failed");
    });
}
