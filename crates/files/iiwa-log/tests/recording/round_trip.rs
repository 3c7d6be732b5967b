//! Round trip of all content; the same calls give the same bytes.

use std::io::Cursor;
use std::time::Duration;

use crate::recording::sample::{JOINT_SAMPLES, TICK, point, sample, state};
use iiwa_log::{
    Config, DEFAULT_EPOCH, Entry, MotionEntry, Reader, Recording, Topic, TrajectoryMessage,
    WriteError, Writer,
};

fn writer() -> Writer<Cursor<Vec<u8>>> {
    Writer::new(Cursor::new(Vec::new()), Config::default()).unwrap()
}

#[test]
fn everything_comes_back() {
    let recording = Recording::from_bytes(&sample()).unwrap();

    assert_eq!(recording.epoch, DEFAULT_EPOCH);
    assert_eq!(recording.joint_states.len(), JOINT_SAMPLES as usize);
    for (i, sample) in (0..).zip(&recording.joint_states) {
        let t = TICK * i;
        let (q, dq) = state(t);
        assert_eq!((sample.t_s, sample.q, sample.dq), (t.as_secs_f64(), q, Some(dq)));
    }
    assert_eq!(recording.tcp_poses.len(), JOINT_SAMPLES as usize);
    assert_eq!(&*recording.tcp_poses[0].frame_id, "iiwa_link_0");
    assert_eq!(recording.tcp_poses[3].position_m, [0.5, 0.0, 3.0]);
    assert_eq!(recording.tcp_poses[3].rotation_xyzw, [0.0, 0.0, 0.6, 0.8]);
    assert_eq!(recording.motions.len(), 2);
    assert_eq!(recording.motions[0].motion.index, 1);
    assert_eq!(recording.motions[0].motion.kind, "line");
    assert_eq!(recording.motions[0].motion.limiting_joint, Some(4));
    assert_eq!(recording.motions[0].motion.name.as_deref(), Some("swing"));
    assert_eq!(recording.motions[0].motion.group.as_deref(), Some("pick"));
    assert_eq!(recording.motions[1].motion.group, None);
    assert_eq!(recording.motions[0].motion.limiting_kind, "velocity");
    assert_eq!(recording.motions[1].t_s, 0.2);
    assert_eq!(recording.motions[1].motion.limiting_joint, None);
    assert_eq!(recording.trajectory, (0..=20).map(point).collect::<Vec<_>>());
    assert_eq!(recording.robot_description.as_deref(), Some("<robot name=\"ä\"/>"));
    let attachments: Vec<_> = recording
        .attachments
        .iter()
        .map(|a| (a.name.as_str(), a.media_type.as_str(), a.bytes.as_slice()))
        .collect();
    assert_eq!(
        attachments,
        [("program.json", "application/json", &b"{}"[..]), ("empty", "text/plain", b"")]
    );
    assert_eq!(recording.metadata["iiwasim"]["cycle_time_s"], "0.4");
}

#[test]
fn first_and_last_stamps_are_exact() {
    let file = sample();
    let stamps: Vec<u64> = mcap::MessageStream::new(&file)
        .unwrap()
        .map(Result::unwrap)
        .filter(|message| message.channel.topic == "/joint_states")
        .map(|message| {
            assert_eq!(message.log_time, message.publish_time);
            let field =
                |offset| u32::from_le_bytes(message.data[offset..offset + 4].try_into().unwrap());
            let stamp = u64::from(field(4)) * 1_000_000_000 + u64::from(field(8));
            assert_eq!(message.log_time, stamp);
            stamp
        })
        .collect();
    // 2020-01-01T00:00:00Z, cross-validated against `date -u -d 2020-01-01 +%s`.
    assert_eq!(stamps[0], 1_577_836_800_000_000_000);
    assert_eq!(stamps[stamps.len() - 1], 1_577_836_800_400_000_000);
    assert!(stamps.is_sorted_by(|a, b| a < b));
}

