//! Tests of the pictures: the same from every camera and on any number of threads, sound for any input.

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::*;
use scene::{BoxId, Class, Extent, Frame, Pose, SceneBox, SensorRig, Sun, TimeOfDay, VoxelGrid, Weather};
use world::World;
use world::voxelize::{Vertical, complete};

fn street(seed: u64) -> Frame {
    let world = World::random(seed);
    let grid = complete(&world, Vertical::Occ3d);
    Frame::new(world.layout.clone(), world.boxes.clone(), grid)
}

fn of(time: TimeOfDay, weather: Weather) -> Conditions {
    Conditions::usual(time, weather, 3)
}

fn pictures(frame: &Frame, rig: &SensorRig, size: [u32; 2], conditions: Conditions) -> Vec<CameraImage> {
    let appearance = Appearance::new(frame, rig, &conditions);
    let cameras = rig.cameras.par_iter();
    cameras
        .map(|c| appearance.render(c, size[0], size[1], Quality::Full))
        .collect()
}

/// Mean of a channel, 0..255.
fn mean(image: &CameraImage, channel: usize) -> f64 {
    let values = image.rgba.iter().skip(channel).step_by(4);
    values.map(|v| f64::from(*v)).sum::<f64>() / (image.rgba.len() / 4) as f64
}

#[test]
fn conditions_show() {
    let (frame, mut rig) = (street(5), SensorRig::default());
    rig.cameras.truncate(2);
    let take = |time, weather| pictures(&frame, &rig, [96, 54], of(time, weather)).remove(1);
    let day = take(TimeOfDay::Day, Weather::Clear);
    let light = |i: &CameraImage| (mean(i, 0) + mean(i, 1) + mean(i, 2)) / 3.0;
    assert!((70.0..200.0).contains(&light(&day)), "{}", light(&day));
    let night = take(TimeOfDay::Night, Weather::Clear);
    assert!(light(&night) < 0.5 * light(&day) && light(&night) > 4.0);
    let dusk = take(TimeOfDay::Dusk, Weather::Clear);
    assert!(mean(&dusk, 0) / mean(&dusk, 2) > mean(&day, 0) / mean(&day, 2) + 0.1);
    let sand = take(TimeOfDay::Day, Weather::Sandstorm);
    assert!(mean(&sand, 0) > mean(&sand, 2) + 30.0);
    // Snow whitens the lower half, fog takes contrast away.
    let lower = |i: &CameraImage| {
        let half = i.rgba.len() / 2;
        i.rgba[half..].iter().map(|v| f64::from(*v)).sum::<f64>() / half as f64
    };
    assert!(lower(&take(TimeOfDay::Day, Weather::Snow)) > lower(&day) + 25.0);
    let spread = |i: &CameraImage| {
        let m = mean(i, 1);
        let sum: f64 = i
            .rgba
            .iter()
            .skip(1)
            .step_by(4)
            .map(|v| (f64::from(*v) - m).powi(2))
            .sum();
        (sum / (i.rgba.len() / 4) as f64).sqrt()
    };
    assert!(spread(&take(TimeOfDay::Day, Weather::Fog)) < 0.6 * spread(&day));
    assert_ne!(
        take(TimeOfDay::Day, Weather::Rain).rgba,
        take(TimeOfDay::Day, Weather::Overcast).rgba
    );
}

/// Each number of the conditions shows, and rain falls on ground of any wetness.
#[test]
fn wetness_visibility_and_sun_show() {
    let (frame, mut rig) = (street(5), SensorRig::default());
    rig.cameras.truncate(2);
    let take = |conditions| pictures(&frame, &rig, [96, 54], conditions).remove(1);
    let day = of(TimeOfDay::Day, Weather::Clear);
    let base = take(day);
    let low = Sun {
        azimuth_deg: 20.0,
        elevation_deg: 12.0,
    };
    for other in [
        Conditions { wetness: 0.8, ..day },
        Conditions {
            visibility_m: 60.0,
            ..day
        },
        Conditions {
            sun: Some(low),
            ..day
        },
    ] {
        assert_ne!(take(other).rgba, base.rgba, "{other:?}");
    }
    let blue = |i: &CameraImage| mean(i, 2);
    let thick = take(Conditions {
        visibility_m: 20.0,
        ..day
    });
    assert!((blue(&thick) - blue(&base)).abs() > 5.0);
    // Streaks of rain do not hang on how wet the ground is.
    let appearance = |wetness| {
        let rain = of(TimeOfDay::Day, Weather::Rain);
        Appearance::new(&frame, &rig, &Conditions { wetness, ..rain })
    };
    assert!(appearance(0.3).air.rain && appearance(1.0).air.rain);
    let wet = |l: &Appearance| l.data().air[2][3];
    assert_eq!((wet(&appearance(0.25)), wet(&appearance(1.0))), (2.25, 3.0));
}

