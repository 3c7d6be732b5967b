//! The queue on disk: order, restarts, bounds, damage.

#![expect(clippy::unwrap_used, reason = "a failed test panics")]

use std::{fs, io, path::Path};

use iiwa_bridge::spool::{self, Spool, SpoolReader};
use proptest::prelude::*;

const MB: u64 = 1 << 20;

fn record(number: u64, length: usize) -> Vec<u8> {
    let mut bytes = number.to_le_bytes().to_vec();
    bytes.resize(length.max(8), 7);
    bytes
}

fn number(record: &[u8]) -> u64 {
    u64::from_le_bytes(*record.first_chunk().unwrap())
}

fn rest(spool: &Spool, reader: &mut SpoolReader) -> Vec<u64> {
    let mut all = Vec::new();
    loop {
        let batch = reader.batch(spool, 64, 1 << 20).unwrap();
        if batch.is_empty() {
            return all;
        }
        all.extend(batch.iter().map(|record| number(record)));
    }
}

fn segments(folder: &Path) -> Vec<std::path::PathBuf> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut all: Vec<_> =
        entries.filter(|path| path.extension().is_some_and(|it| it == "spool")).collect();
    all.sort();
    all
}

#[test]
fn committed_records_are_not_read_again_after_a_restart() {
    let folder = tempfile::tempdir().unwrap();
    {
        let (spool, mut reader) = spool::open(folder.path(), 64 * MB).unwrap();
        for i in 0..1000 {
            spool.append(&record(i, 300)).unwrap();
        }
        assert_eq!(reader.batch(&spool, 400, usize::MAX).unwrap().len(), 400);
        reader.commit(&spool).unwrap();
        reader.save(&spool).unwrap();
        // The records are read, but not committed.
        assert_eq!(reader.batch(&spool, 100, usize::MAX).unwrap().len(), 100);
    }
    let (spool, mut reader) = spool::open(folder.path(), 64 * MB).unwrap();
    spool.append(&record(5000, 8)).unwrap();
    let expected: Vec<u64> = (400..500).chain(500..1000).chain([5000]).collect();
    // All records except the tail that was never written to the system.
    assert_eq!(rest(&spool, &mut reader), expected);
}

#[test]
fn a_rewound_reader_begins_behind_the_last_commit() {
    let folder = tempfile::tempdir().unwrap();
    let (spool, mut reader) = spool::open(folder.path(), 64 * MB).unwrap();
    for i in 0..10 {
        spool.append(&record(i, 8)).unwrap();
    }
    assert_eq!(reader.batch(&spool, 4, usize::MAX).unwrap().len(), 4);
    reader.commit(&spool).unwrap();
    assert_eq!(rest(&spool, &mut reader), [4, 5, 6, 7, 8, 9]);
    reader.rewind();
    assert_eq!(rest(&spool, &mut reader), [4, 5, 6, 7, 8, 9]);
}

#[test]
fn a_full_spool_drops_and_counts_the_oldest() {
    let folder = tempfile::tempdir().unwrap();
    let (spool, mut reader) = spool::open(folder.path(), 16 * MB).unwrap();
    let count = 40_000;
    for i in 0..count {
        spool.append(&record(i, 1000)).unwrap();
    }
    let level = spool.level();
    assert!(level.bytes <= 16 * MB + 1000, "{level:?}");
    assert!(level.dropped > 0);
    let remaining = rest(&spool, &mut reader);
    assert_eq!(remaining, (level.dropped..count).collect::<Vec<_>>());
}

#[test]
fn committed_segments_are_removed() {
    let folder = tempfile::tempdir().unwrap();
    let (spool, mut reader) = spool::open(folder.path(), 1024 * MB).unwrap();
    for i in 0..30_000 {
        spool.append(&record(i, 1000)).unwrap();
    }
    assert!(segments(folder.path()).len() > 5);
    assert_eq!(rest(&spool, &mut reader).len(), 30_000);
    reader.commit(&spool).unwrap();
    assert_eq!(segments(folder.path()).len(), 1);
    assert_eq!(spool.level().dropped, 0);
}

#[test]
fn damage_costs_a_segment_and_no_more() {
    let folder = tempfile::tempdir().unwrap();
    let count = 12_000;
    {
        let (spool, _) = spool::open(folder.path(), 1024 * MB).unwrap();
        for i in 0..count {
            spool.append(&record(i, 1000)).unwrap();
        }
    }
    let damaged = &segments(folder.path())[1];
    let mut bytes = fs::read(damaged).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    fs::write(damaged, bytes).unwrap();
    let (spool, mut reader) = spool::open(folder.path(), 1024 * MB).unwrap();
    let remaining = rest(&spool, &mut reader);
    assert!(remaining.is_sorted_by(|a, b| a < b));
    assert_eq!(remaining[0], 0);
    // Half of a segment is lost, and the records that had not been written to the system.
    assert!(remaining.len() > 8000, "{}", remaining.len());
    let gaps = remaining.windows(2).filter(|pair| pair[1] != pair[0] + 1).count();
    assert_eq!(gaps, 1);
}

#[test]
fn two_processes_do_not_share_a_spool() {
    let folder = tempfile::tempdir().unwrap();
    let (_spool, _reader) = spool::open(folder.path(), 64 * MB).unwrap();
    let error = spool::open(folder.path(), 64 * MB).unwrap_err();
    assert_eq!(error.kind(), io::ErrorKind::WouldBlock);
}

