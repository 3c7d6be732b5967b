//! Choices for reading a table of joint positions.

/// Options for reading a table, for the information that column names leave open.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct LogOptions {
    /// Unit of positions whose columns name none. If unset, the positions of a `DataRecorder` are
    /// in rad unless one of them is beyond every joint range in rad: then they are in degrees, and
    /// [`Loss::DegreesAssumed`](crate::Loss::DegreesAssumed) reports this.
    pub unit: Option<AngleUnit>,
    /// Preferred positions if a `DataRecorder` log has both; default: measured ones.
    pub positions: Positions,
    /// `true` if a `DataRecorder` log without these positions is an error; by default, the other
    /// ones are read.
    pub positions_required: bool,
}

/// Unit of an angle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AngleUnit {
    /// Radians.
    Radians,
    /// Degrees.
    Degrees,
}

/// Kind of positions of a `DataRecorder`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Positions {
    /// Measured positions (encoders).
    #[default]
    Measured,
    /// Commanded positions, without noise and lag.
    Commanded,
}

impl Positions {
    /// Name of the positions, and prefix of their columns.
    pub(super) fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::Measured => ("measured", "axisQMsr"),
            Self::Commanded => ("commanded", "axisQCmd"),
        }
    }

    /// The other kind.
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

    /// Restricts a `DataRecorder` log to these positions.
    #[must_use]
    pub fn with_only(mut self, positions: Positions) -> Self {
        self.positions = positions;
        self.positions_required = true;
        self
    }
}
