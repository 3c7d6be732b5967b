//! State that all connections share.

use std::{sync::Arc, time::Duration};

use tokio::{
    sync::{Semaphore, watch},
    time,
};

use crate::output;

use super::{Dispatcher, Setup, message::PageMessage};

/// Requests of all pages that are carried out at one time, at most. Each has its own connection to the drive.
const MAX_REQUESTS: usize = 8;

/// What pages receive, and what carries out their requests.
#[derive(Clone)]
pub(crate) struct Shared {
    pub(super) setup: Arc<Setup>,
    pub(super) live: watch::Receiver<PageMessage>,
    pub(super) health: watch::Receiver<PageMessage>,
    pub(super) dispatcher: Arc<Dispatcher>,
    /// Permits of requests.
    pub(super) requests: Arc<Semaphore>,
    /// Permit of work that takes much memory: planning, and making a report.
    pub(super) heavy: Arc<Semaphore>,
}

impl Shared {
    /// With the channels of joint positions and of health.
    pub(crate) fn new(
        setup: Arc<Setup>,
        [live, health]: [watch::Receiver<PageMessage>; 2],
        dispatcher: Arc<Dispatcher>,
    ) -> Self {
        let permits = |count| Arc::new(Semaphore::new(count));
        Self { setup, live, health, dispatcher, requests: permits(MAX_REQUESTS), heavy: permits(1) }
    }
}

/// Returns on an interrupt.
pub(super) async fn interrupted() {
    while !output::interrupted() {
        time::sleep(Duration::from_millis(50)).await;
    }
}
