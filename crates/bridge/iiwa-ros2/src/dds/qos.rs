//! Quality-of-service profiles, like those of standard ROS nodes.

use ros2_client::{
    QosProfile,
    action::ActionServerQosPolicies,
    qos::{Durability, History, WhenFull},
};

/// Returns a reliable profile that does not wait for slow readers: publishers have the next sample
/// soon, and servers have other clients.
fn reliable(depth: usize) -> QosProfile {
    QosProfile::subscription_default()
        .reliability_reliable(WhenFull::Fail)
        .history(History::KeepLast { depth })
}

/// Returns the profile of `joint_states`, the default of `joint_state_broadcaster`.
pub(super) fn states() -> QosProfile {
    reliable(10)
}

/// Returns the profile of `/tf`, like that of tf2's broadcasters.
pub(super) fn transforms() -> QosProfile {
    reliable(100)
}

/// Returns the profile of topics that are published once, for late subscribers.
pub(super) fn latched() -> QosProfile {
    reliable(1).durability(Durability::TransientLocal)
}

/// Returns the profile of services.
pub(super) fn service() -> QosProfile {
    reliable(10)
}

/// Returns the profiles of an action server, as in `rcl_action`.
pub(super) fn action() -> ActionServerQosPolicies {
    ActionServerQosPolicies {
        goal_service: service(),
        result_service: service(),
        cancel_service: service(),
        feedback_publisher: reliable(10),
        status_publisher: latched(),
    }
}
