//! The sensors against the reference data, and their orientation.

use std::fs::File;
use std::path::PathBuf;

use glam::DVec3;
use npyz::NpyFile;
use scene::{CameraMaps, Class, SensorRig, VoxelGrid, Window};
use sensors::lidar;
use sensors::pictures::color;
use sensors::raycast;
use sensors::splat::{self, cloud, order, project};

use crate::splat_reference::{camera_of, floats, json, reference_cloud};

fn reference(name: &str) -> PathBuf {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    root.join("tests/reference").join(name)
}

fn array<T: npyz::Deserialize>(file: &str, name: &str) -> Vec<T> {
    let mut zip = zip::ZipArchive::new(File::open(reference(file)).expect("a file")).expect("an npz file");
    let array = zip
        .by_name(&format!("{name}.npy"))
        .expect("an array of that name");
    let array = NpyFile::new(array).expect("an npy file");
    array.into_vec().expect("the type asked for")
}

/// Row 45: 34,688 rays against Open3D 0.20.0 (Embree), and the voxels of a float64 walk (NumPy
/// 2.4.6). Tolerance of raycast.json: 1e-3 m, here without any hit or miss mismatch.
#[test]
fn row_45_raycast_reference() {
    let meta = &json("raycast/raycast.json")["meta"];
    let occupancy: Vec<u8> = array("raycast/occupancy.npz", "occupancy");
    let open3d: Vec<f32> = array("raycast/open3d_t.npz", "t");
    let voxels: Vec<i32> = array("raycast/dda.npz", "voxel");
    let (beams, azimuths) = (
        meta["beams"].as_u64().expect("a count"),
        meta["azimuths"].as_u64().expect("a count"),
    );
    assert_eq!(open3d.len() as u64, beams * azimuths);
    let labels: Vec<u8> = occupancy
        .iter()
        .map(|&o| if o == 1 { Class::Others.id() } else { Class::FREE })
        .collect();
    let grid = VoxelGrid::from_dense(&labels).expect("640,000 labels");
    let masks = raycast::ColumnMasks::from_grid(&grid);
    // The reference's grid starts at 0; ours at its lower corner.
    let origin = DVec3::from_slice(&floats(&meta["origin_m"])) / Window::VOXEL_M;
    let (mut hits, mut mismatches, mut other_voxel, mut gap_m) = (0, 0, 0, 0.0f64);
    for beam in 0..beams {
        for step in 0..azimuths {
            let el = (-30.67 + 41.34 * beam as f64 / 31.0).to_radians();
            let az = -std::f64::consts::PI + std::f64::consts::TAU * step as f64 / azimuths as f64;
            let d = DVec3::new(el.cos() * az.cos(), el.cos() * az.sin(), el.sin());
            let ray = (beam * azimuths + step) as usize;
            let got = masks.cast_in_voxels(origin, d, f64::INFINITY);
            if got.is_some() != open3d[ray].is_finite() {
                mismatches += 1;
            }
            let flat = got.map_or(-1, |(_, [x, y, z])| ((x * 200 + y) * 16 + z) as i32);
            other_voxel += i32::from(flat != voxels[ray]);
            if let Some((t, _)) = got {
                hits += 1;
                if open3d[ray].is_finite() {
                    gap_m = gap_m.max((t * Window::VOXEL_M - f64::from(open3d[ray])).abs());
                }
            }
        }
    }
    println!("{hits} hits, {mismatches} mismatches, {other_voxel} other voxels, largest gap {gap_m:.2e} m");
    assert_eq!(hits, meta["hits"].as_u64().expect("a count"));
    assert_eq!(mismatches, 0);
    assert!(gap_m <= 1e-3, "{gap_m}");
    assert_eq!(
        other_voxel, 0,
        "allowed are 1 in 1,000; the same f64 walk gives none"
    );
}

/// Projection against splat.json (float64 NumPy 2.4.6). Positions here are f32: 1e-6 relative.
#[test]
fn row_38_projection_reference() {
    let data = json("splat.json");
    let cloud = reference_cloud(&data);
    for (i, v) in data["cameras"].as_array().expect("cameras").iter().enumerate() {
        let camera = camera_of(v);
        let view = project::SplatCamera::new(&camera, camera.width, camera.height, 1.3);
        let mut depths = Vec::new();
        for (g, want) in cloud
            .gaussians()
            .iter()
            .zip(v["projected"].as_array().expect("a list"))
        {
            let position = glam::Vec3::from(g.position_m).as_dvec3();
            let got = view.project(position, g.std_m.into(), 0.2, 200.0);
            depths.push(got.map_or(f32::NAN, |f| f.depth_m as f32));
            assert_eq!(got.is_none(), want["culled"].as_bool() == Some(true), "{want}");
            let Some(got) = got else { continue };
            let close = |a: f64, b: f64| assert!((a - b).abs() <= 2e-5 * b.abs().max(1.0), "{a} for {b}");
            close(got.depth_m, want["depth"].as_f64().expect("a depth"));
            for (a, b) in got.mean_px.into_iter().zip(floats(&want["mean"])) {
                close(a, b);
            }
            for (a, b) in got.covariance_px2.into_iter().zip(floats(&want["covariance"])) {
                close(a, b);
            }
        }
        let first: Vec<f64> = order::depth_order(&depths)[..10]
            .iter()
            .map(|&i| i.into())
            .collect();
        assert_eq!(
            first,
            floats(&data["renders"][2 * i]["first_drawn"]),
            "front to back"
        );
    }
}