#[test]
fn same_calls_same_bytes() {
    assert!(sample() == sample());
}

#[test]
fn another_epoch_shifts_the_stamps_only() {
    let epoch = Duration::new(1_700_000_000, 123_456_789);
    let config = Config { epoch, ..Config::default() };
    let mut writer = Writer::new(Cursor::new(Vec::new()), config).unwrap();
    writer.joint_state(Duration::ZERO, &[0.0; 7], &[0.0; 7], None).unwrap();
    writer.joint_state(Duration::from_nanos(1), &[0.0; 7], &[0.0; 7], None).unwrap();
    let recording = Recording::read(&*writer.finish().unwrap().into_inner()).unwrap();
    assert_eq!(recording.epoch, epoch);
    assert_eq!(recording.joint_states[1].t_s, 1e-9);
}

#[test]
fn a_header_that_foreign_tools_know() {
    let file = sample();
    let summary = mcap::Summary::read(&file).unwrap().unwrap();
    let mut topics: Vec<_> = summary
        .channels
        .values()
        .map(|channel| {
            assert_eq!(channel.message_encoding, "cdr");
            let schema = channel.schema.as_ref().unwrap();
            assert_eq!(schema.encoding, "ros2msg");
            let latched = channel.metadata["offered_qos_profiles"].contains("durability: 1\n");
            (channel.topic.clone(), schema.name.clone(), latched)
        })
        .collect();
    topics.sort();
    let latched = ["/joint_trajectory", "/robot_description"];
    let mut expected: Vec<_> = Topic::ALL
        .iter()
        // Topics without messages have no channel: these two occur only in plans with a tool, and
        // only in recordings.
        .filter(|topic| !matches!(topic, Topic::FlangePose | Topic::Diagnostics))
        .map(|topic| {
            let name = topic.name();
            (name.to_owned(), topic.type_name().to_owned(), latched.contains(&name))
        })
        .collect();
    expected.sort();
    assert_eq!(topics, expected);

    let header = mcap::read::LinearReader::new(&file).unwrap().next().unwrap().unwrap();
    let mcap::records::Record::Header(header) = header else { panic!("{header:?}") };
    assert_eq!(header.profile, "ros2");
}

#[test]
fn schemas_are_ros2msg_text() {
    assert_eq!(Topic::RobotDescription.schema(), "string data\n");
    let separator = "=".repeat(80);
    assert_eq!(
        Topic::Motion.schema(),
        format!(
            "std_msgs/Header header\nuint32 index\nstring kind\nuint32 limiting_joint\n\
             string limiting_kind\nstring name\nstring group\n{separator}\nMSG: std_msgs/Header\n\
             builtin_interfaces/Time stamp\nstring frame_id\n{separator}\n\
             MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n"
        )
    );
    for topic in Topic::ALL {
        let schema = topic.schema();
        let names: Vec<_> = schema.lines().filter_map(|line| line.strip_prefix("MSG: ")).collect();
        let needed = schema
            .lines()
            .filter(|line| !line.starts_with("MSG: "))
            .filter_map(|line| line.split_once(' '))
            .map(|(kind, _)| kind.trim_end_matches("[]"))
            .filter(|kind| kind.contains('/'));
        for kind in needed {
            assert!(names.contains(&kind), "{topic}: {kind} is not defined");
        }
        assert_eq!(schema.matches(&separator).count(), names.len());
    }
}

#[test]
fn entries_come_one_by_one() {
    let file = sample();
    let mut reader = Reader::new(file.as_slice());
    assert_eq!(reader.epoch(), None);
    let first = reader.next().unwrap().unwrap();
    assert!(matches!(first, Entry::RobotDescription { t_s: 0.0, .. }), "{first:?}");
    assert_eq!(reader.epoch(), Some(DEFAULT_EPOCH));
    let joint_states = reader.filter(|entry| matches!(entry, Ok(Entry::JointState(_)))).count();
    assert_eq!(joint_states, JOINT_SAMPLES as usize);
}

