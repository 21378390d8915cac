//! Camera pictures by latent diffusion: a VAE of pictures, and a transformer that draws the pictures of a ring of
//! cameras at once, from the hints of the voxels for every pixel and from the frame before. Twins of
//! `training/models/picture_vae.py` and `training/models/picture_dit.py`.

mod condition;
mod config;
mod dit;
mod sample;
mod segmenter;
#[cfg(test)]
mod tests;
mod vae;
mod warp;

use std::path::Path;
use std::sync::{Arc, OnceLock};

use crate::ModelError;
use nn::weights::{self, WeightFile, WeightsError};

pub use condition::{CAMERA_NUMBERS, Condition, EDGE, EncodedCondition, TIMES, WEATHERS};
pub use config::{PictureDitConfig, PictureSegmenterConfig, PictureVaeConfig};
pub use dit::PictureDit;
pub use sample::PictureSampling;
pub use segmenter::{PictureSegmenter, SHOWN};
pub use vae::PictureVae;
pub use warp::{Motion, WarpedLatents, warp};

/// File names of both networks in a folder of weights, as `training/train_pictures.py` leaves it.
pub const FILES: [&str; 2] = ["vae.safetensors", "dit.safetensors"];
/// Pixels of a latent cell along a side.
pub const CELL: usize = 8;
/// Cells of a token along a side.
const TOKEN: usize = 2;
/// Most pixels of a picture along a side.
const MOST_PX: usize = 8192;
/// Most cameras of a ring.
const MOST_VIEWS: usize = 64;

/// Size of the pictures of a ring of cameras. Arrays of pixels are `[view][height][width]`, latents
/// `[view][height / 8][width / 8][8]`; a view's neighbours are the one before it on its left, the one after it on its right,
/// and the last one is on the left of the first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RingSize {
    views: usize,
    rows: usize,
    columns: usize,
}

impl RingSize {
    /// Size for `views` cameras (1 to 64) whose pictures have this height and width, px: multiples of 16 up to 8192.
    pub fn new(views: usize, [height, width]: [usize; 2]) -> Result<Self, ModelError> {
        if !(1..=MOST_VIEWS).contains(&views) {
            return Err(ModelError::OutOfRange {
                what: "number of cameras",
                found: views,
                expected: "1 to 64",
            });
        }
        let expected = "a multiple of 16 px up to 8192";
        check_sides([height, width], CELL * TOKEN, expected)?;
        Ok(Self {
            views,
            rows: height / CELL,
            columns: width / CELL,
        })
    }

    /// Cameras.
    pub fn views(&self) -> usize {
        self.views
    }

    /// Height and width of a picture, px.
    pub fn pixels(&self) -> [usize; 2] {
        [self.rows * CELL, self.columns * CELL]
    }

    /// Rows and columns of latent cells of a picture.
    pub fn cells(&self) -> [usize; 2] {
        [self.rows, self.columns]
    }

    /// Pixels of one picture.
    fn view_pixels(&self) -> usize {
        self.view_cells() * CELL * CELL
    }

    /// Latent cells of one picture.
    fn view_cells(&self) -> usize {
        self.rows * self.columns
    }
}

/// The two networks, which belong together: the transformer knows only this VAE's latents.
pub struct PictureNets {
    /// Pictures to latents and back.
    pub vae: PictureVae,
    /// Latents from noise and a condition.
    pub dit: PictureDit,
    /// FNV-1a of the VAE's file and of the transformer's.
    pub hashes: [u64; 2],
}

impl PictureNets {
    /// The weights that ship with the program, learned from its own renderer; unpacked once.
    pub fn bundled() -> Result<Arc<Self>, WeightsError> {
        static NETS: OnceLock<Arc<PictureNets>> = OnceLock::new();
        if let Some(nets) = NETS.get() {
            return Ok(nets.clone());
        }
        let nets = Self::parse(assets::weights::PICTURES_VAE, assets::weights::PICTURES_DIT)?;
        Ok(NETS.get_or_init(|| Arc::new(nets)).clone())
    }

    /// `vae.safetensors` and `dit.safetensors` of a folder. Errors in one line if a file or a tensor is missing or of
    /// another shape, or if the two do not belong together.
    pub fn from_dir(folder: &Path) -> Result<Self, WeightsError> {
        let [vae, dit] = FILES.map(|file| weights::read(&folder.join(file)));
        Self::parse(&vae?, &dit?)
    }

    /// Reads the networks from the bytes of both files; errors as [`Self::from_dir`].
    pub fn parse(vae: &[u8], dit: &[u8]) -> Result<Self, WeightsError> {
        let (vae, dit) = (
            WeightFile::parse(FILES[0], vae)?,
            WeightFile::parse(FILES[1], dit)?,
        );
        let hashes = [vae.hash(), dit.hash()];
        let (vae, latent) = (
            PictureVae::new(vae)?,
            dit.config::<PictureDitConfig>("config")?.latent,
        );
        if latent != vae.config().latent {
            let expected = vae.config().latent;
            let reason = format!("latent: expected {expected} as in the VAE, found {latent}");
            return Err(dit.config_error("config", reason));
        }
        Ok(Self {
            vae,
            dit: PictureDit::new(dit)?,
            hashes,
        })
    }
}

/// Fails unless both sides of a picture, px, are multiples of `unit` up to 8192.
fn check_sides([height, width]: [usize; 2], unit: usize, expected: &'static str) -> Result<(), ModelError> {
    for (what, found) in [("picture height", height), ("picture width", width)] {
        if !(1..=MOST_PX).contains(&found) || !found.is_multiple_of(unit) {
            return Err(ModelError::OutOfRange {
                what,
                found,
                expected,
            });
        }
    }
    Ok(())
}

/// Fails unless the metadata of a file call it this kind of network.
pub(crate) fn check_kind(file: &WeightFile<'_>, expected: &str) -> Result<(), WeightsError> {
    match file.metadata("kind") {
        Some(found) if found == expected => Ok(()),
        found => {
            let found = found.unwrap_or("none");
            Err(file.config_error("kind", format!("expected {expected}, found {found}")))
        }
    }
}