#[test]
fn splat_reference() {
    crate::splat_reference::check(|cloud, camera, options| {
        splat::render_raw(cloud, camera, camera.width, camera.height, options)
    });
}

/// Mean column of the pixels of a class (0 left, 1 right) and how many there are.
fn place(maps: &CameraMaps, class: Class) -> (f64, usize) {
    let columns = maps
        .semantic
        .iter()
        .enumerate()
        .filter(|(_, s)| **s == class.id());
    let columns: Vec<f64> = columns.map(|(i, _)| (i % maps.width) as f64).collect();
    let mean = columns.iter().sum::<f64>() / columns.len().max(1) as f64;
    (mean / maps.width as f64, columns.len())
}

#[test]
fn cameras_and_lidar_look_the_right_way() {
    let (grid, bev) = crate::sensor_scene::street();
    let cloud = cloud::GaussianCloud::from_grid(&grid, &bev);
    let rig = SensorRig::default();
    let [w, h] = splat::PREVIEW_SIZE;
    let maps = splat::render_rig(&cloud, &rig, w, h, &splat::SplatOptions::default());
    let of = |name: &str| {
        maps.iter()
            .find(|m| m.camera == name)
            .expect("a camera of the rig")
    };
    // The truck is ahead and to the right, the bus behind: seen from behind, left is to the right.
    let (column, pixels) = place(of("CAM_FRONT"), Class::Truck);
    assert!(pixels > 500 && (0.5..0.7).contains(&column), "{column} {pixels}");
    let (column, pixels) = place(of("CAM_BACK"), Class::Bus);
    assert!(pixels > 500 && column > 0.5, "{column} {pixels}");
    assert_eq!(place(of("CAM_FRONT"), Class::Bus).1, 0);
    assert_eq!(place(of("CAM_BACK"), Class::Truck).1, 0);
    // The pedestrian is ahead on the left.
    assert!(place(of("CAM_FRONT"), Class::Pedestrian).0 < 0.3);
    assert!(place(of("CAM_FRONT_LEFT"), Class::Pedestrian).1 > 50);
    assert_eq!(place(of("CAM_FRONT_RIGHT"), Class::Pedestrian).1, 0);
    // Up is up: road at the bottom, sky at the top; depth grows upward on the road.
    let front = of("CAM_FRONT");
    let pixel = |x: usize, y: usize| {
        (
            front.semantic[y * front.width + x],
            front.depth_m[y * front.width + x],
        )
    };
    assert_eq!(pixel(100, 5).0, 0);
    assert_eq!(pixel(100, 130).0, Class::DriveableSurface.id());
    assert!(pixel(100, 130).1 > 3.0 && pixel(100, 110).1 > pixel(100, 130).1 + 0.5);
    // The truck's rear face is 14 m ahead of the rear axle, the camera 1.7 m.
    let rear = front
        .semantic
        .iter()
        .zip(&front.depth_m)
        .filter(|(s, _)| **s == Class::Truck.id());
    let mut rear: Vec<f32> = rear.map(|(_, d)| *d).collect();
    rear.sort_by(f32::total_cmp);
    let middle = rear[rear.len() / 2];
    assert!((middle - 12.5).abs() < 0.6, "{middle}");

    let sweep = lidar::sweep(&grid, &rig.lidars[0], Some(lidar::EgoBox::of_rig(&rig)));
    assert_eq!(sweep.rays, 32 * 1084);
    assert!(sweep.points.len() > sweep.rays / 2);
    let mut seen = std::collections::BTreeMap::<Class, usize>::new();
    // What ends on the own roof, or beyond the grid, lies on no voxel.
    let in_grid = |p: &scene::LidarPoint| p.position_in_ego[..2].iter().all(|v| v.abs() < 39.99);
    let met = |p: &&scene::LidarPoint| p.class != Class::Others && in_grid(p);
    for p in sweep.points.iter().filter(met) {
        *seen.entry(p.class).or_default() += 1;
        let at = glam::Vec3::from(p.position_in_ego).as_dvec3();
        // On a face of its voxel, at its range from the sensor.
        let from = DVec3::from(rig.lidars[0].translation_m);
        assert!((at.distance(from) - f64::from(p.range_m)).abs() < 1e-4);
        let u = Window::to_voxel_units(at);
        let from_face = (u - u.round()).abs().min_element();
        assert!(from_face < 1e-3, "{at}");
        match p.class {
            Class::Truck => assert!(at.x > 13.9 && at.y < 0.0),
            Class::Bus => assert!(at.x < -10.7 && at.y > 0.0),
            Class::Pedestrian => assert!(at.x > 7.9 && at.y > 3.9),
            _ => {}
        }
    }
    for class in [
        Class::Truck,
        Class::Bus,
        Class::Pedestrian,
        Class::DriveableSurface,
    ] {
        assert!(seen.get(&class).is_some_and(|&n| n > 10), "{class:?}: {seen:?}");
    }
}

