//! Time against error of the sensors' knobs: samples and beams of the LiDAR, cut-offs of the splats, the two VAEs.

use std::sync::Arc;
use std::time::Instant;

use serde_json::{Value, json};

use crate::held_out::{TEST_SEED, bare_scene};
use crate::machine::forget_peak_memory;
use crate::machine::peak_rss_mb;
use dataset::world_of;
use metrics::iou::Confusion;
use metrics::stats::mean_ci95;
use nets::lidar::field::RaySampling;
use nets::lidar::{LearnedRay, LidarNet};
use nets::{OccModels, fine_vae};
use numeric::quantile::quantile;
use scene::raster::bev_channels;
use scene::{CameraMaps, SensorRig};
use sensors::lidar;
use sensors::lidar::learned;
use sensors::splat::cloud::GaussianCloud;
use sensors::splat::{SplatOptions, VIEW_SIZE, render_rig};
use trade::{Interval, bootstrap_median};

/// Samples per ray of the reference.
const REFERENCE_SAMPLES: usize = 4096;
/// Stride of the rays that are compared with the reference.
const COMPARED: usize = 16;

/// One setting of these parts.
pub struct SettingMeasurement {
    /// `lidar`, `splat`, `vae`.
    pub part: &'static str,
    /// The knob's value.
    pub name: String,
    /// Wall times, s.
    pub wall_s: Interval,
    /// Numerical error per scene: metres for LiDAR, share of pixels for splats, share of voxels for the VAEs.
    pub error: Interval,
    /// Other figures.
    pub figures: Value,
    /// Largest memory held, MB.
    pub peak_rss_mb: Option<f64>,
    /// True if it shows something else than the reference, not only less exactly.
    pub other_target: bool,
}

/// Runs `work` `repeats` times. Returns the last result, and the times in s.
fn timed<T>(repeats: usize, mut work: impl FnMut() -> T) -> (T, Vec<f64>) {
    let mut times = Vec::new();
    loop {
        let start = Instant::now();
        let out = work();
        times.push(start.elapsed().as_secs_f64());
        if times.len() >= repeats.max(1) {
            return (out, times);
        }
    }
}

/// Samples per ray of the learned sweep against 4096 on every ray, and beams of the exact cast.
pub fn lidars(frames: usize, repeats: usize) -> anyhow::Result<Vec<SettingMeasurement>> {
    let net = LidarNet::bundled()?;
    let rig = SensorRig::default();
    let Some(pattern) = rig.lidars.first() else {
        return Ok(Vec::new());
    };
    let rays = learned::rays(pattern, rig.velocity_mps());
    let few: Vec<_> = rays.iter().copied().step_by(COMPARED).collect();
    let ways = [
        ("prior".to_owned(), RaySampling::Prior),
        ("18 samples".into(), RaySampling::Uniform(18)),
        ("36 samples".into(), RaySampling::Uniform(36)),
        ("72 samples".into(), RaySampling::Uniform(72)),
        ("144 samples".into(), RaySampling::Uniform(144)),
        ("288 samples".into(), RaySampling::Uniform(288)),
    ];
    let mut walls = vec![Vec::new(); ways.len()];
    let (mut errors, mut flips, mut model) = (walls.clone(), walls.clone(), walls.clone());
    let mut peaks = vec![None; ways.len()];
    for i in 0..frames as u64 {
        let scene = bare_scene(i);
        let (world, _) = world_of(TEST_SEED, i, |_| None);
        let field = net.field(&scene.frame().occupancy)?;
        let exact = net.shoot(&field, &few, RaySampling::Uniform(REFERENCE_SAMPLES))?;
        for (k, (_, sampling)) in ways.iter().enumerate() {
            forget_peak_memory();
            let (found, times) = timed(repeats, || net.shoot(&field, &rays, *sampling));
            peaks[k] = peak_rss_mb();
            walls[k].extend(times);
            let some: Vec<LearnedRay> = found?.into_iter().step_by(COMPARED).collect();
            let both = || some.iter().zip(&exact).filter(|(a, b)| a.is_hit() && b.is_hit());
            let gaps: Vec<f64> = both()
                .map(|(a, b)| f64::from(a.met.median_m - b.met.median_m).abs())
                .collect();
            errors[k].push(quantile(&gaps, 0.95));
            let flipped = some
                .iter()
                .zip(&exact)
                .filter(|(a, b)| a.is_hit() != b.is_hit())
                .count();
            flips[k].push(flipped as f64 / some.len() as f64);
            let off: Vec<f64> = few
                .iter()
                .zip(&some)
                .filter(|(_, a)| a.is_hit())
                .filter_map(|(ray, a)| {
                    let hit = world.cast(ray.origin, ray.direction, ray.range_m[1])?;
                    Some((hit.range_m - f64::from(a.met.median_m)).abs())
                })
                .collect();
            model[k].push(quantile(&off, 0.5));
        }
    }
    let mut out: Vec<SettingMeasurement> = ways
        .iter()
        .enumerate()
        .map(|(k, (name, _))| SettingMeasurement {
            part: "lidar",
            name: name.clone(),
            wall_s: bootstrap_median(&walls[k], 1),
            error: bootstrap_median(&errors[k], 2),
            figures: json!({
                "range_off_p95_m": mean_ci95(&errors[k]).0,
                "hits_flipped": mean_ci95(&flips[k]).0,
                "model_error_p50_m": mean_ci95(&model[k]).0,
            }),
            peak_rss_mb: peaks[k],
            other_target: false,
        })
        .collect();
    for beams in [16, 32, 64, 128] {
        let mut pattern = pattern.clone();
        let (low, high) = (-30.0, 10.0);
        let step = (high - low) / f64::from(beams - 1);
        pattern.elevations_deg = (0..beams).map(|b| low + step * f64::from(b)).collect();
        // The exact cast alone, without surfaces beyond the voxels.
        pattern.beyond_grid = false;
        let mut walls = Vec::new();
        for i in 0..frames as u64 {
            let grid = bare_scene(i).frame().occupancy.clone();
            walls.extend(timed(repeats, || lidar::sweep(&grid, &pattern, None)).1);
        }
        out.push(SettingMeasurement {
            part: "lidar",
            name: format!("exact cast, {beams} beams"),
            wall_s: bootstrap_median(&walls, 1),
            error: bootstrap_median(&[0.0], 2),
            figures: json!({ "rays": beams * pattern.columns }),
            peak_rss_mb: None,
            other_target: true,
        });
    }
    Ok(out)
}

