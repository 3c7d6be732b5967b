//! Joint positions from files of every kind: what is read, what is refused, and what is lost.

#![expect(
    clippy::unwrap_used,
    clippy::panic,
    clippy::float_cmp,
    reason = "a failed test is a panic, and what is read back is what was written, bit by bit"
)]

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::io::{self, Cursor, Read};
use std::time::Duration;

use iiwa_kin::{Joints, Robot};
use iiwa_log::{JointLog, JointLogError, Loss, Place, ReadError, Recorder, RecorderConfig, Source};
use proptest::prelude::*;

const HEADER: &str =
    "t_s,joint_1_rad,joint_2_rad,joint_3_rad,joint_4_rad,joint_5_rad,joint_6_rad,joint_7_rad";
const DATA_RECORDER: &[u8] = include_bytes!("../../../fixtures/data-recorder.log");

fn read(text: &str) -> Result<JointLog, JointLogError> {
    JointLog::read(text.as_bytes())
}

/// The error's text.
fn refused(text: &str) -> String {
    read(text).unwrap_err().to_string()
}

/// A swing.
fn swing(t_s: f64) -> Joints {
    std::array::from_fn(|joint| 0.5 * ((joint + 1) as f64 * t_s).sin())
}

/// A table of the swing at these times, as `write_csv` writes it.
fn table(t_s: &[f64]) -> String {
    let log = JointLog::new(t_s.to_vec(), t_s.iter().map(|t_s| swing(*t_s)).collect());
    let mut bytes = Vec::new();
    log.write_csv(&mut bytes).unwrap();
    String::from_utf8(bytes).unwrap()
}

fn millis(count: u32) -> Vec<f64> {
    (0..count).map(|k| Duration::from_millis(k.into()).as_secs_f64()).collect()
}

/// A recording of the swing at 1 kHz, with a chunk every 100 ms.
fn recording(samples: u32, metadata: &[(&str, &str)]) -> Vec<u8> {
    let config = RecorderConfig { period: Duration::from_millis(100), ..RecorderConfig::default() };
    let robot = Robot::lbr_iiwa_14_r820();
    let mut recorder = Recorder::new(Cursor::new(Vec::new()), &robot, config).unwrap();
    for k in 0..samples {
        let t = Duration::from_millis(k.into());
        recorder.sample(t, &swing(t.as_secs_f64())).unwrap();
    }
    let metadata: BTreeMap<_, _> =
        metadata.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
    let program: (&str, &str, &[u8]) = ("program.json", "application/json", b"{\"version\": 1}");
    recorder.finish(&metadata, &[program]).unwrap().into_inner()
}

mod formats {
    use super::*;

    #[test]
    fn mcap() {
        let log = JointLog::read(&*recording(1500, &[("robot", "my_robot")])).unwrap();
        assert_eq!(log.t_s, millis(1500));
        assert_eq!(log.q_rad, log.t_s.iter().map(|t_s| swing(*t_s)).collect::<Vec<_>>());
        assert_eq!(log.robot.as_deref(), Some("my_robot"));
        assert_eq!(log.program.as_deref(), Some("{\"version\": 1}"));
        assert_eq!(log.source, Some(Source::Mcap));
        assert_eq!(log.losses, []);
        assert_eq!(log.duration_s(), 1.499);
        assert!((log.period_s().unwrap() - 0.001).abs() < 1e-12);
    }

    #[test]
    fn the_robot_of_a_recording_without_metadata_is_the_described_one() {
        let log = JointLog::read(&*recording(10, &[])).unwrap();
        assert_eq!(log.robot.as_deref(), Some("lbr_iiwa_14_r820"));
    }

    #[test]
    fn csv_as_it_is_written() {
        let text = table(&millis(100));
        assert!(text.starts_with(&format!("{HEADER}\n0.0,0.0,")), "{text}");
        let log = read(&text).unwrap();
        assert_eq!(log.t_s, millis(100));
        assert_eq!(log.q_rad, log.t_s.iter().map(|t_s| swing(*t_s)).collect::<Vec<_>>());
        assert_eq!((log.robot, log.program, log.source), (None, None, Some(Source::Table)));
        assert_eq!(log.losses, []);
    }

