//! Values of KUKA's API as text.

use iiwa_java::HostValue;

use crate::application::{robot_value::RobotValue, spot::Spot, station::Station};

impl Station {
    pub(crate) fn path_in_parent(&self, spot: Spot) -> String {
        match spot {
            Spot::World => "/".to_owned(),
            Spot::Flange => "/Flange".to_owned(),
            Spot::Tree(index) => {
                self.tree.get(index).map(|frame| frame.path.clone()).unwrap_or_default()
            }
            Spot::Root(index) => {
                self.bodies.get(index).map(|body| body.name.clone()).unwrap_or_default()
            }
            Spot::Of(index, frame) => {
                let body = self.bodies.get(index);
                let frame = body.and_then(|body| body.frames.get(frame));
                frame.map(|frame| frame.path.clone()).unwrap_or_default()
            }
        }
    }

    /// Formats a value for string concatenation.
    pub(crate) fn robot_text(&self, value: &RobotValue) -> String {
        match value {
            RobotValue::Constant(constant) => constant.name.to_string(),
            RobotValue::Joints(joints) => format!("{:?}", joints.borrow().joints_rad),
            RobotValue::Spot(spot) => self.path_in_parent(*spot),
            other => other.class().to_owned(),
        }
    }
}
