//! What the end-to-end tests share: the reference programs, and random programs.

pub mod random;
pub mod reference;

use std::path::PathBuf;

/// A file below `fixtures/`.
#[must_use]
pub fn fixture(name: &str) -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../fixtures")).join(name)
}
