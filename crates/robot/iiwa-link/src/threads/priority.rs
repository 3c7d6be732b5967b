//! Real-time priority of threads.

use thread_priority::{ThreadPriority, ThreadPriorityValue};

/// Gives this thread real-time priority. Returns `false` if the system does not permit this. With
/// the feature `real-time`.
#[must_use]
pub fn raise_priority() -> bool {
    // Above ordinary threads, below critical threads of the system.
    const PRIORITY: u8 = 40;
    ThreadPriorityValue::try_from(PRIORITY).is_ok_and(|value| {
        let priority = ThreadPriority::Crossplatform(value);
        set(priority).inspect_err(|error| tracing::debug!("ordinary priority: {error}")).is_ok()
    })
}

#[cfg(unix)]
fn set(priority: ThreadPriority) -> Result<(), thread_priority::Error> {
    use thread_priority::{
        RealtimeThreadSchedulePolicy, ThreadSchedulePolicy, set_thread_priority_and_policy,
        thread_native_id,
    };
    let policy = ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo);
    set_thread_priority_and_policy(thread_native_id(), priority, policy)
}

#[cfg(not(unix))]
fn set(priority: ThreadPriority) -> Result<(), thread_priority::Error> {
    thread_priority::set_current_thread_priority(priority)
}
