//! Options for logs and tables whose columns do not state everything.

use clap::{Args, ValueEnum};
use iiwa_log::{AngleUnit, LogOptions, Positions};

/// Help of `--positions` for commands that prefer commanded positions.
pub(super) const COMMANDED_PREFERRED: &str = "Columns of a `DataRecorder` log: commanded positions \
    (axisQCmd) or measured positions (axisQMsr, with lag and noise) [default: commanded if the log \
    has them, otherwise measured]";

/// Options for reading logs and tables.
#[derive(Args, Clone, Copy, Debug)]
pub(crate) struct LogReading {
    /// Unit of joint positions, for files whose columns do not state it: `DataRecorder` logs, and
    /// tables with columns such as `q1` [default: rad, but deg for a `DataRecorder` log with a
    /// position that no joint can reach in rad]
    #[arg(long, value_enum, value_name = "UNIT")]
    unit: Option<AngleName>,

    /// Columns of a `DataRecorder` log: commanded positions (axisQCmd) or measured positions
    /// (axisQMsr, with lag and noise) [default: measured if the log has them, otherwise commanded]
    #[arg(long, value_enum, value_name = "POSITIONS")]
    positions: Option<PositionKind>,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum AngleName {
    /// Degrees
    Deg,
    /// Radians
    Rad,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum PositionKind {
    /// Positions that the controller commanded
    Commanded,
    /// Positions that the encoders measured
    Measured,
}

impl LogReading {
    /// The options for reading; `default` unless the command line names the positions.
    pub(crate) fn options(self, default: Positions) -> LogOptions {
        let options = LogOptions::default();
        let options = match self.positions {
            Some(PositionKind::Commanded) => options.with_only(Positions::Commanded),
            Some(PositionKind::Measured) => options.with_only(Positions::Measured),
            None => options.with_positions(default),
        };
        match self.unit {
            Some(AngleName::Deg) => options.with_unit(AngleUnit::Degrees),
            Some(AngleName::Rad) => options.with_unit(AngleUnit::Radians),
            None => options,
        }
    }
}
