//! Drives through worlds of our own as a recording has them: sweeps alone, with noise, and poses that know no height and drift.
//! What the import makes of them is compared with the world.

use std::collections::BTreeMap;

use glam::DVec2;
use scene::{Background, BevLayout, Class, Extent, Pose, SceneBox, draft};
use sensors::lidar::direction_in_sensor;
use sensors::lidar::truth::{self, Echo, TruthRay};
use tempfile::TempDir;
use world::World;

use super::*;
use crate::drives::{STEP_S, drive_scene_of};
use crate::large::scenery_over;

/// Frames of a drive.
const FRAMES: usize = 16;

/// A drive and its truth.
struct MadeDrive {
    folder: TempDir,
    scene: Scene,
    /// Poses of the sensor in the world of the scene.
    world_from_sensor: Vec<Pose>,
    /// Places of the returns of each sweep, m, in that world.
    seen: Vec<Vec<DVec3>>,
}

/// A pose that knows no height, roll and pitch, after a drift of the way driven.
fn planar_with_drift(pose: &Pose, way_m: f64) -> Pose {
    let ahead = (pose.rotation * DVec3::X).truncate();
    let at_m = pose.translation_m;
    let drift = DVec2::new(0.01, -0.006) * way_m;
    Pose::planar(
        at_m.x + drift.x,
        at_m.y + drift.y,
        ahead.to_angle() + 2e-4 * way_m,
    )
}

/// The ground at a moment of a scene below its vehicle.
fn standing(scene: &Scene, time_s: f64) -> Pose {
    let there = scene.at(time_s);
    let pose = there.frame().world_from_ego;
    let at_m = pose.translation_m.truncate();
    let ahead = (pose.rotation * DVec3::X).truncate();
    let mut standing = Pose::planar(at_m.x, at_m.y, ahead.to_angle());
    standing.translation_m.z = there.frame().layout.relief.height_m(at_m);
    standing
}

/// The pose of the sensor at a moment of a scene, which leans with the ground, and what it measures: places of returns in its frame, m,
/// and strengths, 0 to 1. Noise, lost echoes and strengths are those of a real sensor. The world is 80 m wide around `middle`: its
/// ground is the same at all moments.
fn sweep(scene: &Scene, time_s: f64, middle: Pose, seed: u64) -> (Pose, Vec<(DVec3, f32)>) {
    let there = scene.at(time_s);
    let mut still = there.still();
    still.change_canvas(|canvas| canvas.world_from_ego = middle);
    let in_ego = still.in_ego();
    let near = in_ego.frame().crop(Extent::WINDOW);
    let world = World::with_background(
        near.layout,
        near.boxes,
        Background::clone(&in_ego.background),
        scene.seed,
    );
    let mut pattern = scene.rig.lidars.first().expect("a LiDAR").clone();
    let world_from_sensor = there.frame().world_from_ego * pattern.ego_from_sensor();
    let mount = middle.inverse() * world_from_sensor;
    let q = mount.rotation;
    pattern.rotation_wxyz = [q.w, q.x, q.y, q.z];
    (pattern.own_body, pattern.beyond_grid) = (false, false);
    pattern.translation_m = mount.translation_m.to_array();
    let columns = pattern.columns as usize;
    let rays = truth::sweep(&world, &pattern, seed);
    let place = |(i, ray): (usize, &TruthRay)| {
        let direction = direction_in_sensor(
            pattern.elevations_deg[i / columns],
            pattern.azimuth_rad((i % columns) as u32),
        );
        let is_return = ray.echo == Echo::Return;
        is_return.then(|| {
            (
                direction * f64::from(ray.range_m),
                f32::from(ray.intensity) / 255.0,
            )
        })
    };
    let returns = rays.iter().enumerate().filter_map(place).collect();
    (world_from_sensor, returns)
}

fn made(seed: u64, index: u64) -> MadeDrive {
    let mut scene = drive_scene_of(seed, index, FRAMES, |_| None);
    let canvas = scene.canvas();
    let scenery = scenery_over(&canvas.layout, &canvas.boxes, Background::default(), seed ^ index);
    scene.background = Arc::new(scenery.0);
    let folder = tempfile::tempdir().expect("a folder");
    let (mut poses, mut world_from_sensor, mut seen) = (String::new(), Vec::new(), Vec::new());
    let (mut way_m, mut before) = (0.0, None);
    let middle = standing(&scene, FRAMES as f64 / 2.0 * STEP_S);
    for i in 0..FRAMES {
        let time_s = i as f64 * STEP_S;
        let (pose, returns) = sweep(&scene, time_s, middle, seed ^ (i as u64) << 8);
        way_m += before.map_or(0.0, |at: DVec3| at.distance(pose.translation_m));
        before = Some(pose.translation_m);
        let numbers = returns
            .iter()
            .flat_map(|(at, strength)| at.as_vec3().to_array().into_iter().chain([*strength]));
        let bytes: Vec<u8> = numbers.flat_map(f32::to_le_bytes).collect();
        seen.push(returns.iter().map(|(at, _)| pose.apply(*at)).collect());
        std::fs::write(folder.path().join(format!("{i:06}.bin")), bytes).expect("written");
        let given = planar_with_drift(&pose, way_m);
        let (q, t) = (given.rotation, given.translation_m);
        poses += &format!(
            "{time_s} {} {} {} {} {} {} {}\n",
            t.x, t.y, t.z, q.x, q.y, q.z, q.w
        );
        world_from_sensor.push(pose);
    }
    std::fs::write(folder.path().join("poses.txt"), poses).expect("written");
    MadeDrive {
        folder,
        scene,
        world_from_sensor,
        seen,
    }
}

