//! The routes, and who may use them.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::io;
use std::net::{IpAddr, SocketAddr};
use std::sync::Arc;
use std::time::Duration;

use axum::Router;
use axum::body::Bytes;
use axum::extract::{Path, Request, State};
use axum::http::header::{
    CACHE_CONTROL, CONTENT_SECURITY_POLICY, CONTENT_TYPE, ETAG, HOST, HeaderMap, HeaderName,
    HeaderValue, IF_NONE_MATCH, X_CONTENT_TYPE_OPTIONS,
};
use axum::http::{StatusCode, Uri};
use axum::middleware::{Next, from_fn, map_response};
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use tokio::net::TcpListener;
use tokio::runtime::{Builder, Runtime};
use tokio::sync::Semaphore;
use tokio::time::{sleep, timeout};

use super::{Answer, Refusal, Source, page};

/// A bound server, which does not answer yet.
pub struct Server {
    runtime: Runtime,
    listener: TcpListener,
}

impl Server {
    /// Binds `address`; port 0 is any free one.
    ///
    /// # Errors
    /// When the port is taken, or not ours to take.
    pub fn bind(address: SocketAddr) -> io::Result<Self> {
        let runtime = Builder::new_current_thread()
            .enable_all()
            .max_blocking_threads(MOST_CONNECTIONS)
            .build()?;
        let listener = runtime.block_on(TcpListener::bind(address))?;
        Ok(Self { runtime, listener })
    }

    /// Where it listens.
    ///
    /// # Errors
    /// When the system does not tell.
    pub fn address(&self) -> io::Result<SocketAddr> {
        self.listener.local_addr()
    }

    /// Answers until the process ends.
    ///
    /// # Errors
    /// When the system does not tell where it listens.
    pub fn serve(self, source: Arc<dyn Source>) -> io::Result<()> {
        let router = router(source, self.address()?.ip());
        self.runtime.block_on(accept(&self.listener, &router));
        Ok(())
    }
}

/// Connections that are open at once; a browser opens six.
const MOST_CONNECTIONS: usize = 64;

/// The time in which a request must have come, and after an answer the next one: whoever sends half of one keeps no place.
const LONGEST_REQUEST: Duration = Duration::from_secs(15);

/// The time that a connection may take, whoever reads it however slowly.
const LONGEST_CONNECTION: Duration = Duration::from_secs(600);

/// Serves each connection that comes, so many at a time, until the process ends.
async fn accept(listener: &TcpListener, router: &Router) {
    let places = Arc::new(Semaphore::new(MOST_CONNECTIONS));
    while let Ok(place) = places.clone().acquire_owned().await {
        let Ok((stream, _)) = listener.accept().await else {
            // Too many files are open, or a client went away before it was served.
            sleep(Duration::from_millis(50)).await;
            continue;
        };
        let service = TowerToHyperService::new(router.clone());
        let connection = http1::Builder::new()
            .timer(TokioTimer::new())
            .header_read_timeout(LONGEST_REQUEST)
            .serve_connection(TokioIo::new(stream), service);
        tokio::spawn(async move {
            // Whoever hangs up or comes too late is told by the closed connection alone.
            let _ = timeout(LONGEST_CONNECTION, connection).await;
            drop(place);
        });
    }
}

/// The routes to `source` for a server that listens on `address`.
pub fn router(source: Arc<dyn Source>, address: IpAddr) -> Router {
    let routes = Router::new()
        .route("/api/run", get(run))
        .route("/api/design/{id}", get(design))
        .route("/api/shape/{id}", get(shape))
        .fallback(get(file))
        .with_state(source);
    // Who asks for another address has decided who may ask.
    let is_private = address.is_loopback();
    let routes = if is_private { routes.layer(from_fn(from_this_machine)) } else { routes };
    routes.layer(map_response(hardened))
}

async fn run(State(source): State<Arc<dyn Source>>, headers: HeaderMap) -> Response {
    json(&headers, move || source.run()).await
}

async fn design(
    State(source): State<Arc<dyn Source>>,
    Path(id): Path<String>,
    headers: HeaderMap,
) -> Response {
    json(&headers, move || source.design(&id)).await
}

async fn shape(
    State(source): State<Arc<dyn Source>>,
    Path(id): Path<String>,
    headers: HeaderMap,
) -> Response {
    json(&headers, move || source.shape(&id)).await
}

