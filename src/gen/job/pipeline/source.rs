//! The starting point of an edit: the trajectory that leads from noise to the frame's source, taken from memory or
//! found by inversion; or the source with fresh noise added. Also decides which trajectories stay in memory.

use std::sync::Arc;

use super::network::{Condition, Network, StepKeysValues, density_of_source};
use super::{CHANNELS, OccPipeline};
use crate::composite::label_hash;
use crate::contract::{ChosenDensities, GenError, GenParams, GenReport, JobCtx, Stage};
use crate::region::CELLS;
use diffusion::inversion::{InversionReport, Refinement, Trajectory, invert};
use diffusion::solver::{Guidance, Sampler, SolverKind};
use nets::KeysValues;
use nn::{Ops, Precision};
use scene::{Scene, VoxelGrid};
use world::draw::hash;

/// Number of trajectories kept; each is about 2 MB at ten steps.
const KEPT_TRAJECTORIES: usize = 24;
/// Most memory for them; the latest is kept in any case.
const TRAJECTORY_BYTES: usize = 256 << 20;
/// Most memory for the keys and values of the latest of them.
const KEYS_VALUES_BYTES: usize = 256 << 20;
/// Memory for the keys and values of one step, about.
const STEP_BYTES: usize = 7_700_000;

/// Key of a trajectory: labels under a layout. Several trajectories may lead there, for example from other densities;
/// an edit can use any of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct SourceKey {
    occupancy: u64,
    layout: u64,
    draft: u64,
    steps: u32,
    iterations: u32,
    exact: bool,
    precision: Precision,
}

pub(super) struct EditSource<B: Ops> {
    pub(super) key: SourceKey,
    /// The solver for edits of it: O-BELM can only continue what it inverted itself.
    pub(super) solver: SolverKind,
    pub(super) trajectory: Arc<Trajectory>,
    /// Keys and values of the network at the trajectory's states; `None` if they take too much memory.
    pub(super) keys_values: Option<Arc<StepKeysValues<B::Tensor>>>,
    pub(super) report: Option<InversionReport>, // None for a trajectory that sampling made
}

impl<B: Ops> Clone for EditSource<B> {
    fn clone(&self) -> Self {
        Self {
            key: self.key,
            solver: self.solver,
            trajectory: self.trajectory.clone(),
            keys_values: self.keys_values.clone(),
            report: self.report.clone(),
        }
    }
}

/// An empty store for keys and values, if those of so many steps fit into memory.
pub(super) fn stored<T>(steps: u32) -> Option<StepKeysValues<T>> {
    (steps as usize * STEP_BYTES <= KEYS_VALUES_BYTES).then(StepKeysValues::new)
}

/// An empty store as of [`stored`]; `None` also if blocks are reused between steps, which leave no keys and values.
pub(super) fn stored_for<T>(params: &GenParams) -> Option<StepKeysValues<T>> {
    stored(params.steps).filter(|_| params.reuse_steps <= 1)
}

impl<B: Ops + Clone> OccPipeline<B> {
    fn key(&self, occupancy: &VoxelGrid, condition: &Condition, params: &GenParams) -> SourceKey {
        SourceKey {
            occupancy: label_hash(occupancy),
            layout: condition
                .bev
                .iter()
                .zip(&condition.heading)
                .fold(0, |h, (b, yaw)| hash(h ^ u64::from(*b) ^ u64::from(*yaw) << 32)),
            draft: label_hash(&condition.draft) ^ u64::from(condition.given),
            steps: params.steps,
            iterations: params.inversion_iterations,
            exact: params.solver == SolverKind::OBelm,
            precision: params.precision,
        }
    }

    /// The condition that a frame's source is generated from.
    pub(super) fn condition_of_source(&mut self, scene: &Scene) -> Condition {
        let frame = scene.frame();
        let named = ChosenDensities::default().or(&density_of_source(frame));
        self.condition(scene, &frame.source.layout, &frame.source.boxes, named)
    }

    pub(super) fn remember(&mut self, source: EditSource<B>) {
        self.sources.retain(|s| s.key != source.key);
        self.sources.push_front(source);
        self.sources.truncate(KEPT_TRAJECTORIES);
        let mut bytes = 0;
        let held = |s: &EditSource<B>| s.trajectory.states.len() * CELLS * CHANNELS * size_of::<f64>();
        let mut trajectory_bytes = 0;
        let fit = self.sources.iter().take_while(|s| {
            trajectory_bytes += held(s);
            trajectory_bytes <= TRAJECTORY_BYTES
        });
        let fit = fit.count().max(1);
        self.sources.truncate(fit);
        for source in &mut self.sources {
            let own = source.keys_values.iter().flat_map(|k| k.values());
            bytes += own.map(KeysValues::bytes).sum::<usize>();
            if bytes > KEYS_VALUES_BYTES {
                source.keys_values = None;
            }
        }
    }

