//! Files and crates stay small enough to be read.

use std::collections::BTreeMap;
use std::path::Path;

use crate::tests::architecture::offenders::forbid;
use crate::tests::architecture::sources::{files, members, root, shown, text};

const FILE_LINES: usize = 600;
const CRATE_LINES: usize = 8000;

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

#[test]
fn no_crate_is_larger_than_8000_lines() {
    let mut large = BTreeMap::new();
    for member in members() {
        let src = member.folder.join("src");
        let lines: usize = files(&src, &["rs"]).iter().map(|path| lines(path)).sum();
        if lines > CRATE_LINES {
            large.insert(shown(&src), format!("{lines} lines, at most {CRATE_LINES}"));
        }
    }
    forbid(
        "size",
        &large,
        "Move what others could use into the library it belongs to, or cut the crate in two.",
    );
}
