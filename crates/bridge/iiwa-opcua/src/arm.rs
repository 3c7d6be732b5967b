//! Motion device with seven axes, their power trains, and the flange load.

use iiwa_kin::{Joints, Robot};
use opcua::types::{DataTypeId, DataValue, ExtensionObject, LocalizedText, NodeId, Range, Variant};

use crate::{
    load::LoadNodes,
    state::RobotState,
    tree::{Of, Tree},
    units::{
        DEGREE_CELSIUS, EngineeringUnit, RADIAN, RADIAN_PER_SECOND, RADIAN_PER_SECOND_SQUARED,
    },
};

// Node numbers of OPC 40010-1.
const MOTION_DEVICE_TYPE: u32 = 1004;
const AXIS_TYPE: u32 = 16601;
const POWER_TRAIN_TYPE: u32 = 16794;
const MOTOR_TYPE: u32 = 1019;
const MOTION_DEVICE_CATEGORY: u32 = 18193;
const ARTICULATED_ROBOT: i32 = 1;
const AXIS_MOTION_PROFILE: u32 = 3008;
const ROTARY: i32 = 1;
const MOVES: u32 = 18178;

/// Manufacturer of the robot and its controller.
pub(crate) const MANUFACTURER: &str = "KUKA";

/// Variable nodes of the motion device.
pub(crate) struct ArmNodes {
    pub(crate) id: NodeId,
    speed_override: NodeId,
    axes: [AxisNodes; 7],
    motor_temperatures: [NodeId; 7],
    load: LoadNodes,
}

struct AxisNodes {
    position: NodeId,
    speed: NodeId,
    acceleration: NodeId,
}

impl ArmNodes {
    /// Inserts a motion device into the devices of a system.
    pub(crate) fn insert(tree: &mut Tree<'_>, devices: &NodeId, robot: &Robot) -> Self {
        let id = tree.object(devices, Of::Instances, "Arm", tree.robotics(MOTION_DEVICE_TYPE));
        identify(tree, &id, model(robot.name()));
        let category = tree.robotics(MOTION_DEVICE_CATEGORY);
        tree.property(&id, Of::Robotics, "MotionDeviceCategory", category, ARTICULATED_ROBOT);
        let parameters = tree.parameters(&id);
        let speed_override =
            tree.data(&parameters, "SpeedOverride", DataTypeId::Double, Variant::Empty);
        let load = LoadNodes::insert(tree, &id);

        let axes_folder = tree.folder(&id, "Axes");
        let trains_folder = tree.folder(&id, "PowerTrains");
        let parts: [(AxisNodes, NodeId); 7] = std::array::from_fn(|joint| {
            let (axis, nodes) = AxisNodes::insert(tree, &axes_folder, robot, joint);
            let (train, temperature) = insert_power_train(tree, &trains_folder, joint);
            // The reverse reference is omitted: browsers that follow references would loop.
            tree.refer(&train, MOVES, &axis);
            (nodes, temperature)
        });
        let motor_temperatures = std::array::from_fn(|joint| parts[joint].1.clone());
        Self { id, speed_override, axes: parts.map(|(axis, _)| axis), motor_temperatures, load }
    }

    /// Appends the values of a state.
    pub(crate) fn values(&self, state: &RobotState, values: &mut Vec<(NodeId, DataValue)>) {
        let percent = state.override_rel.map(|share| share * 100.0);
        values.push((self.speed_override.clone(), state.value(percent)));
        let derivatives = state.derivatives();
        let positions = state.positions();
        let moving =
            |joints: Option<Joints>, joint: usize| state.moving_value(joints.map(|it| it[joint]));
        for (joint, axis) in self.axes.iter().enumerate() {
            let speed = derivatives.map(|it| it.speed);
            let acceleration = derivatives.map(|it| it.acceleration);
            values.push((axis.position.clone(), moving(positions, joint)));
            values.push((axis.speed.clone(), moving(speed, joint)));
            values.push((axis.acceleration.clone(), moving(acceleration, joint)));
        }
        for (joint, motor) in self.motor_temperatures.iter().enumerate() {
            let temperature = state.temperatures.map(|it| it[joint]);
            values.push((motor.clone(), state.value(temperature)));
        }
        self.load.values(state, values);
    }
}

impl AxisNodes {
    fn insert(tree: &mut Tree<'_>, folder: &NodeId, robot: &Robot, joint: usize) -> (NodeId, Self) {
        let name = format!("A{}", joint + 1);
        let id = tree.object(folder, Of::Instances, &name, tree.robotics(AXIS_TYPE));
        let profile = tree.robotics(AXIS_MOTION_PROFILE);
        tree.property(&id, Of::Robotics, "MotionProfile", profile, ROTARY);
        let parameters = tree.parameters(&id);
        let limits = robot.limits();
        let [velocity, acceleration] =
            [limits.velocity_rad_s, limits.acceleration_rad_s2].map(|limit| limit[joint]);
        let mut measured = |name: &str, unit: EngineeringUnit, low: f64, high: f64| {
            let id = tree.measurement(&parameters, name, unit);
            let range = ExtensionObject::from_message(Range { low, high });
            tree.property(&id, Of::Base, "EURange", DataTypeId::Range, range);
            id
        };
        let (lower, upper) = (limits.lower_rad[joint], limits.upper_rad[joint]);
        let position = measured("ActualPosition", RADIAN, lower, upper);
        let speed = measured("ActualSpeed", RADIAN_PER_SECOND, -velocity, velocity);
        let unit = RADIAN_PER_SECOND_SQUARED;
        let acceleration = measured("ActualAcceleration", unit, -acceleration, acceleration);
        (id, Self { position, speed, acceleration })
    }
}

/// Inserts motor and power train of an axis; returns the power train, and the node of the motor
/// temperature.
fn insert_power_train(tree: &mut Tree<'_>, folder: &NodeId, joint: usize) -> (NodeId, NodeId) {
    let name = format!("A{}", joint + 1);
    let train = tree.object(folder, Of::Instances, &name, tree.robotics(POWER_TRAIN_TYPE));
    let motor = tree.object(&train, Of::Instances, "Motor", tree.robotics(MOTOR_TYPE));
    identify(tree, &motor, "");
    let parameters = tree.parameters(&motor);
    (train, tree.measurement(&parameters, "MotorTemperature", DEGREE_CELSIUS))
}

/// Inserts the identification of a device. Codes and serial numbers are left empty, because they
/// are not published.
pub(crate) fn identify(tree: &mut Tree<'_>, device: &NodeId, model: &str) {
    let mut text = |name: &str, value: &str| {
        let value = LocalizedText::from(value);
        tree.property(device, Of::Devices, name, DataTypeId::LocalizedText, value);
    };
    text("Manufacturer", MANUFACTURER);
    text("Model", model);
    for name in ["ProductCode", "SerialNumber"] {
        tree.property(device, Of::Devices, name, DataTypeId::String, "");
    }
}

/// Returns KUKA's name of a model.
fn model(name: &str) -> &str {
    match name {
        "lbr_iiwa_7_r800" => "LBR iiwa 7 R800",
        "lbr_iiwa_14_r820" => "LBR iiwa 14 R820",
        other => other,
    }
}
