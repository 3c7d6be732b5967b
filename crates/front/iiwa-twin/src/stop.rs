//! Stop requests: a separate thread and connection to the drive.
//!
//! A stop waits for no other request, however many connections and threads they use. Stops that are
//! requested while one is pending are sent to the drive as one.

use std::{
    iter,
    sync::{Arc, Weak, mpsc},
    thread,
};

use iiwa_link::{Client, ClientError};
use tokio::sync::oneshot;

use crate::Setup;

/// Result of a stop: success, or the reason for failure.
type StopResult = Result<(), String>;

/// Sends stop requests to the drive. Its thread ends when the stopper is dropped.
#[derive(Debug)]
pub(crate) struct Stopper(mpsc::Sender<oneshot::Sender<StopResult>>);

impl Stopper {
    pub(crate) fn new(setup: &Arc<Setup>) -> Self {
        let (sender, asked) = mpsc::channel();
        // A strong reference would keep the temporary folder alive after the end of the twin.
        let explain = setup.wording.request;
        let setup = Arc::downgrade(setup);
        thread::spawn(move || serve_stops(&setup, explain, &asked));
        Self(sender)
    }

    /// Requests a stop at once, and resolves to the answer of the drive.
    pub(crate) fn stop(&self) -> impl Future<Output = StopResult> + use<> {
        let (answer, answered) = oneshot::channel();
        let asked = self.0.send(answer);
        async move {
            let closed = || "the twin is shutting down".to_owned();
            asked.map_err(|_| closed())?;
            answered.await.unwrap_or_else(|_| Err(closed()))
        }
    }
}

fn serve_stops(
    setup: &Weak<Setup>,
    explain: fn(&ClientError) -> String,
    asked: &mpsc::Receiver<oneshot::Sender<StopResult>>,
) {
    let connect = || {
        let setup = setup.upgrade().ok_or_else(|| "the twin is shutting down".to_owned())?;
        setup.client().map_err(|error| setup.words(&error))
    };
    // Connected from the start, so that a stop needs no new connection.
    let mut client = connect();
    while let Ok(first) = asked.recv() {
        // Includes stops requested while the last one was pending, which may have been too early
        // for them.
        let waiting: Vec<_> = iter::once(first).chain(asked.try_iter()).collect();
        if client.is_err() {
            client = connect();
        }
        let taken = match &mut client {
            Ok(client) => Client::stop(client).map_err(|error| explain(&error)),
            Err(why) => Err(why.clone()),
        };
        for answer in waiting {
            // The page may have been closed.
            let _ = answer.send(taken.clone());
        }
    }
}
