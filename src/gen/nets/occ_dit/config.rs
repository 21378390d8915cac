//! Sizes of the occupancy transformer, as its weight file names them.

use serde::Deserialize;

use crate::CHANNELS;

/// Sizes, as in the file's metadata.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DitConfig {
    /// Numbers per latent cell; 8.
    pub latent: usize,
    /// Channels of a token.
    pub width: usize,
    /// Blocks.
    pub depth: usize,
    /// Attention heads.
    pub heads: usize,
    /// Numbers of the timestep embedding.
    pub frequencies: usize,
    /// True if blocks convolve their values.
    pub local: bool,
}

impl DitConfig {
    pub(super) fn check(&self) -> Result<(), String> {
        if self.latent != CHANNELS {
            Err(format!("latent: expected {CHANNELS}, found {}", self.latent))
        } else if !(1..=4096).contains(&self.width) || !self.width.is_multiple_of(4) {
            Err(format!(
                "width: expected a multiple of 4 up to 4096, found {}",
                self.width
            ))
        } else if !(1..=256).contains(&self.depth) {
            Err(format!("depth: expected 1 to 256, found {}", self.depth))
        } else if self.heads == 0 || !self.width.is_multiple_of(self.heads) {
            Err(format!(
                "heads: expected a divisor of {}, found {}",
                self.width, self.heads
            ))
        } else if !(2..=4096).contains(&self.frequencies) || !self.frequencies.is_multiple_of(2) {
            Err(format!(
                "frequencies: expected an even number up to 4096, found {}",
                self.frequencies
            ))
        } else {
            Ok(())
        }
    }
}
