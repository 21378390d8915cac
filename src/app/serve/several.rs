//! Several sensors in one request, rendered one after another.

use tonic::Status;

use crate::limits::{MOST_ANSWER_BYTES, MOST_ITEMS, MOST_PIXELS_TOGETHER};
use crate::renderer::Renderer;
use crate::wire::{
    AggregatedRenderRequest, AggregatedRenderReturn, BatchRgbRenderRequest, BatchRgbRenderReturn,
    BatchRgbRenderReturnItem, RgbRenderRequest, RgbRenderReturn,
};
use crate::{lidar, picture};

/// Counts the bytes of an answer.
#[derive(Default)]
struct Bytes(usize);

impl Bytes {
    fn add(&mut self, bytes: usize) -> Result<(), Status> {
        self.0 += bytes;
        match self.0 > MOST_ANSWER_BYTES {
            true => Err(Status::resource_exhausted(format!(
                "an answer of more than {MOST_ANSWER_BYTES} bytes, expected fewer or smaller pictures"
            ))),
            false => Ok(()),
        }
    }
}

/// Errors if a request asks for too much.
fn check<'a>(items: usize, pictures: impl Iterator<Item = &'a RgbRenderRequest>) -> Result<(), Status> {
    if items > MOST_ITEMS {
        return Err(Status::invalid_argument(format!(
            "{items} sensors in one request, expected at most {MOST_ITEMS}"
        )));
    }
    // Those without a size are errors of their own.
    let pixels: u64 = pictures
        .filter_map(|p| picture::size_of(p).ok())
        .map(|[w, h]| u64::from(w) * u64::from(h))
        .sum();
    if pixels > MOST_PIXELS_TOGETHER {
        return Err(Status::invalid_argument(format!(
            "pictures of {pixels} pixels in one request, expected at most {MOST_PIXELS_TOGETHER}"
        )));
    }
    Ok(())
}

/// An error of one of several.
fn prefix_error(place: &str, i: usize, error: Status) -> Status {
    Status::new(error.code(), format!("{place}[{i}]: {}", error.message()))
}

/// Pictures and sweeps, in the order of the request. Errors if one of them is one.
pub fn aggregated(
    renderer: &Renderer,
    request: &AggregatedRenderRequest,
) -> Result<AggregatedRenderReturn, Status> {
    let (pictures, sweeps) = (&request.rgb_requests, &request.lidar_requests);
    check(pictures.len() + sweeps.len(), pictures.iter())?;
    let (mut out, mut bytes) = (AggregatedRenderReturn::default(), Bytes::default());
    for (i, one) in pictures.iter().enumerate() {
        let made = picture::render(renderer, one).map_err(|e| prefix_error("rgb_requests", i, e))?;
        bytes.add(made.image_bytes.len())?;
        out.rgb_returns.push(made);
    }
    for (i, one) in sweeps.iter().enumerate() {
        let made = lidar::render(renderer, one).map_err(|e| prefix_error("lidar_requests", i, e))?;
        bytes.add(2 * (made.point_xyzs_buffer.len() + made.point_intensities_buffer.len()))?;
        out.lidar_returns.push(made);
    }
    Ok(out)
}

/// Pictures in the order of the request; those that fail say why. Errors if the request as a whole asks for too much.
pub fn batch(renderer: &Renderer, request: &BatchRgbRenderRequest) -> Result<BatchRgbRenderReturn, Status> {
    let wanted = || request.items.iter().filter_map(|item| item.request.as_ref());
    check(request.items.len(), wanted())?;
    let (mut out, mut bytes) = (BatchRgbRenderReturn::default(), Bytes::default());
    for item in &request.items {
        let made: Result<RgbRenderReturn, Status> = match &item.request {
            Some(request) => picture::render(renderer, request),
            None => Err(Status::invalid_argument("request is missing")),
        };
        let error_message = match &made {
            Ok(made) => {
                bytes.add(made.image_bytes.len())?;
                String::new()
            }
            Err(error) => error.message().to_owned(),
        };
        out.items.push(BatchRgbRenderReturnItem {
            camera_name: item.camera_name.clone(),
            success: made.is_ok(),
            result: made.ok(),
            error_message,
        });
    }
    Ok(out)
}
