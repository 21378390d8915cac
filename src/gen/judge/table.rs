//! The table of suites.

use crate::suite::{Options, Suite, SuiteFigures};
use crate::suites::{forecast, gaussians, map};
use job::pipeline::OccPipeline;
use nets::OccModels;

/// All suites, in the order of `eval all`.
pub static SUITES: [Suite; 13] = [
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
        takes_data: false,
        quick: |options| options.frames = 16,
        table: None,
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
        takes_data: true,
        quick: |options| options.frames = 3,
        table: None,
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
        takes_data: false,
        quick: |options| (options.frames, options.rows_only) = (4, true),
        table: Some(crate::suites::generation::table),
        run: |options, progress| with_pipeline(options, |pipeline| options.generation(pipeline, progress)),
    },
    Suite {
        name: "map",
        title: "Windows of a map that is generated one by one, the first beside the last",
        figures: &[
            (
                "told from worlds, patches, first half",
                "/rows/first_half/told_apart/occupancy/window",
            ),
            (
                "told from worlds, patches, last half",
                "/rows/last_half/told_apart/occupancy/window",
            ),
            (
                "cells Fréchet, first half",
                "/rows/first_half/distances/cells/frechet",
            ),
            (
                "cells Fréchet, last half",
                "/rows/last_half/distances/cells/frechet",
            ),
            ("findings per window, first half", "/rows/first_half/findings/all"),
            ("findings per window, last half", "/rows/last_half/findings/all"),
        ],
        takes_data: true,
        quick: |options| options.frames = 4,
        table: Some(map::table),
        run: |options, progress| with_pipeline(options, |pipeline| options.map(pipeline, progress)),
    },
    Suite {
        name: "forecast",
        title: "How a drive goes on after two frames",
        figures: &[
            (
                "temporal networks, mIoU after 1 s",
                "/layouts that came/temporal/mIoU 1 s",
            ),
            ("the same, after 3 s", "/layouts that came/temporal/mIoU 3 s"),
            (
                "frame by frame, after 1 s",
                "/layouts that came/single frames/mIoU 1 s",
            ),
            (
                "on the canvas, after 1 s",
                "/layouts that came/canvas, inpainted/mIoU 1 s",
            ),
        ],
        takes_data: false,
        quick: |options| options.frames = 1,
        table: Some(forecast::table),
        run: |options, progress| with_pipeline(options, |pipeline| options.forecast(pipeline, progress)),
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
        takes_data: true,
        quick: |options| {
            (options.frames, options.vehicles, options.band_worlds) = (2, 1, 2);
            options.presets = vec!["balanced".into()];
        },
        table: None,
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
        takes_data: false,
        quick: |options| options.frames = 3,
        table: None,
        run: |options, progress| options.lidar(progress),
    },
    Suite {
        name: "near",
        title: "Walls, posts and fences near the cameras beside those of the analytic worlds",
        figures: &[
            (
                "walls whose normal is off by more than 10 degrees",
                "/level/things/wall_normal_off_by_10_degrees/share",
            ),
            (
                "walls off by more than .15 m",
                "/level/things/wall_off_by_15_cm/share",
            ),
            ("posts missing", "/level/things/posts_missing/share"),
            ("fences missing", "/level/things/fences_missing/share"),
            (
                "man-made surfaces where nothing is",
                "/level/things/manmade_where_nothing_is/share",
            ),
            (
                "walls off by more than .15 m, on slopes",
                "/slopes/things/wall_off_by_15_cm/share",
            ),
        ],
        takes_data: false,
        quick: |options| options.frames = 3,
        table: None,
        run: |options, progress| options.near(progress),
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
        takes_data: false,
        quick: |options| options.frames = 3,
        table: None,
        run: |options, progress| options.splat(progress),
    },
    Suite {
        name: "gaussians",
        title: "Pictures of baked Gaussians beside the renderer's, from unseen poses",
        figures: &[
            ("PSNR of a scene's median picture, dB", "/psnr_median_db"),
            ("PSNR of a scene's worst picture, dB", "/psnr_worst_db"),
            ("time of baking, s (median)", "/bake_s_median"),
        ],
        takes_data: false,
        quick: |options| options.frames = 1,
        table: Some(gaussians::table),
        run: |options, progress| options.gaussians(progress),
    },
    Suite {
        name: "pictures",
        title: "Learned pictures: agreement, likeness over time, edits",
        figures: &[
            (
                "pixels that a segmenter says rightly, rendered",
                "/agreement/rendered",
            ),
            ("pixels that it says rightly, learned", "/agreement/learned"),
            (
                "difference from the moment before, 0 to 1, rendered",
                "/over_time/rendered",
            ),
            (
                "difference from the moment before, learned, told it",
                "/over_time/after_the_frame_before",
            ),
            (
                "difference from the moment before, learned, each alone",
                "/over_time/alone",
            ),
            (
                "difference between cameras, rendered",
                "/between_cameras/rendered",
            ),
            ("difference between cameras, learned", "/between_cameras/learned"),
            (
                "less difference over time by noise of surfaces than of each frame, alone",
                "/over_time/noise/alone/gain_by_surfaces",
            ),
            (
                "the same, told the frame before",
                "/over_time/noise/after_the_frame_before/gain_by_surfaces",
            ),
            (
                "less difference between cameras by shared noise",
                "/between_cameras/gain_by_sharing",
            ),
            ("FID to rendered pictures, rendered", "/likeness/rendered/fid"),
            ("FID to rendered pictures, learned", "/likeness/learned/fid"),
            ("KID to rendered pictures, rendered", "/likeness/rendered/kid"),
            ("KID to rendered pictures, learned", "/likeness/learned/kid"),
            ("share of pixels painted when a car goes", "/edit/painted_share"),
            ("pixels changed elsewhere", "/edit/pixels_changed_elsewhere"),
            ("time of six pictures, s (median)", "/six_pictures_s_median"),
            ("time after the edit, s (median)", "/edit/s_median"),
        ],
        takes_data: false,
        quick: |options| options.frames = 3,
        table: None,
        run: |options, progress| options.pictures(progress),
    },
    Suite {
        name: "downstream",
        title: "Generated scenes as networks of LiDAR and cameras see them that learned from worlds",
        figures: &[
            ("cars found, worlds", "/worlds/cars_found"),
            ("cars found, generated", "/generated/cars_found"),
            ("cars found, the network's own output", "/own_output/cars_found"),
            ("other boxes found, worlds", "/worlds/other_boxes_found"),
            ("other boxes found, generated", "/generated/other_boxes_found"),
            ("ghosts a scene, worlds", "/worlds/ghosts_per_scene"),
            ("ghosts a scene, generated", "/generated/ghosts_per_scene"),
            (
                "columns near returns told rightly, worlds",
                "/worlds/columns_right",
            ),
            (
                "columns near returns told rightly, generated",
                "/generated/columns_right",
            ),
            ("IoU of voxels from both, worlds", "/voxels/worlds/both/iou"),
            ("IoU of voxels from the LiDAR, worlds", "/voxels/worlds/lidar/iou"),
            ("IoU of voxels from cameras, worlds", "/voxels/worlds/cameras/iou"),
            ("IoU of voxels from both, generated", "/voxels/generated/both/iou"),
            (
                "boxes found among voxels from both, worlds",
                "/voxels/worlds/both/boxes_found",
            ),
            (
                "boxes found among voxels from both, generated",
                "/voxels/generated/both/boxes_found",
            ),
            (
                "IoU of voxels from learned pictures, worlds",
                "/voxels/learned_pictures/worlds/told/iou",
            ),
            (
                "IoU of voxels from learned pictures, generated",
                "/voxels/learned_pictures/generated/told/iou",
            ),
            (
                "pixels of learned pictures told rightly, generated",
                "/voxels/learned_pictures/generated/pixels_right",
            ),
            (
                "boxes found by cameras in fog more than in clear air",
                "/voxels/cameras_by_weather/fog/more_than_clear/boxes_found",
            ),
            (
                "boxes found by cameras at night more than in clear air",
                "/voxels/cameras_by_weather/night/more_than_clear/boxes_found",
            ),
        ],
        takes_data: false,
        quick: |options| options.frames = 3,
        table: None,
        run: |options, progress| with_pipeline(options, |pipeline| options.downstream(pipeline, progress)),
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
        takes_data: false,
        quick: |options| (options.sentences, options.placer_prompts) = (Some(240), 2),
        table: None,
        run: |options, progress| options.layout(progress),
    },
];

/// The suite of that name.
pub fn named(name: &str) -> Option<&'static Suite> {
    SUITES.iter().find(|s| s.name == name)
}

/// Runs `with` on the networks of the options. The report names the networks.
fn with_pipeline(
    options: &Options,
    with: impl FnOnce(&mut OccPipeline) -> anyhow::Result<SuiteFigures>,
) -> anyhow::Result<SuiteFigures> {
    let mut pipeline = OccPipeline::new(OccModels::open(options.weights.as_deref())?);
    let (mut report, bars) = with(&mut pipeline)?;
    report["model"] = pipeline.models().card.name.clone().into();
    Ok((report, bars))
}
