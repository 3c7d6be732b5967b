//! Mobile platforms: KMR omniMove and other devices that carry the robot.

use iiwa_java::{EvaluationStop, Value};

use crate::application::{
    arguments::robot_value,
    robot_value::{RobotValue, robot},
    robotics::Robotics,
};

/// Words in the names of platform classes and devices.
const WORDS: [&str; 5] = ["mobilerobot", "mobileplatform", "omnimove", "kmp", "kmr"];

/// Suffixes of classes that belong to platforms, but are not platforms.
const OTHERS: [&str; 11] = [
    "IOGroup",
    "Motion",
    "Container",
    "State",
    "Listener",
    "Data",
    "Pose",
    "Condition",
    "Task",
    "Application",
    "Exception",
];

/// Returns true if a class name or device name is that of a mobile platform. The names of the robot
/// on a platform are excluded.
pub(crate) fn is_platform(name: &str) -> bool {
    let lower = name.to_ascii_lowercase();
    !lower.contains("lbr")
        && WORDS.iter().any(|word| lower.contains(word))
        && !OTHERS.iter().any(|end| name.ends_with(end))
}

/// Returns true if one of the arguments, a class or a device name, names a mobile platform.
pub(crate) fn name_platform(arguments: &[Value]) -> bool {
    arguments.iter().any(|argument| match argument {
        Value::ForeignClass(name) | Value::Text(name) => is_platform(name),
        _ => false,
    })
}

pub(crate) fn platform() -> Value {
    robot(RobotValue::opaque("MobilePlatform"))
}

impl Robotics<'_> {
    /// Calls a method of a mobile platform.
    pub(crate) fn call_platform(
        &mut self,
        name: &str,
        arguments: &[Value],
    ) -> Result<Value, EvaluationStop> {
        match name {
            "move" | "moveAsync" | "execute" | "executeAsync" | "drive" | "driveTo" => {
                if let Some(RobotValue::Motion(_)) = arguments.first().and_then(robot_value) {
                    return self.reject("a motion of the arm is sent to the mobile platform");
                }
                self.take_given_time("the platform drives")?;
                self.station.driven_at = Some(self.place.clone());
                Ok(robot(RobotValue::opaque("PlatformMotion")))
            }
            // Methods of a platform manager.
            _ if name.starts_with("getMobileRobot") || name.starts_with("getPlatform") => {
                Ok(platform())
            }
            "isReadyToMove" | "isMotionEnabled" => Ok(Value::Boolean(true)),
            "getController" => Ok(robot(RobotValue::opaque("Controller"))),
            _ if ["lock", "unlock", "set", "add", "remove"]
                .iter()
                .any(|prefix| name.starts_with(prefix)) =>
            {
                Ok(Value::Null)
            }
            _ => Ok(self.unknown("the state of the mobile platform")),
        }
    }

    /// Calls a method of a platform motion, which has ended: a drive is planned as if the program
    /// waited for it.
    pub(crate) fn call_platform_motion(&mut self, name: &str) -> Value {
        match name {
            _ if name.starts_with("await") || name.starts_with("wait") => Value::Null,
            "cancel" | "addListener" => Value::Null,
            "isFinished" | "isDone" => Value::Boolean(true),
            "hasError" | "hasFailed" | "isCanceled" => Value::Boolean(false),
            _ => self.unknown("the state of the mobile platform"),
        }
    }

    /// Notes that a world frame is a target after a drive.
    pub(crate) fn note_world_after_drive(&mut self) {
        let Some(place) = self.station.driven_at.take() else { return };
        self.note(format!(
            "the target is a frame of the world, and the platform has driven before ({place}): it \
             is planned as if the frame had moved along with the arm's base"
        ));
    }
}
