//! The generation itself. A whole scene is sampled from its layout. An edit inverts the source to noise and denoises
//! the region that it touches under the new layout; outside the region the stored states are replayed, and the labels
//! are copied from the source. After UniScene (occupancy; editing in C.1).

mod lattice;
mod network;
mod new_ground;
mod plan;
mod round_trip;
mod source;
pub(crate) mod standing;
mod unfinished;
mod window;

use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;
use std::time::{Duration, Instant};

use crate::composite::{composite, seam_change_share, untouched_hash, untouched_voxels_changed};
use crate::contract::{
    ChosenDensities, GenError, GenParams, GenReport, GenResult, Job, JobCtx, Pipeline, Quality, RegionMode,
    Stage,
};
use crate::guards::clear::observed_still;
use crate::guards::holes::still_closed;
use crate::guards::{self, GuardInput};
use crate::inpaint::{self, InpaintMask};
use crate::refine::decode_refined;
use crate::region::{CELLS, CELLS_PER_SIDE, Region, dilate};
use crate::request::VoxelRequest;
use diffusion::inversion::Trajectory;
use diffusion::replay::edit_with_replay;
use diffusion::solver::Sampler;
use nets::{DecoderInput, DitCondition, GROUPS, OccModels, tokens_of};
use network::{Condition, Network};
use new_ground::NewGround;
use nn::{Cpu, Ops};
use numeric::philox::{Stream, normal_field};
use scene::{BevLayout, BoxId, Extent, Scene, SceneBox, VoxelGrid, Window};
use source::{EditSource, stored_for};
use standing::SceneryVoxels;
use unfinished::Unfinished;

pub use network::Ablation;
pub use plan::{Bounds, LatentWindow, parts, windows_over};
pub use round_trip::RoundTrip;
pub use window::is_idle;

/// Numbers per latent cell.
const CHANNELS: usize = 8;
/// Completeness from which on a scene may have no holes in its ground.
const COMPLETE: f32 = 0.95;

/// Decides when a long job sends a preview: after its first step, then rarely enough that previews take a fifth of the
/// time.
#[derive(Default)]
struct Glimpses {
    begun: Option<Instant>,
    next: Option<Instant>,
}

impl Glimpses {
    const PAUSE_PER_COST: u32 = 4;

    fn due(&mut self) -> bool {
        self.begun = Some(Instant::now());
        self.next.is_none_or(|next| next <= Instant::now())
    }

    fn shown(&mut self) {
        let cost = self.begun.map_or(Duration::ZERO, |begun| begun.elapsed());
        self.next = Some(Instant::now() + cost * Self::PAUSE_PER_COST);
    }
}

/// Generates occupancy. Keeps the trajectories of recent sources and of its own results in memory, so that the next
/// edit of such a scene needs no inversion. A clone shares what is in memory so far.
#[derive(Clone)]
pub struct OccPipeline<B: Ops = Cpu> {
    models: Arc<OccModels<B>>,
    sources: VecDeque<EditSource<B>>,
    /// The last draft and its latent. The next draft mostly differs in a few columns, and only those are encoded again.
    draft: Option<(VoxelGrid, Vec<f32>)>,
    /// The voxels beside the road in the last job.
    standing: Option<SceneryVoxels>,
    /// Part of the condition that is hidden from the network, to measure its value.
    ablation: Option<Ablation>,
    /// Finished parts of a whole map whose generation was stopped.
    unfinished: Unfinished,
}

impl OccPipeline {
    /// A pipeline with the weights that ship with the program.
    pub fn bundled() -> Result<Self, GenError> {
        Ok(Self::new(OccModels::bundled().map_err(GenError::failed)?))
    }
}

impl<B: Ops + Clone> OccPipeline<B> {
    /// A pipeline with these networks, on their backend.
    pub fn new(models: Arc<OccModels<B>>) -> Self {
        Self {
            models,
            sources: VecDeque::new(),
            draft: None,
            standing: None,
            ablation: None,
            unfinished: Unfinished::default(),
        }
    }

