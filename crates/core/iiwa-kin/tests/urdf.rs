//! URDF export, and comparison of URDF files with a model. Independent readers are in
//! `tests/peers`.

// Texts are assembled by plain string operations; test helpers may panic.
#![allow(
    clippy::float_cmp,
    clippy::format_collect,
    clippy::format_push_string,
    clippy::panic,
    clippy::unwrap_used
)]

use iiwa_kin::{Robot, RosNames, UrdfError, UrdfReport};
use proptest::prelude::*;

use crate::urdf_examples::{namings, odd_name, robots};

#[test]
fn other_names_change_nothing_else() {
    let robot = Robot::default();
    for (names, [joint, base, flange_joint, flange]) in namings() {
        let urdf = robot.to_urdf_with_names(&names);
        let report = robot.check_urdf(&urdf, None).unwrap();
        assert_eq!((&*report.base, &*report.tip), (base, flange));
        assert_eq!(report.joints[0], joint);
        assert_eq!(report.joints, names.joints());
        let all = |names: &RosNames, flange_joint: &str| {
            names.joints().into_iter().chain([flange_joint.to_owned()]).chain(names.links())
        };
        let usual_names = all(&RosNames::default(), "iiwa_joint_ee");
        let renamed =
            all(&names, flange_joint).zip(usual_names).fold(urdf, |text, (name, usual)| {
                text.replace(&format!("\"{name}\""), &format!("\"{usual}\""))
            });
        assert_eq!(renamed, robot.to_urdf());
    }
}

#[test]
fn a_prefix_is_a_valid_ros_name() {
    let long = "a".repeat(50);
    for good in ["a", "iiwa", "Left_2", &long] {
        assert_eq!(good.parse::<iiwa_kin::RosPrefix>().unwrap().to_string(), good);
    }
    let longer = "a".repeat(51);
    for bad in ["", "2nd", "_a", "a-b", "a b", "a/b", "l\u{e4}", "a\"", &longer] {
        let error = bad.parse::<iiwa_kin::RosPrefix>().unwrap_err().to_string();
        assert!(error.contains("1 to 50 letters"), "{bad}: {error}");
    }
}

#[test]
fn a_name_cannot_break_the_xml() {
    let robot = odd_name();
    robot.check_urdf(&robot.to_urdf(), None).unwrap();
}

#[test]
fn the_exported_urdf_is_the_model() {
    for robot in robots() {
        let report = robot.check_urdf(&robot.to_urdf(), None).unwrap();
        assert!(report.position_deviation_m < 1e-12 && report.rotation_deviation_rad < 1e-12);
        assert_eq!((&*report.base, &*report.tip), ("iiwa_link_0", "iiwa_link_ee"));
        assert_eq!(report.joints[6], "iiwa_joint_7");
        assert!(report.limits.is_empty());
        assert!(report.poses >= 100);
    }
}

/// An LBR iiwa 7 R800 whose link frames are on the joint axes at the bolted interfaces between
/// links.
fn other_frames() -> String {
    let mut text =
        String::from("<?xml version=\"1.0\"?>\n<!-- seven joints -->\n<robot name='lbr'>\n");
    let names = ["world", "link_0", "link_1", "link_2", "link_3", "link_4", "link_5", "link_6"];
    for name in names.iter().chain(&["link_7", "link_ee"]) {
        text += &format!("<link name='{name}'/>\n");
    }
    let quarter = std::f64::consts::FRAC_PI_2;
    let back = format!("{quarter} 0 0");
    let forth = format!("-{quarter} 0 0");
    for (name, kind, parent, child, xyz, rpy, axis) in [
        ("world_joint", "fixed", "world", "link_0", "1 2 0.7", "0 0 0.3", ""),
        ("A1", "revolute", "link_0", "link_1", "0 0 0.1475", "0 0 0", "0 0 1"),
        ("A2", "revolute", "link_1", "link_2", "0 -0.0105 0.1925", &forth, "0 0 2"),
        ("A3", "revolute", "link_2", "link_3", "0 -0.2075 0.0105", &back, "0 0 1"),
        ("A4", "revolute", "link_3", "link_4", "0 0.0105 0.1925", "0 0 0", "0 -1 0"),
        ("A5", "revolute", "link_4", "link_5", "0 -0.0105 0.2075", "0 0 0", "0 0 1"),
        ("A6", "revolute", "link_5", "link_6", "0 -0.0707 0.1925", "0 0 0", "0 1 0"),
        ("A7", "revolute", "link_6", "link_7", "0 0.0707 0.091", "0 0 0", "0 0 1"),
        ("ee", "fixed", "link_7", "link_ee", "0 0 0.061", "0 0 0", ""),
    ] {
        text += &format!(
            "<joint name='{name}' type='{kind}'><parent link='{parent}'/><child link='{child}'/>\
             <origin xyz='{xyz}' rpy='{rpy}'/>"
        );
        if kind == "revolute" {
            text += &format!("<axis xyz='{axis}'/><limit effort='200' velocity='10'/>");
        }
        text += "</joint>\n";
    }
    text + "<gazebo><joint name='A1'/></gazebo>\n</robot>\n"
}

