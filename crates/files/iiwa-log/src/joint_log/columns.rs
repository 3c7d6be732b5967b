//! Roles of table columns, derived from their names.

use iiwa_kin::Robot;

use super::samples::PositionUnit;
use super::shown::shown;
use super::{AngleUnit, FilePlace, JointLogError, LogOptions, PositionSource, Positions};

/// Role of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ColumnRole {
    /// Time, s.
    Time,
    /// Whole seconds of the time.
    Seconds,
    /// Nanoseconds of the time, without its whole seconds.
    Nanoseconds,
    /// Position of the joint with this index, in this unit.
    Position(usize, PositionUnit),
    /// Torque exerted by the joint with this index, Nm.
    Exerted(usize),
    /// Torque of the joint with this index, Nm, with the opposite sign, as KUKA's controller
    /// measures it.
    Measured(usize),
    /// Any other column.
    PassedOver,
}

/// Columns of a table.
#[derive(Debug)]
pub(super) struct Columns {
    /// Role of each column.
    pub(super) roles: Vec<ColumnRole>,
    /// Name of each column.
    pub(super) names: Vec<String>,
    pub(super) source: PositionSource,
    pub(super) robot: Option<String>,
}

impl Columns {
    /// Assigns roles to the columns with these names; `place` is that of the names.
    pub(super) fn new(
        place: FilePlace,
        names: Vec<String>,
        options: LogOptions,
    ) -> Result<Self, JointLogError> {
        let mut columns =
            ColumnChoice { place, names: &names, roles: vec![ColumnRole::PassedOver; names.len()] };
        let sources = match options.positions {
            Positions::Measured => {
                [PositionSource::Measured, PositionSource::Commanded, PositionSource::Table]
            }
            Positions::Commanded => {
                [PositionSource::Commanded, PositionSource::Measured, PositionSource::Table]
            }
        };
        let joints = sources.into_iter().find_map(|source| {
            let joint = |name: &String| joint(source, &name.to_ascii_lowercase(), options.unit);
            let joints: Vec<_> = names.iter().map(joint).collect();
            joints.iter().any(Option::is_some).then_some((source, joints))
        });
        let split = names.iter().any(|name| is_seconds(name) || is_nanoseconds(name));

        let Some((source, joints)) = joints else {
            if split || names.iter().any(|name| is_time(name)) {
                return Err(columns.missing(&title(0), "`joint_1_rad` or `joint_1_deg`".to_owned()));
            }
            return Err(JointLogError::Unknown { found: format!("`{}`", names.join(" ")) });
        };
        let other = match options.positions {
            Positions::Measured => PositionSource::Commanded,
            Positions::Commanded => PositionSource::Measured,
        };
        if options.positions_required && source == other {
            let positions = options.positions;
            return Err(JointLogError::MissingPositions { place, positions });
        }
        if split {
            columns.choose("seconds", "`ZeitInSec`", ColumnRole::Seconds, is_seconds)?;
            columns.choose(
                "nanoseconds",
                "`ZeitInNanoSec`",
                ColumnRole::Nanoseconds,
                is_nanoseconds,
            )?;
        } else {
            let expected = "`t_s`, or `ZeitInSec` and `ZeitInNanoSec`";
            columns.choose("time", expected, ColumnRole::Time, is_time)?;
        }
        for wanted in 0..7 {
            let mut column_index = None;
            for (column, joint) in joints.iter().enumerate() {
                let Some((_, role)) = joint.as_ref().filter(|(index, _)| *index == wanted) else {
                    continue;
                };
                columns.set(&title(wanted), &mut column_index, column, *role)?;
            }
            if column_index.is_none() {
                let expected = match source {
                    PositionSource::Measured => format!("`axisQMsr_...[{wanted}]`"),
                    PositionSource::Commanded => format!("`axisQCmd_...[{wanted}]`"),
                    _ => format!("`joint_{0}_rad` or `joint_{0}_deg`", wanted + 1),
                };
                return Err(columns.missing(&title(wanted), expected));
            }
        }
        columns.find_torques();
        let robot = names.iter().find_map(|name| axis(source, &name.to_ascii_lowercase())?.1);
        let roles = columns.roles;
        Ok(Self { roles, names, source, robot })
    }