    /// Hides a part of every condition from the network, to measure its value.
    pub fn ablate(&mut self, ablation: Option<Ablation>) {
        self.ablation = ablation;
    }

    /// The networks in use.
    pub fn models(&self) -> &OccModels<B> {
        &self.models
    }

    /// The tokens that an edit computes: those of its region and a few around it. This works only if the keys and
    /// values of all other tokens are in memory from the source; `None` if all tokens must be computed.
    fn local_tokens(
        &self,
        source: &EditSource<B>,
        sampler: &Sampler,
        cells: &[bool],
        params: &GenParams,
    ) -> Option<Vec<usize>> {
        let kept = source.keys_values.as_ref().filter(|_| params.local)?;
        let first = sampler.states_of_noise() - 1;
        let mut asked = sampler.levels[first..sampler.steps()].iter();
        let known = asked.all(|level| kept.contains_key(&level.t.to_bits()));
        (known && sampler.guidance.weight == 1.0).then(|| tokens_of(cells, params.halo_tokens as usize))
    }

    /// Encodes a draft. Cells that see only columns unchanged since the last draft keep their latents.
    fn draft_latent(&mut self, draft: &VoxelGrid) -> Result<Vec<f32>, GenError> {
        let vae = &self.models.vae;
        let latent = match self.draft.take() {
            Some((last, mut latent)) => {
                let columns = (0..Window::COLUMNS).map(|c| {
                    let (x, y) = (c / Window::NY, c % Window::NY);
                    last.column(x, y) != draft.column(x, y)
                });
                let changed = Region::of_columns(columns.collect());
                let seen = dilate(&changed.latent_cells, CELLS_PER_SIDE, vae.encoder_reach());
                vae.encode_cells(draft, &seen, &mut latent).map(|()| latent)
            }
            None => vae.encode(draft),
        };
        let latent = latent.map_err(GenError::failed)?;
        self.draft = Some((draft.clone(), latent.clone()));
        Ok(latent)
    }

    /// The condition for a scene's frame with this layout and these boxes.
    fn condition(
        &mut self,
        scene: &Scene,
        layout: &BevLayout,
        boxes: &BTreeMap<BoxId, SceneBox>,
        named: ChosenDensities,
    ) -> Condition {
        self.standing = SceneryVoxels::from_scene(scene, layout, self.standing.as_ref());
        Condition::new(layout, boxes, self.standing.as_ref(), named, self.ablation)
    }

    /// The network under a condition, for some tokens or (`None`) all.
    fn network(
        &mut self,
        condition: &Condition,
        tokens: Option<Vec<usize>>,
        mask: Vec<f32>,
        context: Vec<f32>,
        params: &GenParams,
    ) -> Result<Network<B>, GenError> {
        let guided = params.guidance != 1.0;
        let draft_latent = match condition.draft_hidden {
            true => vec![0.0; CELLS * CHANNELS],
            false => self.draft_latent(&condition.draft)?,
        };
        let full = DitCondition {
            bev: condition.bev.clone(),
            heading: condition.heading.clone(),
            named: condition.named.values(),
            draft_latent,
            given: vec![[f32::from(u8::from(condition.given)); GROUPS]; CELLS],
            columns: condition.columns.clone(),
            ground: true,
            mask,
            context,
        };
        let models = self.models.clone();
        let dit = &models.dit;
        let prepared = match tokens {
            Some(tokens) => dit.prepare_some(&full, tokens),
            None => dit.prepare(&full),
        };
        let prepared = prepared.map_err(GenError::failed)?;
        let without = if guided {
            let null = dit.null_condition(&full);
            Some(dit.prepare(&null).map_err(GenError::failed)?)
        } else {
            None
        };
        Ok(Network {
            models: self.models.clone(),
            condition: prepared,
            without,
            keys_values: None,
            precision: params.precision,
            reuse_steps: params.reuse_steps,
            predictions: 0,
            added: Vec::new(),
        })
    }

    /// The latent (50x50x8) of the trajectory that the latest job used or made.
    pub fn latest_latent(&self) -> Option<Vec<f32>> {
        self.sources.front().map(|s| s.trajectory.latent_f32())
    }

