//! Request for pictures.

use diffusion::solver::Guidance;

use crate::config::SchedulerKind;
use crate::pictures::PictureBatch;

/// Pictures that a run starts from.
#[derive(Clone, Copy, Debug)]
pub struct StartPictures<'a> {
    /// Pictures of the same number and size as those drawn: renderings, or the frame before.
    pub pictures: &'a PictureBatch,
    /// Share of the steps that are done anew, 0 to 1: 0 gives the pictures back, 1 keeps nothing of them.
    pub strength: f64,
    /// Pixels `[picture][row][column]` that may change; `None` means all. The others come back bit for bit. Pictures
    /// without such a pixel are references: the other pictures see them through attention to views and frames.
    pub mask: Option<&'a [bool]>,
}

/// Input of a ControlNet.
#[derive(Clone, Copy, Debug)]
pub struct Control<'a> {
    /// Index in [`Pipeline::controls`](super::Pipeline::controls).
    pub net: usize,
    /// `[picture][channel][row][column]` from 0 to 1, for instance splats of semantics or depth; at the size of the
    /// pictures, with the ControlNet's number of channels.
    pub picture: &'a [f32],
    /// Factor of its output; 1 as trained.
    pub scale: f64,
    /// The part of the steps in which it is used, from 0 to 1.
    pub during: [f64; 2],
}

impl<'a> Control<'a> {
    /// Input with full effect in all steps.
    pub fn new(net: usize, picture: &'a [f32]) -> Self {
        Self {
            net,
            picture,
            scale: 1.0,
            during: [0.0, 1.0],
        }
    }
}

/// Semantic multi-plane images.
#[derive(Clone, Copy, Debug)]
pub struct SemanticPlanes<'a> {
    /// Class ids as plain numbers, `[picture][channel][row][column]` at the size of latents: all planes from the
    /// nearest on, 0 for empty, then the first visible id.
    pub ids: &'a [f32],
    /// Factor of their output; 1 as trained.
    pub scale: f64,
}

/// All inputs of pictures: an equal request gives equal bytes on one machine and build.
#[derive(Clone, Debug)]
pub struct PictureRequest<'a> {
    /// One text for all pictures, or one for each.
    pub prompts: Vec<String>,
    /// Text of the other branch of guidance; usually empty.
    pub negative: String,
    /// Height and width, px: multiples of a latent cell.
    pub size: [usize; 2],
    /// Number of views of a frame. A UNet that draws views together needs its own number of views.
    pub views: usize,
    /// Number of frames that are drawn at once, one after the other in time.
    pub frames: usize,
    /// Number of steps.
    pub steps: usize,
    /// Guidance from the answer to the negative text to that of the prompt; weight 7 to 7.5 is usual.
    pub guidance: Guidance,
    /// The method; `None` takes that of the folder.
    pub scheduler: Option<SchedulerKind>,
    /// Seed of the noise.
    pub seed: u64,
    /// The noise `[picture][channel][row][column]`, of unit spread; `None` draws it from the seed (see [`crate::noise::fresh`]).
    pub noise: Option<Vec<f32>>,
    /// Pictures that the run starts from.
    pub start: Option<StartPictures<'a>>,
    /// Inputs of ControlNets; their outputs are summed.
    pub controls: Vec<Control<'a>>,
    /// Semantic multi-plane images.
    pub planes: Option<SemanticPlanes<'a>>,
}

impl PictureRequest<'_> {
    /// A request for one picture of a text: 20 steps, guidance 7.5.
    pub fn new(prompt: &str, size: [usize; 2], seed: u64) -> Self {
        Self {
            prompts: vec![prompt.to_owned()],
            negative: String::new(),
            size,
            views: 1,
            frames: 1,
            steps: 20,
            guidance: Guidance {
                weight: 7.5,
                rescale: 0.0,
            },
            scheduler: None,
            seed,
            noise: None,
            start: None,
            controls: Vec::new(),
            planes: None,
        }
    }

    /// Number of pictures that are drawn: the views of all frames.
    pub fn pictures(&self) -> usize {
        self.views.saturating_mul(self.frames)
    }
}
