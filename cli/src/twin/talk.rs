//! An open page: it receives the state of the robot, and gives orders.

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

use super::{
    Word,
    order::{Numbered, Order},
    shared::{Shared, interrupted},
    word,
};

/// An order is at most so long, in bytes. Programs do not come this way.
pub(super) const LONGEST_ORDER: usize = 16 << 10;

/// Orders of one page that may be under way; and, beside them, stops.
const ORDERS: usize = 8;

/// Answers that wait for a page, at most.
const ANSWERS: usize = 64;

/// How long a page may take for one message.
const PATIENCE: Duration = Duration::from_secs(10);

/// Passes on each newest word, and takes orders, until the page is closed. While a word is on its way, and
/// while orders are carried out, the page is listened to: it may want the robot to stop.
pub(super) async fn talk(socket: WebSocket, twin: Shared) {
    let (mut to_page, from_page) = socket.split();
    let (answered, answers) = mpsc::channel(ANSWERS);
    tokio::select! {
        () = tell(&mut to_page, &twin, answers) => {}
        () = listen(from_page, &twin, answered) => {}
        () = interrupted() => {}
    }
    // The page may be gone as well.
    let goodbye = to_page.send(Message::Close(None));
    let _ = time::timeout(Duration::from_millis(500), goodbye).await;
}

/// Passes on each newest word, and the answers, until the page takes no more.
async fn tell(
    page: &mut SplitSink<WebSocket, Message>,
    twin: &Shared,
    mut answers: mpsc::Receiver<Word>,
) {
    let desk = &twin.desk;
    let mut live = twin.live.clone();
    let mut health = twin.health.clone();
    let mut positions = desk.positions.subscribe();
    let mut plan = desk.plan.subscribe();
    let mut run = desk.run.subscribe();
    // All that there is already is news to this page.
    for words in [&mut live, &mut health, &mut positions, &mut plan, &mut run] {
        words.mark_changed();
    }
    loop {
        let word = tokio::select! {
            Ok(()) = live.changed() => live.borrow_and_update().clone(),
            Ok(()) = health.changed() => health.borrow_and_update().clone(),
            Ok(()) = positions.changed() => positions.borrow_and_update().clone(),
            Ok(()) = plan.changed() => plan.borrow_and_update().clone(),
            Ok(()) = run.changed() => run.borrow_and_update().clone(),
            Some(answer) = answers.recv() => answer,
        };
        let message = Message::Text(Utf8Bytes::from(&*word));
        if !matches!(time::timeout(PATIENCE, page.send(message)).await, Ok(Ok(()))) {
            return;
        }
    }
}

/// The answer to an order.
#[derive(Serialize)]
struct OrderAnswer {
    id: u64,
    error: Option<String>,
}

fn answer(id: u64, error: Option<String>) -> Word {
    word("answer", &OrderAnswer { id, error })
}

/// Has orders carried out, beside everything else, until the page is closed or does not take its answers.
async fn listen(mut page: SplitStream<WebSocket>, twin: &Shared, answered: mpsc::Sender<Word>) {
    let places = Arc::new(Semaphore::new(ORDERS));
    let stops = Arc::new(Semaphore::new(ORDERS));
    while let Some(Ok(message)) = page.next().await {
        let text = match message {
            Message::Text(text) => text,
            Message::Close(_) => return,
            _ => continue,
        };
        let refused = match serde_json::from_str::<Numbered>(&text) {
            Ok(Numbered { id, order: Order::Stop }) => {
                // It waits for no other order, and is asked for at once; only the answer may take a while.
                let stopped = twin.desk.stop();
                let answered = answered.clone();
                let Ok(place) = stops.clone().acquire_owned().await else { return };
                task::spawn(async move {
                    let _place = place;
                    // The page may have been closed.
                    let _ = answered.send(answer(id, stopped.await.err())).await;
                });
                continue;
            }
            Ok(Numbered { id, order }) => {
                if let Ok(place) = places.clone().try_acquire_owned() {
                    let (twin, answered) = (twin.clone(), answered.clone());
                    task::spawn(async move {
                        let _place = place;
                        let _ = answered.send(answer(id, carry_out(order, twin).await.err())).await;
                    });
                    continue;
                }
                answer(id, Some(format!("{ORDERS} orders of this page are under way: wait")))
            }
            Err(error) => answer(0, Some(format!("not understood: {error}"))),
        };
        if answered.try_send(refused).is_err() {
            return;
        }
    }
}

/// Carries out an order when it is its turn.
async fn carry_out(order: Order, twin: Shared) -> Result<(), String> {
    let turns = if order.is_heavy() { twin.heavy } else { twin.orders };
    let ended = |_| "the twin ends".to_owned();
    let turn = turns.acquire_owned().await.map_err(ended)?;
    let done = task::spawn_blocking(move || {
        // It is over when the work is, and not when the page is gone.
        let _turn = turn;
        twin.desk.carry_out(order)
    });
    done.await.map_err(|error| format!("the order failed: {error}"))?
}
