//! `eval editing`: do edits do what they say, and nothing else?

use std::sync::Arc;

use glam::DVec3;
use serde_json::{Value, json};

use super::{Bar, Eval, scene, with_interval};
use crate::app::cli::progress::Progress;
use crate::editor::{Document, Edit};
use crate::generation::job::{GenParams, Job, JobCtx, Pipeline};
use crate::generation::metrics::stats::{mean_ci95, median};
use crate::generation::pipeline::OccPipeline;
use crate::generation::world::draw::Draw;
use crate::scene::raster::box_cells;
use crate::scene::{BevLayer, BoxId, Class, Frame, GridSpec, Scene, SceneBox, VoxelGrid};

impl Eval {
    /// One car removed, one truck added on free road, per world.
    pub(super) fn editing(&self, pipeline: &mut OccPipeline, progress: &Progress) -> anyhow::Result<(Value, Vec<Bar>)> {
        let params = GenParams {
            keep_objects: false,
            ..self.generation.params(GenParams::default())
        };
        let ctx = JobCtx::detached();
        let mut gone = Vec::new();
        let mut filled = Vec::new();
        let (mut remove_s, mut add_s, mut invert_s, mut seam, mut round_trip) =
            (Vec::new(), Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let mut untouched = 0;
        for i in 0..self.frames {
            progress.at("editing", i, self.frames);
            let scene = scene(i as u64);
            let start = std::time::Instant::now();
            let job = Job {
                scene: Arc::new(scene.clone()),
                params,
            };
            pipeline.prepare(&job, &ctx)?;
            invert_s.push(start.elapsed().as_secs_f64());
            round_trip.push(pipeline.round_trip(&job, &ctx)?);
            let cars = scene.frame().boxes.values().filter(|b| b.class == Class::Car);
            if let Some(car) = cars
                .min_by(|a, b| a.center_m.length().total_cmp(&b.center_m.length()))
                .copied()
            {
                let (before, after, report) =
                    edited(pipeline, &scene, &Edit::RemoveBox { id: car.id }, params)?;
                gone.extend(removed_share(&car, &before, &after));
                untouched += report.untouched_voxels_changed;
                seam.push(report.seam_change_share);
                remove_s.push(report.total_s());
            }
            if let Some(truck) = free_truck(scene.frame(), i as u64) {
                let edit = Edit::AddBox {
                    class: truck.class,
                    center_m: truck.center_m,
                    size_m: truck.size_m,
                    yaw_deg: truck.yaw_rad.to_degrees(),
                    velocity_mps: None,
                    id: None,
                };
                let (_, after, report) = edited(pipeline, &scene, &edit, params)?;
                filled.push(filled_share(&truck, &after));
                untouched += report.untouched_voxels_changed;
                add_s.push(report.total_s());
            }
        }
        let report = json!({
            "removed_car_share_of_voxels_gone": with_interval(&gone),
            "added_truck_share_of_columns_filled": with_interval(&filled),
            "untouched_voxels_changed": untouched,
            "seam_change_share": with_interval(&seam),
            "round_trip_error": with_interval(&round_trip),
            "inversion_s_median": median(&invert_s),
            "remove_s_median": median(&remove_s),
            "add_s_median": median(&add_s),
            "steps": params.steps,
        });
        let bars = vec![
            ("removed car", mean_ci95(&gone).0, 0.95),
            ("added truck", mean_ci95(&filled).0, 0.60),
            (
                "untouched voxels kept",
                if untouched == 0 { 1.0 } else { 0.0 },
                1.0,
            ),
        ];
        Ok((report, bars))
    }
}

/// Applies one edit and regenerates; occupancy before, after, and the cost.
fn edited(
    pipeline: &mut OccPipeline,
    scene: &Scene,
    edit: &Edit,
    params: GenParams,
) -> anyhow::Result<(VoxelGrid, VoxelGrid, crate::generation::job::GenReport)> {
    let mut document = Document::new(scene.clone());
    document.apply("Edit", edit)?;
    let job = Job {
        scene: document.scene().clone(),
        params,
    };
    let result = pipeline.run(&job, &JobCtx::detached())?;
    Ok((scene.frame().occupancy.clone(), result.occupancy, result.report))
}

/// Share of the voxels of the box's class over its footprint that became ground or free; `None` if there were none.
fn removed_share(b: &SceneBox, before: &VoxelGrid, after: &VoxelGrid) -> Option<f64> {
    let (mut all, mut gone) = (0, 0);
    box_cells(b, 0.2, |x, y| {
        for (old, new) in before.column(x, y).iter().zip(after.column(x, y)) {
            if *old == b.class.id() {
                all += 1;
                let ground = Class::from_id(*new).is_some_and(Class::is_ground);
                gone += usize::from(ground || *new == Class::FREE);
            }
        }
    });
    (all > 0).then(|| f64::from(gone as u32) / f64::from(all))
}

/// Share of the box's footprint columns that hold its class.
fn filled_share(b: &SceneBox, after: &VoxelGrid) -> f64 {
    let (mut all, mut hit) = (0u32, 0u32);
    box_cells(b, 0.0, |x, y| {
        all += 1;
        hit += u32::from(after.column(x, y).contains(&b.class.id()));
    });
    f64::from(hit) / f64::from(all.max(1))
}

/// A truck on road that nothing stands on, along the nearest lane.
fn free_truck(frame: &Frame, seed: u64) -> Option<SceneBox> {
    let mut draw = Draw::new(seed, "free truck");
    let objects: u32 = (8..18).map(|bit| 1 << bit).sum();
    let cells = frame.bev_channels();
    let lanes: Vec<_> = frame
        .layout
        .polylines
        .iter()
        .filter(|l| l.kind == crate::scene::PolylineKind::LaneCenter)
        .collect();
    let size_m = DVec3::from_array(Class::Truck.typical_size_m()?);
    for _ in 0..400 {
        let lane = lanes.get(draw.below(lanes.len()))?;
        let k = draw.below(lane.points_m.len().saturating_sub(1));
        let (a, b) = (*lane.points_m.get(k)?, *lane.points_m.get(k + 1)?);
        let truck = SceneBox {
            id: BoxId(0),
            class: Class::Truck,
            center_m: a.extend(size_m.z / 2.0),
            size_m,
            yaw_rad: (b - a).to_angle(),
            velocity_mps: glam::DVec2::ZERO,
        };
        let mut free = truck.footprint().iter().all(|c| c.abs().max_element() < 38.0) && a.length() > 6.0;
        box_cells(&truck, 0.8, |x, y| {
            free &= cells[x * GridSpec::NY + y] & objects == 0
        });
        box_cells(&truck, 0.0, |x, y| {
            free &= frame.layout.has(BevLayer::DrivableArea, x, y)
        });
        if free {
            return Some(truck);
        }
    }
    None
}
