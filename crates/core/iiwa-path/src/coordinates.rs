//! Coordinates that have limits.

/// A value for each coordinate that has limits: the seven joints and, last, the [coordinate of the
/// tool](crate::ToolCoordinate), which is zero where none of its limits holds.
pub type Coordinates = [f64; 8];
