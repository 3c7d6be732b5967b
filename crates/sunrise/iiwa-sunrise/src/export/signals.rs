//! Inputs and outputs of an exported class: `Group.Signal` is a signal of the class `GroupIOGroup`
//! that Sunrise Workbench generates for a group.

use iiwa_program::{IoEntry, IoKind, IoValue, MotionIndex, Program};

use super::{error::ExportError, identifier::is_name_part, literal::number};

/// Package of the generated classes.
const PACKAGE: &str = "com.kuka.generated.ioAccess";

/// Signal of a group, as Java names.
pub(super) struct ExportedSignal<'p> {
    group: &'p str,
    signal: &'p str,
}

/// Name of the field with a group.
fn field_of(group: &str) -> String {
    format!("io{group}")
}

/// Fields of the groups of a program.
pub(super) fn fields(program: &Program) -> impl Iterator<Item = String> {
    let groups = program.motions.iter().filter_map(|entry| Some(entry.io()?.io.split_once('.')?.0));
    groups.map(field_of)
}

impl<'p> ExportedSignal<'p> {
    pub(super) fn new(motion: MotionIndex, entry: &'p IoEntry) -> Result<Self, ExportError> {
        let fault = |why| ExportError::NotInSunrise { motion, key: "io", why };
        let Some((group, signal)) = entry.io.split_once('.') else {
            return Err(fault("name the group and the signal, as `Group.Signal`"));
        };
        let begins_with_digit = group.starts_with(|c: char| c.is_ascii_digit());
        if is_name_part(group) && is_name_part(signal) && !begins_with_digit {
            return Ok(Self { group, signal });
        }
        Err(fault(
            "group and signal are parts of Java names: use ASCII letters, digits and `_`, as in \
             `Group.Signal`",
        ))
    }

    /// Full name of the class of the group.
    pub(super) fn import(&self) -> String {
        format!("{PACKAGE}.{}", self.class())
    }

    /// Class of the group.
    pub(super) fn class(&self) -> String {
        format!("{}IOGroup", self.group)
    }

    /// Field with the group.
    pub(super) fn field(&self) -> String {
        field_of(self.group)
    }

    /// Statement of an entry, without indentation.
    pub(super) fn statement(
        &self,
        motion: MotionIndex,
        entry: &IoEntry,
        indent: usize,
    ) -> Result<String, ExportError> {
        let (field, signal) = (self.field(), self.signal);
        let fault = |why| ExportError::NotInSunrise { motion, key: "value", why };
        match (entry.kind, entry.value) {
            (IoKind::Set, value) => {
                let value = match value {
                    IoValue::Boolean(value) => value.to_string(),
                    IoValue::Digital(value) => match i64::try_from(value) {
                        Ok(value) if i32::try_from(value).is_ok() => value.to_string(),
                        Ok(value) => format!("{value}L"),
                        Err(_) => return Err(fault("Java's whole numbers end at 2^63 - 1")),
                    },
                    IoValue::Analog(value) => number(value),
                };
                Ok(format!("{:indent$}{field}.set{signal}({value});", ""))
            }
            (IoKind::WaitFor { seconds }, IoValue::Boolean(value)) => {
                let not = if value { "!" } else { "" };
                Ok(format!(
                    "{:indent$}while ({not}{field}.get{signal}()) {{ // iiwasim: {seconds} s\n\
                     {:indent$}    ThreadUtil.milliSleep(10L);\n{:indent$}}}",
                    "", "", ""
                ))
            }
            (IoKind::WaitFor { .. }, _) => Err(fault(
                "a wait for a number is not exported; wait for true or false, or remove the wait",
            )),
        }
    }
}
