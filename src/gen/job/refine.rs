//! The fine stage. The coarse latent is decoded, the result is encoded by the fine VAE, and a few steps of diffusion
//! inpaint that finer latent, which can represent single voxels. Each cell has its own noise, so equal surroundings are
//! refined alike in a source and in an edit of it.

use crate::contract::GenError;
use crate::region::CELLS_PER_SIDE;
use diffusion::solver::{Branch, Denoiser, Guidance, Sampler, SolverKind};
use nets::pieces::pieces;
use nets::refiner::{Refiner, Rough};
use nets::{CHANNELS, CellRect, DecoderInput, OccModels};
use nn::Ops;
use numeric::philox::{Stream, normal};
use scene::VoxelGrid;

/// Margin of coarse cells around the wanted ones that are computed with them: 3.2 m, half of what the network sees. It
/// was trained on crops, so it does not need the rest.
const AROUND: usize = 2;

/// Decodes some cells of a coarse latent (50x50x8) with `input` for the decoder, and refines them in `steps` steps.
/// With 0 steps, or without a fine network, it only decodes. All other cells stay free.
pub fn decode_refined<B: Ops + Clone>(
    models: &OccModels<B>,
    latent: &[f32],
    cells: &[bool],
    input: DecoderInput<'_>,
    (steps, seed): (u32, u64),
) -> Result<VoxelGrid, GenError> {
    let rough = |cells: &[bool]| {
        models
            .vae
            .decode_with(latent, cells, input)
            .map_err(GenError::failed)
    };
    let Some(net) = models.refiner.as_deref().filter(|_| steps > 0) else {
        return rough(cells);
    };
    let sampler = Sampler::standard(SolverKind::Ddim, steps as usize, Guidance::NONE)?;
    let numbers = net.vae.config().latent;
    let mut fine = vec![0.0; 4 * cells.len() * numbers];
    for part in pieces(cells, AROUND) {
        let Some(window) = CellRect::around(&part, AROUND) else {
            continue;
        };
        let mut seen = vec![false; cells.len()];
        window.cells().for_each(|cell| seen[cell] = true);
        let encoded = |grid: &VoxelGrid| {
            let found = net.vae.encode_window(grid, window.halved());
            found.map(|(latent, _)| latent).map_err(GenError::failed)
        };
        let rough = encoded(&rough(&seen)?)?;
        let told = match input.draft {
            Some(draft) => encoded(draft)?,
            None => vec![0.0; rough.len()],
        };
        let coarse: Vec<f32> = window
            .cells()
            .flat_map(|c| latent[c * CHANNELS..][..CHANNELS].iter().copied())
            .collect();
        let places: Vec<usize> = window.halved().cells().collect();
        let noise = places.iter().flat_map(|place| {
            (0..numbers).map(|channel| normal(seed, Stream::Refine, *place as u32, channel as u32, 0))
        });
        let mut refining = Refining {
            net,
            rough: Rough {
                fine: &rough,
                told: &told,
                coarse: &coarse,
                window,
            },
        };
        let states = sampler.sample(noise.collect(), &mut refining, |_| Ok(()))?;
        let refined = states.last().ok_or_else(|| GenError::failed("no state"))?;
        for (place, values) in places.iter().zip(refined.chunks_exact(numbers)) {
            let into = &mut fine[place * numbers..][..numbers];
            into.iter_mut().zip(values).for_each(|(i, v)| *i = *v as f32);
        }
    }
    let wanted: Vec<bool> = (0..4 * cells.len())
        .map(|place| {
            let side = 2 * CELLS_PER_SIDE;
            cells[place / side / 2 * CELLS_PER_SIDE + place % side / 2]
        })
        .collect();
    net.vae.decode_cells(&fine, &wanted).map_err(GenError::failed)
}

/// The network as a sampler sees it.
struct Refining<'a, B: Ops> {
    net: &'a Refiner<B>,
    rough: Rough<'a>,
}

impl<B: Ops + Clone> Denoiser for Refining<'_, B> {
    type Error = GenError;

    fn predict(&mut self, x: &[f64], t: f64, _: Branch) -> Result<Vec<f64>, GenError> {
        let x: Vec<f32> = x.iter().map(|v| *v as f32).collect();
        let v = self
            .net
            .forward(&x, t as f32, &self.rough)
            .map_err(GenError::failed)?;
        Ok(v.into_iter().map(f64::from).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nets::{LATENT, SIDE};
    use scene::Window;

    /// Labels of a few cells, by windows of their own, and nothing around them; the same again; without steps the coarse decoder's.
    #[test]
    fn some_cells_are_refined_and_the_others_stay_free() {
        let models = OccModels::bundled().expect("weights");
        let latent: Vec<f32> = (0..LATENT).map(|i| (i as f32 * 0.7).sin()).collect();
        let mut cells = vec![false; SIDE * SIDE];
        for cell in [0, 1, 30 * SIDE + 40, 49 * SIDE + 49] {
            cells[cell] = true;
        }
        let refined = |steps| {
            decode_refined(&models, &latent, &cells, DecoderInput::default(), (steps, 7))
                .expect("a finite latent")
        };
        let found = refined(2);
        assert_eq!(found, refined(2));
        assert_ne!(found, refined(0));
        assert_eq!(
            refined(0),
            models.vae.decode_cells(&latent, &cells).expect("a finite latent")
        );
        assert!(found.iter_set().count() > 0);
        for (x, y, _, _) in found.iter_set() {
            let per_cell = Window::NX / SIDE;
            assert!(cells[x / per_cell * SIDE + y / per_cell], "({x}, {y})");
        }
        let none = decode_refined(
            &models,
            &latent,
            &vec![false; SIDE * SIDE],
            DecoderInput::default(),
            (2, 7),
        );
        assert_eq!(none.expect("nothing to do").iter_set().count(), 0);
    }

    /// A bend sees what lies in its corner too: its cells get the labels that they have in the rectangle around it.
    #[test]
    fn a_bend_is_refined_as_its_rectangle() {
        let models = OccModels::bundled().expect("weights");
        let latent: Vec<f32> = (0..LATENT).map(|i| (i as f32 * 0.7).sin()).collect();
        let refined = |inside: &dyn Fn(usize, usize) -> bool| {
            let cells: Vec<bool> = (0..SIDE * SIDE).map(|c| inside(c / SIDE, c % SIDE)).collect();
            decode_refined(&models, &latent, &cells, DecoderInput::default(), (2, 7))
                .expect("a finite latent")
        };
        let rectangle = |x: usize, y: usize| (10..20).contains(&x) && (10..20).contains(&y);
        let bend = |x: usize, y: usize| rectangle(x, y) && (x < 12 || y < 12);
        let (part, whole) = (refined(&bend), refined(&rectangle));
        let per_cell = Window::NX / SIDE;
        for (x, y) in (0..Window::COLUMNS).map(|c| (c / Window::NY, c % Window::NY)) {
            let same = part.column(x, y) == whole.column(x, y);
            assert!(same || !bend(x / per_cell, y / per_cell), "({x}, {y})");
        }
    }

    #[test]
    fn what_is_not_finite_is_refused_in_one_line() {
        let models = OccModels::bundled().expect("weights");
        let all = vec![true; SIDE * SIDE];
        let latent = vec![f32::NAN; LATENT];
        let error = decode_refined(&models, &latent, &all, DecoderInput::default(), (2, 7)).expect_err("NaN");
        assert_eq!(error.to_string().lines().count(), 1, "{error}");
    }
}
