//! A car that heads 35 degrees to the left stands, in every source's picture, where an independent pin-hole formula
//! projects its corners: a wrong sign of its yaw or of the camera's moves it by metres.

use glam::{DVec2, DVec3};

use super::*;
use scene::{BoxId, Class, SceneBox, Window};

/// Heading of the car and way that the camera looks, counter-clockwise from ego x.
const CAR_YAW_DEG: f64 = 35.0;
const CAMERA_YAW_DEG: f64 = -20.0;
const CAMERA_M: DVec3 = DVec3::new(1.0, 0.3, 0.6);
const CAR_M: DVec3 = DVec3::new(13.2, -4.1, 0.85);
const CAR_SIZE_M: DVec3 = DVec3::new(4.6, 1.9, 1.7);
const SIZE: [u32; 2] = [400, 225];
const FOCAL_PX: f64 = 550.0;

/// A point of the car, fractions of its size from its middle, in the ego frame: written out, so that nothing of the
/// program is asked.
fn of_car([x, y, z]: [f64; 3]) -> DVec3 {
    let (s, c) = CAR_YAW_DEG.to_radians().sin_cos();
    let (ahead, left) = (x * CAR_SIZE_M.x, y * CAR_SIZE_M.y);
    CAR_M + DVec3::new(ahead * c - left * s, ahead * s + left * c, z * CAR_SIZE_M.z)
}

/// The pixel of a point of the ego frame: a pin-hole that looks level to its yaw.
fn pixel(p: DVec3) -> DVec2 {
    let (s, c) = CAMERA_YAW_DEG.to_radians().sin_cos();
    let d = p - CAMERA_M;
    let (ahead, right) = (d.x * c + d.y * s, d.x * s - d.y * c);
    let middle = DVec2::new(f64::from(SIZE[0]), f64::from(SIZE[1])) / 2.0;
    middle + DVec2::new(right, -d.z) * (FOCAL_PX / ahead)
}

/// The camera of that formula: its yaw as a quaternion, times that of a camera that looks ahead.
fn camera() -> Camera {
    let (s, c) = (CAMERA_YAW_DEG.to_radians() / 2.0).sin_cos();
    let [w, x, y, z] = [0.5, -0.5, 0.5, -0.5];
    Camera {
        name: "CAM".into(),
        width: SIZE[0],
        height: SIZE[1],
        focal_px: [FOCAL_PX; 2],
        center_px: SIZE.map(|v| f64::from(v) / 2.0),
        rotation_wxyz: [c * w - s * z, c * x - s * y, c * y + s * x, c * z + s * w],
        translation_m: CAMERA_M.to_array(),
        ..Camera::new("CAM", 60.0)
    }
}

/// A road, and on it the car, as a box and as voxels: those of its front are half as high.
fn frame(with_car: bool) -> Frame {
    let mut grid = VoxelGrid::new();
    let (s, c) = CAR_YAW_DEG.to_radians().sin_cos();
    for (x, y) in (0..Window::NX).flat_map(|x| (0..Window::NY).map(move |y| (x, y))) {
        grid.set(x, y, 0, Class::DriveableSurface.id());
        for z in (2..Window::NZ).filter(|_| with_car) {
            let d = Window::center(x, y, z) - CAR_M;
            let (ahead, left) = (d.x * c + d.y * s, d.y * c - d.x * s);
            let top_m = if ahead > 0.1 * CAR_SIZE_M.x {
                0.0
            } else {
                CAR_SIZE_M.z / 2.0
            };
            if ahead.abs() < CAR_SIZE_M.x / 2.0 && left.abs() < CAR_SIZE_M.y / 2.0 && d.z < top_m {
                grid.set(x, y, z, Class::Car.id());
            }
        }
    }
    let car = SceneBox {
        id: BoxId(1),
        class: Class::Car,
        center_m: CAR_M,
        size_m: CAR_SIZE_M,
        yaw_rad: CAR_YAW_DEG.to_radians(),
        velocity_mps: DVec2::ZERO,
        label: Default::default(),
    };
    let boxes = with_car.then_some((car.id, car)).into_iter().collect();
    Frame::new(BevLayout::default(), boxes, grid)
}

/// True in the convex hull of some points grown by `margin` pixels.
fn in_hull(points: &[DVec2], p: DVec2, margin: f64) -> bool {
    // No line separates it from the points: half a degree apart is fine enough here.
    (0..720).all(|i| {
        let n = DVec2::from_angle(f64::from(i) * std::f64::consts::TAU / 720.0);
        let reach = points.iter().map(|q| n.dot(*q)).fold(f64::NEG_INFINITY, f64::max);
        n.dot(p) <= reach + margin
    })
}

