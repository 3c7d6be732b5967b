//! Inputs and outputs of an exported class: `Group.Signal` is a signal of the class `GroupIOGroup`
//! that Sunrise Workbench generates for a group.

use std::collections::BTreeSet;

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

/// Whole number of a value. Negative whole numbers are included: programs do not distinguish whole
/// numbers from real ones among them, and Java converts whole numbers to real ones.
fn whole(value: IoValue) -> Option<i64> {
    match value {
        IoValue::Boolean(_) => None,
        IoValue::Digital(value) => i64::try_from(value).ok(),
        #[expect(clippy::cast_possible_truncation, reason = "the number is whole and small enough")]
        IoValue::Analog(value) => {
            let is_whole = value.fract() == 0.0 && (-MAX_EXACT..0.0).contains(&value);
            is_whole.then_some(value as i64)
        }
    }
}

/// Whole numbers up to here are exact as floating-point numbers: 2^53.
const MAX_EXACT: f64 = 9_007_199_254_740_992.0;

/// Signals of a program that have a value beyond Java's `int`: all of their whole numbers are
/// `long`, because Java does not convert an `int` to the `Long` of such a signal's setter.
pub(super) fn long_signals(program: &Program) -> BTreeSet<&str> {
    let is_long =
        |entry: &&IoEntry| whole(entry.value).is_some_and(|value| i32::try_from(value).is_err());
    let entries = program.motions.iter().filter_map(|entry| entry.io());
    entries.filter(is_long).map(|entry| entry.io.as_str()).collect()
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
        long_signals: &BTreeSet<&str>,
        indent: usize,
    ) -> Result<String, ExportError> {
        let (field, signal) = (self.field(), self.signal);
        let fault = |why| ExportError::NotInSunrise { motion, key: "value", why };
        match (entry.kind, entry.value) {
            (IoKind::Set, value) => {
                let value = match value {
                    IoValue::Digital(value) if i64::try_from(value).is_err() => {
                        return Err(fault("Java's whole numbers end at 2^63 - 1"));
                    }
                    value => match (whole(value), value) {
                        (Some(value), _) if long_signals.contains(&*entry.io) => {
                            format!("{value}L")
                        }
                        (Some(value), _) => value.to_string(),
                        (None, IoValue::Analog(value)) => number(value),
                        (None, value) => value.to_string(),
                    },
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
