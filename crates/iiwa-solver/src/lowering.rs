//! By how much the limits of a cell are lowered.

use iiwa_program::ByKind;

/// The factors by which the limits of a cell are lowered: 1 leaves them as they are.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lowering {
    pub(crate) of: ByKind<f64>,
    /// Of what the offsets of further limits leave of them.
    pub(crate) rows: f64,
}

impl Lowering {
    /// Whether it changes nothing.
    pub(crate) fn is_none(&self) -> bool {
        self.rows == 1.0 && self.of.values().all(|by| *by == 1.0)
    }
}
