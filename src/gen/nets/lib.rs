//! The networks, written against [`nn::Ops`]: they run on any backend. Trained by `training/`, whose files have the same names
//! and the same order of blocks.

mod between;
pub mod column_heights;
pub mod encoder;
mod error;
mod latent;
pub mod layout;
pub mod lidar;
pub mod occ_dit;
pub mod occ_vae;
pub mod perceiver;
pub mod picture;
pub mod pieces;
pub mod refiner;
pub mod scenery;
pub mod sensor_occupancy;
pub mod text;
mod time_decoder;
pub mod unet;

#[cfg(test)]
#[path = "../nn/golden.rs"]
mod golden;
#[cfg(test)]
mod twin;

use std::path::Path;
use std::sync::{Arc, OnceLock};

pub use between::{Between, Squares};
pub use column_heights::{ColumnHeights, GROUPS, column_heights};
pub use error::ModelError;
pub(crate) use error::{check_finite, check_length};
pub use latent::{CELLS, CHANNELS, LATENT, SIDE};
pub use nn::map::CellRect;
pub use occ_dit::{
    BlockReuse, DitCondition, DitConfig, KeysValues, OccDit, OccDitTime, Prepared, TimeConfig, tokens_of,
};
pub use occ_vae::{DecoderInput, OccVae, VaeConfig};
pub use refiner::Refiner;
pub use time_decoder::{TimeDecoder, TimeDecoderConfig};

use nn::weights::{self, WeightFile, WeightsError};
use nn::{Cpu, Ops};

/// File names of the two networks.
pub const FILES: [&str; 2] = ["occ_vae.safetensors", "occ_dit.safetensors"];

/// File name of the fine VAE.
const FINE: &str = "occ_vae_fine.safetensors";

/// The VAE of 100x100x16 latents that ships with the program: it keeps nearly every label. [`refiner`] generates its latents.
pub fn fine_vae() -> Result<OccVae, WeightsError> {
    OccVae::new(fine_file()?)
}

fn fine_file() -> Result<WeightFile<'static>, WeightsError> {
    WeightFile::parse(FINE, assets::weights::OCC_VAE_FINE)
}

/// Identifies the weights in reports.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ModelCard {
    /// Steps and samples they were trained on, as their files say.
    pub name: String,
    /// FNV-1a of the VAE's file, of the DiT's and of the refiner's with its fine VAE (0 without one).
    pub hashes: [u64; 3],
}

/// The two networks, which belong together: the DiT knows only this VAE's latents. Whoever makes them chooses the backend; the
/// program computes on the processor.
pub struct OccModels<B: Ops = Cpu> {
    /// Labels to latents and back.
    pub vae: OccVae<B>,
    /// Latents from noise and a layout.
    pub dit: OccDit<B>,
    /// The fine stage; a folder of weights may lack it.
    pub refiner: Option<Arc<Refiner<B>>>,
    /// Names and hashes of the weights.
    pub card: ModelCard,
}

impl OccModels {
    /// The weights that ship with the program; unpacked once.
    pub fn bundled() -> Result<Arc<Self>, WeightsError> {
        static MODELS: OnceLock<Arc<OccModels>> = OnceLock::new();
        if let Some(models) = MODELS.get() {
            return Ok(models.clone());
        }
        let models = Self::parse(
            Cpu,
            assets::weights::OCC_VAE,
            assets::weights::OCC_DIT,
            Some(Refiner::bundled()?),
        )?;
        Ok(MODELS.get_or_init(|| Arc::new(models)).clone())
    }

    /// The weights of a folder; without a folder the bundled ones.
    pub fn open(folder: Option<&Path>) -> Result<Arc<Self>, WeightsError> {
        folder.map_or_else(Self::bundled, Self::from_dir)
    }

    /// `occ_vae.safetensors` and `occ_dit.safetensors` of a folder, and `refiner.safetensors` with `occ_vae_fine.safetensors` where it
    /// has one of them. Errors if a file is missing or damaged.
    pub fn from_dir(folder: &Path) -> Result<Arc<Self>, WeightsError> {
        let [vae, dit] = FILES.map(|f| weights::read(&folder.join(f)));
        let refiner = match [refiner::FILE, FINE].iter().any(|f| folder.join(f).exists()) {
            true => {
                let [net, fine] = [refiner::FILE, FINE].map(|f| weights::read(&folder.join(f)));
                let (net, fine) = (net?, fine?);
                let net = WeightFile::parse(refiner::FILE, &net)?;
                Some(Arc::new(Refiner::new(net, WeightFile::parse(FINE, &fine)?)?))
            }
            false => None,
        };
        Ok(Arc::new(Self::parse(Cpu, &vae?, &dit?, refiner)?))
    }
}

