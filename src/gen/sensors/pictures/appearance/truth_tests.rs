//! Tests of labels, depths, flow and boxes against the picture that they belong to.

use std::collections::BTreeMap;

use glam::{DVec2, DVec3, Vec3};

use super::shade::VisibleSurface;
use super::truth::usable;
use super::*;
use crate::raycast::rays::CameraRays;
use scene::truth::{OTHERS, OUTSIDE, SKY};
use scene::{
    BevLayout, BoxId, Camera, CameraTruth, Class, Frame, Lens, ReadOut, SceneBox, SensorRig, Shutter,
    TimeOfDay, VoxelGrid, Weather,
};
use world::World;
use world::voxelize::{Vertical, complete};

const SIZE: [u32; 2] = [200, 112];

fn street(seed: u64) -> Frame {
    let world = World::random(seed);
    let grid = complete(&world, Vertical::Occ3d);
    Frame::new(world.layout.clone(), world.boxes.clone(), grid)
}

fn day() -> Conditions {
    Conditions::usual(TimeOfDay::Day, Weather::Clear, 3)
}

fn car(id: u32, x_m: f64, y_m: f64) -> SceneBox {
    SceneBox {
        id: BoxId(id),
        class: Class::Car,
        center_m: DVec3::new(x_m, y_m, 0.8),
        size_m: DVec3::new(4.5, 1.9, 1.6),
        yaw_rad: 0.0,
        velocity_mps: DVec2::ZERO,
        label: Default::default(),
    }
}

fn field_with(boxes: &[SceneBox]) -> Frame {
    let boxes = boxes.iter().map(|b| (b.id, *b)).collect();
    Frame::new(BevLayout::default(), boxes, VoxelGrid::new())
}

fn front() -> Camera {
    SensorRig::default().cameras[1].clone()
}

fn truth_of(frame: &Frame, camera: &Camera, next: Option<&NextMoment<'_>>) -> CameraTruth {
    let rig = SensorRig {
        cameras: vec![camera.clone()],
        ..SensorRig::default()
    };
    Appearance::new(frame, &rig, &day()).truth(camera, SIZE, &frame.boxes, next)
}

/// Sky, skyline and surfaces: what a pixel is called is what its colour was made of, in every pixel; and to ask for the truth
/// changes no picture.
#[test]
fn labels_are_of_what_made_the_colour() {
    for (seed, weather) in [(5, Weather::Clear), (9, Weather::Snow)] {
        let (frame, rig) = (street(seed), SensorRig::default());
        let conditions = Conditions::usual(TimeOfDay::Day, weather, 3);
        let appearance = Appearance::new(&frame, &rig, &conditions);
        for camera in &rig.cameras[..3] {
            for quality in [Quality::Preview, Quality::Full] {
                let (image, truth) = appearance.render_truth(camera, SIZE, quality, &frame.boxes, None);
                assert_eq!(image, appearance.render(camera, SIZE[0], SIZE[1], quality));
                let plain = appearance.truth(camera, SIZE, &frame.boxes, None);
                // Flow is NaN.
                let told = |t: &CameraTruth| t.plane(|p| (p.class, p.instance, p.depth_m.to_bits()));
                match quality {
                    Quality::Play | Quality::Preview => assert_eq!(told(&truth), told(&plain)),
                    Quality::Full => {
                        let of = |t: &CameraTruth| t.plane(|p| (p.class, p.instance));
                        let same = of(&truth)
                            .iter()
                            .zip(of(&plain))
                            .filter(|(a, b)| **a == *b)
                            .count();
                        assert!(
                            same * 20 > truth.pixels.len() * 19,
                            "{same} of {}",
                            truth.pixels.len()
                        );
                    }
                }
            }
            let truth = appearance.truth(camera, SIZE, &frame.boxes, None);
            let rays = CameraRays::new(camera, SIZE[0], SIZE[1]);
            let (mut sky, mut wrong) = (0, 0);
            for (i, pixel) in truth.pixels.iter().enumerate() {
                let at = (i % SIZE[0] as usize, i / SIZE[0] as usize);
                let ray = rays.at(at.0 as f64 + 0.5, at.1 as f64 + 0.5);
                let (o, d) = usable(&ray).expect("a pinhole sees everywhere");
                let (sample, seen) = appearance.light_along((o, d), 0.0, 0.001);
                let is_sky = sample.color == appearance.air.sky(appearance.anchor_dir(d));
                wrong += usize::from(is_sky != (pixel.class == SKY));
                wrong += usize::from((pixel.depth_m < 0.0) != is_sky);
                wrong += usize::from(matches!(seen, VisibleSurface::Sky) != is_sky);
                sky += usize::from(is_sky);
            }
            assert!(
                sky > 1000 && wrong == 0,
                "{}: {wrong} wrong, {sky} of the sky",
                camera.name
            );
        }
    }
}

