//! State that all connections share.

use std::{sync::Arc, time::Duration};

use iiwa_files::interrupt;
use tokio::{
    sync::{Semaphore, watch},
    time,
};

use crate::{Setup, dispatcher::TwinDispatcher, message::PageMessage};

/// Maximum number of concurrent requests of all pages. Each has its own connection to the drive.
const MAX_REQUESTS: usize = 8;

/// Messages to pages, and the dispatcher of their requests.
#[derive(Clone)]
pub(crate) struct SharedTwin {
    pub(crate) setup: Arc<Setup>,
    pub(crate) live: watch::Receiver<PageMessage>,
    pub(crate) health: watch::Receiver<PageMessage>,
    pub(crate) dispatcher: Arc<TwinDispatcher>,
    /// Permits of requests.
    pub(crate) requests: Arc<Semaphore>,
    /// Permit of work that needs much memory: planning, and creating a report.
    pub(crate) heavy: Arc<Semaphore>,
}

impl SharedTwin {
    /// Creates the state with the channels of joint positions and of health.
    pub(crate) fn new(
        setup: Arc<Setup>,
        [live, health]: [watch::Receiver<PageMessage>; 2],
        dispatcher: Arc<TwinDispatcher>,
    ) -> Self {
        let permits = |count| Arc::new(Semaphore::new(count));
        Self { setup, live, health, dispatcher, requests: permits(MAX_REQUESTS), heavy: permits(1) }
    }
}

/// Returns on an interrupt.
pub(crate) async fn interrupted() {
    while !interrupt::has_come() {
        time::sleep(Duration::from_millis(50)).await;
    }
}
