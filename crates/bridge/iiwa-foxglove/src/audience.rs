//! Subscriptions of viewers, and messages that have not been sent to them yet.

use std::{
    collections::{BTreeMap, VecDeque},
    sync::{Arc, Mutex, MutexGuard, PoisonError},
    time::{SystemTime, UNIX_EPOCH},
};

use axum::extract::ws::Message;
use tokio::sync::{Notify, watch};

use super::protocol::{
    Channel, ServerMessage, StatusLevel, Subscription, ViewerMessage, message_data,
};

/// Maximum number of messages queued for a slow viewer, less than two seconds and a megabyte;
/// beyond this, the oldest are dropped.
const BACKLOG: usize = 512;

/// Channels and their viewers.
#[derive(Debug)]
pub(super) struct Audience {
    pub(super) channels: Vec<Channel>,
    state: Mutex<AudienceState>,
    /// `true` once the server ends.
    ended: watch::Sender<bool>,
}

#[derive(Debug, Default)]
struct AudienceState {
    /// Viewers by number.
    viewers: BTreeMap<u64, Viewer>,
    /// Number of the next viewer.
    next: u64,
    /// Last message of each latched channel.
    last: BTreeMap<u64, Vec<u8>>,
}

#[derive(Debug)]
struct Viewer {
    /// Subscription ids by channel.
    subscriptions: BTreeMap<u64, u32>,
    queue: VecDeque<Message>,
    /// Notified when the queue has messages.
    wake: Arc<Notify>,
}

impl Viewer {
    fn queue(&mut self, message: Message) {
        if self.queue.len() >= BACKLOG {
            self.queue.pop_front();
        }
        self.queue.push_back(message);
        self.wake.notify_one();
    }

    fn status(&mut self, level: StatusLevel, message: &str) {
        self.queue(Message::text(ServerMessage::Status { level, message }.text()));
    }
}

impl Audience {
    pub(super) fn new(channels: Vec<Channel>) -> Self {
        Self { channels, state: Mutex::default(), ended: watch::Sender::new(false) }
    }

    fn state(&self) -> MutexGuard<'_, AudienceState> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Adds a viewer; returns its number, and the notification for its queue.
    pub(super) fn add(&self) -> (u64, Arc<Notify>) {
        let mut state = self.state();
        let number = state.next;
        state.next += 1;
        let wake = Arc::new(Notify::new());
        let viewer =
            Viewer { subscriptions: BTreeMap::new(), queue: VecDeque::new(), wake: wake.clone() };
        state.viewers.insert(number, viewer);
        (number, wake)
    }

    pub(super) fn remove(&self, number: u64) {
        self.state().viewers.remove(&number);
    }

    pub(super) fn is_empty(&self) -> bool {
        self.state().viewers.is_empty()
    }

    /// Returns the next message for a viewer.
    pub(super) fn next_for(&self, number: u64) -> Option<Message> {
        self.state().viewers.get_mut(&number)?.queue.pop_front()
    }

    /// Returns true if any viewer has subscribed to a channel.
    pub(super) fn has_viewers(&self, channel: u64) -> bool {
        self.state().viewers.values().any(|viewer| viewer.subscriptions.contains_key(&channel))
    }

    /// Sends a message to the viewers of a channel. The time is since 1970.
    pub(super) fn publish(&self, channel: u64, time_ns: u64, data: &[u8]) {
        Self::send(&mut self.state(), channel, time_ns, data);
    }

    /// Sends a message to the viewers of a channel, including later subscribers.
    pub(super) fn latch(&self, channel: u64, time_ns: u64, data: Vec<u8>) {
        // Under one lock, so that a viewer never receives an older message after a newer one.
        let mut state = self.state();
        Self::send(&mut state, channel, time_ns, &data);
        state.last.insert(channel, data);
    }

    fn send(state: &mut AudienceState, channel: u64, time_ns: u64, data: &[u8]) {
        for viewer in state.viewers.values_mut() {
            if let Some(subscription) = viewer.subscriptions.get(&channel) {
                let message = message_data(*subscription, time_ns, data);
                viewer.queue(Message::binary(message));
            }
        }
    }

    /// Handles a viewer request, or replies with the reason for a refusal.
    pub(super) fn receive(&self, number: u64, text: &str) {
        let mut state = self.state();
        let AudienceState { viewers, last, .. } = &mut *state;
        let Some(viewer) = viewers.get_mut(&number) else { return };
        match serde_json::from_str(text) {
            Ok(ViewerMessage::Subscribe { subscriptions }) => {
                for subscription in subscriptions {
                    self.subscribe(viewer, last, subscription);
                }
            }
            Ok(ViewerMessage::Unsubscribe { subscription_ids }) => {
                viewer.subscriptions.retain(|_, id| !subscription_ids.contains(id));
            }
            Ok(ViewerMessage::Other) => {
                viewer.status(
                    StatusLevel::Error,
                    "this server does not support that: viewers only read",
                );
            }
            Err(error) => viewer.status(StatusLevel::Error, &format!("invalid message: {error}")),
        }
    }

    fn subscribe(
        &self,
        viewer: &mut Viewer,
        last: &BTreeMap<u64, Vec<u8>>,
        Subscription { id, channel_id }: Subscription,
    ) {
        if !self.channels.iter().any(|channel| channel.id == channel_id) {
            viewer.status(StatusLevel::Error, &format!("unknown channel {channel_id}"));
        } else if viewer.subscriptions.contains_key(&channel_id) {
            viewer.status(
                StatusLevel::Warning,
                &format!("already subscribed to channel {channel_id}"),
            );
        } else if viewer.subscriptions.values().any(|other| *other == id) {
            viewer.status(StatusLevel::Error, &format!("subscription {id} is in use"));
        } else {
            viewer.subscriptions.insert(channel_id, id);
            if let Some(data) = last.get(&channel_id) {
                // The latched message is still valid.
                viewer.queue(Message::binary(message_data(id, now_ns(), data)));
            }
        }
    }

    /// Disconnects all viewers.
    pub(super) fn end(&self) {
        self.ended.send_replace(true);
    }

    /// Waits until the server ends.
    pub(super) async fn ended(&self) {
        // The sender lives as long as `self`.
        let _ = self.ended.subscribe().wait_for(|ended| *ended).await;
    }
}

/// Returns the current time since 1970, in ns.
fn now_ns() -> u64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    u64::try_from(since.as_nanos()).unwrap_or(u64::MAX)
}
