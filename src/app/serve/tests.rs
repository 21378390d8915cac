//! Requests answered without a network.

use std::sync::Arc;

use glam::{DVec2, DVec3};
use tempfile::TempDir;

use crate::fixture::{self, held, own_picture};
use crate::renderer::{Renderer, ServerLidarModel};
use crate::wire::{
    AggregatedRenderRequest, AvailableCamerasRequest, AvailableTrajectoriesRequest, BatchRgbRenderRequest,
    BatchRgbRenderRequestItem, CameraParam, DynamicObject, ImageFormat, LidarRenderRequest, LidarSpec,
    PosePair, RgbRenderRequest, ShutterType,
};
use crate::{lidar, offers, picture, poses, several};
use scene::{BevLayout, Class, Conditions, Frame, Pose, Scene, SceneBox, SensorRig, VoxelGrid};
use sensors::cameras::pictures::PictureSource;
use sensors::cameras::{CameraInput, CameraPicture, Detail, PreparedSource, RenderContext, RenderOptions};

fn scenes() -> (TempDir, Renderer) {
    let folder = tempfile::tempdir().expect("a folder");
    fixture::write(folder.path());
    let renderer = fixture::renderer(folder.path(), ServerLidarModel::Exact);
    (folder, renderer)
}

fn rgba(png: &[u8]) -> Vec<u8> {
    image::load_from_memory(png)
        .expect("a picture")
        .to_rgba8()
        .into_raw()
}

fn pixels(renderer: &Renderer, request: &RgbRenderRequest) -> Vec<u8> {
    rgba(&picture::render(renderer, request).expect("a picture").image_bytes)
}