    /// Inverts the source of the job's frame now, so that a later edit finds it in memory. Returns the number of
    /// network calls.
    pub fn prepare(&mut self, job: &Job, ctx: &JobCtx<'_>) -> Result<usize, GenError> {
        let mut report = GenReport::default();
        let inner = lattice::in_networks_lattice(job);
        let job = inner.as_ref().unwrap_or(job);
        let cut = window::at_origin(job);
        let scene = cut.as_ref().map_or(&job.scene, |cut| &cut.scene);
        let condition = self.condition_of_source(scene);
        self.source(scene, &condition, &job.params, &mut report, ctx)?;
        Ok(report.network_calls)
    }

    fn generate(&mut self, job: &Job, ctx: &JobCtx<'_>) -> Result<GenResult, GenError> {
        let (frame, params) = (job.scene.frame(), &job.params);
        let mut report = GenReport::default();
        let condition = self.condition(&job.scene, &frame.layout, &frame.boxes, params.named);
        let sampler = Sampler::standard(params.solver, params.steps as usize, params.guidance())?;
        ctx.progress(Stage::Encode, 0, 1)?;
        let mut network = report.timed(Stage::Encode, |_| {
            self.network(
                &condition,
                None,
                vec![1.0; CELLS],
                vec![0.0; CELLS * CHANNELS],
                params,
            )
        })?;
        network.keys_values = stored_for(params);
        let start = normal_field(params.seed, Stream::Start, CELLS, CHANNELS);
        let region = Region::full();
        let mut glimpses = Glimpses::default();
        let states = report.timed(Stage::Denoise, |report| {
            sampler.sample(start, &mut network, |view| {
                ctx.progress(Stage::Denoise, view.step, view.steps)?;
                if ctx.previews() && view.step < view.steps && glimpses.due() {
                    let seen = (&condition, &region);
                    self.glimpse(job, seen, &view.clean_estimate(), report, ctx)?;
                    glimpses.shown();
                }
                Ok(())
            })
        })?;
        report.network_calls = params.steps as usize * sampler.guidance.calls();
        report.tokens = network.condition.tokens();
        let keys_values = network.keys_values.take();
        drop(network);
        let trajectory = Trajectory {
            levels: sampler.levels.clone(),
            states,
        };
        ctx.progress(Stage::Decode, 0, 1)?;
        let latent = trajectory.latent_f32();
        let mut generated = report.timed(Stage::Decode, |_| {
            let refine = (params.fine_steps, params.seed);
            decode_refined(
                &self.models,
                &latent,
                &region.latent_cells,
                condition.decoder_input(),
                refine,
            )
        })?;
        let request = VoxelRequest::from_frame(frame);
        let on = GuardInput {
            scene: &job.scene,
            region: &region,
            inpainted: &InpaintMask::default(),
            request: &request,
            source: None,
            complete: params.named.completeness.is_none_or(|share| share >= COMPLETE),
        };
        guards::run(&on, params.keep_objects, &mut generated, &mut report);
        let result = self.finish(job, &frame.source.occupancy, &generated, &region, &mut report);
        self.adopt(
            &result.occupancy,
            &condition,
            params,
            sampler.solver,
            trajectory,
            keys_values,
        );
        Ok(result)
    }

    /// Sends a preview: the present estimate of the clean latent, decoded in a region.
    fn glimpse(
        &self,
        job: &Job,
        (condition, region): (&Condition, &Region),
        clean: &[f64],
        report: &GenReport,
        ctx: &JobCtx<'_>,
    ) -> Result<(), GenError> {
        let latent: Vec<f32> = clean.iter().map(|v| *v as f32).collect();
        let vae = &self.models.vae;
        let grid = vae.decode_with(&latent, &region.latent_cells, condition.decoder_input());
        let grid = grid.map_err(GenError::failed)?;
        let frame = job.scene.frame();
        ctx.preview(GenResult {
            key: job.key(),
            occupancy: composite(&frame.source.occupancy, &grid, region, &frame.painted),
            report: report.clone(),
        });
        Ok(())
    }

