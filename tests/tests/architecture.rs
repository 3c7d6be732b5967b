//! The rules that keep the workspace easy to change, held against its sources: sizes, the arrows between
//! crates, circles between files, names, and names in the documentation.

#![expect(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "a failed test is a panic"
)]

mod arrows;
mod circles;
mod documents;
mod literals;
mod module_tree;
mod names;
mod offenders;
mod sizes;
mod sources;
