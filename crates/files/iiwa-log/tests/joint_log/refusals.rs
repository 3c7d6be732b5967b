//! Rejected content, and the error texts.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::io::{self, Cursor, Read};
use std::time::Duration;

use iiwa_kin::{Joint, Robot};
use iiwa_log::{JointLog, JointLogError, ReadError, Recorder, RecorderConfig};

use crate::joint_log::{DATA_RECORDER, HEADER, millis, read, recording, refused, table};

#[test]
fn files_of_another_kind() {
    assert!(matches!(JointLog::read(&b""[..]), Err(JointLogError::Empty)));
    for blank in ["\n", " \r\n\n", "\u{feff}"] {
        assert!(matches!(read(blank), Err(JointLogError::NoSamples)), "{blank:?}");
    }
    for other in ["{\"version\": 1}\n", "x,y,z\n1,2,3\n", "\0\0\0\0", "PK\u{3}\u{4}"] {
        assert!(matches!(read(other), Err(JointLogError::Unknown { .. })), "{other:?}");
    }
    let unknown = JointLog::read(&vec![0xff; 200_000][..]).unwrap_err();
    assert!(matches!(unknown, JointLogError::Unknown { .. }), "{unknown}");
    let long = "x,".repeat(100_000);
    assert!(matches!(read(&long), Err(JointLogError::Unknown { .. })));
    assert_eq!(
        refused("\u{1b}[31mred\n"),
        "neither an MCAP file nor a table of joint positions: expected a header line such as \
         `t_s,joint_1_rad,...,joint_7_rad`, found `\\\\u{1b}[31mred`"
            .replace("\\\\", "\\")
    );
    let error = refused("0,1,2,3,1,2,3,1\n");
    assert!(error.ends_with("found numbers: `0,1,2,3,1,2,3,1`"), "{error}");
}

#[test]
fn nothing_but_a_header() {
    for text in [HEADER.to_owned(), format!("{HEADER}\n"), format!("{HEADER}\n0.0,1")] {
        assert!(matches!(read(&text), Err(JointLogError::NoSamples)), "{text}");
    }
    let error = JointLog::read(&*recording(0, &[])).unwrap_err();
    assert!(matches!(error, JointLogError::NoSamples), "{error}");
}

#[test]
fn columns() {
    let row = "\n0,0,0,0,0,0,0,0\n";
    let cases = [
        (
            "t_s,q1,q2,q4,q5,q6,q7,q8",
            "line 1: no column for joint A3, expected `joint_3_rad` or `joint_3_deg`",
        ),
        (
            "q1,q2,q3,q4,q5,q6,q7,u",
            "line 1: no column for time, expected `t_s`, or `ZeitInSec` and `ZeitInNanoSec`",
        ),
        ("t_s,x,y", "line 1: no column for joint A1, expected `joint_1_rad` or `joint_1_deg`"),
        (
            "t_s,q1,q2,q3,q4,q5,q6,q7,q1_deg",
            "line 1: `q1` and `q1_deg` are both a column for joint A1",
        ),
        ("t_s,q1,q2,q3,q4,q5,q6,q7,time", "line 1: `t_s` and `time` are both a column for time"),
        (
            "ZeitInSec,q1,q2,q3,q4,q5,q6,q7",
            "line 1: no column for nanoseconds, expected `ZeitInNanoSec`",
        ),
        (
            "ZeitInNanoSec,q1,q2,q3,q4,q5,q6,q7",
            "line 1: no column for seconds, expected `ZeitInSec`",
        ),
        (
            "t,axisQMsr_R[0],axisQMsr_R[1],q1,q2,q3,q4,q5,q6,q7",
            "line 1: no column for joint A3, expected `axisQMsr_...[2]`",
        ),
    ];
    for (header, expected) in cases {
        assert_eq!(refused(&format!("{header}{row}")), expected);
    }
    let two = "t axisQCmd_A[0] axisQCmd_A[1] axisQCmd_A[2] axisQCmd_A[3] axisQCmd_A[4] \
               axisQCmd_A[5] axisQCmd_A[6] axisQCmd_B[0]";
    assert_eq!(
        refused(two),
        "line 1: `axisQCmd_A[0]` and `axisQCmd_B[0]` are both a column for joint A1"
    );
}

