//! Insertion of instances into the address space: each node below its parent, named by its path.

use opcua::{
    nodes::{AccessLevel, MethodBuilder, ObjectBuilder, ReferenceDirection, VariableBuilder},
    server::address_space::AddressSpace,
    types::{
        Argument, DataTypeId, ExtensionObject, NodeId, ObjectTypeId, QualifiedName,
        ReferenceTypeId, VariableTypeId, Variant,
    },
};

use crate::units::EngineeringUnit;

/// Namespace indices of the server.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Namespaces {
    pub(crate) devices: u16,
    pub(crate) robotics: u16,
    /// Namespace of the instances.
    pub(crate) instances: u16,
}

/// The specification that defines a browse name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Of {
    /// OPC UA itself.
    Base,
    Devices,
    Robotics,
    /// This server: names of robots, axes and so on.
    Instances,
}

/// The address space during the insertion of instances.
pub(crate) struct Tree<'a> {
    space: &'a mut AddressSpace,
    namespaces: Namespaces,
}

impl<'a> Tree<'a> {
    pub(crate) fn new(space: &'a mut AddressSpace, namespaces: Namespaces) -> Self {
        Self { space, namespaces }
    }

    /// Returns a Robotics node, such as a type, by its number in OPC 40010-1.
    pub(crate) fn robotics(&self, number: u32) -> NodeId {
        NodeId::new(self.namespaces.robotics, number)
    }

    /// Returns a Devices node, by its number in OPC 10000-100.
    pub(crate) fn devices(&self, number: u32) -> NodeId {
        NodeId::new(self.namespaces.devices, number)
    }

    /// Inserts an object as a component of its parent.
    pub(crate) fn object(
        &mut self,
        parent: &NodeId,
        of: Of,
        name: &str,
        type_id: impl Into<NodeId>,
    ) -> NodeId {
        self.linked_object(parent, ReferenceTypeId::HasComponent, of, name, type_id)
    }

    /// Inserts an object with another reference from its parent.
    pub(crate) fn linked_object(
        &mut self,
        parent: &NodeId,
        reference: ReferenceTypeId,
        of: Of,
        name: &str,
        type_id: impl Into<NodeId>,
    ) -> NodeId {
        let id = self.child_id(parent, name);
        ObjectBuilder::new(&id, self.browse_name(of, name), name)
            .reference(parent.clone(), reference, ReferenceDirection::Inverse)
            .has_type_definition(type_id)
            .insert(self.space);
        id
    }

    /// Inserts a folder as a component of its parent.
    pub(crate) fn folder(&mut self, parent: &NodeId, name: &str) -> NodeId {
        self.object(parent, Of::Robotics, name, ObjectTypeId::FolderType)
    }

    /// Inserts the parameter set of a device, which contains its values according to OPC UA for
    /// Devices.
    pub(crate) fn parameters(&mut self, device: &NodeId) -> NodeId {
        self.object(device, Of::Devices, "ParameterSet", ObjectTypeId::BaseObjectType)
    }

    /// Inserts a property.
    pub(crate) fn property(
        &mut self,
        parent: &NodeId,
        of: Of,
        name: &str,
        data_type: impl Into<NodeId>,
        value: impl Into<Variant>,
    ) -> NodeId {
        let id = self.child_id(parent, name);
        let variable = VariableBuilder::new(&id, self.browse_name(of, name), name)
            .property_of(parent.clone())
            .has_type_definition(VariableTypeId::PropertyType);
        self.insert(variable, data_type, value);
        id
    }

    /// Inserts a variable of the given type as a component of its parent.
    pub(crate) fn variable(
        &mut self,
        parent: &NodeId,
        (of, name): (Of, &str),
        type_id: impl Into<NodeId>,
        data_type: impl Into<NodeId>,
        value: impl Into<Variant>,
    ) -> NodeId {
        let id = self.child_id(parent, name);
        let variable = VariableBuilder::new(&id, self.browse_name(of, name), name)
            .component_of(parent.clone())
            .has_type_definition(type_id);
        self.insert(variable, data_type, value);
        id
    }