#[test]
fn a_stream_may_trickle() {
    struct Trickle<'a>(&'a [u8]);

    impl std::io::Read for Trickle<'_> {
        fn read(&mut self, buf: &mut [u8]) -> std::io::Result<usize> {
            let n = buf.len().min(7);
            std::io::Read::read(&mut self.0, &mut buf[..n])
        }
    }

    let file = sample();
    assert_eq!(Recording::read(Trickle(&file)).unwrap(), Recording::from_bytes(&file).unwrap());
}

#[test]
fn a_long_trajectory_comes_back() {
    let message = TrajectoryMessage::from_points((0..20_000).map(point)).unwrap();
    assert_eq!(message.len(), 20_000);
    assert!(message.len_bytes() > 4_000_000);
    let mut writer = writer();
    writer.joint_state(Duration::ZERO, &[0.0; 7], &[0.0; 7], None).unwrap();
    writer.joint_trajectory(Duration::ZERO, message).unwrap();
    writer.joint_state(TICK, &[0.0; 7], &[0.0; 7], None).unwrap();
    let recording = Recording::from_bytes(writer.finish().unwrap().get_ref()).unwrap();
    assert_eq!(recording.trajectory.len(), 20_000);
    assert_eq!(recording.trajectory[19_999], point(19_999));
    assert_eq!(recording.joint_states.len(), 2);
}

#[test]
fn time_does_not_run_backwards() {
    let mut writer = writer();
    writer.joint_state(TICK, &[0.0; 7], &[0.0; 7], None).unwrap();
    let error = writer.joint_state(TICK, &[0.0; 7], &[0.0; 7], None).unwrap_err();
    assert_eq!(error.to_string(), "/joint_states at 4ms after 4ms: stamps must increase");
    // Another topic has its own time, and the file is still valid.
    writer.transforms(Duration::ZERO, &[]).unwrap();
    writer.joint_state(TICK * 2, &[0.0; 7], &[0.0; 7], None).unwrap();
    let recording = Recording::from_bytes(writer.finish().unwrap().get_ref()).unwrap();
    assert_eq!(recording.joint_states.len(), 2);
}

#[test]
fn mismatched_samples_are_refused() {
    let late = Duration::from_secs(1 << 31);
    let config = Config { epoch: late, ..Config::default() };
    let error = Writer::new(Cursor::new(Vec::new()), config).unwrap_err();
    assert!(matches!(error, WriteError::EpochOutOfRange { .. }), "{error}");

    let mut writer = writer();
    for t in [late, Duration::MAX] {
        let error = writer.robot_description(t, "").unwrap_err();
        assert!(matches!(error, WriteError::StampOutOfRange { .. }), "{error}");
    }
    for joint in [0, 8] {
        let motion = MotionEntry {
            index: 1,
            kind: "line".into(),
            limiting_joint: Some(joint),
            limiting_kind: "jerk".into(),
            name: None,
            group: None,
        };
        let error = writer.motion(Duration::ZERO, &motion).unwrap_err();
        assert!(matches!(error, WriteError::NoSuchJoint { .. }), "{error}");
    }
}

#[test]
fn a_full_disk_is_an_error() {
    let mut room = [0; 4096];
    let mut writer = Writer::new(Cursor::new(&mut room[..]), Config::default()).unwrap();
    // The chunk buffers these messages; at the end of the file they must be written.
    let mut result = Ok(());
    for i in 0..1000 {
        let (q, dq) = state(TICK * i);
        result = result.and_then(|()| writer.joint_state(TICK * i, &q, &dq, None));
    }
    let error = result.and_then(|()| writer.finish().map(drop)).unwrap_err();
    assert!(matches!(error, WriteError::Mcap { .. }), "{error}");
}