/// What `sceneloom render` draws of a camera.
fn rendered(scene: &Scene, camera: usize, size: [u32; 2]) -> Vec<u8> {
    let scene = scene.with_rig_in_world();
    let input = CameraInput {
        frame: scene.frame(),
        rig: &scene.rig,
        background: &scene.background,
        conditions: scene.conditions,
        detail: Detail::Full,
        paint: None,
        cache: None,
    };
    let options = RenderOptions {
        size,
        quality: Default::default(),
    };
    let ready = PreparedSource::new(&PictureSource, &input);
    let drawn = ready.render(&scene.rig.cameras[camera], &options, RenderContext::processor());
    match drawn.expect("a picture") {
        CameraPicture::Picture(image) => image.rgba,
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_camera_of_the_rig_at_its_place_sees_what_the_program_renders() {
    let (folder, renderer) = scenes();
    for name in ["still", "clip"] {
        let path = folder.path().join(format!("{name}.loom"));
        let scene = formats::loom::load(&path).expect("a scene");
        let request = own_picture(name, &scene);
        let expected = rendered(&scene.at(0.0), 1, [160, 90]);
        let found = pixels(&renderer, &request);
        assert!(found == expected, "{name}");
        // With the vehicle told too, as the cameras of the server tell it, and under another name from the same place.
        let offered = offers::cameras(
            &renderer,
            &AvailableCamerasRequest {
                scene_id: name.into(),
            },
        );
        let offered = offered.expect("cameras").available_cameras.remove(1);
        let ways = AvailableTrajectoriesRequest {
            scene_id: name.into(),
        };
        let way = offers::trajectories(&renderer, &ways)
            .expect("a way")
            .available_trajectories
            .remove(0);
        let first = way.trajectory.expect("poses").poses[0];
        assert_eq!(first.timestamp_us, 0);
        let told = RgbRenderRequest {
            camera_intrinsics: offered.intrinsics.clone(),
            ego_pose: Some(PosePair {
                start_pose: first.pose,
                end_pose: None,
            }),
            ..request.clone()
        };
        assert!(pixels(&renderer, &told) == expected, "{name}");
        let mut other = request.clone();
        if let Some(spec) = &mut other.camera_intrinsics {
            spec.logical_id = "other".into();
        }
        let found = pixels(&renderer, &other);
        let differ = found
            .iter()
            .zip(&expected)
            .filter(|(a, b)| a.abs_diff(**b) > 24)
            .count();
        assert!(differ * 100 < found.len(), "{name}: {differ} of {}", found.len());
    }
}

#[test]
fn later_moments_are_those_of_the_clip() {
    let (_folder, renderer) = scenes();
    let scene = renderer.scenes.get("clip").expect("a scene");
    let later = scene.at(1.5);
    let camera = scene.rig.cameras[1].ego_from_camera();
    let request = RgbRenderRequest {
        frame_start_us: 1_500_000,
        frame_end_us: 1_500_001,
        sensor_pose: held(&(later.frame().world_from_ego * camera)),
        ..own_picture("clip", &scene)
    };
    let found = pixels(&renderer, &request);
    assert!(found == rendered(&later, 1, [160, 90]));
    assert!(found != pixels(&renderer, &own_picture("clip", &scene)));
    // A way that begins and ends with the clip.
    let ways = AvailableTrajectoriesRequest {
        scene_id: "clip".into(),
    };
    let way = offers::trajectories(&renderer, &ways)
        .expect("a way")
        .available_trajectories
        .remove(0);
    let poses = way.trajectory.expect("poses").poses;
    assert_eq!((poses.len(), poses[20].timestamp_us), (21, 2_000_000));
}

/// A car ahead in the picture of the first camera that looks ahead, told at a place.
fn moved(scene: &Scene, b: &SceneBox, by: DVec2, turn_rad: f64) -> DynamicObject {
    let there = Pose {
        translation_m: b.center_m + by.extend(0.0),
        ..Pose::planar(0.0, 0.0, b.yaw_rad + turn_rad)
    };
    assert!(scene.frame().boxes.contains_key(&b.id));
    DynamicObject {
        track_id: b.id.0.to_string(),
        pose_pair: held(&there),
    }
}

#[test]
fn objects_are_where_the_simulator_has_them() {
    let (_folder, renderer) = scenes();
    for name in ["still", "clip"] {
        let scene = renderer.scenes.get(name).expect("a scene").at(0.0);
        let plain = own_picture(name, &scene);
        let before = pixels(&renderer, &plain);
        for b in scene.frame().boxes.values() {
            let with = |object| RgbRenderRequest {
                dynamic_objects: vec![object],
                ..plain.clone()
            };
            let same = pixels(&renderer, &with(moved(&scene, b, DVec2::ZERO, 0.0)));
            assert!(same == before, "{name}: {b:?} where it stands");
        }
        // A car is put 6 m ahead of the vehicle, in the middle of the picture.
        let car = scene
            .frame()
            .boxes
            .values()
            .find(|b| b.class == Class::Car)
            .expect("a car");
        let ahead = scene
            .frame()
            .world_from_ego
            .apply(DVec3::new(6.0, 0.0, 0.0))
            .truncate();
        let object = moved(&scene, car, ahead - car.center_m.truncate(), 0.7);
        let request = RgbRenderRequest {
            dynamic_objects: vec![object.clone()],
            ..plain.clone()
        };
        let after = pixels(&renderer, &request);
        let differ = before
            .chunks(4)
            .zip(after.chunks(4))
            .filter(|(a, b)| a != b)
            .count();
        assert!(differ > 300, "{name}: {differ} of {} pixels", 160 * 90);
        assert!(
            after == pixels(&renderer, &request),
            "the same request gives the same"
        );
        assert!(before == pixels(&renderer, &plain), "the scene is as it was");
        // The LiDAR sees it too: nearer than before, straight ahead.
        let at = scene.frame().world_from_ego * Pose::from_wxyz([1.0, 0.0, 0.0, 0.0], [0.94, 0.0, 1.2]);
        let sweep = |dynamic_objects| {
            let request = LidarRenderRequest {
                scene_id: name.into(),
                sensor_pose: held(&at),
                dynamic_objects,
                ..LidarRenderRequest::default()
            };
            lidar::render(&renderer, &request).expect("a sweep").point_xyzs
        };
        let nearest = |xyzs: Vec<f32>| {
            let ahead = xyzs
                .chunks(3)
                .filter(|p| p[0] > 0.0 && p[1].abs() < 0.3 && p[2].abs() < 0.3);
            ahead.map(|p| p[0]).fold(f32::INFINITY, f32::min)
        };
        let [free_m, seen_m] = [nearest(sweep(vec![])), nearest(sweep(vec![object]))];
        assert!(
            (1.5..6.0).contains(&seen_m) && free_m > 7.0,
            "{name}: {free_m} m, then {seen_m} m"
        );
    }
}

/// Numbers that no client should send, but that are allowed one by one, do no harm.
#[test]
fn odd_cameras_are_rendered_or_refused() {
    let (_folder, renderer) = scenes();
    let scene = renderer.scenes.get("still").expect("a scene");
    let good = own_picture("still", &scene);
    for (focal, center, k) in [
        (1e-300, 0.0, 0.0),
        (1e300, 1e300, 1e5),
        (80.0, -1e9, -5.0),
        (80.0, 45.0, 1e-3),
    ] {
        for shutter in [ShutterType::Global, ShutterType::RollingRightToLeft] {
            let mut request = good.clone();
            request.frame_end_us = 30_000;
            request.sensor_pose = Some(PosePair {
                start_pose: good.sensor_pose.and_then(|p| p.start_pose),
                end_pose: Some(poses::write(&Pose::planar(9999.0, -9999.0, 3.0))),
            });
            let spec = request.camera_intrinsics.as_mut().expect("a lens");
            spec.shutter_type = shutter.into();
            if let Some(CameraParam::Pinhole(p)) = &mut spec.camera_param {
                (p.focal_length_x, p.focal_length_y) = (focal, focal);
                (p.principal_point_x, p.principal_point_y) = (center, center);
                p.radial_coeffs = vec![k];
            }
            match picture::render(&renderer, &request) {
                Ok(made) => assert_eq!(rgba(&made.image_bytes).len(), 160 * 90 * 4),
                Err(error) => assert_eq!(error.code(), tonic::Code::InvalidArgument, "{error}"),
            }
        }
    }
}

/// A wall across the way, 20 m ahead of the origin.
fn wall(folder: &std::path::Path) -> Renderer {
    let mut grid = VoxelGrid::new();
    for y in 0..200 {
        (0..16).for_each(|z| grid.set(150, y, z, Class::Manmade.id()));
    }
    let frame = Frame::new(BevLayout::default(), Default::default(), grid);
    let mut scene = Scene::single("wall", frame, Arc::new(SensorRig::default()), 1);
    scene.conditions = Conditions::default();
    formats::loom::save(&folder.join("wall.loom"), &scene).expect("saved");
    fixture::renderer(folder, ServerLidarModel::Exact)
}

#[test]
fn points_are_in_the_frame_of_the_end_of_the_spin() {
    let folder = tempfile::tempdir().expect("a folder");
    let renderer = wall(folder.path());
    // Turned to the left by a quarter while it drives 2 m ahead and 1 m to the side.
    let at = |x, y, yaw| Pose {
        translation_m: DVec3::new(x, y, 1.8),
        ..Pose::planar(0.0, 0.0, yaw)
    };
    let quarter = std::f64::consts::FRAC_PI_2;
    for (start, end, lidar_type) in [
        (at(0.0, 0.0, quarter), at(0.0, 0.0, quarter), 0),
        (at(0.0, 0.0, 0.0), at(2.0, 1.0, quarter), 0),
        (at(0.0, 0.0, -0.2), at(2.0, 1.0, 0.0), 1),
    ] {
        let request = LidarRenderRequest {
            scene_id: "wall".into(),
            lidar_config: Some(LidarSpec { lidar_type }),
            frame_end_us: 100_000,
            sensor_pose: Some(PosePair {
                start_pose: Some(poses::write(&start)),
                end_pose: Some(poses::write(&end)),
            }),
            ..LidarRenderRequest::default()
        };
        let sweep = lidar::render(&renderer, &request).expect("a sweep");
        let count = sweep.num_points as usize;
        assert_eq!(
            (sweep.point_xyzs.len(), sweep.point_intensities.len()),
            (3 * count, count)
        );
        let buffer = sweep.point_xyzs_buffer.as_chunks::<4>().0;
        assert!(
            buffer
                .iter()
                .map(|b| f32::from_le_bytes(*b))
                .eq(sweep.point_xyzs.iter().copied())
        );
        assert_eq!(sweep.point_intensities_buffer.len(), 4 * count);
        let mut on_wall = 0;
        for p in sweep.point_xyzs.chunks(3) {
            let world = end.apply(DVec3::new(p[0].into(), p[1].into(), p[2].into()));
            // (what lies beyond the map may be hit too)
            if world.y.abs() < 15.0 && (1.0..4.0).contains(&world.z) && world.x > 10.0 {
                assert!((world.x - 20.0).abs() < 0.05, "{world}");
                on_wall += 1;
            }
        }
        assert!(on_wall > 3000, "{on_wall} of {count}");
    }
}

#[test]
fn learned_sweeps_tell_intensities() {
    let folder = tempfile::tempdir().expect("a folder");
    fixture::write(folder.path());
    let renderer = fixture::renderer(folder.path(), ServerLidarModel::Learned);
    let request = LidarRenderRequest {
        scene_id: "clip".into(),
        frame_end_us: 100_000,
        sensor_pose: held(&Pose::from_wxyz([1.0, 0.0, 0.0, 0.0], [0.94, 0.0, 1.84])),
        ..LidarRenderRequest::default()
    };
    let sweep = lidar::render(&renderer, &request).expect("a sweep");
    assert!(sweep.num_points > 50_000, "{}", sweep.num_points);
    let (low, high) = sweep
        .point_intensities
        .iter()
        .fold((f32::MAX, f32::MIN), |(low, high), i| (low.min(*i), high.max(*i)));
    assert!(low >= 0.0 && high <= 1.0 && high - low > 0.05, "{low} to {high}");
    assert!(sweep == lidar::render(&renderer, &request).expect("a sweep"));
}

#[test]
fn several_sensors_are_answered_in_their_order() {
    let (_folder, renderer) = scenes();
    let scene = renderer.scenes.get("still").expect("a scene");
    let png = own_picture("still", &scene);
    let planar = RgbRenderRequest {
        image_format: ImageFormat::RgbUint8Planar.into(),
        ..png.clone()
    };
    let sweep = LidarRenderRequest {
        scene_id: "still".into(),
        lidar_config: Some(LidarSpec { lidar_type: 1 }),
        sensor_pose: held(&Pose::from_wxyz([1.0, 0.0, 0.0, 0.0], [0.94, 0.0, 1.84])),
        ..LidarRenderRequest::default()
    };
    let all = AggregatedRenderRequest {
        rgb_requests: vec![png.clone(), planar.clone()],
        lidar_requests: vec![sweep.clone()],
    };
    let made = several::aggregated(&renderer, &all).expect("all of them");
    assert_eq!(
        made.rgb_returns[0],
        picture::render(&renderer, &png).expect("a picture")
    );
    assert_eq!(made.rgb_returns[1].image_bytes.len(), 160 * 90 * 3);
    assert_eq!(
        made.lidar_returns[0],
        lidar::render(&renderer, &sweep).expect("a sweep")
    );
    let bad = RgbRenderRequest {
        scene_id: "nowhere".into(),
        ..planar.clone()
    };
    let with_bad = AggregatedRenderRequest {
        rgb_requests: vec![png.clone(), bad.clone()],
        ..AggregatedRenderRequest::default()
    };
    let error = several::aggregated(&renderer, &with_bad).expect_err("one of them");
    assert!(
        error.message().starts_with("rgb_requests[1]: no scene"),
        "{error}"
    );
    let item = |name: &str, request| BatchRgbRenderRequestItem {
        camera_name: name.into(),
        request,
    };
    let batch = BatchRgbRenderRequest {
        items: vec![
            item("a", Some(png.clone())),
            item("b", Some(bad)),
            item("c", None),
        ],
    };
    let made = several::batch(&renderer, &batch).expect("a batch").items;
    let told: Vec<_> = made.iter().map(|i| (i.camera_name.as_str(), i.success)).collect();
    assert_eq!(told, [("a", true), ("b", false), ("c", false)]);
    assert!(made[0].result.is_some() && made[1].error_message.contains("no scene"));
    let many = BatchRgbRenderRequest {
        items: vec![item("a", None); 65],
    };
    assert!(
        several::batch(&renderer, &many)
            .expect_err("too many")
            .message()
            .contains("at most 64")
    );
    let large = RgbRenderRequest {
        resolution_w: 4096,
        resolution_h: 4096,
        ..png
    };
    let large = AggregatedRenderRequest {
        rgb_requests: vec![large; 5],
        ..AggregatedRenderRequest::default()
    };
    assert!(
        several::aggregated(&renderer, &large)
            .expect_err("too large")
            .message()
            .contains("67108864")
    );
}
