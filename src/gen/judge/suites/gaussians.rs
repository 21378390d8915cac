//! `eval gaussians`: compares pictures of a scene's Gaussians with those of the renderer, from places that were not
//! baked from.

use std::fmt::Write as _;
use std::time::Instant;

use anyhow::Context;
use glam::DVec2;
use serde_json::{Value, json};

use crate::suite::{Options, SuiteFigures, with_interval};
use authoring::{drives, open};
use calibration::MeasurementProgress;
use calibration::held_out::TEST_SEED;
use numeric::quantile::median;
use numeric::splitmix::Draw;
use scene::{Camera, Pose, Scene};
use sensors::bake::{self, BakeOptions, draw, stands};
use sensors::pictures::appearance::{Appearance, Quality};
use world::template::TEMPLATES;

/// Size of the judged pictures, px; larger than the pictures that are baked from.
const SIZE: [u32; 2] = [400, 225];
/// Number of cameras that are judged in a scene.
const VIEWS: usize = 24;
/// Distance of the vehicle from the place beside which it stands, m, and its turn, degrees.
const ASIDE_M: [f64; 2] = [1.0, 2.0];
const TURNED_DEG: [f64; 2] = [5.0, 20.0];
/// Bar of the median, dB.
const WANTED_DB: f64 = 26.0;
/// Bytes of a Gaussian in the PLY.
const PLY_BYTES: f64 = 77.0;

/// Number of templates before each drive.
const DRIVE_AFTER: usize = 3;

/// Scene `i` of those that are judged: templates one after another with drives between them. A drive is shown at its
/// middle.
fn scene_of(i: usize) -> anyhow::Result<(String, Scene)> {
    let round = (i / (DRIVE_AFTER + 1), i % (DRIVE_AFTER + 1));
    if round.1 == DRIVE_AFTER {
        let mut scene = drives::drive_scene(TEST_SEED, round.0 as u64, |_| None);
        let middle = 0.5 * scene.clip().length_s;
        scene.show(middle);
        return Ok((format!("drive {}", round.0), scene));
    }
    let name = TEMPLATES[(round.0 * DRIVE_AFTER + round.1) % TEMPLATES.len()];
    let scene = open::from_template(name, TEST_SEED + i as u64).context("no such template")?;
    Ok((name.to_owned(), scene))
}

/// Cameras that were not baked from: on vehicles beside the baked places, and in drives about every second one on the
/// path itself, midway between two of the baked places.
fn unseen(scene: &Scene, stands: &[Pose], seed: u64) -> Vec<Camera> {
    let mut draw = Draw::new(seed, "unseen poses");
    let is_free = |pose: &Pose| stands::is_free(scene.frame(), &scene.rig, pose);
    let on_way: Vec<Pose> = bake::between(scene).into_iter().filter(is_free).collect();
    let mut out = Vec::new();
    // If there is too little room beside the places, fewer cameras are judged.
    for _ in 0..VIEWS * 200 {
        if out.len() == VIEWS {
            break;
        }
        let which = draw.below(scene.rig.cameras.len());
        let is_beside = on_way.is_empty() || draw.chance(0.5);
        let pose = if is_beside {
            let from = stands[draw.below(stands.len())];
            let way = draw.range(0.0, std::f64::consts::TAU);
            let aside = DVec2::from_angle(way) * draw.range(ASIDE_M[0], ASIDE_M[1]);
            let sign = if draw.chance(0.5) { 1.0 } else { -1.0 };
            let turn = sign * draw.range(TURNED_DEG[0], TURNED_DEG[1]).to_radians();
            let at = from.translation_m.truncate() + aside;
            stands::standing(scene.frame(), &from, at, turn)
        } else {
            on_way[draw.below(on_way.len())]
        };
        if !is_beside || stands::fits(scene.frame(), &scene.rig, &pose) {
            let mut camera = scene.rig.standing_at(&pose).cameras[which].clone();
            camera.shutter = None;
            out.push(camera);
        }
    }
    out
}