/// The pixels of a block of the car, fractions of its size from its middle.
fn corners(low: [f64; 3], high: [f64; 3]) -> Vec<DVec2> {
    let pick = |corner: usize, axis: usize| [low, high][corner >> axis & 1][axis];
    (0..8)
        .map(|i| pixel(of_car([pick(i, 0), pick(i, 1), pick(i, 2)])))
        .collect()
}

/// Where the car is seen, row-major, and whether the picture tells front from rear. Of pictures in colours, where it
/// differs from the picture without it, above the horizon: below it are shadows.
fn seen(source: &'static dyn CameraSource) -> (Vec<bool>, bool) {
    let draw = |with_car| {
        drawn(source, &frame(with_car), Conditions::default(), &camera(), SIZE).expect("a small picture")
    };
    let car = Class::Car.id();
    match (draw(true), draw(false)) {
        (CameraPicture::Maps(maps), _) => (maps.semantic.iter().map(|s| *s == car).collect(), true),
        (CameraPicture::Planes(image), _) => {
            let first = image.first_visible();
            (first.iter().map(|s| *s == Some(car)).collect(), true)
        }
        (CameraPicture::Layout(map), _) => {
            let bit = 4 + Class::OBJECTS
                .iter()
                .position(|c| *c == Class::Car)
                .expect("an object");
            (map.channels.iter().map(|c| c >> bit & 1 == 1).collect(), false)
        }
        (CameraPicture::Picture(with), CameraPicture::Picture(without)) => {
            let pairs = with.rgba.chunks_exact(4).zip(without.rgba.chunks_exact(4));
            let gap = |(a, b): (&[u8], &[u8])| a.iter().zip(b).map(|(a, b)| u32::from(a.abs_diff(*b))).sum();
            let gaps: Vec<u32> = pairs.map(gap).collect();
            let above = |i: usize| i / with.width < with.height / 2;
            (
                gaps.iter()
                    .enumerate()
                    .map(|(i, gap)| *gap > 24 && above(i))
                    .collect(),
                true,
            )
        }
        _ => panic!("of two kinds"),
    }
}

/// What of one source's picture is not where it should be; `None` if all is.
fn misplaced(source: &'static dyn CameraSource) -> Option<String> {
    let name = source.id().name();
    let whole = corners([-0.5; 3], [0.5; 3]);
    let body = corners([-0.45, -0.42, -0.2], [0.45, 0.42, -0.02]);
    let row = |z: f64| pixel(of_car([0.0, 0.0, z])).y;
    let (mask, tells_front) = seen(source);
    let only_above = matches!(
        source.views()[0].id.name(),
        "appearance" | "normals" | "perceived"
    );
    let (mut body_seen, mut body_all, mut outside, mut total) = (0, 0, 0, 0);
    let (mut top_columns, mut top_count) = (0.0, 0);
    for (i, seen) in mask.iter().enumerate() {
        let at = [i as u32 % SIZE[0], i as u32 / SIZE[0]].map(f64::from);
        let p = DVec2::from_array(at) + 0.5;
        if in_hull(&body, p, -2.0) && !(only_above && p.y > f64::from(SIZE[1]) / 2.0 - 2.0) {
            body_all += 1;
            body_seen += usize::from(*seen);
        }
        total += usize::from(*seen);
        // Voxels stick out by half a voxel's diagonal, splats by some more.
        outside += usize::from(*seen && !in_hull(&whole, p, 0.45 * FOCAL_PX / 13.0));
        if *seen && (row(0.45)..row(0.3)).contains(&p.y) {
            top_columns += p.x;
            top_count += 1;
        }
    }
    // What is highest stands behind the middle: the bonnet is low.
    let [middle, rear] = [0.0, -0.5].map(|x| pixel(of_car([x, 0.0, 0.4])).x);
    let behind_px = (top_columns / f64::from(top_count) - middle) * (rear - middle).signum();
    let line = format!(
        "{name}: {body_seen} of {body_all} pixels of the body, {outside} of {total} beside the car, the top of {top_count} \
         pixels {behind_px:.1} px behind the middle"
    );
    println!("{line}");
    let stands = body_all > 300 && body_seen * 100 >= body_all * 90 && outside * 100 <= total;
    let heads = !tells_front || top_count > 100 && behind_px > 3.0;
    (!(stands && heads)).then_some(line)
}

#[test]
fn every_source_shows_a_turned_car_where_its_corners_are() {
    // Painted alone, a picture is another everywhere; where an edit is painted is tested with the painter.
    let exact = all().iter().filter(|s| s.id() != learned::ID);
    let wrong: Vec<String> = exact.filter_map(|s| misplaced(*s)).collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
}
