//! Reported losses of a file.

use iiwa_log::{FilePlace, JointLog, JointLogError, Loss};

use crate::joint_log::{HEADER, millis, read, recording, table};

#[test]
fn gaps() {
    let mut t_s = millis(1000);
    // Gaps of one sample, of two samples, and of half a second.
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
    assert_eq!(log.losses, [Loss::Repeated { first: FilePlace::Line(4), t_s: 0.1, count: 3 }]);
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

/// Returns true if the log is a part of the test motion from its start; checks that a loss reports
/// the missing rest.
fn check_prefix(file: &[u8], whole: &JointLog, label: &str) -> bool {
    let Ok(log) = JointLog::read(file) else { return false };
    let count = log.t_s.len();
    assert!(count > 0, "{label}");
    assert_eq!(log.t_s, whole.t_s[..count], "{label}");
    assert_eq!(log.q_rad, whole.q_rad[..count], "{label}");
    if log.losses.is_empty() {
        assert_eq!(&log, whole, "{label}");
    } else {
        let Loss::BrokenOff { t_s, samples, reason } = &log.losses[0] else { panic!("{label}") };
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
    // The file of a killed recorder has no metadata.
    assert_eq!(log.robot.as_deref(), Some("lbr_iiwa_14_r820"));
    let text = log.losses[0].to_string();
    assert!(text.contains("samples: the file is cut off: it ends after"), "{text}");
}

#[test]
fn a_recording_that_is_damaged() {
    let file = recording(300, &[]);
    let whole = JointLog::read(&*file).unwrap();
    for offset in (0..file.len()).step_by(61).chain(0..200) {
        let mut bytes = file.clone();
        bytes[offset] ^= 0x55;
        // Data after the last sample contain no samples, so the loss may concern none.
        check_prefix(&bytes, &whole, &format!("byte {offset}"));
    }
}