/// What an import is measured by.
#[derive(Debug, Default)]
struct Figures {
    way_m: f64,
    align_rms_m: f64,
    drivable_iou: f64,
    /// Vehicles in view and those that a box stands for; boxes of vehicles and those that stand for one.
    vehicles: [usize; 2],
    boxes: [usize; 2],
    /// Vehicles that move, and those that one track stands for all the time.
    moving: [usize; 2],
}

fn figures(drive: &MadeDrive, found: &Scene) -> Figures {
    let first = drive.world_from_sensor[0];
    let sweeps = &found.kept.sweeps;
    let found_first = sweeps[0].world_from_file;
    let found_from_world = found_first * first.inverse();
    let squares = sweeps.iter().zip(&drive.world_from_sensor).map(|(sweep, truth)| {
        let here = (found_from_world * *truth).translation_m;
        sweep.world_from_file.translation_m.distance_squared(here)
    });
    let align_rms_m = (squares.sum::<f64>() / sweeps.len() as f64).sqrt();
    // Ground that was seen: columns with a return beside them.
    let (layout, truth) = (&found.canvas().layout, &drive.scene.canvas().layout);
    let mut near = std::collections::HashSet::new();
    for p in drive.seen.iter().flatten() {
        let cell = (p.truncate() / 1.2).floor().as_ivec2();
        near.insert(cell.to_array());
    }
    let (mut both, mut either) = (0, 0);
    for [x, y] in layout.extent().all_columns() {
        let at = layout.extent().center(x, y, 0);
        let in_world = found_from_world.inverse().apply(at).truncate();
        let cell = (in_world / 1.2).floor().as_ivec2().to_array();
        let Some([tx, ty]) = truth
            .extent()
            .column_at(in_world.x, in_world.y)
            .filter(|_| near.contains(&cell))
        else {
            continue;
        };
        let is_road =
            |layout: &BevLayout, x, y| draft::ground_class(layout.cell(x, y)) == Class::DriveableSurface;
        let (is_found, is_true) = (is_road(layout, x, y), is_road(truth, tx, ty));
        both += usize::from(is_found && is_true);
        either += usize::from(is_found || is_true);
    }
    let mut out = Figures {
        way_m: drive.world_from_sensor[FRAMES - 1]
            .translation_m
            .distance(first.translation_m),
        align_rms_m,
        drivable_iou: both as f64 / either as f64,
        ..Figures::default()
    };
    let mut tracks_of: BTreeMap<BoxId, Vec<BoxId>> = BTreeMap::new();
    for i in 0..FRAMES {
        let time_s = i as f64 * STEP_S;
        let (there, here) = (drive.scene.at(time_s), found.at(time_s));
        let ego_m = drive.world_from_sensor[i].translation_m.truncate();
        let in_view = |at: DVec2| at.distance(ego_m) < 36.0;
        let of_vehicles = |scene: &Scene| -> Vec<SceneBox> {
            let boxes = scene.frame().boxes.values();
            boxes.filter(|b| b.class.is_vehicle()).copied().collect()
        };
        let returns = |b: &SceneBox| {
            drive.seen[i]
                .iter()
                .filter(|p| p.distance_squared(b.center_m) < 100.0 && b.contains(**p, 0.15))
                .count()
        };
        let truth: Vec<SceneBox> = of_vehicles(&there)
            .into_iter()
            .filter(|b| in_view(b.center_m.truncate()))
            .collect();
        let boxes: Vec<(SceneBox, DVec2)> = of_vehicles(&here)
            .into_iter()
            .map(|b| (b, found_from_world.inverse().apply(b.center_m).truncate()))
            .filter(|(_, at)| in_view(*at))
            .collect();
        let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
        for (t, b) in truth.iter().enumerate() {
            for (f, (_, at)) in boxes.iter().enumerate() {
                let off_m = b.center_m.truncate().distance(*at);
                if off_m < 2.0 {
                    pairs.push((off_m, t, f));
                }
            }
        }
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (mut of_truth, mut of_found) = (vec![None; truth.len()], vec![None; boxes.len()]);
        for (_, t, f) in pairs {
            if of_truth[t].is_none() && of_found[f].is_none() {
                (of_truth[t], of_found[f]) = (Some(f), Some(t));
            }
        }
        for (b, f) in truth.iter().zip(&of_truth).filter(|(b, _)| returns(b) >= 5) {
            out.vehicles[0] += 1;
            out.vehicles[1] += usize::from(f.is_some());
            if let Some(f) = f.filter(|_| drive.scene.clip().tracks.contains_key(&b.id)) {
                tracks_of.entry(b.id).or_default().push(boxes[f].0.id);
            }
        }
        for (n, (b, _)) in boxes.iter().enumerate() {
            // Boxes of what stands are there at all moments: only what is seen then counts.
            let in_world = SceneBox {
                center_m: found_from_world.inverse().apply(b.center_m),
                ..*b
            };
            if of_found[n].is_some() || returns(&in_world) >= 5 {
                out.boxes[0] += 1;
                out.boxes[1] += usize::from(of_found[n].is_some());
            }
        }
    }
    for mut ids in tracks_of.into_values().filter(|ids| ids.len() >= 3) {
        ids.dedup();
        out.moving[0] += 1;
        out.moving[1] += usize::from(ids.len() == 1);
    }
    out
}

