//! Plans as tables and pictures, and poses in lines.

use std::fs;

use crate::helpers::fixture;
use crate::run::{files, iiwasim};
use assert_cmd::cargo::cargo_bin_cmd;
use iiwa_log::JointLog;
use predicates::{prelude::PredicateBooleanExt, str::contains};
use serde_json::Value;
use tempfile::tempdir;

#[test]
fn tables_read_back_as_the_plan() {
    let folder = tempdir().unwrap();
    let program = fixture("pick-and-place.json").display().to_string();
    let options = ["--csv", "a.csv", "--exact", "--rate", "200", "--json", "--timing", "jerk"];
    let assert = iiwasim(&folder, &[&["plan", &program, "-o", "a.mcap"], &options[..]].concat());
    let figures: Value = serde_json::from_slice(&assert.success().get_output().stdout).unwrap();
    let read = |name: &str| JointLog::read(&*fs::read(folder.path().join(name)).unwrap()).unwrap();
    let (mcap, csv) = (read("a.mcap"), read("a.csv"));
    assert_eq!(csv.q_rad, mcap.q_rad);
    let end_s = figures["cycle_time_s"].as_f64().unwrap();
    assert!((csv.t_s.last().unwrap() - end_s).abs() < 1e-12);
    for (table, plan) in csv.t_s.iter().zip(&mcap.t_s) {
        // Stamps in the file are integer nanoseconds.
        assert!((table - plan).abs() < 1e-9);
    }
    let text = fs::read_to_string(folder.path().join("a.csv")).unwrap();
    let mut lines = text.lines();
    let head: Vec<&str> = lines.next().unwrap().split(',').collect();
    assert_eq!((head.len(), head[0], head[1], head[28]), (36, "t_s", "motion", "tcp_c_rad"));
    assert_eq!(head[29..], [1, 2, 3, 4, 5, 6, 7].map(|joint| format!("torque_{joint}_nm")));
    // Figures, MCAP file and tables contain the same torques.
    let largest = |j: usize| {
        let rows = text.lines().skip(1).map(|row| row.split(',').nth(29 + j).unwrap());
        rows.map(|nm| nm.parse::<f64>().unwrap().abs()).fold(0.0, f64::max)
    };
    let motions = figures["motions"].as_array().unwrap();
    for j in 0..7 {
        let peaks = motions.iter().map(|it| it["torque"]["peak_nm"][j].as_f64().unwrap().abs());
        let peak = peaks.fold(0.0, f64::max);
        assert!(largest(j) <= peak + 1e-9 && largest(j) > 0.9 * peak - 0.1, "A{}: {peak}", j + 1);
    }
    let states: Vec<_> = mcap.exerted_nm().map(|torques| torques.unwrap()[1]).collect();
    let rows = text.lines().skip(1).map(|row| row.split(',').nth(30).unwrap());
    assert!(rows.map(|nm| nm.parse::<f64>().unwrap()).eq(states));
    // The program's tool is 120 mm long: its TCP agrees with `fk`.
    let last: Vec<f64> =
        lines.last().unwrap().split(',').map(|field| field.parse().unwrap()).collect();
    let joints: Vec<_> = last[2..9].iter().map(f64::to_string).collect();
    let fk = iiwasim(
        &folder,
        &[
            "fk",
            "--json",
            "--program",
            &program,
            "--base",
            "robot",
            "--joints-rad",
            &joints.join(","),
        ],
    );
    let pose: Value = serde_json::from_slice(&fk.success().get_output().stdout).unwrap();
    for (axis, actual) in last[23..26].iter().enumerate() {
        assert!((pose["position_m"][axis].as_f64().unwrap() - actual).abs() < 1e-12, "{pose}");
    }
    // At rest.
    assert!(last[9..23].iter().all(|rate| rate.abs() < 1e-9));
    iiwasim(&folder, &["compare", "a.mcap", "a.csv"]).success().stdout(contains("0.00 %"));
    iiwasim(
        &folder,
        &["plan", &program, "--csv", "b.csv", "--no-output", "--max-file-size", "1kB"],
    )
    .code(2)
    .stderr(contains("--max-file-size"));
    assert_eq!(files(&folder), ["a.csv", "a.mcap"]);
}

