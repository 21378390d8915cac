//! Draws the pictures of a request.

use std::ops::ControlFlow;

use candle_core::{Device, Tensor};
use diffusion::solver::{Guidance, Prediction, check_finite as check_state, clean_estimate};

use super::preview::Colours;
use super::{Control, PictureRequest, Pipeline, checks, numbers};
use crate::noise::{self, LatentSize};
use crate::pictures::PictureBatch;
use crate::sampling::{SamplingPlan, Solver};
use crate::unet::Extra;
use crate::{StableError, check_length};

/// State of a run that the caller gets after each network call.
pub struct DenoisingStep<'a> {
    /// Number of calls done, from 1.
    pub step: usize,
    /// Number of all calls; PNDM does one more than it has steps.
    pub steps: usize,
    /// Size of the latents.
    pub size: LatentSize,
    x: &'a [f64],
    predicted: &'a [f64],
    prediction: Prediction,
    level: diffusion::schedule::NoiseLevel,
    colours: Option<&'a Colours>,
}

impl DenoisingStep<'_> {
    /// The pictures at this stage, one pixel a cell, without the decoder. `None` for a run that starts from no picture.
    pub fn preview(&self) -> Option<PictureBatch> {
        self.colours?.of(&self.clean_estimate(), self.size).ok()
    }

    /// The clean latents that this call implies: [`Pipeline::decode`] makes a preview of them.
    pub fn clean_estimate(&self) -> Vec<f32> {
        let pairs = self.x.iter().zip(self.predicted);
        let clean = pairs.map(|(x, p)| clean_estimate(self.prediction, &self.level, *x, *p) as f32);
        clean.map(|v| if v.is_finite() { v } else { 0.0 }).collect()
    }
}

/// Result of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct GeneratedPictures {
    /// The pictures: all views of the first frame, then of the next.
    pub pictures: PictureBatch,
    /// Their latents, before they were decoded.
    pub latents: Vec<f32>,
    /// The noise that the run started from, for the next frame.
    pub noise: Vec<f32>,
    /// Number of calls of the UNet, two for each step with guidance.
    pub calls: usize,
}

/// A ControlNet with the embedding of its picture.
struct EmbeddedControl<'a> {
    control: Control<'a>,
    embedded: Tensor,
}

/// Text and picture conditions of a run, on the machine.
struct Conditions<'a> {
    told: Tensor,
    negative: Tensor,
    shown: Vec<EmbeddedControl<'a>>,
    planes: Option<Tensor>,
}