#[test]
fn frames_may_lie_elsewhere() {
    let report = Robot::default().check_urdf(&other_frames(), None).unwrap();
    assert!(report.position_deviation_m < 1e-12 && report.rotation_deviation_rad < 1e-12);
    assert_eq!((&*report.base, &*report.tip), ("link_0", "link_ee"));
    // No positions, other speeds and torques.
    assert_eq!(report.limits.len(), 28);
    assert_eq!((report.limits[0].limit, report.limits[0].urdf), ("lower", None));
    assert_eq!((report.limits[2].limit, report.limits[2].urdf), ("effort", Some(200.0)));
}

#[test]
fn a_byte_order_mark_is_skipped() {
    let robot = Robot::default();
    robot.check_urdf(&format!("\u{feff}{}", robot.to_urdf()), None).unwrap();
}

#[test]
fn rounded_quarter_turns_pass() {
    let text = other_frames().replace("1.5707963267948966", "1.5708");
    let report = Robot::default().check_urdf(&text, None).unwrap();
    assert!(report.position_deviation_m > 1e-7);
    assert!(report.position_deviation_m < UrdfReport::TOLERANCE_M);
}

#[test]
fn another_model_is_detected_at_its_first_joint() {
    let big = Robot::lbr_iiwa_14_r820();
    match big.check_urdf(&other_frames(), None).unwrap_err() {
        UrdfError::Axis { number: 2, joint, position_m, rotation_rad, .. } => {
            assert_eq!(joint, "A2");
            assert!((position_m - 0.02).abs() < 1e-12 && rotation_rad < 1e-12);
        }
        other => panic!("{other}"),
    }
}

#[test]
fn a_millimetre_is_detected_at_its_joint() {
    let robot = Robot::default();
    let urdf = robot.to_urdf();
    // The upper arm ends at joint 4.
    let error = robot.check_urdf(&urdf.replace("0 0 0.4\"", "0 0 0.401\""), None).unwrap_err();
    let message = error.to_string();
    assert!(message.contains("axis of joint 4 (\"iiwa_joint_4\") is 1.000 mm"), "{message}");
    let line = urdf.lines().position(|line| line.contains("\"iiwa_joint_4\"")).unwrap() + 1;
    assert_eq!(error.place().line, line);
    assert!(message.ends_with(&format!("at line {line}, column 3")), "{message}");
    assert!(message.starts_with(&error.message()) && !error.message().contains("line"));
    // A wrong direction of rotation.
    let text = other_frames().replace("0 1 0", "0 -1 0");
    let error = robot.check_urdf(&text, None).unwrap_err();
    assert!(matches!(error, UrdfError::Axis { number: 6, .. }), "{error}");
    // A rotated zero of joint 3 is detected at joint 4, that of joint 7 at the flange.
    let text =
        other_frames().replace("0 0.0105 0.1925' rpy='0 0 0", "0 0.0105 0.1925' rpy='0 0 0.01");
    let error = robot.check_urdf(&text, None).unwrap_err();
    assert!(matches!(error, UrdfError::Axis { number: 4, .. }), "{error}");
    let text = other_frames().replace("0 0 0.061' rpy='0 0 0", "0 0 0.061' rpy='0 0 0.01");
    let error = robot.check_urdf(&text, None).unwrap_err();
    assert!(
        matches!(&error, UrdfError::Tip { tip, rotation_rad, .. }
            if tip == "link_ee" && (rotation_rad - 0.01).abs() < 1e-12),
        "{error}"
    );
}

