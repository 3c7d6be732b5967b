//! The way of a stop to the drive: a thread and a connection that serve nothing else.
//!
//! However many other orders are under way, and however many connections and threads they take, a stop
//! waits for none of them. Stops that come in while one is on its way are asked for together.

use std::{
    iter,
    sync::{Arc, Weak, mpsc},
    thread,
};

use iiwa_link::Client;
use tokio::sync::oneshot;

use super::Setup;

/// Whether the drive has taken the stop, or why not.
type Taken = Result<(), String>;

/// Asks the drive to stop the robot. Its thread ends when it is dropped.
#[derive(Debug)]
pub(super) struct Stopper(mpsc::Sender<oneshot::Sender<Taken>>);

impl Stopper {
    pub(super) fn new(setup: &Arc<Setup>) -> Self {
        let (ask, asked) = mpsc::channel();
        // It must not keep the twin's folder when the twin ends.
        let setup = Arc::downgrade(setup);
        thread::spawn(move || attend(&setup, &asked));
        Self(ask)
    }

    /// Asks for a stop; the answer comes when the drive has given it.
    pub(super) fn stop(&self) -> impl Future<Output = Taken> + use<> {
        let (answer, answered) = oneshot::channel();
        let asked = self.0.send(answer);
        async move {
            let gone = || "the twin ends".to_owned();
            asked.map_err(|_| gone())?;
            answered.await.unwrap_or_else(|_| Err(gone()))
        }
    }
}

fn attend(setup: &Weak<Setup>, asked: &mpsc::Receiver<oneshot::Sender<Taken>>) {
    let connect = || {
        let setup = setup.upgrade().ok_or_else(|| "the twin ends".to_owned())?;
        setup.client().map_err(|failure| failure.what())
    };
    // Connected before anything can stand in the way.
    let mut client = connect();
    while let Ok(first) = asked.recv() {
        // Those that came in while the one before was on its way; it may have come too early for them.
        let waiting: Vec<_> = iter::once(first).chain(asked.try_iter()).collect();
        if client.is_err() {
            client = connect();
        }
        let taken = match &mut client {
            Ok(client) => {
                Client::stop(client).map_err(|error| crate::connection::explained(&error))
            }
            Err(why) => Err(why.clone()),
        };
        for answer in waiting {
            // The page may have been closed.
            let _ = answer.send(taken.clone());
        }
    }
}
