//! One table of suites: what each measures, on how much, and which figures of its report are shown.

use serde_json::{Value, json};

pub use crate::options::Options;

use crate::Progress;
use crate::held_out::TEST_SEED;
use crate::suites::generation;
use job::pipeline::OccPipeline;
use metrics::stats::mean_ci95;
use nets::OccModels;

/// One bar: name, figure, the least it should be.
pub type Bar = (&'static str, f64, f64);

/// A report with its bars.
pub(crate) type Found = (Value, Vec<Bar>);

/// Mean, half width of its 95 % interval and number of values, for a report.
pub(crate) fn with_interval(values: &[f64]) -> Value {
    let (mean, half) = mean_ci95(values);
    let round = |v: f64| (v * 1e4).round() / 1e4;
    json!({ "mean": round(mean), "ci95": round(half), "n": values.len() })
}

/// A kind of evaluation.
pub struct Suite {
    /// As it is called on the command line.
    pub name: &'static str,
    /// What it tells, in one line.
    pub title: &'static str,
    /// Figures of the report that are shown: name with unit, and JSON pointer to a number, to `mean` with `ci95`, or to `share`
    /// with `low` and `high`.
    pub figures: &'static [(&'static str, &'static str)],
    /// Makes options small, so that all suites together take about five minutes on two cores.
    pub quick: fn(&mut Options),
    /// Measures.
    pub(crate) run: fn(&Options, &dyn Progress) -> anyhow::Result<Found>,
}

/// What a suite found.
pub struct Report {
    /// Everything, with `bars`, `seeds` and `n`.
    pub json: Value,
    /// Its bars.
    pub bars: Vec<Bar>,
}

/// True if a bar is missed; a figure that is not there misses it.
fn is_missed((_, found, least): &Bar) -> bool {
    found.is_nan() || found < least
}

impl Report {
    /// The bars that were missed, in words.
    pub fn missed(&self) -> Vec<String> {
        let missed = self.bars.iter().filter(|b| is_missed(b));
        missed
            .map(|(name, found, least)| format!("{name} {found:.3} below {least}"))
            .collect()
    }
}

impl Suite {
    /// Runs it. Errors are one line: weights, files or options that will not do.
    pub fn measure(&self, options: &Options, progress: &dyn Progress) -> anyhow::Result<Report> {
        let (mut json, bars) = (self.run)(options, progress)?;
        json["seeds"] = json!({ "test": TEST_SEED });
        let n = json.get("files").or(json.get("prompts")).cloned();
        json["n"] = n.unwrap_or_else(|| options.frames.into());
        json["bars"] = bars
            .iter()
            .map(|(name, found, least)| json!({ "name": name, "found": found, "least": least }))
            .collect();
        Ok(Report { json, bars })
    }

    /// The report for a person.
    pub fn text(&self, report: &Value) -> String {
        match self.name {
            "generation" => generation::table(report),
            _ => serde_json::to_string_pretty(report).unwrap_or_default(),
        }
    }
}

/// The suite of that name.
pub fn named(name: &str) -> Option<&'static Suite> {
    SUITES.iter().find(|s| s.name == name)
}

/// Runs `with` on the networks of the options; the report names them.
fn with_pipeline(
    options: &Options,
    with: impl FnOnce(&mut OccPipeline) -> anyhow::Result<Found>,
) -> anyhow::Result<Found> {
    let mut pipeline = OccPipeline::new(OccModels::of(options.weights.as_deref())?);
    let (mut report, bars) = with(&mut pipeline)?;
    report["model"] = pipeline.models().card.name.clone().into();
    Ok((report, bars))
}

