//! Choices for reading a table of joint positions.

/// Choices for reading a table: what its columns leave open.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct LogOptions {
    /// The unit of positions whose columns name none. Left out, a `DataRecorder`'s are in rad unless one of them is beyond
    /// every range in rad: then they are in degrees, and [`Loss::DegreesAssumed`](crate::Loss::DegreesAssumed) says so.
    pub unit: Option<AngleUnit>,
    /// The positions that are read where a `DataRecorder` has both; by default, measured ones.
    pub positions: Positions,
}

/// The unit of an angle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AngleUnit {
    /// Radians.
    Radians,
    /// Degrees.
    Degrees,
}

/// The positions of a `DataRecorder`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Positions {
    /// Measured positions (encoders).
    #[default]
    Measured,
    /// Commanded positions, without noise and lag.
    Commanded,
}

impl LogOptions {
    /// Sets the unit of columns that name none.
    #[must_use]
    pub fn with_unit(mut self, unit: AngleUnit) -> Self {
        self.unit = Some(unit);
        self
    }

    /// Sets the preferred positions.
    #[must_use]
    pub fn with_positions(mut self, positions: Positions) -> Self {
        self.positions = positions;
        self
    }
}
