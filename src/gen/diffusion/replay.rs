//! Editing by trajectory replay. At each step, cells outside the mask are copied from the source's stored states, and cells
//! inside are denoised. The result is again a trajectory, so the next edit of an adopted result needs no inversion. For
//! inpainting from fresh noise (SDEdit, Meng et al. 2021, arXiv 2108.01073) the source is not an inverted trajectory but
//! [`Trajectory::noised`]: cells outside then look as they did in training.

use super::inversion::Trajectory;
use super::solver::{Denoiser, Sampler, SolverError, StepView, check_finite, check_length};

/// An edited latent.
#[derive(Clone, Debug, PartialEq)]
pub struct Edited {
    /// The clean latent, channel last.
    pub latent: Vec<f32>,
    /// The states that lead to it: the source's outside the mask, new ones inside.
    pub trajectory: Trajectory,
    /// Network calls; 0 if the mask is empty.
    pub calls: usize,
}

/// Regenerates the cells of `mask` (one flag per latent cell, `channels` numbers each, channel last)
/// under the model's condition. Predictions outside the mask are never read, so the model may skip
/// them. `on_step` runs after each step and may end the run with an error.
pub fn edit_with_replay<D: Denoiser + ?Sized>(
    sampler: &Sampler,
    source: &Trajectory,
    mask: &[bool],
    channels: usize,
    model: &mut D,
    mut on_step: impl FnMut(StepView<'_>) -> Result<(), D::Error>,
) -> Result<Edited, D::Error> {
    let steps = sampler.steps();
    let numbers = mask.len() * channels;
    check_length("the trajectory", source.states.len(), steps + 1)?;
    for state in &source.states {
        check_length("a state of the trajectory", state.len(), numbers)?;
    }
    if source.levels != sampler.levels {
        return Err(SolverError::OtherLevels.into());
    }
    if !mask.contains(&true) {
        return Ok(Edited {
            latent: source.latent_f32(),
            trajectory: source.clone(),
            calls: 0,
        });
    }
    let edited_cells: Vec<usize> = (0..mask.len()).filter(|c| mask[*c]).collect();
    let edited = || edited_cells.iter().flat_map(|c| c * channels..(c + 1) * channels);

    check_finite(&source.states[0], 0, steps)?;
    let mut states = vec![source.states[0].clone()];
    let mut stepper = sampler.stepper();
    // O-BELM's noise is two states.
    if sampler.states_of_noise() > 1 {
        stepper.pass(&states[0]);
        states.push(source.states[1].clone());
    }
    let given = states.len() - 1;
    for k in given..steps {
        let x = &states[k];
        let level = sampler.levels[k];
        let predicted = sampler.guidance.predict(model, x, level.t)?;
        let stepped = stepper.advance(k, x, &predicted)?;
        let mut next = source.states[k + 1].clone();
        for i in edited() {
            next[i] = stepped[i];
        }
        check_finite(&next, k + 1, steps)?;
        on_step(StepView::new(
            (k + 1, steps),
            sampler.prediction,
            level,
            (x, &predicted, &next),
        ))?;
        states.push(next);
    }
    let trajectory = Trajectory {
        levels: sampler.levels.clone(),
        states,
    };
    Ok(Edited {
        latent: trajectory.latent_f32(),
        trajectory,
        calls: (steps - given) * sampler.guidance.calls(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inversion::{Refinement, invert};
    use crate::schedule::{Schedule, Spacing};
    use crate::solver::tests::toy;
    use crate::solver::{Branch, Guidance, SolverKind};
    use numeric::philox::{Stream, normal_field};

    const CELLS: usize = 2500;
    const CHANNELS: usize = 8;

    fn sampler() -> Sampler {
        Sampler::standard(SolverKind::Ddim, 5, Guidance::NONE).expect("valid")
    }

    fn source() -> Trajectory {
        let clean = normal_field(11, Stream::Start, CELLS, CHANNELS);
        let mut old = toy(|x, t| (0.6 * x - 0.001 * t).sin(), |_, _| 0.0);
        invert(&sampler(), &clean, Refinement::NONE, &mut old, |_, _| Ok(()))
            .expect("finite")
            .0
    }

    /// Mixes all cells, so that nothing is local by itself.
    struct Coupled {
        calls: usize,
        nan_outside: Vec<bool>,
    }

    impl Denoiser for Coupled {
        type Error = SolverError;
        fn predict(&mut self, x: &[f64], t: f64, _: Branch) -> Result<Vec<f64>, SolverError> {
            self.calls += 1;
            let mean = x.iter().sum::<f64>() / x.len() as f64;
            let value = |(i, x): (usize, &f64)| {
                if self.nan_outside.get(i / CHANNELS) == Some(&false) {
                    return f64::NAN;
                }
                (x + mean + 0.002 * t).cos()
            };
            Ok(x.iter().enumerate().map(value).collect())
        }
    }

    fn coupled() -> Coupled {
        Coupled {
            calls: 0,
            nan_outside: Vec::new(),
        }
    }

    fn run(source: &Trajectory, mask: &[bool], model: &mut Coupled) -> Edited {
        edit_with_replay(&sampler(), source, mask, CHANNELS, model, |_| Ok(())).expect("finite")
    }

    fn assert_outside_is_source(edited: &Edited, source: &Trajectory, mask: &[bool]) {
        for (new, old) in edited.trajectory.states.iter().zip(&source.states) {
            for (i, (a, b)) in new.iter().zip(old).enumerate() {
                assert!(mask[i / CHANNELS] || a.to_bits() == b.to_bits(), "value {i}");
            }
        }
    }

    /// Row 24 of the extremes table.
    #[test]
    fn row_24_replay() {
        let source = source();
        // Empty: no call, the same bits.
        let mut model = coupled();
        let nothing = run(&source, &[false; CELLS], &mut model);
        assert_eq!((model.calls, nothing.calls), (0, 0));
        assert_eq!(nothing.trajectory, source);
        assert_eq!(nothing.latent, source.latent_f32());
        // Full: plain sampling, bit for bit.
        let mut model = coupled();
        let all = run(&source, &[true; CELLS], &mut model);
        assert_eq!((model.calls, all.calls), (5, 5));
        let plain = sampler()
            .sample(source.noise().to_vec(), &mut coupled(), |_| Ok(()))
            .expect("finite");
        assert_eq!(all.trajectory.states, plain);
        // One cell, predictions elsewhere are NaN: nothing leaks, the cell changes.
        for cell in [0, 1234, CELLS - 1] {
            let mut mask = vec![false; CELLS];
            mask[cell] = true;
            let mut model = Coupled {
                calls: 0,
                nan_outside: mask.clone(),
            };
            let one = run(&source, &mask, &mut model);
            assert_outside_is_source(&one, &source, &mask);
            let at = cell * CHANNELS..(cell + 1) * CHANNELS;
            assert_ne!(one.latent[at.clone()], source.latent_f32()[at.clone()]);
            assert!(one.latent.iter().all(|v| v.is_finite()));
            // The new trajectory is one that the next edit can start from.
            let again = run(&one.trajectory, &[false; CELLS], &mut coupled());
            assert_eq!(again.latent, one.latent);
        }
    }

    /// Row 26 of the extremes table, as far as the sampler goes: with a model that works cell by cell,
    /// edits of disjoint cells commute, because the noise belongs to the cell.
    #[test]
    fn row_26_disjoint_edits_commute() {
        let source = source();
        let mut a = vec![false; CELLS];
        let mut b = vec![false; CELLS];
        a[100..140].fill(true);
        b[900..905].fill(true);
        let edit = |from: &Trajectory, mask: &[bool]| {
            let mut local = toy(|x, t| (x + 0.001 * t).sin(), |_, _| 0.0);
            edit_with_replay(&sampler(), from, mask, CHANNELS, &mut local, |_| Ok(()))
                .expect("finite")
                .trajectory
        };
        let ab = edit(&edit(&source, &a), &b);
        let ba = edit(&edit(&source, &b), &a);
        assert_eq!(ab, ba);
        assert_ne!(ab, source);
    }

    #[test]
    fn mismatches_are_typed_errors() {
        let source = source();
        let edit = |sampler: &Sampler, mask: &[bool], channels| {
            let mut model = coupled();
            edit_with_replay(sampler, &source, mask, channels, &mut model, |_| Ok(()))
                .map(|_| ())
                .map_err(|e| e.to_string())
        };
        assert_eq!(
            edit(&sampler(), &[true; 7], CHANNELS),
            Err("a state of the trajectory has 20000 values, expected 56".into())
        );
        let longer = Sampler::standard(SolverKind::Ddim, 6, Guidance::NONE).expect("valid");
        assert_eq!(
            edit(&longer, &[true; CELLS], CHANNELS),
            Err("the trajectory has 6 values, expected 7".into())
        );
        let other = Sampler {
            levels: Schedule::standard().levels(5, Spacing::Leading).expect("valid"),
            ..sampler()
        };
        assert_eq!(
            edit(&other, &[true; CELLS], CHANNELS),
            Err("the trajectory was made for other noise levels than the sampler's".into())
        );
    }
}
