//! Default ports.

/// Default UDP port of a drive for FRI: the first one that KUKA reserves for it.
pub const FRI_PORT: u16 = 30200;
/// Default TCP port of a robot program for instructions.
pub const CABINET_INSTRUCTIONS_PORT: u16 = 30001;
/// Default TCP port of a robot program for state changes.
pub const CABINET_STATE_PORT: u16 = 30002;