    /// The trajectory of a frame's source under `condition`: from memory, or inverted now.
    pub(super) fn source(
        &mut self,
        scene: &Scene,
        condition: &Condition,
        params: &GenParams,
        report: &mut GenReport,
        ctx: &JobCtx<'_>,
    ) -> Result<EditSource<B>, GenError> {
        let old = &*scene.frame().source;
        let key = self.key(&old.occupancy, condition, params);
        if let Some(known) = self.sources.iter().find(|s| s.key == key).cloned() {
            self.remember(known.clone()); // now the latest: forgotten last
            return Ok(known);
        }
        ctx.progress(Stage::Encode, 0, 1)?;
        let latent = report
            .timed(Stage::Encode, |_| self.models.vae.encode(&old.occupancy))
            .map_err(GenError::failed)?;
        let clean: Vec<f64> = latent.into_iter().map(f64::from).collect();
        let mut network = report.timed(Stage::Encode, |_| self.network_of_source(condition, params))?;
        network.keys_values = stored(params.steps);
        let refinement = Refinement::damped(params.inversion_iterations as usize);
        let mut solver = params.solver;
        let (trajectory, inversion) = loop {
            let sampler = Sampler::standard(solver, params.steps as usize, Guidance::NONE)?;
            let (trajectory, inversion) = report.timed(Stage::Invert, |_| {
                invert(&sampler, &clean, refinement, &mut network, |k, n| {
                    ctx.progress(Stage::Invert, k, n)
                })
            })?;
            report.inversion_calls += inversion.calls;
            if solver != SolverKind::OBelm || inversion.moments_ok() {
                break (trajectory, inversion);
            }
            // The noise is far from normal, and edits from it look wrong. Plain inversion is less exact, but its noise
            // is near normal, and replay needs no more.
            report.notes.push(format!(
                "exact inversion gave unusual noise (std {:.2}, max {:.1}): plain inversion was used",
                inversion.std, inversion.max_abs
            ));
            solver = SolverKind::Ddim;
            network.keys_values = stored(params.steps);
        };
        let keys_values = network.keys_values.take().map(Arc::new);
        drop(network);
        report.network_calls += report.inversion_calls;
        let source = EditSource {
            key,
            solver,
            trajectory: Arc::new(trajectory),
            keys_values,
            report: Some(inversion),
        };
        self.remember(source.clone());
        Ok(source)
    }

    /// Sampler and source for an edit: it starts from the noise that the source comes from.
    pub(super) fn inverted(
        &mut self,
        scene: &Scene,
        condition: &Condition,
        params: &GenParams,
        report: &mut GenReport,
        ctx: &JobCtx<'_>,
    ) -> Result<(Sampler, EditSource<B>), GenError> {
        let source = self.source(scene, condition, params, report, ctx)?;
        if let Some(inversion) = &source.report {
            report.noise_std = Some(inversion.std);
            report.noise_max_abs = Some(inversion.max_abs);
            if !inversion.moments_ok() {
                report.notes.push(format!(
                    "the inverted noise is unusual (std {:.2}, max {:.1}): what is generated anew may resemble what was there less",
                    inversion.std, inversion.max_abs
                ));
            }
        }
        let sampler = Sampler::standard(source.solver, params.steps as usize, params.guidance())?;
        Ok((sampler, source))
    }

    /// Sampler and source for inpainting from fresh noise: the source with noise added, from the step that the strength
    /// gives.
    pub(super) fn noised(
        &mut self,
        scene: &Scene,
        condition: &Condition,
        params: &GenParams,
        report: &mut GenReport,
        ctx: &JobCtx<'_>,
    ) -> Result<(Sampler, EditSource<B>), GenError> {
        let key = self.key(&scene.frame().source.occupancy, condition, params);
        let clean: Vec<f64> = match self.sources.iter().find(|s| s.key == key) {
            Some(known) => known.trajectory.latent().to_vec(),
            None => {
                ctx.progress(Stage::Encode, 0, 1)?;
                let latent = report
                    .timed(Stage::Encode, |_| {
                        self.models.vae.encode(&scene.frame().source.occupancy)
                    })
                    .map_err(GenError::failed)?;
                latent.into_iter().map(f64::from).collect()
            }
        };
        // O-BELM samples well only from its own inversions.
        let solver = match params.solver {
            SolverKind::OBelm => SolverKind::Ddim,
            other => other,
        };
        let mut sampler = Sampler::standard(solver, params.steps as usize, params.guidance())?;
        let steps = (params.strength * f64::from(params.steps)).round().max(1.0) as usize;
        sampler.levels.drain(..sampler.steps() - steps);
        let trajectory = Trajectory::noised(&clean, &sampler.levels, CHANNELS, params.seed);
        let source = EditSource {
            key,
            solver,
            trajectory: Arc::new(trajectory),
            keys_values: None,
            report: None,
        };
        Ok((sampler, source))
    }

    /// The network under the condition of a frame's source, for all tokens.
    pub(super) fn network_of_source(
        &mut self,
        condition: &Condition,
        params: &GenParams,
    ) -> Result<Network<B>, GenError> {
        let (mask, context) = (vec![1.0; CELLS], vec![0.0; CELLS * CHANNELS]);
        let params = GenParams {
            guidance: 1.0,
            reuse_steps: 1,
            ..params.clone()
        };
        self.network(condition, None, mask, context, &params)
    }

    /// Remembers the trajectory of a result. The scene that adopts the result then needs no inversion.
    pub(super) fn adopt(
        &mut self,
        occupancy: &VoxelGrid,
        condition: &Condition,
        params: &GenParams,
        solver: SolverKind,
        trajectory: Trajectory,
        keys_values: Option<StepKeysValues<B::Tensor>>,
    ) {
        let key = self.key(occupancy, condition, params);
        self.remember(EditSource {
            key,
            solver,
            trajectory: Arc::new(trajectory),
            keys_values: keys_values.map(Arc::new),
            report: None,
        });
    }
}
