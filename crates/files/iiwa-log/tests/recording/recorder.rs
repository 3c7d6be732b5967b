//! Growing recordings: content, and completeness after every step.

use std::collections::BTreeMap;
use std::fs;
use std::io::{self, Cursor, Seek, SeekFrom, Write};
use std::time::Duration;

use iiwa_kin::{Joints, Robot};
use iiwa_log::{
    Config, DEFAULT_EPOCH, JointSample, Recorder, RecorderConfig, Recording, Storage, Topic,
    WriteError,
};
use proptest::prelude::*;

use crate::recording::whole::{both_ways, by_index, joint_states};

const MS: Duration = Duration::from_millis(1);

fn recorder<S: Storage>(storage: S, period: Duration) -> Recorder<S> {
    let config = RecorderConfig { period, ..RecorderConfig::default() };
    Recorder::new(storage, &Robot::lbr_iiwa_7_r800(), config).unwrap()
}

fn memory() -> Cursor<Vec<u8>> {
    Cursor::new(Vec::new())
}

/// Returns positions and velocities of a test motion.
fn swing(t: Duration) -> (Joints, Joints) {
    let phase = |joint: usize| (joint + 1) as f64 * t.as_secs_f64();
    (
        std::array::from_fn(|joint| phase(joint).sin()),
        std::array::from_fn(|joint| (joint + 1) as f64 * phase(joint).cos()),
    )
}

#[test]
fn a_recording_that_cannot_begin_leaves_files_as_they_were() {
    let folder = tempfile::tempdir().unwrap();
    let [new, old] = ["new.mcap", "old.mcap"].map(|name| folder.path().join(name));
    fs::write(&old, "before").unwrap();
    let robot = Robot::lbr_iiwa_7_r800();
    let create = |path, overwrite, epoch_s| {
        let file = Config { epoch: Duration::from_secs(epoch_s), ..Config::default() };
        let config = RecorderConfig { file, ..RecorderConfig::default() };
        Recorder::create(path, overwrite, &robot, config).map(drop)
    };
    let past_2038 = 1 << 31;
    for (path, overwrite) in [(&new, false), (&new, true), (&old, true)] {
        let error = create(path, overwrite, past_2038).unwrap_err();
        assert!(matches!(error, WriteError::EpochOutOfRange { .. }), "{error}");
    }
    let error = create(&old, false, 0).unwrap_err();
    assert!(matches!(error, WriteError::Mcap { .. }), "{error}");
    assert!(!new.exists());
    assert_eq!(fs::read_to_string(&old).unwrap(), "before");
    create(&new, false, past_2038 - 1).unwrap();
    create(&old, true, 0).unwrap();
    for path in [new, old] {
        Recording::from_bytes(&fs::read(path).unwrap()).unwrap();
    }
}

#[test]
fn everything_comes_back() {
    let robot = Robot::lbr_iiwa_7_r800();
    let mut recorder = recorder(memory(), Duration::from_secs(1));
    for k in 0..=2505 {
        recorder.sample(MS * k, &swing(MS * k).0).unwrap();
    }
    let metadata = BTreeMap::from([("cycle_time_s".to_owned(), "2.505".to_owned())]);
    let file = recorder
        .finish(&metadata, &[("program.json", "application/json", b"{}")])
        .unwrap()
        .into_inner();

    let recording = Recording::from_bytes(&file).unwrap();
    assert_eq!(recording.epoch, DEFAULT_EPOCH);
    assert_eq!(recording.robot_description.as_deref(), Some(robot.to_urdf().as_str()));
    assert_eq!(recording.joint_states.len(), 2506);
    for (k, state) in (0..).zip(&recording.joint_states) {
        assert_eq!((state.t_s, state.q), ((MS * k).as_secs_f64(), swing(MS * k).0));
    }
    assert_eq!(recording.metadata["iiwasim"], metadata);
    let names: Vec<_> = recording.attachments.iter().map(|a| a.name.as_str()).collect();
    assert_eq!(names, ["program.json", "robot.json", "robot.urdf"]);

    // 100 poses per second, and one at the end.
    let times = by_index(&file);
    assert_eq!(recording.tcp_poses.len(), 252);
    assert_eq!(times["/tf"], times["/tcp_pose"]);
    assert_eq!(recording.tcp_poses[1].t_s, 0.01);
    assert_eq!(recording.tcp_poses[251].t_s, 2.505);
    let tcp = robot.flange_pose(&swing(MS * 10).0);
    assert_eq!(recording.tcp_poses[1].position_m, tcp.position_m);
    assert_eq!(recording.tcp_poses[1].rotation_xyzw, tcp.quaternion_xyzw());

    // A chunk per second, and one for the rest.
    let summary = mcap::Summary::read(&file).unwrap().unwrap();
    assert_eq!(summary.chunk_indexes.len(), 4);
}