    #[test]
    fn every_name_and_delimiter() {
        let expected = read("t q1 q2 q3 q4 q5 q6 q7\n0.5 .1 .2 .3 .4 .5 .6 .7\n").unwrap();
        assert_eq!(expected.t_s, [0.5]);
        assert_eq!(expected.q_rad, [[0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7]]);
        for (stem, unit) in
            [("joint_", "_rad"), ("iiwa_joint_", ""), ("q", "_rad"), ("A", ""), ("Joint_", "")]
        {
            for time in ["t_s", "time_s", "Time", "t"] {
                for between in [",", ";", "\t", " ", "   ", " ; ", ", "] {
                    for (end, quote) in [("\n", ""), ("\r\n", "\""), ("\r\n", ""), ("\n", "\"")] {
                        let header =
                            (1..=7).map(|joint| format!("{quote}{stem}{joint}{unit}{quote}"));
                        let header: Vec<_> =
                            [format!("{quote}{time}{quote}")].into_iter().chain(header).collect();
                        let row: Vec<_> = [0.5, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7]
                            .map(|value| format!("{quote}{value}{quote}"))
                            .into();
                        let text =
                            [header.join(between), row.join(between), String::new()].join(end);
                        let log = read(&text).unwrap_or_else(|error| panic!("{text}{error}"));
                        assert_eq!(log, expected, "{text}");
                    }
                }
            }
        }
    }

    #[test]
    fn other_columns_in_any_order() {
        let log = read(
            "\u{feff}\n  \nnote;q7;q6_deg;q5;q4;q3;q2;q1_rad;force_n;time_s;\n\
             begin, here;7e-1;190;.5;.4;.3;.2;+0.1;NaN;-1e1;\n\n   \n\
             ;0.7;-90.0;0.5;0.4;0.3;0.2;0.1;;0;\n",
        );
        let log = log.unwrap_err().to_string();
        // 190 degrees are beyond any joint, and the line counts from the file's first.
        assert!(log.starts_with("line 4: joint 6 at 190 degrees"), "{log}");
        let log = read(
            "note;q7;q6_deg;q5;q4;q3;q2;q1_rad;force_n;time_s;\n\
             begin, here;7e-1;18;.5;.4;.3;.2;+0.1;NaN;-1e1;\n\n   \n\
             ;0.7;-90.0;0.5;0.4;0.3;0.2;0.1;;0;\n",
        )
        .unwrap();
        assert_eq!(log.t_s, [-10.0, 0.0]);
        assert_eq!(log.q_rad[0], [0.1, 0.2, 0.3, 0.4, 0.5, 18_f64.to_radians(), 0.7]);
        assert_eq!(log.q_rad[1][5], -90_f64.to_radians());
    }

    #[test]
    fn data_recorder() {
        let log = JointLog::read(DATA_RECORDER).unwrap();
        assert_eq!(log.source, Some(Source::Measured));
        assert_eq!(
            log.source.unwrap().to_string(),
            "a DataRecorder log, measured positions (axisQMsr)"
        );
        assert_eq!(log.robot.as_deref(), Some("lbr_iiwa_7_r800"));
        // The stamps pass a whole second, and are too large for a double with all their digits.
        assert_eq!(log.t_s, [0.0, 0.001, 0.002, 0.003, 0.004]);
        assert_eq!(log.q_rad[0], [0.1, 0.2, -0.3, -1.5, 0.5, 0.6, -0.7]);
        assert_eq!(log.q_rad[4], [0.1004, 0.2004, -0.3004, -1.5004, 0.5004, 0.6004, -0.7004]);
        assert_eq!(log.losses, []);

        let text = std::str::from_utf8(DATA_RECORDER).unwrap();
        let commanded = read(&text.replace("axisQMsr", "axisTorque")).unwrap();
        assert_eq!(commanded.source, Some(Source::Commanded));
        assert_eq!(commanded.q_rad[0], [0.11, 0.21, -0.31, -1.51, 0.51, 0.61, -0.71]);
        for between in ["\t", ";", ",", "  "] {
            assert_eq!(read(&text.replace(' ', between)).unwrap(), log);
        }
        let other = read(&text.replace("iiwa_7_R800", "iiwa_14_R820")).unwrap();
        assert_eq!(other.robot.as_deref(), Some("lbr_iiwa_14_r820"));
        let other = read(&text.replace("LBR_iiwa_7_R800_1", "Arm")).unwrap();
        assert_eq!(other.robot.as_deref(), Some("arm"));
    }

    #[test]
    fn what_a_file_is_does_not_depend_on_how_it_comes() {
        /// Gives a byte at a time, and is interrupted every other time.
        struct Slow<'a>(&'a [u8], bool);