#[test]
fn a_different_flange_is_detected() {
    let short = Robot::default().with_flange_m(0.126).unwrap();
    let error = short.check_urdf(&other_frames(), None).unwrap_err();
    assert!(error.to_string().contains("26.000 mm"), "{error}");
    let text = other_frames().replace("0 0 0.061", "0 0 0.035");
    short.check_urdf(&text, None).unwrap();
}

#[test]
fn the_tip_can_be_named() {
    let robot = Robot::default();
    let tool = "<link name='tool'/><joint name='t' type='fixed'><parent link='link_ee'/>\
                <child link='tool'/><origin xyz='0 0 0.1'/></joint>";
    let longer = other_frames().replace("</robot>", &format!("{tool}</robot>"));
    assert!(matches!(robot.check_urdf(&longer, None), Err(UrdfError::Tip { .. })));
    robot.check_urdf(&longer, Some("link_ee")).unwrap();
    let error = robot.check_urdf(&longer, Some("flange")).unwrap_err();
    assert!(error.to_string().contains("link_7, link_ee, tool"), "{error}");
    // A moving finger is beyond the tip.
    let finger = tool.replace("fixed", "prismatic");
    let gripper = other_frames().replace("</robot>", &format!("{finger}</robot>"));
    assert_eq!(robot.check_urdf(&gripper, None).unwrap().tip, "link_ee");
    let error = robot.check_urdf(&gripper, Some("tool")).unwrap_err();
    assert!(matches!(error, UrdfError::JointKind { .. }), "{error}");
    // Two links at the same depth.
    let fork = tool.replace("'link_ee'", "'link_7'");
    let fork = other_frames().replace("</robot>", &format!("{fork}</robot>"));
    let error = robot.check_urdf(&fork, None).unwrap_err();
    assert!(error.to_string().contains("link_ee, tool"), "{error}");
    robot.check_urdf(&fork, Some("link_ee")).unwrap();
}