#[test]
fn the_same_calls_give_the_same_bytes() {
    let record = || {
        let mut recorder = recorder(memory(), MS * 100);
        for k in 0..500 {
            recorder.sample(MS * k, &swing(MS * k).0).unwrap();
        }
        recorder.finish(&BTreeMap::new(), &[]).unwrap().into_inner()
    };
    assert!(record() == record());
}

#[test]
fn velocities_are_those_of_the_motion() {
    // Stamps at uneven distances.
    let stamps: Vec<Duration> =
        (0..400_u64).map(|k| Duration::from_micros(1000 * k + 700 * (k * k % 7) / 7)).collect();
    let mut recorder = recorder(memory(), MS * 50);
    for t in &stamps {
        recorder.sample(*t, &swing(*t).0).unwrap();
    }
    let file = recorder.finish(&BTreeMap::new(), &[]).unwrap().into_inner();
    let states = joint_states(&file);
    assert_eq!(states.len(), stamps.len());
    for (place, (t, state)) in stamps.iter().zip(&states).enumerate() {
        // The error of the parabola is of second order: third derivative, 343 rad/s³, times the
        // product of the steps over six. At the ends, the error of the line: second derivative
        // times half the step.
        let ends = [0, stamps.len() - 1];
        let bound =
            if ends.contains(&place) { 49.0 * 1e-3 } else { 343.0 * 1.7e-3_f64.powi(2) / 6.0 };
        for (actual, expected) in state.dq.unwrap().iter().zip(swing(*t).1) {
            assert!((actual - expected).abs() < bound, "{place}: {actual} {expected}");
        }
    }

    // A parabola is reproduced exactly, up to rounding, for any stamps.
    let mut recorder = self::recorder(memory(), MS * 50);
    let parabola = |t: f64| 0.3 * t * t - 0.2 * t + 0.1;
    for t in &stamps {
        recorder.sample(*t, &[parabola(t.as_secs_f64()); 7]).unwrap();
    }
    let file = recorder.finish(&BTreeMap::new(), &[]).unwrap().into_inner();
    for state in &joint_states(&file)[1..stamps.len() - 1] {
        assert!((state.dq.unwrap()[6] - (0.6 * state.t_s - 0.2)).abs() < 1e-9, "{state:?}");
    }
}

#[test]
fn a_single_sample_is_at_rest() {
    let mut recorder = recorder(memory(), Duration::from_secs(1));
    recorder.sample(MS, &[0.5; 7]).unwrap();
    recorder.flush().unwrap();
    recorder.flush().unwrap();
    let file = recorder.finish(&BTreeMap::new(), &[]).unwrap().into_inner();
    assert_eq!(
        joint_states(&file),
        [JointSample {
            t_s: 1e-3,
            log_s: 1e-3,
            is_stamped: true,
            q: [0.5; 7],
            dq: Some([0.0; 7]),
            torques_nm: None
        }]
    );
}

#[test]
fn an_empty_recording_has_a_robot() {
    let file = recorder(memory(), MS).finish(&BTreeMap::new(), &[]).unwrap().into_inner();
    assert_eq!(joint_states(&file), []);
}