#[test]
fn files_that_are_no_segments_are_left_alone() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("notes.txt"), "mine").unwrap();
    fs::write(folder.path().join("000000000000.spool"), "nonsense").unwrap();
    fs::write(folder.path().join("cursor"), "x y z").unwrap();
    let (spool, mut reader) = spool::open(folder.path(), 64 * MB).unwrap();
    spool.append(&record(3, 8)).unwrap();
    assert_eq!(rest(&spool, &mut reader), [3]);
    assert_eq!(fs::read_to_string(folder.path().join("notes.txt")).unwrap(), "mine");
}

/// A folder with a file outside of the spool, to which a link in the spool refers.
#[cfg(unix)]
struct Victim {
    above: tempfile::TempDir,
}

#[cfg(unix)]
impl Victim {
    fn new() -> Self {
        let above = tempfile::tempdir().unwrap();
        fs::create_dir(above.path().join("spool")).unwrap();
        fs::write(above.path().join("victim"), "iiwaspl1 precious").unwrap();
        Self { above }
    }

    fn spool(&self) -> std::path::PathBuf {
        self.above.path().join("spool")
    }

    /// Puts a link to the victim into the spool.
    fn link(&self, name: &str) {
        std::os::unix::fs::symlink(self.above.path().join("victim"), self.spool().join(name))
            .unwrap();
    }

    /// Asserts that the error names the link and the remedy, and that the victim is unchanged.
    fn check(&self, name: &str, error: &io::Error) {
        let error = error.to_string();
        let link = self.spool().join(name);
        let expected = format!("{} is a symbolic link, which the bridge has not", link.display());
        assert!(error.starts_with(&expected) && error.contains(": remove it"), "{error}");
        assert!(link.is_symlink());
        let content = fs::read_to_string(self.above.path().join("victim")).unwrap();
        assert_eq!(content, "iiwaspl1 precious");
    }
}

#[cfg(unix)]
#[test]
fn a_spool_with_a_link_is_not_opened() {
    for name in ["lock", "cursor", "000000000001.spool"] {
        let victim = Victim::new();
        victim.link(name);
        victim.check(name, &spool::open(&victim.spool(), 64 * MB).unwrap_err());
        // The remedy from the error message.
        fs::remove_file(victim.spool().join(name)).unwrap();
        spool::open(&victim.spool(), 64 * MB).unwrap();
    }
}

#[cfg(unix)]
#[test]
fn links_that_appear_later_are_not_followed() {
    let victim = Victim::new();
    let (spool, mut reader) = spool::open(&victim.spool(), 64 * MB).unwrap();
    victim.link("cursor.new");
    victim.check("cursor.new", &reader.save(&spool).unwrap_err());
    fs::remove_file(victim.spool().join("cursor.new")).unwrap();
    // A file left behind by a killed process.
    fs::write(victim.spool().join("cursor.new"), "1").unwrap();
    reader.save(&spool).unwrap();
    assert!(!victim.spool().join("cursor.new").exists());

    victim.link("000000000002.spool");
    let failed = (0..6).find_map(|i| spool.append(&record(i, 1 << 20)).err()).unwrap();
    victim.check("000000000002.spool", &failed);
    fs::remove_file(victim.spool().join("000000000002.spool")).unwrap();
    spool.append(&record(7, 8)).unwrap();
    assert_eq!(rest(&spool, &mut reader).last(), Some(&7));
}

#[test]
fn the_content_of_the_lock_stays() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("lock"), "mine").unwrap();
    let (_spool, _reader) = spool::open(folder.path(), 64 * MB).unwrap();
    assert_eq!(fs::read_to_string(folder.path().join("lock")).unwrap(), "mine");
}

#[derive(Clone, Debug)]
enum Step {
    Append(usize),
    Read(usize),
    Commit,
    Rewind,
    Reopen,
}

fn steps() -> impl Strategy<Value = Vec<Step>> {
    let step = prop_oneof![
        4 => (8_usize..200_000).prop_map(Step::Append),
        2 => (1_usize..20).prop_map(Step::Read),
        2 => Just(Step::Commit),
        1 => Just(Step::Rewind),
        1 => Just(Step::Reopen),
    ];
    proptest::collection::vec(step, 1..120)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    /// The queue behaves like a list with a mark at the last commit: records are read in order,
    /// each once between commits.
    #[test]
    fn it_is_a_queue(steps in steps()) {
        let folder = tempfile::tempdir().unwrap();
        let (mut spool, mut reader) = spool::open(folder.path(), 1024 * MB).unwrap();
        let (mut appended, mut committed, mut next) = (0_u64, 0_u64, 0_u64);
        for step in steps {
            match step {
                Step::Append(length) => {
                    spool.append(&record(appended, length)).unwrap();
                    appended += 1;
                }
                Step::Read(max_count) => {
                    let batch = reader.batch(&spool, max_count, usize::MAX).unwrap();
                    let expected: Vec<u64> = (next..appended).take(max_count).collect();
                    prop_assert_eq!(
                        batch.iter().map(|it| number(it)).collect::<Vec<_>>(),
                        expected
                    );
                    next += batch.len() as u64;
                }
                Step::Commit => {
                    reader.commit(&spool).unwrap();
                    committed = next;
                }
                Step::Rewind => {
                    reader.rewind();
                    next = committed;
                }
                Step::Reopen => {
                    // Same as at the end of a bridge: all records are read, so that none is only in
                    // memory.
                    while !reader.batch(&spool, 1000, usize::MAX).unwrap().is_empty() {}
                    reader.save(&spool).unwrap();
                    drop(spool);
                    (spool, reader) = spool::open(folder.path(), 1024 * MB).unwrap();
                    next = committed;
                }
            }
        }
    }
}
