//! Joint and link names for other ROS packages, and with a prefix.

use std::collections::BTreeMap;
use std::io::Cursor;
use std::time::Duration;

use crate::recording::sample::{TICK, point, state};
use iiwa_kin::{Robot, RosNames, RosStack};
use iiwa_log::{Config, Recorder, RecorderConfig, Recording, TrajectoryMessage, Writer};

/// Returns names with the prefixes of their joints and links.
fn namings() -> [(RosNames, &'static str, &'static str); 5] {
    let of = |stack, prefix: &str| RosNames::new(stack, Some(prefix.parse().unwrap()));
    [
        (RosNames::default(), "iiwa_joint_", "iiwa_link_"),
        (RosNames::new(RosStack::LbrFriRos2Stack, None), "lbr_A", "lbr_link_"),
        (of(RosStack::LbrFriRos2Stack, "left"), "left_A", "left_link_"),
        // After these names, the first doubles of a trajectory have another alignment.
        (of(RosStack::LbrFriRos2Stack, "right"), "right_A", "right_link_"),
        (of(RosStack::IiwaStack, "right_2"), "right_2_joint_", "right_2_link_"),
    ]
}

/// Returns the strings of a CDR body that look like names: a length, letters, and a zero.
fn names(data: &[u8]) -> Vec<String> {
    let is_name = |text: &[u8]| text.iter().all(|c| c.is_ascii_alphanumeric() || *c == b'_');
    let at = |at: usize| {
        let (length, text) = data.get(at..)?.split_first_chunk::<4>()?;
        let length = usize::try_from(u32::from_le_bytes(*length)).ok()?;
        let (zero, text) = text.get(..length)?.split_last()?;
        (*zero == 0 && text.len() > 2 && is_name(text))
            .then(|| String::from_utf8(text.to_vec()).unwrap())
    };
    (0..data.len()).step_by(4).filter_map(at).collect()
}

/// Returns the encoded messages on a topic.
fn messages(file: &[u8], topic: &str) -> Vec<Vec<u8>> {
    mcap::MessageStream::new(file)
        .unwrap()
        .map(Result::unwrap)
        .filter(|message| message.channel.topic == topic)
        .map(|message| message.data.into_owned())
        .collect()
}

#[test]
fn messages_with_other_names_come_back() {
    for (ros_names, joint, _) in namings() {
        let config = Config { names: ros_names, ..Config::default() };
        let mut writer = Writer::new(Cursor::new(Vec::new()), config).unwrap();
        let trajectory = TrajectoryMessage::from_points((0..=20).map(point)).unwrap();
        writer.joint_trajectory(Duration::ZERO, trajectory).unwrap();
        let (q, dq) = state(TICK);
        writer.joint_state(Duration::ZERO, &q, &dq, None).unwrap();
        writer.joint_state(TICK, &q, &dq, Some(&[0.5; 7])).unwrap();
        let file = writer.finish().unwrap().into_inner();

        let joints: Vec<_> = (1..=7).map(|number| format!("{joint}{number}")).collect();
        for topic in ["/joint_states", "/joint_trajectory"] {
            for message in messages(&file, topic) {
                assert_eq!(names(&message), joints, "{topic}");
            }
        }
        let recording = Recording::from_bytes(&file).unwrap();
        let [without, with] = recording.joint_states[..] else { panic!("not two states") };
        assert_eq!((without.q, without.dq, without.torques_nm), (q, Some(dq), None));
        assert_eq!((with.q, with.dq, with.torques_nm), (q, Some(dq), Some([0.5; 7])));
        assert_eq!(recording.trajectory, (0..=20).map(point).collect::<Vec<_>>());
    }
}

#[test]
fn the_arm_has_the_names_of_its_urdf() {
    for (ros_names, joint, link) in namings() {
        let robot = Robot::default();
        let file = Config { names: ros_names.clone(), ..Config::default() };
        let config = RecorderConfig { file, ..RecorderConfig::default() };
        let mut recorder = Recorder::new(Cursor::new(Vec::new()), &robot, config).unwrap();
        recorder.sample(Duration::ZERO, &[0.1; 7]).unwrap();
        recorder.sample(TICK, &[0.2; 7]).unwrap();
        let file = recorder.finish(&BTreeMap::new(), &[]).unwrap().into_inner();

        let links: Vec<_> = (0..8).map(|number| format!("{link}{number}")).collect();
        let flange = format!("{link}ee");
        let parents_and_children: Vec<_> = links
            .iter()
            .zip(links[1..].iter().chain([&flange]))
            .flat_map(|(parent, child)| [parent.clone(), child.clone()])
            .collect();
        for message in messages(&file, "/tf") {
            assert_eq!(names(&message), parents_and_children);
        }
        let recording = Recording::from_bytes(&file).unwrap();
        assert_eq!(*recording.tcp_poses[0].frame_id, *links[0]);
        let urdf = recording.robot_description.unwrap();
        assert_eq!(urdf, robot.to_urdf_with_names(&ros_names));
        let attached = recording.attachments.iter().find(|it| it.name == "robot.urdf").unwrap();
        assert_eq!(attached.bytes, urdf.as_bytes());
        let states = messages(&file, "/joint_states");
        let joints: Vec<_> = (1..=7).map(|number| format!("{joint}{number}")).collect();
        assert_eq!(names(&states[0]), joints);
        for name in links.iter().chain(&joints).chain([&flange]) {
            assert!(urdf.contains(&format!("name=\"{name}\"")), "{name} in {urdf}");
        }
    }
}
