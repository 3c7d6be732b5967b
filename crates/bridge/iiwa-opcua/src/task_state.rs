//! State of a task control (OPC 40010-1, `TaskControlStateMachineType`), and its last transition.

use iiwa_link::message::DriveState;

use crate::state::RobotState;

/// State of the task control.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum TaskState {
    /// Not ready: the robot is disconnected, its program is not connected, or a safety stop is
    /// active.
    #[default]
    Idle,
    /// Ready to run a program immediately.
    Ready,
    /// A program is running.
    Executing,
}

/// A node of the specification: name and number.
pub(crate) type NamedNode = (&'static str, u32);

impl TaskState {
    /// Returns the state of a robot.
    pub(crate) fn of(state: &RobotState) -> Self {
        match state.drive {
            Some(DriveState::RunningMotion | DriveState::RunningTrajectory) if state.connected => {
                Self::Executing
            }
            Some(DriveState::Idle)
                if state.connected && state.ready && state.safety_stop != Some(true) =>
            {
                Self::Ready
            }
            _ => Self::Idle,
        }
    }

    /// Returns the state in the specification.
    pub(crate) fn named(self) -> NamedNode {
        match self {
            Self::Idle => ("Idle", 5040),
            Self::Ready => ("Ready", 5041),
            Self::Executing => ("Executing", 5042),
        }
    }

    /// Returns the last transition on the way from a state to this one; `None` if the state has not
    /// changed.
    pub(crate) fn reached_from(self, before: Self) -> Option<NamedNode> {
        match (before, self) {
            (Self::Idle, Self::Ready) => Some(("IdleToReady", 5044)),
            (Self::Ready, Self::Idle) => Some(("ReadyToIdle", 5045)),
            // From Idle, a run that begins immediately has been ready between two updates.
            (Self::Idle | Self::Ready, Self::Executing) => Some(("ReadyToExecuting", 5046)),
            (Self::Executing, Self::Ready) => Some(("ExecutingToReady", 5047)),
            (Self::Executing, Self::Idle) => Some(("ExecutingToIdle", 5048)),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn robots_are_ready_if_a_program_would_run() {
        let ready = RobotState {
            connected: true,
            ready: true,
            drive: Some(DriveState::Idle),
            safety_stop: Some(false),
            ..RobotState::default()
        };
        assert_eq!(TaskState::of(&ready), TaskState::Ready);
        let stopped = RobotState { safety_stop: Some(true), ..ready.clone() };
        assert_eq!(TaskState::of(&stopped), TaskState::Idle);
        let alone = RobotState { ready: false, ..ready.clone() };
        assert_eq!(TaskState::of(&alone), TaskState::Idle);
        let unknown = RobotState { safety_stop: None, ..ready.clone() };
        assert_eq!(TaskState::of(&unknown), TaskState::Ready);
        for drive in [DriveState::RunningMotion, DriveState::RunningTrajectory] {
            let running = RobotState { drive: Some(drive), ..ready.clone() };
            assert_eq!(TaskState::of(&running), TaskState::Executing);
            let lost = RobotState { connected: false, ..running };
            assert_eq!(TaskState::of(&lost), TaskState::Idle);
        }
    }

    #[test]
    fn transitions_are_those_of_the_specification() {
        let states = [TaskState::Idle, TaskState::Ready, TaskState::Executing];
        for before in states {
            for after in states {
                match after.reached_from(before) {
                    None => assert_eq!(before, after),
                    Some((name, _)) => assert!(name.ends_with(after.named().0), "{name}"),
                }
            }
        }
    }
}