/// A box that is taken away changes the labels of its own pixels and of no others.
#[test]
fn instances_are_the_pixels_that_go_with_the_box() {
    let frame = street(5);
    let camera = front();
    let all = truth_of(&frame, &camera, None);
    let mut checked = 0;
    for seen in all.boxes.iter().filter(|b| b.visible_px > 30).take(4) {
        let mut without = frame.clone();
        without.boxes.remove(&seen.of.id);
        // Its voxels stay as they are: they were taken out for the box, and come back. So it becomes a hole instead.
        let mut grid = without.occupancy.clone();
        for (x, y, z, label) in frame.occupancy.iter_set() {
            let p = frame.extent().center(x, y, z);
            if label == seen.of.class.id() && seen.of.contains(p, 1.2) {
                grid.set(x, y, z, Class::FREE);
            }
        }
        without.occupancy = grid;
        let rest = truth_of(&without, &camera, None);
        for (i, (a, b)) in all.pixels.iter().zip(&rest.pixels).enumerate() {
            match a.instance == seen.of.id.0 {
                true => assert!(
                    b.instance != a.instance && (b.depth_m > a.depth_m || b.depth_m < 0.0),
                    "pixel {i}"
                ),
                false => assert!(
                    a.class == b.class && a.instance == b.instance,
                    "pixel {i}: {a:?} {b:?}"
                ),
            }
        }
        checked += 1;
    }
    assert!(checked >= 2, "{checked} boxes are seen");
}

#[test]
fn depths_lie_on_the_boxes_and_hidden_parts_are_counted() {
    let (near, far) = (car(7, 12.0, 0.0), car(3, 20.0, 1.2));
    let camera = front();
    let truth = truth_of(&field_with(&[near, far]), &camera, None);
    let rays = CameraRays::new(&camera, SIZE[0], SIZE[1]);
    for (i, pixel) in truth.pixels.iter().enumerate().filter(|(_, p)| p.instance != 0) {
        let ray = rays.at(
            (i % SIZE[0] as usize) as f64 + 0.5,
            (i / SIZE[0] as usize) as f64 + 0.5,
        );
        let p = ray.origin + ray.direction * f64::from(pixel.depth_m);
        // Mirrors stick out.
        let of = if pixel.instance == 7 { near } else { far };
        assert!(
            of.contains(p, 0.2) && pixel.class == Class::Car.id(),
            "{p} of box {}",
            pixel.instance
        );
        let n = Vec3::from(pixel.normal_in_camera);
        let towards =
            n.dot(camera.ego_from_camera().rotation.as_quat().conjugate() * ray.direction.as_vec3());
        assert!((n.length() - 1.0).abs() < 1e-3 && towards < 0.05, "{n}");
    }
    let [behind, front] = [&truth.boxes[0], &truth.boxes[1]];
    assert_eq!((behind.of.id, front.of.id), (BoxId(3), BoxId(7)));
    assert!(front.visibility > 0.99 && front.in_picture > 0.99, "{front:?}");
    assert!((0.1..0.8).contains(&behind.visibility), "{}", behind.visibility);
    assert!(behind.visible_px < behind.whole_px && behind.whole_px < front.whole_px);
    let [left, top, right, bottom] = front.visible_bounds_px.expect("seen");
    let inside = |p: &Option<[f64; 2]>| {
        p.is_some_and(|[u, v]| {
            (left - 2.0..=right + 2.0).contains(&u) && (top - 2.0..=bottom + 2.0).contains(&v)
        })
    };
    assert!(
        !front.corners_px.iter().all(inside),
        "corners stick out of the shape"
    );
    assert!((front.center_in_camera_m.z - (12.0 - camera.translation_m[0])).abs() < 0.2);
    // Nobody behind the camera is listed.
    assert!(
        truth_of(&field_with(&[car(1, -15.0, 0.0)]), &camera, None)
            .boxes
            .is_empty()
    );
}