#[test]
fn without_poses() {
    let config = RecorderConfig { pose_rate_hz: 0, ..RecorderConfig::default() };
    let mut recorder = Recorder::new(memory(), &Robot::lbr_iiwa_7_r800(), config).unwrap();
    for k in 0..100 {
        recorder.sample(MS * k, &[0.0; 7]).unwrap();
    }
    let file = recorder.finish(&BTreeMap::new(), &[]).unwrap().into_inner();
    let times = by_index(&file);
    let topics: Vec<_> = times.keys().map(String::as_str).collect();
    assert_eq!(topics, ["/joint_states", "/robot_description"]);
}

#[test]
fn stamps_that_do_not_increase_are_refused() {
    let mut recorder = recorder(memory(), MS * 3);
    for k in [10, 20] {
        recorder.sample(MS * k, &[0.0; 7]).unwrap();
        for late in [MS * k, MS * (k - 1), Duration::ZERO] {
            let error = recorder.sample(late, &[1.0; 7]).unwrap_err();
            let WriteError::NotIncreasing { topic: Topic::JointStates, t, previous } = error else {
                panic!("{error}")
            };
            assert_eq!((t, previous), (late, MS * k));
        }
        recorder.flush().unwrap();
    }
    let late = Duration::from_secs(1 << 31);
    let error = recorder.sample(late, &[1.0; 7]).unwrap_err();
    assert!(matches!(error, WriteError::StampOutOfRange { .. }), "{error}");
    recorder.sample(MS * 30, &[0.0; 7]).unwrap();
    let file = recorder.finish(&BTreeMap::new(), &[]).unwrap().into_inner();
    assert_eq!(joint_states(&file).iter().map(|s| s.t_s).collect::<Vec<_>>(), [0.01, 0.02, 0.03]);

    let config = Config { epoch: late, ..Config::default() };
    let config = RecorderConfig { file: config, ..RecorderConfig::default() };
    let error = Recorder::new(memory(), &Robot::lbr_iiwa_7_r800(), config).unwrap_err();
    assert!(matches!(error, WriteError::EpochOutOfRange { .. }), "{error}");
}

/// Memory that records every change, in pieces that a kill cannot split: a write, page by page.
#[derive(Default)]
struct Journal {
    content: Cursor<Vec<u8>>,
    changes: Vec<Change>,
    /// Number of changes until the storage is full.
    room: Option<usize>,
}

#[derive(Clone)]
enum Change {
    Write { offset: usize, bytes: Vec<u8> },
    Length(usize),
}

impl Change {
    fn apply(&self, file: &mut Vec<u8>) {
        match self {
            Self::Write { offset, bytes } => {
                let end = offset + bytes.len();
                if file.len() < end {
                    file.resize(end, 0);
                }
                file[*offset..end].copy_from_slice(bytes);
            }
            Self::Length(len) => file.resize(*len, 0),
        }
    }
}

impl Journal {
    fn note(&mut self, change: Change) -> io::Result<()> {
        if self.room.is_some_and(|room| self.changes.len() >= room) {
            return Err(io::ErrorKind::StorageFull.into());
        }
        change.apply(self.content.get_mut());
        self.changes.push(change);
        Ok(())
    }
}

impl Write for Journal {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let offset = usize::try_from(self.content.position()).unwrap();
        let len = bytes.len().min(4096 - offset % 4096);
        self.note(Change::Write { offset, bytes: bytes[..len].to_vec() })?;
        self.content.set_position((offset + len) as u64);
        Ok(len)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Seek for Journal {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.content.seek(to)
    }
}

impl Storage for Journal {
    fn set_len(&mut self, len: u64) -> io::Result<()> {
        // Truncation needs no space.
        let room = self.room.take();
        let result = self.note(Change::Length(usize::try_from(len).unwrap()));
        self.room = room;
        result
    }
}

/// Returns the number of changes before anything can be recorded.
fn changes_of_new() -> usize {
    let mut journal = Journal::default();
    drop(recorder(&mut journal, Duration::MAX));
    journal.changes.len()
}

