//! Kinds of changes that a search may make.

/// Kinds of changes that a search may make.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(clippy::exhaustive_structs, reason = "a struct of choices is written out in full")]
pub struct Freedom {
    /// Elbow angles (E1) at targets.
    pub elbows: bool,
    /// Ends of motions: blends, stops, and motions whose end the program need not wait for.
    pub blends: bool,
    /// Speeds of point-to-point motions.
    pub speeds: bool,
}

impl Freedom {
    /// All kinds.
    pub const ALL: Self = Self { elbows: true, blends: true, speeds: true };
    /// Elbow angles alone: lines, circles and splines keep their paths and programmed speeds.
    pub const ELBOWS: Self = Self { elbows: true, blends: false, speeds: false };
}
