//! Replies with what a run has measured are written by a thread of their own: they may be long, and
//! whoever asked for one may be slow to read it.

use std::{
    collections::VecDeque,
    sync::{
        Arc,
        mpsc::{Receiver, RecvTimeoutError},
    },
    time::Duration,
};

use bytes::Bytes;
use iiwa_link::message::{Body, Id, MAX_REPLY_BYTES, Refusal, Reply, Run};
use tokio::sync::{OwnedSemaphorePermit, Semaphore};

/// What is kept of a run.
pub(super) struct Measured {
    body: Body,
    error: Option<Refusal>,
    samples: usize,
}

impl Measured {
    pub(super) fn new(run: Run, error: Option<Refusal>) -> Self {
        Self { samples: run.samples.t_s.len(), body: Body::Run(run), error }
    }

    /// Memory that a reply takes, in pieces.
    fn pieces(&self) -> u32 {
        let pieces = (self.samples * SAMPLE_BYTES).div_ceil(PIECE).clamp(1, PIECES);
        u32::try_from(pieces).unwrap_or(u32::MAX)
    }
}

/// What is to be answered. `C` tells clients apart.
pub(super) struct Answer<C> {
    pub(super) client: C,
    pub(super) id: Option<Id>,
    pub(super) measured: Arc<Measured>,
}

impl<C> Answer<C> {
    /// The reply as JSON.
    pub(super) fn write(&self) -> String {
        let Self { id, measured, .. } = self;
        let Measured { body, error, .. } = &**measured;
        Reply { id: id.as_ref(), error: error.as_ref(), body: Some(body) }.to_json()
    }
}

/// What a sample takes in a reply, in bytes: eight numbers of up to 20 digits.
const SAMPLE_BYTES: usize = 8 * 21;

/// Memory is counted in pieces of so many bytes.
const PIECE: usize = 64 << 10;
const PIECES: usize = MAX_REPLY_BYTES / PIECE;

/// How often it is seen whether there is room again.
const LOOK: Duration = Duration::from_millis(5);

/// Writes answers, and sends each with what is to be kept until it has left. All that are on their way
/// take no more memory together than the longest one.
pub(super) fn answer<C>(
    asked: &Receiver<Answer<C>>,
    send: impl Fn(C, Bytes, OwnedSemaphorePermit),
) {
    let room = Arc::new(Semaphore::new(PIECES));
    let mut waiting = VecDeque::new();
    loop {
        let next = if waiting.is_empty() {
            asked.recv().map_err(|_| RecvTimeoutError::Disconnected)
        } else {
            asked.recv_timeout(LOOK)
        };
        match next {
            Ok(answer) => waiting.push_back(answer),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return,
        }
        // A long one does not hold up those behind it.
        for answer in std::mem::take(&mut waiting) {
            match room.clone().try_acquire_many_owned(answer.measured.pieces()) {
                Err(_) => waiting.push_back(answer),
                Ok(permit) => {
                    let text = answer.write();
                    send(answer.client, text.into(), permit);
                }
            }
        }
    }
}