/// What leaving out deep voxels changes: nothing with enough layers, little with two.
#[test]
fn culling_deep_voxels_changes_little() {
    let (mut grid, bev) = crate::sensor_scene::street();
    // A solid block, which has an inside to leave out.
    crate::sensor_scene::fill(&mut grid, [10.0, -20.0, -1.0], [30.0, -8.0, 5.4], Class::Manmade);
    let rig = SensorRig::default();
    let all = cloud::GaussianCloud::from_grid(&grid, &bev);
    let draw = |cloud: &cloud::GaussianCloud| splat::render_rig(cloud, &rig, 240, 135, &Default::default());
    let exact = draw(&all);
    for layers in [1, 2, 3, 4] {
        let shell = cloud::GaussianCloud::from_grid_shell(&grid, &bev, layers);
        let maps = draw(&shell);
        let pairs = || exact.iter().zip(&maps);
        let labels: usize = pairs()
            .map(|(a, b)| a.semantic.iter().zip(&b.semantic).filter(|(a, b)| a != b).count())
            .sum();
        let coverage = pairs()
            .flat_map(|(a, b)| a.coverage.iter().zip(&b.coverage).map(|(a, b)| (a - b).abs()))
            .fold(0.0, f32::max);
        println!(
            "{layers} layers: {} of {} Gaussians, {labels} labels differ, coverage by {coverage:.1e}",
            shell.len(),
            all.len()
        );
        match layers {
            1 => assert!(labels < 1000 && coverage < 0.35),
            2 => assert!(labels < 200 && coverage < 0.1),
            3 => assert!(labels < 60 && coverage < 0.02),
            _ => assert!(labels < 20 && coverage < 0.004),
        }
    }
}

/// Six cameras (semantic above depth) and the sweep from above, as pictures to look at:
/// `cargo test --release --test sensors -- --ignored`.
#[test]
#[ignore = "writes pictures to look at"]
fn pictures() {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    let (grid, bev) = crate::sensor_scene::street();
    let rig = SensorRig::default();
    let cloud = cloud::GaussianCloud::from_grid(&grid, &bev);
    let [w, h] = splat::VIEW_SIZE;
    let maps = splat::render_rig(&cloud, &rig, w, h, &splat::SplatOptions::default());
    let mut sheet = image::RgbaImage::new(w * 3, h * 4);
    for (i, maps) in maps.iter().enumerate() {
        let (column, row) = (i as u32 % 3, i as u32 / 3);
        let pictures = [
            color::semantic_rgba(maps, true),
            color::depth_rgba(&maps.depth_m, 2.0, 60.0),
        ];
        for (k, rgba) in pictures.into_iter().enumerate() {
            let picture = image::RgbaImage::from_raw(w, h, rgba).expect("4 bytes a pixel");
            let at = (column * w, (row + 2 * k as u32) * h);
            image::imageops::replace(&mut sheet, &picture, at.0.into(), at.1.into());
        }
    }
    sheet.save(folder.join("cameras.png")).expect("a picture");
    // From above: ego x up, ego y left, 10 px per metre.
    let mut top = image::RgbaImage::from_pixel(800, 800, image::Rgba([12, 14, 18, 255]));
    for p in lidar::sweep(&grid, &rig.lidars[0], None).points {
        let [x, y, _] = p.position_in_ego;
        let at = ((40.0 - y) * 10.0, (40.0 - x) * 10.0);
        if (0.0..800.0).contains(&at.0) && (0.0..800.0).contains(&at.1) {
            let [r, g, b] = p.class.color();
            top.put_pixel(at.0 as u32, at.1 as u32, image::Rgba([r, g, b, 255]));
        }
    }
    top.save(folder.join("lidar.png")).expect("a picture");
    println!("{}", folder.display());
}
