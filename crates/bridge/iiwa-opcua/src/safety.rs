//! Safety state: operational mode, emergency stop, protective stop.

use iiwa_link::message::OperationMode;
use opcua::types::{DataTypeId, DataValue, NodeId, StatusCode, Variant};

use crate::{
    state::RobotState,
    tree::{Of, Tree},
};

const SAFETY_STATE_TYPE: u32 = 1013;
const OPERATIONAL_MODE: u32 = 3006;

/// Nodes of the safety state.
pub(crate) struct SafetyNodes {
    pub(crate) id: NodeId,
    mode: NodeId,
    emergency_stop: NodeId,
    protective_stop: NodeId,
}

impl SafetyNodes {
    /// Inserts the safety state of a system.
    pub(crate) fn insert(tree: &mut Tree<'_>, folder: &NodeId) -> Self {
        let type_id = tree.robotics(SAFETY_STATE_TYPE);
        let id = tree.object(folder, Of::Instances, "SafetyState", type_id);
        let parameters = tree.parameters(&id);
        let mode_type = tree.robotics(OPERATIONAL_MODE);
        let mode = tree.data(&parameters, "OperationalMode", mode_type, Variant::Empty);
        let [emergency_stop, protective_stop] = ["EmergencyStop", "ProtectiveStop"]
            .map(|name| tree.data(&parameters, name, DataTypeId::Boolean, Variant::Empty));
        Self { id, mode, emergency_stop, protective_stop }
    }

    /// Appends the values of a state.
    pub(crate) fn values(&self, state: &RobotState, values: &mut Vec<(NodeId, DataValue)>) {
        values.push((self.mode.clone(), state.value(state.mode.as_ref().map(mode))));
        values.push((self.protective_stop.clone(), state.value(state.safety_stop)));
        values.push((self.emergency_stop.clone(), emergency_stop(state)));
    }
}

/// Returns the number of a mode in OPC 40010-1.
fn mode(mode: &OperationMode) -> i32 {
    match mode {
        OperationMode::T1 => 1,
        OperationMode::T2 => 2,
        OperationMode::Aut => 3,
        _ => 0,
    }
}

/// Returns the state of the emergency stop. The controller reports a safety stop without its cause:
/// without a safety stop, the emergency stop is certainly not pressed; with one, it may be.
fn emergency_stop(state: &RobotState) -> DataValue {
    match state.safety_stop {
        Some(true) if state.connected => state.value_with(Some(true), StatusCode::Uncertain),
        stop => state.value(stop),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn modes_are_those_of_the_specification() {
        let modes = [
            OperationMode::T1,
            OperationMode::T2,
            OperationMode::Aut,
            OperationMode::Other("krf".into()),
        ];
        assert_eq!(modes.each_ref().map(mode), [1, 2, 3, 0]);
    }

    #[test]
    fn a_safety_stop_may_be_an_emergency_stop() {
        let of = |connected, safety_stop| {
            let state = RobotState { connected, safety_stop, ..RobotState::default() };
            let value = emergency_stop(&state);
            (value.value, value.status.unwrap())
        };
        assert_eq!(of(true, Some(false)), (Some(false.into()), StatusCode::Good));
        assert_eq!(of(true, Some(true)), (Some(true.into()), StatusCode::Uncertain));
        assert_eq!(of(true, None).1, StatusCode::BadWaitingForInitialData);
        assert_eq!(
            of(false, Some(false)),
            (Some(false.into()), StatusCode::UncertainNoCommunicationLastUsableValue)
        );
    }
}