#[test]
#[cfg(feature = "parquet")]
fn parquet_files_have_the_rows_of_the_csv_file() {
    let folder = tempdir().unwrap();
    let program = fixture("pick-and-place.json").display().to_string();
    let options = ["-o", "a.mcap", "--csv", "a.csv", "--parquet", "a.parquet", "--rate", "200"];
    iiwasim(&folder, &[&["plan", &program, "--exact"], &options[..]].concat()).success();
    let read = |name: &str| JointLog::read(&*fs::read(folder.path().join(name)).unwrap()).unwrap();
    let (csv, parquet) = (read("a.csv"), read("a.parquet"));
    assert_eq!((&csv.t_s, &csv.q_rad), (&parquet.t_s, &parquet.q_rad));
    iiwasim(&folder, &["compare", "a.mcap", "a.parquet"]).success().stdout(contains("0.00 %"));
    assert_eq!(files(&folder), ["a.csv", "a.mcap", "a.parquet"]);
    // Files of another kind are kept, and those of a plan overwritten.
    fs::write(folder.path().join("hand.txt"), "{}").unwrap();
    iiwasim(&folder, &["plan", &program, "--no-output", "--parquet", "hand.txt"])
        .code(2)
        .stderr(contains("exists and is not a").and(contains("it is kept")));
    iiwasim(&folder, &["plan", &program, "--no-output", "--parquet", "a.parquet"]).success();
}

/// By default, the numbers of a CSV table have at most nine decimals and are within half of the
/// last one of the exact numbers.
#[test]
fn numbers_in_csv_are_rounded() {
    let folder = tempdir().unwrap();
    let program = fixture("pick-and-place.json").display().to_string();
    let table = |name: &str, options: &[&str]| {
        let arguments = ["plan", &program, "--no-output", "--csv", name];
        iiwasim(&folder, &[&arguments[..], options].concat()).success();
        fs::read_to_string(folder.path().join(name)).unwrap()
    };
    let [rounded, exact] = [table("a.csv", &[]), table("b.csv", &["--exact"])];
    assert!(3 * rounded.len() < 2 * exact.len());
    assert_eq!(rounded.lines().next(), exact.lines().next());
    let fields = |text: &str| -> Vec<String> {
        text.lines().skip(1).flat_map(|line| line.split(',')).map(str::to_owned).collect()
    };
    let [rounded, exact] = [fields(&rounded), fields(&exact)];
    assert_eq!(rounded.len(), exact.len());
    for (rounded, exact) in rounded.iter().zip(&exact) {
        let decimals = rounded.split_once('.').map_or(0, |(_, decimals)| decimals.len());
        assert!(rounded.contains('e') || decimals <= 9, "{rounded}");
        assert_ne!(rounded, "-0.0");
        let [near, value] = [rounded, exact].map(|text| text.parse::<f64>().unwrap());
        assert!((near - value).abs() <= 0.5001e-9 + 1e-15 * value.abs(), "{rounded}, {exact}");
    }
    iiwasim(&folder, &["plan", &program, "--exact"]).code(2).stderr(contains("--csv"));
}

#[test]
fn pictures_have_the_format_of_their_extension() {
    let folder = tempdir().unwrap();
    let program = fixture("appendix-b.json").display().to_string();
    let draw = |name: &str| iiwasim(&folder, &["plan", &program, "--no-output", "--picture", name]);
    draw("a.svg").success();
    assert!(fs::read(folder.path().join("a.svg")).unwrap().starts_with(b"<svg"));
    #[cfg(feature = "pictures")]
    for (name, magic) in [("a.png", &b"\x89PNG"[..]), ("a.PDF", b"%PDF")] {
        let assert = draw(name);
        if assert.get_output().status.success() {
            assert!(fs::read(folder.path().join(name)).unwrap().starts_with(magic));
        } else {
            // Text needs a font.
            assert.code(1).stderr(contains("no fonts"));
        }
    }
    for name in ["a.jpg", "a", "a.json"] {
        draw(name).code(2).stderr(contains(".svg, .png or .pdf"));
        assert!(!folder.path().join(name).exists());
    }
}