#[test]
fn fields() {
    let good = "0.0,0,0,0,0,0,0,0\n";
    let cases = [
        ("0.1,0,0,0,0,0,0\n", "line 3 has 7 fields, the header has 8"),
        (
            "0.1,0,0,0,0,0,0,\n",
            "line 3, column `joint_7_rad`: `` is not a finite number with a decimal point",
        ),
        ("0.1,0,0,0,0,0,0,0,0\n", "line 3 has 9 fields, the header has 8"),
        // Decimal commas.
        ("0,1,0,0,0,0,0,0,0,0,0,0,0,0,0,0\n", "line 3 has 16 fields, the header has 8"),
        (
            "0.1,0,0,left,0,0,0,0\n",
            "line 3, column `joint_3_rad`: `left` is not a finite number with a decimal point",
        ),
        (
            "0.1,0,0,0,0,0,0,nan\n",
            "line 3, column `joint_7_rad`: `nan` is not a finite number with a decimal point",
        ),
        (
            "inf,0,0,0,0,0,0,0\n",
            "line 3, column `t_s`: `inf` is not a finite number with a decimal point",
        ),
        (
            "0.1,0,1e999,0,0,0,0,0\n",
            "line 3, column `joint_2_rad`: `1e999` is not a finite number with a decimal point",
        ),
    ];
    for (line, expected) in cases {
        assert_eq!(refused(&format!("{HEADER}\n{good}{line}0.2,0,0,0,0,0,0,0\n")), expected);
        // The same line as the last one, with a line break.
        assert_eq!(refused(&format!("{HEADER}\n{good}{line}")), expected);
    }
    let commas = format!("{}\n0,5;0;0;0;0;0;0;0\n", HEADER.replace(',', ";"));
    assert_eq!(
        refused(&commas),
        "line 2, column `t_s`: `0,5` is not a finite number with a decimal point"
    );
    let stamps = "ZeitInSec,ZeitInNanoSec,q1,q2,q3,q4,q5,q6,q7\n";
    assert_eq!(
        refused(&format!("{stamps}1,1000000000,0,0,0,0,0,0,0\n")),
        "line 2, column `ZeitInNanoSec`: `1000000000` is not a whole number of nanoseconds below \
         1000000000"
    );
    assert_eq!(
        refused(&format!("{stamps}1.5,0,0,0,0,0,0,0,0\n")),
        "line 2, column `ZeitInSec`: `1.5` is not a whole number of seconds"
    );
}

#[test]
fn a_recording_that_is_not_a_number() {
    let robot = Robot::lbr_iiwa_7_r800();
    for bad in [f64::NAN, f64::INFINITY] {
        let storage = Cursor::new(Vec::new());
        let mut recorder = Recorder::new(storage, &robot, RecorderConfig::default()).unwrap();
        recorder.sample(Duration::ZERO, &[0.0; 7]).unwrap();
        recorder.sample(Duration::from_millis(1), &[0.0, bad, 0.0, 0.0, 0.0, 0.0, 0.0]).unwrap();
        let file = recorder.finish(&BTreeMap::new(), &[]).unwrap().into_inner();
        let error = JointLog::read(&*file).unwrap_err().to_string();
        assert!(error.starts_with("sample 2: joint A2 is at "), "{error}");
    }
}

#[test]
fn time_that_does_not_run_on() {
    let text = table(&[0.0, 0.1, 0.2, 0.1, 0.3]);
    assert_eq!(refused(&text), "line 5: time runs backwards, from 0.2 s to 0.1 s");
    let text = format!("{HEADER}\n0.1,0,0,0,0,0,0,0\n0.1,0,0,0,0,0,0,1e-9\n");
    assert_eq!(refused(&text), "line 3: a second sample at 0.1 s, with other positions");
}

#[test]
fn degrees_for_radians() {
    let text = format!("{HEADER}\n0.1,0,45,0,0,0,0,0\n0.2,0,45,0,0,0,0,0\n");
    assert_eq!(
        refused(&text),
        "line 2: joint A2 at 45 rad, and no LBR iiwa turns further than 3.054 rad (175 degrees): \
         the positions look like degrees, which need columns such as `joint_2_deg`"
    );
    let degrees = read(&text.replace("_rad", "_deg")).unwrap();
    assert_eq!(degrees.q_rad[0][1], 45_f64.to_radians());

    // Three degrees at 20 degrees per second: within the range, yet too fast for radians.
    let mut text = format!("{HEADER}\n");
    for k in 0..150 {
        writeln!(text, "{:?},0,0,0,{:?},0,0,0", f64::from(k) * 1e-3, f64::from(k) * 0.02).unwrap();
    }
    let error = read(&text).unwrap_err();
    let JointLogError::TooFast { joint: Joint::A4, found_rad_s, .. } = error else {
        panic!("{error}")
    };
    assert!((found_rad_s - 20.0).abs() < 1e-6);
    let degrees = read(&text.replace("_rad", "_deg")).unwrap();
    degrees.check_robot(&Robot::lbr_iiwa_7_r800()).unwrap();
}

