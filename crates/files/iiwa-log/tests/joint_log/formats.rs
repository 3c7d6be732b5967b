//! Content read from each format.

use std::io::{self, Read};

use iiwa_log::{
    AngleUnit, FilePlace, JointLog, JointLogError, LogOptions, Loss, PositionSource, Positions,
};
use proptest::prelude::*;

use crate::joint_log::{DATA_RECORDER, HEADER, millis, read, recording, swing, table};

#[test]
fn mcap() {
    let log = JointLog::read(&*recording(1500, &[("robot", "my_robot")])).unwrap();
    assert_eq!(log.t_s, millis(1500));
    assert_eq!(log.q_rad, log.t_s.iter().map(|t_s| swing(*t_s)).collect::<Vec<_>>());
    assert_eq!(log.robot.as_deref(), Some("my_robot"));
    assert_eq!(log.program.as_deref(), Some("{\"version\": 1}"));
    assert_eq!(log.source, Some(PositionSource::Mcap));
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
    assert_eq!((log.robot, log.program, log.source), (None, None, Some(PositionSource::Table)));
    assert_eq!(log.losses, []);
}

#[test]
fn every_name_and_delimiter() {
    let expected =
        read("t q1_rad q2_rad q3_rad q4_rad q5_rad q6_rad q7_rad\n0.5 .1 .2 .3 .4 .5 .6 .7\n")
            .unwrap();
    assert_eq!(expected.t_s, [0.5]);
    assert_eq!(expected.q_rad, [[0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7]]);
    for (stem, unit) in
        [("joint_", "_rad"), ("iiwa_joint_", ""), ("q", "_rad"), ("A", ""), ("Joint_", "")]
    {
        for time in ["t_s", "time_s", "Time", "t"] {
            for between in [",", ";", "\t", " ", "   ", " ; ", ", "] {
                for (end, quote) in [("\n", ""), ("\r\n", "\""), ("\r\n", ""), ("\n", "\"")] {
                    let header = (1..=7).map(|joint| format!("{quote}{stem}{joint}{unit}{quote}"));
                    let header: Vec<_> =
                        [format!("{quote}{time}{quote}")].into_iter().chain(header).collect();
                    let row: Vec<_> = [0.5, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7]
                        .map(|value| format!("{quote}{value}{quote}"))
                        .into();
                    let text = [header.join(between), row.join(between), String::new()].join(end);
                    let mut log = read(&text).unwrap_or_else(|error| panic!("{text}{error}"));
                    let stated = if unit.is_empty() { vec![Loss::RadiansAssumed] } else { vec![] };
                    assert_eq!(std::mem::take(&mut log.losses), stated, "{text}");
                    assert_eq!(log, expected, "{text}");
                }
            }
        }
    }
}

/// Tests the headers of numpy and Excel, comments, other line ends and other encodings.
#[test]
fn headers_of_other_programs() {
    let columns: Vec<_> = (1..=7).map(|j| format!("joint_{j}_rad")).collect();
    let (names, row) = (format!("t_s,{}", columns.join(",")), "0.5,.1,.2,.3,.4,.5,.6,.7");
    let expected = read(&format!("{names}\n{row}\n")).unwrap();
    for text in [
        format!("# {names}\n{row}\n"),
        format!("% {names}\n{row}\n"),
        format!("# recorded 2026\n# {names}\n{row}\n"),
        format!("# recorded 2026\n{names}\n# begins here\n{row}\n"),
        format!("sep=,\r\n{names}\r\n{row}\r\n"),
        format!("{names}\r{row}\r"),
        format!("{names},Kraft ä\n{row},1\n"),
        format!("% {names}\n\n{row}\n"),
        format!("# note,{names}\nbegin,{row}\n"),
        format!("% note,{names}\n,{row}\n"),
        format!("#\n  % by hand\n\t# {names}\n{row}\n"),
        format!("{names}\n% begins here\n{row}\n  # ends here\n\t%\n"),
        format!("\t{}\n0\t{}\n", names.replace(',', "\t"), row.replace(',', "\t")),
        format!("{}\n{row}\n", names.replace("joint_", "q0")),
    ] {
        assert_eq!(read(&text).unwrap(), expected, "{text}");
    }
    let latin_1 = [names.as_bytes(), b",Kraft_\xe4\n", row.as_bytes(), b",1\n"].concat();
    assert_eq!(JointLog::read(&*latin_1).unwrap(), expected);
    let error = read(&format!("# {names}\n# {names}\n")).unwrap_err();
    assert!(matches!(error, JointLogError::NoSamples), "{error}");
    for (end, blank) in [("\n", ""), ("\r", ""), ("\r\n", ""), ("\n", "\n\n"), ("\r\n", "\r\n")] {
        let bad = "0.6,.1,x,.3,.4,.5,.6,.7";
        let text = [&format!("# {names}"), row, &format!("{blank}{bad}"), ""].join(end);
        let error = read(&text).unwrap_err().to_string();
        let line = 3 + blank.matches('\n').count();
        assert!(error.starts_with(&format!("line {line},")), "{error} in {text:?}");
    }
    let long = format!("# {}\n{names}\n{row}\n", "x".repeat(70_000));
    let error = read(&long).unwrap_err().to_string();
    assert!(error.contains("none in the first 64 KiB"), "{error}");
    let utf_16: Vec<u8> = "\u{feff}t_s".encode_utf16().flat_map(u16::to_le_bytes).collect();
    assert!(JointLog::read(&*utf_16).unwrap_err().to_string().contains("UTF-16"));
}