    /// Inserts a Robotics variable without further structure.
    pub(crate) fn data(
        &mut self,
        parent: &NodeId,
        name: &str,
        data_type: impl Into<NodeId>,
        value: impl Into<Variant>,
    ) -> NodeId {
        let type_id = VariableTypeId::BaseDataVariableType;
        self.variable(parent, (Of::Robotics, name), type_id, data_type, value)
    }

    /// Inserts a number with its unit, without a value yet.
    pub(crate) fn measurement(
        &mut self,
        parent: &NodeId,
        name: &str,
        unit: EngineeringUnit,
    ) -> NodeId {
        let type_id = VariableTypeId::AnalogUnitType;
        let double = DataTypeId::Double;
        let id = self.variable(parent, (Of::Robotics, name), type_id, double, Variant::Empty);
        self.unit(&id, "EngineeringUnits", unit);
        id
    }

    /// Inserts a unit as a property of a variable.
    pub(crate) fn unit(&mut self, of: &NodeId, name: &str, unit: EngineeringUnit) {
        let value = ExtensionObject::from_message(unit.information());
        self.property(of, Of::Base, name, DataTypeId::EUInformation, value);
    }

    /// Inserts a method; the node manager implements its call.
    pub(crate) fn method(
        &mut self,
        parent: &NodeId,
        name: &str,
        input: Argument,
        output: Argument,
    ) -> NodeId {
        let id = self.child_id(parent, name);
        let [inputs, outputs] =
            ["InputArguments", "OutputArguments"].map(|name| self.child_id(&id, name));
        MethodBuilder::new(&id, self.browse_name(Of::Robotics, name), name)
            .component_of(parent.clone())
            .executable(true)
            .user_executable(true)
            .input_args(self.space, &inputs, &[input])
            .output_args(self.space, &outputs, &[output])
            .insert(self.space);
        id
    }

    /// Inserts a Robotics reference, by the number of its type in OPC 40010-1.
    pub(crate) fn refer(&mut self, from: &NodeId, reference: u32, to: &NodeId) {
        let reference = self.robotics(reference);
        self.space.insert_reference(from, to, reference);
    }

    /// Returns the value of an imported variable.
    pub(crate) fn value_of(&self, variable: &NodeId) -> Variant {
        let node = self.space.find(variable);
        let value = node.and_then(|node| {
            node.as_node().get_attribute(
                opcua::types::TimestampsToReturn::Neither,
                opcua::types::AttributeId::Value,
                &opcua::types::NumericRange::None,
                &opcua::types::DataEncoding::Binary,
            )
        });
        value.and_then(|value| value.value).unwrap_or(Variant::Empty)
    }

    fn insert(
        &mut self,
        variable: VariableBuilder,
        data_type: impl Into<NodeId>,
        value: impl Into<Variant>,
    ) {
        let value = value.into();
        let rank = if value.is_array() { 1 } else { -1 };
        variable
            .value(value)
            .data_type(data_type)
            .value_rank(rank)
            .access_level(AccessLevel::CURRENT_READ)
            .user_access_level(AccessLevel::CURRENT_READ)
            .insert(self.space);
    }

    /// Returns the id of an instance, which is its path: stable over restarts, and readable.
    fn child_id(&self, parent: &NodeId, name: &str) -> NodeId {
        let path = match &parent.identifier {
            opcua::types::Identifier::String(path)
                if parent.namespace == self.namespaces.instances =>
            {
                format!("{path}/{name}")
            }
            _ => name.to_owned(),
        };
        NodeId::new(self.namespaces.instances, path)
    }

    fn browse_name(&self, of: Of, name: &str) -> QualifiedName {
        let namespace = match of {
            Of::Base => 0,
            Of::Devices => self.namespaces.devices,
            Of::Robotics => self.namespaces.robotics,
            Of::Instances => self.namespaces.instances,
        };
        QualifiedName::new(namespace, name)
    }
}
