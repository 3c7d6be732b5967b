//! Import of our own project, from its XML to the tools, bases and frames of programs.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use std::fmt::Write as _;

use iiwa_kin::{Joints, Pose, Robot, Status, Turn};
use iiwa_path::TurnContradiction;
use iiwa_program::{Frame, Load, Program, Workcell};
use iiwa_sunrise::{DataFile, ImportedCell, ImportedFrame, Verdict};
use proptest::prelude::*;

const TCP: Frame = Frame { xyz_mm: [4.0, -3.0, 180.0], abc_rad: [0.4, 0.0, 0.0] };
const BENCH: Frame = Frame { xyz_mm: [350.0, -120.0, 90.0], abc_rad: [0.7, 0.02, -0.01] };

/// Joint positions with several statuses.
const TAUGHT_DEG: [[f64; 7]; 4] = [
    [10.0, 40.0, -15.0, -70.0, 20.0, 60.0, -30.0],
    [-50.0, 35.0, 80.0, 75.0, -20.0, -50.0, 100.0],
    [120.0, -30.0, -25.0, -80.0, 140.0, 45.0, -160.0],
    [0.0, 30.0, 0.0, -60.0, 0.0, 90.0, 0.0],
];

fn pose_element(name: &str, frame: &Frame) -> String {
    let Frame { xyz_mm: [x, y, z], abc_rad: [a, b, c] } = frame;
    format!(r#"<{name} a="{a}" b="{b}" c="{c}" x="{x}" y="{y}" z="{z}"/>"#)
}

fn frame_element(name: &str, frame: &Frame, inner: &str) -> String {
    format!(
        "<frame id=\"_1\" name=\"{name}\">\n{}\n{inner}</frame>\n",
        pose_element("transformation", frame)
    )
}

/// Returns the XML that a controller writes for a frame taught at `joints`.
fn taught(joints: &Joints, tcp_name: &str, tcp: &Frame) -> String {
    let redundancy = Robot::default().redundancy(joints);
    let parameter = |name: &str, value: String| {
        format!(r#"<info type="com.example.{name}" value="{value}" valueType="java.lang.Double"/>"#)
    };
    let parameters = [
        parameter("StatusTurnRedundancy$StatusParameter", redundancy.status.to_string()),
        parameter("StatusTurnRedundancy$TurnParameter", redundancy.turn.to_string()),
        parameter("LBRE1Redundancy$E1Parameter", redundancy.e1_rad.to_string()),
    ];
    format!(
        r#"<additionalInformation>
             <info key="LastModificationTime" type="java.lang.Long" value="1"/>
             <info base="World" device="LBR_iiwa_7_R800_1" tcpName="{tcp_name}"
                   type="com.example.TeachInformation">
               {}
             </info>
           </additionalInformation>
           <redundancyData>
             <redundancy transformationProviderName="Cabinet/LBR_iiwa_7_R800_1"
                         type="com.example.LBRE1Redundancy">
               {}
             </redundancy>
           </redundancyData>
"#,
        pose_element("tcpTransformation", tcp),
        parameters.concat()
    )
}

/// Returns the frame of a TCP, relative to `base`.
fn frame_at(joints: &Joints, tcp: &Frame, base: &Pose) -> Frame {
    let pose = Robot::default().flange_pose(joints).then(&tcp.pose());
    Frame::from(&base.inverse().then(&pose))
}

fn file(world: &str, objects: &str) -> String {
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\" standalone=\"no\"?>\n<RoboticsAPIData \
         version=\"3\">\n\
         <world>\n<gravitation x=\"0.0\" y=\"0.0\" z=\"9.81\"/>\n{world}</world>\n\
         <objectTemplates>\n{objects}</objectTemplates>\n</RoboticsAPIData>\n"
    )
}

fn gripper() -> String {
    let jaws = Frame { xyz_mm: [0.0, 30.0, 160.0], abc_rad: [0.0, 0.5, 0.0] };
    let nail = Frame { xyz_mm: [0.0, 0.0, 12.0], abc_rad: [0.0, 0.0, 0.3] };
    format!(
        r#"<toolTemplate class="" defaultMotionFrameRef="/Fingers" name="Gripper"><frames>
             {}
             {}
           </frames>
           <loadData cogA="0.1" cogB="0.0" cogC="0.0" cogX="1.5" cogY="-2.0" cogZ="61.0"
                     inertiaX="0.002" inertiaY="0.003" inertiaZ="0.001" mass="1.25"/>
         </toolTemplate>
"#,
        frame_element(
            "Jaw",
            &jaws,
            &format!("<frames>{}</frames>", frame_element("Nail", &nail, ""))
        ),
        frame_element("Fingers", &TCP, r#"<measurementTranslation method="XYZ4Point"/>"#)
    )
}

fn project() -> String {
    let [a, b, c, d] = TAUGHT_DEG.map(|joints| joints.map(f64::to_radians));
    let on_bench = BENCH.pose();
    let tray = frame_at(&b, &TCP, &on_bench);
    let on_tray = on_bench.then(&tray.pose());
    let inner =
        frame_element("P1", &frame_at(&a, &TCP, &on_bench), &taught(&a, "Gripper/Fingers", &TCP))
            + &frame_element(
                "Tray",
                &tray,
                &(taught(&b, "Gripper/Fingers", &TCP)
                    + &frame_element(
                        "P1",
                        &frame_at(&c, &TCP, &on_tray),
                        &taught(&c, "Gripper/Fingers", &TCP),
                    )),
            );
    let home = frame_at(&d, &Frame::default(), &Pose::IDENTITY);
    let world = frame_element("Bench", &BENCH, &inner)
        + &frame_element("Home", &home, &taught(&d, "Flange", &Frame::default()));
    file(&world, &gripper())
}

fn imported(text: &str) -> ImportedCell {
    ImportedCell::new(&DataFile::from_xml(text).unwrap())
}

fn frame<'a>(cell: &'a ImportedCell, name: &str) -> &'a ImportedFrame {
    cell.frames.iter().find(|frame| frame.name == name).unwrap()
}