#[test]
fn stamps_in_bursts_are_not_speed() {
    // Pairs of samples 0.02 ms apart, 10 ms from pair to pair, as a network may deliver them.
    let t_s: Vec<f64> =
        (0..200).map(|k| f64::from(k / 2) * 1e-2 + f64::from(k % 2) * 2e-5).collect();
    let q_rad = (0..200).map(|k| [f64::from(k) * 5e-3; 7]).collect();
    let mut bytes = Vec::new();
    JointLog::new(t_s, q_rad).write_csv(&mut bytes).unwrap();
    assert!(JointLog::read(&*bytes).is_ok());
}

#[test]
fn time_that_is_not_in_seconds() {
    let log = |period_s: f64| {
        let t_s = (0..100).map(|k| f64::from(k) * period_s).collect();
        JointLog::new(t_s, vec![[0.0; 7]; 100]).check_rate()
    };
    for period_s in [1e-4, 1e-3, 2e-2, 0.1] {
        log(period_s).unwrap();
    }
    // Milliseconds read as seconds, and seconds read as milliseconds.
    for period_s in [1.0, 20.0, 1e-6, 2e-5] {
        assert!(matches!(log(period_s), Err(JointLogError::Rate { .. })), "{period_s}");
    }
    JointLog::new(vec![0.0], vec![[0.0; 7]]).check_rate().unwrap();
}

#[test]
fn another_robot() {
    let small = Robot::lbr_iiwa_7_r800();
    let large = Robot::lbr_iiwa_14_r820();
    let log = JointLog::read(DATA_RECORDER).unwrap();
    log.check_robot(&small).unwrap();
    assert_eq!(
        log.check_robot(&large).unwrap_err().to_string(),
        "recorded on another robot: lbr_iiwa_7_r800, not lbr_iiwa_14_r820"
    );

    let mut log = JointLog::new(vec![0.0, 1.0], vec![[0.0; 7]; 2]);
    log.check_robot(&small).unwrap();
    // A position measured slightly outside the range.
    log.q_rad[1][3] = -120.4_f64.to_radians();
    log.t_s[1] = 2.0;
    log.check_robot(&small).unwrap();
    log.q_rad[1][3] = -121_f64.to_radians();
    assert_eq!(
        log.check_robot(&small).unwrap_err().to_string(),
        "joint A4 is at -121.00 degrees at 2.000 s, and the range of lbr_iiwa_7_r800 ends at \
         -120.00: wrong robot or wrong units"
    );
    log.q_rad[1][3] = f64::NAN;
    assert!(log.check_robot(&small).is_err());

    // Joint 4 of the large robot is slower.
    let log = JointLog::new(vec![0.0, 1.0], vec![[0.0; 7], [0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0]]);
    log.check_robot(&small).unwrap();
    let error = log.check_robot(&large).unwrap_err();
    assert!(matches!(error, JointLogError::TooFast { joint: Joint::A4, .. }), "{error}");
}

#[test]
fn no_motion() {
    let mut log = JointLog::new(millis(1000), vec![[0.1; 7]; 1000]);
    assert_eq!(
        log.check_motion().unwrap_err().to_string(),
        "no motion: no joint moves by more than 0.0e0 rad in 0.999 s"
    );
    log.q_rad[500][6] += 0.0011;
    log.check_motion().unwrap();
    assert!(JointLog::default().check_motion().is_err());
}

#[test]
fn a_stream_that_fails() {
    struct Broken;

    impl Read for Broken {
        fn read(&mut self, _: &mut [u8]) -> io::Result<usize> {
            Err(io::Error::other("the disk is gone"))
        }
    }

    let table = table(&millis(20_000));
    let recording = recording(20_000, &[]);
    for bytes in [&[], table.as_bytes(), &recording[..recording.len() / 2]] {
        let error = JointLog::read(bytes.chain(Broken)).unwrap_err();
        assert!(
            matches!(
                error,
                JointLogError::Io { .. }
                    | JointLogError::Recording { source: ReadError::Io { .. } }
            ),
            "{error}"
        );
    }
}