async fn file(uri: Uri) -> Response {
    let name = uri.path().trim_start_matches('/');
    page::file(name).unwrap_or_else(|| StatusCode::NOT_FOUND.into_response())
}

const JSON: HeaderValue = HeaderValue::from_static("application/json");

/// What `answer` says, worked out on another thread; only its tag where the browser has it already.
async fn json(headers: &HeaderMap, answer: impl FnOnce() -> Answer + Send + 'static) -> Response {
    let answer = tokio::task::spawn_blocking(answer).await;
    let answer = answer.unwrap_or_else(|panic| Err(Refusal::Failed(panic.to_string())));
    match answer {
        Ok(bytes) => {
            let tag = tag(&bytes);
            if headers.get(IF_NONE_MATCH) == Some(&tag) {
                return (StatusCode::NOT_MODIFIED, [(ETAG, tag)]).into_response();
            }
            ([(CONTENT_TYPE, JSON), (ETAG, tag)], Bytes::from_owner(bytes)).into_response()
        }
        Err(refusal) => {
            let status = match refusal {
                Refusal::Unknown(_) => StatusCode::NOT_FOUND,
                Refusal::Unfit(_) => StatusCode::UNPROCESSABLE_ENTITY,
                Refusal::Failed(_) => StatusCode::INTERNAL_SERVER_ERROR,
            };
            let body = serde_json::json!({ "error": refusal.to_string() }).to_string();
            (status, [(CONTENT_TYPE, JSON)], body).into_response()
        }
    }
}

fn tag(bytes: &[u8]) -> HeaderValue {
    let mut hasher = DefaultHasher::new();
    bytes.hash(&mut hasher);
    HeaderValue::from_str(&format!("\"{:016x}\"", hasher.finish())).expect("digits are a header")
}

/// Headers that keep a browser from running or fetching anything that is not of this page.
const HARDENED: [(HeaderName, &str); 3] = [
    (
        CONTENT_SECURITY_POLICY,
        "default-src 'self'; img-src 'self' data: blob:; frame-ancestors 'none'",
    ),
    (X_CONTENT_TYPE_OPTIONS, "nosniff"),
    (CACHE_CONTROL, "no-cache"),
];

async fn hardened(mut response: Response) -> Response {
    for (name, value) in HARDENED {
        response.headers_mut().insert(name, HeaderValue::from_static(value));
    }
    response
}

/// How a browser says from where a request comes.
const FETCH_SITE: HeaderName = HeaderName::from_static("sec-fetch-site");

/// Refuses what a browser was led to send here by the page of another site.
async fn from_this_machine(request: Request, next: Next) -> Response {
    let headers = request.headers();
    let host = headers.get(HOST).and_then(|host| host.to_str().ok()).unwrap_or_default();
    if !is_this_machine(host) {
        let words = "this server answers to localhost alone; see pneumorph monitor --help\n";
        return (StatusCode::FORBIDDEN, words).into_response();
    }
    if headers.get(FETCH_SITE).is_some_and(|site| site == "cross-site") {
        return (StatusCode::FORBIDDEN, "not for the pages of other sites\n").into_response();
    }
    next.run(request).await
}

/// Whether `host`, a name or address with or without a port, is this machine as it calls itself.
fn is_this_machine(host: &str) -> bool {
    let name = match host.rsplit_once(':') {
        Some((name, port)) if port.bytes().all(|digit| digit.is_ascii_digit()) => name,
        _ => host,
    };
    let address = name.trim_start_matches('[').trim_end_matches(']').parse::<IpAddr>();
    name.eq_ignore_ascii_case("localhost") || address.is_ok_and(|address| address.is_loopback())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hosts_are_told_apart() {
        for ours in
            ["localhost", "LOCALHOST:80", "127.0.0.1:8737", "127.1.2.3", "[::1]:8737", "[::1]"]
        {
            assert!(is_this_machine(ours), "{ours}");
        }
        for other in [
            "",
            "example.org",
            "localhost.example.org:80",
            "192.168.0.7:8737",
            "[::2]:1",
            "127.0.0.1.nip.io",
        ] {
            assert!(!is_this_machine(other), "{other}");
        }
    }
}
