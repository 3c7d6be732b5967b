//! `iiwasim import` as a process.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use std::{fs, path::Path};

use crate::run::{files, iiwasim};
use iiwa_kin::Robot;
use iiwa_program::{Frame, Workcell};
use predicates::{
    prelude::PredicateBooleanExt,
    str::{contains, is_empty},
};
use serde_json::Value;
use tempfile::{TempDir, tempdir};

const JOINTS_DEG: [f64; 7] = [10.0, 40.0, -15.0, -70.0, 20.0, 60.0, -30.0];

/// Returns a project with a bench, a frame on it that was taught on `device`, and a tool.
fn project(robot: &Robot, device: &str) -> String {
    taught_at(JOINTS_DEG, robot, device)
}

fn taught_at(joints_deg: [f64; 7], robot: &Robot, device: &str) -> String {
    let joints = joints_deg.map(f64::to_radians);
    let flange = robot.flange_pose(&joints);
    let bench = Frame { xyz_mm: [300.0, 0.0, 100.0], abc_rad: [0.5, 0.0, 0.0] };
    let tcp = Frame { xyz_mm: [0.0, 0.0, 150.0], abc_rad: [0.0; 3] };
    let target_frame = Frame::from(&bench.pose().inverse().then(&flange.then(&tcp.pose())));
    let redundancy = robot.redundancy(&joints);
    let pose = |name: &str, frame: &Frame| {
        let Frame { xyz_mm: [x, y, z], abc_rad: [a, b, c] } = frame;
        format!(r#"<{name} a="{a}" b="{b}" c="{c}" x="{x}" y="{y}" z="{z}"/>"#)
    };
    format!(
        r#"<?xml version="1.0" encoding="UTF-8"?>
<RoboticsAPIData version="3">
  <world>
    <gravitation x="0.0" y="0.0" z="9.81"/>
    <frame name="Bench">
      {}
      <frame name="Pick">
        {}
        <additionalInformation>
          <info device="{device}" tcpName="Hand/TCP" type="a.TeachInformation">{}</info>
        </additionalInformation>
        <redundancyData>
          <redundancy transformationProviderName="Cabinet/{device}" type="a.LBRE1Redundancy">
            <info type="a$StatusParameter" value="{}"/><info type="a$TurnParameter" value="{}"/>
            <info type="a$E1Parameter" value="{}"/>
          </redundancy>
        </redundancyData>
      </frame>
    </frame>
  </world>
  <objectTemplates>
    <toolTemplate name="Hand">
      <frames><frame name="TCP">{}</frame></frames>
      <loadData mass="0.8"/>
    </toolTemplate>
    <workpieceTemplate name="Nut"/>
  </objectTemplates>
</RoboticsAPIData>
"#,
        pose("transformation", &bench),
        pose("transformation", &target_frame),
        pose("tcpTransformation", &tcp),
        redundancy.status,
        redundancy.turn,
        redundancy.e1_rad,
        pose("transformation", &tcp),
    )
}

fn default_project() -> String {
    project(&Robot::default(), "LBR_iiwa_7_R800_1")
}

fn put(folder: &TempDir, path: &str, text: &str) {
    let path = folder.path().join(path);
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    fs::write(path, text).unwrap();
}

const DATA: &str = "RoboticsAPI.data.xml";

#[test]
fn a_program_uses_the_imported_cell() {
    let folder = tempdir().unwrap();
    put(&folder, DATA, &default_project());
    iiwasim(&folder, &["import", DATA, "-o", "cell.json"])
        .success()
        .stdout(contains("1 tool, 1 base, 1 frame from RoboticsAPI.data.xml"))
        .stdout(contains("Bench/Pick").and(contains("agrees")).and(contains("workpieceTemplate")))
        .stdout(
            contains("1 of 1 taught frames agree with lbr_iiwa_7_r800")
                .and(contains("Frames in cell.json")),
        )
        .stderr(is_empty());
    assert_eq!(files(&folder), [DATA, "cell.json"]);
    let cell = fs::read_to_string(folder.path().join("cell.json")).unwrap();
    let cell = Workcell::from_json(&cell).unwrap();
    assert_eq!(cell.tools["Hand"].load.as_ref().unwrap().load.mass_kg, 0.8);

    put(
        &folder,
        "program.json",
        r#"{ "version": 1, "include": "cell.json", "tool": "Hand", "base": "Bench",
             "start": { "joints_deg": [0, 30, 0, -60, 0, 90, 0] },
             "motions": [{ "type": "ptp", "frame": "Bench/Pick" },
                         { "type": "lin_rel", "offset": { "z_mm": -30 } }] }"#,
    );
    iiwasim(&folder, &["plan", "program.json", "--no-output"]).success().stderr(is_empty());
    let ik = ["ik", "--json", "--program", "cell.json", "--tool", "Hand", "--frame", "Bench/Pick"];
    let output = iiwasim(&folder, &ik).success().stderr(is_empty());
    let actual: Value = serde_json::from_slice(&output.get_output().stdout).unwrap();
    for (joint, taught) in JOINTS_DEG.into_iter().enumerate() {
        assert!((actual["joints_deg"][joint].as_f64().unwrap() - taught).abs() < 1e-9, "{actual}");
    }
}

