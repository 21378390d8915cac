//! MCP over HTTP on a loopback address, for clients that show a token. Each request stands alone: there are no sessions, the
//! scene is the service's.

use std::convert::Infallible;
use std::net::{SocketAddr, TcpListener};
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::Duration;

use anyhow::{Context, bail};
use callers::{Caller, CallerLimits, Callers, Sending, Wait};
use http_body_util::combinators::BoxBody;
use http_body_util::{BodyExt, Full, LengthLimitError, Limited};
use hyper::body::{Body, Bytes, Incoming};
use hyper::header::{AUTHORIZATION, CONNECTION, CONTENT_TYPE, HeaderValue, WWW_AUTHENTICATE};
use hyper::service::service_fn;
use hyper::{Request, Response, StatusCode};
use hyper_util::rt::{TokioIo, TokioTimer};
use rmcp::transport::streamable_http_server::session::local::LocalSessionManager;
use rmcp::transport::{StreamableHttpServerConfig, StreamableHttpService};
use tokio::sync::oneshot;

use super::server::Server;
use crate::LONGEST_CALL;
use crate::service::Service;

/// Path of the server's URL.
const PATH: &str = "/mcp";
/// Shortest token, bytes.
const SHORTEST_TOKEN: usize = 16;
/// Longest body, bytes: a call and the message around it.
const LONGEST_BODY: usize = LONGEST_CALL + 4096;
/// Connections, bodies and answers: how many of each wait, and for how long. A stranger is a connection that has not
/// shown the token.
const CALLERS: CallerLimits = CallerLimits {
    strangers: Wait {
        most: 128,
        within: Duration::from_secs(10),
    },
    idle: Wait {
        most: 64,
        within: Duration::from_secs(60),
    },
    reading: Wait {
        most: 64,
        within: Duration::from_secs(30),
    },
    sending: Wait {
        most: 64,
        within: Duration::from_secs(120),
    },
};

/// A running server. It ends when it is dropped.
pub struct Http {
    /// Address on which the server listens.
    pub address: SocketAddr,
    stop: Option<oneshot::Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Http {
    /// The URL for clients: `http://127.0.0.1:7333/mcp`.
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

/// A random token that cannot be guessed: 32 hexadecimal digits.
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
    let listener = callers::listen(listen).with_context(|| format!("listen on {listen}"))?;
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
type McpResponse = Response<Sending<BoxBody<Bytes, Infallible>>>;

/// State that connections share.
#[derive(Clone)]
struct McpEndpoint {
    mcp: Mcp,
    /// Expected value of the `Authorization` header, with the token.
    expected: Arc<str>,
}

async fn accept(listener: TcpListener, service: Service, token: &str) {
    let Ok(listener) = tokio::net::TcpListener::from_std(listener) else {
        return;
    };
    let config = StreamableHttpServerConfig::default()
        .with_legacy_session_mode(false)
        .with_json_response(true)
        .enforce_origin_validation() // no page of a browser
        .with_max_request_body_bytes(LONGEST_BODY);
    let server = Server::new(service);
    let door = McpEndpoint {
        mcp: Mcp::new(move || Ok(server.clone()), Arc::default(), config),
        expected: format!("Bearer {token}").into(),
    };
    let callers = Callers::new(CALLERS);
    let deadlines = callers.clone();
    tokio::spawn(async move { deadlines.keep_deadlines().await });
    loop {
        let connection = callers.accept(&listener).await;
        let (door, caller) = (door.clone(), connection.caller().clone());
        tokio::spawn(async move {
            let answer = service_fn(|request| {
                let (door, caller) = (door.clone(), caller.clone());
                async move { Ok::<_, Infallible>(door.answer(&caller, request).await) }
            });
            let served = hyper::server::conn::http1::Builder::new()
                .timer(TokioTimer::new())
                .header_read_timeout(CALLERS.strangers.within)
                .serve_connection(TokioIo::new(connection), answer)
                .await;
            // (if a connection ends with an error, no client is left to report it to)
            drop(served);
        });
    }
}

impl McpEndpoint {
    async fn answer(&self, caller: &Arc<Caller>, request: Request<Incoming>) -> McpResponse {
        if request.uri().path() != PATH {
            return refused(StatusCode::NOT_FOUND, "expected the path /mcp");
        }
        if !shows(&request, &self.expected) {
            let why = "expected the header Authorization: Bearer with the token of this server";
            return refused(StatusCode::UNAUTHORIZED, why);
        }
        let asking = Arc::new(caller.asks());
        let (head, body) = request.into_parts();
        let body = match read(body, caller.callers()).await {
            Ok(body) => body,
            Err((status, why)) => return refused(status, why),
        };
        asking.is_read();
        let answer = self.mcp.handle(Request::from_parts(head, Full::new(body))).await;
        answer.map(|body| Sending::new(body, asking))
    }
}

/// A body, read whole before it is handled: a body that does not come must not hold resources that others need.
async fn read(body: Incoming, callers: &Callers) -> Result<Bytes, (StatusCode, &'static str)> {
    const TOO_LONG: &str = "the message is too long, expected at most 1 MiB";
    if body.size_hint().lower() > LONGEST_BODY as u64 {
        return Err((StatusCode::PAYLOAD_TOO_LARGE, TOO_LONG));
    }
    let (late, _place) = callers.reading();
    let read = tokio::select! {
        biased;
        read = Limited::new(body, LONGEST_BODY).collect() => read,
        () = late.told() => {
            let why = "the body did not come whole in time, expected all of it within 30 s";
            return Err((StatusCode::REQUEST_TIMEOUT, why));
        }
    };
    match read {
        Ok(whole) => Ok(whole.to_bytes()),
        Err(error) if error.is::<LengthLimitError>() => Err((StatusCode::PAYLOAD_TOO_LARGE, TOO_LONG)),
        Err(_) => Err((StatusCode::BAD_REQUEST, "the body broke off")),
    }
}

/// A refusal in one line, and the end of the connection.
fn refused(status: StatusCode, why: &'static str) -> McpResponse {
    let body = Full::new(Bytes::from_static(why.as_bytes())).boxed();
    let mut response = Response::new(Sending::short(body));
    *response.status_mut() = status;
    let headers = response.headers_mut();
    headers.insert(CONTENT_TYPE, HeaderValue::from_static("text/plain"));
    headers.insert(CONNECTION, HeaderValue::from_static("close"));
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
