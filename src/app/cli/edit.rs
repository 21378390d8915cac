//! `sceneloom edit`: apply edits, regenerate what they touch by inversion.

use std::path::PathBuf;

use anyhow::{Context, anyhow};
use serde_json::json;

use super::document;
use super::generate::run_and_adopt;
use super::progress::ProgressLine;
use super::{CommandResult, Common, Gen, Stop, Weights, output};
use app::open;
use app::text::with_conditions;
use authoring::new_ground::with_scenery;
use editor::Edit;
use formats::input;
use job::pipeline::OccPipeline;
use job::{GenParams, Job};
use metrics::agreement::layout_agreement;
use scene::{Frame, Lattice};
use sensors::lidar::recorded;

/// Arguments.
#[derive(clap::Args)]
pub struct EditCommand {
    /// Scene to read.
    scene: PathBuf,
    /// JSON list of edits.
    #[arg(long, value_name = "E.json")]
    edits: PathBuf,
    /// Scene to write.
    #[arg(short, long, value_name = "S.loom")]
    output: PathBuf,
    /// Also measure how well inverting and sampling again gives back the source; exit 1 if a voxel
    /// outside the region changed.
    #[arg(long)]
    verify: bool,
    #[command(flatten)]
    generation: Gen,
    #[command(flatten)]
    weights: Weights,
    #[command(flatten)]
    common: Common,
}

/// A JSON list of edits.
pub fn read_edits(path: &std::path::Path) -> anyhow::Result<Vec<Edit>> {
    let name = path.display();
    let text = input::read_text(path, input::LARGEST_TEXT)?;
    serde_json::from_str(&text).with_context(|| name.to_string())
}

/// Voxels that differ from what was last generated or read, those aside that were painted: the next generation draws them.
fn pending(frame: &Frame) -> usize {
    let differ = frame.occupancy.count_different(&frame.source.occupancy);
    let source = &frame.source.occupancy;
    let painted = frame.painted.iter_set();
    let kept = painted.filter(|(x, y, z, class)| source.get(*x, *y, *z) != *class);
    differ.saturating_sub(kept.count())
}

impl EditCommand {
    pub(super) fn run(self) -> CommandResult {
        let scene = open::scene(&self.scene)?;
        let edits = read_edits(&self.edits)?;
        let progress = ProgressLine::new(&self.common);
        let params = self.generation.params(GenParams::default())?;
        let seed = scene.conditions.seed;
        let mut document = document::opened(scene);
        let before = document.scene().clone();
        let lattice = before.frame().extent().lattice();
        if self.verify && lattice != Lattice::OCC3D {
            return Err(anyhow!(
                "--verify compares maps of voxels of {} m, and this one is of {lattice}",
                Lattice::OCC3D.voxel_m()
            )
            .into());
        }
        let mut said = editor::remarks(&before, &edits);
        let pending = pending(before.canvas());
        if pending > 0 {
            said.push(format!(
                "{pending} voxels that were changed before and not generated since are drawn anew, too"
            ));
        }
        document
            .apply_all("Edit", &with_scenery(&before, with_conditions(&edits, seed)))
            .with_context(|| self.edits.display().to_string())?;
        let mut pipeline = OccPipeline::new(self.generation.models(&self.weights)?);
        let round_trip = if self.verify {
            let job = Job {
                scene: before,
                params: params.clone(),
            };
            Some(progress.with_ctx(|ctx| pipeline.round_trip(&job, ctx))?)
        } else {
            None
        };
        let result = run_and_adopt(&mut document, &mut pipeline, params.clone(), &progress, None)?;
        document::save(&self.output, &document)?;
        let scene = document.scene();
        let r = &result.report;
        let agreement = layout_agreement(scene.frame());
        let recorded = recorded::edits_of(scene).map(|edits| [edits.changed.len(), edits.added.len()]);
        said.extend(recorded.map(|told| match told {
            [0, 0] => "the recorded sweep stays as it is".to_owned(),
            [changed, added] => format!("recorded sweep: {changed} returns gone or replaced, {added} new"),
        }));
        let report = json!({
            "occupancy": {
                "occupied_voxels": scene.frame().occupancy.count_set(),
                "layout_agreement": agreement,
            },
            "edits": edits.len(),
            "network_calls": r.network_calls,
            "inversion_calls": r.inversion_calls,
            "wall_s": r.wall_s,
            "peak_rss_mb": output::peak_rss_mb(),
            "objects_kept": r.objects_kept,
            "ground_kept": r.ground_kept,
            "invented_cleared": r.invented_cleared,
            "stems_added": r.stems_added,
            "loose_dropped": r.loose_dropped,
            "unobserved_kept": r.unobserved_kept,
            "unchanged_kept": r.unchanged_kept,
            "seed": params.seed,
            "steps": params.steps,
            "model": pipeline.models().card.name,
            "region": { "columns": r.region_columns, "share": r.region_share },
            "tokens": r.tokens,
            "voxels_changed": r.voxels_changed,
            "untouched_voxels_changed": r.untouched_voxels_changed,
            "seam_change_share": r.seam_change_share,
            "round_trip_error": round_trip,
            "recorded_sweep": recorded.map(|[changed, added]| json!({ "changed": changed, "added": added })),
            "noise": { "std": r.noise_std, "max_abs": r.noise_max_abs },
            "notes": said.iter().chain(&r.notes).collect::<Vec<_>>(),
            "file": self.output,
        });
        output::report(&self.common, &report, || {
            let notes = said.iter().chain(&r.notes).map(|n| format!("\nnote: {n}"));
            let notes: String = notes.collect();
            format!(
                "{}: {} edits, {} voxels changed in {} columns ({:.1} %), {} outside, {} network calls, {:.1} s{notes}",
                self.output.display(),
                edits.len(),
                r.voxels_changed,
                r.region_columns,
                r.region_share * 100.0,
                r.untouched_voxels_changed,
                r.network_calls,
                r.total_s(),
            )
        });
        if self.verify && r.untouched_voxels_changed > 0 {
            return Err(Stop::Short(format!(
                "{} voxels outside the region changed",
                r.untouched_voxels_changed
            )));
        }
        Ok(())
    }
}