/// All suites, in the order of `eval all`.
pub static SUITES: [Suite; 7] = [
    Suite {
        name: "world",
        title: "Procedural worlds beside what is known of real drives",
        figures: &[
            ("figures inside the range of real data", "/inside"),
            ("of so many", "/of"),
            (
                "findings of the checks per world",
                "/complete_worlds/findings_per_world",
            ),
            (
                "share of worlds with an error",
                "/complete_worlds/share_with_errors",
            ),
            ("lost echoes told by class, range, angle (AUC)", "/lidar/lost_auc"),
        ],
        quick: |options| options.frames = 16,
        run: |options, progress| options.world(progress),
    },
    Suite {
        name: "vae",
        title: "What encoding and decoding keep",
        figures: &[
            ("complete worlds, mIoU", "/complete/mean/miou_per_frame"),
            ("complete worlds, IoU", "/complete/mean/iou_per_frame"),
            ("labels, mIoU", "/labels/mean/miou_per_frame"),
            (
                "labels, mIoU, told the draft and what was observed",
                "/labels/told/miou_per_frame",
            ),
            ("labels, mIoU, fine latents", "/labels/fine/miou_per_frame"),
            (
                "mIoU that slopes cost at most",
                "/labels_on_slopes/worst_loss_of_miou",
            ),
        ],
        quick: |options| options.frames = 3,
        run: |options, progress| {
            with_pipeline(options, |pipeline| match &options.data {
                Some(dir) => options.vae_on_files(dir, pipeline, progress),
                None => options.vae(pipeline, progress),
            })
        },
    },
    Suite {
        name: "generation",
        title: "Scenes from their layout alone",
        figures: &[
            (
                "drivable agreement",
                "/rows/generated/layout_agreement/drivable_per_frame",
            ),
            (
                "vehicle agreement",
                "/rows/generated/layout_agreement/vehicles_per_frame",
            ),
            (
                "told from worlds, by scene (.5: not at all)",
                "/rows/scenery_drawn/told_apart/occupancy/scene",
            ),
            (
                "the same of as many worlds",
                "/rows/worlds/told_apart/occupancy/scene",
            ),
            (
                "cells Fréchet, scenery drawn",
                "/rows/scenery_drawn/distances/cells/frechet",
            ),
            (
                "cells Fréchet, as many worlds",
                "/rows/worlds/distances/cells/frechet",
            ),
            (
                "findings per scene, scenery drawn",
                "/rows/scenery_drawn/findings/all",
            ),
            (
                "given manmade background, footprint IoU",
                "/background_given/manmade/footprint_iou",
            ),
            ("diversity across seeds (1 - IoU)", "/diversity_across_seeds"),
            ("time of a scene, s (median)", "/wall_s_median"),
        ],
        quick: |options| (options.frames, options.rows_only) = (4, true),
        run: |options, progress| with_pipeline(options, |pipeline| options.generation(pipeline, progress)),
    },
    Suite {
        name: "editing",
        title: "Edits do what they say, and nothing else",
        figures: &[
            ("removals that succeed", "/kinds/remove/success"),
            ("additions that succeed", "/kinds/add/success"),
            ("moves that succeed", "/kinds/move/success"),
            ("changes of class that succeed", "/kinds/class/success"),
            ("roads that are widened", "/kinds/road/success"),
            ("crossings that are painted", "/kinds/crossing/success"),
            ("untouched voxels changed", "/untouched_voxels_changed"),
            ("round trip error of inversion", "/round_trip_error"),
            (
                "two edits in either order differ (share of voxels)",
                "/two_edits_in_either_order_differ",
            ),
            ("time of a removal, s (median)", "/kinds/remove/wall_s_median"),
            ("time of inverting a scene, s (median)", "/inversion_s_median"),
        ],
        quick: |options| {
            (options.frames, options.vehicles, options.band_worlds) = (2, 1, 2);
            options.presets = vec!["balanced".into()];
        },
        run: |options, progress| with_pipeline(options, |pipeline| options.editing(pipeline, progress)),
    },
    Suite {
        name: "lidar",
        title: "LiDAR sweeps against the analytic surfaces of worlds",
        figures: &[
            (
                "range error, learned, m (median)",
                "/complete/learned/range_error_m/p50",
            ),
            (
                "range error, lifted voxel cast, m (median)",
                "/complete/voxel_cast_lifted/range_error_m/p50",
            ),
            (
                "range error, learned, m (mean)",
                "/complete/learned/range_error_m/mean",
            ),
            ("JSD of bird's-eye maps, learned", "/complete/learned/jsd"),
            ("MMD, learned (1e-4)", "/complete/learned/mmd_1e-4"),
            ("lost echoes, AUC", "/complete/echoes/drop_auc"),
            ("time of a sweep, s (median)", "/complete/learned/wall_s"),
        ],
        quick: |options| options.frames = 3,
        run: |options, progress| options.lidar(progress),
    },
    Suite {
        name: "splat",
        title: "Camera maps beside those of the analytic worlds",
        figures: &[
            ("labels agree, marched with boxes", "/march_boxes/label_agreement"),
            ("labels agree, splats", "/splat/label_agreement"),
            (
                "depth error, marched with boxes, m (median)",
                "/march_boxes/depth_error_median_m",
            ),
            ("depth error, splats, m (median)", "/splat/depth_error_median_m"),
            (
                "time of six maps, marched with boxes, ms (median)",
                "/march_boxes/ms_median",
            ),
            ("time of six maps, splats, ms (median)", "/splat/ms_median"),
        ],
        quick: |options| options.frames = 3,
        run: |options, progress| options.splat(progress),
    },
    Suite {
        name: "layout",
        title: "Sentences become scenes and edits",
        figures: &[
            ("prompts wholly right", "/made/wholly_right"),
            ("edits wholly right", "/edited/wholly_right"),
            ("prompts silently wrong", "/made/silently_wrong"),
            ("edits silently wrong", "/edited/silently_wrong"),
            ("counts exact, prompts", "/made/counts_exact"),
            ("relations satisfied, prompts", "/made/relations_satisfied"),
            ("time of a prompt, s (median)", "/made/wall_s_median"),
            ("time of an edit, s (median)", "/edited/wall_s_median"),
        ],
        quick: |options| (options.sentences, options.placer_prompts) = (Some(240), 2),
        run: |options, progress| options.layout(progress),
    },
];
