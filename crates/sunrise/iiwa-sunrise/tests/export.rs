//! Programs exported as Sunrise projects, and imported as far as a data file describes them.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use std::{f64::consts::PI, fs, path::Path};

use iiwa_kin::Robot;
use iiwa_program::{
    Blend, ByKind, CartesianMotion, Course, Frame, LimitKind, Motion, Program, Ptp, Sources, Start,
    Target, TargetRef, ToolLimits, Workcell,
};
use iiwa_sunrise::{
    DataFile, ExportError, ExportOptions, ExportedProject, ImportedCell, TaughtRedundancy,
    WorldFrame,
};
use proptest::prelude::*;

pub(crate) fn read(motions: &str) -> Program {
    read_with("", motions)
}

pub(crate) fn read_with(cell: &str, motions: &str) -> Program {
    let start = r#""start": { "joints_deg": [0, 30, 0, -60, 0, 90, 0] }"#;
    Program::from_json(&format!(r#"{{ "version": 1, {cell} {start}, "motions": [{motions}] }}"#))
        .unwrap()
}

pub(crate) fn export(program: &Program) -> ExportedProject {
    exported(program).unwrap()
}

pub(crate) fn exported(program: &Program) -> Result<ExportedProject, ExportError> {
    let options = ExportOptions { name: "a program".to_owned(), class: None };
    ExportedProject::new(program, &Robot::default(), &options)
}

/// Returns the statements of a program's motions.
fn statements(motions: &str) -> String {
    java(&read(motions))
}

/// Returns the body of `run()` in one line.
pub(crate) fn java(program: &Program) -> String {
    let java = export(program).java;
    let (_, run) = java.split_once("void run() {").unwrap();
    let (run, _) = run.split_once("\n    }").unwrap();
    run.split('\n').map(str::trim).collect::<Vec<_>>().join(" ").trim().to_owned()
}

pub(crate) const PTP: &str = r#"{ "type": "ptp", "joints_deg": [0, 30, 0, -70, 0, 80, 0] }"#;

#[test]
fn a_program_is_a_project_that_people_read() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../fixtures");
    let text = fs::read_to_string(folder.join("pick-and-place.json")).unwrap();
    let program = Program::from_json(&text).unwrap();
    let options = ExportOptions { name: "pick-and-place".to_owned(), class: None };
    let project = ExportedProject::new(&program, &Robot::default(), &options).unwrap();
    let keys: Vec<_> = project.notices.iter().map(|notice| notice.key).collect();
    assert_eq!(keys, ["blocking"]);
    let folder = folder.join("sunrise-export/pick-and-place");
    let expected = |name: &str| fs::read_to_string(folder.join(name)).unwrap();
    assert_eq!(project.java, expected(&project.java_file()));
    assert_eq!(project.data_file, expected(ExportedProject::DATA_FILE));
}

#[test]
fn motions_to_joints_have_shares_and_blends() {
    assert_eq!(
        statements(
            r#"{ "type": "ptp", "joints_rad": [0.1, 0.3, 0, -0.98, 0, 1.6, 0], "velocity_rel": 0.75,
                 "acceleration_rel": [0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 1],
                 "blend": { "fraction": 0.25 } },
               { "type": "ptp", "joints_deg": [0, 30, 0, -70, 0, 80, 0], "jerk_rel": 0.2,
                 "blend": { "cart_mm": 20 } },
               { "type": "ptp", "joints_deg": [0, 42, 0, -44, 0, 90, 0],
                 "blend": { "sunrise_rel": 0.5 } },
               { "type": "ptp", "joints_deg": [0, 0, 0, 0, 0, 0, 0] }"#
        ),
        "lbr.moveAsync(ptp(0.1, 0.3, 0.0, -0.98, 0.0, 1.6, 0.0) .setJointVelocityRel(0.75) \
         .setJointAccelerationRel(new double[] {0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 1.0}) \
         .setBlendingRel(0.5)); lbr.moveAsync(ptp(0.0, Math.toRadians(30.0), 0.0, \
         Math.toRadians(-70.0), 0.0, Math.toRadians(80.0), 0.0) .setJointJerkRel(0.2) \
         .setBlendingCart(20.0)); lbr.moveAsync(ptp(0.0, Math.toRadians(42.0), 0.0, \
         Math.toRadians(-44.0), 0.0, Math.toRadians(90.0), 0.0) .setBlendingRel(0.5)); \
         lbr.move(ptp(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0));"
    );
}

