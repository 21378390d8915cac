//! Tries one edit: the networks' own result, and what the composite makes of it.

use std::sync::Arc;

use calibration::trials::{Reached, Trial};
use editor::Document;
use job::guards::clear::{keep_clear, keep_unobserved};
use job::guards::grounded::keep_grounded;
use job::guards::objects::{keep_ground, keep_objects};
use job::inpaint;
use job::invented::Invented;
use job::pipeline::OccPipeline;
use job::request::{VoxelRequest, voxels_of};
use job::{GenParams, Job, JobCtx, Pipeline};
use scene::{BevLayout, Class, Extent, Scene, SceneBox, VoxelGrid, draft};

/// States of a result, in the order in which the composite makes them: the networks alone; with placed boxes and
/// painted ground kept; as the editor shows it, with the road kept clear and unobserved places kept as well.
pub const STATES: [&str; 3] = ["networks", "objects_kept", "shown"];

/// Outcome of an edit.
pub struct Tried {
    /// Success shares, by state.
    pub reached: [Reached; 3],
    /// Invented voxels, by state.
    pub invented: [Invented; 3],
    /// The object that it added or moved, if there is one.
    pub brought: Option<Brought>,
}

/// Number of voxels of an object that was added, moved or changed its class.
#[derive(Clone, Copy, Debug)]
pub struct Brought {
    /// Class of the object after the edit.
    pub class: Class,
    /// Voxels in the source, if an object of the same class moved; else `None`.
    pub before: Option<usize>,
    /// Voxels in the draft.
    pub draft: usize,
    /// Voxels in the networks' own result.
    pub networks: usize,
    /// Voxels in the result as shown.
    pub shown: usize,
    /// Voxels in the result as shown, where the networks' own result holds the same class.
    pub shared: usize,
}

impl Brought {
    fn from_trial(
        trial: &Trial,
        b: &SceneBox,
        layout: &BevLayout,
        source: &VoxelGrid,
        states: &[VoxelGrid; 3],
    ) -> Self {
        let from_ground = |(x, y, layers): (usize, usize, usize)| {
            layers - draft::ground_bin(layout, x, y).min(layers.saturating_sub(1))
        };
        let [networks, _, shown] = states;
        // Voxels of the class that the networks and the shown result share.
        let mut both = VoxelGrid::new();
        let same = networks
            .iter_set()
            .filter(|(x, y, z, l)| shown.get(*x, *y, *z) == *l);
        same.filter(|(.., l)| *l == b.class.id())
            .for_each(|(x, y, z, l)| both.set(x, y, z, l));
        Self {
            class: b.class,
            before: trial
                .gone()
                .filter(|old| old.class == b.class)
                .map(|old| voxels_of(source, old)),
            draft: draft::box_columns(Extent::WINDOW, b)
                .into_iter()
                .map(from_ground)
                .sum(),
            networks: voxels_of(networks, b),
            shown: voxels_of(shown, b),
            shared: voxels_of(&both, b),
        }
    }
}

/// Tries an edit; `pipeline` itself is left as it was. With `params.keep_objects` off, the pipeline returns the
/// networks' own result, and the steps of the composite are applied here in the pipeline's order.
pub fn try_edit(
    pipeline: &OccPipeline,
    scene: &Scene,
    trial: &Trial,
    params: GenParams,
) -> anyhow::Result<Tried> {
    let mut document = Document::new(scene.clone());
    document.apply("Edit", &trial.edit)?;
    let job = Job {
        scene: document.scene().clone(),
        params: GenParams {
            keep_objects: false,
            ..params.clone()
        },
    };
    let networks = pipeline.clone().run(&job, &JobCtx::detached())?.occupancy;
    let frame = Arc::clone(job.scene.frame());
    let (region, request) = (
        inpaint::region_of(&frame, &params),
        VoxelRequest::from_frame(&frame),
    );
    let mut kept = networks.clone();
    keep_objects(&frame, &region, false, &mut kept);
    keep_ground(&frame, &region, &mut kept);
    let mut shown = kept.clone();
    keep_unobserved(&frame, &region, &params.inpaint, &request, &mut shown);
    keep_clear(&frame, &region, &params.inpaint, &request, &mut shown);
    keep_grounded(&frame, &region, false, &request, &mut shown);
    let states = [networks, kept, shown];
    let source = &frame.source.occupancy;
    Ok(Tried {
        reached: [0, 1, 2].map(|i| trial.judge(source, &states[i])),
        invented: [0, 1, 2].map(|i| Invented::of_request(&request, &frame, &states[i], &region)),
        brought: trial
            .filled()
            .map(|b| Brought::from_trial(trial, b, &frame.layout, source, &states)),
    })
}