fn from_stdin(arguments: &[&str], text: &str) -> assert_cmd::assert::Assert {
    cargo_bin_cmd!("iiwasim").args(arguments).write_stdin(text).assert()
}

#[test]
fn poses_go_through_in_lines() {
    let joints = "joint_1_deg,joint_2_deg,joint_3_deg,joint_4_deg,joint_5_deg,joint_6_deg,\
                  joint_7_deg\n\
                  0,30,0,-60,0,90,0\n\n-100.5,80,-30,70,-150,100,-170\n";
    let poses = from_stdin(&["fk", "--stdin"], joints).success();
    let poses = String::from_utf8(poses.get_output().stdout.clone()).unwrap();
    assert_eq!(poses.lines().count(), 3, "{poses}");
    assert!(
        poses.starts_with("x_mm,y_mm,z_mm,a_deg,b_deg,c_deg,e1_deg,status,turn,error\n"),
        "{poses}"
    );
    let back = from_stdin(&["ik", "--stdin"], &poses).success();
    let back = String::from_utf8(back.get_output().stdout.clone()).unwrap();
    let numbers = |line: &str| -> Vec<f64> {
        line.split(',').filter_map(|field| field.parse().ok()).collect()
    };
    for (asked, actual) in
        joints.lines().skip(1).filter(|line| !line.is_empty()).zip(back.lines().skip(1))
    {
        let (asked, actual) = (numbers(asked), numbers(actual));
        assert_eq!(actual.len(), 7, "{back}");
        assert!(asked.iter().zip(&actual).all(|(a, b)| (a - b).abs() < 1e-9), "{back}");
    }

    // JSON objects; processing continues after an unreachable one.
    let frame = |x_mm: u32| {
        format!(
            "{{\"x_mm\": {x_mm}, \"y_mm\": 0, \"z_mm\": 400, \"a_deg\": 0, \"b_deg\": 180, \
             \"c_deg\": 0}}\n"
        )
    };
    let frames = [600, 6000].map(frame).concat();
    let arguments = ["ik", "--stdin", "--json", "--e1-deg", "0", "--status", "2"];
    let output = from_stdin(&arguments, &frames).code(3);
    let stdout = String::from_utf8(output.get_output().stdout.clone()).unwrap();
    let lines: Vec<Value> =
        stdout.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!(lines[0]["joints_deg"].as_array().unwrap().len(), 7);
    assert!(lines[1]["error"].as_str().unwrap().contains("mm"), "{stdout}");
    output.stderr(contains("line 2").and(contains("1 of 2 frames")));

    // Processing also continues after invalid joint positions; `ik` reads the output of `fk`.
    let joints = "{\"joints_deg\": [0,30,0,-60,0,90,0]}\n{\"joints_deg\": [200,0,0,0,0,0,0]}\n\
                  {\"joints_deg\": [10,20,30,-40,50,60,70]}\n";
    let poses = from_stdin(&["fk", "--stdin", "--json"], joints).code(3);
    let poses = String::from_utf8(poses.get_output().stdout.clone()).unwrap();
    let back = from_stdin(&["ik", "--stdin", "--json"], &poses).code(3);
    let stderr = String::from_utf8_lossy(&back.get_output().stderr).into_owned();
    assert!(stderr.contains("standard input, line 2: joint A1 is at 200 deg"), "{stderr}");
    assert!(!stderr.contains("--frame"), "{stderr}");
    let back = String::from_utf8(back.get_output().stdout.clone()).unwrap();
    for (asked, actual) in joints.lines().zip(back.lines()).step_by(2) {
        let [asked, actual] =
            [asked, actual].map(|line| serde_json::from_str::<Value>(line).unwrap());
        for j in 0..7 {
            let [asked, actual] =
                [&asked, &actual].map(|object| object["joints_deg"][j].as_f64().unwrap());
            assert!((asked - actual).abs() < 1e-9, "{back}");
        }
    }
    // Numbers are printed without noise in their last digits.
    let table = from_stdin(&["fk", "--stdin"], "{\"joints_deg\": [0,30,0,-60,0,90,0]}\n").success();
    let table = String::from_utf8(table.get_output().stdout.clone()).unwrap();
    let row = table.lines().nth(1).unwrap();
    assert!(row.split(',').all(|field| field != "-0" && field.len() < 18), "{row}");

    from_stdin(&["fk", "--stdin"], "1,2,3\n")
        .code(2)
        .stderr(contains("line 1: the first line has to name the columns"));
    for (text, reason) in [
        ("{\"joints_deg\": [0]}\n", "line 1: there are 1 numbers, and seven joints"),
        ("{\"joints_deg\": [200,0,0,0,0,0,0]}\n", "line 1: joint A1"),
        ("{\"joints\": 1}\n", "line 1: there is no `joints_deg`"),
        ("{\n", "line 1: "),
    ] {
        let refused = from_stdin(&["fk", "--stdin"], text).code(3);
        let stderr = String::from_utf8_lossy(&refused.get_output().stderr).replace("\n  │", "");
        assert!(stderr.contains(reason), "{text:?}: no {reason:?} in {stderr}");
    }
}

