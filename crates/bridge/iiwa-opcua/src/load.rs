//! Flange load.

use iiwa_kin::Load;
use opcua::types::{
    DataTypeId, DataValue, ExtensionObject, NodeId, ThreeDCartesianCoordinates, ThreeDFrame,
    ThreeDOrientation, ThreeDVector, VariableTypeId, Variant,
};

use crate::{
    state::RobotState,
    tree::{Of, Tree},
    units::{KILOGRAM, METRE, RADIAN},
};

const LOAD_TYPE: u32 = 1018;

/// Nodes of a load.
pub(crate) struct LoadNodes {
    mass: NodeId,
    frame: NodeId,
    position: NodeId,
    coordinates: [NodeId; 3],
    orientation: NodeId,
    angles: [NodeId; 3],
    inertia: NodeId,
    moments: [NodeId; 3],
}

impl LoadNodes {
    /// Inserts the load of a motion device.
    pub(crate) fn insert(tree: &mut Tree<'_>, device: &NodeId) -> Self {
        let load = tree.object(device, Of::Robotics, "FlangeLoad", tree.robotics(LOAD_TYPE));
        let mass = tree.measurement(&load, "Mass", KILOGRAM);
        let frame = structure(tree, &load, (Of::Robotics, "CenterOfMass"), FRAME);
        let position = structure(tree, &frame, (Of::Base, "CartesianCoordinates"), COORDINATES);
        tree.unit(&position, "LengthUnit", METRE);
        let coordinates = numbers(tree, &position, ["X", "Y", "Z"]);
        let orientation = structure(tree, &frame, (Of::Base, "Orientation"), ORIENTATION);
        tree.unit(&orientation, "AngleUnit", RADIAN);
        let angles = numbers(tree, &orientation, ["A", "B", "C"]);
        let inertia = structure(tree, &load, (Of::Robotics, "Inertia"), VECTOR);
        let moments = numbers(tree, &inertia, ["X", "Y", "Z"]);
        Self { mass, frame, position, coordinates, orientation, angles, inertia, moments }
    }

    /// Appends the values of a state.
    pub(crate) fn values(&self, state: &RobotState, values: &mut Vec<(NodeId, DataValue)>) {
        let parts = state.load.as_ref().map(LoadParts::of);
        let mut push = |node: &NodeId, value: Option<Variant>| {
            values.push((node.clone(), state.value(value)));
        };
        push(&self.mass, state.load.map(|load| load.mass_kg.into()));
        push(&self.frame, parts.map(|it| extension(it.frame())));
        push(&self.position, parts.map(|it| extension(it.position())));
        push(&self.orientation, parts.map(|it| extension(it.orientation())));
        push(&self.inertia, parts.map(|it| extension(it.inertia())));
        for axis in 0..3 {
            push(&self.coordinates[axis], parts.map(|it| it.center_m[axis].into()));
            push(&self.angles[axis], parts.map(|it| it.angles_rad[axis].into()));
            push(&self.moments[axis], parts.map(|it| it.inertia_kg_m2[axis].into()));
        }
    }
}

/// A load in the representation of OPC UA.
#[derive(Clone, Copy)]
struct LoadParts {
    center_m: [f64; 3],
    /// Angles about x, y and z: roll, pitch and yaw.
    angles_rad: [f64; 3],
    inertia_kg_m2: [f64; 3],
}

impl LoadParts {
    fn of(load: &Load) -> Self {
        // KUKA's a, b, c are angles about z, y and x.
        let [a, b, c] = load.abc_rad;
        Self {
            center_m: load.center_mm.map(|mm| mm / 1e3),
            angles_rad: [c, b, a],
            inertia_kg_m2: load.inertia_kg_m2,
        }
    }

    fn position(self) -> ThreeDCartesianCoordinates {
        let [x, y, z] = self.center_m;
        ThreeDCartesianCoordinates { x, y, z }
    }

    fn orientation(self) -> ThreeDOrientation {
        let [a, b, c] = self.angles_rad;
        ThreeDOrientation { a, b, c }
    }

    fn frame(self) -> ThreeDFrame {
        ThreeDFrame { cartesian_coordinates: self.position(), orientation: self.orientation() }
    }

    fn inertia(self) -> ThreeDVector {
        let [x, y, z] = self.inertia_kg_m2;
        ThreeDVector { x, y, z }
    }
}

/// Type of a structure: variable type and data type.
type Structure = (VariableTypeId, DataTypeId);

const FRAME: Structure = (VariableTypeId::ThreeDFrameType, DataTypeId::ThreeDFrame);
const COORDINATES: Structure =
    (VariableTypeId::ThreeDCartesianCoordinatesType, DataTypeId::ThreeDCartesianCoordinates);
const ORIENTATION: Structure =
    (VariableTypeId::ThreeDOrientationType, DataTypeId::ThreeDOrientation);
const VECTOR: Structure = (VariableTypeId::ThreeDVectorType, DataTypeId::ThreeDVector);

fn structure(
    tree: &mut Tree<'_>,
    parent: &NodeId,
    name: (Of, &str),
    (type_id, data_type): Structure,
) -> NodeId {
    tree.variable(parent, name, type_id, data_type, Variant::Empty)
}

fn numbers(tree: &mut Tree<'_>, parent: &NodeId, names: [&str; 3]) -> [NodeId; 3] {
    let type_id = VariableTypeId::BaseDataVariableType;
    names.map(|name| {
        tree.variable(parent, (Of::Base, name), type_id, DataTypeId::Double, Variant::Empty)
    })
}

fn extension<T: opcua::types::DynEncodable>(value: T) -> Variant {
    ExtensionObject::from_message(value).into()
}
