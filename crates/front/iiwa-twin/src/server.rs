//! HTTP server: the page, its WebSocket, uploads of programs, files.

use std::{net::TcpListener, time::Duration};

use axum::{
    Extension, Router,
    body::Body,
    extract::{
        DefaultBodyLimit, FromRequest as _, Path, Query, Request, State, ws::WebSocketUpgrade,
    },
    http::{
        HeaderValue, StatusCode,
        header::{CONTENT_DISPOSITION, CONTENT_LENGTH, CONTENT_SECURITY_POLICY, CONTENT_TYPE},
    },
    middleware,
    response::{IntoResponse, Response},
    routing::{get, post},
};
use iiwa_page::twin_page;
use serde::Deserialize;
use tokio::{fs, task, time};
use tokio_util::io::ReaderStream;

use crate::{
    Setup, TwinError,
    connections::{self, PageConnection},
    guard::{Admission, LIVE, PageToken, guard},
    message::page_message,
    page_socket::{MAX_REQUEST_BYTES, serve_page},
    shared::{SharedTwin, interrupted},
};

/// Maximum length of a program's text, in bytes.
const MAX_PROGRAM_BYTES: usize = 4 << 20;

/// Time limit for the upload of a program.
const UPLOAD_TIMEOUT: Duration = Duration::from_secs(20);

/// Serves the page until an interrupt.
pub(crate) fn serve(
    listener: TcpListener,
    token: &PageToken,
    twin: SharedTwin,
) -> Result<(), TwinError> {
    let to_error = TwinError::Serve;
    listener.set_nonblocking(true).map_err(to_error)?;
    let admission = Admission { token: token.clone(), address: twin.setup.wording.address };
    let router = routes(twin).layer(middleware::from_fn_with_state(admission, guard));
    let runtime = tokio::runtime::Builder::new_multi_thread()
        .worker_threads(2)
        .enable_all()
        .build()
        .map_err(to_error)?;
    let served = runtime.block_on(async {
        let listener = tokio::net::TcpListener::from_std(listener)?;
        tokio::select! {
            () = connections::accept(listener, router) => {}
            () = interrupted() => {}
        }
        Ok(())
    });
    // Pending requests have a moment to finish.
    runtime.shutdown_timeout(Duration::from_secs(1));
    served.map_err(to_error)
}

/// Routes behind the guard.
fn routes(twin: SharedTwin) -> Router {
    Router::new()
        .route("/", get(page))
        .route(LIVE, get(connect))
        .route("/program", post(program).layer(DefaultBodyLimit::max(MAX_PROGRAM_BYTES)))
        .route("/report.html", get(report))
        .route("/files/{name}", get(file))
        .with_state(twin)
}

/// Returns a page that runs only its own scripts, and cannot be framed by another page.
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

fn failed(setup: &Setup, error: &TwinError) -> Response {
    (StatusCode::INTERNAL_SERVER_ERROR, format!("{}\n", setup.words(error))).into_response()
}

/// Content security policy: the page runs its own scripts, connects to its own server, and cannot
/// be framed by another page.
const POLICY: &str = "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; \
                      img-src data:; connect-src 'self'; base-uri 'none'; form-action 'none'; \
                      frame-ancestors 'none'";

async fn page(State(twin): State<SharedTwin>) -> Response {
    twin_page(&twin.setup.for_page())
        .map_or_else(|error| failed(&twin.setup, &error.into()), |text| html(text, POLICY))
}

/// Query of an upload.
#[derive(Deserialize)]
struct UploadQuery {
    name: String,
}

/// Plans an uploaded program, once it is read: a slow upload does not delay others.
async fn program(
    State(twin): State<SharedTwin>,
    Query(UploadQuery { name }): Query<UploadQuery>,
    request: Request,
) -> Response {
    let setup = twin.setup.clone();
    let text = match read_program(request).await {
        Ok(text) => text,
        Err(refusal) => return refusal,
    };
    let Ok(turn) = twin.heavy.acquire_owned().await else { return shutting_down() };
    let planned = task::spawn_blocking(move || {
        // Released when the work is done, even if the page is closed before.
        let _turn = turn;
        twin.dispatcher.load(&name, text)
    });
    match planned.await {
        // A fault in a program is not a failure of the request, which browsers would report as an
        // error of the page.
        Ok(planned) => {
            let answer = page_message("error", &planned.err());
            ([(CONTENT_TYPE, "application/json")], answer.to_string()).into_response()
        }
        Err(error) => failed(&setup, &broken_down("planning failed", error)),
    }
}

/// Reads the text of an upload, with bounds on its length and its duration. The number of
/// connections bounds the number of texts in memory.
async fn read_program(request: Request) -> Result<String, Response> {
    let read = time::timeout(UPLOAD_TIMEOUT, String::from_request(request, &())).await;
    let refusal = |status, why| (status, why).into_response();
    match read {
        Ok(Ok(text)) => Ok(text),
        Ok(Err(refused)) if refused.status() == StatusCode::PAYLOAD_TOO_LARGE => {
            let why = format!(
                "the program is longer than {} MiB, the most that the twin accepts; iiwasim plan \
                 has no such limit",
                MAX_PROGRAM_BYTES >> 20
            );
            Err(refusal(StatusCode::PAYLOAD_TOO_LARGE, why))
        }
        Ok(Err(refused)) => Err(refused.into_response()),
        Err(_) => {
            let limit_s = UPLOAD_TIMEOUT.as_secs();
            let why = format!("the program was not uploaded within {limit_s} s: load it again\n");
            Err(refusal(StatusCode::REQUEST_TIMEOUT, why))
        }
    }
}

