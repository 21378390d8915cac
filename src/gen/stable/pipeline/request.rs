//! What a picture is drawn from.

use diffusion::solver::Guidance;

use crate::config::SchedulerKind;
use crate::pictures::Pictures;

/// Pictures to go out from.
#[derive(Clone, Copy, Debug)]
pub struct Start<'a> {
    /// As many as are drawn, of the same size: renderings, or the frame before.
    pub pictures: &'a Pictures,
    /// How much of the way is gone anew, 0 to 1: 0 gives the pictures back, 1 keeps nothing of them.
    pub strength: f64,
    /// Pixels `[picture][row][column]` that may change; `None` is all. The others come back bit for bit. Pictures without such a
    /// pixel are references: those beside them see them through attention to views and frames.
    pub mask: Option<&'a [bool]>,
}

/// What a ControlNet is shown.
#[derive(Clone, Copy, Debug)]
pub struct Control<'a> {
    /// Which: its place in [`Pipeline::controls`](super::Pipeline::controls).
    pub net: usize,
    /// `[picture][channel][row][column]` from 0 to 1, for instance splats of semantics or depth; at the size of the pictures, as
    /// many channels as it has.
    pub picture: &'a [f32],
    /// Factor of what it adds; 1 as trained.
    pub scale: f64,
    /// The part of the steps in which it is heard, from 0 to 1.
    pub during: [f64; 2],
}

impl<'a> Control<'a> {
    /// Heard fully, in all steps.
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
pub struct Planes<'a> {
    /// Class ids as plain numbers, `[picture][channel][row][column]` at the size of latents: all planes from the nearest on, 0
    /// where there is nothing, then the id that is seen first.
    pub ids: &'a [f32],
    /// Factor of what they add; 1 as trained.
    pub scale: f64,
}

/// All that pictures depend on: the same request gives the same bytes on one machine and build.
#[derive(Clone, Debug)]
pub struct Request<'a> {
    /// One text for all pictures, or one for each.
    pub prompts: Vec<String>,
    /// What is told to the other branch of guidance; mostly nothing.
    pub negative: String,
    /// Height and width, px: multiples of a latent cell.
    pub size: [usize; 2],
    /// Views of a frame. A UNet that draws views together needs as many as it has.
    pub views: usize,
    /// Frames that are drawn at once, one behind the other in time.
    pub frames: usize,
    /// Steps.
    pub steps: usize,
    /// How far to go from the negative answer to the told one; weight 7 to 7.5 is usual.
    pub guidance: Guidance,
    /// The method; `None` takes that of the folder.
    pub scheduler: Option<SchedulerKind>,
    /// Fixes the noise.
    pub seed: u64,
    /// The noise `[picture][channel][row][column]`, of unit spread; `None` draws it from the seed (see [`crate::noise::fresh`]).
    pub noise: Option<Vec<f32>>,
    /// Pictures to go out from.
    pub start: Option<Start<'a>>,
    /// What ControlNets are shown; what they add is summed.
    pub controls: Vec<Control<'a>>,
    /// Semantic multi-plane images.
    pub planes: Option<Planes<'a>>,
}

impl Request<'_> {
    /// One picture of a text: 20 steps, guidance 7.5.
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

    /// Pictures that are drawn: views of all frames.
    pub fn pictures(&self) -> usize {
        self.views.saturating_mul(self.frames)
    }
}
