//! `sceneloom eval`: quality on held-out worlds, with 95 % intervals over scenes. The networks' own
//! output is judged: drafts are not put in for boxes that they left out.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::DVec3;
use serde_json::{Value, json};

use super::generate::{full_params, models};
use super::progress::Progress;
use super::{Common, Gen, Outcome, Stop, output};
use crate::editor::{Document, Edit};
use crate::generation::dataset::{OccupancyFrame, occupancy_frame};
use crate::generation::job::{GenParams, Job, JobCtx, Pipeline};
use crate::generation::metrics::agreement::AgreementCount;
use crate::generation::metrics::iou::Confusion;
use crate::generation::metrics::stats::{mean_ci95, median};
use crate::generation::pipeline::OccPipeline;
use crate::generation::world::World;
use crate::generation::world::draw::{Draw, hash};
use crate::generation::world::voxelize::{Vertical, complete};
use crate::scene::raster::box_cells;
use crate::scene::{BevLayer, BoxId, Class, Frame, GridSpec, Scene, SceneBox, SensorRig, VoxelGrid};

/// Seed of the held-out worlds; training uses 1, validation 2.
const TEST_SEED: u64 = 3;

/// Arguments.
#[derive(clap::Args)]
pub struct Eval {
    /// What is measured.
    #[arg(value_parser = ["vae", "generation", "editing"])]
    suite: String,
    /// Number of held-out worlds.
    #[arg(long, value_name = "N", default_value_t = 24)]
    frames: usize,
    /// Fail (exit 1) if a bar of the suite is missed.
    #[arg(long)]
    bar: bool,
    #[command(flatten)]
    generation: Gen,
    #[command(flatten)]
    common: Common,
}

fn with_interval(values: &[f64]) -> Value {
    let (mean, half) = mean_ci95(values);
    let round = |v: f64| (v * 1e4).round() / 1e4;
    json!({ "mean": round(mean), "ci95": round(half), "n": values.len() })
}

/// Held-out world `index` as a scene with complete occupancy.
fn scene(index: u64) -> Scene {
    let seed = hash(hash(TEST_SEED) ^ index);
    let world = World::random(seed);
    let grid = complete(&world, Vertical::Occ3d);
    let frame = Frame::new(world.layout.clone(), world.boxes.clone(), grid);
    Scene::single("held out", frame, Arc::new(SensorRig::default()), seed)
}