#[test]
fn invalid_files_are_reported() {
    let robot = Robot::default();
    let good = other_frames();
    let a4 = good.lines().position(|line| line.contains("'A4'")).unwrap() + 1;
    let cases = [
        ("", "it has no element", 1),
        ("no xml", "text before the outermost element", 1),
        ("<robot/>\nrest", "text after the outermost element", 2),
        ("<robot/>\n&amp;", "text after the outermost element", 2),
        ("<robot>", "it ends inside 1 open elements", 1),
        ("<robot>\n</link>", "", 2),
        ("<robot name='a", "", 1),
        ("<sdf/>", "<sdf>; a URDF has <robot>", 1),
        ("<robot/><robot/>", "second outermost", 1),
        ("<robot/>", "the robot has no <link>", 1),
        ("<robot><link/></robot>", "a link has no name", 1),
        ("<robot><link name='a'/></robot>", "0 revolute joints", 1),
        ("<robot><link name='a' name='b'/></robot>", "appears twice", 1),
        ("<robot><link name='&a;'/></robot>", "the entity &a;", 1),
        ("<robot><link name='&#0;'/></robot>", "this is not XML", 1),
        ("<robot>\n<link name='a'/>\n<link name='a'/></robot>", "appears twice", 3),
    ];
    for (text, expected, line) in cases {
        let error = robot.check_urdf(text, None).unwrap_err();
        assert!(error.to_string().contains(expected), "{text}: {error}");
        assert_eq!(error.place().line, line, "{text}: {error}");
    }
    for (old, new, expected) in [
        ("'A4' type='revolute'", "'A4' type='continuous'", "\"A4\" is continuous"),
        ("'A4' type='revolute'", "'A4' type='prismatic'", "\"A4\" is prismatic"),
        ("'A4' type='revolute'", "'A4'", "joint \"A4\" has no type"),
        ("'A4'", "'A3'", "joint \"A3\" appears twice"),
        ("<axis xyz='0 -1 0'/>", "<axis xyz='0 -1 0'/><mimic joint='A1'/>", "\"A4\" is mimic"),
        ("<axis xyz='0 -1 0'/>", "<axis xyz='0 0 0'/>", "axis 0 0 0"),
        ("<axis xyz='0 -1 0'/>", "<axis xyz='0 1'/>", "\"0 1\"; it must be 3 finite numbers"),
        ("<axis xyz='0 -1 0'/>", "<axis xyz='0 1 0 0'/>", "it must be 3 finite numbers"),
        ("<axis xyz='0 -1 0'/>", "<axis xyz='0 NaN 0'/>", "it must be 3 finite numbers"),
        ("<axis xyz='0 -1 0'/>", "<axis xyz='0 -1 0'/><axis/>", "appears twice"),
        ("<axis xyz='0 -1 0'/>", "<axis xyz='1e300 -1e300 0'/>", "45.0000 deg"),
        ("0 0.0105 0.1925", "0 inf 0.1925", "it must be 3 finite numbers"),
        ("0 0.0105 0.1925", "0 1e400 0.1925", "it must be 3 finite numbers"),
        ("0 0.0105 0.1925", "0 0.0105 ${d3}", "expand the xacro"),
        ("0 0.0105 0.1925", "1e308 0 1e308", "(\"A4\") is inf mm"),
        ("<parent link='link_3'/>", "<parent link='nowhere'/>", "\"nowhere\""),
        ("<parent link='link_3'/>", "<parent/>", "has no link"),
        ("<parent link='link_3'/>", "", "joint \"A4\" has no <parent>"),
        ("<child link='link_4'/>", "<child link='link_3'/>", "as another joint does"),
        ("<child link='link_4'/>", "", "joint \"A4\" has no <child>"),
    ] {
        let text = good.replace(old, new);
        assert_ne!(text, good);
        let error = robot.check_urdf(&text, None).unwrap_err();
        assert!(error.to_string().contains(expected), "{new}: {error}");
        assert_eq!(error.place().line, a4, "{new}: {error}");
    }
    let text = good.replace("'A4' type='revolute'", "'A4' type='fixed'");
    let error = robot.check_urdf(&text, None).unwrap_err();
    assert!(error.to_string().contains("\"link_ee\" has 6 revolute joints"), "{error}");
}

/// A joint between a new link `rail` and the mounting of [`other_frames`].
fn on_a(kind: &str) -> String {
    other_frames().replace(
        "</robot>",
        &format!(
            "<link name='rail'/><joint name='r' type='{kind}'><parent link='rail'/>\
             <child link='world'/><axis xyz='1 0 0'/></joint></robot>"
        ),
    )
}

#[test]
fn a_mounting_may_move() {
    let robot = Robot::default();
    for kind in ["prismatic", "floating", "planar", "continuous"] {
        let report = robot.check_urdf(&on_a(kind), None).unwrap();
        assert_eq!((&*report.base, &*report.tip), ("link_0", "link_ee"), "{kind}");
        assert_eq!(report.joints[0], "A1", "{kind}");
        assert!(report.position_deviation_m < 1e-12, "{kind}");
        // A mounting does not hide a fault of the arm.
        let text = on_a(kind).replace("'A4' type='revolute'", "'A4' type='fixed'");
        let error = robot.check_urdf(&text, None).unwrap_err();
        assert!(error.to_string().contains("has 6 revolute joints"), "{kind}: {error}");
        let text = on_a(kind).replace("'A4' type='revolute'", "'A4' type='prismatic'");
        let error = robot.check_urdf(&text, None).unwrap_err();
        assert!(error.to_string().contains("\"A4\" is prismatic"), "{kind}: {error}");
    }
}

