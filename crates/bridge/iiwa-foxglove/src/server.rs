//! A WebSocket server for viewers.

use std::{
    io,
    net::{SocketAddr, TcpListener as Listener},
    sync::Arc,
    time::Duration,
};

use axum::{
    Extension, Router,
    extract::{
        State, WebSocketUpgrade,
        ws::{Message, WebSocket},
    },
    http::StatusCode,
    response::{IntoResponse, Response},
};
use futures_util::{
    SinkExt, StreamExt,
    stream::{SplitSink, SplitStream},
};
use hyper::server::conn::http1;
use hyper_util::{rt::TokioIo, service::TowerToHyperService};
use tokio::{
    net::{TcpListener, TcpStream},
    runtime::{self, Runtime},
    sync::{Notify, OwnedSemaphorePermit, Semaphore},
    time::{sleep, timeout},
};

use super::{
    audience::Audience,
    protocol::{Channel, PROTOCOL, ServerMessage},
};

/// Maximum number of connections; further ones are closed immediately.
const MAX_CONNECTIONS: usize = 16;

/// Time-out of the WebSocket handshake.
const HANDSHAKE: Duration = Duration::from_secs(5);

/// Maximum length of a viewer request, in bytes.
const MAX_REQUEST_BYTES: usize = 64 << 10;

/// Time-out of disconnecting viewers: a viewer that does not read would never disconnect.
const SHUTDOWN_TIMEOUT: Duration = Duration::from_millis(200);

/// Pause after a failure to accept a connection.
const PAUSE: Duration = Duration::from_millis(20);

/// A server that listens until it is dropped.
///
/// The server has a separate thread. [`Self::listen`] and the drop block, so asynchronous code must
/// not call them.
#[derive(Debug)]
pub(super) struct FoxgloveServer {
    audience: Arc<Audience>,
    address: SocketAddr,
    /// `None` once the server has ended.
    runtime: Option<Runtime>,
}

impl FoxgloveServer {
    /// Listens at `address`; port 0 selects a free port.
    pub(super) fn listen(address: SocketAddr, channels: Vec<Channel>) -> io::Result<Self> {
        let listener = Listener::bind(address)?;
        listener.set_nonblocking(true)?;
        let address = listener.local_addr()?;
        let runtime = runtime::Builder::new_multi_thread()
            .worker_threads(1)
            .thread_name("viewers")
            .enable_all()
            .build()?;
        let audience = Arc::new(Audience::new(channels));
        let listener = {
            let _context = runtime.enter();
            TcpListener::from_std(listener)?
        };
        runtime.spawn(accept(listener, audience.clone()));
        Ok(Self { audience, address, runtime: Some(runtime) })
    }

    pub(super) fn address(&self) -> SocketAddr {
        self.address
    }

    pub(super) fn audience(&self) -> &Audience {
        &self.audience
    }
}

impl Drop for FoxgloveServer {
    fn drop(&mut self) {
        let Some(runtime) = self.runtime.take() else { return };
        self.audience.end();
        let all_closed = async {
            while !self.audience.is_empty() {
                sleep(Duration::from_millis(1)).await;
            }
        };
        // Viewers that are still connected afterwards are cut off.
        let _ = runtime.block_on(async { timeout(SHUTDOWN_TIMEOUT, all_closed).await });
        runtime.shutdown_timeout(SHUTDOWN_TIMEOUT);
    }
}

/// Accepts connections until the server ends.
async fn accept(listener: TcpListener, audience: Arc<Audience>) {
    let places = Arc::new(Semaphore::new(MAX_CONNECTIONS));
    let router = Router::new().fallback(upgrade).with_state(audience.clone());
    loop {
        let accepted = tokio::select! {
            accepted = listener.accept() => accepted,
            () = audience.ended() => return,
        };
        match accepted {
            Ok((stream, _)) => {
                if let Ok(place) = places.clone().try_acquire_owned() {
                    tokio::spawn(shake_hands(stream, Arc::new(place), router.clone()));
                }
            }
            // The other side has disconnected, or the process has too many open files.
            Err(_) => sleep(PAUSE).await,
        }
    }
}

/// Answers the single request of a connection, which upgrades it to a viewer connection.
async fn shake_hands(stream: TcpStream, place: Arc<OwnedSemaphorePermit>, router: Router) {
    let service = TowerToHyperService::new(router.layer(Extension(place)));
    let exchange =
        http1::Builder::new().serve_connection(TokioIo::new(stream), service).with_upgrades();
    // A failure affects the other side only.
    let _ = timeout(HANDSHAKE, exchange).await;
}

async fn upgrade(
    State(audience): State<Arc<Audience>>,
    Extension(place): Extension<Arc<OwnedSemaphorePermit>>,
    upgrade: WebSocketUpgrade,
) -> Response {
    let upgrade = upgrade.protocols([PROTOCOL]).max_message_size(MAX_REQUEST_BYTES);
    if upgrade.selected_protocol().is_none() {
        return (StatusCode::BAD_REQUEST, format!("this server speaks {PROTOCOL}")).into_response();
    }
    upgrade.on_upgrade(|socket| async move {
        serve(socket, &audience).await;
        drop(place);
    })
}

/// Sends a viewer the messages of its subscriptions, until it disconnects or the server ends.
async fn serve(socket: WebSocket, audience: &Audience) {
    let (mut to_viewer, from_viewer) = socket.split();
    let (number, wake) = audience.add();
    tokio::select! {
        () = send(&mut to_viewer, audience, number, &wake) => {}
        () = receive(from_viewer, audience, number) => {}
        () = audience.ended() => {}
    }
    // The viewer may have disconnected already.
    let _ = timeout(SHUTDOWN_TIMEOUT / 2, to_viewer.send(Message::Close(None))).await;
    audience.remove(number);
}

async fn send(
    viewer: &mut SplitSink<WebSocket, Message>,
    audience: &Audience,
    number: u64,
    wake: &Notify,
) {
    let info = ServerMessage::ServerInfo { name: "iiwasim", capabilities: [] };
    let advertised = ServerMessage::Advertise { channels: &audience.channels };
    for message in [info, advertised] {
        if viewer.send(Message::text(message.text())).await.is_err() {
            return;
        }
    }
    loop {
        let Some(message) = audience.next_for(number) else {
            wake.notified().await;
            continue;
        };
        if viewer.send(message).await.is_err() {
            return;
        }
    }
}

async fn receive(mut viewer: SplitStream<WebSocket>, audience: &Audience, number: u64) {
    while let Some(Ok(message)) = viewer.next().await {
        match message {
            Message::Text(text) => audience.receive(number, &text),
            // Binary messages would publish, or call services.
            Message::Binary(_) => audience.receive(number, r#"{ "op": "" }"#),
            Message::Close(_) => return,
            Message::Ping(_) | Message::Pong(_) => {}
        }
    }
}