#[test]
fn the_file_is_whole_after_every_step() {
    // Number of samples after each update of the file.
    let mut marks = Vec::new();
    let mut recorder = recorder(Journal::default(), Duration::MAX);
    for k in 0..600 {
        recorder.sample(MS * k, &swing(MS * k).0).unwrap();
        if k % 60 == 59 || k == 100 {
            recorder.flush().unwrap();
            marks.push(k as usize + 1);
        }
    }
    let journal = recorder.finish(&BTreeMap::new(), &[("a", "text/plain", &[7; 10_000])]).unwrap();
    marks.push(600);

    let (new, growing) = journal.changes.split_at(changes_of_new());
    let mut file = Vec::new();
    for change in new {
        change.apply(&mut file);
    }
    assert_eq!(joint_states(&file), []);
    let (mut before, mut marks) = (0, marks.into_iter());
    let mut after = marks.next();
    for change in growing {
        change.apply(&mut file);
        let (states, indexed) = both_ways(&file);
        for count in [states.len(), indexed] {
            assert!(count == before || Some(count) == after, "{before} {count} {after:?}");
        }
        if let Change::Length(_) = change {
            // A call is complete: all its data are in the file, and nothing else.
            assert_eq!((Some(states.len()), Some(indexed)), (after, after));
            assert!(mcap::MessageStream::new(&file).unwrap().all(|message| message.is_ok()));
            (before, after) = (indexed, marks.next());
        }
    }
    assert_eq!(after, None);
}

#[test]
fn a_full_disk_leaves_the_last_whole_file() {
    let record = |journal: &mut Journal| -> Result<(), WriteError> {
        let config = RecorderConfig { period: MS * 50, ..RecorderConfig::default() };
        let mut recorder = Recorder::new(&mut *journal, &Robot::lbr_iiwa_7_r800(), config)?;
        for k in 0..200 {
            if let Err(error) = recorder.sample(MS * k, &[0.0; 7]) {
                // The error is permanent, even if there were space again.
                recorder.sample(MS * (k + 1), &[0.0; 7])?;
                assert!(recorder.flush().is_err());
                assert!(recorder.finish(&BTreeMap::new(), &[]).is_err());
                return Err(error);
            }
        }
        recorder.finish(&BTreeMap::new(), &[]).map(drop)
    };
    let mut journal = Journal::default();
    record(&mut journal).unwrap();

    let mut last = 0;
    for room in changes_of_new()..journal.changes.len() - 1 {
        let mut journal = Journal { room: Some(room), ..Journal::default() };
        if let Err(error) = record(&mut journal) {
            assert!(matches!(error, WriteError::Mcap { .. }), "{error}");
        }
        let states = joint_states(journal.content.get_ref());
        assert!(
            states.len() >= last && states.len().is_multiple_of(50),
            "{} after {last}",
            states.len()
        );
        last = states.len();
    }
    assert_eq!(last, 150);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn any_samples_and_flushes_come_back(
        period_us in 1_u64..20_000,
        steps in prop::collection::vec((1_u64..3_000_000, -3.0..3.0_f64, 0_u8..20), 0..200),
    ) {
        let mut recorder = recorder(memory(), Duration::from_micros(period_us));
        let mut t = Duration::ZERO;
        let mut expected = Vec::new();
        for (step_ns, angle, flush) in steps {
            t += Duration::from_nanos(step_ns);
            let q = std::array::from_fn(|joint| angle / (joint + 1) as f64);
            recorder.sample(t, &q).unwrap();
            expected.push((t, q));
            if flush == 0 {
                recorder.flush().unwrap();
            }
        }
        let file = recorder.finish(&BTreeMap::new(), &[]).unwrap().into_inner();
        let states: Vec<_> = joint_states(&file).iter().map(|state| (state.t_s, state.q)).collect();
        let expected: Vec<_> = expected.iter().map(|(t, q)| (t.as_secs_f64(), *q)).collect();
        prop_assert_eq!(states, expected);
    }
}