#[test]
fn nested_frames_become_bases_and_frames() {
    let cell = imported(&project());
    let workcell = &cell.workcell;
    assert_eq!(workcell.bases.keys().collect::<Vec<_>>(), ["Bench", "Bench/Tray"]);
    let frames: Vec<_> = workcell.frames.keys().collect();
    assert_eq!(frames, ["Bench/P1", "Bench/Tray", "Bench/Tray/P1", "Home"]);
    // Frames keep their numbers, relative to their base.
    assert_eq!(workcell.bases["Bench"].frame, BENCH);
    assert_eq!(workcell.bases["Bench"].base, None);
    assert_eq!(workcell.bases["Bench/Tray"].base.as_deref(), Some("Bench"));
    assert_eq!(workcell.bases["Bench/Tray"].frame, workcell.frames["Bench/Tray"].frame);
    assert_eq!(workcell.frames["Bench/Tray/P1"].base.as_deref(), Some("Bench/Tray"));
    assert_eq!(workcell.frames["Home"].base.as_deref(), Some("robot"));
    assert_eq!(workcell.frames["Home"].status.map(Status::bits), Some(2));
    let paths: Vec<_> = cell.frames.iter().map(|frame| frame.path.as_str()).collect();
    assert_eq!(paths, ["/Bench", "/Bench/P1", "/Bench/Tray", "/Bench/Tray/P1", "/Home"]);
    assert!(cell.renamed.is_empty());
    let read = Workcell::from_json(&workcell.to_json()).unwrap();
    assert_eq!((&read.frames, &read.bases), (&workcell.frames, &workcell.bases));
}

#[test]
fn a_frame_without_anything_is_a_frame_to_go_to() {
    let world = frame_element("A", &BENCH, &frame_element("B", &BENCH, ""));
    let workcell = imported(&file(&world, "")).workcell;
    assert_eq!((workcell.bases.len(), workcell.frames.len()), (1, 1));
    let target = &workcell.frames["A/B"];
    assert_eq!((target.e1_rad, target.status, target.turn), (None, None, None));
}

