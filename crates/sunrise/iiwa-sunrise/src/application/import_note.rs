//! Notes on an imported program.

use iiwa_program::Source;

/// Note for the user of an imported program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ImportNote {
    /// Sentence without its capital and its full stop.
    pub text: String,
    /// Place in the sources.
    pub source: Source,
}