/// Rain and snow fall around the vehicle wherever it drives.
#[test]
fn rain_goes_along() {
    let frame = street(4);
    for weather in [Weather::Rain, Weather::Snow] {
        let wet_px = |x_m: f64| {
            let mut rig = SensorRig::default();
            rig.vehicle.translation_m.x = x_m;
            let mut camera = rig.cameras[0].clone();
            camera.translation_m[0] += x_m;
            let falling = Appearance::new(&frame, &rig, &of(TimeOfDay::Day, weather));
            let mut calm = Appearance::new(&frame, &rig, &of(TimeOfDay::Day, weather));
            (calm.air.rain, calm.air.snow) = (false, 0.0);
            let [a, b] = [&falling, &calm].map(|a| a.render(&camera, 80, 45, Quality::Preview).rgba);
            a.chunks(4).zip(b.chunks(4)).filter(|(a, b)| a != b).count()
        };
        let (here, there) = (wet_px(0.0), wet_px(25.0));
        assert!(here > 100 && there > here / 2, "{weather:?}: {here} {there}");
    }
}

#[test]
fn threads_do_not_matter_and_the_seed_does() {
    let (frame, mut rig) = (street(4), SensorRig::default());
    rig.cameras.truncate(2);
    let on = |threads, conditions| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("a pool");
        pool.install(|| pictures(&frame, &rig, [80, 45], conditions))
    };
    let rain = of(TimeOfDay::Dusk, Weather::Rain);
    let one = on(1, rain);
    assert_eq!(one, on(3, rain));
    assert_eq!(
        (one[0].camera.as_str(), one[0].rgba.len()),
        (rig.cameras[0].name.as_str(), 80 * 45 * 4)
    );
    assert_ne!(one, on(2, Conditions { seed: 4, ..rain }));
}

/// Matt ground has one colour, whichever camera looks at it, and keeps it when the ego drives on.
#[test]
fn places_look_the_same_from_everywhere() {
    let mut grid = VoxelGrid::new();
    for x in 0..Extent::WINDOW.nx() {
        for y in 0..Extent::WINDOW.ny() {
            let class = if y > 105 {
                Class::Sidewalk
            } else {
                Class::DriveableSurface
            };
            grid.set(x, y, 0, class.id());
        }
    }
    let frame = Frame::new(scene::BevLayout::default(), Default::default(), grid);
    let rig = SensorRig::default();
    let ahead = rig.standing_at(&Pose::planar(4.0, 0.0, 0.0));
    let conditions = of(TimeOfDay::Day, Weather::Clear);
    let (now, then) = (
        Appearance::new(&frame, &rig, &conditions),
        Appearance::new(&frame, &ahead, &conditions),
    );
    // The light of a place seen from an eye.
    let light = |appearance: &Appearance, place: DVec3, eye: DVec3| {
        let d = place - eye;
        let sample = appearance
            .light_along((eye.as_vec3(), d.normalize().as_vec3()), 0.0, 0.0015)
            .0;
        assert!(
            (f64::from(sample.t) - d.length()).abs() < 0.02,
            "{place}: {} {}",
            sample.t,
            d.length()
        );
        sample.color
    };
    for i in 0..60 {
        let place = DVec3::new(9.0 + 0.1 * f64::from(i), 0.37 - 0.05 * f64::from(i), 0.0);
        let a = light(&now, place, DVec3::new(1.7, 0.0, 1.5));
        let b = light(&now, place, DVec3::new(1.5, -0.5, 1.5));
        let c = light(&then, place, DVec3::new(1.7, 0.0, 1.5));
        // Haze, footprint and the sun's sheen differ a little with the eye.
        assert!((a - b).abs().max_element() < 0.03 * a.max_element(), "{a} {b}");
        assert!((a - c).abs().max_element() < 0.004 * a.max_element(), "{a} {c}");
    }
}

