//! The rules that keep the workspace easy to change, held against its sources: sizes, the arrows between
//! crates, circles between files, names, and names in the documentation.
//!
//! A rule that today's code does not keep everywhere yet lists its offenders in [`known::KNOWN`]. The list
//! must shrink: an offender that has been mended has to leave it.

#![expect(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "a failed test is a panic"
)]

mod arrows;
mod circles;
mod documents;
mod known;
mod literals;
mod module_tree;
mod names;
mod sizes;
mod sources;
