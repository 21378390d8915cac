//! Folders of the parts of a model, as diffusers writes them.

use std::path::{Path, PathBuf};

/// Folders of the parts of a model.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Folders {
    /// Folder with `model_index.json`, `text_encoder`, `tokenizer`, `vae` and `scheduler`.
    pub base: PathBuf,
    /// Folder with `config.json` and the weights of the UNet.
    pub unet: PathBuf,
    /// One folder for each ControlNet.
    pub controls: Vec<PathBuf>,
    /// Folder of the encoder of multi-plane images that is added behind the first convolution, as in SyntheOcc's paper.
    pub mpi: Option<PathBuf>,
}

impl Folders {
    /// The parts in one folder: `unet`, every folder that begins with `controlnet`, in the order of their names, and
    /// `mpi_encoder`. Parts that lie elsewhere, as SyntheOcc's UNet and ControlNet do, can be put in their place.
    pub fn from_base(base: &Path) -> Self {
        let entries = std::fs::read_dir(base).into_iter().flatten().flatten();
        let is_control = |name: &str| name.starts_with("controlnet");
        let mut controls: Vec<PathBuf> = entries
            .filter(|e| is_control(&e.file_name().to_string_lossy()))
            .map(|e| e.path())
            .filter(|path| path.join("config.json").is_file())
            .collect();
        controls.sort();
        let mpi = base.join("mpi_encoder");
        Self {
            base: base.to_owned(),
            unet: base.join("unet"),
            controls,
            mpi: mpi.is_dir().then_some(mpi),
        }
    }
}
