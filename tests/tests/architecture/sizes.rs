//! Files stay small enough to be read.

use std::path::Path;

use crate::tests::architecture::offenders::forbid;
use crate::tests::architecture::sources::{files, root, shown, text};

const FILE_LINES: usize = 600;

fn lines(path: &Path) -> usize {
    text(path).lines().count()
}

#[test]
fn no_file_is_longer_than_600_lines() {
    let long = files(&root(), &["rs", "js", "py"])
        .iter()
        .map(|path| (shown(path), lines(path)))
        .filter(|(_, lines)| *lines > FILE_LINES)
        .map(|(path, lines)| (path, format!("{lines} lines")))
        .collect();
    forbid("file", &long, "Split each by idea, and name the parts after theirs.");
}