#[test]
fn templates_become_tools_with_tips_and_loads() {
    let cell = imported(&project());
    let tool = &cell.workcell.tools["Gripper"];
    assert_eq!(tool.tcp, TCP);
    assert_eq!(tool.tips.keys().collect::<Vec<_>>(), ["Jaw", "Jaw/Nail"]);
    let jaw = tool.tips["Jaw"].pose();
    let nail = Frame { xyz_mm: [0.0, 0.0, 12.0], abc_rad: [0.0, 0.0, 0.3] }.pose();
    let nail_tcp = cell.workcell.tcp(Some("Gripper/Jaw/Nail")).unwrap();
    let expected = jaw.then(&nail);
    for i in 0..3 {
        assert!((nail_tcp.position_m[i] - expected.position_m[i]).abs() < 1e-15);
    }
    let load = Load {
        mass_kg: 1.25,
        center_mm: [1.5, -2.0, 61.0],
        inertia_kg_m2: [0.002, 0.003, 0.001],
        abc_rad: [0.1, 0.0, 0.0],
    };
    assert_eq!(tool.load, Some(load.into()));
    assert_eq!(cell.tools[0].tcp.as_deref(), Some("/Fingers"));
    assert_eq!(cell.tools[0].tips, ["Jaw", "Jaw/Nail"]);

    // Defaults: the first frame without a default frame, the flange without frames, no load without
    // a mass.
    let other = gripper().replace(" defaultMotionFrameRef=\"/Fingers\"", "");
    let cell = imported(&file("", &other));
    assert_eq!(cell.tools[0].tcp.as_deref(), Some("/Jaw"));
    assert_eq!(cell.tools[0].tips, ["Jaw/Nail", "Fingers"]);
    let none = r#"<toolTemplate name="Plate"><loadData mass="0.0"/></toolTemplate>"#;
    let cell = imported(&file("", none));
    assert_eq!(cell.tools[0].tcp, None);
    let plate = &cell.workcell.tools["Plate"];
    assert_eq!((plate.tcp, &plate.load), (Frame::default(), &None));
    // Programs would refuse a load in grams, and with it all frames of the file.
    let cell = imported(&file("", &none.replace("0.0", "2000")));
    assert_eq!(cell.workcell.tools["Plate"].load, None);
}

#[test]
fn taught_frames_are_reached_with_the_taught_joints() {
    let cell = imported(&project());
    let names = ["Bench/P1", "Bench/Tray", "Bench/Tray/P1", "Home"];
    for (name, joints_deg) in names.into_iter().zip(TAUGHT_DEG) {
        let check = frame(&cell, name).check(&Robot::default());
        assert_eq!(check.verdict, Verdict::Agrees, "{name}");
        for (actual, taught) in check.joints_rad.unwrap().iter().zip(joints_deg) {
            assert!((actual.to_degrees() - taught).abs() < 1e-9, "{name}");
        }
    }
    assert_eq!(frame(&cell, "Bench").check(&Robot::default()).verdict, Verdict::NotTaught);
    assert_eq!(frame(&cell, "Bench/P1").tool.as_deref(), Some("Gripper"));
    assert_eq!(frame(&cell, "Home").tool.as_deref(), Some("flange"));

    // A program moves there without a warning.
    let program = Program::from_json_with(
        r#"{ "version": 1, "include": "f.json", "tool": "Gripper", "start": { "frame": "Bench/P1" },
             "motions": [{ "type": "ptp", "frame": "Bench/Tray/P1" }] }"#,
        |_| Ok(cell.workcell.to_json()),
    );
    let program = program.unwrap();
    assert_eq!(TurnContradiction::all(&program, &Robot::default()), Ok(vec![]));
    let start = program.start_rad(&Robot::default()).unwrap();
    assert!((start[6].to_degrees() + 30.0).abs() < 1e-9);
}

#[test]
fn contradictions_are_reported() {
    let verdict =
        |text: &str, name: &str, robot: &Robot| frame(&imported(text), name).check(robot).verdict;
    let iiwa = Robot::default();
    let project = project();
    let bench = |x: &str| project.replacen("x=\"350\"", &format!("x=\"{x}\""), 1);
    assert!(matches!(verdict(&bench("3500"), "Bench/P1", &iiwa), Verdict::Unreachable(_)));
    let turn = Turn::of(&TAUGHT_DEG[0]).bits();
    let turned = project.replacen(
        &format!("TurnParameter\" value=\"{turn}\""),
        &format!("TurnParameter\" value=\"{}\"", turn ^ 64),
        1,
    );
    assert_ne!(turned, project);
    let actual = verdict(&turned, "Bench/P1", &iiwa);
    let stated = Turn::new(turn ^ 64).unwrap();
    assert_eq!(actual, Verdict::OtherTurn { stated, reached: Turn::of(&TAUGHT_DEG[0]) });
    assert!(actual.to_string().contains(&stated.to_string()));

    // A TCP rotation by half a turn moves A7 out of its range.
    let joints = [0.0, 0.5, 0.0, -1.2, 0.0, 0.9, 0.02];
    let tcp_frame = frame_at(&joints, &Frame::default(), &Pose::IDENTITY);
    let flipped = Frame { abc_rad: [3.1, 0.0, 0.0], ..Frame::default() };
    let text = file(&frame_element("P", &tcp_frame, &taught(&joints, "Gone/TCP", &flipped)), "");
    assert!(matches!(verdict(&text, "P", &iiwa), Verdict::Outside(_)));
    let cell = imported(&text);
    assert_eq!(frame(&cell, "P").tool, None);
    assert_eq!(frame(&cell, "P").teaching.as_ref().unwrap().tcp_name, "Gone/TCP");
}

