//! Listens, and answers until it is told to end.

use std::io;
use std::net::{SocketAddr, TcpListener};
use std::path::PathBuf;
use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll};
use std::time::Duration;

use anyhow::Context as _;
use callers::{Caller, Callers, Connection};
use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::sync::mpsc;
use tokio_stream::wrappers::ReceiverStream;
use tonic::transport::server::Connected;

use crate::gate::Gate;
use crate::limits::{CALLERS, MOST_STREAMS};
use crate::renderer::{Renderer, ServerLidarModel};
use crate::service::Service;
use sensors::pictures::appearance::Quality;

/// A client that does not answer a ping for so long is gone.
const PING_EVERY: Duration = Duration::from_secs(30);
const PONG_WITHIN: Duration = Duration::from_secs(20);
/// How long requests that are inside may take once the server ends.
const END_WITHIN: Duration = Duration::from_secs(10);

/// Options of a server: the scenes, its address, and bounds.
#[derive(Clone, Debug)]
pub struct Options {
    /// Scenes, and folders of scenes.
    pub scenes: Vec<PathBuf>,
    /// Address to listen on; port 0 stands for any free one.
    pub listen: SocketAddr,
    /// Requests that are rendered at a time, at least one.
    pub jobs: usize,
    /// Requests that wait at most; more are refused.
    pub waiting: usize,
    /// Scenes that are kept in memory.
    pub kept: usize,
    /// How sweeps come about.
    pub lidar: ServerLidarModel,
    /// Effort for pictures.
    pub quality: Quality,
}

impl Options {
    /// Two jobs, 64 that wait, 4 scenes, learned sweeps, full pictures, on the port that AlpaSim's runtime asks first.
    pub fn new(scenes: Vec<PathBuf>) -> Self {
        Self {
            scenes,
            listen: SocketAddr::from(([127, 0, 0, 1], 50051)),
            jobs: 2,
            waiting: 64,
            kept: 4,
            lidar: ServerLidarModel::default(),
            quality: Quality::Full,
        }
    }
}

/// A server that listens already.
pub struct Server {
    listener: TcpListener,
    service: Service,
    jobs: usize,
    scenes: usize,
}

impl Server {
    /// Lists the scenes and takes the address. Errors in one line if there is no scene, or the address cannot be had.
    pub fn bind(options: Options) -> anyhow::Result<Self> {
        let jobs = options.jobs.max(1);
        // One prepared moment per job: the cameras of a session ask for the same one after another.
        let renderer = Renderer::new(
            &options.scenes,
            options.kept,
            jobs,
            (options.lidar, options.quality),
        )?;
        let scenes = renderer.scenes.len();
        Ok(Self {
            listener: callers::listen(options.listen)
                .with_context(|| format!("listen on {}", options.listen))?,
            service: Service::new(renderer, Gate::new(jobs, options.waiting)),
            jobs,
            scenes,
        })
    }

    /// The address on which it listens. Errors if the system cannot tell.
    pub fn address(&self) -> anyhow::Result<SocketAddr> {
        self.listener.local_addr().context("listen")
    }

    /// How many scenes it offers.
    pub fn scenes(&self) -> usize {
        self.scenes
    }

    /// Answers until `end` is ready; requests that are inside then are still answered, if it does not take long. Errors in one line
    /// if the system gives no thread.
    pub fn run(self, end: impl Future<Output = ()>) -> anyhow::Result<()> {
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .max_blocking_threads(self.jobs + 1)
            .build()
            .context("start the server")?;
        let served = runtime.block_on(serve(self.listener, self.service, end));
        runtime.shutdown_timeout(Duration::from_millis(100));
        served
    }

    /// Answers until the process is told to end by Ctrl-C or SIGTERM. Errors as [`Self::run`].
    pub fn run_until_signal(self) -> anyhow::Result<()> {
        self.run(signal())
    }
}

/// Ready when the process is told to end; never where the system sends no signals.
async fn signal() {
    #[cfg(unix)]
    {
        use tokio::signal::unix::{SignalKind, signal};
        if let Ok(mut terminate) = signal(SignalKind::terminate()) {
            tokio::select! {
                _ = terminate.recv() => {}
                told = tokio::signal::ctrl_c() => if told.is_err() { std::future::pending().await },
            }
            return;
        }
    }
    if tokio::signal::ctrl_c().await.is_err() {
        std::future::pending().await
    }
}

async fn serve(listener: TcpListener, service: Service, end: impl Future<Output = ()>) -> anyhow::Result<()> {
    let listener = tokio::net::TcpListener::from_std(listener).context("listen")?;
    let (send, incoming) = mpsc::channel(1);
    let callers = Callers::new(CALLERS);
    let accepting = tokio::spawn(accept(listener, callers.clone(), send));
    let deadlines = tokio::spawn(async move { callers.keep_deadlines().await });
    let (ended, told) = tokio::sync::oneshot::channel::<()>();
    let serving = tonic::transport::Server::builder()
        .max_concurrent_streams(MOST_STREAMS)
        .http2_keepalive_interval(Some(PING_EVERY))
        .http2_keepalive_timeout(Some(PONG_WITHIN))
        .serve_with_incoming_shutdown(service, ReceiverStream::new(incoming), async {
            let _ = told.await;
        });
    tokio::pin!(serving);
    tokio::select! {
        served = &mut serving => return served.context("serve"),
        _ = end => {}
    }
    accepting.abort();
    let _ = ended.send(());
    // Requests that take longer are dropped.
    let _ = tokio::time::timeout(END_WITHIN, serving).await;
    deadlines.abort();
    Ok(())
}

/// Takes connections. A silent one makes room for a new one.
async fn accept(
    listener: tokio::net::TcpListener,
    callers: Callers,
    send: mpsc::Sender<io::Result<Incoming>>,
) {
    loop {
        let connection = callers.accept(&listener).await;
        if send.send(Ok(Incoming(connection))).await.is_err() {
            return;
        }
    }
}

/// A connection that tells its requests whose they are.
struct Incoming(Connection);

impl Connected for Incoming {
    type ConnectInfo = Arc<Caller>;

    fn connect_info(&self) -> Arc<Caller> {
        self.0.caller().clone()
    }
}

impl AsyncRead for Incoming {
    fn poll_read(self: Pin<&mut Self>, c: &mut Context<'_>, into: &mut ReadBuf<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.get_mut().0).poll_read(c, into)
    }
}

impl AsyncWrite for Incoming {
    fn poll_write(self: Pin<&mut Self>, c: &mut Context<'_>, bytes: &[u8]) -> Poll<io::Result<usize>> {
        Pin::new(&mut self.get_mut().0).poll_write(c, bytes)
    }

    fn poll_flush(self: Pin<&mut Self>, c: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.get_mut().0).poll_flush(c)
    }

    fn poll_shutdown(self: Pin<&mut Self>, c: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.get_mut().0).poll_shutdown(c)
    }

    fn poll_write_vectored(
        self: Pin<&mut Self>,
        c: &mut Context<'_>,
        bytes: &[io::IoSlice<'_>],
    ) -> Poll<io::Result<usize>> {
        Pin::new(&mut self.get_mut().0).poll_write_vectored(c, bytes)
    }

    fn is_write_vectored(&self) -> bool {
        self.0.is_write_vectored()
    }
}