impl<B: Ops + Clone> OccModels<B> {
    /// The weights that ship with the program, loaded onto a backend; not kept.
    pub fn on(ops: B) -> Result<Self, WeightsError> {
        let file = WeightFile::parse(refiner::FILE, assets::weights::REFINER)?;
        let refiner = Refiner::on(ops.clone(), file, fine_file()?)?;
        Self::parse(
            ops,
            assets::weights::OCC_VAE,
            assets::weights::OCC_DIT,
            Some(Arc::new(refiner)),
        )
    }

    fn parse(ops: B, vae: &[u8], dit: &[u8], refiner: Option<Arc<Refiner<B>>>) -> Result<Self, WeightsError> {
        let (vae, dit) = (
            WeightFile::parse(FILES[0], vae)?,
            WeightFile::parse(FILES[1], dit)?,
        );
        let told = |w: &WeightFile<'_>| w.metadata("samples").unwrap_or("?").to_owned();
        let card = ModelCard {
            name: format!(
                "occ_vae ({} samples) + occ_dit ({} samples)",
                told(&vae),
                told(&dit)
            ),
            hashes: [vae.hash(), dit.hash(), refiner.as_ref().map_or(0, |r| r.hash)],
        };
        let (made, found) = (vae.metadata("name"), dit.metadata("vae"));
        if made.is_some() && made != found {
            let reason = format!(
                "expected {}, the name of {}, found {}",
                made.unwrap_or(""),
                vae.name(),
                found.unwrap_or("none")
            );
            return Err(dit.config_error("vae", reason));
        }
        let expected = [SIDE, CHANNELS];
        let vae_name = vae.name().to_owned();
        let vae = OccVae::on(ops.clone(), vae)?;
        let found = [vae.config().side(), vae.config().latent];
        if found != expected {
            return Err(dit.config_error(
                "vae",
                format!("expected latents of {expected:?} (side, numbers), found {found:?} in {vae_name}"),
            ));
        }
        Ok(Self {
            vae,
            dit: OccDit::on(ops, dit)?,
            refiner,
            card,
        })
    }
}

impl OccModels {
    /// Tokens of a whole map.
    pub const TOKENS: usize = occ_dit::TOKENS;
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Row 62 of the extremes table: every file that ships, cut or with more behind it, is refused in one line.
    #[test]
    fn row_62_shipped_files_that_were_cut() {
        use assets::weights as shipped;
        for (name, bytes) in [
            ("f3d", shipped::F3D),
            ("layout", shipped::LAYOUT),
            ("lidar", shipped::LIDAR),
            ("lidar_flat", shipped::LIDAR_FLAT),
            ("lidar_perceiver", shipped::LIDAR_PERCEIVER),
            ("occ_dit", shipped::OCC_DIT),
            ("occ_vae", shipped::OCC_VAE),
            ("occ_vae_fine", shipped::OCC_VAE_FINE),
            ("reader", shipped::READER),
            ("refiner", shipped::REFINER),
            ("scenery", shipped::SCENERY),
            ("sensor_occupancy", shipped::SENSOR_OCCUPANCY),
            ("text", shipped::TEXT),
        ] {
            let refusal = |bytes: &[u8]| match WeightFile::parse(name, bytes) {
                Ok(_) => "accepted".to_owned(),
                Err(error) => error.to_string(),
            };
            let all = bytes.len();
            let expected = |found| {
                format!(
                    "{name}: not a usable safetensors file: expected {all} bytes, as its header says, found {found}"
                )
            };
            for cut in [1, 2, 7, 4096] {
                assert_eq!(refusal(&bytes[..all - cut]), expected(all - cut));
            }
            assert_eq!(refusal(&[bytes, &[0]].concat()), expected(all + 1));
        }
        // A folder of weights says which file it is.
        let folder = std::env::temp_dir().join(format!("sceneloom-cut-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder");
        let dit = &shipped::OCC_DIT[..shipped::OCC_DIT.len() - 1];
        for (name, bytes) in FILES.iter().zip([shipped::OCC_VAE, dit]) {
            std::fs::write(folder.join(name), bytes).expect("written");
        }
        let told = OccModels::from_dir(&folder)
            .map(|_| ())
            .expect_err("cut")
            .to_string();
        assert!(
            told.starts_with("occ_dit.safetensors: not a usable safetensors file: expected 11840048 bytes"),
            "{told}"
        );
        std::fs::remove_dir_all(&folder).expect("removed");
    }
}
