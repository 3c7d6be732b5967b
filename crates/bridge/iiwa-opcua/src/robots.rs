//! Robots in the address space, and client access: reading, and stopping a robot if permitted.

use std::{collections::HashMap, sync::Arc};

use async_trait::async_trait;
use iiwa_kin::Robot;
use opcua::{
    server::{
        address_space::AddressSpace,
        diagnostics::NamespaceMetadata,
        node_manager::{
            MethodCall, RequestContext, ServerContext, WriteNode,
            memory::{InMemoryNodeManager, InMemoryNodeManagerImpl},
        },
    },
    sync::RwLock,
    types::{DataTypeId, DataValue, LocalizedText, NodeId, StatusCode, Variant},
};

use crate::{
    arm::ArmNodes,
    controller::{ControllerNodes, STOP_ON_PATH, TaskHistory},
    nodesets::{DEVICES, NodeSet, ROBOTICS},
    safety::SafetyNodes,
    state::RobotState,
    stop::{StopFailure, StopRobot},
    tree::{Namespaces, Of, Tree},
};

const DEVICE_SET: u32 = 5001;
const MOTION_DEVICE_SYSTEM_TYPE: u32 = 1002;

/// Namespace of the instances.
pub(crate) const INSTANCES: &str = "urn:iiwasim:robots";

/// A robot to be inserted into the address space.
pub(crate) struct RobotPlan {
    pub(crate) name: String,
    pub(crate) model: Robot,
    /// Stop callback; `None` if clients may not stop the robot.
    pub(crate) stop: Option<Arc<dyn StopRobot>>,
}

/// Node manager of all nodes outside of the base namespace.
pub(crate) type RobotsManager = InMemoryNodeManager<Robots>;

/// Robots of the server.
pub(crate) struct Robots {
    namespaces: Vec<NamespaceMetadata>,
    robotics: u16,
    systems: Vec<SystemNodes>,
    stops: HashMap<NodeId, Arc<dyn StopRobot>>,
}

/// Variable nodes of a robot.
struct SystemNodes {
    arm: ArmNodes,
    safety: SafetyNodes,
    controller: ControllerNodes,
}

impl Robots {
    /// Imports the types, and inserts the robots.
    pub(crate) fn insert(
        robots: Vec<RobotPlan>,
        node_sets: Vec<NodeSet>,
        context: &ServerContext,
        space: &mut AddressSpace,
    ) -> Self {
        let mut types = context.type_tree.write();
        let indices = types.namespaces_mut();
        for set in node_sets {
            space.import_node_set(&set, indices);
        }
        let instances = indices.add_namespace(INSTANCES);
        space.add_namespace(INSTANCES, instances);
        let namespaces = space.namespaces().iter().map(|(index, uri)| NamespaceMetadata {
            namespace_uri: uri.clone(),
            namespace_index: *index,
            ..NamespaceMetadata::default()
        });
        let namespaces = namespaces.collect();
        let [devices, robotics] =
            [DEVICES, ROBOTICS].map(|uri| indices.get_index(uri).unwrap_or_default());
        let mut tree = Tree::new(space, Namespaces { devices, robotics, instances });
        let mut stops = HashMap::new();
        let systems = robots.into_iter().map(|robot| {
            let nodes = SystemNodes::insert(&mut tree, &robot);
            if let (Some(method), Some(stop)) = (&nodes.controller.stop, robot.stop) {
                stops.insert(method.clone(), stop);
            }
            nodes
        });
        let systems = systems.collect();
        Self { namespaces, robotics, systems, stops }
    }

    /// Returns the values of a robot's state.
    pub(crate) fn values(
        &self,
        robot: usize,
        state: &RobotState,
        history: &mut TaskHistory,
    ) -> Vec<(NodeId, DataValue)> {
        let mut values = Vec::with_capacity(64);
        if let Some(SystemNodes { arm, safety, controller }) = self.systems.get(robot) {
            arm.values(state, &mut values);
            safety.values(state, &mut values);
            controller.values(state, history, self.robotics, &mut values);
        }
        values
    }
}

impl SystemNodes {
    fn insert(tree: &mut Tree<'_>, robot: &RobotPlan) -> Self {
        let set = tree.devices(DEVICE_SET);
        let type_id = tree.robotics(MOTION_DEVICE_SYSTEM_TYPE);
        let system = tree.object(&set, Of::Instances, &robot.name, type_id);
        let name = LocalizedText::from(robot.name.as_str());
        tree.property(&system, Of::Devices, "ComponentName", DataTypeId::LocalizedText, name);
        let devices = tree.folder(&system, "MotionDevices");
        let controllers = tree.folder(&system, "Controllers");
        let safety_states = tree.folder(&system, "SafetyStates");
        let arm = ArmNodes::insert(tree, &devices, &robot.model);
        let safety = SafetyNodes::insert(tree, &safety_states);
        let commands = robot.stop.is_some();
        let controller = ControllerNodes::insert(tree, &controllers, &arm.id, &safety.id, commands);
        Self { arm, safety, controller }
    }
}

#[expect(clippy::mut_mut, reason = "the signature that the trait has")]
#[async_trait]
impl InMemoryNodeManagerImpl for Robots {
    async fn init(&self, _: &mut AddressSpace, _: ServerContext) {}

    fn name(&self) -> &'static str {
        "robots"
    }

    fn namespaces(&self) -> Vec<NamespaceMetadata> {
        self.namespaces.clone()
    }

    // The types contain writable variables, none of which is supported here.
    async fn write(
        &self,
        _: &RequestContext,
        _: &RwLock<AddressSpace>,
        nodes: &mut [&mut WriteNode],
    ) -> Result<(), StatusCode> {
        for node in nodes {
            node.set_status(StatusCode::BadNotWritable);
        }
        Ok(())
    }

    async fn call(
        &self,
        _: &RequestContext,
        _: &RwLock<AddressSpace>,
        calls: &mut [&mut &mut MethodCall],
    ) -> Result<(), StatusCode> {
        for call in calls {
            match self.stops.get(call.method_id()) {
                Some(stop) if call.arguments() == [Variant::Int64(STOP_ON_PATH)] => {
                    match stop_robot(stop).await {
                        Ok(()) => {
                            call.set_outputs(vec![Variant::Int32(0)]);
                            call.set_status(StatusCode::Good);
                        }
                        Err(status) => call.set_status(status),
                    }
                }
                Some(_) => call.set_argument_error(vec![StatusCode::BadOutOfRange]),
                // Methods of types, which do not belong to a robot.
                None => call.set_status(StatusCode::BadMethodInvalid),
            }
        }
        Ok(())
    }
}

/// Stops a robot in a separate thread, because the drive client blocks until the reply.
async fn stop_robot(stop: &Arc<dyn StopRobot>) -> Result<(), StatusCode> {
    let stop = Arc::clone(stop);
    match tokio::task::spawn_blocking(move || stop.stop()).await {
        Ok(Ok(())) => Ok(()),
        Ok(Err(StopFailure::Unreachable)) => Err(StatusCode::BadNoCommunication),
        Ok(Err(StopFailure::Refused)) => Err(StatusCode::BadInvalidState),
        Err(_) => Err(StatusCode::BadInternalError),
    }
}