        impl Read for Slow<'_> {
            fn read(&mut self, room: &mut [u8]) -> io::Result<usize> {
                self.1 = !self.1;
                if self.1 {
                    return Err(io::ErrorKind::Interrupted.into());
                }
                let len = room.len().min(1);
                self.0.read(&mut room[..len])
            }
        }

        for bytes in [recording(20, &[]), table(&millis(20)).into_bytes(), DATA_RECORDER.to_vec()] {
            let log = JointLog::read(Slow(&bytes, false)).unwrap();
            assert_eq!(log, JointLog::read(&*bytes).unwrap());
        }
    }

    proptest! {
        #[test]
        fn csv_comes_back(
            t_s in proptest::collection::btree_set(-1_000_000_000_000_i64..1_000_000_000_000, 1..40),
            q_rad in proptest::collection::vec(proptest::array::uniform7(-3.0..3.0_f64), 40),
        ) {
            // Far enough apart that no joint is too fast.
            let t_s: Vec<f64> = t_s.into_iter().map(|t| t as f64 / 7.0).collect();
            let log = JointLog::new(t_s.clone(), q_rad[..t_s.len()].to_vec());
            let mut bytes = Vec::new();
            log.write_csv(&mut bytes).unwrap();
            match JointLog::read(&*bytes) {
                Ok(found) => {
                    prop_assert_eq!(found.t_s, log.t_s);
                    prop_assert_eq!(found.q_rad, log.q_rad);
                }
                Err(error) => prop_assert!(matches!(error, JointLogError::TooFast { .. }), "{}", error),
            }
        }
    }
}

mod refusals {
    use super::*;

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
                "line 1: no column for joint 3, expected `joint_3_rad` or `joint_3_deg`",
            ),
            (
                "q1,q2,q3,q4,q5,q6,q7,u",
                "line 1: no column for time, expected `t_s`, or `ZeitInSec` and `ZeitInNanoSec`",
            ),
            ("t_s,x,y", "line 1: no column for joint 1, expected `joint_1_rad` or `joint_1_deg`"),
            (
                "t_s,q1,q2,q3,q4,q5,q6,q7,q1_deg",
                "line 1: `q1` and `q1_deg` are both a column for joint 1",
            ),
            (
                "t_s,q1,q2,q3,q4,q5,q6,q7,time",
                "line 1: `t_s` and `time` are both a column for time",
            ),
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
                "line 1: no column for joint 3, expected `axisQMsr_...[2]`",
            ),
        ];
        for (header, expected) in cases {
            assert_eq!(refused(&format!("{header}{row}")), expected);
        }
        let two = "t axisQCmd_A[0] axisQCmd_A[1] axisQCmd_A[2] axisQCmd_A[3] axisQCmd_A[4] \
                   axisQCmd_A[5] axisQCmd_A[6] axisQCmd_B[0]";
        assert_eq!(
            refused(two),
            "line 1: `axisQCmd_A[0]` and `axisQCmd_B[0]` are both a column for joint 1"
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
            // The same in the last line, which has an end.
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
            "line 2, column `ZeitInNanoSec`: `1000000000` is not a whole number of nanoseconds below 1000000000"
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
            recorder
                .sample(Duration::from_millis(1), &[0.0, bad, 0.0, 0.0, 0.0, 0.0, 0.0])
                .unwrap();
            let file = recorder.finish(&BTreeMap::new(), &[]).unwrap().into_inner();
            let error = JointLog::read(&*file).unwrap_err().to_string();
            assert!(error.starts_with("sample 2: joint 2 is at "), "{error}");
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
            "line 2: joint 2 at 45 rad, and no LBR iiwa turns further than 3.054 rad (175 degrees): \
             the positions look like degrees, which need columns such as `joint_2_deg`"
        );
        let degrees = read(&text.replace("_rad", "_deg")).unwrap();
        assert_eq!(degrees.q_rad[0][1], 45_f64.to_radians());

        // Three degrees at 20 degrees a second: within the range, yet too fast for radians.
        let mut text = format!("{HEADER}\n");
        for k in 0..150 {
            writeln!(text, "{:?},0,0,0,{:?},0,0,0", f64::from(k) * 1e-3, f64::from(k) * 0.02)
                .unwrap();
        }
        let error = read(&text).unwrap_err();
        let JointLogError::TooFast { joint: 4, found_rad_s, .. } = error else { panic!("{error}") };
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
        // Milliseconds as seconds, and seconds as milliseconds.
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
            "a recording of lbr_iiwa_7_r800, not of lbr_iiwa_14_r820: wrong robot"
        );

        let mut log = JointLog::new(vec![0.0, 1.0], vec![[0.0; 7]; 2]);
        log.check_robot(&small).unwrap();
        // Measured a little outside of it.
        log.q_rad[1][3] = -120.4_f64.to_radians();
        log.t_s[1] = 2.0;
        log.check_robot(&small).unwrap();
        log.q_rad[1][3] = -121_f64.to_radians();
        assert_eq!(
            log.check_robot(&small).unwrap_err().to_string(),
            "joint 4 is at -121.00 degrees at 2.000 s, and the range of lbr_iiwa_7_r800 ends at \
             -120.00: wrong robot or wrong units"
        );
        log.q_rad[1][3] = f64::NAN;
        assert!(log.check_robot(&small).is_err());

        // Joint 4 of the large one is slower.
        let log =
            JointLog::new(vec![0.0, 1.0], vec![[0.0; 7], [0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0]]);
        log.check_robot(&small).unwrap();
        let error = log.check_robot(&large).unwrap_err();
        assert!(matches!(error, JointLogError::TooFast { joint: 4, .. }), "{error}");
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
}