/// Cut-offs of the splats against none.
pub fn splats(frames: usize, repeats: usize) -> Vec<SettingMeasurement> {
    let rig = SensorRig::default();
    let [w, h] = VIEW_SIZE;
    let plain = SplatOptions::default();
    let exact = SplatOptions {
        alpha_min: 1e-6,
        t_stop: 1e-9,
        ..plain
    };
    let with = |alpha_min: f32, t_stop: f32| SplatOptions {
        alpha_min,
        t_stop,
        ..plain
    };
    let ways = [
        ("alpha 1/255, pass 1e-4 (papers)", plain),
        ("alpha 1/64, pass 1e-2", with(1.0 / 64.0, 1e-2)),
        ("alpha 1/32, pass 0.05", with(1.0 / 32.0, 0.05)),
        ("alpha 1/16, pass 0.1", with(1.0 / 16.0, 0.1)),
        ("alpha 1/8, pass 0.2", with(1.0 / 8.0, 0.2)),
        ("nothing cut", exact),
    ];
    let mut walls = vec![Vec::new(); ways.len()];
    let (mut labels, mut depths) = (walls.clone(), walls.clone());
    let mut peaks = vec![None; ways.len()];
    for i in 0..frames as u64 {
        let scene = bare_scene(i);
        let frame = scene.frame();
        let cloud = GaussianCloud::from_grid(
            &frame.occupancy,
            &bev_channels(&frame.layout, frame.boxes.values()),
        );
        let truth = render_rig(&cloud, &rig, w, h, &exact);
        for (k, (_, options)) in ways.iter().enumerate() {
            forget_peak_memory();
            let (maps, times) = timed(repeats, || render_rig(&cloud, &rig, w, h, options));
            peaks[k] = peak_rss_mb();
            walls[k].extend(times);
            let (label, depth) = map_errors(&maps, &truth);
            labels[k].push(label);
            depths[k].push(depth);
        }
    }
    ways.iter()
        .enumerate()
        .map(|(k, (name, _))| SettingMeasurement {
            part: "splat",
            name: (*name).into(),
            wall_s: bootstrap_median(&walls[k], 1),
            error: bootstrap_median(&labels[k], 2),
            figures: json!({ "depth_rmse_m": mean_ci95(&depths[k]).0 }),
            peak_rss_mb: peaks[k],
            other_target: false,
        })
        .collect()
}

/// Share of pixels with another label, and RMS difference of depths where both have one, m.
fn map_errors(maps: &[CameraMaps], truth: &[CameraMaps]) -> (f64, f64) {
    let (mut pixels, mut other, mut square, mut deep) = (0usize, 0usize, 0.0, 0usize);
    for (a, b) in maps.iter().zip(truth) {
        pixels += a.semantic.len();
        other += a.semantic.iter().zip(&b.semantic).filter(|(a, b)| a != b).count();
        for (a, b) in a
            .depth_m
            .iter()
            .zip(&b.depth_m)
            .filter(|(a, b)| **a > 0.0 && **b > 0.0)
        {
            square += f64::from(a - b).powi(2);
            deep += 1;
        }
    }
    (
        other as f64 / pixels.max(1) as f64,
        (square / deep.max(1) as f64).sqrt(),
    )
}

/// The two VAEs: time of encoding and decoding, and labels lost on the way (model error: no knob buys it).
pub fn vaes(
    models: &Arc<OccModels>,
    frames: usize,
    repeats: usize,
) -> anyhow::Result<Vec<SettingMeasurement>> {
    let fine = fine_vae()?;
    let mut out = Vec::new();
    for (name, vae) in [("50x50x8", &models.vae), ("100x100x16", &fine)] {
        let (mut walls, mut errors) = (Vec::new(), Vec::new());
        let mut confusion = Confusion::default();
        forget_peak_memory();
        for i in 0..frames as u64 {
            let grid = bare_scene(i).frame().occupancy.clone();
            let (back, times) = timed(repeats, || {
                vae.encode(&grid).and_then(|latent| vae.decode(&latent))
            });
            let back = back?;
            walls.extend(times);
            errors.push(grid.count_different(&back) as f64 / grid.count_set().max(1) as f64);
            confusion.add(&grid, &back);
        }
        out.push(SettingMeasurement {
            part: "vae",
            name: name.into(),
            wall_s: bootstrap_median(&walls, 1),
            error: bootstrap_median(&errors, 2),
            figures: json!({ "miou": confusion.mean_iou().0, "iou": confusion.occupied_iou() }),
            peak_rss_mb: peak_rss_mb(),
            other_target: false,
        });
    }
    Ok(out)
}