    fn edit(&mut self, job: &Job, ctx: &JobCtx<'_>) -> Result<GenResult, GenError> {
        let mut report = GenReport::default();
        let region = report.timed(Stage::Composite, |_| {
            inpaint::region_of(job.scene.frame(), &job.params)
        });
        self.inpaint(job, region, &job.params.inpaint, report, ctx)
    }

    /// Regenerates a region of the window of the job's frame, whether it was edited or not.
    pub fn inpaint_region(
        &mut self,
        job: &Job,
        region: Region,
        ctx: &JobCtx<'_>,
    ) -> Result<GenResult, GenError> {
        job.params.check()?;
        // All of the region may get new content.
        let mut mask = InpaintMask::default();
        let columns = Extent::WINDOW.all_columns().zip(&region.columns);
        columns
            .filter(|(_, held)| **held)
            .for_each(|(column, _)| mask.set_columns(Extent::WINDOW, &[column], true));
        window::in_window(job, ctx, |job, ctx| {
            self.inpaint(job, region.clone(), &mask, GenReport::default(), ctx)
        })
    }

    fn inpaint(
        &mut self,
        job: &Job,
        region: Region,
        inpainted: &InpaintMask,
        mut report: GenReport,
        ctx: &JobCtx<'_>,
    ) -> Result<GenResult, GenError> {
        let frame = job.scene.frame();
        let before = &frame.source.occupancy;
        if region.is_empty() {
            // The region is empty: no network is called.
            return Ok(self.finish(job, before, before, &region, &mut report));
        }
        let ground = NewGround::from_frame(frame);
        let is_new = ground.is_in(&region);
        let params = &match is_new {
            true => NewGround::params(&job.params),
            false => job.params.clone(),
        };
        let fresh = params.strength > 0.0;
        let condition_before = self.condition_of_source(&job.scene);
        let (sampler, source) = match fresh {
            true => self.noised(&job.scene, &condition_before, params, &mut report, ctx)?,
            false => self.inverted(&job.scene, &condition_before, params, &mut report, ctx)?,
        };
        let named = params.named.or_else(&ground.density());
        let condition = self.condition(&job.scene, &frame.layout, &frame.boxes, named);
        let latent = source.trajectory.latent_f32();
        let drawn = match is_new {
            true => ground.drawn_with(&region),
            false => region.latent_cells.clone(),
        };
        let mask: Vec<f32> = drawn.iter().map(|c| f32::from(u8::from(*c))).collect();
        let context = latent
            .iter()
            .enumerate()
            .map(|(i, v)| v * (1.0 - mask[i / CHANNELS]))
            .collect();
        let local = self.local_tokens(&source, &sampler, &drawn, params);
        // Tokens that are not computed take part with their keys and values from the source.
        let kept = source.keys_values.as_deref().filter(|_| local.is_some());
        let keys_values = match kept {
            Some(kept) => Some(kept.clone()),
            None => stored_for(params).filter(|_| !fresh),
        };
        let mut network = report.timed(Stage::Encode, |_| {
            self.network(&condition, local, mask, context, params)
        })?;
        network.keys_values = keys_values;
        report.tokens = network.condition.tokens();
        let mut glimpses = Glimpses::default();
        // A job of preview quality ends before a preview of it would be seen.
        let shows_steps = ctx.previews() && params.quality == Quality::Final;
        let edited = report.timed(Stage::Denoise, |report| {
            edit_with_replay(
                &sampler,
                &source.trajectory,
                &drawn,
                CHANNELS,
                &mut network,
                |view| {
                    ctx.progress(Stage::Denoise, view.step, view.steps)?;
                    if shows_steps && view.step < view.steps && glimpses.due() {
                        self.glimpse(job, (&condition, &region), &view.clean_estimate(), report, ctx)?;
                        glimpses.shown();
                    }
                    Ok(())
                },
            )
        })?;
        let keys_values = network.keys_values.take().filter(|_| params.reuse_steps <= 1);
        drop(network);
        report.network_calls += edited.calls;
        ctx.progress(Stage::Decode, 0, 1)?;
        let request = VoxelRequest::from_frame(frame);
        let observed = observed_still(frame, inpainted, &request);
        let (mut generated, decoded_source) = report.timed(Stage::Decode, |_| {
            let refine = (params.fine_steps, params.seed);
            let decoded = |latent: &[f32], condition: &Condition| {
                let input = DecoderInput {
                    observed: observed.as_deref(),
                    ..condition.decoder_input()
                };
                decode_refined(&self.models, latent, &region.latent_cells, input, refine)
            };
            let (generated, source) = rayon::join(
                || decoded(&edited.latent, &condition),
                || decoded(&latent, &condition_before),
            );
            Ok::<_, GenError>((generated?, source?))
        })?;
        let on = GuardInput {
            scene: &job.scene,
            region: &region,
            inpainted,
            request: &request,
            source: Some(&decoded_source),
            complete: is_new && named.completeness.is_some_and(|share| share >= COMPLETE),
        };
        guards::run(&on, params.keep_objects, &mut generated, &mut report);
        let result = self.finish(job, before, &generated, &region, &mut report);
        if fresh {
            return Ok(result); // not adopted: its states around the region are noised, not inverted
        }
        self.adopt(
            &result.occupancy,
            &condition,
            params,
            sampler.solver,
            edited.trajectory,
            keys_values,
        );
        Ok(result)
    }