/// Names of the joint columns, with this delimiter.
fn joint_names(delimiter: &str) -> String {
    (1..=7).map(|joint| format!("joint_{joint}_deg")).collect::<Vec<_>>().join(delimiter)
}

#[test]
fn tables_have_the_dialects_of_recordings() {
    let printed = |command: &str, text: &str| {
        let done = from_stdin(&[command, "--stdin"], text).success();
        String::from_utf8(done.get_output().stdout.clone()).unwrap()
    };
    let names = joint_names(",");
    let expected = printed("fk", &format!("{names}\n0,30,0,-60,0,90,0\n"));
    let row = expected.lines().nth(1).unwrap();
    assert!(row.starts_with("600,0,534.41"), "{row}");
    let quoted = names.replace("joint_1_deg", "\"joint_1_deg\"");
    for text in [
        format!("{}\n0;30;0;-60;0;90;0\n", joint_names(";")),
        format!("sep=;\r\n{};\r\n0;30;0;-60;0;90;0;\r\n", joint_names(";")),
        format!("{}\r0\t30\t0\t-60\t0\t90\t0\r", joint_names("\t")),
        format!("# recorded\n# {}\n0.0e+00 3.0e+01  0 -6.0e+01 0 9.0e+01 0\n", joint_names(" ")),
        format!("\u{feff}{quoted}\n\"0\",30,0,-60,\"0\",+90,0.\n# end\n"),
        format!("note,{names}\n\"a, \"\"b\"\"\",0,30,0,-60,0,90,0\n"),
        format!("{}\n0,30,0,-60,0,90,0\n", names.replace("joint_", "A")),
        format!("#\n  # by hand\n{}\n%\n0,30,0,-60,0,90,0\n", names.replace("joint_", "q0")),
    ] {
        assert_eq!(printed("fk", &text), expected, "{text}");
    }
    let rad = names.replace("_deg", "_rad").replace("joint_", "q");
    let text = printed(
        "fk",
        &format!("{rad}\n0,0.5235987755982988,0,-1.0471975511965976,0,1.5707963267948966,0\n"),
    );
    let number = |text: &str| -> f64 { text.split(',').next().unwrap().parse().unwrap() };
    assert!((number(text.lines().nth(1).unwrap()) - number(row)).abs() < 1e-9, "{text}");

    let table = "x_mm,y_mm,z_mm,a_deg,b_deg,c_deg,e1_deg,status\n600,0,400,0,180,0,0,2\n";
    let joints = printed("ik", table);
    for text in [
        table.replace(',', ";"),
        format!("#\n{table}"),
        format!("%\n  % by hand\n{table}"),
        table.replace("x_mm", "\"x_mm\"").replace("600", "\"600\""),
        table.replace("x_mm", "X_MM").replace("0,2\n", "0.000000e+00,2.000000e+00\n"),
    ] {
        assert_eq!(printed("ik", &text), joints, "{text}");
    }
    // An error of `fk` is repeated by `ik`, and does not stop it.
    let poses =
        from_stdin(&["fk", "--stdin"], &format!("{names}\n200,0,0,0,0,0,0\n0,30,0,-60,0,90,0\n"));
    let poses = String::from_utf8(poses.code(3).get_output().stdout.clone()).unwrap();
    let back = from_stdin(&["ik", "--stdin"], &poses).code(3);
    let message = String::from_utf8_lossy(&back.get_output().stderr).into_owned();
    assert!(message.contains("standard input, line 2: joint A1 is at 200 deg"), "{message}");
    let back = String::from_utf8(back.get_output().stdout.clone()).unwrap();
    let again = from_stdin(&["fk", "--stdin"], &back).code(3);
    let again = String::from_utf8(again.get_output().stdout.clone()).unwrap();
    assert!(again.lines().nth(1).unwrap().contains("joint A1 is at 200 deg"), "{again}");
    assert!((number(again.lines().nth(2).unwrap()) - number(row)).abs() < 1e-6, "{again}");
}