/// One bar: name, figure, the least it should be.
type Bar = (&'static str, f64, f64);

impl Eval {
    pub(super) fn run(self) -> Outcome {
        let progress = Progress::new(&self.common);
        let mut pipeline = OccPipeline::new(models(self.common.weights.as_deref())?);
        let (mut report, bars) = match self.suite.as_str() {
            "vae" => self.vae(&pipeline, &progress)?,
            "generation" => self.generation(&mut pipeline, &progress)?,
            _ => self.editing(&mut pipeline, &progress)?,
        };
        progress.done();
        report["seeds"] = json!({ "test": TEST_SEED });
        report["n"] = self.frames.into();
        report["model"] = pipeline.models().card.name.clone().into();
        let missed: Vec<String> = bars
            .iter()
            .filter(|(_, found, least)| found.is_nan() || found < least)
            .map(|(name, found, least)| format!("{name} {found:.3} below {least}"))
            .collect();
        report["bars"] = bars
            .iter()
            .map(|(name, found, least)| json!({ "name": name, "found": found, "least": least }))
            .collect();
        output::report(&self.common, &report, || {
            serde_json::to_string_pretty(&report).unwrap_or_default()
        });
        if self.bar && !missed.is_empty() {
            return Err(Stop::Short(missed.join("; ")));
        }
        Ok(())
    }

    /// Encode and decode: complete worlds and simulated labels.
    fn vae(&self, pipeline: &OccPipeline, progress: &Progress) -> anyhow::Result<(Value, Vec<Bar>)> {
        let vae = &pipeline.models().vae;
        type Pick = fn(&OccupancyFrame) -> &VoxelGrid;
        let kinds: [(&str, Pick); 2] = [("complete", |f| &f.dense), ("labels", |f| &f.labels)];
        let mut totals = [Confusion::default(), Confusion::default()];
        let mut frames: [[Vec<f64>; 2]; 2] = Default::default();
        let mut agreement = AgreementCount::default();
        for i in 0..self.frames {
            progress.at("vae", i, self.frames);
            let world = occupancy_frame(TEST_SEED, i as u64);
            for (k, (_, pick)) in kinds.iter().enumerate() {
                let truth = pick(&world);
                let found = vae.decode(&vae.encode(truth)?)?;
                if k == 0 {
                    agreement.add(scene(i as u64).frame(), &found);
                }
                let mut one = Confusion::default();
                one.add(truth, &found);
                totals[k].merge(&one);
                frames[k][0].extend(one.mean_iou().0);
                frames[k][1].extend(one.occupied_iou());
            }
        }
        let mut report = json!({});
        for (k, (name, _)) in kinds.iter().enumerate() {
            let (mean, present) = totals[k].mean_iou();
            let per_class: BTreeMap<&str, f64> = Class::ALL[..17]
                .iter()
                .filter_map(|c| Some((c.name(), (totals[k].class_iou(*c)? * 1e3).round() / 1e3)))
                .collect();
            report[*name] = json!({
                "miou": mean,
                "iou": totals[k].occupied_iou(),
                "classes_present": present,
                "miou_per_frame": with_interval(&frames[k][0]),
                "iou_per_frame": with_interval(&frames[k][1]),
                "per_class": per_class,
            });
        }
        report["complete"]["layout_agreement_of_reconstructions"] = json!(agreement.iou());
        let bars = vec![
            ("complete miou", totals[0].mean_iou().0.unwrap_or(f64::NAN), 0.75),
            ("complete iou", totals[0].occupied_iou().unwrap_or(f64::NAN), 0.80),
        ];
        Ok((report, bars))
    }

    /// Occupancy from the layout alone, against the layout.
    fn generation(
        &self,
        pipeline: &mut OccPipeline,
        progress: &Progress,
    ) -> anyhow::Result<(Value, Vec<Bar>)> {
        let (mut all, mut world_all) = (AgreementCount::default(), AgreementCount::default());
        let (mut drivable, mut vehicles, mut wall_s) = (Vec::new(), Vec::new(), Vec::new());
        let mut params = GenParams {
            keep_objects: false,
            ..self.generation.params(full_params())
        };
        for i in 0..self.frames {
            progress.at("generation", i, self.frames);
            let scene = scene(i as u64);
            world_all.add(scene.frame(), &scene.frame().occupancy);
            params.seed = self.generation.seed + i as u64;
            let job = Job {
                scene: Arc::new(scene),
                params,
            };
            let result = pipeline.run(&job, &JobCtx::detached())?;
            wall_s.push(result.report.total_s());
            all.add(job.scene.frame(), &result.occupancy);
            let mut one = AgreementCount::default();
            one.add(job.scene.frame(), &result.occupancy);
            drivable.extend(one.iou().drivable);
            vehicles.extend(one.iou().vehicles);
        }
        let found = all.iou();
        let report = json!({
            "layout_agreement": found,
            "drivable_per_frame": with_interval(&drivable),
            "vehicles_per_frame": with_interval(&vehicles),
            "layout_agreement_of_the_worlds_themselves": world_all.iou(),
            "wall_s_median": median(&wall_s),
            "steps": params.steps,
            "guidance": params.guidance,
        });
        let bars = vec![
            ("drivable agreement", found.drivable.unwrap_or(f64::NAN), 0.80),
            ("vehicle agreement", found.vehicles.unwrap_or(f64::NAN), 0.80),
        ];
        Ok((report, bars))
    }

    /// One car removed, one truck added on free road, per world.
    fn editing(&self, pipeline: &mut OccPipeline, progress: &Progress) -> anyhow::Result<(Value, Vec<Bar>)> {
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
