//! Networks that paint: those that ship, a folder of one's own from the same training, or a public Stable Diffusion.

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError, Weak};

use super::public::PublicPainter;
use super::{PaintError, PaintInput, PaintOptions, PaintProgress, Painter};
use crate::pictures::appearance::CameraImage;
use nets::picture::PictureNets;
use stable::{Folders, Machine, Pipeline};

/// A painter of the cameras of a frame, which remembers what it painted.
pub trait CameraPainter: Send {
    /// Paints pictures of all cameras of the rig, in its order. `watch` is told of every step and may stop the
    /// painting. Errors if it did, or if the networks refuse their input.
    fn paint(
        &mut self,
        input: &PaintInput<'_>,
        watch: &mut dyn FnMut(PaintProgress<'_>) -> ControlFlow<()>,
    ) -> Result<Vec<Arc<CameraImage>>, PaintError>;
}

impl CameraPainter for Painter {
    fn paint(
        &mut self,
        input: &PaintInput<'_>,
        watch: &mut dyn FnMut(PaintProgress<'_>) -> ControlFlow<()>,
    ) -> Result<Vec<Arc<CameraImage>>, PaintError> {
        Painter::paint(self, input, watch)
    }
}

/// Networks that paint, with their weights.
#[derive(Clone)]
pub enum PaintModel {
    /// The program's own.
    Own(Arc<PictureNets>),
    /// Stable Diffusion 1 or 2, with a ControlNet or SyntheOcc's planes if the folder has them.
    Public(Arc<Pipeline>),
}

/// Networks, and how they paint.
#[derive(Clone, Debug, PartialEq)]
pub struct PaintWith {
    /// The networks.
    pub model: PaintModel,
    /// Options of the painting.
    pub options: PaintOptions,
}

impl PaintWith {
    /// A painter; with `previews` it shows pictures of its steps, where that costs little.
    pub fn painter(&self, previews: bool) -> Box<dyn CameraPainter> {
        self.model.painter(self.options.clone(), previews)
    }
}

impl std::fmt::Debug for PaintModel {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Own(_) => "own weights",
            Self::Public(_) => "public weights",
        })
    }
}

/// Equal if both are the same networks in memory.
impl PartialEq for PaintModel {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Own(a), Self::Own(b)) => Arc::ptr_eq(a, b),
            (Self::Public(a), Self::Public(b)) => Arc::ptr_eq(a, b),
            _ => false,
        }
    }
}

/// Public weights in use in this process, by their folder.
static HELD: Mutex<Vec<(PathBuf, Weak<Pipeline>)>> = Mutex::new(Vec::new());

/// The networks of a folder; they have gigabytes, so networks in use are not read again.
fn open_once(folder: &Path) -> Result<Arc<Pipeline>, String> {
    let mut held = HELD.lock().unwrap_or_else(PoisonError::into_inner);
    held.retain(|(_, pipeline)| pipeline.strong_count() > 0);
    let known = held.iter().find(|(at, _)| at == folder);
    if let Some(pipeline) = known.and_then(|(_, pipeline)| pipeline.upgrade()) {
        return Ok(pipeline);
    }
    let pipeline = Pipeline::open(&Folders::from_base(folder), &Machine::best());
    let pipeline = Arc::new(pipeline.map_err(|e| e.to_string())?);
    held.push((folder.to_owned(), Arc::downgrade(&pipeline)));
    Ok(pipeline)
}

impl PaintModel {
    /// The weights that ship with the program. Errors if they cannot be read.
    pub fn bundled() -> Result<Self, PaintError> {
        let nets = PictureNets::bundled();
        nets.map(Self::Own)
            .map_err(|e| PaintError::Network(e.to_string()))
    }

    /// The weights of a folder: a public one as diffusers writes it has a `model_index.json`, one of the program's own has
    /// `vae.safetensors` and `dit.safetensors`. Errors in one line if something is missing, damaged or foreign.
    pub fn open(folder: &Path) -> Result<Self, PaintError> {
        let network = |e: String| PaintError::Network(e);
        if Self::is_public(folder) {
            return open_once(folder).map(Self::Public).map_err(network);
        }
        if !folder.join("vae.safetensors").is_file() {
            return Err(network(format!(
                "{}: no folder of weights: neither model_index.json (public ones) nor vae.safetensors is there",
                folder.display()
            )));
        }
        let nets = PictureNets::from_dir(folder).map_err(|e| network(e.to_string()))?;
        Ok(Self::Own(Arc::new(nets)))
    }

    /// Reason why the processor paints although this build could use a card; `None` if there is none.
    pub fn without_card(&self) -> Option<&str> {
        match self {
            Self::Own(_) => None,
            Self::Public(pipeline) => pipeline.machine().without_card(),
        }
    }

    /// True if a folder looks like one of public weights.
    pub fn is_public(folder: &Path) -> bool {
        folder.join("model_index.json").is_file()
    }

    /// A painter; with `previews` it shows pictures of its steps, where that costs little.
    fn painter(&self, options: PaintOptions, previews: bool) -> Box<dyn CameraPainter> {
        match self {
            Self::Own(nets) => {
                let painter = Painter::new(nets.clone(), options);
                Box::new(if previews {
                    painter
                } else {
                    painter.without_previews()
                })
            }
            Self::Public(pipeline) => Box::new(PublicPainter::new(pipeline.clone(), options, previews)),
        }
    }
}
