//! The page, and the connection over which it hears of the robot and gives orders.

use std::{
    fs,
    net::{SocketAddr, TcpListener},
    sync::Arc,
    time::Duration,
};

use axum::{
    Router,
    extract::{
        Path, State,
        ws::{Message, Utf8Bytes, WebSocket, WebSocketUpgrade},
    },
    http::{
        HeaderValue, StatusCode,
        header::{CONTENT_DISPOSITION, CONTENT_SECURITY_POLICY, CONTENT_TYPE},
    },
    middleware,
    response::{IntoResponse, Response},
    routing::get,
};
use serde::Serialize;
use tokio::{
    sync::{mpsc, watch},
    task, time,
};

use crate::{
    failure::Failure,
    output,
    page::{self, Part},
};

use super::{Desk, Setup, Token, Word, guard::guard, order::Numbered, word};

/// Where pages connect to.
pub(super) const LIVE: &str = "/live";

/// A program's text is at most so long, in bytes.
const LONGEST_ORDER: usize = 16 << 20;

const PARTS: [Part; 5] = [
    ("/*twin.css*/", include_str!("twin.css")),
    ("/*link.js*/", include_str!("link.js")),
    ("/*live.js*/", include_str!("live.js")),
    ("/*programs.js*/", include_str!("programs.js")),
    ("/*main.js*/", include_str!("main.js")),
];

/// What the server passes on.
#[derive(Clone)]
pub(crate) struct Twin {
    pub(crate) setup: Arc<Setup>,
    pub(crate) live: watch::Receiver<Word>,
    pub(crate) health: watch::Receiver<Word>,
    pub(crate) desk: Arc<Desk>,
}

/// Serves the page until an interrupt comes.
pub(crate) fn serve(listener: TcpListener, token: &Token, twin: Twin) -> Result<(), Failure> {
    let refuse = |error: std::io::Error| Failure::run("cannot serve the page", &error);
    listener.set_nonblocking(true).map_err(refuse)?;
    let router = Router::new()
        .route("/", get(page))
        .route(LIVE, get(connect))
        .route("/report.html", get(report))
        .route("/files/{name}", get(file))
        .with_state(twin)
        .layer(middleware::from_fn_with_state(token.clone(), guard));
    let runtime = tokio::runtime::Builder::new_multi_thread()
        .worker_threads(2)
        .enable_all()
        .build()
        .map_err(refuse)?;
    let served = runtime.block_on(async {
        let listener = tokio::net::TcpListener::from_std(listener)?;
        let service = router.into_make_service_with_connect_info::<SocketAddr>();
        tokio::select! {
            served = axum::serve(listener, service) => served,
            () = interrupted() => Ok(()),
        }
    });
    // Orders that are under way have a moment.
    runtime.shutdown_timeout(Duration::from_secs(1));
    served.map_err(refuse)
}

async fn interrupted() {
    while !output::interrupted() {
        time::sleep(Duration::from_millis(50)).await;
    }
}

/// A page with scripts of its own only, in no other page's frame.
fn html(text: String, policy: &str) -> Response {
    let headers = [
        (CONTENT_TYPE, HeaderValue::from_static("text/html; charset=utf-8")),
        (
            CONTENT_SECURITY_POLICY,
            HeaderValue::from_str(policy).unwrap_or(HeaderValue::from_static("default-src 'none'")),
        ),
    ];
    (headers, text).into_response()
}

fn failed(failure: &Failure) -> Response {
    (StatusCode::INTERNAL_SERVER_ERROR, format!("{}\n", failure.what())).into_response()
}

/// The page runs its own scripts, connects to its own server, and is in no other page's frame.
const POLICY: &str = "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; \
                      img-src data:; connect-src 'self'; base-uri 'none'; form-action 'none'; \
                      frame-ancestors 'none'";

async fn page(State(twin): State<Twin>) -> Response {
    let title = format!("{} - iiwasim twin", twin.setup.robot.name());
    let page = page::assemble(include_str!("page.html"), &PARTS, &title, &twin.setup.for_page());
    page.map_or_else(|failure| failed(&failure), |text| html(text, POLICY))
}

async fn report(State(twin): State<Twin>) -> Response {
    match task::spawn_blocking(move || twin.desk.report()).await {
        Ok(Some(Ok(text))) => html(text, "frame-ancestors 'none'"),
        Ok(Some(Err(failure))) => failed(&failure),
        Ok(None) => (StatusCode::NOT_FOUND, "there is no plan\n").into_response(),
        Err(error) => failed(&Failure::run("the report failed", &error)),
    }
}

async fn file(State(twin): State<Twin>, Path(name): Path<String>) -> Response {
    let file = twin.desk.file(&name).and_then(|path| Some((fs::read(&path).ok()?, path)));
    let Some((bytes, path)) = file else {
        return (StatusCode::NOT_FOUND, "there is no such file\n").into_response();
    };
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let named = HeaderValue::from_str(&format!(
        "attachment; filename=\"{}\"",
        name.replace(|c: char| !c.is_ascii(), "_")
    ));
    let headers = [
        (CONTENT_TYPE, HeaderValue::from_static("application/octet-stream")),
        (CONTENT_DISPOSITION, named.unwrap_or(HeaderValue::from_static("attachment"))),
    ];
    (headers, bytes).into_response()
}

async fn connect(State(twin): State<Twin>, upgrade: WebSocketUpgrade) -> Response {
    upgrade.max_message_size(LONGEST_ORDER).on_upgrade(move |socket| talk(socket, twin))
}

/// Passes on each newest word, and takes orders, until the page is closed.
async fn talk(mut socket: WebSocket, twin: Twin) {
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
    let (answered, mut answers) = mpsc::channel::<Word>(16);
    loop {
        let word = tokio::select! {
            Ok(()) = live.changed() => live.borrow_and_update().clone(),
            Ok(()) = health.changed() => health.borrow_and_update().clone(),
            Ok(()) = positions.changed() => positions.borrow_and_update().clone(),
            Ok(()) = plan.changed() => plan.borrow_and_update().clone(),
            Ok(()) = run.changed() => run.borrow_and_update().clone(),
            Some(answer) = answers.recv() => answer,
            message = socket.recv() => match message {
                Some(Ok(Message::Text(text))) => {
                    take(&text, &twin.desk, &answered);
                    continue;
                }
                Some(Ok(Message::Close(_)) | Err(_)) | None => return,
                Some(Ok(_)) => continue,
            },
            () = interrupted() => {
                // The page may be gone as well.
                let _ = socket.send(Message::Close(None)).await;
                return;
            }
        };
        if socket.send(Message::Text(Utf8Bytes::from(&*word))).await.is_err() {
            return;
        }
    }
}

/// The answer to an order.
#[derive(Serialize)]
struct Answer {
    id: u64,
    error: Option<String>,
}

/// Has an order carried out, beside everything else.
fn take(text: &str, desk: &Arc<Desk>, answered: &mpsc::Sender<Word>) {
    let (desk, answered) = (desk.clone(), answered.clone());
    let order = serde_json::from_str::<Numbered>(text);
    task::spawn_blocking(move || {
        let answer = match order {
            Ok(Numbered { id, order }) => Answer { id, error: desk.carry_out(order).err() },
            Err(error) => Answer { id: 0, error: Some(format!("not understood: {error}")) },
        };
        // The page may have been closed.
        let _ = answered.blocking_send(word("answer", &answer));
    });
}