#[test]
fn as_json_it_has_the_joints() {
    let folder = tempdir().unwrap();
    put(&folder, DATA, &default_project());
    let report = iiwasim(&folder, &["import", DATA, "--json"]).success();
    let report: Value = serde_json::from_slice(&report.get_output().stdout).unwrap();
    assert_eq!(report["output"], "frames.json");
    assert_eq!((&report["taught"], &report["agreeing"]), (&1.into(), &1.into()));
    let [bench, pick] = [0, 1].map(|index| &report["frames"][index]);
    assert_eq!((&bench["name"], &bench["agrees"]), (&"Bench".into(), &Value::Null));
    assert_eq!((&pick["path"], &pick["name"]), (&"/Bench/Pick".into(), &"Bench/Pick".into()));
    assert_eq!((&pick["tool"], &pick["agrees"]), (&"Hand".into(), &true.into()));
    let a4 = pick["joints_deg"][3].as_f64().unwrap();
    assert!((a4 + 70.0).abs() < 1e-9, "{pick}");
    let kinds = report["not_taken"].as_array().unwrap();
    assert!(kinds.iter().any(|kind| kind["what"] == "workpieceTemplate" && kind["count"] == 1));
}

#[test]
fn a_folder_stands_for_the_file_in_it() {
    let text = default_project();
    let find = |paths: &[&str]| {
        let folder = tempdir().unwrap();
        for path in paths {
            put(&folder, &format!("project/{path}"), &text);
        }
        fs::create_dir_all(folder.path().join("project/docs")).unwrap();
        let result = iiwasim(&folder, &["import", "project", "--no-output"]);
        assert_eq!(files(&folder), ["project"]);
        result
    };
    for (paths, taken) in [
        (&["RoboticsAPI.data.xml"][..], "project/RoboticsAPI.data.xml"),
        (&["src/RoboticsAPI.data.xml"], "project/src/RoboticsAPI.data.xml"),
        (&["cell/src/RoboticsAPI.data.xml"], "project/cell/src/RoboticsAPI.data.xml"),
        (&["bin/RoboticsAPI.data.xml", "src/RoboticsAPI.data.xml"], "project/src/Robotics"),
        (&["RoboticsAPI.data.xml", "src/RoboticsAPI.data.xml"], "project/RoboticsAPI.data.xml"),
    ] {
        find(paths).success().stdout(contains(Path::new(taken).to_str().unwrap()));
    }
    find(&["a/src/RoboticsAPI.data.xml", "b/src/RoboticsAPI.data.xml"])
        .code(2)
        .stderr(contains("several projects"));
    find(&["a/b/c/RoboticsAPI.data.xml"]).code(2).stderr(contains("is not a Sunrise project"));
}

#[test]
fn nothing_is_written_on_errors() {
    let folder = tempdir().unwrap();
    let refuses = |text: &str, arguments: &[&str], reason: &str| {
        put(&folder, DATA, text);
        let refused = iiwasim(&folder, &[&["import", DATA], arguments].concat()).code(2);
        let stderr = String::from_utf8_lossy(&refused.get_output().stderr).replace("\n  │ ", " ");
        assert!(stderr.contains(reason), "no {reason:?} in {stderr}");
        assert_eq!(files(&folder), [DATA]);
        assert_eq!(fs::read_to_string(folder.path().join(DATA)).unwrap(), text);
    };
    let text = default_project();
    refuses(&text.replace("</world>", ""), &[], "RoboticsAPI.data.xml, line ");
    refuses(&text.replace("z=\"100\"", "z=\"high\""), &[], "line 6, column 7: z is \"high\"");
    refuses("<RoboticsAPIData version=\"3\"/>", &[], "neither frames nor tools");
    refuses(&text, &["--robot", "puma"], "no robot is called `puma`");
    refuses(&text, &["-o", DATA], "would be written over the project");
    iiwasim(&folder, &["import", "none.xml"]).code(2).stderr(contains("cannot read none.xml"));
}

#[test]
fn frames_of_another_robot_or_flange_are_noticed() {
    let folder = tempdir().unwrap();
    let taught_on = Robot::lbr_iiwa_14_r820();
    put(&folder, DATA, &project(&taught_on, "LBR_iiwa_14_R820_1"));
    iiwasim(&folder, &["import", DATA, "--no-output"])
        .success()
        .stderr(contains("--robot lbr_iiwa_14_r820 checks them"));
    iiwasim(&folder, &["import", DATA, "--no-output", "--robot", "lbr_iiwa_14_r820"])
        .success()
        .stdout(contains("1 of 1 taught frames agree"))
        .stderr(is_empty());

    // A1 is so near to zero that the flange length determines its sign.
    let iiwa = Robot::default();
    let other_m = if iiwa.lengths().flange_m > 0.14 { 0.126 } else { 0.152 };
    let taught_on = iiwa.with_flange_m(other_m).unwrap();
    let noticed = [1.0, -1.0].map(|a1_deg| {
        let joints_deg = [a1_deg, 40.0, -15.0, -70.0, 70.0, 80.0, -30.0];
        put(&folder, DATA, &taught_at(joints_deg, &taught_on, "LBR_iiwa_7_R800_1"));
        let result = iiwasim(&folder, &["import", DATA, "--no-output"]).success();
        let stdout = String::from_utf8_lossy(&result.get_output().stdout).into_owned();
        let is_noticed = stdout.contains("0 of 1 taught frames agree");
        let hint =
            format!("With a flange of {:.0} mm (wrist to face), 1 would agree", 1e3 * other_m);
        assert_eq!(stdout.contains(&hint), is_noticed, "{stdout}");
        is_noticed
    });
    assert!(noticed.contains(&true));
}