/// Peak signal-to-noise ratio of sRGB-coded colours, dB.
fn psnr_db(a: &[[f32; 3]], b: &[[f32; 3]]) -> f64 {
    let square = |(a, b): (&[f32; 3], &[f32; 3])| -> f64 {
        let off = |c: usize| f64::from(a[c].clamp(0.0, 1.0) - b[c].clamp(0.0, 1.0));
        (0..3).map(|c| off(c).powi(2)).sum()
    };
    let mean = a.iter().zip(b).map(square).sum::<f64>() / (3 * a.len()).max(1) as f64;
    -10.0 * mean.max(1e-12).log10()
}

/// A judged scene, as it stands in the report.
fn judged(i: usize) -> anyhow::Result<Value> {
    let (name, scene) = scene_of(i)?;
    let scene = scene.for_sensors();
    let options = BakeOptions::default();
    let before = Instant::now();
    let mut baked = bake::bake_scene(&scene, &options, &|_| true).context("cancelled")?;
    let bake_s = before.elapsed().as_secs_f64();
    // Cameras are in world coordinates.
    baked.place(&scene.frame().world_from_ego);
    let places = bake::places(&scene, &options);
    let appearance = Appearance::with_things(scene.frame(), &scene.background, &scene.rig, &scene.conditions);
    let of = |camera: &Camera| {
        let there = appearance.render_plain(camera, SIZE, Quality::Full);
        psnr_db(&there, &draw::render(&baked.gaussians, camera, SIZE))
    };
    let db: Vec<f64> = unseen(&scene, &places, i as u64).iter().map(of).collect();
    Ok(json!({
        "scene": name,
        "gaussians": baked.gaussians.len(),
        "ply_mb": baked.gaussians.len() as f64 * PLY_BYTES / 1e6,
        "places": places.len(),
        "views": db.len(),
        "psnr_median_db": median(&db),
        "psnr_worst_db": db.iter().copied().fold(f64::INFINITY, f64::min),
        "bake_s": bake_s,
    }))
}

impl Options {
    /// Compares pictures of baked scenes with the renderer's, from unseen poses.
    pub(crate) fn gaussians(&self, progress: &dyn MeasurementProgress) -> anyhow::Result<SuiteFigures> {
        let mut rows = Vec::new();
        for i in 0..self.frames {
            progress.at("gaussians", i, self.frames);
            rows.push(judged(i)?);
        }
        let all = |key: &str| -> Vec<f64> { rows.iter().filter_map(|row| row[key].as_f64()).collect() };
        let medians = all("psnr_median_db");
        let report = json!({
            "judged_px": SIZE,
            "psnr_median_db": with_interval(&medians),
            "psnr_worst_db": with_interval(&all("psnr_worst_db")),
            "bake_s_median": median(&all("bake_s")),
            "scenes": rows,
        });
        let bar = ("median over unseen poses, dB", median(&medians), WANTED_DB);
        Ok((report, vec![bar]))
    }
}

/// The report as a table for a person.
pub(crate) fn table(report: &Value) -> String {
    let mut out = format!(
        "{:<14}{:>10}{:>8}{:>11}{:>10}{:>8}",
        "scene", "Gaussians", "MB", "median dB", "worst dB", "s"
    );
    let rows = report["scenes"].as_array();
    for row in rows.into_iter().flatten() {
        let number = |key: &str| row[key].as_f64().unwrap_or(f64::NAN);
        let _ = write!(
            out,
            "\n{:<14}{:>10}{:>8.1}{:>11.2}{:>10.2}{:>8.1}",
            row["scene"].as_str().unwrap_or_default(),
            number("gaussians"),
            number("ply_mb"),
            number("psnr_median_db"),
            number("psnr_worst_db"),
            number("bake_s")
        );
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn psnr_is_that_of_the_textbook() {
        let (black, grey) = ([[0.0; 3]; 8], [[0.1; 3]; 8]);
        assert!((psnr_db(&black, &grey) - 20.0).abs() < 1e-5);
        assert!(psnr_db(&grey, &grey) > 100.0);
    }

    #[test]
    fn every_fourth_scene_is_a_drive() {
        let of = |i| scene_of(i).expect("a scene");
        assert_eq!(of(0).0, "straight");
        assert!(of(3).1.clip().ego.is_some());
        assert_eq!(of(4).0, TEMPLATES[3]);
    }
}
