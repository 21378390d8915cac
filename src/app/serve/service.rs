//! The service as HTTP/2 hands it requests: each method by its path, with a place inside for all that is rendered.

use std::convert::Infallible;
use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll};

use http_body::{Body, Frame, SizeHint};
use tokio::sync::OwnedSemaphorePermit;
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

type Later<T> = Pin<Box<dyn Future<Output = T> + Send>>;
type Answer = http::Response<Held>;

/// Answers requests.
#[derive(Clone)]
pub struct Service {
    renderer: Arc<Renderer>,
    gate: Gate,
}

/// The body of an answer, and its place inside until it is sent.
pub struct Held {
    body: tonic::body::Body,
    _place: Option<OwnedSemaphorePermit>,
}

impl Body for Held {
    type Data = <tonic::body::Body as Body>::Data;
    type Error = Status;

    fn poll_frame(
        self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Self::Data>, Self::Error>>> {
        Pin::new(&mut self.get_mut().body).poll_frame(context)
    }

    fn is_end_stream(&self) -> bool {
        self.body.is_end_stream()
    }

    fn size_hint(&self) -> SizeHint {
        self.body.size_hint()
    }
}

/// What a method does, on a thread that may block.
type Work<Q, A> = fn(&Renderer, &Q) -> Result<A, Status>;

/// A method with what it needs.
struct Method<Q, A> {
    renderer: Arc<Renderer>,
    /// None for what is answered at once.
    gate: Option<Gate>,
    work: Work<Q, A>,
}

impl<Q: Send + Sync + 'static, A: Send + 'static> UnaryService<Q> for Method<Q, A> {
    type Response = A;
    type Future = Later<Result<Response<A>, Status>>;

    fn call(&mut self, request: Request<Q>) -> Self::Future {
        let (renderer, gate, work) = (self.renderer.clone(), self.gate.clone(), self.work);
        let asked = request.into_inner();
        Box::pin(async move {
            let made = match gate {
                Some(gate) => gate.run(move || work(&renderer, &asked)).await?,
                None => work(&renderer, &asked)?,
            };
            Ok(Response::new(made))
        })
    }
}

impl Service {
    /// Of a renderer, behind a gate.
    pub fn new(renderer: Renderer, gate: Gate) -> Self {
        Self {
            renderer: Arc::new(renderer),
            gate,
        }
    }

    /// Answers at once.
    fn told<Q, A>(&self, request: http::Request<tonic::body::Body>, work: Work<Q, A>) -> Later<Answer>
    where
        Q: prost::Message + Default + 'static,
        A: prost::Message + Default + 'static,
    {
        let method = Method {
            renderer: self.renderer.clone(),
            gate: None,
            work,
        };
        Box::pin(answer(method, request, SHORT_REQUEST_BYTES, None))
    }

    /// Answers when it is its turn; refuses before the request is read where there is no place.
    fn made<Q, A>(
        &self,
        request: http::Request<tonic::body::Body>,
        longest: usize,
        work: Work<Q, A>,
    ) -> Later<Answer>
    where
        Q: prost::Message + Default + 'static,
        A: prost::Message + Default + 'static,
    {
        let place = match self.gate.enter() {
            Ok(place) => place,
            Err(full) => return Box::pin(async move { refused(full) }),
        };
        let method = Method {
            renderer: self.renderer.clone(),
            gate: Some(self.gate.clone()),
            work,
        };
        Box::pin(answer(method, request, longest, Some(place)))
    }
}

async fn answer<Q, A>(
    method: Method<Q, A>,
    request: http::Request<tonic::body::Body>,
    longest: usize,
    place: Option<OwnedSemaphorePermit>,
) -> Answer
where
    Q: prost::Message + Default + 'static,
    A: prost::Message + Default + 'static,
{
    let codec = ProstCodec::<A, Q>::default();
    let mut grpc = tonic::server::Grpc::new(codec)
        .max_decoding_message_size(longest)
        .max_encoding_message_size(MOST_ANSWER_BYTES);
    let response = grpc.unary(method, request).await;
    response.map(|body| Held { body, _place: place })
}

fn refused(status: Status) -> Answer {
    status
        .into_http::<tonic::body::Body>()
        .map(|body| Held { body, _place: None })
}

impl tower_service::Service<http::Request<tonic::body::Body>> for Service {
    type Response = Answer;
    type Error = Infallible;
    type Future = Later<Result<Answer, Infallible>>;

    fn poll_ready(&mut self, _: &mut Context<'_>) -> Poll<Result<(), Infallible>> {
        Poll::Ready(Ok(()))
    }

    fn call(&mut self, request: http::Request<tonic::body::Body>) -> Self::Future {
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
