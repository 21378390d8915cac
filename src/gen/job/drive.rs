//! Draws the frames of a drive together: by the transformer with its temporal blocks, or (to compare) frame by frame.

use super::contract::GenError;
use diffusion::solver::{Branch, Denoiser, Guidance, Sampler, SolverKind};
use nets::{Between, CELLS, CHANNELS, DitCondition, LATENT, OccDitTime, OccModels, Prepared, Squares};
use numeric::philox::{Stream, normal_field};

/// Networks and settings of a drawn drive.
pub struct DriveNetwork<'a> {
    /// VAE and transformer.
    pub models: &'a OccModels,
    /// Its temporal blocks; `None` draws each frame by itself.
    pub time: Option<&'a OccDitTime>,
    /// Steps of the sampler.
    pub steps: usize,
    /// Seed of the noise.
    pub seed: u64,
}

impl DriveNetwork<'_> {
    /// The latents (50x50x8) of frames under their conditions. Frames whose mask is 0 are known: their context is an
    /// input, and the latents drawn for them come near it. `poses`: pose of the vehicle in each frame, x and y in m,
    /// heading in rad.
    pub fn draw(
        &self,
        conditions: &[DitCondition],
        poses: &[[f64; 3]],
        step_s: f64,
    ) -> Result<Vec<Vec<f32>>, GenError> {
        let dit = &self.models.dit;
        let prepared: Result<Vec<Prepared>, _> = conditions.iter().map(|c| dit.prepare(c)).collect();
        let prepared = prepared.map_err(GenError::failed)?;
        let same_cell = self.time.is_some_and(|time| time.config().same_cell);
        let mut network = Together {
            models: self.models,
            time: self.time,
            between: Between::of(poses, step_s, Squares::TOKENS.by_number(same_cell)),
            prepared,
        };
        let sampler = Sampler::standard(SolverKind::Ddim, self.steps, Guidance::NONE)?;
        let noise = |frame: u64| {
            normal_field(
                self.seed.wrapping_add(frame << 32),
                Stream::Start,
                CELLS,
                CHANNELS,
            )
        };
        let start: Vec<f64> = (0..conditions.len() as u64).flat_map(noise).collect();
        let states = sampler.sample(start, &mut network, |_| Ok(()))?;
        let last = states.last().map_or(&[][..], |s| s.as_slice());
        let frames = last.chunks_exact(LATENT);
        Ok(frames.map(|f| f.iter().map(|v| *v as f32).collect()).collect())
    }
}

/// All frames as one state.
struct Together<'a> {
    models: &'a OccModels,
    time: Option<&'a OccDitTime>,
    between: Between,
    prepared: Vec<Prepared>,
}

impl Denoiser for Together<'_> {
    type Error = GenError;

    fn predict(&mut self, x: &[f64], t: f64, _: Branch) -> Result<Vec<f64>, GenError> {
        let frames: Vec<Vec<f32>> = x
            .chunks_exact(LATENT)
            .map(|f| f.iter().map(|v| *v as f32).collect())
            .collect();
        let dit = &self.models.dit;
        let v = match self.time {
            Some(time) => time.forward(dit, &frames, t as f32, &self.prepared, &self.between),
            None => frames
                .iter()
                .zip(&self.prepared)
                .map(|(x, condition)| dit.forward(x, t as f32, condition))
                .collect(),
        };
        let v = v.map_err(GenError::failed)?;
        Ok(v.concat().into_iter().map(f64::from).collect())
    }
}
