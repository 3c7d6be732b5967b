//! Subscriber process.

use std::{
    sync::{Arc, Mutex, PoisonError},
    thread,
    time::{Duration, Instant},
};

use iiwa_link::{Published, Remote, Stream};
use iiwasim_benches::Result;
use serde::{Deserialize, Serialize};

use super::part::serve;

/// Received messages of a subscriber, and missed messages between the first and the last one.
#[derive(Clone, Copy, Default, Deserialize, Serialize)]
pub(crate) struct Followed {
    pub(crate) messages: u64,
    pub(crate) missed: u64,
    pub(crate) last_s: Option<f64>,
}

impl Followed {
    /// Counts a message of the 1 ms stream.
    fn take(&mut self, t_s: f64) {
        if let Some(last_s) = self.last_s {
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "saturates"
            )]
            let steps = ((t_s - last_s) * 1e3).round() as u64;
            self.missed += steps.saturating_sub(1);
        }
        self.messages += 1;
        self.last_s = Some(t_s);
    }
}

/// Messages of all subscribers.
#[derive(Deserialize, Serialize)]
pub(crate) struct Subscribers {
    pub(crate) live: [Followed; LIVE],
    pub(crate) asleep: Followed,
}

/// Number of subscribers that read.
const LIVE: usize = 9;

/// Subscribes until the input ends.
pub(crate) fn be_subscribers(address: &str) -> Result<()> {
    let sleeper = Sleeper::new(address)?;
    let live = Arc::new(Mutex::new([Followed::default(); LIVE]));
    let remote = Remote::open();
    for i in 0..LIVE {
        let mut stream = Stream::new(&remote, address)?;
        let live = Arc::clone(&live);
        thread::spawn(move || {
            while let Ok(published) = stream.next(Duration::from_secs(1)) {
                if let Some(Published::Joints { t_s, .. }) = published {
                    live.lock().unwrap_or_else(PoisonError::into_inner)[i].take(t_s);
                }
            }
        });
    }
    // Connections need a moment.
    thread::sleep(Duration::from_millis(500));
    serve(|| {
        let asleep = sleeper.wake();
        Subscribers { live: *live.lock().unwrap_or_else(PoisonError::into_inner), asleep }
    })
}

/// Subscriber that reads nothing until it is woken.
struct Sleeper {
    socket: zmq::Socket,
}

impl Sleeper {
    fn new(address: &str) -> Result<Self> {
        let socket = zmq::Context::new().socket(zmq::SUB)?;
        // The smallest buffers, so that the subscriber stores next to nothing.
        socket.set_rcvhwm(1)?;
        socket.set_rcvbuf(4096)?;
        socket.set_subscribe(b"joints")?;
        socket.connect(address)?;
        Ok(Self { socket })
    }

    /// Receives for a second: the queued messages, and those published now.
    fn wake(&self) -> Followed {
        #[derive(Deserialize)]
        struct Stamp {
            t_s: f64,
        }
        let mut followed = Followed::default();
        let since = Instant::now();
        while since.elapsed() < Duration::from_secs(1) {
            if matches!(self.socket.poll(zmq::POLLIN, 100), Ok(1..))
                && let Ok(frames) = self.socket.recv_multipart(zmq::DONTWAIT)
                && let Some(Ok(Stamp { t_s })) =
                    frames.get(1).map(|body| serde_json::from_slice(body))
            {
                followed.take(t_s);
            }
        }
        followed
    }
}