#[test]
fn faults_of_tables_are_named() {
    let joints = joint_names(";");
    for (command, text, code, reason) in [
        ("fk", "joint_1_deg,joint_2_deg\n1,2\n", 2, "line 1: no column `joint_3_deg`"),
        ("fk", "A1;A2;A3;A4;A5;A6;A7\n1;2;3;4;5;6;7\n", 2, "the column `A1` states no unit"),
        ("fk", "pose,name\n1,2\n", 2, "found `pose name`"),
        ("fk", "A1_deg,joint_1_deg\n1,2\n", 2, "no column `joint_2_deg`"),
        ("ik", "x,y,z,a,b,c\n1,2,3,4,5,6\n", 2, "line 1: unknown column `x`, expected `x_mm`"),
        ("ik", "x_mm,X_MM\n1,2\n", 2, "the columns `x_mm` and `X_MM` are both `x_mm`"),
        ("fk", "# A1 A2 A3 A4 A5 A6 A7\n1 2 3 4 5 6 7\n", 2, "line 1: the column `A1` states no"),
        ("ik", "600;0;400;0;180;0\n", 2, "the first line has to name the columns"),
        ("ik", "x_mm;y_mm\n600,5;0\n", 3, "`600,5` is not a number; it needs a decimal point"),
        (
            "ik",
            "x_mm,y_mm\n600,5,0,5\n",
            3,
            "4 fields, and 2 columns; numbers need a decimal point",
        ),
        ("ik", "x_mm,y_mm\n\"600,0\n", 3, "a quote is not closed"),
        (
            "fk",
            &format!("{joints}\nx;0;0;0;0;0;0\n"),
            3,
            "line 2: joint_1_deg: `x` is not a number",
        ),
        ("fk", &format!("{joints}\n1;2\n"), 3, "line 2: 2 fields, and 7 columns"),
    ] {
        let refused = from_stdin(&[command, "--stdin"], text).code(code);
        let stderr = String::from_utf8_lossy(&refused.get_output().stderr).replace("\n  │ ", " ");
        assert!(stderr.contains(reason), "{text:?}: no {reason:?} in {stderr}");
    }
    cargo_bin_cmd!("iiwasim")
        .args(["fk", "--stdin"])
        .write_stdin(&b"\xff\xfej\0o\0"[..])
        .assert()
        .code(2)
        .stderr(contains("line 1: text in UTF-16: save it as UTF-8"));
}

#[test]
fn a_robot_has_all_its_figures_in_json() {
    let folder = tempdir().unwrap();
    let all = iiwasim(&folder, &["robot", "lbr_iiwa_7_r800", "--json", "--all"]).success();
    let text = String::from_utf8(all.get_output().stdout.clone()).unwrap();
    let profile: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(
        profile["velocity_limit_deg_s"],
        serde_json::json!([98, 98, 100, 130, 140, 180, 180])
            .as_array()
            .map_or(Value::Null, |list| {
                list.iter().map(|value| value.as_f64().unwrap()).collect()
            })
    );
    for key in [
        "lengths_mm",
        "position_limit_deg",
        "acceleration_limit_deg_s2",
        "jerk_limit_deg_s3",
        "torque_limit_nm",
        "link_mass_kg",
        "settle_time_s",
    ] {
        assert!(!profile[key].is_null(), "{key}");
    }
    // The output reads back as the same robot.
    fs::write(folder.path().join("all.json"), &text).unwrap();
    let again = iiwasim(&folder, &["robot", "all.json", "--json", "--all"]).success();
    assert_eq!(again.get_output().stdout, text.as_bytes());
    iiwasim(&folder, &["robot", "lbr_iiwa_7_r800"]).success().stdout(contains("\"flange\": 126"));
}