#[test]
fn things_cast_shadows_and_keep_their_colour_by_id() {
    let car = |id| SceneBox {
        id: BoxId(id),
        class: Class::Car,
        center_m: DVec3::new(10.0, 0.0, 0.85),
        size_m: DVec3::new(4.6, 1.95, 1.7),
        yaw_rad: 0.3,
        velocity_mps: DVec2::ZERO,
        label: Default::default(),
    };
    let mut grid = VoxelGrid::new();
    for x in 0..Extent::WINDOW.nx() {
        for y in 0..Extent::WINDOW.ny() {
            grid.set(x, y, 0, Class::DriveableSurface.id());
        }
    }
    let rig = SensorRig::default();
    let with = |boxes: &[SceneBox]| {
        let boxes = boxes.iter().map(|b| (b.id, *b)).collect();
        Frame::new(scene::BevLayout::default(), boxes, grid.clone())
    };
    let conditions = of(TimeOfDay::Day, Weather::Clear);
    let (empty, full) = (
        Appearance::new(&with(&[]), &rig, &conditions),
        Appearance::new(&with(&[car(1)]), &rig, &conditions),
    );
    let beside = glam::Vec3::new(10.0, 0.0, 0.0) - full.to_sun().truncate().normalize().extend(0.0) * 2.0;
    let eye = glam::Vec3::new(beside.x, beside.y, 9.0);
    let down = |appearance: &Appearance| {
        appearance
            .light_along((eye, -glam::Vec3::Z), 0.0, 0.001)
            .0
            .color
            .element_sum()
    };
    assert!(
        down(&full) < 0.6 * down(&empty),
        "{} {}",
        down(&full),
        down(&empty)
    );
    let roof = |id| {
        let appearance = Appearance::new(&with(&[car(id)]), &rig, &conditions);
        appearance
            .light_along((glam::Vec3::new(9.6, 0.0, 9.0), -glam::Vec3::Z), 0.0, 0.001)
            .0
    };
    assert!((roof(1).t - 7.3).abs() < 0.1, "{}", roof(1).t);
    assert_eq!(roof(1).color, roof(1).color);
    let others = (2..9)
        .filter(|id| (roof(*id).color - roof(1).color).length() > 0.05)
        .count();
    assert!(others >= 4, "{others}");
}

#[test]
fn bears_anything() {
    let mut full = VoxelGrid::new();
    for x in 0..Extent::WINDOW.nx() {
        for y in 0..Extent::WINDOW.ny() {
            full.column_mut(x, y)
                .fill([15, 16, 0, 4, 200][(x / 9 + y / 7) % 5]);
        }
    }
    let world = World::random(9);
    let mut boxes = world.boxes.clone();
    for (i, (class, size)) in Class::OBJECTS
        .into_iter()
        .zip([1e-6, 0.01, 0.3, 50.0, 900.0].into_iter().cycle())
        .enumerate()
    {
        let id = BoxId(9000 + i as u32);
        let b = SceneBox {
            id,
            class,
            center_m: DVec3::new(i as f64 * 3.0 - 20.0, 900.0 * f64::from(u8::from(i == 3)), 1.0),
            size_m: DVec3::splat(size),
            yaw_rad: 1e9,
            velocity_mps: DVec2::ONE,
            label: Default::default(),
        };
        boxes.insert(id, b);
    }
    boxes.insert(
        BoxId(9999),
        SceneBox {
            center_m: DVec3::NAN,
            ..*world.boxes.values().next().expect("traffic")
        },
    );
    let mut rig = SensorRig::default();
    rig.cameras.truncate(4);
    rig.cameras[0].focal_px = [800.0 / 2.0 / 85f64.to_radians().tan(); 2];
    rig.cameras[1].translation_m = [f64::NAN, 0.0, 1.0];
    rig.cameras[2].translation_m = [3.0, 1.0, -0.9];
    rig.cameras[3].translation_m = [1e7, -1e7, 1e3];
    for grid in [VoxelGrid::new(), full] {
        let frame = Frame::new(world.layout.clone(), boxes.clone(), grid);
        for pose in [
            Pose::IDENTITY,
            Pose::planar(1e9, -1e9, 7.0),
            Pose::planar(f64::NAN, 0.0, 0.0),
        ] {
            let rig = rig.standing_at(&pose);
            for (i, weather) in Weather::ALL.into_iter().enumerate() {
                let time = TimeOfDay::ALL[i % 4];
                for image in pictures(&frame, &rig, [23, 17], of(time, weather)) {
                    assert_eq!(image.rgba.len(), 23 * 17 * 4);
                    assert!(image.rgba.chunks(4).all(|p| p[3] == 255));
                }
            }
        }
        for size in [[0, 0], [0, 7], [1, 1], [3, 1], [1, 9]] {
            let all = pictures(&frame, &rig, size, Conditions::default());
            assert!(
                all.iter()
                    .all(|i| i.rgba.len() == (size[0] * size[1] * 4) as usize)
            );
        }
    }
    // Rays along axes and through edges.
    let appearance = Appearance::new(&street(1), &SensorRig::default(), &Conditions::default());
    let pick = [0.0f32, -0.0, 1.0, -1.0, 1e-30, 0.2, f32::NAN, f32::INFINITY];
    for (i, x) in pick.iter().enumerate() {
        for (k, y) in pick.iter().enumerate() {
            let d = glam::Vec3::new(*x, *y, pick[(i + 2 * k) % 6]).normalize_or_zero();
            let o = glam::Vec3::new(-40.2 + 3.2 * i as f32, 0.2 * k as f32, 0.1 * k as f32);
            if d != glam::Vec3::ZERO {
                let sample = appearance.light_along((o, d), 0.0, 0.001).0;
                assert!(!sample.color.is_nan(), "{o} {d} {:?}", sample);
            }
        }
    }
}

