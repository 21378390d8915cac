//! A frame that goes on from the one before.

use std::ops::ControlFlow;

use super::{Drawn, Pipeline, Request, Start, Step};
use crate::StableError;
use crate::noise::{carried, fresh};
use crate::pictures::Pictures;

/// The frame before, as the cameras of this one see it. Who calls warps it: depth and motion are known to the renderer, not to
/// the networks.
#[derive(Clone, Copy, Debug)]
pub struct Onward<'a> {
    /// The pictures of the frame before, moved to this one; where nothing was seen before, the rendered picture.
    pub pictures: &'a Pictures,
    /// For each latent cell `[picture][row][column]` the cell of the frame before that showed the same surface.
    pub cells: &'a [Option<u32>],
    /// How much of the way is gone anew, 0 to 1. About half keeps what is seen and mends what the warp tore.
    pub strength: f64,
    /// Counts the frames; cells without a past take noise of its own for each.
    pub frame: u32,
}

impl Pipeline {
    /// The next frame of a video: from the frame before, moved to this one, under noise that moves with the surfaces. Otherwise
    /// as [`draw`](Self::draw) with `request`, of whose start only the mask is used, and whose noise is not.
    pub fn next_frame(
        &self,
        before: &Drawn,
        onward: &Onward<'_>,
        request: &Request<'_>,
        on_step: impl FnMut(&Step<'_>) -> ControlFlow<()>,
    ) -> Result<Drawn, StableError> {
        super::checks::request(self, request)?;
        let size = self.latent_size(request.pictures(), request.size);
        let new = fresh(request.seed, onward.frame, size);
        let request = Request {
            noise: Some(carried(&before.noise, onward.cells, &new, size)?),
            start: Some(Start {
                pictures: onward.pictures,
                strength: onward.strength,
                mask: request.start.and_then(|s| s.mask),
            }),
            ..request.clone()
        };
        self.draw(&request, on_step)
    }
}