#[test]
fn meshes_need_no_single_tip() {
    let robot = Robot::default();
    let fixed = |name: &str, parent: &str| {
        format!(
            "<link name='{name}'><visual><origin xyz='0 0 0.1'/><geometry>\
             <mesh filename='{name}.stl'/></geometry></visual></link><joint name='{name}' \
             type='fixed'><parent link='{parent}'/><child link='{name}'/></joint>"
        )
    };
    let two = fixed("tool0", "link_ee") + &fixed("flange", "link_ee");
    let text = other_frames().replace("</robot>", &format!("{two}</robot>"));
    let error = robot.check_urdf(&text, None).unwrap_err();
    assert!(matches!(error, UrdfError::AmbiguousTip { .. }), "{error}");
    let links = robot.urdf_meshes(&text).unwrap();
    let files: Vec<_> = links[7].visual.iter().map(|mesh| &*mesh.file).collect();
    assert_eq!(files, ["tool0.stl", "flange.stl"]);
    for mesh in &links[7].visual {
        // From the flange, 152 mm from the wrist.
        assert!((mesh.pose.position_m[2] - 0.252).abs() < 1e-12, "{:?}", mesh.pose);
    }

    // Two arms: neither of them is chosen by its depth.
    let left =
        other_frames().replace("<robot name='lbr'>", "<robot name='lbr'><link name='floor'/>");
    let right = &left[left.find("<link name='world'").unwrap()..left.find("<gazebo").unwrap()];
    let right = right.replace("name='", "name='r_").replace("link='", "link='r_");
    let ends = fixed("tool0", "link_ee");
    let both = left.replace("</robot>", &format!("{right}{ends}</robot>"));
    let error = robot.urdf_meshes(&both).unwrap_err().to_string();
    assert!(error.contains("several arms have seven joints, with the last links"), "{error}");
    assert!(error.contains("link_7, r_link_7"), "{error}");
}

#[test]
fn unexpanded_files_are_named() {
    let robot = Robot::default();
    let xacro = "<?xml version=\"1.0\"?>\n<robot xmlns:xacro='http://wiki.ros.org/xacro' \
                 name='iiwa'>\n<xacro:include filename='iiwa7.xacro'/></robot>";
    for result in [
        robot.check_urdf(xacro, None).map(drop),
        robot.urdf_meshes(xacro).map(drop),
        robot
            .check_urdf(&xacro.replace("<xacro:i", "<link name='world'/><xacro:i"), None)
            .map(drop),
    ] {
        let error = result.unwrap_err();
        assert!(error.to_string().contains("a xacro file with <xacro:include>"), "{error}");
        assert_eq!(error.place().line, 3);
    }
    // An expanded file keeps the namespace.
    let expanded =
        other_frames().replace("<robot ", "<robot xmlns:xacro='http://wiki.ros.org/xacro' ");
    robot.check_urdf(&expanded, None).unwrap();

    let entity = "<!DOCTYPE robot [<!ENTITY v \"1.7\">]>\n<robot><link name='&v;3'/></robot>";
    let error = robot.check_urdf(entity, None).unwrap_err();
    assert!(
        error.to_string().starts_with("the entity &v; is defined by a document type"),
        "{error}"
    );
    assert_eq!(error.place().line, 2);
}

#[test]
fn a_cycle_of_joints_is_detected() {
    let text = "<robot><link name='a'/><link name='b'/>\
        <joint name='j' type='revolute'><parent link='a'/><child link='b'/></joint>\
        <joint name='k' type='revolute'><parent link='b'/><child link='a'/></joint></robot>";
    for tip in [None, Some("b")] {
        let error = Robot::default().check_urdf(text, tip).unwrap_err();
        assert!(matches!(error, UrdfError::Cycle { .. }), "{error}");
    }
    let text = other_frames().replace("<parent link='link_3'/>", "<parent link='link_5'/>");
    let error = Robot::default().check_urdf(&text, Some("link_ee")).unwrap_err();
    assert!(matches!(error, UrdfError::Cycle { .. }), "{error}");
}

