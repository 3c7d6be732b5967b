//! A spool that wakes its reader and warns of overflow.

use std::{
    io,
    path::Path,
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicU64, Ordering},
    },
};

use tokio::sync::Notify;

use crate::{
    BridgeError,
    spool::{self, Level, Spool, SpoolReader},
    trouble::Trouble,
};

/// A spool that feeds write to and one task reads.
#[derive(Debug)]
pub(crate) struct SpoolTarget {
    spool: Spool,
    appended: Notify,
    /// Number of dropped records at the last warning.
    dropped: AtomicU64,
    /// Number of records that the broker has refused.
    refused: AtomicU64,
    trouble: Mutex<Trouble>,
}

impl SpoolTarget {
    /// Opens the spool in a folder, and its reader.
    pub(crate) fn open(
        folder: &Path,
        max_bytes: u64,
    ) -> Result<(Arc<Self>, SpoolReader), BridgeError> {
        let (spool, reader) = spool::open(folder, max_bytes).map_err(|source| {
            let folder = folder.to_owned();
            match source.kind() {
                io::ErrorKind::WouldBlock => BridgeError::SpoolInUse { folder },
                _ => BridgeError::Spool { folder, source },
            }
        })?;
        let target = Self {
            spool,
            appended: Notify::new(),
            dropped: AtomicU64::new(0),
            refused: AtomicU64::new(0),
            trouble: Mutex::default(),
        };
        Ok((Arc::new(target), reader))
    }

    /// Appends an event, which must survive the process.
    pub(crate) fn append_now(&self, record: &[u8]) {
        let appended = self.spool.append(record).and_then(|()| self.spool.flush());
        self.report(appended);
    }

    /// Appends a record.
    #[cfg(feature = "kafka")]
    pub(crate) fn append(&self, record: &[u8]) {
        let appended = self.spool.append(record);
        self.report(appended);
    }

    /// Wakes the reader, and logs failures.
    fn report(&self, appended: io::Result<()>) {
        self.appended.notify_one();
        let dropped = self.spool.level().dropped;
        if dropped > self.dropped.swap(dropped, Ordering::Relaxed) {
            let mut trouble = self.trouble.lock().unwrap_or_else(PoisonError::into_inner);
            match appended {
                Ok(()) => trouble.warn(format_args!(
                    "the spool is full: {dropped} of the oldest messages were dropped so far; give \
                     it more room, or bring the broker back"
                )),
                Err(error) => trouble.warn(format_args!(
                    "cannot write to the spool: {error}; {dropped} messages were dropped so far"
                )),
            }
        }
    }

    /// Waits for a record to be appended.
    pub(crate) async fn appended(&self) {
        self.appended.notified().await;
    }

    pub(crate) fn spool(&self) -> &Spool {
        &self.spool
    }

    /// Counts records that the broker has refused.
    pub(crate) fn refused(&self, count: u64) {
        self.refused.fetch_add(count, Ordering::Relaxed);
    }

    /// Returns the number of bytes on disk, and of lost records.
    pub(crate) fn level(&self) -> Level {
        let level = self.spool.level();
        Level { dropped: level.dropped + self.refused.load(Ordering::Relaxed), ..level }
    }
}