    /// Returns true if there are torques of all joints.
    pub(super) fn has_torques(&self) -> bool {
        self.roles
            .iter()
            .any(|role| matches!(role, ColumnRole::Exerted(_) | ColumnRole::Measured(_)))
    }

    /// Unit of each joint in the file.
    pub(super) fn units(&self) -> [PositionUnit; 7] {
        let mut units = [PositionUnit::Radians; 7];
        for role in &self.roles {
            if let ColumnRole::Position(joint, unit) = *role {
                units[joint] = unit;
            }
        }
        units
    }
}

/// Returns true if these are names of columns: of a time, and of a joint.
pub(super) fn are_columns(names: &[String]) -> bool {
    let sources = [PositionSource::Measured, PositionSource::Commanded, PositionSource::Table];
    let is_joint = |name: &String| {
        let name = name.to_ascii_lowercase();
        sources.iter().any(|source| joint(*source, &name, None).is_some())
    };
    names.iter().any(is_joint) && names.iter().any(|name| is_time(name) || is_seconds(name))
}

fn is_time(name: &str) -> bool {
    ["t_s", "time_s", "time", "t"].iter().any(|known| name.eq_ignore_ascii_case(known))
}

fn is_seconds(name: &str) -> bool {
    name.eq_ignore_ascii_case("ZeitInSec")
}

fn is_nanoseconds(name: &str) -> bool {
    name.eq_ignore_ascii_case("ZeitInNanoSec")
}

/// Columns while their roles are assigned.
struct ColumnChoice<'a> {
    place: FilePlace,
    names: &'a [String],
    roles: Vec<ColumnRole>,
}

impl ColumnChoice<'_> {
    /// Gives `role` to the only column whose name matches.
    fn choose(
        &mut self,
        quantity: &str,
        expected: &str,
        role: ColumnRole,
        fits: impl Fn(&str) -> bool,
    ) -> Result<(), JointLogError> {
        let mut column_index = None;
        for (column, name) in self.names.iter().enumerate() {
            if fits(name) {
                self.set(quantity, &mut column_index, column, role)?;
            }
        }
        column_index.map(drop).ok_or_else(|| self.missing(quantity, expected.to_owned()))
    }

    /// Gives `role` to a column, unless another column, in `found`, has that role.
    fn set(
        &mut self,
        quantity: &str,
        column_index: &mut Option<usize>,
        column: usize,
        role: ColumnRole,
    ) -> Result<(), JointLogError> {
        if let Some(first) = column_index.replace(column) {
            return Err(JointLogError::DuplicateColumn {
                place: self.place,
                quantity: quantity.to_owned(),
                first: self.names[first].clone(),
                second: self.names[column].clone(),
            });
        }
        self.roles[column] = role;
        Ok(())
    }

    /// Assigns roles to the torque columns if they cover all joints, otherwise ignores them.
    fn find_torques(&mut self) {
        let torques: Vec<_> =
            self.names.iter().map(|name| torque(&name.to_ascii_lowercase())).collect();
        let is_one = |role| torques.iter().filter(|torque| **torque == Some(role)).count() == 1;
        let exerted = (0..7).all(|joint| is_one(ColumnRole::Exerted(joint)));
        let measured = !exerted && (0..7).all(|joint| is_one(ColumnRole::Measured(joint)));
        for (role, torque) in self.roles.iter_mut().zip(torques) {
            match torque {
                Some(ColumnRole::Exerted(_)) if exerted => *role = torque.unwrap_or(*role),
                Some(ColumnRole::Measured(_)) if measured => *role = torque.unwrap_or(*role),
                _ => {}
            }
        }
    }

    fn missing(&self, quantity: &str, expected: String) -> JointLogError {
        JointLogError::MissingColumn { place: self.place, quantity: quantity.to_owned(), expected }
    }
}

fn title(joint: usize) -> String {
    format!("joint A{}", joint + 1)
}