/// If the time were quadratic in the file length, this test would take hours.
#[test]
fn huge_files_are_refused() {
    let open = "<a>".repeat(3_500_000);
    let closed = format!("<robot>{open}{}</robot>", "</a>".repeat(3_500_000));
    let attributes: String = (0..1_000_000).map(|i| format!("a{i}='' ")).collect();
    let attributes = format!("<robot {attributes}/>");
    let mut links = String::from("<robot>");
    for i in 0..100_000 {
        links += &format!("<link name='{i}'/>");
    }
    let mut chain = links.clone();
    for i in 1..100_000 {
        let kind = if i % 3 == 0 { "fixed" } else { "revolute" };
        let up = i - 1;
        chain += &format!(
            "<joint name='{i}' type='{kind}'><parent link='{up}'/><child link='{i}'/></joint>"
        );
    }
    for text in [open, closed, attributes, links + "</robot>", chain + "</robot>"] {
        Robot::default().check_urdf(&text, None).unwrap_err();
    }
}

/// Deeply nested elements are skipped; otherwise this test would take minutes.
#[test]
fn meshes_are_found_beside_deep_elements() {
    let mesh = "<visual><geometry><mesh filename='a.stl'/></geometry></visual>";
    let depth = 1_000_000;
    let deep =
        format!("<visual>{}{}</visual>", "<geometry>".repeat(depth), "</geometry>".repeat(depth));
    let inside = "<visual><geometry><a><mesh filename='b.stl'/></a></geometry></visual>";
    let text = other_frames().replace(
        "<link name='link_2'/>",
        &format!("<link name='link_2'>{deep}{inside}{mesh}</link>"),
    );
    let links = Robot::default().urdf_meshes(&text).unwrap();
    let files: [Vec<&str>; 8] =
        links.each_ref().map(|link| link.visual.iter().map(|mesh| &*mesh.file).collect());
    let mut expected: [Vec<&str>; 8] = Default::default();
    expected[2] = vec!["a.stl"];
    assert_eq!(files, expected);
}

/// Lines are counted on from mesh to mesh; counting from the start of the file each time would take
/// minutes.
#[test]
fn meshes_have_their_places() {
    let pair = "<visual><geometry><mesh filename='\u{e4}'/></geometry></visual>\t\u{fc}\
                <collision><geometry><mesh\n filename='b'/></geometry></collision>\n";
    let count = 200_000;
    let head = "<link name='link_2'>";
    let text = other_frames()
        .replace("<link name='link_2'/>", &format!("{head}{}</link>", pair.repeat(count)));
    let links = Robot::default().urdf_meshes(&text).unwrap();
    let first = text.lines().position(|line| line.starts_with(head)).unwrap() + 1;
    let column = |text: &str, behind: &str| text[..text.rfind(behind).unwrap()].chars().count() + 1;
    let line = pair.lines().next().unwrap();
    let columns = [line.find("<mesh").unwrap() + 1, column(line, "<mesh")];
    for (shapes, column) in [&links[2].visual, &links[2].collision].into_iter().zip(columns) {
        assert_eq!(shapes.len(), count);
        for (k, mesh) in shapes.iter().enumerate() {
            let shift = if k == 0 { head.len() } else { 0 };
            assert_eq!((mesh.place.line, mesh.place.column), (first + 2 * k, column + shift));
            let tag = &text[mesh.place.span.clone()];
            assert!(tag.starts_with("<mesh") && tag.ends_with("/>"), "{tag}");
        }
    }
}

proptest! {
    /// Any change to a valid file is either harmless or an error, never a panic.
    #[test]
    fn never_panics(
        from in 0_usize..3000,
        length in 0_usize..40,
        with in "[<>/a='\" &;!\\[\\]?\\-0e9]{0,8}",
        is_model in any::<bool>(),
    ) {
        let robot = Robot::default();
        let text = if is_model { robot.to_urdf() } else { other_frames() };
        let from = from.min(text.len());
        let to = (from + length).min(text.len());
        let text = format!("{}{with}{}", &text[..from], &text[to..]);
        if let Err(error) = robot.check_urdf(&text, None) {
            prop_assert!(!error.to_string().is_empty());
            prop_assert!(error.place().span.end <= text.len());
        }
    }

    #[test]
    fn any_text_is_refused(
        text in "(<|>|/|robot|link|joint|name|=|'|\"| |a|type|revolute|&|<!--|-->|<!\\[CDATA\\[|\
                 \\]\\]>|<\\?|<!DOCTYPE|\u{fffd}|ü){0,40}"
    ) {
        prop_assert!(Robot::default().check_urdf(&text, None).is_err());
    }
}
