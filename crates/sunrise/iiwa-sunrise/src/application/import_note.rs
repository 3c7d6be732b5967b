//! What a user should know of an imported program.

use iiwa_program::Source;

/// What the user should know of an imported program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ImportNote {
    /// A sentence without its capital and its full stop.
    pub text: String,
    /// What it is about.
    pub source: Source,
}
