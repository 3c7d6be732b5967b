//! URDF against independent readers: `urdf-rs` for the text, `k` for the kinematics.

// Texts are put together plainly; helpers of tests may fail.
#![allow(
    clippy::float_cmp,
    clippy::format_collect,
    clippy::format_push_string,
    clippy::panic,
    clippy::unwrap_used
)]

use std::time::Instant;

use iiwa_kin::{Joints, Robot, RosNames, RosStack, UrdfError, UrdfReport};
use nalgebra::{
    Isometry3, Matrix3, Point3, Rotation3, SymmetricEigen, Translation3, UnitQuaternion, Vector3,
};
use proptest::prelude::*;

/// Every model and flange that is written as a URDF here.
fn robots() -> Vec<Robot> {
    [Robot::lbr_iiwa_7_r800(), Robot::lbr_iiwa_14_r820()]
        .into_iter()
        .flat_map(|robot| [robot.clone().with_flange_m(0.126).unwrap(), robot])
        .collect()
}

/// Poses inside the limits, the same ones every time.
fn poses(robot: &Robot, count: usize) -> Vec<Joints> {
    let mut state = 7_u64;
    let mut random = move || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64 * 2.0 - 1.0
    };
    (0..count).map(|_| robot.limits().upper_rad.map(|limit| 0.999 * limit * random())).collect()
}

/// The crate `k` finds the links of a URDF where they are. Cross-validated: the crate `k`.
fn assert_links_are_found(robot: &Robot, urdf: &str, names: &[String], count: usize) {
    let chain = k::Chain::<f64>::from(urdf_rs::read_from_string(urdf).unwrap());
    for q in poses(robot, count) {
        chain.set_joint_positions(&q).unwrap();
        chain.update_transforms();
        let links = robot.link_poses(&q);
        assert_eq!(links[8], robot.flange_pose(&q));
        for (link, expected) in names.iter().zip(&links) {
            let found = chain.find_link(link).unwrap().world_transform().unwrap();
            let rotation = found.rotation.to_rotation_matrix();
            for i in 0..3 {
                let apart = found.translation.vector[i] - expected.position_m[i];
                assert!(apart.abs() < 1e-12, "{link}: {apart} m");
                for c in 0..3 {
                    let apart = rotation[(i, c)] - expected.rotation[i][c];
                    assert!(apart.abs() < 1e-12, "{link}: {apart}");
                }
            }
        }
    }
}

#[test]
fn k_finds_the_same_poses() {
    let links: Vec<_> =
        (0..8).map(|link| format!("iiwa_link_{link}")).chain(["iiwa_link_ee".to_owned()]).collect();
    for robot in robots() {
        assert_links_are_found(&robot, &robot.to_urdf(), &links, 1000);
    }
}

