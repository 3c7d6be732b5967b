//! Architecture rules, checked on the sources of the workspace: dependencies between crates, cycles
//! between files, names, and names in the documentation.

mod arrows;
mod circles;
mod documents;
mod literals;
mod module_tree;
mod names;
mod offenders;
mod single_use_case;
mod sources;