#[test]
fn a_remeasured_tcp_is_reported() {
    let text = project();
    // Change only the tool's TCP, which is the last one.
    let (world, tools) = text.split_at(text.find("<objectTemplates>").unwrap());
    let cell = imported(&format!("{world}{}", tools.replace("z=\"180\"", "z=\"183\"")));
    let change = frame(&cell, "Bench/P1").tcp_change.unwrap();
    assert!((change.distance_mm - 3.0).abs() < 1e-9 && change.turn_rad < 1e-7);
    assert_eq!(frame(&cell, "Home").tcp_change, None);
    // The check uses the TCP at the time of teaching.
    assert_eq!(frame(&cell, "Bench/P1").check(&Robot::default()).verdict, Verdict::Agrees);
    assert_eq!(frame(&imported(&text), "Bench/P1").tcp_change, None);
}

#[test]
fn of_several_robots_the_one_that_taught_counts() {
    let text = project().replacen(
        "<redundancyData>",
        r#"<redundancyData>
             <redundancy transformationProviderName="Cabinet/Other" type="x.LBRE1Redundancy">
               <info type="x$E1Parameter" value="1.5"/>
             </redundancy>
             <redundancy transformationProviderName="Cabinet/Third" type="x.LBRAlphaRedundancy"/>"#,
        1,
    );
    let file = DataFile::from_xml(&text).unwrap();
    let cell = ImportedCell::new(&file);
    assert_eq!(frame(&cell, "Bench/P1").check(&Robot::default()).verdict, Verdict::Agrees);
    let kinds: Vec<_> = file.not_taken.iter().map(|kind| kind.kind.as_str()).collect();
    assert!(kinds.contains(&"redundancy of another robot"), "{kinds:?}");
    assert!(kinds.contains(&"redundancy LBRAlphaRedundancy"), "{kinds:?}");
}

#[test]
fn names_that_programs_cannot_have_are_changed() {
    let world = frame_element("robot", &BENCH, &frame_element("P1", &BENCH, ""))
        + &frame_element("A", &BENCH, &frame_element("B", &BENCH, ""))
        + &frame_element("A", &BENCH, "")
        + &frame_element("A/B", &BENCH, "")
        + &frame_element("A", &BENCH, "")
        + &frame_element("", &BENCH, "");
    let tool = |name: &str, frames: &str| {
        format!("<toolTemplate name=\"{name}\"><frames>{frames}</frames></toolTemplate>")
    };
    let tips = ["TCP", "left", "left", "a/b"].map(|name| frame_element(name, &TCP, "")).concat();
    let cell = imported(&file(&world, &(tool("flange", &tips) + &tool("x/y", ""))));
    let frames: Vec<_> = cell.frames.iter().map(|frame| frame.name.as_str()).collect();
    assert_eq!(frames, ["robot_2", "robot_2/P1", "A", "A/B", "A_2", "A_B", "A_3", "unnamed"]);
    assert_eq!(cell.workcell.frames["robot_2/P1"].base.as_deref(), Some("robot_2"));
    assert_eq!(cell.workcell.tools.keys().collect::<Vec<_>>(), ["flange_2", "x_y"]);
    assert_eq!(cell.tools[0].tips, ["left", "left_2", "a_b"]);
    for base in cell.workcell.bases.keys() {
        cell.workcell.base(Some(base)).unwrap();
    }
    for tip in &cell.tools[0].tips {
        cell.workcell.tcp(Some(&format!("flange_2/{tip}"))).unwrap();
    }
    let renamed: Vec<_> =
        cell.renamed.iter().map(|entry| (entry.from.as_str(), entry.to.as_str())).collect();
    for pair in [("/robot", "robot_2"), ("/A", "A_3"), ("/A/B", "A_B"), ("flange", "flange_2")] {
        assert!(renamed.contains(&pair), "{pair:?} in {renamed:?}");
    }
    // Children of a renamed frame are renamed without a separate entry.
    assert!(!renamed.contains(&("/robot/P1", "robot_2/P1")), "{renamed:?}");
}

