//! Edits and whole scenes under many settings, each compared with a reference of so many steps that more change
//! nothing.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use anyhow::Context;
use serde::{Deserialize, Serialize};

use super::cases::Case;
use super::settings::CandidateSetting;
use crate::machine::{forget_peak_memory, peak_rss_mb};
use formats::{atomic, input};
use job::composite::label_hash;
use job::inpaint;
use job::invented::Invented;
use job::pipeline::OccPipeline;
use job::region::Region;
use job::{GenError, GenParams, GenReport, Job, JobCtx, Pipeline, Precision, RegionMode};
use metrics::iou::Confusion;
use nets::{LATENT, OccModels};
use scene::{Class, Extent, Scene, VoxelGrid, Window};
use world::draw::{Draw, hash};

/// Settings whose sources are kept ready at the same time while their runs take turns.
const SIDE_BY_SIDE: usize = 8;
/// Largest file of a kept reference, bytes: room for labels and a latent.
const LARGEST_REFERENCE: u64 = 64 << 20;

/// Result that every setting is compared with.
#[derive(Clone)]
pub struct Reference {
    /// Labels.
    pub occupancy: VoxelGrid,
    /// Latent, 50x50x8.
    pub latent: Vec<f32>,
}

/// Outcome of a setting on a case.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct CaseOutcome {
    /// Share of the region's voxels that differ from the reference; infinite where there is no result.
    pub error: f64,
    /// Number of differing voxels over the number of the region's voxels that either of the two holds occupied.
    pub error_of_occupied: f64,
    /// Mean IoU with the reference in the region.
    pub miou: f64,
    /// Relative RMS difference of the latents in the region's cells.
    pub latent_error: f64,
    /// Voxels above the ground that are in neither the source nor the request.
    #[serde(default)]
    pub invented: f64,
    /// Share of voxels changed along the inner border of the region.
    pub seam: f64,
    /// Voxels outside the region that changed; must be 0.
    pub untouched_voxels_changed: usize,
    /// FNV-1a of the labels outside the region, which every setting must share.
    pub untouched_hash: u64,
    /// FNV-1a of all labels.
    pub result_hash: u64,
    /// Tokens computed per call.
    pub tokens: usize,
    /// Calls of the network, without inversion.
    pub network_calls: usize,
    /// Wall times of single runs from a prepared source, s.
    pub wall_s: Vec<f64>,
    /// Time to prepare the source, s.
    pub invert_s: f64,
    /// Wall time by stage of the last run, s.
    pub stages_s: BTreeMap<String, f64>,
    /// Largest memory held, MB.
    pub peak_rss_mb: Option<f64>,
    /// Fallbacks and warnings.
    pub notes: Vec<String>,
}

/// Runs settings on cases.
pub struct Bench {
    /// The networks.
    pub models: Arc<OccModels>,
    /// Steps of the reference.
    pub reference_steps: u32,
    /// Folder that keeps references between runs, if there is one.
    pub kept_in: Option<PathBuf>,
}

/// Steps of the reference's fine stage.
const REFERENCE_FINE_STEPS: u32 = 16;

/// Parameters of the reference for the parameters of a setting.
pub fn reference_params(base: GenParams, steps: u32) -> GenParams {
    GenParams {
        steps,
        local: false,
        reuse_steps: 1,
        inversion_iterations: 0,
        fine_steps: REFERENCE_FINE_STEPS,
        precision: Precision::F32,
        quality: job::Quality::Preview, // no preview is decoded on the way
        ..base
    }
}

impl Bench {
    fn job(scene: &Arc<Scene>, params: GenParams) -> Job {
        Job {
            scene: scene.clone(),
            params,
        }
    }

