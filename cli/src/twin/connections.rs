//! Connections: how many there may be, and for how long without showing the token.
//!
//! A connection that has not shown the token yet is a stranger's. There are few places for strangers, and
//! for one too many, the oldest is closed: a page gets in, however many connections another program opens
//! and keeps silent on. A connection that has shown the token is never closed for a stranger's. Pages have
//! places of their own, which short requests cannot take.

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

/// Connections that have not shown the token, at most. Few of the files that a process may have open.
const STRANGERS: usize = 64;

/// Pages that are open, at most: each keeps what it was sent last until its browser takes it.
const PAGES: usize = 16;

/// Other requests with the token at one time, at most: a browser makes six.
const REQUESTS: usize = 8;

/// How long a connection has to show the token, and, if it is refused, to take the answer.
const PATIENCE: Duration = Duration::from_secs(5);

/// How long nothing is accepted after the system has refused to.
const PAUSE: Duration = Duration::from_millis(20);

/// Bytes of a request's head, at most.
const HEAD_BYTES: usize = 16 << 10;

/// Accepts connections and has `router` answer them; it never ends. Requests carry the [`Connection`] as an
/// extension. Each connection has one request: `router` answers with `Connection: close`.
pub(super) async fn receive(listener: TcpListener, router: Router) {
    let connections = Arc::new(Connections::new());
    let mut count = 0;
    loop {
        // A place for one more than there may be: the one that is closed for it takes its until then.
        let Ok(permit) = connections.accepted.clone().acquire_owned().await else { return };
        match listener.accept().await {
            Ok((stream, peer)) => {
                count += 1;
                let connection = connections.add(count, peer, permit);
                tokio::spawn(attend(stream, connection, router.clone()));
            }
            // The other end has gone already.
            Err(error) if is_gone(&error) => {}
            Err(_) => {
                // There may be no file left for it. That must neither end the server nor keep a core busy.
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

/// Answers a connection's request, unless the connection is closed before.
async fn attend(stream: TcpStream, connection: Connection, router: Router) {
    let service = TowerToHyperService::new(router.layer(Extension(connection.clone())));
    let exchange = http1::Builder::new()
        .max_buf_size(HEAD_BYTES)
        .serve_connection(TokioIo::new(stream), service)
        .with_upgrades();
    tokio::select! {
        // If it fails, that concerns the other end only.
        _ = exchange => {}
        () = connection.closed() => {}
    }
}

/// Those that there are.
#[derive(Debug)]
struct Connections {
    /// How each is closed, by the order in which they came.
    strangers: Mutex<BTreeMap<u64, Arc<Notify>>>,
    pages: Arc<Semaphore>,
    requests: Arc<Semaphore>,
    /// All connections that there may be, whichever they are.
    accepted: Arc<Semaphore>,
}

impl Connections {
    fn new() -> Self {
        let places = |count| Arc::new(Semaphore::new(count));
        Self {
            strangers: Mutex::default(),
            pages: places(PAGES),
            requests: places(REQUESTS),
            accepted: places(STRANGERS + PAGES + REQUESTS + 1),
        }
    }

    fn strangers(&self) -> MutexGuard<'_, BTreeMap<u64, Arc<Notify>>> {
        self.strangers.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Takes in a connection, for which the oldest of a stranger may be closed.
    fn add(
        self: &Arc<Self>,
        number: u64,
        peer: SocketAddr,
        permit: OwnedSemaphorePermit,
    ) -> Connection {
        if self.strangers().len() >= STRANGERS {
            self.close_oldest();
        }
        let close = Arc::new(Notify::new());
        self.strangers().insert(number, close.clone());
        let place = OnceLock::new();
        Connection(Arc::new(ConnectionState {
            number,
            peer,
            close,
            place,
            connections: self.clone(),
            _accepted: permit,
        }))
    }

    /// Closes the oldest connection of a stranger.
    fn close_oldest(&self) {
        let first = self.strangers().pop_first();
        if let Some((_, close)) = first {
            close.notify_one();
        }
    }
}

/// A connection. Its place is free again when all clones are dropped.
#[derive(Clone, Debug)]
pub(super) struct Connection(Arc<ConnectionState>);

#[derive(Debug)]
struct ConnectionState {
    number: u64,
    peer: SocketAddr,
    close: Arc<Notify>,
    /// Of one that has shown the token.
    place: OnceLock<OwnedSemaphorePermit>,
    connections: Arc<Connections>,
    _accepted: OwnedSemaphorePermit,
}

/// All places are taken.
#[derive(Debug)]
pub(super) struct Full {
    /// Of how many.
    pub(super) places: usize,
}

impl Connection {
    pub(super) fn peer(&self) -> SocketAddr {
        self.0.peer
    }

    /// Gives a connection that has shown the token a place that no stranger can take.
    pub(super) fn admit(&self, is_page: bool) -> Result<(), Full> {
        let ConnectionState { number, place, connections, .. } = &*self.0;
        let (free, places) =
            if is_page { (&connections.pages, PAGES) } else { (&connections.requests, REQUESTS) };
        let taken = free.clone().try_acquire_owned().map_err(|_| Full { places })?;
        // A connection has one request; a second place would only be given back.
        let _ = place.set(taken);
        connections.strangers().remove(number);
        Ok(())
    }

    /// Returns when a stranger's connection is closed: for another one, or because its time is up.
    async fn closed(&self) {
        tokio::select! {
            () = self.0.close.notified() => {}
            () = time::sleep(PATIENCE) => {
                if self.0.place.get().is_some() {
                    // It may stay for as long as it likes.
                    std::future::pending::<()>().await;
                }
            }
        }
    }
}

impl Drop for ConnectionState {
    fn drop(&mut self) {
        self.connections.strangers().remove(&self.number);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn connect(connections: &Arc<Connections>, number: u64) -> Connection {
        let permit = connections.accepted.clone().try_acquire_owned().unwrap();
        connections.add(number, ([127, 0, 0, 1], 9).into(), permit)
    }

    /// Whether a connection was told to close.
    async fn is_closed(connection: &Connection) -> bool {
        time::timeout(Duration::ZERO, connection.0.close.notified()).await.is_ok()
    }

    #[tokio::test]
    async fn the_first_stranger_leaves_for_one_too_many() {
        let connections = Arc::new(Connections::new());
        let page = connect(&connections, 0);
        page.admit(true).unwrap();
        let strangers: Vec<_> =
            (1..=STRANGERS as u64).map(|number| connect(&connections, number)).collect();
        for stranger in &strangers {
            assert!(!is_closed(stranger).await);
        }
        let newcomer = connect(&connections, 1000);
        assert!(is_closed(&strangers[0]).await && !is_closed(&strangers[1]).await);
        // Still in time.
        newcomer.admit(false).unwrap();
        let next = connect(&connections, 1001);
        assert!(!is_closed(&strangers[1]).await, "a place was free");
        // What was closed is not counted any more.
        drop(strangers);
        assert_eq!(connections.strangers().len(), 1);
        assert!(!is_closed(&page).await && !is_closed(&newcomer).await && !is_closed(&next).await);
    }

    #[tokio::test]
    async fn places_are_few_and_free_again() {
        let connections = Arc::new(Connections::new());
        let pages: Vec<_> = (0..PAGES as u64).map(|number| connect(&connections, number)).collect();
        for page in &pages {
            page.admit(true).unwrap();
        }
        let more = connect(&connections, 1000);
        assert_eq!(more.admit(true).unwrap_err().places, PAGES);
        // Requests have places of their own.
        more.admit(false).unwrap();
        // A place is taken for as long as anything holds it.
        let held = pages[0].clone();
        drop(pages);
        assert_eq!(connections.pages.available_permits(), PAGES - 1);
        drop(held);
        assert_eq!(connections.pages.available_permits(), PAGES);
    }

    #[tokio::test(start_paused = true)]
    async fn patience_ends_for_strangers_only() {
        let connections = Arc::new(Connections::new());
        let (stranger, page) = (connect(&connections, 1), connect(&connections, 2));
        page.admit(true).unwrap();
        time::timeout(2 * PATIENCE, stranger.closed()).await.unwrap();
        time::timeout(1000 * PATIENCE, page.closed()).await.unwrap_err();
    }
}