/// `cargo test --profile checked -p sceneloom-authoring --lib drive_tests -- --nocapture` prints the figures of six worlds.
#[test]
fn a_drive_without_heights_and_labels_becomes_the_world_that_it_drove_through() {
    let mut all = Vec::new();
    for (seed, index) in [(3, 0), (3, 1), (3, 2), (5, 0), (5, 1), (5, 2)] {
        let drive = made(seed, index);
        let from = std::time::Instant::now();
        let (_, content) = file_with(drive.folder.path(), ImportOptions::default()).expect("a drive");
        let Content::Scene(loaded) = content else {
            panic!("no scene")
        };
        let took_s = from.elapsed().as_secs_f64();
        let found = figures(&drive, &loaded.scene);
        println!("world {seed} {index}: {found:.3?}, {took_s:.2} s");
        loaded.notes.iter().for_each(|note| println!("  {note}"));
        assert!(found.align_rms_m <= 0.05, "{found:?}");
        all.push(found);
    }
    let sum = |of: fn(&Figures) -> [usize; 2]| {
        let sums = all
            .iter()
            .map(of)
            .fold([0; 2], |sum, n| [sum[0] + n[0], sum[1] + n[1]]);
        sums[1] as f64 / sums[0] as f64
    };
    let (recall, precision, whole) = (sum(|f| f.vehicles), sum(|f| f.boxes), sum(|f| f.moving));
    let way_m: f64 = all.iter().map(|f| f.way_m).sum();
    let iou = all.iter().map(|f| f.drivable_iou).sum::<f64>() / all.len() as f64;
    println!(
        "{way_m:.0} m: drivable {iou:.3}, recall {recall:.3}, precision {precision:.3}, whole tracks {whole:.3}"
    );
    assert!(iou >= 0.85 && recall >= 0.85 && precision >= 0.9 && whole >= 0.8);
}

/// Two parked cars of a real drive, of which one was marked by eye and one has a thousand returns, are boxes that stand, on the ground
/// that its sweeps show; road and walkways are there.
#[test]
fn parked_cars_of_a_real_drive_are_boxes_on_its_street() {
    let Some(folder) = super::tests::real_sweeps() else {
        return;
    };
    let (_, content) = file_with(&folder.join("os1_drive"), ImportOptions::default()).expect("a drive");
    let Content::Scene(loaded) = content else {
        panic!("no scene")
    };
    loaded.notes.iter().for_each(|note| println!("  {note}"));
    let canvas = loaded.scene.canvas();
    for at_m in [DVec2::new(-5.5, 11.45), DVec2::new(0.6, 11.6)] {
        let off = |b: &&SceneBox| b.center_m.truncate().distance(at_m);
        let cars = canvas.boxes.values().filter(|b| b.class.is_vehicle());
        let nearest = cars.min_by(|a, b| off(a).total_cmp(&off(b))).expect("a vehicle");
        assert!(off(&nearest) < 1.5, "{at_m}: {nearest:?}");
        let ground_m = canvas.layout.relief.height_m(nearest.center_m.truncate());
        let above_m = nearest.center_m.z - nearest.size_m.z / 2.0 - ground_m;
        assert!(above_m.abs() < 1e-6, "{above_m} m above its ground");
    }
    assert!(
        loaded.scene.clip().tracks.is_empty(),
        "in two tenths of a second nothing drives"
    );
    let counts = canvas.occupancy.class_counts();
    let columns = |class: Class| counts[usize::from(class.id())];
    assert!(
        columns(Class::DriveableSurface) > 4000 && columns(Class::Sidewalk) > 300,
        "{counts:?}"
    );
}