    /// The reference of a case; read from the folder of kept references if it is there.
    pub fn reference(
        &self,
        pipeline: &mut OccPipeline,
        case: &Case,
        base: GenParams,
        ctx: &JobCtx<'_>,
    ) -> anyhow::Result<Reference> {
        let params = reference_params(base, self.reference_steps);
        let path = self.kept_in.as_ref().map(|dir| {
            let key = self.models.card.hashes.iter().fold(0, |h, v| hash(h ^ v));
            let frame = case.after.frame();
            let of = [
                label_hash(&frame.source.occupancy),
                label_hash(&frame.occupancy),
                u64::from(params.steps) << 32 | u64::from(params.fine_steps),
                case.name.bytes().fold(0, |h, b| hash(h ^ u64::from(b))),
                params.guidance.to_bits(),
                u64::from(params.region == RegionMode::Full),
            ];
            dir.join(format!("{:016x}.ref", of.iter().fold(key, |h, v| hash(h ^ v))))
        });
        if let Some(path) = &path
            && let Some(read) = input::read(path, LARGEST_REFERENCE)
                .ok()
                .and_then(|bytes| unpack(&bytes))
        {
            return Ok(read);
        }
        let result = pipeline.run(&Self::job(&case.after, params), ctx)?;
        let latent = pipeline.latest_latent().context("the reference has no latent")?;
        let reference = Reference {
            occupancy: result.occupancy,
            latent,
        };
        if let Some(path) = &path {
            atomic::write(path, &pack(&reference)).with_context(|| format!("write {}", path.display()))?;
        }
        Ok(reference)
    }

    /// Measures the distance of `result` from the reference in the region that an edit touches.
    pub fn compare(
        case: &Case,
        params: &GenParams,
        result: &VoxelGrid,
        latent: Option<&[f32]>,
        report: &GenReport,
        reference: &Reference,
    ) -> CaseOutcome {
        let region = match params.region {
            RegionMode::Full => Region::full(),
            RegionMode::Auto => inpaint::region_of(case.after.frame(), params),
        };
        // On a larger map only the networks' window is judged.
        let (result, wanted) = (
            result.crop(Extent::WINDOW),
            reference.occupancy.crop(Extent::WINDOW),
        );
        let (mut differ, mut occupied, mut both) = (0usize, 0usize, 0usize);
        let mut outside = 0u64;
        let mut confusion = Confusion::default();
        let (mut truth, mut found) = (VoxelGrid::new(), VoxelGrid::new());
        for x in 0..Window::NX {
            for y in 0..Window::NY {
                let (a, b) = (result.column(x, y), wanted.column(x, y));
                if !region.columns[x * Window::NY + y] {
                    outside = a.iter().fold(outside, |h, v| hash(h ^ u64::from(*v)));
                    continue;
                }
                both += Window::NZ;
                for z in 0..Window::NZ {
                    differ += usize::from(a[z] != b[z]);
                    occupied += usize::from(a[z] != Class::FREE || b[z] != Class::FREE);
                }
                truth.column_mut(x, y).copy_from_slice(b);
                found.column_mut(x, y).copy_from_slice(a);
            }
        }
        confusion.add(&truth, &found);
        let share = |n: usize| n as f64 / both.max(1) as f64;
        let latent_error = latent.map_or(f64::NAN, |latent| {
            let (mut gap, mut size) = (0.0, 0.0);
            for (i, (a, b)) in latent.iter().zip(&reference.latent).enumerate() {
                if region.latent_cells[i * region.latent_cells.len() / latent.len()] {
                    gap += f64::from(a - b).powi(2);
                    size += f64::from(*b).powi(2);
                }
            }
            (gap / size.max(1e-30)).sqrt()
        });
        CaseOutcome {
            error: share(differ),
            error_of_occupied: differ as f64 / occupied.max(1) as f64,
            miou: confusion.mean_iou().0.unwrap_or(1.0),
            latent_error,
            invented: match params.region {
                RegionMode::Full => 0.0, // all of it is new
                RegionMode::Auto => {
                    let frame = case.after.frame().crop(Extent::WINDOW);
                    Invented::count(&frame, &result, &region).total() as f64
                }
            },
            seam: report.seam_change_share,
            untouched_voxels_changed: report.untouched_voxels_changed,
            untouched_hash: outside,
            result_hash: label_hash(&result),
            tokens: report.tokens,
            network_calls: report.network_calls - report.inversion_calls,
            stages_s: report.wall_s.iter().map(|(k, v)| ((*k).to_owned(), *v)).collect(),
            notes: report.notes.clone(),
            ..CaseOutcome::default()
        }
    }

