//! `eval splat`: camera maps by splats and by marching, compared with those of the analytic worlds.

use std::time::Instant;

use rayon::prelude::*;
use serde_json::json;

use crate::suite::{Options, SuiteFigures, with_interval};
use calibration::MeasurementProgress;
use calibration::held_out::TEST_SEED;
use dataset::world_of;
use metrics::maps::{LabelledDepth, MapAgreement, OUTLINE_PX};
use numeric::quantile::median;
use scene::raster::bev_channels;
use scene::{Camera, CameraMaps, Class, SensorRig, Window};
use sensors::pictures::march::{CameraRays, GroundHeight, MarchOptions, MarchScene};
use sensors::splat::cloud::GaussianCloud;
use sensors::splat::{self, SplatOptions};
use world::World;
use world::voxelize::{Vertical, complete};

/// Size of the judged pictures; that of the editor's views.
const SIZE: [u32; 2] = splat::VIEW_SIZE;
/// Size of the timed pictures.
const TIMED: [u32; 2] = [800, 450];
/// Seed of the shapes of the boxes' solids. It differs from the worlds' seed, since the true shapes are unknown in
/// practice.
const SHAPE_SEED: u64 = 77;

/// The ways to draw, with their names.
const WAYS: [(&str, Option<(GroundHeight, bool)>); 5] = [
    ("splat", None),
    ("march", Some((GroundHeight::AsLabelled, false))),
    ("march_boxes", Some((GroundHeight::AsLabelled, true))),
    ("march_physical", Some((GroundHeight::Physical, false))),
    ("march_boxes_physical", Some((GroundHeight::Physical, true))),
];

/// Figures of one way, one value per world.
#[derive(Default)]
struct SplatFigures {
    labels: Vec<f64>,
    depth_median_m: Vec<f64>,
    depth_p95_m: Vec<f64>,
    outline: [Vec<f64>; 2],
    ms: Vec<f64>,
}

/// Labels with lane paint as road: paint is not part of the analytic worlds.
fn without_paint(maps: CameraMaps) -> LabelledDepth {
    let road = Class::DriveableSurface.id();
    LabelledDepth {
        width: maps.width,
        label: maps
            .semantic
            .iter()
            .map(|id| if *id > 16 { road } else { *id })
            .collect(),
        depth_m: maps.depth_m,
    }
}

/// Maps of a camera in the analytic world inside the grid's height.
fn truth(world: &World, camera: &Camera) -> LabelledDepth {
    let [width, height] = SIZE;
    let rays = CameraRays::new(camera, width, height);
    let pixels: Vec<(u8, f32)> = (0..(width * height) as usize)
        .into_par_iter()
        .map(|i| {
            let (u, v) = (i % width as usize, i / width as usize);
            let along = rays.at(u as f64 + 0.5, v as f64 + 0.5).direction;
            let dir = along.normalize();
            let hit = world.cast(rays.origin, dir, 200.0);
            // The grid holds nothing of higher things.
            let low = hit.filter(|h| rays.origin.z + dir.z * h.range_m < Window::MAX_M[2]);
            low.map_or((0, -1.0), |h| (h.class.id(), (h.range_m / along.length()) as f32))
        })
        .collect();
    let (label, depth_m) = pixels.into_iter().unzip();
    LabelledDepth {
        width: width as usize,
        label,
        depth_m,
    }
}

impl Options {
    /// Judges label agreement, depth error and outlines of every way to draw maps; no bars.
    pub(crate) fn splat(&self, progress: &dyn MeasurementProgress) -> anyhow::Result<SuiteFigures> {
        let rig = SensorRig::default();
        let mut found: [SplatFigures; WAYS.len()] = Default::default();
        for i in 0..self.frames {
            progress.at("splat", i, self.frames);
            let (world, _) = world_of(TEST_SEED, i as u64, |_| None);
            let grid = complete(&world, Vertical::Occ3d);
            let truths: Vec<LabelledDepth> = rig.cameras.iter().map(|c| truth(&world, c)).collect();
            for ((_, way), found) in WAYS.iter().zip(&mut found) {
                let draw = |[w, h]: [u32; 2]| match way {
                    None => {
                        let bev = bev_channels(&world.layout, world.boxes.values());
                        let cloud = GaussianCloud::from_grid(&grid, &bev);
                        splat::render_rig(&cloud, &rig, w, h, &SplatOptions::default())
                    }
                    Some((ground, boxes)) => {
                        let options = MarchOptions {
                            ground: *ground,
                            boxes: *boxes,
                            lines: true,
                            seed: SHAPE_SEED,
                        };
                        let scene = MarchScene::new(&grid, &world.layout, &world.boxes, &options);
                        scene.render_rig(&rig, w, h)
                    }
                };
                let mut agreement = MapAgreement::default();
                for (maps, truth) in draw(SIZE).into_iter().zip(&truths) {
                    agreement.add(&without_paint(maps), truth);
                }
                let start = Instant::now();
                draw(TIMED);
                found.ms.push(start.elapsed().as_secs_f64() * 1e3);
                found.labels.push(agreement.labels());
                let (median_m, p95_m) = agreement.depth_error_m();
                found.depth_median_m.push(median_m);
                found.depth_p95_m.push(p95_m);
                for (all, f) in found.outline.iter_mut().zip(agreement.outline_f()) {
                    all.push(f);
                }
            }
        }
        let mut report = json!({ "judged_px": SIZE, "timed_px": TIMED, "cameras": rig.cameras.len() });
        for ((name, _), f) in WAYS.iter().zip(&found) {
            let mut row = json!({
                "label_agreement": with_interval(&f.labels),
                "depth_error_median_m": with_interval(&f.depth_median_m),
                "depth_error_p95_m": with_interval(&f.depth_p95_m),
                "ms_median": (median(&f.ms) * 10.0).round() / 10.0,
            });
            for (px, values) in OUTLINE_PX.iter().zip(&f.outline) {
                row[format!("outline_f_{px}px")] = with_interval(values);
            }
            report[*name] = row;
        }
        Ok((report, Vec::new()))
    }
}
