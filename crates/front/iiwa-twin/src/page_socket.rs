//! WebSocket of an open page: messages to the page, requests from it.

use std::{sync::Arc, time::Duration};

use axum::extract::ws::{Message, Utf8Bytes, WebSocket};
use futures_util::{
    SinkExt, StreamExt,
    stream::{SplitSink, SplitStream},
};
use serde::Serialize;
use tokio::{
    sync::{Semaphore, mpsc},
    task, time,
};

use crate::{
    message::{PageMessage, page_message},
    request::{NumberedRequest, PageRequest},
    shared::{SharedTwin, interrupted},
};

/// Maximum length of a request, in bytes. Programs are uploaded over HTTP instead.
pub(crate) const MAX_REQUEST_BYTES: usize = 16 << 10;

/// Maximum number of pending requests of one page; stops are counted separately.
const MAX_REQUESTS: usize = 8;

/// Maximum number of answers queued for a page.
const MAX_ANSWERS: usize = 64;

/// Time limit for a page to receive one message.
const TIMEOUT: Duration = Duration::from_secs(10);

/// Sends messages and receives requests until the page is closed. Neither sending nor a pending
/// request delays the reading of the next request, which may be a stop.
pub(crate) async fn serve_page(socket: WebSocket, twin: SharedTwin) {
    let (mut to_page, from_page) = socket.split();
    let (answered, answers) = mpsc::channel(MAX_ANSWERS);
    tokio::select! {
        () = send_messages(&mut to_page, &twin, answers) => {}
        () = receive_requests(from_page, &twin, answered) => {}
        () = interrupted() => {}
    }
    // The page may be closed already.
    let close = to_page.send(Message::Close(None));
    let _ = time::timeout(Duration::from_millis(500), close).await;
}

/// Sends the latest message of each kind, and the answers, until the page receives no more.
async fn send_messages(
    page: &mut SplitSink<WebSocket, Message>,
    twin: &SharedTwin,
    mut answers: mpsc::Receiver<PageMessage>,
) {
    let dispatcher = &twin.dispatcher;
    let mut live = twin.live.clone();
    let mut health = twin.health.clone();
    let mut positions = dispatcher.positions_channel.subscribe();
    let mut plan = dispatcher.plan.subscribe();
    let mut run = dispatcher.run.subscribe();
    // The page has not received the current state yet.
    for channel in [&mut live, &mut health, &mut positions, &mut plan, &mut run] {
        channel.mark_changed();
    }
    loop {
        let message = tokio::select! {
            Ok(()) = live.changed() => live.borrow_and_update().clone(),
            Ok(()) = health.changed() => health.borrow_and_update().clone(),
            Ok(()) = positions.changed() => positions.borrow_and_update().clone(),
            Ok(()) = plan.changed() => plan.borrow_and_update().clone(),
            Ok(()) = run.changed() => run.borrow_and_update().clone(),
            Some(answer) = answers.recv() => answer,
        };
        let message = Message::Text(Utf8Bytes::from(&*message));
        if !matches!(time::timeout(TIMEOUT, page.send(message)).await, Ok(Ok(()))) {
            return;
        }
    }
}

/// Answer to a request.
#[derive(Serialize)]
struct PageAnswer {
    id: u64,
    error: Option<String>,
}

fn answer(id: u64, error: Option<String>) -> PageMessage {
    page_message("answer", &PageAnswer { id, error })
}

/// Starts a task for each request, until the page is closed or does not receive its answers.
async fn receive_requests(
    mut page: SplitStream<WebSocket>,
    twin: &SharedTwin,
    answered: mpsc::Sender<PageMessage>,
) {
    let places = Arc::new(Semaphore::new(MAX_REQUESTS));
    let stops = Arc::new(Semaphore::new(MAX_REQUESTS));
    while let Some(Ok(message)) = page.next().await {
        let text = match message {
            Message::Text(text) => text,
            Message::Close(_) => return,
            _ => continue,
        };
        let refused = match serde_json::from_str::<NumberedRequest>(&text) {
            Ok(NumberedRequest { id, request: PageRequest::Stop }) => {
                // A stop is sent at once, without waiting for other requests; only its answer may
                // take a while.
                let stopped = twin.dispatcher.stop();
                let answered = answered.clone();
                let Ok(place) = stops.clone().acquire_owned().await else { return };
                task::spawn(async move {
                    let _place = place;
                    // The page may have been closed.
                    let _ = answered.send(answer(id, stopped.await.err())).await;
                });
                continue;
            }
            Ok(NumberedRequest { id, request }) => {
                if let Ok(place) = places.clone().try_acquire_owned() {
                    let (twin, answered) = (twin.clone(), answered.clone());
                    task::spawn(async move {
                        let _place = place;
                        let _ =
                            answered.send(answer(id, carry_out(request, twin).await.err())).await;
                    });
                    continue;
                }
                answer(
                    id,
                    Some(format!("{MAX_REQUESTS} requests of this page are under way: wait")),
                )
            }
            Err(error) => answer(0, Some(format!("not a valid request: {error}"))),
        };
        if answered.try_send(refused).is_err() {
            return;
        }
    }
}

/// Carries out a request in its turn.
async fn carry_out(request: PageRequest, twin: SharedTwin) -> Result<(), String> {
    let turns = if request.is_heavy() { twin.heavy } else { twin.requests };
    let ended = |_| "the twin is shutting down".to_owned();
    let turn = turns.acquire_owned().await.map_err(ended)?;
    let done = task::spawn_blocking(move || {
        // Released when the work is done, even if the page is closed before.
        let _turn = turn;
        twin.dispatcher.carry_out(request)
    });
    done.await.map_err(|error| format!("the request failed: {error}"))?
}
