//! Requests over the network.

use std::net::SocketAddr;
use std::path::Path;
use std::thread::JoinHandle;
use std::time::Duration;

use tokio::sync::oneshot;
use tonic::transport::{Channel, Endpoint};
use tonic::{Code, Status};
use tonic_prost::ProstCodec;

use crate::fixture::{self, own_picture};
use crate::limits::MOST_ANSWER_BYTES;
use crate::renderer::ServerLidarModel;
use crate::server::{Options, Server};
use crate::wire::{AvailableScenesReturn, Empty, RgbRenderRequest, RgbRenderReturn, SERVICE, VersionId};

/// A server that ends when it is dropped.
struct Running {
    address: SocketAddr,
    end: Option<oneshot::Sender<()>>,
    thread: Option<JoinHandle<anyhow::Result<()>>>,
}

impl Running {
    fn start(folder: &Path, jobs: usize, waiting: usize) -> Self {
        let server = Server::bind(Options {
            listen: SocketAddr::from(([127, 0, 0, 1], 0)),
            jobs,
            waiting,
            lidar: ServerLidarModel::Exact,
            ..Options::new(vec![folder.to_owned()])
        });
        let server = server.expect("a server");
        let address = server.address().expect("an address");
        let (end, told) = oneshot::channel();
        let thread = std::thread::spawn(move || {
            server.run(async {
                let _ = told.await;
            })
        });
        Self {
            address,
            end: Some(end),
            thread: Some(thread),
        }
    }

    fn channel(&self) -> Channel {
        let endpoint = Endpoint::from_shared(format!("http://{}", self.address));
        endpoint.expect("an address").connect_lazy()
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        drop(self.end.take());
        if let Some(thread) = self.thread.take() {
            let ended = thread.join().expect("no panic");
            assert!(ended.is_ok(), "{ended:?}");
        }
    }
}

fn block_on<T>(future: impl Future<Output = T>) -> T {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    runtime.expect("a runtime").block_on(future)
}

async fn ask<Q, A>(channel: &Channel, method: &str, request: Q) -> Result<A, Status>
where
    Q: prost::Message + 'static,
    A: prost::Message + Default + 'static,
{
    let mut grpc = tonic::client::Grpc::new(channel.clone()).max_decoding_message_size(MOST_ANSWER_BYTES);
    let ready = tokio::time::timeout(Duration::from_secs(60), grpc.ready()).await;
    ready
        .expect("in time")
        .map_err(|e| Status::unavailable(e.to_string()))?;
    let path = format!("/{SERVICE}/{method}").parse().expect("a path");
    let answer = grpc
        .unary(tonic::Request::new(request), path, ProstCodec::<Q, A>::default())
        .await;
    answer.map(tonic::Response::into_inner)
}

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    fixture::write(folder.path());
    folder
}

#[test]
fn many_sessions_get_what_one_gets() {
    let folder = folder();
    let running = Running::start(folder.path(), 2, 64);
    let requests: Vec<RgbRenderRequest> = [("still", fixture::still()), ("clip", fixture::clip())]
        .iter()
        .flat_map(|(name, scene)| {
            [0, 500_000].map(|at| RgbRenderRequest {
                frame_start_us: at,
                frame_end_us: at + 1,
                ..own_picture(name, scene)
            })
        })
        .collect();
    block_on(async {
        let channel = running.channel();
        let mut serial = Vec::new();
        for request in &requests {
            let made: RgbRenderReturn = ask(&channel, "render_rgb", request.clone())
                .await
                .expect("a picture");
            serial.push(made.image_bytes);
        }
        let mut all = Vec::new();
        for i in 0..16 {
            let (channel, requests) = (running.channel(), requests.clone());
            all.push(tokio::spawn(async move {
                let mut made = Vec::new();
                for j in 0..requests.len() {
                    let at = (i + j) % requests.len();
                    let one = ask::<_, RgbRenderReturn>(&channel, "render_rgb", requests[at].clone()).await;
                    made.push((at, one.expect("a picture").image_bytes));
                }
                made
            }));
        }
        for one in all {
            for (at, bytes) in one.await.expect("no panic") {
                assert!(bytes == serial[at], "request {at}");
            }
        }
    });
}

#[test]
fn a_full_server_refuses_at_once_and_lives_on() {
    let folder = folder();
    let running = Running::start(folder.path(), 1, 1);
    let request = own_picture("still", &fixture::still());
    block_on(async {
        let channel = running.channel();
        let mut all = Vec::new();
        for _ in 0..12 {
            let (channel, request) = (channel.clone(), request.clone());
            all.push(tokio::spawn(async move {
                ask::<_, RgbRenderReturn>(&channel, "render_rgb", request).await
            }));
        }
        // What needs no rendering is answered whatever waits.
        let version: VersionId = ask(&channel, "get_version", Empty {}).await.expect("a version");
        assert!(version.version_id.starts_with("sceneloom "));
        assert_eq!(version.grpc_api_version.map(|v| v.minor), Some(54));
        let (mut made, mut refused) = (0, 0);
        for one in all {
            match one.await.expect("no panic") {
                Ok(_) => made += 1,
                Err(error) => {
                    assert_eq!(error.code(), Code::ResourceExhausted, "{error}");
                    refused += 1;
                }
            }
        }
        assert!(made >= 2 && refused >= 1, "{made} made, {refused} refused");
        let again = ask::<_, RgbRenderReturn>(&channel, "render_rgb", request).await;
        assert!(again.is_ok(), "places are free again");
    });
}

#[test]
fn what_is_no_request_is_refused() {
    let folder = folder();
    let running = Running::start(folder.path(), 1, 8);
    block_on(async {
        let channel = running.channel();
        let unknown = ask::<_, Empty>(&channel, "make_coffee", Empty {}).await;
        assert_eq!(unknown.expect_err("unknown").code(), Code::Unimplemented);
        let scenes: AvailableScenesReturn = ask(&channel, "get_available_scenes", Empty {})
            .await
            .expect("scenes");
        assert_eq!(scenes.scene_ids, ["clip", "still"]);
        let long = RgbRenderRequest {
            scene_id: "x".repeat(5 << 20),
            ..RgbRenderRequest::default()
        };
        let long = ask::<_, RgbRenderReturn>(&channel, "render_rgb", long).await;
        assert!(matches!(
            long.expect_err("too long").code(),
            Code::OutOfRange | Code::ResourceExhausted
        ));
        // Bytes that are no HTTP/2 end their own connection alone.
        use tokio::net::TcpStream;
        for junk in [&b"GET / HTTP/1.1\r\n\r\n"[..], &[0xff; 4096]] {
            let stream = TcpStream::connect(running.address).await.expect("a connection");
            stream.writable().await.expect("writable");
            stream.try_write(junk).expect("written");
        }
        let version = ask::<_, VersionId>(&channel, "get_version", Empty {}).await;
        assert!(version.is_ok());
    });
}