/// Returns the joint whose position a column of this source contains, by its lower-case name.
fn joint(
    source: PositionSource,
    name: &str,
    unit: Option<AngleUnit>,
) -> Option<(usize, ColumnRole)> {
    if source != PositionSource::Table {
        let (joint, _) = axis(source, name)?;
        return Some((joint, ColumnRole::Position(joint, unit_or_unstated(unit))));
    }
    let (joint, stated) = joint_column(name)?;
    Some((joint, ColumnRole::Position(joint, unit_or_unstated(stated.or(unit)))))
}

/// Returns the joint whose position a table column contains, from 0, and the unit that the column
/// name states.
///
/// ```
/// use iiwa_log::{AngleUnit, joint_column};
///
/// assert_eq!(joint_column("A1_deg"), Some((0, Some(AngleUnit::Degrees))));
/// assert_eq!(joint_column("q07"), Some((6, None)));
/// assert_eq!(joint_column("joint_8"), None);
/// ```
#[must_use]
pub fn joint_column(name: &str) -> Option<(usize, Option<AngleUnit>)> {
    let name = name.to_ascii_lowercase();
    let (stem, unit) = match (name.strip_suffix("_deg"), name.strip_suffix("_rad")) {
        (Some(stem), _) => (stem, Some(AngleUnit::Degrees)),
        (_, Some(stem)) => (stem, Some(AngleUnit::Radians)),
        _ => (&*name, None),
    };
    let number = ["iiwa_joint_", "joint_", "q", "a"].iter().find_map(|p| stem.strip_prefix(p))?;
    Some((joint_of_number(number)?, unit))
}

/// Returns the joint with a number from 1 to 7, which may have leading zeros.
fn joint_of_number(number: &str) -> Option<usize> {
    let joint = digit(number.trim_start_matches('0'))?.checked_sub(1)?;
    Some(joint).filter(|joint| *joint < 7)
}

fn unit_or_unstated(unit: Option<AngleUnit>) -> PositionUnit {
    match unit {
        Some(AngleUnit::Radians) => PositionUnit::Radians,
        Some(AngleUnit::Degrees) => PositionUnit::Degrees,
        None => PositionUnit::Unstated,
    }
}

/// Returns the torque role of a column, by its lower-case name.
fn torque(name: &str) -> Option<ColumnRole> {
    if let Some(recorded) = name.strip_prefix("axistaumsr") {
        let (_, index) = recorded.strip_suffix(']')?.split_once('[')?;
        return digit(index).filter(|joint| *joint < 7).map(ColumnRole::Measured);
    }
    let stem = name.strip_suffix("_nm").unwrap_or(name);
    let stem = ["torque_", "effort_"].iter().find_map(|prefix| stem.strip_prefix(prefix))?;
    let number =
        ["iiwa_joint_", "joint_"].iter().find_map(|p| stem.strip_prefix(p)).unwrap_or(stem);
    joint_of_number(number).map(ColumnRole::Exerted)
}

/// Returns joint and robot of a `DataRecorder` column, by its lower-case name:
/// `axisqmsr_lbr_iiwa_7_r800_1[0]` is joint 0 of an `lbr_iiwa_7_r800`.
fn axis(source: PositionSource, name: &str) -> Option<(usize, Option<String>)> {
    let prefix = if source == PositionSource::Measured { "axisqmsr" } else { "axisqcmd" };
    let (device, index) = name.strip_prefix(prefix)?.strip_suffix(']')?.split_once('[')?;
    let joint = digit(index).filter(|joint| *joint < 7)?;
    // Skips the rest of the signal name: `axisqcmdt1m_` is longer than `axisqcmd_`.
    let device = device.split_once('_').map_or("", |(_, device)| device).trim_start_matches('_');
    let built_in = Robot::BUILT_IN.iter().find(|robot| device.starts_with(*robot));
    let robot = built_in.map_or_else(|| shown(device.as_bytes()), |robot| (*robot).to_owned());
    Some((joint, Some(robot).filter(|robot| !robot.is_empty())))
}

fn digit(text: &str) -> Option<usize> {
    let [digit @ b'0'..=b'9'] = text.as_bytes() else { return None };
    Some(usize::from(digit - b'0'))
}