#[test]
fn skipped_entries_are_counted() {
    let world = frame_element("A", &BENCH, "<colour/><measurementRotation/>")
        + &frame_element("B", &BENCH, "<colour/>")
        + "<plane/>";
    let text = file(&world, "<workpieceTemplate name=\"Nut\"/><workpieceTemplate name=\"Bolt\"/>")
        .replace(
            "</RoboticsAPIData>",
            "<processDataContainer><processData \
             id=\"speed\"/></processDataContainer></RoboticsAPIData>",
        )
        .replace("version=\"3\"", "version=\"4\"")
        .replace("z=\"9.81\"", "z=\"-9.81\"");
    let file = DataFile::from_xml(&text).unwrap();
    let count = |expected_kind: &str| {
        let kind = file.not_taken.iter().find(|kind| kind.kind == expected_kind);
        kind.map_or(0, |kind| kind.count)
    };
    let actual =
        ["<colour>", "<plane>", "workpieceTemplate", "processData", "measurement"].map(count);
    assert_eq!(actual, [2, 1, 2, 1, 1]);
    assert_eq!((count("gravitation"), count("version 4")), (1, 1));
    let gravity = file.not_taken.iter().find(|kind| kind.kind == "gravitation").unwrap();
    assert!(gravity.reason.contains("-9.81"), "{}", gravity.reason);
    assert_eq!(file.frames.len(), 2);
}

#[test]
fn workpieces_and_process_data_are_kept_for_who_asks() {
    let workpiece =
        gripper().replace("toolTemplate", "workpieceTemplate").replace("Gripper", "Box");
    let broken = "<workpieceTemplate><frames><frame/></frames></workpieceTemplate>";
    let text = file("", &(workpiece + broken)).replace(
        "</RoboticsAPIData>",
        "<processDataContainer>\
         <processData dataType=\"java.lang.Double\" defaultValue=\"0.5\" id=\"speed\" min=\"0.1\" \
         value=\"0.3\"/>\
         <processData/></processDataContainer></RoboticsAPIData>",
    );
    let file = DataFile::from_xml(&text).unwrap();
    // A workpiece without a name cannot be requested, and does not prevent reading the frames.
    let [workpiece] = file.workpieces.as_slice() else { panic!("{:?}", file.workpieces) };
    assert_eq!((workpiece.name.as_str(), workpiece.frames.len()), ("Box", 2));
    assert_eq!(workpiece.load.map(|load| load.mass_kg), Some(1.25));
    let [data] = file.process_data.as_slice() else { panic!("{:?}", file.process_data) };
    let actual =
        (data.id.as_str(), data.value.as_deref(), data.min.as_deref(), data.max.as_deref());
    assert_eq!(actual, ("speed", Some("0.3"), Some("0.1"), None));
    assert!(ImportedCell::new(&file).workcell.tools.is_empty());
}

#[test]
fn a_status_that_there_is_not_is_left_out() {
    let text = project().replacen("StatusParameter\" value=\"", "StatusParameter\" value=\"9", 1);
    let file = DataFile::from_xml(&text).unwrap();
    assert!(file.not_taken.iter().any(|kind| kind.kind.starts_with("StatusParameter 9")));
    assert_eq!(ImportedCell::new(&file).workcell.frames["Bench/P1"].status, None);
}

#[test]
fn errors_state_their_place() {
    let nested = "<frame>".repeat(200);
    let bench = r#"<frame name="A"><transformation a="0" b="0" c="0" x="1" y="2" z="3"/></frame>"#;
    let world = |inner: &str| {
        format!("<RoboticsAPIData>\n <world>\n  {inner}\n </world>\n</RoboticsAPIData>")
    };
    for (text, place, message) in [
        (String::new(), (1, 1), "it has no element"),
        ("<urdf/>".to_owned(), (1, 1), "the outermost element is <urdf>"),
        (world("<frame name=\"A\">"), (4, 2), "this is not XML"),
        (world("<frame name=\"A\"/>"), (3, 3), "<frame> has no transformation"),
        (world(&bench.replace("name=\"A\"", "")), (3, 3), "<frame> has no name"),
        (world(&bench.replace("z=\"3\"", "")), (3, 19), "<transformation> has no z"),
        (world(&bench.replace("z=\"3\"", "z=\"up\"")), (3, 19), "z is \"up\"; it must be a finite"),
        (world(&bench.replace("z=\"3\"", "z=\"NaN\"")), (3, 19), "it must be a finite number"),
        (world(&bench.replace("z=\"3\"", "z=3")), (3, 19), "this is not XML"),
        (world(bench) + "<x/>", (5, 19), "a second outermost element"),
        (
            world(bench).replace("</RoboticsAPIData>", ""),
            (5, 1),
            "it ends inside <RoboticsAPIData>",
        ),
        (world(&nested), (3, 689), "nested more than 100 deep"),
    ] {
        let error = DataFile::from_xml(&text).unwrap_err();
        assert!(error.to_string().contains(message), "{message}: {error}");
        let actual = (error.place().line, error.place().column);
        assert_eq!(actual, place, "{message}: {error}");
        assert!(!error.message().contains("line "), "{}", error.message());
    }
}