/// Tests that one damaged value does not change the unit of all others.
#[test]
fn a_table_without_units_is_never_read_in_degrees() {
    let text = "t q1 q2 q3 q4 q5 q6 q7\n0 0 0 0 0 0 0 0\n0.1 0 0 6.28 0 0 0 0\n";
    let error = read(text).unwrap_err().to_string();
    assert!(error.contains("line 3") && error.contains("A3"), "{error}");
}

#[test]
fn other_columns_in_any_order() {
    let log = read(
        "\u{feff}\n  \nnote;q7;q6_deg;q5;q4;q3;q2;q1_rad;force_n;time_s;\n\
         begin, here;7e-1;190;.5;.4;.3;.2;+0.1;NaN;-1e1;\n\n   \n\
         ;0.7;-90.0;0.5;0.4;0.3;0.2;0.1;;0;\n",
    );
    let log = log.unwrap_err().to_string();
    // 190 degrees exceed every joint range, and lines count from the first line of the file.
    assert!(log.starts_with("line 4: joint A6 at 190 degrees"), "{log}");
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
    assert_eq!(log.source, Some(PositionSource::Measured));
    assert_eq!(
        log.source.unwrap().to_string(),
        "a DataRecorder log, measured positions (axisQMsr)"
    );
    assert_eq!(log.robot.as_deref(), Some("lbr_iiwa_7_r800"));
    // The stamps pass a whole second, and have too many digits for a double.
    assert_eq!(log.t_s, [0.0, 0.001, 0.002, 0.003, 0.004]);
    assert_eq!(log.q_rad[0], [0.1, 0.2, -0.3, -1.5, 0.5, 0.6, -0.7]);
    assert_eq!(log.q_rad[4], [0.1004, 0.2004, -0.3004, -1.5004, 0.5004, 0.6004, -0.7004]);
    assert_eq!(log.losses, []);

    let text = std::str::from_utf8(DATA_RECORDER).unwrap();
    let commanded = read(&text.replace("axisQMsr", "axisTorque")).unwrap();
    assert_eq!(commanded.source, Some(PositionSource::Commanded));
    assert_eq!(commanded.q_rad[0], [0.11, 0.21, -0.31, -1.51, 0.51, 0.61, -0.71]);
    for between in ["\t", ";", ",", "  "] {
        assert_eq!(read(&text.replace(' ', between)).unwrap(), log);
    }
    let other = read(&text.replace("iiwa_7_R800", "iiwa_14_R820")).unwrap();
    assert_eq!(other.robot.as_deref(), Some("lbr_iiwa_14_r820"));
    let other = read(&text.replace("LBR_iiwa_7_R800_1", "Arm")).unwrap();
    assert_eq!(other.robot.as_deref(), Some("arm"));
}

