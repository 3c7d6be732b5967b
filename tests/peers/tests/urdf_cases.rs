//! Edits of a URDF, and the outcome of each with our reader and with `urdf-rs`.
//!
//! `DESIGN.md` ("Which libraries are used, and for what?") rests on this table. A case that fails
//! after an update of `urdf-rs` is a reason to look at that decision again.

use std::{env, process::Command};

use iiwa_kin::{Robot, UrdfReport};

/// One edit of the URDF that we write, and its outcome with each reader.
struct Case {
    old: &'static str,
    new: &'static str,
    ours: Ours,
    theirs: Theirs,
}

/// Outcome of [`Robot::check_urdf`].
enum Ours {
    /// The model, with the limits of the model.
    Same,
    /// The model, with these limits reported as missing.
    Lacks(&'static [&'static str]),
    /// This message, at the line of the edit or of the joint around it.
    Refuses(&'static str),
}

/// Outcome of `urdf_rs::read_from_string`.
enum Theirs {
    /// The links and joints of the file without the edit.
    Same,
    /// A robot that has this property; no error.
    Reads(fn(&urdf_rs::Robot) -> bool),
    /// This message, which names no line.
    Refuses(&'static str),
    /// This message of its XML parser, with the line.
    RefusesXml(&'static str),
}

const fn case(old: &'static str, new: &'static str, ours: Ours, theirs: Theirs) -> Case {
    Case { old, new, ours, theirs }
}

/// XML that both read alike.
const BOTH_READ: &[Case] = &[
    case("0 0 1\"", " 0\t0\n+1e0 \"", Ours::Same, Theirs::Same),
    case("\"iiwa_joint_4\"", "\"&#105;iwa_joint_4\"", Ours::Same, Theirs::Same),
    case("<?xml", "\u{feff}<?xml", Ours::Same, Theirs::Same),
    case("<robot ", "<!DOCTYPE robot [<!ENTITY a 'b'>]>\n<robot ", Ours::Same, Theirs::Same),
    case("<robot ", "<robot version='1.1' ", Ours::Same, Theirs::Same),
    case("<robot ", "<robot xmlns='http://ros.org' ", Ours::Same, Theirs::Same),
    case("<robot ", "<robot xmlns:xacro='http://ros.org' ", Ours::Same, Theirs::Same),
    case(
        "</robot>",
        "<gazebo><joint name='iiwa_joint_4'/></gazebo></robot>",
        Ours::Same,
        Theirs::Same,
    ),
    case("</robot>", "<!-- & --><?pi?><a><![CDATA[<]]></a></robot>", Ours::Same, Theirs::Same),
];

/// Files that both refuse: ours with the line and the joint, theirs mostly without either.
const BOTH_REFUSE: &[Case] = &[
    case(
        "\"iiwa_joint_4\"",
        "\"&a;\"",
        Ours::Refuses("the entity &a; is defined by a document type"),
        Theirs::RefusesXml("Found invalid entity"),
    ),
    case(
        " type=\"revolute\"",
        " type=\"revolute\" type=\"fixed\"",
        Ours::Refuses("the attribute type appears twice"),
        Theirs::RefusesXml("Duplicate attribute"),
    ),
    case(
        "</robot>",
        "</link>",
        Ours::Refuses("expected `</robot>`"),
        Theirs::Refuses("Elements not properly nested"),
    ),
    case(
        "name=\"iiwa_joint_4\" ",
        "",
        Ours::Refuses("a joint has no name"),
        Theirs::Refuses("missing field `name`"),
    ),
    case(
        " type=\"revolute\"",
        "",
        Ours::Refuses("joint \"iiwa_joint_4\" has no type"),
        Theirs::Refuses("missing field `type`"),
    ),
    case(
        " type=\"revolute\"",
        " type=\"Revolute\"",
        Ours::Refuses("joint \"iiwa_joint_4\" is Revolute"),
        Theirs::Refuses("unknown variant `Revolute`"),
    ),
    case(
        "<parent link=\"iiwa_link_3\"/>",
        "",
        Ours::Refuses("joint \"iiwa_joint_4\" has no <parent>"),
        Theirs::Refuses("missing field `parent`"),
    ),
    case(
        "<parent link=\"iiwa_link_3\"/>",
        "<parent/>",
        Ours::Refuses("the parent of joint \"iiwa_joint_4\" has no link"),
        Theirs::Refuses("missing field `link`"),
    ),
    case(
        "<axis xyz=\"0 0 1\"/>",
        "<axis xyz=\"0 0 1\"/><axis xyz=\"0 0 1\"/>",
        Ours::Refuses("the axis of joint \"iiwa_joint_4\" appears twice"),
        Theirs::Refuses("duplicate field `axis`"),
    ),
    case(
        "<axis xyz=\"0 0 1\"/>",
        "<axis xyz=\"0 1\"/>",
        Ours::Refuses("xyz is \"0 1\"; it must be 3 finite numbers"),
        Theirs::Refuses("expected 3 found 2 for [0 1]"),
    ),
    case(
        "0 0 0.4\"",
        "0 0 0,4\"",
        Ours::Refuses("xyz is \"0 0 0,4\"; it must be 3 finite numbers"),
        Theirs::Refuses("expected 3 found 2 for [0 0 0,4]"),
    ),
    case(
        "</robot>",
        "<link/></robot>",
        Ours::Refuses("a link has no name"),
        Theirs::Refuses("missing field `name`"),
    ),
];

/// Files that only `urdf-rs` reads: it drops what it cannot read, or leaves the check to its
/// caller.
const ONLY_THEIRS_READS: &[Case] = &[
    case("0 0 0.4\"", "0 0 0.4 m\"", Ours::Refuses("xyz is \"0 0 0.4 m\""), Theirs::Same),
    case("0 0 0.4\"", "0, 0 0 0.4\"", Ours::Refuses("xyz is \"0, 0 0 0.4\""), Theirs::Same),
    case("0 0 0.4\"", "0 0 ${d3} 0.4\"", Ours::Refuses("expand the xacro file"), Theirs::Same),
    case(
        "<axis xyz=\"0 0 1\"/>",
        "<axis xyz=\"0 NaN 1\"/>",
        Ours::Refuses("it must be 3 finite numbers"),
        Theirs::Reads(|robot| robot.joints[3].axis.xyz[1].is_nan()),
    ),
    case(
        "0 0 0.4\"",
        "0 0 1e400\"",
        Ours::Refuses("it must be 3 finite numbers"),
        Theirs::Reads(|robot| robot.joints[3].origin.xyz[2] == f64::INFINITY),
    ),
    case(
        "lower=\"",
        "lower=\"NaN\" low=\"",
        Ours::Refuses("lower is \"NaN\"; it must be 1 finite number"),
        Theirs::Reads(|robot| robot.joints[3].limit.lower.is_nan()),
    ),
    case(
        "<axis xyz=\"0 0 1\"/>",
        "<axis xyz=\"0 0 0\"/>",
        Ours::Refuses("turns about the axis 0 0 0"),
        Theirs::Reads(|robot| *robot.joints[3].axis.xyz == [0.0; 3]),
    ),
    case(
        "</robot>",
        "<link name='iiwa_link_4'/></robot>",
        Ours::Refuses("link \"iiwa_link_4\" appears twice"),
        Theirs::Reads(|robot| robot.links[4].name == robot.links[9].name),
    ),
    case(
        "\"iiwa_joint_4\"",
        "\"iiwa_joint_3\"",
        Ours::Refuses("joint \"iiwa_joint_3\" appears twice"),
        Theirs::Reads(|robot| robot.joints[2].name == robot.joints[3].name),
    ),
    case(
        "<parent link=\"iiwa_link_3\"/>",
        "<parent link=\"nowhere\"/>",
        Ours::Refuses("names the link \"nowhere\", which the file does not have"),
        Theirs::Reads(|robot| robot.joints[3].parent.link == "nowhere"),
    ),
    case(
        "<child link=\"iiwa_link_4\"/>",
        "<child link=\"iiwa_link_3\"/>",
        Ours::Refuses("as another joint does already"),
        Theirs::Reads(|robot| robot.joints[2].child.link == robot.joints[3].child.link),
    ),
    case(
        " type=\"revolute\"",
        " type=\"continuous\"",
        Ours::Refuses("joint \"iiwa_joint_4\" is continuous"),
        Theirs::Reads(|robot| robot.joints[3].joint_type == urdf_rs::JointType::Continuous),
    ),
    case(
        "<axis xyz=\"0 0 1\"/>",
        "<axis xyz=\"0 0 1\"/><mimic joint='a'/>",
        Ours::Refuses("joint \"iiwa_joint_4\" is mimic"),
        Theirs::Reads(|robot| robot.joints[3].mimic.is_some()),
    ),
    case(
        "</robot>",
        "</robot><robot/>",
        Ours::Refuses("it has a second outermost element"),
        Theirs::Same,
    ),
];

/// Files that both read, with missing limits as zero in `urdf-rs`.
const READ_DIFFERENTLY: &[Case] = &[
    case(
        "<limit lower=",
        "<limit low=",
        Ours::Lacks(&["lower"]),
        Theirs::Reads(|robot| robot.joints[3].limit.lower == 0.0),
    ),
    case(
        " effort=",
        " torque=",
        Ours::Lacks(&["effort"]),
        Theirs::Reads(|robot| robot.joints[3].limit.effort == 0.0),
    ),
    case(
        "<limit ",
        "<bounds ",
        Ours::Lacks(&["lower", "upper", "effort", "velocity"]),
        Theirs::Reads(|robot| robot.joints[3].limit.velocity == 0.0),
    ),
];

/// Files that only ours reads: the kinematics need nothing of what `urdf-rs` misses.
const ONLY_OURS_READS: &[Case] = &[
    case(
        " velocity=",
        " speed=",
        Ours::Lacks(&["velocity"]),
        Theirs::Refuses("missing field `velocity`"),
    ),
    case(
        "</robot>",
        "<xacro:arg name='a'/></robot>",
        Ours::Same,
        Theirs::RefusesXml("Unbound namespace prefix in tag name"),
    ),
    case(
        "</robot>",
        "<gazebo xlink:href='a'/></robot>",
        Ours::Same,
        Theirs::RefusesXml("Unbound namespace prefix in attribute name"),
    ),
    case(
        "</robot>",
        "<gazebo a='1' a='2'/></robot>",
        Ours::Same,
        Theirs::RefusesXml("Duplicate attribute"),
    ),
    case(
        "<axis xyz=\"0 0 1\"/>",
        "<axis xyz=\"0 0 1\"/><dynamics damping='low'/>",
        Ours::Same,
        Theirs::Refuses("invalid float literal"),
    ),
    case(
        "<axis xyz=\"0 0 1\"/>",
        "<axis xyz=\"0 0 1\"/><safety_controller/>",
        Ours::Same,
        Theirs::Refuses("missing field `k_velocity`"),
    ),
    case(
        "</robot>",
        "<link name='a'/><joint name='a' type='screw'><parent link='iiwa_link_0'/>\
         <child link='a'/></joint></robot>",
        Ours::Same,
        Theirs::Refuses("unknown variant `screw`"),
    ),
    case(
        "</joint>\n</robot>",
        "<axis/></joint>\n</robot>",
        Ours::Same,
        Theirs::Refuses("missing field `xyz`"),
    ),
    case(
        "</robot>",
        "<link name='a'><collision/></link></robot>",
        Ours::Same,
        Theirs::Refuses("missing field `geometry`"),
    ),
    case(
        "</robot>",
        "<link name='a'><visual><geometry><ellipsoid/></geometry></visual></link></robot>",
        Ours::Same,
        Theirs::Refuses("unknown variant `ellipsoid`"),
    ),
    case(
        "</robot>",
        "<link name='a'><inertial><mass value='1'/></inertial></link></robot>",
        Ours::Same,
        Theirs::Refuses("missing field `inertia`"),
    ),
    case("</robot>", "<material/></robot>", Ours::Same, Theirs::Refuses("missing field `name`")),
];

/// The file with the edit, at the first `old` from joint 4 on or else at the first one in the file;
/// and the lines of the edit and of joint 4.
fn edited(case: &Case) -> (String, [usize; 2]) {
    let Case { old, new, .. } = case;
    let good = Robot::default().to_urdf();
    let joint = good.find("name=\"iiwa_joint_4\"").unwrap();
    let behind = good[joint..].find(old).map(|offset| joint + offset);
    let offset = behind.or_else(|| good.find(old)).unwrap();
    let text = format!("{}{new}{}", &good[..offset], &good[offset + old.len()..]);
    let lines = [offset, joint].map(|end| good[..end].matches('\n').count() + 1);
    (text, lines)
}

/// Links and joints as a text: NaN is NaN.
fn content(robot: &urdf_rs::Robot) -> String {
    format!("{:?} {:?}", robot.links, robot.joints)
}

fn lacking(report: &UrdfReport) -> Vec<&'static str> {
    report.limits.iter().filter(|limit| limit.urdf.is_none()).map(|limit| limit.limit).collect()
}

#[track_caller]
fn assert_outcomes(cases: &[Case]) {
    let good = urdf_rs::read_from_string(&Robot::default().to_urdf()).unwrap();
    for case in cases {
        let (text, lines) = edited(case);
        let new = case.new;
        match (Robot::default().check_urdf(&text, None), &case.ours) {
            (Ok(report), Ours::Same) => assert!(report.limits.is_empty(), "{new}: {report:?}"),
            (Ok(report), Ours::Lacks(limits)) => {
                assert_eq!(lacking(&report), *limits, "{new}");
                assert_eq!(report.limits.len(), limits.len(), "{new}");
            }
            (Err(error), Ours::Refuses(message)) => {
                assert!(error.to_string().contains(message), "{new}: {error}");
                assert!(lines.contains(&error.place().line), "{new}: {error}, not {lines:?}");
            }
            (outcome, _) => panic!("{new}: {outcome:?}"),
        }
        let theirs = urdf_rs::read_from_string(&text).map_err(|error| error.to_string());
        match (theirs, &case.theirs) {
            (Ok(robot), Theirs::Same) => assert_eq!(content(&robot), content(&good), "{new}"),
            (Ok(robot), Theirs::Reads(holds)) => {
                assert!(holds(&robot), "{new}: {robot:?}");
                assert_ne!(content(&robot), content(&good), "{new}");
            }
            (Err(error), Theirs::Refuses(message)) => {
                assert!(error.contains(message), "{new}: {error}");
                assert!(!error.to_lowercase().contains("line"), "{new}: {error}");
                assert!(!error.contains("iiwa"), "{new}: {error}");
            }
            (Err(error), Theirs::RefusesXml(message)) => {
                assert!(error.contains(message), "{new}: {error}");
                assert!(error.contains(&format!("Line: {}", lines[0])), "{new}: {error}");
            }
            (outcome, _) => panic!("{new}: {outcome:?}"),
        }
    }
}

#[test]
fn both_read_the_same() {
    assert_outcomes(BOTH_READ);
}

#[test]
fn both_refuse() {
    assert_outcomes(BOTH_REFUSE);
}

#[test]
fn only_urdf_rs_reads() {
    assert_outcomes(ONLY_THEIRS_READS);
}

#[test]
fn missing_limits_are_zero_in_urdf_rs() {
    assert_outcomes(READ_DIFFERENTLY);
}

#[test]
fn only_ours_reads() {
    assert_outcomes(ONLY_OURS_READS);
}

/// Version `2` has quaternions in our reader, and none in `urdf-rs`, which then has no rotation.
#[test]
fn a_version_without_a_dot_is_read_differently() {
    let turned = |version: &str| {
        let good = Robot::default().to_urdf();
        let start = good.find("\"iiwa_joint_ee\"").unwrap();
        let offset = start + good[start..].find("rpy=\"0 0 0\"").unwrap();
        let text = format!("{}quat_xyzw=\"0 0 1 0\"{}", &good[..offset], &good[offset + 11..]);
        text.replacen("<robot ", &format!("<robot version='{version}' "), 1)
    };
    for (version, theirs) in [("1.0", false), ("1.1", true), ("2", false)] {
        let text = turned(version);
        let error = Robot::default().check_urdf(&text, None).map_err(|error| error.to_string());
        assert_eq!(
            error.is_err_and(|error| error.contains("180.0000 deg")),
            version != "1.0",
            "{version}"
        );
        let read = urdf_rs::read_from_string(&text).unwrap();
        assert_eq!(read.joints[7].origin.rpy[2].abs() > 3.0, theirs, "{version}");
    }
}

/// A file of 150 kB ends a process that reads it with `urdf-rs`: its tree is walked by recursion.
#[test]
fn deep_nesting_overflows_the_stack_in_urdf_rs() {
    const CHILD: &str = "IIWASIM_TEST_READS_DEEP_NESTING";
    const DEPTH: usize = 20_000;
    let (open, close) = ("<a>".repeat(DEPTH), "</a>".repeat(DEPTH));
    let text = Robot::default().to_urdf().replace("</robot>", &format!("{open}{close}</robot>"));
    if env::var_os(CHILD).is_some() {
        let _ = urdf_rs::read_from_string(&text);
        return;
    }
    assert!(Robot::default().check_urdf(&text, None).unwrap().limits.is_empty());
    let child = Command::new(env::current_exe().unwrap())
        .args(["--exact", "urdf_cases::deep_nesting_overflows_the_stack_in_urdf_rs"])
        .env(CHILD, "1")
        .env("RUST_MIN_STACK", "2097152")
        .output()
        .unwrap();
    let message = String::from_utf8_lossy(&child.stderr);
    assert!(!child.status.success() && message.contains("overflowed its stack"), "{message}");
}
