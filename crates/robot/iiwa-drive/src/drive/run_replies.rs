//! Replies with run measurements, in a separate thread: replies may be long, and clients may read
//! them slowly.

use std::{
    collections::VecDeque,
    sync::{
        Arc,
        mpsc::{Receiver, RecvTimeoutError},
    },
    time::Duration,
};

use bytes::Bytes;
use iiwa_link::message::{Id, MAX_REPLY_BYTES, Refusal, Reply, ReplyBody, Run};
use tokio::sync::{OwnedSemaphorePermit, Semaphore};

/// The stored measurements of a run.
pub(super) struct RunRecord {
    body: ReplyBody,
    error: Option<Refusal>,
    samples: usize,
}

impl RunRecord {
    pub(super) fn new(run: Run, error: Option<Refusal>) -> Self {
        Self { samples: run.samples.t_s.len(), body: ReplyBody::Run(run), error }
    }

    /// Returns the memory of a reply, in units of [`UNIT_BYTES`].
    fn units(&self) -> u32 {
        // More than `UNITS` could never be acquired.
        let units = (self.samples * SAMPLE_BYTES).div_ceil(UNIT_BYTES).clamp(1, UNITS);
        u32::try_from(units).unwrap_or(u32::MAX)
    }
}

/// A reply to be written. `C` identifies clients.
pub(super) struct RunReply<C> {
    pub(super) client: C,
    pub(super) id: Option<Id>,
    pub(super) record: Arc<RunRecord>,
}

impl<C> RunReply<C> {
    /// Returns the reply as JSON.
    pub(super) fn to_json(&self) -> String {
        let Self { id, record, .. } = self;
        let RunRecord { body, error, .. } = &**record;
        Reply { id: id.as_ref(), error: error.as_ref(), body: Some(body) }.to_json()
    }
}

/// Size of a sample in a reply, in bytes: eight numbers of up to 20 digits.
const SAMPLE_BYTES: usize = 8 * 21;

/// Unit of memory accounting.
const UNIT_BYTES: usize = 64 << 10;
const UNITS: usize = MAX_REPLY_BYTES / UNIT_BYTES;

/// Poll interval for the quota.
const POLL_INTERVAL: Duration = Duration::from_millis(5);

/// Writes replies and sends each with a permit that is held until the reply is sent. All replies in
/// transit together use at most the memory of the longest possible reply.
pub(super) fn write_replies<C>(
    queue: &Receiver<RunReply<C>>,
    send: impl Fn(C, Bytes, OwnedSemaphorePermit),
) {
    let quota = Arc::new(Semaphore::new(UNITS));
    let mut backlog = VecDeque::new();
    loop {
        let next = if backlog.is_empty() {
            queue.recv().map_err(|_| RecvTimeoutError::Disconnected)
        } else {
            queue.recv_timeout(POLL_INTERVAL)
        };
        match next {
            Ok(reply) => backlog.push_back(reply),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return,
        }
        // A long reply does not delay later ones.
        for reply in std::mem::take(&mut backlog) {
            match quota.clone().try_acquire_many_owned(reply.record.units()) {
                Err(_) => backlog.push_back(reply),
                Ok(permit) => {
                    let text = reply.to_json();
                    send(reply.client, text.into(), permit);
                }
            }
        }
    }
}