impl Pipeline {
    /// Draws the pictures of a request. `on_step` runs after each network call and may stop the run, which then ends
    /// with [`StableError::Stopped`]. Also errors if sizes do not fit, a number is not finite, or the number of steps
    /// is 0 or too large.
    pub fn draw(
        &self,
        request: &PictureRequest<'_>,
        mut on_step: impl FnMut(&DenoisingStep<'_>) -> ControlFlow<()>,
    ) -> Result<GeneratedPictures, StableError> {
        checks::request(self, request)?;
        let size = self.latent_size(request.pictures(), request.size);
        let strength = request.start.map_or(1.0, |s| s.strength);
        let kind = request.scheduler.unwrap_or(self.scheduler.kind);
        let plan = SamplingPlan::new(&self.scheduler, kind, request.steps, strength)?;
        let noise = request.noise.clone();
        let noise = noise.unwrap_or_else(|| noise::fresh(request.seed, 0, size));
        let clean = request
            .start
            .map(|start| self.encode(start.pictures))
            .transpose()?;
        let anew = request
            .start
            .and_then(|s| s.mask)
            .map(|mask| self.cells(mask, size));
        let idle = plan.calls.is_empty() || anew.as_ref().is_some_and(|cells| !cells.contains(&true));
        if let (Some(start), Some(clean), true) = (request.start, &clean, idle) {
            return Ok(GeneratedPictures {
                pictures: start.pictures.clone(),
                latents: clean.clone(),
                noise,
                calls: 0,
            });
        }
        let start = request.start.zip(clean.as_ref());
        let colours = start.and_then(|(start, clean)| Colours::fit(clean, size, start.pictures));
        let mut x: Vec<f64> = match &clean {
            Some(clean) => noise::noised(clean, &noise, &plan.calls[0].at),
            None => noise.iter().map(|n| f64::from(*n) * plan.spread).collect(),
        };
        let conditions = self.conditions(request, size)?;
        let (mut solver, steps) = (Solver::new(&plan), plan.calls.len());
        for (k, call) in plan.calls.iter().enumerate() {
            let predicted = self.guided(request, &conditions, &x, call.at.t, [k, steps])?;
            let mut next = solver.advance(k, &x, &predicted)?;
            if let (Some(clean), Some(anew)) = (&clean, &anew) {
                // Kept cells hold, at every level, the state that exact denoising would give them.
                let kept = noise::noised(clean, &noise, &call.to);
                let pairs = next.iter_mut().zip(kept).zip(anew);
                pairs
                    .filter(|(_, anew)| !**anew)
                    .for_each(|((next, kept), _)| *next = kept);
            }
            check_state(&next, k + 1, steps)?;
            let seen = DenoisingStep {
                step: k + 1,
                steps,
                size,
                x: &x,
                predicted: &predicted,
                prediction: plan.prediction,
                level: call.at,
                colours: colours.as_ref(),
            };
            if on_step(&seen).is_break() && k + 1 < steps {
                return Err(StableError::Stopped { step: k + 1, steps });
            }
            x = next;
        }
        let latents: Vec<f32> = x.iter().map(|v| *v as f32).collect();
        let mut pictures = self.decode(&latents, size)?;
        if let Some((start, mask)) = request.start.and_then(|s| Some((s, s.mask?))) {
            pictures = pictures.except(mask, start.pictures);
        }
        Ok(GeneratedPictures {
            pictures,
            latents,
            noise,
            calls: steps * request.guidance.calls(),
        })
    }

    /// Flags of the latent numbers that are drawn anew: those of cells with a pixel of the mask.
    fn cells(&self, mask: &[bool], [count, channels, rows, columns]: LatentSize) -> Vec<bool> {
        let cell = self.cell();
        let width = columns * cell;
        let mut anew = vec![false; count * rows * columns];
        for (i, _) in mask.iter().enumerate().filter(|(_, m)| **m) {
            let (row, column) = (i / width, i % width);
            // Rows of all pictures follow each other.
            anew[row / cell * columns + column / cell] = true;
        }
        let of_picture = |cells: &[bool]| vec![cells; channels].concat();
        anew.chunks_exact(rows * columns).flat_map(of_picture).collect()
    }

    /// Conditions of a request, after the networks that run only once.
    fn conditions<'a>(
        &self,
        request: &PictureRequest<'a>,
        size: LatentSize,
    ) -> Result<Conditions<'a>, StableError> {
        let [count, _, rows, columns] = size;
        let on = |numbers: &[f32], shape: [usize; 4]| -> Result<Tensor, StableError> {
            Ok(Tensor::from_slice(numbers, &shape, &Device::Cpu)?.to_device(&self.machine.device)?)
        };
        let told = request
            .prompts
            .iter()
            .map(|p| self.told(p))
            .collect::<Result<Vec<_>, _>>()?;
        let mut shown = Vec::new();
        for control in &request.controls {
            let net = &self.controls[control.net];
            let [height, width] = request.size;
            let shape = [count, net.config().conditioning_channels, height, width];
            let embedded = net.embed(&on(control.picture, shape)?)?;
            let control = *control;
            shown.push(EmbeddedControl { control, embedded });
        }
        let mut added = None;
        if let (Some(planes), Some(channels)) = (&request.planes, self.plane_channels()) {
            let ids = on(planes.ids, [count, channels, rows, columns])?;
            match &self.mpi {
                Some(encoder) => added = Some(encoder.forward(&ids)?.affine(planes.scale, 0.0)?),
                None => {
                    let net = self.controls.iter().position(|c| c.takes_planes()).unwrap_or(0);
                    let control = Control {
                        scale: planes.scale,
                        ..Control::new(net, planes.ids)
                    };
                    let embedded = self.controls[net].embed(&ids)?;
                    shown.push(EmbeddedControl { control, embedded });
                }
            }
        }
        Ok(Conditions {
            told: Tensor::cat(&told, 0)?,
            negative: self.told(&request.negative)?,
            shown,
            planes: added,
        })
    }

    /// The encoded text for the UNet, `[1, tokens, width]`.
    fn told(&self, text: &str) -> Result<Tensor, StableError> {
        let length = self.text.config().max_position_embeddings;
        self.text.encode(&self.words.ids(text, length)?)
    }

    /// The prediction for a state, with guidance.
    fn guided(
        &self,
        request: &PictureRequest<'_>,
        conditions: &Conditions<'_>,
        x: &[f64],
        t: f64,
        step: [usize; 2],
    ) -> Result<Vec<f64>, StableError> {
        let size = self.latent_size(request.pictures(), request.size);
        let small: Vec<f32> = x.iter().map(|v| *v as f32).collect();
        let tensor = Tensor::from_slice(&small, &size, &Device::Cpu)?.to_device(&self.machine.device)?;
        let said = |context: &Tensor| {
            let extra = self.extra(conditions, &tensor, t, context, step)?;
            let said = self.unet.forward(&tensor, t, context, &extra, request.frames)?;
            let said = numbers(&said)?;
            check_length("what the UNet says", said.len(), x.len())?;
            Ok::<Vec<f64>, StableError>(said.into_iter().map(f64::from).collect())
        };
        let Guidance { weight, .. } = request.guidance;
        if weight == 0.0 {
            return said(&conditions.negative);
        }
        let told = said(&conditions.told)?;
        if weight == 1.0 {
            return Ok(told);
        }
        let negative = said(&conditions.negative)?;
        // Rescaling restores the spread of each picture by itself.
        let each = (x.len() / size[0]).max(1);
        let pairs = told.chunks(each).zip(negative.chunks(each));
        Ok(pairs
            .flat_map(|(told, negative)| request.guidance.combine(told, negative))
            .collect())
    }

    /// Values that conditions add to the UNet's maps in this step.
    fn extra(
        &self,
        conditions: &Conditions<'_>,
        x: &Tensor,
        t: f64,
        context: &Tensor,
        [k, steps]: [usize; 2],
    ) -> Result<Extra, StableError> {
        let mut sum = Extra {
            first: conditions.planes.clone(),
            ..Extra::default()
        };
        for EmbeddedControl { control, embedded } in &conditions.shown {
            let [from, until] = control.during;
            let (begins, ends) = (k as f64 / steps as f64, (k + 1) as f64 / steps as f64);
            if begins < from || ends > until {
                continue;
            }
            let more = self.controls[control.net].forward(x, t, context, embedded, control.scale)?;
            sum.middle = match (sum.middle, more.middle) {
                (Some(a), Some(b)) => Some((a + b)?),
                (a, b) => a.or(b),
            };
            sum.down = match sum.down.is_empty() {
                true => more.down,
                false => {
                    let pairs = sum.down.iter().zip(&more.down);
                    pairs.map(|(a, b)| a + b).collect::<candle_core::Result<_>>()?
                }
            };
        }
        Ok(sum)
    }
}
