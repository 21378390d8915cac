//! Sizes of the occupancy VAE, as its weight file names them.

use serde::Deserialize;

use scene::Window;

/// Sizes, as in the file's metadata.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct VaeConfig {
    /// Numbers per latent cell.
    pub latent: usize,
    /// Channels at 0.4, 0.8 and (if latent cells are that large) 1.6 m.
    pub widths: Vec<usize>,
    /// Kernels (1 or 3) of the encoder's blocks at every level, finest first.
    pub encoder_kernels: Vec<Vec<usize>>,
    /// Kernels (1 or 3) of the decoder's blocks at every level, coarsest first.
    pub decoder_kernels: Vec<Vec<usize>>,
    /// True if the decoder gets the draft of the layout, and which voxels were observed.
    #[serde(default)]
    pub hears: bool,
}

impl VaeConfig {
    pub(super) fn check(&self) -> Result<(), String> {
        let kernels = || self.encoder_kernels.iter().chain(&self.decoder_kernels).flatten();
        let levels = self.widths.len();
        if !(1..=64).contains(&self.latent) {
            Err(format!("latent: expected 1 to 64, found {}", self.latent))
        } else if !(2..=3).contains(&levels) {
            Err(format!("widths: expected 2 or 3 levels, found {levels}"))
        } else if [&self.encoder_kernels, &self.decoder_kernels]
            .iter()
            .any(|k| k.len() != levels)
        {
            Err(format!("kernels: expected {levels} levels, as many as widths"))
        } else if self.widths.iter().any(|w| !(1..=4096).contains(w)) {
            Err(format!("widths: expected 1 to 4096, found {:?}", self.widths))
        } else if kernels().count() > 256 {
            Err("more than 256 blocks".into())
        } else if let Some(k) = kernels().find(|k| ![1, 3].contains(*k)) {
            Err(format!("kernels: expected 1 or 3, found {k}"))
        } else {
            Ok(())
        }
    }

    /// Latent cells along one side of the map.
    pub fn side(&self) -> usize {
        Window::NX >> (self.widths.len() - 1)
    }
}
