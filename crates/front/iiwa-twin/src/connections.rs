//! Bounds on connections: their number, and the time until they present the token.
//!
//! A connection is unverified until it presents the token. The number of unverified connections is
//! bounded, and the oldest is closed for a new one beyond that: a page can connect, however many
//! idle connections another program opens. A verified connection is never closed for an unverified
//! one. Pages are counted separately from other requests, which cannot exhaust their number.

use std::{
    collections::BTreeMap,
    io::{self, ErrorKind},
    net::SocketAddr,
    sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError},
    time::Duration,
};

use axum::{Extension, Router};
use hyper::server::conn::http1;
use hyper_util::{rt::TokioIo, service::TowerToHyperService};
use tokio::{
    net::{TcpListener, TcpStream},
    sync::{Notify, OwnedSemaphorePermit, Semaphore},
    time,
};

/// Maximum number of unverified connections: a small part of the files that a process may have
/// open.
const MAX_UNVERIFIED: usize = 64;

/// Maximum number of open pages: each holds its last messages until the browser receives them.
const MAX_PAGES: usize = 16;

/// Maximum number of other requests with the token at one time: a browser opens six connections.
const MAX_OTHERS: usize = 8;

/// Time limit for a connection to present the token and, if it is rejected, to receive the answer.
const TIMEOUT: Duration = Duration::from_secs(5);

/// Pause after the system could not accept a connection.
const PAUSE: Duration = Duration::from_millis(20);

/// Maximum size of a request's head, in bytes.
const HEAD_BYTES: usize = 16 << 10;

/// Accepts connections, which `router` answers; never returns. Requests carry the
/// [`PageConnection`] as an extension. Each connection has one request: `router` answers with
/// `Connection: close`.
pub(crate) async fn accept(listener: TcpListener, router: Router) {
    let connections = Arc::new(Connections::new());
    let mut count = 0;
    loop {
        // There is one permit more than connections: the one to be closed holds its own until it
        // is.
        let Ok(permit) = connections.accepted.clone().acquire_owned().await else { return };
        match listener.accept().await {
            Ok((stream, peer)) => {
                count += 1;
                let connection = connections.add(count, peer, permit);
                tokio::spawn(serve(stream, connection, router.clone()));
            }
            // The peer has disconnected already.
            Err(error) if is_gone(&error) => {}
            Err(_) => {
                // The process may have too many open files. The server continues without keeping a
                // core busy.
                connections.close_oldest();
                time::sleep(PAUSE).await;
            }
        }
    }
}

fn is_gone(error: &io::Error) -> bool {
    use ErrorKind::{ConnectionAborted, ConnectionRefused, ConnectionReset};
    matches!(error.kind(), ConnectionAborted | ConnectionRefused | ConnectionReset)
}

/// Answers the request of a connection, unless the connection is closed before.
async fn serve(stream: TcpStream, connection: PageConnection, router: Router) {
    let service = TowerToHyperService::new(router.layer(Extension(connection.clone())));
    let exchange = http1::Builder::new()
        .max_buf_size(HEAD_BYTES)
        .serve_connection(TokioIo::new(stream), service)
        .with_upgrades();
    tokio::select! {
        // A failure concerns the peer only.
        _ = exchange => {}
        () = connection.closed() => {}
    }
}

/// All connections.
#[derive(Debug)]
struct Connections {
    /// Close signals of the unverified connections; sorted by age, oldest first.
    unverified: Mutex<BTreeMap<u64, Arc<Notify>>>,
    pages: Arc<Semaphore>,
    requests: Arc<Semaphore>,
    /// Permits of all connections, of any kind.
    accepted: Arc<Semaphore>,
}

impl Connections {
    fn new() -> Self {
        let permits = |count| Arc::new(Semaphore::new(count));
        Self {
            unverified: Mutex::default(),
            pages: permits(MAX_PAGES),
            requests: permits(MAX_OTHERS),
            accepted: permits(MAX_UNVERIFIED + MAX_PAGES + MAX_OTHERS + 1),
        }
    }

    fn unverified(&self) -> MutexGuard<'_, BTreeMap<u64, Arc<Notify>>> {
        self.unverified.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Adds a connection, for which the oldest unverified one may be closed.
    fn add(
        self: &Arc<Self>,
        number: u64,
        peer: SocketAddr,
        permit: OwnedSemaphorePermit,
    ) -> PageConnection {
        if self.unverified().len() >= MAX_UNVERIFIED {
            self.close_oldest();
        }
        let close = Arc::new(Notify::new());
        self.unverified().insert(number, close.clone());
        let verified = OnceLock::new();
        PageConnection(Arc::new(ConnectionState {
            number,
            peer,
            close,
            verified,
            connections: self.clone(),
            _accepted: permit,
        }))
    }