    /// Runs the cases of one scene under all settings, `repeats` timed runs each, in random turns. Sources are ready
    /// when the clock starts, as they are in the window; the time to prepare them is given separately. Outcomes by
    /// case, then by setting.
    #[allow(clippy::too_many_arguments)] // what is measured, how often, and who listens
    pub fn run(
        &self,
        cases: &[Case],
        settings: &[CandidateSetting],
        repeats: usize,
        base: GenParams,
        seed: u64,
        ctx: &JobCtx<'_>,
        mut at: impl FnMut(usize),
    ) -> anyhow::Result<Vec<Vec<CaseOutcome>>> {
        let mut pipeline = OccPipeline::new(self.models.clone());
        let references = cases
            .iter()
            .map(|case| self.reference(&mut pipeline, case, base.clone(), ctx));
        let references = references.collect::<anyhow::Result<Vec<_>>>()?;
        drop(pipeline);
        let mut outcomes: Vec<Vec<CaseOutcome>> =
            vec![vec![CaseOutcome::default(); settings.len()]; cases.len()];
        let mut order: Vec<usize> = (0..settings.len()).collect();
        let mut draw = Draw::new(seed, "turns");
        shuffle(&mut order, &mut draw);
        let mut done = 0;
        for some in order.chunks(SIDE_BY_SIDE) {
            let mut ready: Vec<(usize, OccPipeline)> = Vec::new();
            for i in some {
                let params = settings[*i].params.clone();
                let mut pipeline = OccPipeline::new(self.models.clone());
                forget_peak_memory();
                let start = Instant::now();
                if params.region == RegionMode::Auto {
                    pipeline.prepare(&Self::job(&cases[0].before, params.clone()), ctx)?;
                }
                let invert_s = start.elapsed().as_secs_f64();
                for ((case, reference), outcomes) in cases.iter().zip(&references).zip(&mut outcomes) {
                    // The run that is judged also warms up.
                    let mut first = pipeline.clone();
                    let outcome = match first.run(&Self::job(&case.after, params.clone()), ctx) {
                        Ok(result) => {
                            let latent = first.latest_latent();
                            let (grid, report) = (&result.occupancy, &result.report);
                            Self::compare(case, &params, grid, latent.as_deref(), report, reference)
                        }
                        Err(GenError::Superseded) => return Err(GenError::Superseded.into()),
                        Err(error) => CaseOutcome {
                            error: f64::INFINITY,
                            notes: vec![error.to_string()],
                            ..CaseOutcome::default()
                        },
                    };
                    outcomes[*i] = CaseOutcome {
                        invert_s,
                        peak_rss_mb: peak_rss_mb(),
                        ..outcome
                    };
                }
                done += 1;
                at(done);
                ready.push((*i, pipeline));
            }
            let turns = ready.len() * cases.len();
            let mut turns: Vec<usize> = (0..turns * repeats).map(|t| t % turns).collect();
            shuffle(&mut turns, &mut draw);
            for turn in turns {
                ctx.check()?;
                let (i, pipeline) = &ready[turn / cases.len()];
                let c = turn % cases.len();
                let mut pipeline = pipeline.clone();
                let job = Self::job(&cases[c].after, settings[*i].params.clone());
                let start = Instant::now();
                let ran = pipeline.run(&job, ctx);
                let wall_s = start.elapsed().as_secs_f64();
                if let Ok(result) = ran {
                    let outcome = &mut outcomes[c][*i];
                    outcome.wall_s.push(wall_s);
                    let stages = result.report.wall_s.iter();
                    outcome.stages_s = stages.map(|(k, v)| ((*k).to_owned(), *v)).collect();
                }
            }
        }
        Ok(outcomes)
    }
}

fn shuffle<T>(list: &mut [T], draw: &mut Draw) {
    for i in (1..list.len()).rev() {
        list.swap(i, draw.below(i + 1));
    }
}

fn pack(reference: &Reference) -> Vec<u8> {
    let mut bytes = reference.occupancy.to_dense();
    bytes.extend(reference.latent.iter().flat_map(|v| v.to_le_bytes()));
    bytes
}

fn unpack(bytes: &[u8]) -> Option<Reference> {
    let (labels, latent) = bytes.split_at_checked(Window::COLUMNS * Window::NZ)?;
    let latent: Vec<f32> = latent
        .chunks_exact(4)
        .filter_map(|b| b.try_into().ok().map(f32::from_le_bytes))
        .collect();
    let whole = latent.len() == LATENT && latent.iter().all(|v| v.is_finite());
    let occupancy = VoxelGrid::from_dense(labels).ok().filter(|_| whole)?;
    Some(Reference { occupancy, latent })
}
