//! The service as HTTP/2 hands it requests: each method by its path, with a place inside for all that is rendered. Places are taken
//! by requests that were read whole, never by those that are still to come.

use std::convert::Infallible;
use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll};

use callers::{Asking, Caller, CallerPlace, Sending};
use tonic::server::UnaryService;
use tonic::{Request, Response, Status};
use tonic_prost::ProstCodec;

use crate::gate::Gate;
use crate::limits::{MOST_ANSWER_BYTES, MOST_REQUEST_BYTES};
use crate::renderer::Renderer;
use crate::wire::SERVICE;
use crate::{lidar, offers, picture, several};

/// A request that says nothing but a name, bytes at most.
const SHORT_REQUEST_BYTES: usize = 64 << 10;

/// Why a request whose body does not come is refused.
const LATE: &str =
    "the request did not come whole in time, expected all of it within 30 s, or sooner where many others ask";

type Later<T> = Pin<Box<dyn Future<Output = T> + Send>>;
type RpcRequest = http::Request<tonic::body::Body>;
type RpcResponse = http::Response<Sending<tonic::body::Body>>;

/// Answers requests.
#[derive(Clone)]
pub struct Service {
    renderer: Arc<Renderer>,
    gate: Gate,
}

/// Work of a method, on a thread that may block.
type RpcHandler<Q, A> = fn(&Renderer, &Q) -> Result<A, Status>;

/// A method with its resources.
struct RpcMethod<Q, A> {
    renderer: Arc<Renderer>,
    /// Place that is held until the request is read.
    reading: Option<CallerPlace>,
    asking: Arc<Asking>,
    /// Gate; `None` for methods that are answered at once.
    gate: Option<Gate>,
    work: RpcHandler<Q, A>,
}

impl<Q: Send + Sync + 'static, A: Send + 'static> UnaryService<Q> for RpcMethod<Q, A> {
    type Response = A;
    type Future = Later<Result<Response<A>, Status>>;

    fn call(&mut self, request: Request<Q>) -> Self::Future {
        self.reading = None;
        self.asking.is_read();
        let (renderer, gate, work) = (self.renderer.clone(), self.gate.clone(), self.work);
        let asked = request.into_inner();
        Box::pin(async move {
            let made = match gate {
                Some(gate) => {
                    let _place = gate.enter()?;
                    gate.run(move || work(&renderer, &asked)).await?
                }
                None => work(&renderer, &asked)?,
            };
            Ok(Response::new(made))
        })
    }
}

impl Service {
    /// Makes a service of a renderer, behind a gate.
    pub fn new(renderer: Renderer, gate: Gate) -> Self {
        Self {
            renderer: Arc::new(renderer),
            gate,
        }
    }

    /// Answers at once.
    fn told<Q, A>(&self, request: RpcRequest, work: RpcHandler<Q, A>) -> Later<RpcResponse>
    where
        Q: prost::Message + Default + 'static,
        A: prost::Message + Default + 'static,
    {
        Box::pin(answer(
            self.renderer.clone(),
            None,
            work,
            request,
            SHORT_REQUEST_BYTES,
        ))
    }

    /// Answers when it is its turn; refuses before the request is read where there is no place.
    fn made<Q, A>(&self, request: RpcRequest, longest: usize, work: RpcHandler<Q, A>) -> Later<RpcResponse>
    where
        Q: prost::Message + Default + 'static,
        A: prost::Message + Default + 'static,
    {
        if let Err(full) = self.gate.enter() {
            return Box::pin(async move { refused(full) });
        }
        let gate = Some(self.gate.clone());
        Box::pin(answer(self.renderer.clone(), gate, work, request, longest))
    }
}

async fn answer<Q, A>(
    renderer: Arc<Renderer>,
    gate: Option<Gate>,
    work: RpcHandler<Q, A>,
    request: RpcRequest,
    longest: usize,
) -> RpcResponse
where
    Q: prost::Message + Default + 'static,
    A: prost::Message + Default + 'static,
{
    let Some(caller) = request.extensions().get::<Arc<Caller>>() else {
        return refused(Status::internal(
            "the request came over no connection of this server",
        ));
    };
    let asking = Arc::new(caller.asks());
    let (late, reading) = caller.callers().reading();
    let method = RpcMethod {
        renderer,
        reading: Some(reading),
        asking: asking.clone(),
        gate,
        work,
    };
    let codec = ProstCodec::<A, Q>::default();
    let mut grpc = tonic::server::Grpc::new(codec)
        .max_decoding_message_size(longest)
        .max_encoding_message_size(MOST_ANSWER_BYTES);
    let response = tokio::select! {
        biased;
        response = grpc.unary(method, request) => response,
        () = late.told() => return refused(Status::deadline_exceeded(LATE)),
    };
    response.map(|body| Sending::new(body, asking))
}

fn refused(status: Status) -> RpcResponse {
    status.into_http::<tonic::body::Body>().map(Sending::short)
}

impl tower_service::Service<http::Request<tonic::body::Body>> for Service {
    type Response = RpcResponse;
    type Error = Infallible;
    type Future = Later<Result<RpcResponse, Infallible>>;

    fn poll_ready(&mut self, _: &mut Context<'_>) -> Poll<Result<(), Infallible>> {
        Poll::Ready(Ok(()))
    }

    fn call(&mut self, request: RpcRequest) -> Self::Future {
        let path = request.uri().path();
        let method = path.strip_prefix('/').and_then(|p| p.strip_prefix(SERVICE));
        let answer = match method.unwrap_or_default() {
            "/render_rgb" => self.made(request, MOST_REQUEST_BYTES, picture::render),
            "/render_lidar" => self.made(request, MOST_REQUEST_BYTES, lidar::render),
            "/render_aggregated" => self.made(request, MOST_REQUEST_BYTES, several::aggregated),
            "/batch_render_rgb" => self.made(request, MOST_REQUEST_BYTES, several::batch),
            "/get_available_cameras" => self.made(request, SHORT_REQUEST_BYTES, offers::cameras),
            "/get_available_trajectories" => self.made(request, SHORT_REQUEST_BYTES, offers::trajectories),
            "/get_available_scenes" => self.told(request, offers::scenes),
            "/get_available_ego_masks" => self.told(request, offers::ego_masks),
            "/get_version" => self.told(request, offers::version),
            _ => {
                let path: String = path.chars().take(120).collect();
                let unknown = Status::unimplemented(format!("no method {path}, expected one of {SERVICE}"));
                Box::pin(async move { refused(unknown) })
            }
        };
        Box::pin(async move { Ok(answer.await) })
    }
}
