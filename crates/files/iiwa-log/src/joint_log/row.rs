//! Row of a table of joint positions.

use super::columns::ColumnRole;

/// Numbers of a row in the columns that are read.
#[derive(Debug, Default)]
pub(super) struct LogRow {
    time_s: f64,
    /// Whole seconds and nanoseconds, where the time is in two columns.
    split: Option<[f64; 2]>,
    /// Positions, in the units of the file.
    pub(super) positions: [f64; 7],
    /// Torques, Nm, with the controller's sign.
    pub(super) measured_nm: [f64; 7],
}

impl LogRow {
    /// Stores a number of a column. The error is the expected content.
    pub(super) fn set(&mut self, role: ColumnRole, value: f64) -> Result<(), &'static str> {
        match role {
            ColumnRole::Time => self.time_s = value,
            ColumnRole::Seconds if value.fract() != 0.0 || value.abs() > MAX_SECONDS => {
                return Err("a whole number of seconds");
            }
            ColumnRole::Seconds => self.split.get_or_insert_default()[0] = value,
            ColumnRole::Nanoseconds if value.fract() != 0.0 || !(0.0..1e9).contains(&value) => {
                return Err("a whole number of nanoseconds below 1000000000");
            }
            ColumnRole::Nanoseconds => self.split.get_or_insert_default()[1] = value,
            ColumnRole::Position(joint, _) => self.positions[joint] = value,
            ColumnRole::Exerted(joint) => self.measured_nm[joint] = 0.0 - value,
            ColumnRole::Measured(joint) => self.measured_nm[joint] = value,
            ColumnRole::PassedOver => {}
        }
        Ok(())
    }

    /// Time, s. If the time has two columns, it counts from `origin`, the first time: seconds since
    /// 1970 would leave too few digits for the fraction.
    pub(super) fn t_s(&self, origin: &mut Option<[f64; 2]>) -> f64 {
        let Some([seconds, nanoseconds]) = self.split else { return self.time_s };
        let [first_seconds, first_nanoseconds] = *origin.get_or_insert([seconds, nanoseconds]);
        ((seconds - first_seconds) * 1e9 + (nanoseconds - first_nanoseconds)) / 1e9
    }
}

/// Upper bound on seconds: beyond any clock, and differences are still exact.
const MAX_SECONDS: f64 = 1e12;
