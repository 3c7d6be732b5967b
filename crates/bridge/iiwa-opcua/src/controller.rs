//! Controller with its software, and the task control with the running program.

use opcua::types::{
    Argument, DataTypeId, DataValue, EnumValueType, ExtensionObject, LocalizedText, NodeId,
    ReferenceTypeId, VariableTypeId, Variant, VariantScalarTypeId,
};

use crate::{
    arm::{MANUFACTURER, identify},
    state::RobotState,
    task_state::TaskState,
    tree::{Of, Tree},
};

// Node numbers of OPC 40010-1 and OPC 10000-100.
const CONTROLLER_TYPE: u32 = 1003;
const USER_TYPE: u32 = 18175;
const TASK_CONTROL_TYPE: u32 = 1011;
const TASK_CONTROL_OPERATION_TYPE: u32 = 1008;
const TASK_CONTROL_STATE_MACHINE_TYPE: u32 = 1025;
const REASONS: u32 = 6098;
const CONTROLS: u32 = 4002;
const HAS_SAFETY_STATES: u32 = 18182;
const SOFTWARE_TYPE: u32 = 15106;

/// The only stop mode: on the path, to standstill.
pub(crate) const STOP_ON_PATH: i64 = 0;

/// Variable nodes of the controller.
pub(crate) struct ControllerNodes {
    system_software: NodeId,
    robot_program: NodeId,
    program: NodeId,
    loaded: NodeId,
    state: NodeId,
    state_id: NodeId,
    transition: NodeId,
    transition_id: NodeId,
    /// Node of the stop method, if permitted.
    pub(crate) stop: Option<NodeId>,
}

impl ControllerNodes {
    /// Inserts the controller of a system with this motion device and this safety state. With
    /// `commands`, clients can request stops.
    pub(crate) fn insert(
        tree: &mut Tree<'_>,
        folder: &NodeId,
        arm: &NodeId,
        safety: &NodeId,
        commands: bool,
    ) -> Self {
        let id = tree.object(folder, Of::Instances, "Controller", tree.robotics(CONTROLLER_TYPE));
        identify(tree, &id, "KUKA Sunrise Cabinet");
        let user = tree.object(&id, Of::Robotics, "CurrentUser", tree.robotics(USER_TYPE));
        tree.property(&user, Of::Robotics, "Level", DataTypeId::String, "");
        tree.refer(&id, CONTROLS, arm);
        tree.refer(&id, HAS_SAFETY_STATES, safety);

        let software = tree.folder(&id, "Software");
        let system_software =
            insert_software(tree, &software, "SystemSoftware", (MANUFACTURER, "Sunrise.OS"));
        let robot_program =
            insert_software(tree, &software, "RobotProgram", ("iiwasim", "Robot program"));

        let tasks = tree.folder(&id, "TaskControls");
        let task = tree.object(&tasks, Of::Instances, "Task", tree.robotics(TASK_CONTROL_TYPE));
        let name = LocalizedText::from("Task");
        tree.property(&task, Of::Devices, "ComponentName", DataTypeId::LocalizedText, name);
        tree.refer(&task, CONTROLS, arm);
        let parameters = tree.parameters(&task);
        let program = tree.data(&parameters, "TaskProgramName", DataTypeId::String, Variant::Empty);
        let loaded =
            tree.data(&parameters, "TaskProgramLoaded", DataTypeId::Boolean, Variant::Empty);

        let machine = insert_state_machine(tree, &task, arm);
        let (state, state_id) =
            insert_finite(tree, &machine, "CurrentState", VariableTypeId::FiniteStateVariableType);
        let (transition, transition_id) = insert_finite(
            tree,
            &machine,
            "LastTransition",
            VariableTypeId::FiniteTransitionVariableType,
        );
        let stop = commands.then(|| insert_stop(tree, &machine));
        Self {
            system_software,
            robot_program,
            program,
            loaded,
            state,
            state_id,
            transition,
            transition_id,
            stop,
        }
    }

