//! What all connections share.

use std::{sync::Arc, time::Duration};

use tokio::{
    sync::{Semaphore, watch},
    time,
};

use crate::output;

use super::{Desk, Setup, Word};

/// Orders that are carried out at one time, of all pages. Each has a connection to the drive of its own.
const ORDERS: usize = 8;

/// What pages receive, and what carries out their orders.
#[derive(Clone)]
pub(crate) struct Shared {
    pub(super) setup: Arc<Setup>,
    pub(super) live: watch::Receiver<Word>,
    pub(super) health: watch::Receiver<Word>,
    pub(super) desk: Arc<Desk>,
    /// Turns of orders.
    pub(super) orders: Arc<Semaphore>,
    /// The turn of what takes much memory: planning, and making a report.
    pub(super) heavy: Arc<Semaphore>,
}

impl Shared {
    /// With the newest words of where the arm is and of how it is.
    pub(crate) fn new(
        setup: Arc<Setup>,
        [live, health]: [watch::Receiver<Word>; 2],
        desk: Arc<Desk>,
    ) -> Self {
        let turns = |count| Arc::new(Semaphore::new(count));
        Self { setup, live, health, desk, orders: turns(ORDERS), heavy: turns(1) }
    }
}

/// Returns once the twin is to end.
pub(super) async fn interrupted() {
    while !output::interrupted() {
        time::sleep(Duration::from_millis(50)).await;
    }
}
