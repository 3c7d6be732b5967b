//! Parquet files as pandas, pyarrow, Polars and fastparquet write them (`parquet/make.py`), and
//! damaged ones.

use iiwa_log::{JointLog, JointLogError, LogOptions, Loss};

use super::swing;

macro_rules! fixture {
    ($name:literal) => {
        ($name, include_bytes!(concat!("parquet/", $name, ".parquet")).as_slice())
    };
}

const SWINGS: [(&str, &[u8]); 10] = [
    fixture!("snappy"),
    fixture!("gzip"),
    fixture!("brotli"),
    fixture!("lz4"),
    fixture!("zstd"),
    fixture!("none"),
    fixture!("v2"),
    fixture!("polars"),
    fixture!("fastparquet"),
    fixture!("names"),
];
const TYPES: &[u8] = fixture!("types").1;
const DIFFERENCES: &[u8] = fixture!("differences").1;
const NULL: &[u8] = fixture!("null").1;
const TEXT: &[u8] = fixture!("text").1;

/// Number of rows of each file.
const COUNT: usize = 40;

fn read(bytes: &[u8]) -> Result<JointLog, JointLogError> {
    JointLog::read_with(bytes, LogOptions::default())
}

fn refused(bytes: &[u8]) -> String {
    read(bytes).unwrap_err().to_string()
}

/// Compression, page versions, encodings, writers and other columns do not change the numbers.
#[test]
fn files_of_all_writers_have_the_same_numbers() {
    for (name, bytes) in SWINGS {
        let log = read(bytes).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(log.t_s.len(), COUNT, "{name}");
        for (number, (t_s, q_rad)) in log.t_s.iter().zip(&log.q_rad).enumerate() {
            assert_eq!(*t_s, 0.004 * number as f64, "{name}");
            let near =
                q_rad.iter().zip(swing(*t_s)).all(|(q, expected)| (q - expected).abs() < 1e-15);
            assert!(near, "{name}, row {number}: {q_rad:?}");
        }
        assert!(log.losses.is_empty(), "{name}: {:?}", log.losses);
    }
}

/// Integers of all sizes, floats of 16 and 32 bits, decimals, timestamps.
#[test]
fn numbers_of_all_types_are_read() {
    let log = read(TYPES).unwrap();
    for number in 0..COUNT {
        assert_eq!(log.t_s[number], 4e6 * number as f64 / 1e9);
        for joint in 0..7 {
            let degrees = (number / 4 + joint + 1) as f64;
            assert_eq!(log.q_rad[number][joint], degrees.to_radians(), "row {number}");
        }
        let torques = log.exerted_nm().nth(number).flatten().unwrap();
        assert_eq!(torques, std::array::from_fn(|j| (number * (j + 1)) as f64 / 100.0));
    }
    let log = read(DIFFERENCES).unwrap();
    for number in 0..COUNT {
        assert_eq!(log.t_s[number], 4e6 * number as f64 / 1e9);
        let degrees: [f64; 7] = std::array::from_fn(|joint| (number / 4 + joint + 1) as f64);
        assert_eq!(log.q_rad[number], degrees.map(f64::to_radians), "row {number}");
    }
}

#[test]
fn faults_have_their_row_and_column() {
    assert_eq!(refused(NULL), "row 12, column `joint_3_rad`: the value is missing (null)");
    let message = refused(TEXT);
    assert!(message.contains("column `joint_2_rad` has the type STRING: numbers"), "{message}");
    let none = fixture!("none").1;
    let text = |from: &str, to: &str| {
        let bytes = replaced(none, from.as_bytes(), to.as_bytes());
        assert_ne!(bytes, none);
        refused(&bytes)
    };
    assert_eq!(
        text("joint_3_rad", "joint_9_rad"),
        "schema: no column for joint A3, expected `joint_3_rad` or `joint_3_deg`"
    );
    let message = text("joint_3_rad", "joint_2_rad");
    assert!(message.starts_with("schema: `joint_2_rad` and `joint_2_rad` are both"), "{message}");
    // A number beyond all joint ranges, and NaN.
    let value = 0.5 * (7.0 * (0.004 * 11.0_f64)).sin();
    for (number, words) in [
        (90.0, "row 12: joint A7 at 90 rad"),
        (f64::NAN, "row 12, column `joint_7_rad`: `NaN` is not a finite number"),
    ] {
        let bytes = replaced(none, &value.to_le_bytes(), &f64::to_le_bytes(number));
        assert!(refused(&bytes).starts_with(words), "{}", refused(&bytes));
    }
}

/// Replaces all occurrences of a part of a file.
fn replaced(bytes: &[u8], from: &[u8], to: &[u8]) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    for at in 0..bytes.len() - from.len() {
        if bytes[at..].starts_with(from) {
            bytes.splice(at..at + from.len(), to.iter().copied());
        }
    }
    bytes
}

/// Columns that are not read may have any contents, and are not unpacked.
#[test]
fn other_columns_are_not_unpacked() {
    let (_, names) = fixture!("names");
    let texts = replaced(names, &[b'x'; 20], &[0xff; 20]);
    assert_ne!(texts, names);
    // Page headers of the first column, which begins behind the magic number.
    let mut damaged = texts;
    damaged[4..20].fill(0xff);
    assert_eq!(read(&damaged).unwrap(), read(names).unwrap());
}

/// Damaged files give errors, not panics, and no more samples than they have.
#[test]
fn damaged_files_are_refused_or_bounded() {
    let mut random = fastrand::Rng::with_seed(60);
    let seeds = SWINGS.iter().map(|it| it.1).chain([TYPES, DIFFERENCES, NULL]);
    let (mut accepted, mut damaged) = (0, 0);
    for seed in seeds {
        for _ in 0..400 {
            let mut bytes = seed.to_vec();
            for _ in 0..random.usize(1..4) {
                // Metadata at the end are as likely as the pages.
                let at = if random.bool() {
                    random.usize(..bytes.len())
                } else {
                    bytes.len() - 1 - random.usize(..bytes.len().min(1500))
                };
                match random.u8(..8) {
                    0 => bytes[at] = 0xff,
                    1 => bytes[at] = 0,
                    2 => bytes[at] = random.u8(..),
                    3 => drop(bytes.remove(at)),
                    4 => bytes.insert(at, random.u8(..)),
                    5 if random.u8(..8) == 0 => bytes.truncate(at.max(8)),
                    _ => bytes[at] ^= 1 << random.u8(..8),
                }
            }
            match read(&bytes) {
                Ok(log) => {
                    assert!(log.t_s.len() <= COUNT, "{}", log.t_s.len());
                    assert!(log.q_rad.as_flattened().iter().all(|q| q.is_finite()));
                    accepted += 1;
                }
                Err(error) => {
                    assert!(error.to_string().len() < 2000, "{error}");
                    damaged += 1;
                }
            }
        }
    }
    assert!(accepted > 100 && damaged > 100, "{accepted} accepted, {damaged} refused");
}

#[test]
fn cut_off_files_are_refused() {
    let (_, file) = fixture!("snappy");
    for length in (4..file.len()).step_by(7) {
        assert!(read(&file[..length]).is_err(), "{length}");
    }
    let message = refused(&file[..file.len() - 1]);
    assert!(message.contains("the file is cut off"), "{message}");
    let mut encrypted = file.to_vec();
    let end = encrypted.len();
    encrypted[end - 1] = b'E';
    assert!(refused(&encrypted).contains("encrypted"));
    assert!(!read(file).unwrap().losses.iter().any(|loss| matches!(loss, Loss::Gap { .. })));
}
