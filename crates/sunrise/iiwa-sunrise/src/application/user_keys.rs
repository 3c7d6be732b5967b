//! smartPAD keys that an application defines.

use iiwa_java::Value;

use crate::application::{
    robot_value::{RobotValue, robot},
    robotics::Robotics,
};

impl Robotics<'_> {
    /// Calls a method of the user interface other than a dialog.
    pub(crate) fn call_user_interface(&mut self, name: &str) -> Value {
        match name {
            "createUserKeyBar" => robot(RobotValue::opaque("IUserKeyBar")),
            _ => self.not_known(&format!("IApplicationUI.{name}")),
        }
    }

    /// Calls a method of a key bar: it creates keys, whose listeners wait for the operator.
    pub(crate) fn call_user_key_bar(&mut self, name: &str) -> Value {
        match name {
            "addUserKey" | "addDoubleUserKey" => {
                self.note(
                    "a key of the smartPAD is defined: its action when it is pressed is not \
                    evaluated",
                );
                robot(RobotValue::opaque("IUserKey"))
            }
            "publish" => Value::Null,
            _ => self.not_known(&format!("IUserKeyBar.{name}")),
        }
    }

    /// Calls a method of a key.
    pub(crate) fn call_user_key(&mut self, name: &str) -> Value {
        if name.starts_with("set") || name == "publish" {
            return Value::Null;
        }
        self.not_known(&format!("IUserKey.{name}"))
    }
}
