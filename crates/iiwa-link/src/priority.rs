//! Threads that have to be on time.

use thread_priority::{
    RealtimeThreadSchedulePolicy, ThreadPriority, ThreadPriorityValue, ThreadSchedulePolicy,
    set_thread_priority_and_policy, thread_native_id,
};

/// Lets this thread run ahead of others, where the system permits it; else it stays an ordinary one, and
/// this is false.
pub(crate) fn raise() -> bool {
    // Above ordinary threads, below what keeps a machine alive.
    const PRIORITY: u8 = 40;
    let Ok(value) = ThreadPriorityValue::try_from(PRIORITY) else { return false };
    let policy = ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo);
    let priority = ThreadPriority::Crossplatform(value);
    match set_thread_priority_and_policy(thread_native_id(), priority, policy) {
        Ok(()) => true,
        Err(error) => {
            tracing::debug!("this thread keeps its ordinary priority: {error}");
            false
        }
    }
}