/// Flow leads to where the same thing is seen at the next moment, for what moves, what stands and the sky.
#[test]
fn flow_leads_to_the_same_thing() {
    let mut now = car(7, 14.0, 2.0);
    (now.yaw_rad, now.velocity_mps) = (0.3, DVec2::new(8.0, 2.0));
    let mut then = now;
    (then.center_m, then.yaw_rad) = (now.center_m + DVec3::new(0.8, 0.2, 0.0), 0.38);
    let post = car(9, 16.0, -4.0);
    let camera = front();
    let mut later = camera.clone();
    later.translation_m[0] += 1.0;
    let (before, after) = (field_with(&[now, post]), field_with(&[then, post]));
    let next = NextMoment {
        camera: later.clone(),
        boxes: &after.boxes,
        after_s: 0.1,
    };
    let (truth, arrived) = (
        truth_of(&before, &camera, Some(&next)),
        truth_of(&after, &later, None),
    );
    assert_eq!(truth.flow_s, Some(0.1));
    let mut counted: BTreeMap<u32, [usize; 2]> = BTreeMap::new();
    for (i, pixel) in truth.pixels.iter().enumerate() {
        let [u, v] = [
            (i % SIZE[0] as usize) as f32 + 0.5,
            (i / SIZE[0] as usize) as f32 + 0.5,
        ];
        let (x, y) = (u + pixel.flow_px[0], v + pixel.flow_px[1]);
        if !(x >= 0.0 && y >= 0.0 && x < SIZE[0] as f32 && y < SIZE[1] as f32) {
            continue;
        }
        let there = arrived.pixels[y as usize * SIZE[0] as usize + x as usize];
        let count = counted
            .entry(if pixel.class == SKY { 1000 } else { pixel.instance })
            .or_default();
        count[usize::from(
            there.instance == pixel.instance && (there.class == SKY) == (pixel.class == SKY),
        )] += 1;
    }
    for (of, [wrong, right]) in counted {
        assert!(
            right > 60 && wrong * 12 < right,
            "{of}: {wrong} wrong, {right} right"
        );
    }
    // What is gone leads nowhere.
    let gone = NextMoment {
        boxes: &BTreeMap::new(),
        ..next
    };
    let truth = truth_of(&before, &camera, Some(&gone));
    assert!(
        truth
            .pixels
            .iter()
            .filter(|p| p.instance == 7)
            .all(|p| p.flow_px[0].is_nan())
    );
}

/// What a fisheye shows in a pixel is what a pinhole shows in the pixel that looks the same way.
#[test]
fn lenses_of_all_kinds_show_the_same_world() {
    let frame = street(5);
    let mut fisheye = front();
    fisheye.lens = Lens::Fisheye {
        k: [-0.02, 0.004, 0.0, 0.0],
        max_angle_deg: 92.0,
    };
    fisheye.focal_px = [420.0; 2];
    let mut barrel = front();
    barrel.lens = Lens::Distorted {
        k: [-0.28, 0.07, 0.0, 0.0, 0.0, 0.0],
        p: [1e-3, -5e-4],
    };
    let pinhole = front();
    let of_pinhole = truth_of(&frame, &pinhole, None);
    let straight = CameraRays::new(&pinhole, SIZE[0], SIZE[1]);
    for camera in [fisheye, barrel] {
        let truth = truth_of(&frame, &camera, None);
        let bent = CameraRays::new(&camera, SIZE[0], SIZE[1]);
        let (mut same, mut other, mut blind) = (0, 0, 0);
        for (i, pixel) in truth.pixels.iter().enumerate() {
            let ray = bent.at(
                (i % SIZE[0] as usize) as f64 + 0.5,
                (i / SIZE[0] as usize) as f64 + 0.5,
            );
            if pixel.class == OUTSIDE {
                assert_eq!(ray.direction, DVec3::ZERO);
                blind += 1;
                continue;
            }
            let Some(px) = straight.seen_at(ray.origin + ray.direction, DVec3::ZERO) else {
                continue;
            };
            if px.cmplt(DVec2::ZERO).any() || px.x >= f64::from(SIZE[0]) || px.y >= f64::from(SIZE[1]) {
                continue;
            }
            let there = of_pinhole.pixels[px.y as usize * SIZE[0] as usize + px.x as usize];
            *(if there.class == pixel.class {
                &mut same
            } else {
                &mut other
            }) += 1;
        }
        // Pixels do not fall together, so borders differ.
        assert!(
            same > 1000 && other * 6 < same,
            "{}: {same} same, {other} other",
            camera.lens.name()
        );
        assert!((blind > 0) == camera.lens.is_wide(), "{blind}");
        let labels: Vec<u8> = truth.plane(|p| p.class);
        assert!(labels.iter().all(|c| *c <= OTHERS + 1 || *c == OUTSIDE));
    }
}

