//! Threads that have to be on time.

use thread_priority::{
    RealtimeThreadSchedulePolicy, ThreadPriority, ThreadPriorityValue, ThreadSchedulePolicy,
    set_thread_priority_and_policy, thread_native_id,
};

/// Lets this thread run ahead of others, where the system permits it; else it stays an ordinary one.
pub(crate) fn raise() {
    // Above ordinary threads, below what keeps a machine alive.
    const PRIORITY: u8 = 40;
    let Ok(value) = ThreadPriorityValue::try_from(PRIORITY) else { return };
    let policy = ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo);
    let priority = ThreadPriority::Crossplatform(value);
    if let Err(error) = set_thread_priority_and_policy(thread_native_id(), priority, policy) {
        tracing::debug!("this thread keeps its ordinary priority: {error}");
    }
}