/// Tests the format of the controller: a header that is a comment, degrees, and another name for
/// commanded positions.
#[test]
fn a_data_recorder_in_degrees() {
    let signal = |name: &str| {
        let column = |j: usize| format!(" {name}_LBR_iiwa_7_R800_1[{j}]");
        (0..7).map(column).collect::<String>()
    };
    let [measured, commanded] = ["axisQMsr", "axisQCmdT1m"].map(signal);
    let header = format!("%   ZeitInSec ZeitInNanoSec{measured}{commanded}\n");
    let still = " 15 1000000 0 0.001 0 1 0 0 0 0 0 0 1.01 0 0 0\n";
    let far = " 15 21000000 0 0.001 0 1.1 0 0 90 0 0 0 1.11 0 0 90.02\n";
    let text = [&header, still, far].concat();

    let log = read(&text).unwrap();
    assert_eq!(
        (log.robot.as_deref(), log.source),
        (Some("lbr_iiwa_7_r800"), Some(PositionSource::Measured))
    );
    let degrees = [[0.0, 0.001, 0.0, 1.0, 0.0, 0.0, 0.0], [0.0, 0.001, 0.0, 1.1, 0.0, 0.0, 90.0]];
    assert_eq!(log.q_rad, degrees.map(|q| q.map(f64::to_radians)));
    assert_eq!(log.t_s, [0.0, 0.02]);
    let assumed = Loss::DegreesAssumed { place: FilePlace::Line(3), joint: 7, found_deg: 90.0 };
    assert_eq!(log.losses, [assumed]);
    let message = "the file states no unit of its positions: read as degrees, as joint A7 is at \
                90.000 in line 3";
    assert_eq!(log.losses[0].to_string(), message);

    // A stated unit has priority, and small angles in degrees look like rad.
    let with = |text: &str, options| JointLog::read_with(text.as_bytes(), options);
    let in_degrees = LogOptions::default().with_unit(AngleUnit::Degrees);
    let stated = with(&text, in_degrees).unwrap();
    assert_eq!((stated.q_rad, stated.losses), (log.q_rad.clone(), vec![]));
    let short = [&header, still].concat();
    assert_eq!(read(&short).unwrap().q_rad[0][3], 1.0);
    assert_eq!(with(&short, in_degrees).unwrap().q_rad[0][3], 1_f64.to_radians());
    let error = with(&text, LogOptions::default().with_unit(AngleUnit::Radians)).unwrap_err();
    assert!(error.to_string().starts_with("line 3: joint A7 at 90 rad"), "{error}");
    let error = read(&text.replace("90", "190")).unwrap_err();
    assert!(error.to_string().starts_with("line 3: joint A7 at 190 degrees"), "{error}");

    let options = LogOptions::default().with_positions(Positions::Commanded);
    let commanded = with(&text, options).unwrap();
    assert_eq!(commanded.source, Some(PositionSource::Commanded));
    assert_eq!(commanded.robot.as_deref(), Some("lbr_iiwa_7_r800"));
    assert_eq!(commanded.q_rad[1][6], 90.02_f64.to_radians());
    // Without commanded positions, the others are read, unless the options exclude them.
    let measured_only = text.replace("axisQCmdT1m", "axisTauMsr");
    assert_eq!(with(&measured_only, options).unwrap().source, Some(PositionSource::Measured));
    let only = LogOptions::default().with_only(Positions::Commanded);
    assert_eq!(with(&text, only).unwrap().source, Some(PositionSource::Commanded));
    let error = with(&measured_only, only).unwrap_err().to_string();
    assert!(
        error.starts_with("line 1: no commanded positions (columns `axisQCmd_...[0]`"),
        "{error}"
    );
    assert_eq!(with(&table(&millis(3)), options).unwrap().source, Some(PositionSource::Table));
}

/// The unit in a column name has priority; the stated unit applies to the other columns.
#[test]
fn names_of_columns_win_over_options() {
    let options = LogOptions::default().with_unit(AngleUnit::Degrees);
    let text = "t q1 q2_rad q3 q4 q5 q6 q7\n0.5 90 1 2 3 4 5 6\n";
    let log = JointLog::read_with(text.as_bytes(), options).unwrap();
    assert_eq!(log.q_rad[0][..3], [90_f64.to_radians(), 1.0, 2_f64.to_radians()]);
}

#[test]
fn the_format_does_not_depend_on_the_reader() {
    /// Stream that returns one byte at a time, and is interrupted every other time.
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
        // The time steps are long enough for plausible joint speeds.
        let t_s: Vec<f64> = t_s.into_iter().map(|t| t as f64 / 7.0).collect();
        let log = JointLog::new(t_s.clone(), q_rad[..t_s.len()].to_vec());
        let mut bytes = Vec::new();
        log.write_csv(&mut bytes).unwrap();
        match JointLog::read(&*bytes) {
            Ok(copy) => {
                prop_assert_eq!(copy.t_s, log.t_s);
                prop_assert_eq!(copy.q_rad, log.q_rad);
            }
            Err(error) => prop_assert!(matches!(error, JointLogError::TooFast { .. }), "{}", error),
        }
    }
}
