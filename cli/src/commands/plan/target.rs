//! Names of trajectory files.

use std::path::{Path, PathBuf};

/// Returns true if the program is read from standard input.
pub(super) fn is_stdin(program: &Path) -> bool {
    program == Path::new("-")
}

/// Returns the name of a program's MCAP file.
pub(super) fn file_name(program: &Path) -> PathBuf {
    let stem = match program.file_stem() {
        Some(stem) if !is_stdin(program) => stem.to_owned(),
        _ => "program".into(),
    };
    let mut name = stem;
    name.push(".mcap");
    PathBuf::from(name)
}