/// Generates trees of frames: each is a child of a previous frame, or of the world.
fn trees() -> impl Strategy<Value = Vec<(Option<usize>, String, Frame)>> {
    let number = -500.0..500.0_f64;
    let angle = -3.0..3.0_f64;
    let frame = (prop::array::uniform3(number), prop::array::uniform3(angle))
        .prop_map(|(xyz_mm, abc_rad)| Frame { xyz_mm, abc_rad });
    let entry = (any::<prop::sample::Index>(), "[AB/]{0,2}|robot|A_2", frame);
    prop::collection::vec(entry, 1..25).prop_map(|entries| {
        let place =
            |(index, (parent, name, frame)): (usize, (prop::sample::Index, String, Frame))| {
                (parent.index(index + 1).checked_sub(1), name, frame)
            };
        entries.into_iter().enumerate().map(place).collect()
    })
}

fn element_of(tree: &[(Option<usize>, String, Frame)], index: usize) -> String {
    let children = (0..tree.len()).filter(|child| tree[*child].0 == Some(index));
    let inner = children.fold(String::new(), |mut inner, child| {
        let _ = write!(inner, "{}", element_of(tree, child));
        inner
    });
    frame_element(&tree[index].1, &tree[index].2, &inner)
}

proptest! {
    /// Each frame has a unique name and keeps its pose, for any nesting and naming.
    #[test]
    fn every_frame_stays_where_it_is(tree in trees()) {
        let outer = (0..tree.len()).filter(|index| tree[*index].0.is_none());
        let elements: String = outer.map(|index| element_of(&tree, index)).collect();
        let cell = imported(&file(&elements, ""));
        prop_assert_eq!(cell.frames.len(), tree.len());
        let expected = |mut index: usize| {
            let mut pose = tree[index].2.pose();
            while let Some(parent) = tree[index].0 {
                pose = tree[parent].2.pose().then(&pose);
                index = parent;
            }
            pose
        };
        // Frames are in file order, each before its children.
        let mut order = Vec::new();
        let mut open: Vec<usize> =
            (0..tree.len()).rev().filter(|index| tree[*index].0.is_none()).collect();
        while let Some(index) = open.pop() {
            order.push(index);
            open.extend((0..tree.len()).rev().filter(|child| tree[*child].0 == Some(index)));
        }
        let mut names = std::collections::BTreeSet::new();
        for (actual, index) in cell.frames.iter().zip(order) {
            prop_assert!(names.insert(actual.name.clone()));
            let pose = if actual.is_base {
                cell.workcell.base(Some(&actual.name)).unwrap()
            } else {
                cell.workcell.target(&actual.name.as_str().into(), None).unwrap().1
            };
            let expected = expected(index);
            for pose in [pose, actual.pose] {
                for i in 0..3 {
                    prop_assert!((pose.position_m[i] - expected.position_m[i]).abs() < 1e-9);
                }
            }
        }
        prop_assert_eq!(Workcell::from_json(&cell.workcell.to_json()).unwrap(), cell.workcell);
    }

    /// A damaged text is either read, or refused with a place in it, without a panic.
    #[test]
    fn damaged_files_are_refused_or_read(
        position in any::<prop::sample::Index>(),
        by in "[<>/\"=&; a0-]{0,3}",
    ) {
        let text = project();
        let position = position.index(text.len());
        let rest = &text[(position + 1).min(text.len())..];
        let damaged = format!("{}{by}{rest}", &text[..position]);
        match DataFile::from_xml(&damaged) {
            Ok(file) => {
                ImportedCell::new(&file).frames.iter().for_each(|frame| {
                    let _ = frame.check(&Robot::default());
                });
            }
            Err(error) => prop_assert!(error.place().span.end <= damaged.len() + 1),
        }
    }
}
