//! The rules that keep the workspace easy to change, held against its sources: the arrows between
//! crates, circles between files, names, and names in the documentation.

mod arrows;
mod circles;
mod documents;
mod literals;
mod module_tree;
mod names;
mod offenders;
mod single_use_case;
mod sources;
