//! Kinds of changes that a search may make.

/// Kinds of changes that a search may make.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(clippy::struct_excessive_bools, reason = "each kind is chosen by itself")]
#[expect(clippy::exhaustive_structs, reason = "a struct of choices is written out in full")]
pub struct Freedom {
    /// Elbow angles (E1) at targets.
    pub elbows: bool,
    /// Ends of motions: blends, stops, and motions whose end the program need not wait for.
    pub blends: bool,
    /// Speeds of point-to-point motions.
    pub speeds: bool,
    /// Waits at rest that could run during the motion before them.
    pub waits: bool,
}

impl Freedom {
    /// All kinds. Only a person can tell if a wait may run during a motion.
    pub const ALL: Self = Self { waits: true, ..Self::MOTIONS };
    /// Changes of motions; waits stay as they are.
    pub const MOTIONS: Self = Self { elbows: true, blends: true, speeds: true, waits: false };
    /// Nothing.
    pub const NONE: Self = Self { elbows: false, blends: false, speeds: false, waits: false };
    /// Elbow angles alone: lines, circles and splines keep their paths and programmed speeds.
    pub const ELBOWS: Self = Self { elbows: true, ..Self::NONE };
}
