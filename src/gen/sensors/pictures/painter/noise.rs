//! The noise that pictures of the shipped networks begin with.

use super::PaintError;
use super::ring::Ring;
use super::seen::RingFrame;
use super::surfaces::{cells_of, pixels_before, shared_cells};
use nets::picture::CELL;
use stable::noise::{carried, fresh};

/// Source of the noise of a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum NoisePrior {
    /// Noise that belongs to the places of the pictures, whatever they show.
    Places,
    /// Noise that belongs to the visible surfaces: it moves with them from frame to frame, and cameras that see the
    /// same surface share it.
    #[default]
    Surfaces,
    /// Separate noise for each frame.
    Frames,
}

impl NoisePrior {
    /// Noise `[view][row][column][latent]` of a frame that is the `number`th of a drive. It follows an earlier frame
    /// and its noise if there is one near.
    pub(super) fn of(
        self,
        seen: &RingFrame,
        ring: &Ring,
        earlier: Option<(&[f32], &RingFrame)>,
        number: u32,
        latent: usize,
    ) -> Result<Vec<f32>, PaintError> {
        let ([rows, columns], views) = (ring.size.cells(), ring.size.views());
        let size = [views * rows * columns, latent, 1, 1];
        let of_frame = |number| fresh(seen.seed(), number, size);
        let (from, noise, new) = match (self, earlier) {
            (Self::Places, _) => return Ok(of_frame(0)),
            (Self::Frames, _) => return Ok(of_frame(number)),
            (Self::Surfaces, Some((noise, then))) => {
                let pixels = pixels_before(seen, then, views);
                let cells = cells_of(&pixels, ring.size.pixels(), CELL);
                (cells, noise.to_vec(), of_frame(number))
            }
            (Self::Surfaces, None) => {
                let cells = shared_cells(seen, &ring.views(), CELL);
                (cells, of_frame(0), of_frame(0))
            }
        };
        carried(&noise, &from, &new, size).map_err(|e| PaintError::Network(e.to_string()))
    }
}
