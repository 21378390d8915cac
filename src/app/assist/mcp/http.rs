//! MCP over HTTP on a loopback address, for clients that show a token. Each request stands alone: there are no sessions, the
//! scene is the service's.

use std::convert::Infallible;
use std::net::{SocketAddr, TcpListener};
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::Duration;

use anyhow::{Context, bail};
use http_body_util::combinators::BoxBody;
use http_body_util::{BodyExt, Full};
use hyper::body::{Bytes, Incoming};
use hyper::header::{AUTHORIZATION, CONTENT_TYPE, HeaderValue, WWW_AUTHENTICATE};
use hyper::service::service_fn;
use hyper::{Request, Response, StatusCode};
use hyper_util::rt::{TokioIo, TokioTimer};
use rmcp::transport::streamable_http_server::session::local::LocalSessionManager;
use rmcp::transport::{StreamableHttpServerConfig, StreamableHttpService};
use tokio::sync::{Semaphore, oneshot};

use super::server::Server;
use crate::LONGEST_CALL;
use crate::service::Service;

/// Where clients ask.
const PATH: &str = "/mcp";
/// Shortest token, bytes.
const SHORTEST_TOKEN: usize = 16;
/// Connections at the same time; more wait.
const MOST_CONNECTIONS: usize = 64;
/// How long a client may take to say what it wants.
const HEADERS_WITHIN: Duration = Duration::from_secs(10);
/// What a message may have around the arguments of its call, bytes.
const ENVELOPE: usize = 4096;

/// A running server. It ends when it is dropped.
pub struct Http {
    /// Where it listens.
    pub address: SocketAddr,
    stop: Option<oneshot::Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Http {
    /// What a client is told: `http://127.0.0.1:7333/mcp`.
    pub fn url(&self) -> String {
        format!("http://{}{PATH}", self.address)
    }

    /// Waits until it ends, which it does not by itself.
    pub fn wait(mut self) {
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

impl Drop for Http {
    fn drop(&mut self) {
        if let Some(stop) = self.stop.take() {
            let _ = stop.send(());
        }
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// A token that nobody can guess: 32 hexadecimal digits.
pub fn random_token() -> anyhow::Result<String> {
    let mut bytes = [0; 16];
    getrandom::fill(&mut bytes).context("draw a token")?;
    Ok(bytes.iter().map(|b| format!("{b:02x}")).collect())
}

/// Serves a service on an address of this machine (port 0: any free one) to clients that send `Authorization: Bearer TOKEN`.
/// Errors in one line if the address is not a loopback one or is taken, or if the token is short.
pub fn http(service: Service, listen: SocketAddr, token: String) -> anyhow::Result<Http> {
    if !listen.ip().is_loopback() {
        bail!(
            "{listen} can be reached from other machines, expected a loopback address such as 127.0.0.1:7333"
        );
    }
    let plain = token.bytes().all(|b| b.is_ascii_graphic());
    if token.len() < SHORTEST_TOKEN || !plain {
        let found = token.len();
        bail!("the token has {found} bytes, expected at least {SHORTEST_TOKEN} letters, digits or signs");
    }
    let listener = TcpListener::bind(listen).with_context(|| format!("listen on {listen}"))?;
    listener.set_nonblocking(true).context("listen")?;
    let address = listener.local_addr().context("listen")?;
    let (stop, stopped) = oneshot::channel();
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build()
        .context("start the server")?;
    let thread = std::thread::Builder::new()
        .name("mcp http".into())
        .spawn(move || {
            runtime.block_on(async {
                tokio::select! {
                    _ = accept(listener, service, &token) => {}
                    _ = stopped => {}
                }
            });
        })
        .context("start the server")?;
    Ok(Http {
        address,
        stop: Some(stop),
        thread: Some(thread),
    })
}

type Mcp = StreamableHttpService<Server, LocalSessionManager>;

async fn accept(listener: TcpListener, service: Service, token: &str) {
    let Ok(listener) = tokio::net::TcpListener::from_std(listener) else {
        return;
    };
    let config = StreamableHttpServerConfig::default()
        .with_legacy_session_mode(false)
        .with_json_response(true)
        .enforce_origin_validation() // no page of a browser
        .with_max_request_body_bytes(LONGEST_CALL + ENVELOPE);
    let server = Server::new(service);
    let mcp = Mcp::new(move || Ok(server.clone()), Arc::default(), config);
    let expected: Arc<str> = format!("Bearer {token}").into();
    let places = Arc::new(Semaphore::new(MOST_CONNECTIONS));
    loop {
        let Ok(place) = places.clone().acquire_owned().await else {
            return;
        };
        let Ok((stream, _)) = listener.accept().await else {
            // (no file handle is left, or the client went: others may do better a little later)
            tokio::time::sleep(Duration::from_millis(50)).await;
            continue;
        };
        let (mcp, expected) = (mcp.clone(), expected.clone());
        tokio::spawn(async move {
            let answer = service_fn(|request: Request<Incoming>| {
                let (mcp, expected) = (mcp.clone(), expected.clone());
                async move {
                    if request.uri().path() != PATH {
                        return Ok::<_, Infallible>(refused(StatusCode::NOT_FOUND, "expected the path /mcp"));
                    }
                    if !shows(&request, &expected) {
                        let why = "expected the header Authorization: Bearer with the token of this server";
                        return Ok(refused(StatusCode::UNAUTHORIZED, why));
                    }
                    Ok(mcp.handle(request).await)
                }
            });
            let served = hyper::server::conn::http1::Builder::new()
                .timer(TokioTimer::new())
                .header_read_timeout(HEADERS_WITHIN)
                .serve_connection(TokioIo::new(stream), answer)
                .await;
            drop((served, place));
        });
    }
}

/// A refusal in one line.
fn refused(status: StatusCode, why: &'static str) -> Response<BoxBody<Bytes, Infallible>> {
    let mut response = Response::new(Full::new(Bytes::from_static(why.as_bytes())).boxed());
    *response.status_mut() = status;
    let headers = response.headers_mut();
    headers.insert(CONTENT_TYPE, HeaderValue::from_static("text/plain"));
    if status == StatusCode::UNAUTHORIZED {
        headers.insert(WWW_AUTHENTICATE, HeaderValue::from_static("Bearer"));
    }
    response
}

/// True if a request shows the token. Takes the same time for every token of the right length.
fn shows(request: &Request<Incoming>, expected: &str) -> bool {
    let Some(shown) = request.headers().get(AUTHORIZATION) else {
        return false;
    };
    let (shown, expected) = (shown.as_bytes(), expected.as_bytes());
    let differs = shown.iter().zip(expected).fold(0, |d, (a, b)| d | (a ^ b));
    shown.len() == expected.len() && differs == 0
}
