//! Life cycle of a twin.

use std::{
    net::TcpListener,
    sync::{Arc, Mutex},
    thread,
};

use iiwa_files::interrupt;
use iiwa_foxglove::Viewers;

use crate::{
    Setup, TwinError,
    dispatcher::TwinDispatcher,
    follow::{LatestJoints, follow},
    guard::PageToken,
    health::watch_health,
    message::PageChannel,
    server::serve,
    shared::SharedTwin,
};

/// Page of a robot, and its server.
pub struct Twin {
    setup: Arc<Setup>,
    live: Arc<LatestJoints>,
    dispatcher: Arc<TwinDispatcher>,
    token: PageToken,
}

impl Twin {
    /// Creates a twin with the saved positions, and a unique token.
    ///
    /// # Errors
    ///
    /// [`TwinError`] if the file of saved positions is invalid or belongs to another robot, or the
    /// system provides no random numbers.
    pub fn new(setup: Setup) -> Result<Self, TwinError> {
        let token = PageToken::new()?;
        let setup = Arc::new(setup);
        let live = Arc::new(LatestJoints::default());
        let dispatcher = Arc::new(TwinDispatcher::new(setup.clone(), live.clone())?);
        Ok(Self { setup, live, dispatcher, token })
    }

    /// Token that the address of the page must end with, as in `/?token=...`.
    #[must_use]
    pub fn token(&self) -> &str {
        self.token.text()
    }

    /// Follows the robot, serves its page, and publishes it to `viewers`, until an interrupt
    /// ([`mod@iiwa_files::interrupt`]). A run started from the page is then stopped.
    ///
    /// # Errors
    ///
    /// [`TwinError`] if the page cannot be served, or the joint positions cannot be published to
    /// viewers.
    pub fn run(self, listener: TcpListener, viewers: Option<Viewers>) -> Result<(), TwinError> {
        let Self { setup, live, dispatcher, token } = self;
        let words = || PageChannel::new("{}".into());
        let (live_words, health_words) = (words(), words());
        let words = [live_words.subscribe(), health_words.subscribe()];
        let shared = SharedTwin::new(setup.clone(), words, dispatcher.clone());
        let viewers = viewers.map(Mutex::new);
        thread::scope(|scope| {
            scope.spawn(|| watch_health(&setup, &health_words, viewers.as_ref()));
            let following = scope.spawn(|| {
                // Without joint positions there is nothing to show.
                follow(&setup, &live, &live_words, viewers.as_ref())
                    .inspect_err(|_| interrupt::request())
            });
            let served = serve(listener, &token, shared);
            interrupt::request();
            dispatcher.end();
            following.join().unwrap_or(Ok(())).and(served)
        })
    }
}