    /// Closes the oldest unverified connection.
    fn close_oldest(&self) {
        let first = self.unverified().pop_first();
        if let Some((_, close)) = first {
            close.notify_one();
        }
    }
}

/// Connection; it counts until all clones are dropped.
#[derive(Clone, Debug)]
pub(crate) struct PageConnection(Arc<ConnectionState>);

#[derive(Debug)]
struct ConnectionState {
    number: u64,
    peer: SocketAddr,
    close: Arc<Notify>,
    /// Permit of a verified connection.
    verified: OnceLock<OwnedSemaphorePermit>,
    connections: Arc<Connections>,
    _accepted: OwnedSemaphorePermit,
}

/// Error: the maximum number of verified connections of this kind is reached.
#[derive(Debug)]
pub(crate) struct Full {
    pub(crate) max: usize,
}

impl PageConnection {
    pub(crate) fn peer(&self) -> SocketAddr {
        self.0.peer
    }

    /// Marks a connection as verified, once it has presented the token.
    pub(crate) fn verify(&self, is_page: bool) -> Result<(), Full> {
        let ConnectionState { number, verified, connections, .. } = &*self.0;
        let (permits, max) = if is_page {
            (&connections.pages, MAX_PAGES)
        } else {
            (&connections.requests, MAX_OTHERS)
        };
        let permit = permits.clone().try_acquire_owned().map_err(|_| Full { max })?;
        // A connection has one request; a second permit would be released at once.
        let _ = verified.set(permit);
        connections.unverified().remove(number);
        Ok(())
    }

    /// Returns when an unverified connection is to be closed: for a newer one, or after
    /// [`TIMEOUT`].
    async fn closed(&self) {
        tokio::select! {
            () = self.0.close.notified() => {}
            () = time::sleep(TIMEOUT) => {
                if self.0.verified.get().is_some() {
                    // A verified connection has no time limit.
                    std::future::pending::<()>().await;
                }
            }
        }
    }
}

impl Drop for ConnectionState {
    fn drop(&mut self) {
        self.connections.unverified().remove(&self.number);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn connect(connections: &Arc<Connections>, number: u64) -> PageConnection {
        let permit = connections.accepted.clone().try_acquire_owned().unwrap();
        connections.add(number, ([127, 0, 0, 1], 9).into(), permit)
    }

    /// Returns true if a connection is to be closed.
    async fn is_closed(connection: &PageConnection) -> bool {
        time::timeout(Duration::ZERO, connection.0.close.notified()).await.is_ok()
    }

    #[tokio::test]
    async fn the_oldest_unverified_connection_is_closed_for_one_too_many() {
        let connections = Arc::new(Connections::new());
        let page = connect(&connections, 0);
        page.verify(true).unwrap();
        let unverified: Vec<_> =
            (1..=MAX_UNVERIFIED as u64).map(|number| connect(&connections, number)).collect();
        for connection in &unverified {
            assert!(!is_closed(connection).await);
        }
        let newcomer = connect(&connections, 1000);
        assert!(is_closed(&unverified[0]).await && !is_closed(&unverified[1]).await);
        // Still in time.
        newcomer.verify(false).unwrap();
        let next = connect(&connections, 1001);
        assert!(!is_closed(&unverified[1]).await, "there was room");
        // Closed connections no longer count.
        drop(unverified);
        assert_eq!(connections.unverified().len(), 1);
        assert!(!is_closed(&page).await && !is_closed(&newcomer).await && !is_closed(&next).await);
    }

    #[tokio::test]
    async fn permits_are_bounded_and_released() {
        let connections = Arc::new(Connections::new());
        let pages: Vec<_> =
            (0..MAX_PAGES as u64).map(|number| connect(&connections, number)).collect();
        for page in &pages {
            page.verify(true).unwrap();
        }
        let more = connect(&connections, 1000);
        assert_eq!(more.verify(true).unwrap_err().max, MAX_PAGES);
        // Other requests have separate permits.
        more.verify(false).unwrap();
        // A permit is held until the last clone is dropped.
        let held = pages[0].clone();
        drop(pages);
        assert_eq!(connections.pages.available_permits(), MAX_PAGES - 1);
        drop(held);
        assert_eq!(connections.pages.available_permits(), MAX_PAGES);
    }

    #[tokio::test(start_paused = true)]
    async fn only_unverified_connections_time_out() {
        let connections = Arc::new(Connections::new());
        let (connection, page) = (connect(&connections, 1), connect(&connections, 2));
        page.verify(true).unwrap();
        time::timeout(2 * TIMEOUT, connection.closed()).await.unwrap();
        time::timeout(1000 * TIMEOUT, page.closed()).await.unwrap_err();
    }
}
