//! Face of the networks in a program that was built without them: weights cannot be opened, so that nothing below is ever
//! reached.

use std::convert::Infallible;
use std::ops::ControlFlow;

use crate::config::{ControlConfig, SchedulerKind};
use crate::noise::LatentSize;
use crate::{Folders, PictureBatch, PictureRequest, StableError};

/// Device and number type that networks would run in.
#[derive(Clone, Debug)]
pub struct Machine;

impl Machine {
    /// The processor.
    pub fn best() -> Self {
        Self
    }

    /// Reason why a card is not used: none, because no card could be.
    pub fn without_card(&self) -> Option<&str> {
        None
    }
}

/// All networks of a model; there are none.
pub struct Pipeline(Infallible);

impl Pipeline {
    /// Errors with how to get a program that has the networks.
    pub fn open(_: &Folders, _: &Machine) -> Result<Self, StableError> {
        Err(StableError::Absent)
    }

    /// Device of the networks.
    pub fn machine(&self) -> &Machine {
        match self.0 {}
    }

    /// The UNet.
    pub fn unet(&self) -> &Unet {
        match self.0 {}
    }

    /// The ControlNets.
    pub fn controls(&self) -> &[ControlNet] {
        match self.0 {}
    }

    /// Name of the folder of a ControlNet.
    pub fn control_name(&self, _: usize) -> &str {
        match self.0 {}
    }

    /// Number of network calls of a run.
    pub fn calls(&self, _: Option<SchedulerKind>, _: usize, _: f64) -> Result<usize, StableError> {
        match self.0 {}
    }

    /// Channels of the planes that the networks take.
    pub fn plane_channels(&self) -> Option<usize> {
        match self.0 {}
    }

    /// Pixels that one latent stands for, a side.
    pub fn cell(&self) -> usize {
        match self.0 {}
    }

    /// Size of the latents of pictures.
    pub fn latent_size(&self, _: usize, _: [usize; 2]) -> LatentSize {
        match self.0 {}
    }

    /// Draws pictures.
    pub fn draw(
        &self,
        _: &PictureRequest<'_>,
        _: impl FnMut(&DenoisingStep<'_>) -> ControlFlow<()>,
    ) -> Result<GeneratedPictures, StableError> {
        match self.0 {}
    }
}

/// The UNet; there is none.
pub struct Unet(Infallible);

impl Unet {
    /// Views that are drawn together.
    pub fn views(&self) -> usize {
        match self.0 {}
    }
}

/// A ControlNet; there is none.
pub struct ControlNet(Infallible);

impl ControlNet {
    /// True if it takes planes in place of a picture.
    pub fn takes_planes(&self) -> bool {
        match self.0 {}
    }

    /// Its configuration.
    pub fn config(&self) -> &ControlConfig {
        match self.0 {}
    }
}

/// State of a run; there is none.
pub struct DenoisingStep<'a> {
    /// Number of calls done.
    pub step: usize,
    /// Number of all calls.
    pub steps: usize,
    never: &'a Infallible,
}

impl DenoisingStep<'_> {
    /// The pictures at this stage.
    pub fn preview(&self) -> Option<PictureBatch> {
        match *self.never {}
    }
}

/// Result of a run.
pub struct GeneratedPictures {
    /// The pictures.
    pub pictures: PictureBatch,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn opening_says_how_to_get_the_networks() {
        let folders = Folders::from_base(std::path::Path::new("weights"));
        let problem = Pipeline::open(&folders, &Machine::best()).err().expect("absent");
        assert!(problem.to_string().ends_with("--features pictures"));
    }
}