/// A wall 100 m ahead on a map: a ray finds it, a picture shows it, and the skyline stands behind it.
#[test]
fn a_map_is_seen_as_far_as_it_reaches() {
    let map = Extent::new([-150, -110], [480, 320]).expect("a sound size");
    let mut grid = VoxelGrid::over(map);
    for [x, y] in map.all_columns() {
        grid.set(x, y, 0, Class::DriveableSurface.id());
    }
    let bare = Frame::new(scene::BevLayout::over(map), Default::default(), grid.clone());
    let [x0, y0] = map.column_at(100.1, -10.0).expect("on the map");
    for i in 0..5 * 50 {
        grid.column_mut(x0 + i % 5, y0 + i / 5)[1..14].fill(Class::Manmade.id());
    }
    let frame = Frame::new(scene::BevLayout::over(map), Default::default(), grid);
    let (rig, conditions) = (SensorRig::default(), of(TimeOfDay::Day, Weather::Clear));
    let of_frame = |frame: &Frame| Appearance::new(frame, &rig, &conditions);
    let (with, without) = (of_frame(&frame), of_frame(&bare));
    let cropped = of_frame(&frame.crop(Extent::WINDOW));
    let eye = glam::Vec3::new(1.7, 0.0, 1.6);
    let ahead = |appearance: &Appearance| appearance.light_along((eye, glam::Vec3::X), 0.0, 0.001).0;
    let met = ahead(&with).t;
    assert!((met - 98.3).abs() < 0.4, "{met}");
    assert_eq!(
        (ahead(&without).t, ahead(&cropped).t),
        (f32::INFINITY, f32::INFINITY)
    );
    // Down to the road, beyond the window and 5 m in front of the wall.
    let road = (glam::Vec3::new(95.0, 3.0, 0.0) - eye).normalize();
    assert!((with.light_along((eye, road), 0.0, 0.001).0.t - 93.36).abs() < 0.1);
    let camera = rig.cameras.iter().find(|c| {
        let ahead = c.ego_from_camera().rotation * DVec3::Z;
        ahead.x > 0.99
    });
    let camera = camera.expect("one looks ahead");
    let [a, b] = [&with, &without].map(|l| l.render(camera, 160, 90, Quality::Preview).rgba);
    let differing = a.chunks_exact(4).zip(b.chunks_exact(4)).filter(|(a, b)| a != b);
    let differing = differing.count();
    assert!(
        (40..4000).contains(&differing),
        "{differing} pixels show the wall"
    );
    let data = with.data();
    assert_eq!(data.extent, map);
    // Much farther than one can see nothing is prepared.
    let far = Extent::new([-2000, -2000], [4000, 2000]).expect("a sound size");
    let far = Frame::new(
        scene::BevLayout::over(far),
        Default::default(),
        VoxelGrid::over(far),
    );
    assert_eq!(
        of_frame(&far).data().extent,
        Extent::new([-1000, -1000], [2000, 1000]).expect("sound")
    );
}

/// Maps of odd sizes, of one column too, are drawn without a panic.
#[test]
fn bears_any_extent() {
    let world = World::random(9);
    let whole = Frame::new(
        world.layout.clone(),
        world.boxes.clone(),
        complete(&world, Vertical::Occ3d),
    );
    let rig = SensorRig::default();
    for (from, size) in [
        ([0, 0], [1, 1]),
        ([-3, 5], [1, 40]),
        ([-60, -60], [90, 1]),
        ([5000, 5000], [7, 9]),
        ([-100, -40], [203, 77]),
    ] {
        let frame = whole.crop(Extent::new(from, size).expect("a sound size"));
        for image in pictures(&frame, &rig, [24, 14], of(TimeOfDay::Night, Weather::Rain)) {
            assert_eq!(image.rgba.len(), 24 * 14 * 4);
        }
    }
}
