//! Qualities of service, as ROS nodes of these kinds have them.

use ros2_client::{
    QosProfile,
    action::ActionServerQosPolicies,
    qos::{Durability, History, WhenFull},
};

/// Nothing waits for a reader that is too slow: publishers have the next sample soon, and servers other clients.
fn reliable(depth: usize) -> QosProfile {
    QosProfile::subscription_default()
        .reliability_reliable(WhenFull::Fail)
        .history(History::KeepLast { depth })
}

/// Of `joint_states`: what `joint_state_broadcaster` has by default.
pub(super) fn states() -> QosProfile {
    reliable(10)
}

/// Of `/tf`: what tf2's broadcasters have.
pub(super) fn transforms() -> QosProfile {
    reliable(100)
}

/// Of what is published once, for readers that come later.
pub(super) fn latched() -> QosProfile {
    reliable(1).durability(Durability::TransientLocal)
}

/// Of services.
pub(super) fn service() -> QosProfile {
    reliable(10)
}

/// Of an action's server, as `rcl_action` has it.
pub(super) fn action() -> ActionServerQosPolicies {
    ActionServerQosPolicies {
        goal_service: service(),
        result_service: service(),
        cancel_service: service(),
        feedback_publisher: reliable(10),
        status_publisher: latched(),
    }
}