    /// Appends the values of a state; `last` is the previous state of the task.
    pub(crate) fn values(
        &self,
        state: &RobotState,
        last: &mut TaskHistory,
        robotics: u16,
        values: &mut Vec<(NodeId, DataValue)>,
    ) {
        let mut push = |node: &NodeId, value: DataValue| values.push((node.clone(), value));
        push(&self.system_software, state.value(state.system_software.clone()));
        push(&self.robot_program, state.value(state.robot_program.clone()));
        let task = TaskState::of(state);
        let executes = task == TaskState::Executing;
        // The name is empty for a run without a name and before the first run, and unknown before
        // the first drive state.
        let name = state.program.clone().or_else(|| state.drive.map(|_| String::new()));
        push(&self.program, state.value(name));
        push(&self.loaded, state.value(state.drive.map(|_| executes)));

        let good = opcua::types::StatusCode::Good;
        let id = |number: u32| NodeId::new(robotics, number);
        let (name, number) = task.named();
        push(&self.state, state.value_with(Some(LocalizedText::from(name)), good));
        push(&self.state_id, state.value_with(Some(id(number)), good));
        if let Some((name, number)) = last.go_on(task) {
            push(&self.transition, state.value_with(Some(LocalizedText::from(name)), good));
            push(&self.transition_id, state.value_with(Some(id(number)), good));
        }
    }
}

/// The task state that was published last.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct TaskHistory {
    state: TaskState,
}

impl TaskHistory {
    fn go_on(&mut self, state: TaskState) -> Option<(&'static str, u32)> {
        let before = std::mem::replace(&mut self.state, state);
        state.reached_from(before)
    }
}

/// Inserts a software item of the controller; returns the node of its version.
fn insert_software(
    tree: &mut Tree<'_>,
    folder: &NodeId,
    name: &str,
    (manufacturer, model): (&str, &str),
) -> NodeId {
    let software = tree.object(folder, Of::Instances, name, tree.devices(SOFTWARE_TYPE));
    for (name, value) in [("Manufacturer", manufacturer), ("Model", model)] {
        let value = LocalizedText::from(value);
        tree.property(&software, Of::Devices, name, DataTypeId::LocalizedText, value);
    }
    let string = DataTypeId::String;
    tree.property(&software, Of::Devices, "SoftwareRevision", string, Variant::Empty)
}

/// Inserts the state machine of a task control.
fn insert_state_machine(tree: &mut Tree<'_>, task: &NodeId, arm: &NodeId) -> NodeId {
    let operation = tree.linked_object(
        task,
        ReferenceTypeId::HasAddIn,
        Of::Robotics,
        "TaskControlOperation",
        tree.robotics(TASK_CONTROL_OPERATION_TYPE),
    );
    let arms = Variant::from(vec![arm.clone()]);
    tree.property(&operation, Of::Robotics, "MotionDevicesUnderControl", DataTypeId::NodeId, arms);
    let machine = tree.object(
        &operation,
        Of::Robotics,
        "TaskControlStateMachine",
        tree.robotics(TASK_CONTROL_STATE_MACHINE_TYPE),
    );
    // The reason of a transition is unknown.
    let reason = tree.variable(
        &machine,
        (Of::Robotics, "LastTransitionReason"),
        VariableTypeId::MultiStateValueDiscreteType,
        DataTypeId::Int16,
        0_i16,
    );
    let reasons = tree.value_of(&tree.robotics(REASONS));
    tree.property(&reason, Of::Base, "EnumValues", DataTypeId::EnumValueType, reasons);
    let text = LocalizedText::from("Unknown");
    tree.property(&reason, Of::Base, "ValueAsText", DataTypeId::LocalizedText, text);
    machine
}

/// Inserts a state or transition: its text, and the id of the corresponding type node.
fn insert_finite(
    tree: &mut Tree<'_>,
    machine: &NodeId,
    name: &str,
    type_id: VariableTypeId,
) -> (NodeId, NodeId) {
    let text = DataTypeId::LocalizedText;
    let variable = tree.variable(machine, (Of::Base, name), type_id, text, Variant::Empty);
    let id = tree.property(&variable, Of::Base, "Id", DataTypeId::NodeId, Variant::Empty);
    (variable, id)
}

/// Inserts the stop method and the available stop modes.
fn insert_stop(tree: &mut Tree<'_>, machine: &NodeId) -> NodeId {
    let modes = [EnumValueType {
        value: STOP_ON_PATH,
        display_name: "OnPath".into(),
        description: "The arm comes to rest on its path; the rest of the program is dropped".into(),
    }];
    let modes = modes.map(|mode| Variant::from(ExtensionObject::from_message(mode)));
    let modes = Variant::from((VariantScalarTypeId::ExtensionObject, modes.to_vec()));
    tree.data(machine, "PossibleStopModes", DataTypeId::EnumValueType, modes);
    let argument = |name: &str, data_type: DataTypeId, description: &str| Argument {
        name: name.into(),
        data_type: data_type.into(),
        value_rank: -1,
        array_dimensions: None,
        description: description.into(),
    };
    let mode = argument("StopMode", DataTypeId::Int64, "One of PossibleStopModes");
    let status = argument("Status", DataTypeId::Int32, "0: the arm is at rest");
    tree.method(machine, "Stop", mode, status)
}