/// A car that drives the way the columns are read is drawn longer, by what it drives meanwhile.
#[test]
fn a_rolling_shutter_stretches_what_moves_with_it() {
    let mut camera = front();
    let mut across = car(4, 14.0, 0.0);
    (across.yaw_rad, across.size_m.x) = (-std::f64::consts::FRAC_PI_2, 4.0);
    let width = |camera: &Camera, velocity_mps: DVec2| {
        let truth = truth_of(
            &field_with(&[SceneBox {
                velocity_mps,
                ..across
            }]),
            camera,
            None,
        );
        let [left, _, right, _] = truth.boxes[0].visible_bounds_px.expect("seen");
        right - left
    };
    let still = width(&camera, DVec2::ZERO);
    camera.shutter = Some(Shutter {
        readout_s: 0.5,
        direction: ReadOut::LeftToRight,
    });
    assert_eq!(width(&camera, DVec2::ZERO), still);
    // To the right in the picture is towards -y.
    let (with, against) = (
        width(&camera, DVec2::new(0.0, -8.0)),
        width(&camera, DVec2::new(0.0, 8.0)),
    );
    assert!(
        with > still * 1.15 && against < still * 0.9,
        "{against} {still} {with}"
    );
}

/// A box is listed for every pixel that shows it, also where only a part of a pixel does; its bounds are those of its pixels, and
/// are left out just where there is no such pixel.
#[test]
fn boxes_have_bounds_as_soon_as_a_pixel_shows_them() {
    let (mut seen, mut hidden, mut finer) = (0, 0, 0);
    for seed in 0..9 {
        let frame = street(seed);
        let rig = SensorRig::default();
        let appearance = Appearance::new(&frame, &rig, &day());
        for camera in &rig.cameras {
            let size = [96, 54];
            let (_, truth) = appearance.render_truth(camera, size, Quality::Full, &frame.boxes, None);
            let plain = appearance.truth(camera, size, &frame.boxes, None);
            finer += truth.boxes.len() - plain.boxes.len().min(truth.boxes.len());
            let mut pixels: BTreeMap<u32, (u32, [f64; 4])> = BTreeMap::new();
            for (i, pixel) in truth.pixels.iter().enumerate().filter(|(_, p)| p.instance != 0) {
                let [x, y] = [i % truth.width, i / truth.width].map(|v| v as f64);
                let (n, b) = pixels.entry(pixel.instance).or_insert((0, [x, y, x, y]));
                *n += 1;
                *b = [b[0].min(x), b[1].min(y), b[2].max(x + 1.0), b[3].max(y + 1.0)];
            }
            for b in &truth.boxes {
                let own = pixels.remove(&b.of.id.0);
                assert_eq!(b.visible_px, own.map_or(0, |(n, _)| n), "{:?}", b.of.id);
                assert_eq!(
                    b.visible_bounds_px,
                    own.map(|(_, bounds)| bounds),
                    "{:?}",
                    b.of.id
                );
                assert!(b.whole_px >= b.visible_px.max(1) && (0.0..=1.0).contains(&b.visibility));
                let [left, top, right, bottom] = b.whole_bounds_px;
                let within = |[l, t, r, m]: [f64; 4]| left <= l && top <= t && right >= r && bottom >= m;
                assert!(b.visible_bounds_px.is_none_or(within), "{:?}", b.of.id);
                *(if own.is_some() { &mut seen } else { &mut hidden }) += 1;
            }
            assert!(
                pixels.is_empty(),
                "pixels show boxes that are not listed: {pixels:?}"
            );
        }
    }
    println!("{seen} boxes are seen, {hidden} are not, {finer} only by parts of pixels");
    assert!(seen > 100 && hidden > 20, "{seen} {hidden}");
}