async fn report(State(twin): State<SharedTwin>) -> Response {
    let setup = twin.setup.clone();
    let Ok(turn) = twin.heavy.acquire_owned().await else { return shutting_down() };
    let made = task::spawn_blocking(move || {
        let _turn = turn;
        twin.dispatcher.report()
    });
    match made.await {
        Ok(Some(Ok(text))) => html(text, "frame-ancestors 'none'"),
        Ok(Some(Err(error))) => failed(&setup, &error),
        Ok(None) => (StatusCode::NOT_FOUND, "no plan\n").into_response(),
        Err(error) => failed(&setup, &broken_down("the report failed", error)),
    }
}

fn broken_down(part: &'static str, source: task::JoinError) -> TwinError {
    TwinError::BrokenDown { message: part, source: source.into() }
}

fn shutting_down() -> Response {
    (StatusCode::SERVICE_UNAVAILABLE, "the twin is shutting down\n").into_response()
}

/// Streams a file: it is never in memory as a whole.
async fn file(State(twin): State<SharedTwin>, Path(name): Path<String>) -> Response {
    let missing = || (StatusCode::NOT_FOUND, "no such file\n").into_response();
    let Some(path) = twin.dispatcher.file(&name) else { return missing() };
    let Ok(file) = fs::File::open(&path).await else { return missing() };
    let Ok(kind) = file.metadata().await else { return missing() };
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let named = HeaderValue::from_str(&format!(
        "attachment; filename=\"{}\"",
        name.replace(|c: char| !c.is_ascii(), "_")
    ));
    let headers = [
        (CONTENT_TYPE, HeaderValue::from_static("application/octet-stream")),
        (CONTENT_DISPOSITION, named.unwrap_or(HeaderValue::from_static("attachment"))),
        (CONTENT_LENGTH, HeaderValue::from(kind.len())),
    ];
    (headers, Body::from_stream(ReaderStream::new(file))).into_response()
}

async fn connect(
    State(twin): State<SharedTwin>,
    Extension(connection): Extension<PageConnection>,
    upgrade: WebSocketUpgrade,
) -> Response {
    upgrade.max_message_size(MAX_REQUEST_BYTES).max_frame_size(MAX_REQUEST_BYTES).on_upgrade(
        async move |socket| {
            serve_page(socket, twin).await;
            // The connection counts until here.
            drop(connection);
        },
    )
}

#[cfg(test)]
mod tests {
    use std::{convert::Infallible, path::Path, pin::pin, sync::Arc};

    use axum::body;
    use futures_util::stream;
    use hyper::service::Service as _;
    use hyper_util::service::TowerToHyperService;
    use time::Instant;

    use super::*;
    use crate::{dispatcher::TwinDispatcher, follow::LatestJoints, message::PageChannel};

    /// Returns a twin without a drive, with its files in this folder.
    fn twin(folder: &Path) -> SharedTwin {
        let setup = Arc::new(Setup::without_drive(folder));
        let dispatcher = TwinDispatcher::new(setup.clone(), Arc::new(LatestJoints::default()));
        let channels = [(), ()].map(|()| PageChannel::new("{}".into()).subscribe());
        SharedTwin::new(setup, channels, Arc::new(dispatcher.unwrap()))
    }

    /// Returns status and text of the answer to an upload.
    async fn upload(router: Router, program: Body) -> (StatusCode, String) {
        let request = Request::post("/program?name=a.json").body(program).unwrap();
        let answer = TowerToHyperService::new(router).call(request).await.unwrap();
        let status = answer.status();
        let text = body::to_bytes(answer.into_body(), usize::MAX).await.unwrap();
        (status, String::from_utf8(text.into()).unwrap())
    }

    #[tokio::test(start_paused = true)]
    async fn a_slow_upload_delays_no_other_and_has_a_time_limit() {
        let folder = tempfile::tempdir().unwrap();
        let router = routes(twin(folder.path()));
        let begin = Instant::now();
        // One byte per second, without end.
        let trickle = Body::from_stream(stream::unfold((), async |()| {
            time::sleep(Duration::from_secs(1)).await;
            Some((Ok::<_, Infallible>(" "), ()))
        }));
        let mut slow = pin!(upload(router.clone(), trickle));
        let (status, text) = tokio::select! {
            biased;
            (status, text) = &mut slow => panic!("it is answered first: {status}, {text}"),
            answer = upload(router, Body::from("{")) => answer,
        };
        assert_eq!(status, StatusCode::OK);
        assert!(text.contains("a.json, line 1") || text.contains("EOF"), "{text}");
        assert_eq!(begin.elapsed(), Duration::ZERO);
        let (status, text) = slow.await;
        assert_eq!(status, StatusCode::REQUEST_TIMEOUT);
        assert!(text.contains("within 20 s"), "{text}");
        assert_eq!(begin.elapsed().as_secs(), UPLOAD_TIMEOUT.as_secs());
    }
}
