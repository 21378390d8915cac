//! Sizes of the picture networks, as their weight files name them.

use serde::Deserialize;

/// Sizes of the VAE.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PictureVaeConfig {
    /// Numbers of a latent cell.
    pub latent: usize,
    /// Channels at 2, 4 and 8 px.
    pub widths: [usize; 3],
    /// Kernels of the encoder's blocks at 2, 4 and 8 px.
    pub encoder_kernels: [Vec<usize>; 3],
    /// Kernels of the decoder's blocks at 8, 4 and 2 px.
    pub decoder_kernels: [Vec<usize>; 3],
}

/// Sizes of the transformer.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PictureDitConfig {
    /// Numbers of a latent cell.
    pub latent: usize,
    /// Channels of the encoder of the condition at 1, 2 and 4 px.
    pub told: [usize; 3],
    /// Channels of a cell of 8 px.
    pub cells: usize,
    /// Channels of a token.
    pub width: usize,
    /// Transformer blocks.
    pub depth: usize,
    /// Attention heads.
    pub heads: usize,
    /// Blocks that attend to the neighbours.
    pub across: Vec<usize>,
    /// Numbers of the timestep embedding.
    pub frequencies: usize,
    /// Kernels of the blocks on cells, before and after those on tokens.
    pub kernels: Vec<usize>,
    /// Planes of classes instead of first surfaces; only an ablation has them.
    planes: usize,
    /// Kernel over such planes.
    #[serde(rename = "plane_kernel")]
    _plane_kernel: usize,
    /// True if depths are an input; false only in an ablation.
    depths: bool,
    /// True if the frame before is an input; false only in an ablation.
    before: bool,
}

/// Sizes of the segmenter.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PictureSegmenterConfig {
    /// Channels at 2, 4 and 8 px.
    pub widths: [usize; 3],
    /// Kernels of the blocks at 2, 4 and 8 px on the way down.
    pub kernels: [Vec<usize>; 3],
}

impl PictureSegmenterConfig {
    pub(super) fn check(&self) -> Result<(), String> {
        widths("widths", &self.widths)?;
        kernels(self.kernels.iter().flatten())
    }
}

impl PictureVaeConfig {
    pub(super) fn check(&self) -> Result<(), String> {
        widths("latent", &[self.latent])?;
        widths("widths", &self.widths)?;
        kernels(self.encoder_kernels.iter().chain(&self.decoder_kernels).flatten())
    }
}

impl PictureDitConfig {
    pub(super) fn check(&self) -> Result<(), String> {
        widths("latent", &[self.latent])?;
        widths("told", &self.told)?;
        widths("cells", &[self.cells])?;
        widths("width", &[self.width])?;
        kernels(self.kernels.iter())?;
        let expected = |name: &str, what: &str, found: &dyn std::fmt::Display| {
            Err(format!("{name}: expected {what}, found {found}"))
        };
        if !self.width.is_multiple_of(4) {
            return expected("width", "a multiple of 4", &self.width);
        }
        if !(1..=256).contains(&self.depth) {
            return expected("depth", "1 to 256", &self.depth);
        }
        if self.heads == 0 || !self.width.is_multiple_of(self.heads) {
            return expected("heads", &format!("a divisor of {}", self.width), &self.heads);
        }
        if let Some(block) = self.across.iter().find(|block| **block >= self.depth) {
            return expected("across", &format!("blocks below {}", self.depth), block);
        }
        if !(2..=4096).contains(&self.frequencies) || !self.frequencies.is_multiple_of(2) {
            return expected("frequencies", "an even number up to 4096", &self.frequencies);
        }
        if self.planes != 0 {
            return expected("planes", "0", &self.planes);
        }
        for (name, on) in [("depths", self.depths), ("before", self.before)] {
            if !on {
                return expected(name, "true", &on);
            }
        }
        Ok(())
    }
}

fn widths(name: &str, found: &[usize]) -> Result<(), String> {
    match found.iter().find(|width| !(1..=4096).contains(*width)) {
        Some(bad) => Err(format!("{name}: expected 1 to 4096, found {bad}")),
        None => Ok(()),
    }
}

fn kernels<'a>(mut found: impl Iterator<Item = &'a usize>) -> Result<(), String> {
    match found.find(|kernel| ![1, 3].contains(*kernel)) {
        Some(bad) => Err(format!("kernels: expected 1 or 3, found {bad}")),
        None => Ok(()),
    }
}