mod losses {
    use super::*;

    #[test]
    fn gaps() {
        let mut t_s = millis(1000);
        // One sample, then two, then half a second.
        t_s.drain(300..800);
        t_s.drain(200..202);
        t_s.remove(100);
        let log = read(&table(&t_s)).unwrap();
        assert_eq!(log.t_s, t_s);
        assert_eq!(
            log.losses,
            [
                Loss::Gap { from_s: 0.199, to_s: 0.202, missing: 2 },
                Loss::Gap { from_s: 0.299, to_s: 0.8, missing: 500 },
            ]
        );
        assert_eq!(
            log.losses[1].to_string(),
            "no samples from 0.299 s to 0.800 s (0.501 s): some 500 are missing"
        );
    }

    #[test]
    fn repeated_samples() {
        let text = table(&[0.0, 0.1, 0.1, 0.2, 0.2, 0.2, 0.3]);
        let log = read(&text).unwrap();
        assert_eq!(log.t_s, [0.0, 0.1, 0.2, 0.3]);
        assert_eq!(log.losses, [Loss::Repeated { first: Place::Line(4), t_s: 0.1, count: 3 }]);
        assert_eq!(
            log.losses[0].to_string(),
            "3 samples repeat the one before and were left out, the first of them is line 4, at 0.100 s"
        );
    }

    #[test]
    fn a_table_that_is_cut_off() {
        let whole = read(&table(&millis(30))).unwrap();
        let text = table(&millis(30));
        for len in HEADER.len() + 1..text.len() {
            let part = &text[..len];
            let lines = part.lines().count() as u64;
            match read(part) {
                Ok(log) => {
                    let count = log.t_s.len();
                    assert_eq!(log.t_s, whole.t_s[..count]);
                    assert_eq!(log.q_rad, whole.q_rad[..count]);
                    if part.ends_with('\n') {
                        assert_eq!((log.losses, count as u64), (vec![], lines - 1));
                    } else {
                        assert_eq!(log.losses, [Loss::LastLine { line: lines }]);
                        assert_eq!(count as u64, lines - 2);
                    }
                }
                Err(JointLogError::NoSamples) => assert!(lines <= 2),
                Err(error) => panic!("{len}: {error}"),
            }
        }
    }

    /// Whether this is a beginning of the swing, and says so if it is not all of it.
    fn check_prefix(file: &[u8], whole: &JointLog, what: &str) -> bool {
        let Ok(log) = JointLog::read(file) else { return false };
        let count = log.t_s.len();
        assert!(count > 0, "{what}");
        assert_eq!(log.t_s, whole.t_s[..count], "{what}");
        assert_eq!(log.q_rad, whole.q_rad[..count], "{what}");
        if log.losses.is_empty() {
            assert_eq!(&log, whole, "{what}");
        } else {
            let Loss::BrokenOff { t_s, samples, reason } = &log.losses[0] else { panic!("{what}") };
            assert_eq!((*t_s, *samples), (whole.t_s[count - 1], count as u64));
            assert!(!reason.is_empty());
        }
        true
    }

    #[test]
    fn a_recording_that_is_cut_off() {
        let file = recording(1000, &[("robot", "lbr_iiwa_14_r820")]);
        let whole = JointLog::read(&*file).unwrap();
        let mut read = 0;
        for len in (0..file.len()).step_by(1000).chain(file.len() - 40..file.len()) {
            read += u32::from(check_prefix(&file[..len], &whole, &format!("{len} bytes")));
        }
        assert!(read > 100, "{read}");

        let log = JointLog::read(&file[..file.len() / 2]).unwrap();
        assert!((0.3..0.6).contains(&log.duration_s()), "{}", log.duration_s());
        // Killed, it has no metadata.
        assert_eq!(log.robot.as_deref(), Some("lbr_iiwa_14_r820"));
        let text = log.losses[0].to_string();
        assert!(text.contains("samples: the file is cut off: it ends after"), "{text}");
    }

    #[test]
    fn a_recording_that_is_damaged() {
        let file = recording(300, &[]);
        let whole = JointLog::read(&*file).unwrap();
        for at in (0..file.len()).step_by(61).chain(0..200) {
            let mut bytes = file.clone();
            bytes[at] ^= 0x55;
            // Nothing after the last sample is one, so that the loss may be of no sample.
            check_prefix(&bytes, &whole, &format!("byte {at}"));
        }
    }
}
