//! Constants of the API's enums.

use std::rc::Rc;

/// Constant of a KUKA or Java enum.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct EnumConstant {
    /// Simple name of the enum.
    pub(crate) class: Rc<str>,
    pub(crate) name: Rc<str>,
    /// Position in the enum, where the position is relevant.
    pub(crate) ordinal: i32,
}

/// Enums with all of their constants, in order.
const LISTED: [(&str, &[&str]); 8] = [
    ("JointEnum", &["J1", "J2", "J3", "J4", "J5", "J6", "J7"]),
    (
        "TimeUnit",
        &["NANOSECONDS", "MICROSECONDS", "MILLISECONDS", "SECONDS", "MINUTES", "HOURS", "DAYS"],
    ),
    ("CartDOF", &["X", "Y", "Z", "A", "B", "C", "TRANSL", "ROT", "ALL"]),
    ("CoordinateAxis", &["X", "Y", "Z"]),
    ("SplineOrientationType", &["Constant", "Variable", "OriJoint", "Ignore"]),
    ("OrientationReferenceSystem", &["Base", "Path"]),
    ("ApplicationDialogType", &["INFORMATION", "QUESTION", "WARNING", "ERROR"]),
    ("IOTypes", &["BOOLEAN", "UNSIGNED_INTEGER", "INTEGER", "ANALOG"]),
];

/// Enums whose constants do not affect the plan.
const OTHERS: [&str; 15] = [
    "AxisEnum",
    "CallerTask",
    "ClientCommandMode",
    "DispatchedEventsEnum",
    "ErrorHandlingAction",
    "ExecutionState",
    "LogLevel",
    "OperationMode",
    "SafetyState",
    "ServoMotionState",
    "TaskStateEnum",
    "UserKeyAlignment",
    "UserKeyEvent",
    "UserKeyLED",
    "UserKeyLEDSize",
];

impl EnumConstant {
    /// Returns a constant by its class and name.
    pub(crate) fn named(class: &str, name: &str) -> Option<Self> {
        let add_body = |ordinal: usize| Self {
            class: Rc::from(class),
            name: Rc::from(name),
            ordinal: i32::try_from(ordinal).unwrap_or(i32::MAX),
        };
        if let Some((_, names)) = LISTED.iter().find(|(listed, _)| *listed == class) {
            return names.iter().position(|listed| *listed == name).map(add_body);
        }
        OTHERS.contains(&class).then(|| add_body(0))
    }

    /// Returns all constants of a listed enum, in order.
    pub(crate) fn all(class: &str) -> Option<Vec<Self>> {
        let (_, names) = LISTED.iter().find(|(listed, _)| *listed == class)?;
        Some(names.iter().filter_map(|name| Self::named(class, name)).collect())
    }

    /// Converts an amount of a time unit to seconds; units below a second divide, so that 700 ms
    /// are exactly 0.7 s.
    pub(crate) fn seconds(&self, amount: f64) -> Option<f64> {
        if &*self.class != "TimeUnit" {
            return None;
        }
        Some(match &*self.name {
            "NANOSECONDS" => amount / 1e9,
            "MICROSECONDS" => amount / 1e6,
            "MILLISECONDS" => amount / 1e3,
            "SECONDS" => amount,
            "MINUTES" => amount * 60.0,
            "HOURS" => amount * 3600.0,
            "DAYS" => amount * 86400.0,
            _ => return None,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn constants_are_known_by_class_and_name() {
        let joint = EnumConstant::named("JointEnum", "J4").map(|joint| joint.ordinal);
        assert_eq!(joint, Some(3));
        assert_eq!(EnumConstant::named("JointEnum", "J8"), None);
        assert_eq!(EnumConstant::named("Camera", "RED"), None);
        assert_eq!(EnumConstant::all("CoordinateAxis").map(|axes| axes.len()), Some(3));
    }

    #[test]
    fn milliseconds_are_divided() {
        let unit = EnumConstant::named("TimeUnit", "MILLISECONDS");
        assert_eq!(unit.and_then(|unit| unit.seconds(700.0)), Some(0.7));
        assert_eq!(EnumConstant::named("CartDOF", "X").and_then(|axis| axis.seconds(1.0)), None);
    }
}