#[test]
fn a_motion_is_waited_for_where_the_arm_stops() {
    let stops = format!(
        r#"{PTP}, {{ "type": "wait", "seconds": 0.7 }}, {{ "type": "wait", "seconds": 0.0001 }},
           {{ "type": "ptp", "joints_deg": [0, 0, 0, 0, 0, 0, 0], "blend": {{ "cart_mm": 20 }} }}"#
    );
    let project = export(&read(&stops));
    assert!(project.java.contains("ThreadUtil.milliSleep(700L);"));
    assert!(project.java.contains("TimeUnit.NANOSECONDS.sleep(100000L);"));
    assert!(project.java.contains("public void run() throws InterruptedException {"));
    assert!(!project.java.contains("moveAsync") && !project.java.contains("setBlending"));
    let notices: Vec<_> = project.notices.iter().map(ToString::to_string).collect();
    assert_eq!(
        notices,
        ["motion 4: `blend`: nothing follows that it could blend into: the arm stops"]
    );
    let third = export(&read(&format!(r#"{PTP}, {{ "type": "wait", "seconds": 0.1234567891 }}"#)));
    assert_eq!(third.notices.len(), 1);
    assert_eq!(third.notices[0].key, "seconds");
}

#[test]
fn overlapping_waits_are_sleeps_after_asynchronous_motions() {
    let overlap = |motions: usize| {
        format!(r#"{{ "type": "wait", "seconds": 0.25, "overlap_motions": {motions} }}"#)
    };
    let blended = PTP.replace(" }", r#", "blend": { "cart_mm": 20 } }"#);
    let (relative_lift, down) = (
        r#"{ "type": "lin_rel", "offset": { "z_mm": 5 } }"#,
        r#"{ "type": "lin_rel", "offset": { "z_mm": -5 } }"#,
    );
    let lines = |motions: &[&str]| {
        let java = java(&read(&motions.join(", ")));
        let short = |line: &str| {
            let (call, _) =
                line.split_once("(ptp").or(line.split_once("(lin")).unwrap_or((line, ""));
            call.to_owned()
        };
        java.split("; ").map(short).collect::<Vec<_>>().join(" ")
    };
    // The blend is kept; at run time, the motion after the wait may be sent too late for it.
    let two = lines(&[&blended, &overlap(1), relative_lift]);
    assert_eq!(two, "lbr.moveAsync ThreadUtil.milliSleep(250L) lbr.move");
    // Both motions are sent at once; at the end, the program waits for the robot.
    let end = lines(&[&blended, relative_lift, &overlap(2)]);
    assert_eq!(end, "lbr.moveAsync sent = lbr.moveAsync ThreadUtil.milliSleep(250L) sent.await();");
    // The second wait starts with the second motion, which begins when the first has ended.
    let twice = lines(&[relative_lift, &overlap(1), down, &overlap(1), relative_lift]);
    assert_eq!(
        twice,
        "sent = lbr.moveAsync ThreadUtil.milliSleep(250L) sent.await() lbr.moveAsync \
         ThreadUtil.milliSleep(250L) lbr.move"
    );
    // A wait at standstill.
    let plain = lines(&[relative_lift, &overlap(1), r#"{ "type": "wait", "seconds": 1 }"#, down]);
    assert_eq!(
        plain,
        "sent = lbr.moveAsync ThreadUtil.milliSleep(250L) sent.await() \
         ThreadUtil.milliSleep(1000L) lbr.move"
    );
    // The wait would start with the first motion, which is too early.
    for motions in [
        [blended.as_str(), relative_lift, &overlap(1), down].join(", "),
        [relative_lift, down, &overlap(1), &overlap(2), relative_lift].join(", "),
    ] {
        let error = exported(&read(&motions)).unwrap_err().to_string();
        assert!(error.starts_with("motion 3: `overlap`: "), "{error}");
    }
}

#[test]
fn paths_of_the_tcp_have_all_their_limits() {
    let target =
        r#"{ "x_mm": 500, "y_mm": 100, "z_mm": 400, "a_deg": 0, "b_deg": 180, "c_deg": 0 }"#;
    let lin = statements(&format!(
        r#"{PTP}, {{ "type": "lin", "frame": {target}, "velocity_rel": 0.5,
             "orientation": "constant",
             "cart_velocity_mm_s": 250, "cart_acceleration_mm_s2": 1500, "cart_jerk_mm_s3": 20000,
             "orientation_velocity_deg_s": 60, "orientation_acceleration_deg_s2": 90,
             "orientation_jerk_deg_s3": 1000,
             "blend": {{ "cart_mm": 20, "ori_deg": 10 }} }}, {PTP}"#
    ));
    assert!(
        lin.contains(
            "lbr.moveAsync(lin(getApplicationData().getFrame(\"/P2\")) \
             .setOrientationType(SplineOrientationType.Constant) .setJointVelocityRel(0.5) \
             .setCartVelocity(250.0) .setCartAcceleration(1500.0) .setCartJerk(20000.0) \
             .setOrientationVelocity(Math.toRadians(60.0)) \
             .setOrientationAcceleration(Math.toRadians(90.0)) \
             .setOrientationJerk(Math.toRadians(1000.0)) .setBlendingCart(20.0) \
             .setBlendingOri(Math.toRadians(10.0)));"
        ),
        "{lin}"
    );
}

#[test]
fn offsets_are_in_the_tcp_or_in_a_frame() {
    assert_eq!(
        statements(
            r#"{ "type": "lin_rel", "offset": { "z_mm": 50.5 } },
               { "type": "lin_rel", "offset": { "x_mm": 1, "a_deg": 30, "c_rad": 0.1 },
                 "in": { "x_mm": 0, "y_mm": 0, "z_mm": 0, "a_deg": 0, "b_deg": 0, "c_deg": 0 } }"#
        ),
        "lbr.move(linRel(0.0, 0.0, 50.5)); \
         lbr.move(linRel(Transformation.ofRad(1.0, 0.0, 0.0, Math.toRadians(30.0), 0.0, 0.1), \
         getApplicationData().getFrame(\"/P2_in\")));"
    );
}

#[test]
fn circles_and_splines_go_to_frames() {
    let frame_at = |x: f64, y: f64| {
        format!(
            r#"{{ "x_mm": {x}, "y_mm": {y}, "z_mm": 400, "a_deg": 0, "b_deg": 180, "c_deg": 0 }}"#
        )
    };
    let (a, b, c) = (frame_at(450.0, 50.0), frame_at(500.0, 0.0), frame_at(450.0, -50.0));
    let written = statements(&format!(
        r#"{{ "type": "circ", "aux": {a}, "frame": {b}, "circ_angle_deg": 270,
              "orientation_reference": "path" }},
           {{ "type": "spl", "frame": {c}, "cart_velocity_mm_s": 100 }},
           {{ "type": "spline", "segments": [
                {{ "type": "spl", "frame": {a}, "orientation": "ignore" }},
                {{ "type": "lin", "frame": {b}, "velocity_rel": 0.3, "cart_velocity_mm_s": 50 }},
                {{ "type": "circ", "aux": {c}, "frame": {a} }} ],
              "cart_velocity_mm_s": 200, "orientation": "constant" }}"#
    ));
    // The frames of the circle are reused in the spline.
    assert_eq!(
        written,
        "lbr.move(circ(getApplicationData().getFrame(\"/P1_aux\"), \
            getApplicationData().getFrame(\"/P1\")) \
         .setCircAngle(Math.toRadians(270.0)) \
         .setOrientationReferenceSystem(OrientationReferenceSystem.Path)); \
         lbr.move(spl(getApplicationData().getFrame(\"/P2\")).setCartVelocity(100.0)); \
         lbr.move(new Spline( \
         spl(getApplicationData().getFrame(\"/P1_aux\")) \
         .setOrientationType(SplineOrientationType.Ignore), \
         lin(getApplicationData().getFrame(\"/P1\")).setJointVelocityRel(0.3)\
         .setCartVelocity(50.0), \
         circ(getApplicationData().getFrame(\"/P2\"), getApplicationData().getFrame(\"/P1_aux\")) \
         .setOrientationReferenceSystem(OrientationReferenceSystem.Base)) \
         .setOrientationType(SplineOrientationType.Constant) .setCartVelocity(200.0));"
    );
}

pub(crate) const TOOLS: &str = r#""tools": {
    "gripper": { "tcp": { "z_mm": 120 }, "tips": { "left": { "y_mm": 40, "z_mm": 120 } },
                 "load": { "mass_kg": 1.2 } },
    "probe": { "tcp": { "z_mm": 80 } },
    "welder": { "tcp": { "z_mm": 200 }, "load": { "mass_kg": 3, "center_mm": [0, 0, 90] } } },
  "tool": "gripper","#;

pub(crate) fn relative_lift(tool: &str) -> String {
    format!(r#"{{ "type": "lin_rel", "offset": {{ "z_mm": -10 }}, "tool": "{tool}" }}"#)
}

#[test]
fn payloads_are_attached() {
    let motions = [
        relative_lift("gripper"),
        relative_lift("gripper/left"),
        relative_lift("flange"),
        relative_lift("probe"),
        relative_lift("welder"),
    ];
    let project = export(&read_with(TOOLS, &motions.join(",")));
    let (_, body) = project.java.split_once("void initialize() {").unwrap();
    let expected = "
        gripper = getApplicationData().createFromTemplate(\"gripper\");
        probe = getApplicationData().createFromTemplate(\"probe\");
        welder = getApplicationData().createFromTemplate(\"welder\");
        gripper.attachTo(lbr.getFlange());
    }

    @Override
    public void run() {
        gripper.getFrame(\"/TCP\").move(linRel(0.0, 0.0, -10.0));
        gripper.getFrame(\"/left\").move(linRel(0.0, 0.0, -10.0));
        lbr.move(linRel(0.0, 0.0, -10.0));
        probe.attachTo(lbr.getFlange());
        probe.getFrame(\"/TCP\").move(linRel(0.0, 0.0, -10.0));
        gripper.detach();
        probe.detach();
        welder.attachTo(lbr.getFlange());
        welder.getFrame(\"/TCP\").move(linRel(0.0, 0.0, -10.0));
    }
}
";
    assert_eq!(body, expected);
}

#[test]
fn a_load_that_is_picked_up_is_a_tool_that_holds_it() {
    let load = r#"{ "type": "load", "load": { "mass_kg": 4.2, "center_mm": [0, 1, 90] } }"#;
    let none = r#"{ "type": "load", "load": null }"#;
    let motions = [
        &relative_lift("gripper"),
        load,
        &relative_lift("gripper"),
        none,
        &relative_lift("gripper"),
    ];
    let program = read_with(TOOLS, &motions.join(","));
    let project = export(&program);
    assert_eq!(
        java(&program),
        "gripper.getFrame(\"/TCP\").move(linRel(0.0, 0.0, -10.0)); \
         gripper.detach(); gripperLoaded.attachTo(lbr.getFlange()); \
         gripperLoaded.getFrame(\"/TCP\").move(linRel(0.0, 0.0, -10.0)); \
         gripperLoaded.detach(); gripper.attachTo(lbr.getFlange()); \
         gripper.getFrame(\"/TCP\").move(linRel(0.0, 0.0, -10.0));"
    );
    let file = DataFile::from_xml(&project.data_file).unwrap();
    let loaded = file.tools.iter().find(|tool| tool.name == "gripper_Loaded").unwrap();
    assert_eq!(loaded.load, program.loads()[2]);
}

#[test]
fn names_are_valid_in_java_and_xml() {
    let program = read_with(
        r#""tools": {
             "new \"tool\" <&>": { "tcp": {}, "tips": { "TCP": {}, "a/b": { "z_mm": 1 } } },
             "greifer_ü": { "tcp": {} } },
           "bases": {
             "Tisch \"1\"": {},
             "A": { "base": "Tisch \"1\"" },
             "A/B": { "base": "A", "x_mm": 1 } },
           "frames": {
             "A/B": { "base": "A", "x_mm": 1, "y_mm": 0, "z_mm": 0,
                      "a_deg": 0, "b_deg": 0, "c_deg": 0 },
             "P\\u/1": { "base": "A/B", "x_mm": 2, "y_mm": 0, "z_mm": 0,
                         "a_deg": 0, "b_deg": 0, "c_deg": 0 } },
           "tool": "new \"tool\" <&>/TCP", "#,
        r#"{ "type": "lin", "frame": "A/B" },
           { "type": "lin", "frame": "P\\u/1", "tool": "new \"tool\" <&>/a/b" },
           { "type": "lin", "frame": "A/B", "tool": "greifer_ü" }"#,
    );
    let project = export(&program);
    assert!(project.java.is_ascii());
    for part in [
        "private Tool newTool;",
        "newTool = getApplicationData().createFromTemplate(\"new \\\"tool\\\" <&>\");",
        "newTool.getFrame(\"/TCP\").move(lin(getApplicationData().getFrame(\"/Tisch \
         \\\"1\\\"/A/B\")));",
        "newTool.getFrame(\"/a_b\").move(lin(getApplicationData().getFrame(\"/Tisch \
         \\\"1\\\"/A/B/P\\\\u_1\")));",
        "greiferUe.getFrame(\"/TCP\").move(",
        "greiferUe = getApplicationData().createFromTemplate(\"greifer_\\u00fc\");",
    ] {
        assert!(project.java.contains(part), "{part} in {}", project.java);
    }
    let file = DataFile::from_xml(&project.data_file).unwrap();
    let tool = file.tools.iter().find(|tool| tool.name.starts_with("new")).unwrap();
    assert_eq!(tool.name, "new \"tool\" <&>");
    assert_eq!(tool.default_frame.as_deref(), Some("/TCP_2"));
    let cell = ImportedCell::new(&file);
    // A base that is also a motion target.
    let names: Vec<_> = cell.workcell.frames.keys().map(String::as_str).collect();
    assert_eq!(names, ["Tisch \"1\"/A/B", "Tisch \"1\"/A/B/P\\u_1"]);
}

#[test]
fn names_and_comments_are_comment_lines() {
    let text = r#"
        { "type": "ptp", "joints_deg": [0, 30, 0, -70, 0, 80, 0], "name": "approach */ \\u000a x",
          "comment": "first line\r\n\n\tsecond }", "blend": { "fraction": 0.2 } },
        { "type": "wait", "seconds": 0.5, "overlap": true, "name": "overlapping" },
        { "type": "ptp", "joints_deg": [0, 30, 0, -60, 0, 90, 0], "group": "none" },
        { "type": "wait", "seconds": 0.1, "name": "pause" },
        { "type": "load", "load": { "mass_kg": 1 }, "name": "grip" },
        { "type": "ptp", "joints_deg": [0, 40, 0, -60, 0, 90, 0], "name": "Glühofen 溶接" },
        { "type": "load", "load": null, "comment": "nothing follows" }"#;
    let labelled = read(text);
    let java = export(&labelled).java;
    let above = |statement: &str| {
        let (before, _) = java.split_once(statement).unwrap();
        let lines = before.lines().rev().skip(1).map(str::trim);
        let mut comments: Vec<_> = lines.take_while(|line| line.starts_with("//")).collect();
        comments.reverse();
        comments
    };
    let first = [
        r"// iiwasim name: approach */ \u005cu000a x",
        "// iiwasim comment: first line",
        "// iiwasim comment:",
        r"// iiwasim comment: \u0009second }",
    ];
    assert_eq!(above("Math.toRadians(-70.0)"), first, "{java}");
    assert_eq!(above("ThreadUtil.milliSleep(500L)"), ["// iiwasim name: overlapping"], "{java}");
    assert_eq!(above("ThreadUtil.milliSleep(100L)"), ["// iiwasim name: pause"], "{java}");
    assert_eq!(above("Math.toRadians(40.0)"), ["// iiwasim name: Glühofen 溶接"], "{java}");
    let order = ["name: grip", ".attachTo(", "name: Glühofen 溶接", "comment: nothing follows"];
    let places = order.map(|part| java.find(part).unwrap());
    assert!(places.is_sorted(), "{java}");
    // Without the comments, the application is that of the program without labels.
    let mut plain = labelled.clone();
    plain.sources = Sources::default();
    let statements: Vec<_> = java.lines().filter(|line| !line.trim().starts_with("//")).collect();
    assert_eq!(statements, export(&plain).java.lines().collect::<Vec<_>>());
}

#[test]
fn long_programs_are_divided_into_methods() {
    let project = export(&read(&vec![PTP; 130].join(",")));
    assert!(project.java.contains(
        "    public void run() \
         {\n        part1();\n        part2();\n        part3();\n    }\n\n    private void \
         part1() {\n"
    ));
    assert_eq!(project.java.matches("lbr.move(").count(), 130);
}

#[test]
fn repeat_blocks_are_loops() {
    let ptp = |a4_deg: i32, more: &str| {
        format!(r#"{{ "type": "ptp", "joints_deg": [0, 30, 0, {a4_deg}, 0, 80, 0]{more} }}"#)
    };
    let wait = r#"{ "type": "wait", "seconds": 0.5 }"#;
    let inner =
        format!(r#"{{ "type": "repeat", "count": 2, "motions": [{}, {wait}] }}"#, ptp(-60, ""));
    let block = |count: u32, motions: &[&str]| {
        let motions = motions.join(", ");
        format!(
            r#"{{ "type": "repeat", "count": {count}, "name": "stack", "motions": [{motions}] }}"#
        )
    };
    let nested = block(3, &[&ptp(-70, ""), &inner]);
    assert_eq!(
        export(&read(&nested)).java.split_once("void run() {\n").unwrap().1.trim_end(),
        "        // stack
        for (int round = 0; round < 3; round++) {
            lbr.move(ptp(0.0, Math.toRadians(30.0), 0.0, Math.toRadians(-70.0), 0.0, \
         Math.toRadians(80.0), 0.0));
            for (int round2 = 0; round2 < 2; round2++) {
                lbr.move(ptp(0.0, Math.toRadians(30.0), 0.0, Math.toRadians(-60.0), 0.0, \
         Math.toRadians(80.0), 0.0));
                ThreadUtil.milliSleep(500L);
            }
        }
    }
}"
    );
    // The last round ends with a stop, as nothing follows into which it could be blended.
    let blend = r#", "blend": { "fraction": 0.2 }"#;
    let blended = block(4, &[&ptp(-70, blend), &ptp(-60, blend)]);
    let java = java(&read(&blended));
    assert!(java.contains("round < 3;"), "{java}");
    assert_eq!((java.matches("moveAsync(").count(), java.matches("move(").count()), (3, 1));
    // Motions that overlap waits are awaited at the end of each round.
    let overlap = r#"{ "type": "wait", "seconds": 0.5, "overlap": true }"#;
    let overlapping = block(3, &[&ptp(-70, ""), overlap]);
    let java = self::java(&read(&overlapping));
    assert!(java.ends_with("ThreadUtil.milliSleep(500L); sent.await(); }"), "{java}");
    // A tool that is picked up in each round.
    let load = r#"{ "type": "load", "load": { "mass_kg": 1 } }"#;
    let drop = r#"{ "type": "load", "load": null }"#;
    let picking = block(3, &[load, &ptp(-70, ""), drop, &ptp(-60, "")]);
    let java = self::java(&read(&format!("{PTP}, {picking}")));
    assert_eq!((java.matches("attachTo").count(), java.matches("detach").count()), (1, 1));
    // A long round is written out.
    let long = vec![ptp(-70, ""); 70];
    let long: Vec<_> = long.iter().map(String::as_str).collect();
    let project = export(&read(&block(2, &long)));
    assert_eq!(project.java.matches("lbr.move(").count(), 140);
    // So is a block whose rounds have been changed.
    let mut changed = read(&block(2, &[&ptp(-70, "")]));
    changed.motions[1] = read(&ptp(-50, "")).motions.remove(0);
    assert_eq!(self::java(&changed).matches("lbr.move(").count(), 2);
}

#[test]
fn the_data_file_says_for_which_robot_and_start_the_program_is() {
    let mut program = read(PTP);
    program.robot = Some("lbr_iiwa_14_r820".to_owned());
    program.start = Start::Joints([0.1, 0.0, -0.3, 0.0, 0.0, 0.0, 1e-9]);
    let project = export(&program);
    for part in [
        r#"id="iiwasim_robot" dataType="java.lang.String" defaultValue="lbr_iiwa_14_r820""#,
        r#"value="0.1 0.0 -0.3 0.0 0.0 0.0 1e-9""#,
    ] {
        assert!(project.data_file.contains(part), "{}", project.data_file);
    }
    assert_eq!(project.start_deg.map(f64::to_radians), project.start_rad);
}

#[test]
fn a_cell_that_was_imported_comes_back() {
    let cell = r#"{ "version": 1,
        "tools": {
            "Hand": { "tcp": { "z_mm": 150.1, "a_rad": 0.4 }, "tips": { "Jaw": { "x_mm": 1e-7 } },
                "load": { "mass_kg": 0.8, "center_mm": [1, 2, 60.3],
                    "inertia_kg_m2": [0.001, 0.002, 0.003], "abc_deg": [0.1, 0.2, 0.3] } },
            "Nail": { "tcp": { "z_mm": 3 } } },
        "bases": {
            "Bench": { "x_mm": 300.123, "z_mm": 100, "a_rad": 0.5 },
            "Bench/Tray": { "base": "Bench", "x_mm": 5 } },
        "frames": {
            "Bench/Pick": { "base": "Bench", "x_mm": 1, "y_mm": 2, "z_mm": 3,
                "a_rad": 0.1, "b_rad": 3.1, "c_rad": 0, "e1_rad": 0.25, "status": 2, "turn": 35 },
            "Bench/Tray": { "base": "Bench", "x_mm": 5, "y_mm": 0, "z_mm": 0,
                "a_deg": 0, "b_deg": 0, "c_deg": 0, "status": 5 },
            "Bench/Tray/1": { "base": "Bench/Tray", "x_mm": 7, "y_mm": 0, "z_mm": 0,
                "a_deg": 0, "b_deg": 0, "c_deg": 0 },
            "Far": { "base": "robot", "x_mm": 7, "y_mm": 0, "z_mm": 0,
                "a_deg": 0, "b_deg": 0, "c_deg": 0, "e1_rad": 1 } } }"#;
    let workcell = Workcell::from_json(cell).unwrap();
    let program = Program { workcell: workcell.clone(), ..read(PTP) };
    let file = DataFile::from_xml(&export(&program).data_file).unwrap();
    let back = ImportedCell::new(&file);
    assert_eq!(back.renamed, []);
    assert_eq!(back.workcell, workcell);
}

#[test]
fn xml_is_read_back() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../fixtures/sunrise-export");
    let text = fs::read_to_string(folder.join("pick-and-place/RoboticsAPI.data.xml")).unwrap();
    let mut file = DataFile::from_xml(&text).unwrap();
    file.frames[0].teaching = Some(iiwa_sunrise::Teaching {
        device: "LBR".to_owned(),
        tcp_name: "a \"b\"/<TCP>".to_owned(),
        tcp: Frame { xyz_mm: [0.1, -2.5e-9, 3e20], abc_rad: [PI, 0.0, -0.0] },
    });
    let child = WorldFrame {
        name: "é & \u{1f916}".to_owned(),
        redundancy: Some(TaughtRedundancy {
            device: "LBR".to_owned(),
            e1_rad: None,
            status: None,
            turn: iiwa_kin::Turn::new(127),
        }),
        ..file.frames[0].clone()
    };
    file.frames[0].children.push(child);
    let back = DataFile::from_xml(&file.to_xml()).unwrap();
    assert_eq!((back.frames, back.tools), (file.frames, file.tools));
}

/// Returns the numeric arguments of the first call of a method.
fn arguments(java: &str, method: &str) -> Vec<f64> {
    let (_, rest) = java.split_once(&format!("{method}(")).unwrap();
    let mut open = 1;
    let end = rest.find(|c| {
        open += i32::from(c == '(') - i32::from(c == ')');
        open == 0
    });
    let number = |text: &str| match text.trim().strip_prefix("Math.toRadians(") {
        Some(rest) => rest.trim_end_matches(')').parse::<f64>().unwrap().to_radians(),
        None => text.trim().parse().unwrap(),
    };
    rest[..end.unwrap()].split(',').map(number).collect()
}

proptest! {
    #[test]
    fn joints_are_the_same_to_the_last_bit(
        joints_rad in prop::array::uniform7(prop_oneof![
            -1.5..1.5,
            (-80_i32..80).prop_map(|deg| f64::from(deg).to_radians()),
            Just(-0.0),
            Just(5e-324),
        ]),
        share in 1e-6..1.0,
    ) {
        let mut program = read(PTP);
        let ptp = Ptp { blend: Some(Blend::CartMm(30.0)), ..Ptp::to(joints_rad).velocity(share) };
        program.motions.insert(0, Motion::Ptp(ptp));
        let java = export(&program).java;
        let actual = arguments(&java, "moveAsync(ptp");
        let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
        prop_assert_eq!(bits(&actual), bits(&joints_rad));
        prop_assert_eq!(arguments(&java, "setJointVelocityRel"), [share]);
    }

    #[test]
    fn frames_and_limits_are_the_same_to_the_last_bit(
        xyz_mm in prop::array::uniform3(-1000.0..1000.0),
        abc_rad in prop::array::uniform3(-PI..PI),
        e1_rad in proptest::option::of(-2.9..2.9),
        speed_mm_s in 1.0..2000.0,
        turn_rad_s in 0.01..5.0,
    ) {
        let frame = Frame { xyz_mm, abc_rad };
        let target = Target { e1_rad, ..Target::at(frame) };
        let mut lin = CartesianMotion::new(Course::Lin { to: TargetRef::Given(target) });
        lin.tool_limits = ToolLimits {
            way: ByKind::from_fn(|kind| match kind {
                LimitKind::Velocity => 1e-3 * speed_mm_s,
                _ => f64::INFINITY,
            }),
            turn: ByKind::from_fn(|kind| match kind {
                LimitKind::Jerk => turn_rad_s,
                _ => f64::INFINITY,
            }),
        };
        let mut program = read(PTP);
        program.motions.push(Motion::Cartesian(Box::new(lin)));
        let project = export(&program);
        let file = DataFile::from_xml(&project.data_file).unwrap();
        prop_assert_eq!(file.frames[0].frame, frame);
        let redundancy = file.frames[0].redundancy.as_ref();
        prop_assert_eq!(redundancy.and_then(|redundancy| redundancy.e1_rad), e1_rad);
        prop_assert_eq!(1e-3 * arguments(&project.java, "setCartVelocity")[0], 1e-3 * speed_mm_s);
        prop_assert_eq!(arguments(&project.java, "setOrientationJerk"), [turn_rad_s]);
    }
}