/// Outputs overwrite earlier outputs of the same kind, and nothing else.
#[test]
fn only_files_of_the_same_kind_are_replaced() {
    let folder = tempdir().unwrap();
    let program = fixture("appendix-b.json").display().to_string();
    let path = |name: &str| folder.path().join(name);
    fs::write(path("hand.txt"), "{ \"version\": 1 }").unwrap();
    let recorded = {
        let storage = std::io::Cursor::new(Vec::new());
        let robot = iiwa_kin::Robot::default();
        let mut recorder =
            iiwa_log::Recorder::new(storage, &robot, iiwa_log::RecorderConfig::default()).unwrap();
        recorder.sample(std::time::Duration::ZERO, &[0.0; 7]).unwrap();
        recorder.finish(&std::collections::BTreeMap::new(), &[]).unwrap().into_inner()
    };
    fs::write(path("recorded.bag"), &recorded).unwrap();
    let table = ["--no-output", "--csv", "hand.txt"];
    for arguments in [
        &["-o", "hand.txt"][..],
        &["-o", "recorded.bag"],
        &table,
        &["--no-output", "--csv", "recorded.bag"],
    ] {
        iiwasim(&folder, &[&["plan", &program], arguments].concat())
            .code(2)
            .stderr(contains("exists and is not a").and(contains("it is kept")));
    }
    iiwasim(&folder, &["plan", &program, "-o", "plan.mcap"]).success();
    for page in ["hand.txt", "recorded.bag"] {
        iiwasim(&folder, &["report", "plan.mcap", "-o", page])
            .code(2)
            .stderr(contains("is not a page"));
    }
    assert_eq!(fs::read(path("recorded.bag")).unwrap(), recorded);
    assert_eq!(fs::read_to_string(path("hand.txt")).unwrap(), "{ \"version\": 1 }");
    // Repeated runs overwrite their own files.
    for _ in 0..2 {
        let pictures = ["--picture", "a.svg", "--csv", "a.csv"];
        iiwasim(&folder, &[&["plan", &program, "-o", "plan.mcap"], &pictures[..]].concat())
            .success();
        iiwasim(&folder, &["report", "plan.mcap"]).success();
    }
    #[cfg(feature = "pictures")]
    for (picture, other) in [("a.svg", "a.png"), ("a.svg", "a.pdf")] {
        fs::copy(path(picture), path(other)).unwrap();
        iiwasim(&folder, &["plan", &program, "--no-output", "--picture", other])
            .code(2)
            .stderr(contains("is not a picture of this format"));
    }
}

#[test]
fn a_start_that_leaves_the_arm_open_is_noted() {
    let folder = tempdir().unwrap();
    let program = |more: &str| {
        format!(
            r#"{{ "version": 1, "start": {{ "frame": {{ "x_mm": 500, "y_mm": 0, "z_mm": 500,
                "a_deg": 0, "b_deg": 180, "c_deg": 0{more} }} }},
                "motions": [{{ "type": "ptp", "joints_deg": [0, 30, 0, -60, 0, 90, 0] }}] }}"#
        )
    };
    let plan = |more: &str| {
        fs::write(folder.path().join("a.json"), program(more)).unwrap();
        iiwasim(&folder, &["plan", "a.json", "--no-output"]).success()
    };
    plan("").stderr(contains("Warning: the start is a frame without `e1_deg` and `status`"));
    plan(r#", "e1_deg": 0"#).stderr(contains("without `status`"));
    plan(r#", "e1_deg": 0, "status": 2"#).stderr(contains("Warning").not());
}