/// Names of ROS packages, with their own prefix and with another.
fn namings() -> [(RosNames, [&'static str; 4]); 4] {
    let of = |stack, prefix: &str| RosNames::new(stack, Some(prefix.parse().unwrap()));
    [
        (RosNames::default(), ["iiwa_joint_1", "iiwa_link_0", "iiwa_joint_ee", "iiwa_link_ee"]),
        (
            RosNames::new(RosStack::LbrFriRos2Stack, None),
            ["lbr_A1", "lbr_link_0", "lbr_joint_ee", "lbr_link_ee"],
        ),
        (
            of(RosStack::LbrFriRos2Stack, "left"),
            ["left_A1", "left_link_0", "left_joint_ee", "left_link_ee"],
        ),
        (of(RosStack::IiwaStack, "R2"), ["R2_joint_1", "R2_link_0", "R2_joint_ee", "R2_link_ee"]),
    ]
}

#[test]
fn other_names_have_the_same_poses() {
    let robot = Robot::default();
    for (names, [joint, base, flange_joint, flange]) in namings() {
        let urdf = robot.to_urdf_with_names(&names);
        assert_links_are_found(&robot, &urdf, &names.links(), 100);
        let read = urdf_rs::read_from_string(&urdf).unwrap();
        let joints: Vec<_> = read.joints.iter().map(|joint| &*joint.name).collect();
        assert_eq!((joints[0], joints[7]), (joint, flange_joint));
        let report = robot.check_urdf(&urdf, None).unwrap();
        assert_eq!((&*report.base, &*report.tip), (base, flange));
        assert_eq!(report.joints, names.joints());
        // Nothing but names is different.
        let other = joints.iter().map(|it| (*it).to_owned()).chain(names.links());
        let usual = robot.to_urdf();
        let usual_read = urdf_rs::read_from_string(&usual).unwrap();
        let usual_names = usual_read.joints.iter().map(|it| it.name.clone());
        let usual_names = usual_names.chain(RosNames::default().links());
        let renamed = other.zip(usual_names).fold(urdf, |text, (name, usual)| {
            text.replace(&format!("\"{name}\""), &format!("\"{usual}\""))
        });
        assert_eq!(renamed, usual);
    }
}

#[test]
fn a_prefix_is_what_ros_takes() {
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

/// Cross-validated: the crate `urdf-rs`.
#[test]
fn numbers_read_back_exactly() {
    for robot in robots() {
        let read = urdf_rs::read_from_string(&robot.to_urdf()).unwrap();
        assert_eq!(read.name, robot.name());
        for (j, joint) in read.joints.iter().take(7).enumerate() {
            assert_eq!(joint.name, format!("iiwa_joint_{}", j + 1));
            assert_eq!(joint.limit.upper.to_bits(), robot.limits().upper_rad[j].to_bits());
            assert_eq!(joint.limit.lower.to_bits(), robot.limits().lower_rad[j].to_bits());
            assert_eq!(joint.limit.velocity.to_bits(), robot.limits().velocity_rad_s[j].to_bits());
            assert_eq!(joint.limit.effort.to_bits(), robot.limits().torque_nm[j].to_bits());
        }
        for (link, mass) in read.links.iter().zip(robot.link_mass_kg()) {
            assert_eq!(link.inertial.mass.value.to_bits(), mass.to_bits());
        }
        for (link, body) in read.links[1..].iter().zip(robot.links()) {
            let i = &link.inertial.inertia;
            assert_eq!(*link.inertial.origin.xyz, body.center_m);
            assert_eq!([i.ixx, i.ixy, i.ixz, i.iyy, i.iyz, i.izz], body.inertia_kg_m2);
        }
    }
}

#[test]
fn inertias_are_those_of_bodies() {
    for robot in robots() {
        let read = urdf_rs::read_from_string(&robot.to_urdf()).unwrap();
        for link in &read.links[..8] {
            let i = &link.inertial.inertia;
            let tensor =
                Matrix3::new(i.ixx, i.ixy, i.ixz, i.ixy, i.iyy, i.iyz, i.ixz, i.iyz, i.izz);
            let m = SymmetricEigen::new(tensor).eigenvalues;
            assert!(m.min() > 0.0 && 2.0 * m.max() <= m.sum(), "{}: {m}", link.name);
            // Nothing of a link is farther from its centre than 0.4 m.
            assert!(m.max() < link.inertial.mass.value * 0.16);
        }
    }
}

fn isometry(origin: &urdf_rs::Pose) -> Isometry3<f64> {
    let [roll, pitch, yaw] = *origin.rpy;
    let rotation = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
    Isometry3::from_parts(Translation3::from(*origin.xyz), rotation)
}

/// How far `point` is from the inside of `shape`, in m.
fn distance(shape: &urdf_rs::Visual, link: &Isometry3<f64>, point: Point3<f64>) -> f64 {
    let p = (link * isometry(&shape.origin)).inverse_transform_point(&point);
    match shape.geometry {
        urdf_rs::Geometry::Cylinder { radius, length } => {
            let out = (p.x.hypot(p.y) - radius).max(0.0);
            out.hypot((p.z.abs() - length / 2.0).max(0.0))
        }
        urdf_rs::Geometry::Sphere { radius } => (p.coords.norm() - radius).max(0.0),
        _ => panic!("a shape that needs a file"),
    }
}

#[test]
fn shapes_cover_the_arm() {
    for robot in robots() {
        let read = urdf_rs::read_from_string(&robot.to_urdf()).unwrap();
        assert!(read.links.iter().all(|link| link.visual.len() == link.collision.len()));
        for q in poses(&robot, 20).into_iter().chain([[0.0; 7]]) {
            let links = robot.link_poses(&q).map(|pose| pose.to_isometry());
            for pair in links.windows(2) {
                for step in 0..=50 {
                    let share = f64::from(step) / 50.0;
                    let [from, to] = [0, 1].map(|end| pair[end].translation.vector);
                    let point = Point3::from(from.lerp(&to, share));
                    let nearest = read
                        .links
                        .iter()
                        .zip(&links)
                        .flat_map(|(link, pose)| link.visual.iter().map(move |v| (v, pose)))
                        .map(|(shape, pose)| distance(shape, pose, point))
                        .fold(f64::INFINITY, f64::min);
                    assert!(nearest < 1e-9, "{point} is {nearest} m from the arm at {q:?}");
                }
            }
        }
    }
}

#[test]
fn a_name_cannot_break_the_xml() {
    let profile = r#"{ "version": 1, "name": "a \"<b>\" & 'c' ü" }"#;
    let robot = Robot::from_profile(profile).unwrap();
    let read = urdf_rs::read_from_string(&robot.to_urdf()).unwrap();
    assert_eq!(read.name, robot.name());
    robot.check_urdf(&robot.to_urdf(), None).unwrap();
}

#[test]
fn the_own_urdf_is_the_model() {
    for robot in robots() {
        let report = robot.check_urdf(&robot.to_urdf(), None).unwrap();
        assert!(report.position_deviation_m < 1e-12 && report.rotation_deviation_rad < 1e-12);
        assert_eq!((&*report.base, &*report.tip), ("iiwa_link_0", "iiwa_link_ee"));
        assert_eq!(report.joints[6], "iiwa_joint_7");
        assert!(report.limits.is_empty());
        assert!(report.poses >= 100);
    }
}

/// An LBR iiwa 7 R800 whose frames lie along the axes where its links are bolted together.
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
fn another_model_is_told_by_its_first_joint() {
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
fn a_millimetre_is_told_by_its_joint() {
    let robot = Robot::default();
    let own = robot.to_urdf();
    // The upper arm ends in joint 4.
    let error = robot.check_urdf(&own.replace("0 0 0.4\"", "0 0 0.401\""), None).unwrap_err();
    let message = error.to_string();
    assert!(message.contains("axis of joint 4 (\"iiwa_joint_4\") is 1.000 mm"), "{message}");
    let line = own.lines().position(|line| line.contains("\"iiwa_joint_4\"")).unwrap() + 1;
    assert_eq!(error.place().line, line);
    assert!(message.ends_with(&format!("at line {line}, column 3")), "{message}");
    assert!(message.starts_with(&error.what()) && !error.what().contains("line"));
    // A wrong sense of turning.
    let text = other_frames().replace("0 1 0", "0 -1 0");
    let error = robot.check_urdf(&text, None).unwrap_err();
    assert!(matches!(error, UrdfError::Axis { number: 6, .. }), "{error}");
    // A turned zero of joint 3 is seen at joint 4, one of joint 7 at the flange.
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
fn a_flange_that_differs_is_told() {
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
    // A finger that moves is behind the tip.
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
fn says_what_is_wrong() {
    let robot = Robot::default();
    let good = other_frames();
    let a4 = good.lines().position(|line| line.contains("'A4'")).unwrap() + 1;
    let cases = [
        ("", "it has no element", 1),
        ("no xml", "it has no element", 1),
        ("<robot>", "it ends inside 1 open elements", 1),
        ("<robot>\n</link>", "", 2),
        ("<robot name='a", "", 1),
        ("<sdf/>", "<sdf>; a URDF has <robot>", 1),
        ("<robot/><robot/>", "second outermost", 1),
        ("<robot/>", "the robot has no <link>", 1),
        ("<robot><link/></robot>", "a link has no name", 1),
        ("<robot><link name='a'/></robot>", "0 revolute joints", 1),
        ("<robot><link name='a' name='b'/></robot>", "there twice", 1),
        ("<robot><link name='&a;'/></robot>", "", 1),
        ("<robot>\n<link name='a'/>\n<link name='a'/></robot>", "second time", 3),
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
        ("'A4'", "'A3'", "joint \"A3\" is here for the second time"),
        ("<axis xyz='0 -1 0'/>", "<axis xyz='0 -1 0'/><mimic joint='A1'/>", "\"A4\" is mimic"),
        ("<axis xyz='0 -1 0'/>", "<axis xyz='0 0 0'/>", "axis 0 0 0"),
        ("<axis xyz='0 -1 0'/>", "<axis xyz='0 1'/>", "\"0 1\"; it must be 3 finite numbers"),
        ("<axis xyz='0 -1 0'/>", "<axis xyz='0 1 0 0'/>", "it must be 3 finite numbers"),
        ("<axis xyz='0 -1 0'/>", "<axis xyz='0 NaN 0'/>", "it must be 3 finite numbers"),
        ("<axis xyz='0 -1 0'/>", "<axis xyz='0 -1 0'/><axis/>", "second time"),
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

#[test]
fn a_circle_is_told() {
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

#[test]
fn huge_files_are_refused_quickly() {
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
    let start = Instant::now();
    for text in [open, closed, attributes, links + "</robot>", chain + "</robot>"] {
        Robot::default().check_urdf(&text, None).unwrap_err();
    }
    assert!(start.elapsed().as_secs() < 30, "{:?}", start.elapsed());
}

proptest! {
    /// Any change of a good file is either no change or an error; never a panic.
    #[test]
    fn never_panics(from in 0_usize..3000, length in 0_usize..40, with in "[<>/a='\" &;!\\[\\]?\\-0e9]{0,8}", own in any::<bool>()) {
        let robot = Robot::default();
        let text = if own { robot.to_urdf() } else { other_frames() };
        let from = from.min(text.len());
        let to = (from + length).min(text.len());
        let text = format!("{}{with}{}", &text[..from], &text[to..]);
        if let Err(error) = robot.check_urdf(&text, None) {
            prop_assert!(!error.to_string().is_empty());
            prop_assert!(error.place().span.end <= text.len());
        }
    }

    #[test]
    fn any_text_is_refused(text in "(<|>|/|robot|link|joint|name|=|'|\"| |a|type|revolute|&|<!--|-->|<!\\[CDATA\\[|\\]\\]>|<\\?|<!DOCTYPE|\u{fffd}|ü){0,40}") {
        prop_assert!(Robot::default().check_urdf(&text, None).is_err());
    }

    /// Wherever the frames lie, the chain is the same.
    #[test]
    fn shifted_frames_are_the_same_chain(shifts in prop::array::uniform7(-0.5..0.5_f64)) {
        // Joint j is shifted along its own axis; its child's origin is shifted back.
        let robot = Robot::default();
        let mut read = urdf_rs::read_from_string(&robot.to_urdf()).unwrap();
        for (j, shift) in shifts.into_iter().enumerate() {
            let [roll, pitch, yaw] = *read.joints[j].origin.rpy;
            let along = Rotation3::from_euler_angles(roll, pitch, yaw) * Vector3::new(0.0, 0.0, shift);
            for i in 0..3 {
                read.joints[j].origin.xyz[i] += along[i];
            }
            read.joints[j + 1].origin.xyz[2] -= shift;
        }
        let report = robot.check_urdf(&urdf_rs::write_to_string(&read).unwrap(), None).unwrap();
        prop_assert!(report.position_deviation_m < 1e-12);
        prop_assert!(report.limits.is_empty());
    }
}
