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
    /// Whether a `DataRecorder` log without these positions is refused; by default, the others are read.
    pub positions_required: bool,
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

impl Positions {
    /// Their name, and the beginning of the names of their columns.
    pub(super) fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::Measured => ("measured", "axisQMsr"),
            Self::Commanded => ("commanded", "axisQCmd"),
        }
    }

    /// The others.
    pub(super) fn other(self) -> Self {
        match self {
            Self::Measured => Self::Commanded,
            Self::Commanded => Self::Measured,
        }
    }
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

    /// Sets the only positions that are read of a `DataRecorder`.
    #[must_use]
    pub fn with_only(mut self, positions: Positions) -> Self {
        self.positions = positions;
        self.positions_required = true;
        self
    }
}
