//! The whole pipeline: from texts and conditions to pictures.

mod checks;
mod draw;
mod open;
mod preview;

use candle_core::{DType, Device, Tensor};

use crate::config::{SchedulerConfig, SchedulerKind};
use crate::control::{ControlNet, MpiEncoder};
use crate::noise::LatentSize;
use crate::pictures::PictureBatch;
use crate::sampling::SamplingPlan;
use crate::text::{TextEncoder, Words};
use crate::unet::Unet;
use crate::vae::Vae;
use crate::{Machine, StableError, check_finite, check_length};

pub(crate) use crate::request::{Control, PictureRequest};
pub use draw::{DenoisingStep, GeneratedPictures};

/// All networks of a model, checked against each other.
pub struct Pipeline {
    pub(crate) words: Words,
    pub(crate) text: TextEncoder,
    pub(crate) vae: Vae,
    pub(crate) unet: Unet,
    pub(crate) controls: Vec<ControlNet>,
    pub(crate) control_names: Vec<String>,
    pub(crate) mpi: Option<MpiEncoder>,
    pub(crate) scheduler: SchedulerConfig,
    pub(crate) machine: Machine,
}

impl Pipeline {
    /// Configuration of the folder's scheduler.
    pub fn scheduler(&self) -> &SchedulerConfig {
        &self.scheduler
    }

    /// Machine that it computes on.
    pub fn machine(&self) -> &Machine {
        &self.machine
    }

    /// The UNet, with its sizes and the views that it draws together.
    pub fn unet(&self) -> &Unet {
        &self.unet
    }

    /// The ControlNets, in the order of their folders.
    pub fn controls(&self) -> &[ControlNet] {
        &self.controls
    }

    /// Name of the folder of a ControlNet; empty if there is no ControlNet of that index.
    pub fn control_name(&self, net: usize) -> &str {
        self.control_names.get(net).map_or("", String::as_str)
    }

    /// Channels of the planes that [`PictureRequest::planes`] takes; `None` if no network here takes planes.
    pub fn plane_channels(&self) -> Option<usize> {
        let shown = || self.controls.iter().find(|c| c.takes_planes());
        let encoder = self.mpi.as_ref().map(MpiEncoder::channels);
        encoder.or_else(|| shown().map(|c| c.config().conditioning_channels))
    }

    /// Network calls of a run of so many steps by `scheduler` or that of the folder, if the last `strength` (0 to 1) of
    /// the steps are done. Errors if there are no steps or more than the schedule has.
    pub fn calls(
        &self,
        scheduler: Option<SchedulerKind>,
        steps: usize,
        strength: f64,
    ) -> Result<usize, StableError> {
        let kind = scheduler.unwrap_or(self.scheduler.kind);
        let plan = SamplingPlan::new(&self.scheduler, kind, steps, strength)?;
        Ok(plan.calls.len())
    }

    /// Pixels of a latent cell along a side: 8 in all public models.
    pub fn cell(&self) -> usize {
        self.vae.config().cell()
    }

    /// Size of the latents of `count` pictures of so many pixels. Sides must be whole cells.
    pub fn latent_size(&self, count: usize, [height, width]: [usize; 2]) -> LatentSize {
        let (cell, channels) = (self.cell(), self.vae.config().latent_channels);
        [count, channels, height / cell, width / cell]
    }

    /// Mean latents of pictures, `[picture][channel][row][column]`, as the UNet sees them. Errors if a side is no multiple of
    /// [`cell`](Self::cell).
    pub fn encode(&self, pictures: &PictureBatch) -> Result<Vec<f32>, StableError> {
        // One picture at a time, since the finest maps of a picture are large.
        let x = pictures.tensor(&self.machine)?;
        let mut out = Vec::new();
        for i in 0..pictures.count() {
            let latents = self.vae.encode(&x.narrow(0, i, 1)?)?;
            out.extend(numbers(&latents)?);
        }
        check_finite("encoded latent", &out)?;
        Ok(out)
    }

    /// Decodes latents of the given size. Errors if sizes do not fit or a number is not finite.
    pub fn decode(&self, latents: &[f32], size: LatentSize) -> Result<PictureBatch, StableError> {
        let [count, channels, rows, columns] = size;
        check_length("latents", latents.len(), crate::noise::count(size))?;
        check_length("channels of latents", channels, self.vae.config().latent_channels)?;
        check_finite("latent", latents)?;
        let mut rgb = Vec::new();
        let cell = self.cell();
        for latent in latents.chunks_exact((channels * rows * columns).max(1)) {
            let latent = Tensor::from_slice(latent, (1, channels, rows, columns), &self.machine.device)?;
            let picture = PictureBatch::of_tensor(&self.vae.decode(&latent)?)?;
            rgb.extend_from_slice(picture.rgb());
        }
        PictureBatch::new(count, [rows * cell, columns * cell], rgb)
    }
}

/// All numbers of a tensor.
fn numbers(x: &Tensor) -> Result<Vec<f32>, StableError> {
    let x = x.to_dtype(DType::F32)?.to_device(&Device::Cpu)?;
    Ok(x.contiguous()?.flatten_all()?.to_vec1()?)
}