    fn finish(
        &self,
        job: &Job,
        source: &VoxelGrid,
        generated: &VoxelGrid,
        region: &Region,
        report: &mut GenReport,
    ) -> GenResult {
        if job.params.fine_steps > 0 && self.models.refiner.is_none() {
            report
                .notes
                .push("no fine stage: the folder of weights has no refiner".into());
        }
        let painted = &job.scene.frame().painted;
        let occupancy = report.timed(Stage::Composite, |_| {
            composite(source, generated, region, painted)
        });
        let holes = std::mem::take(&mut report.holes);
        report.close(still_closed(holes, &occupancy));
        report.region_columns = region.column_count();
        report.region_share = region.share();
        report.region_cells = region.cell_count();
        report.untouched_voxels_changed = untouched_voxels_changed(source, &occupancy, region, painted);
        report.untouched_hash = untouched_hash(&occupancy, region, painted);
        report.voxels_changed = source.count_different(&occupancy);
        report.seam_change_share = seam_change_share(source, &occupancy, region, 2);
        GenResult {
            key: job.key(),
            occupancy,
            report: std::mem::take(report),
        }
    }
}

impl<B: Ops + Clone> Pipeline for OccPipeline<B> {
    fn run(&mut self, job: &Job, ctx: &JobCtx<'_>) -> Result<GenResult, GenError> {
        job.params.check()?;
        ctx.check()?;
        if let Some(inner) = lattice::in_networks_lattice(job) {
            return lattice::resampled(job, &inner, ctx, |job, ctx| self.run(job, ctx));
        }
        let mut unfinished = std::mem::take(&mut self.unfinished);
        let result = window::over_the_map(job, ctx, &mut unfinished, |job, ctx| match job.params.region {
            RegionMode::Full => self.generate(job, ctx),
            RegionMode::Auto => self.edit(job, ctx),
        });
        self.unfinished = unfinished;
        let mut result = result?;
        result.report.notes.extend(job.params.notes());
        if job.params.region == RegionMode::Full
            && let Some(given) = standing::given(&job.scene)
        {
            let before = job.scene.for_generation();
            let differ = before.frame().occupancy.count_different(&result.occupancy);
            let note = given_note(given, differ);
            result.report.things_given = given;
            result.report.notes.push(note);
        }
        Ok(result)
    }
}

/// Note on a whole scene whose things describe the places beside its roads.
fn given_note(things: usize, voxels: usize) -> String {
    let things = match things {
        1 => "1 thing says".to_owned(),
        n => format!("{n} things say"),
    };
    format!(
        "{things} what stands beside the roads, so nothing else was invented there; {voxels} voxels differ from before"
    )
}
