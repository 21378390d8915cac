//! Every source, through every lens: what it shows in a direction does not depend on the lens.

use glam::{DVec2, DVec3};

use super::*;
use crate::raycast::rays::CameraRays;
use scene::{Lens, ReadOut, Shutter};

const SIZE: [u32; 2] = [240, 136];

fn front() -> Camera {
    SensorRig::default().cameras[1].clone()
}

fn lenses() -> [Camera; 4] {
    let mut fisheye = front();
    fisheye.lens = Lens::Fisheye {
        k: [-0.02, 0.004, 0.0, 0.0],
        max_angle_deg: 95.0,
    };
    fisheye.focal_px = [600.0; 2];
    let mut f_theta = fisheye.clone();
    f_theta.lens = Lens::FTheta {
        c: [1.0, 0.01, -0.03, 0.0, 0.0, 0.0],
        max_angle_deg: 80.0,
    };
    let mut barrel = front();
    barrel.lens = Lens::Distorted {
        k: [-0.28, 0.07, 0.0, 0.0, 0.0, 0.0],
        p: [1e-3, -5e-4],
    };
    // A shutter changes nothing while nothing moves.
    let mut rolling = front();
    rolling.shutter = Some(Shutter {
        readout_s: 0.05,
        direction: ReadOut::RightToLeft,
    });
    [fisheye, f_theta, barrel, rolling]
}

/// A value of each pixel of each source that is the same for the same surface.
fn labels(source: &'static dyn CameraSource, frame: &Frame, camera: &Camera) -> Vec<u32> {
    let picture = drawn(source, frame, Conditions::default(), camera, SIZE).expect("a small picture");
    match picture {
        CameraPicture::Maps(maps) => maps.semantic.iter().map(|id| u32::from(*id)).collect(),
        // Classes of boxes, road and lines together.
        CameraPicture::Layout(map) => map.channels.iter().map(|bits| u32::from(bits >> 3)).collect(),
        CameraPicture::Planes(image) => image
            .first_visible()
            .iter()
            .map(|id| id.map_or(0, u32::from))
            .collect(),
        CameraPicture::Picture(_) => Vec::new(),
    }
}

#[test]
fn what_is_seen_in_a_direction_does_not_depend_on_the_lens() {
    let frame = street();
    let straight = CameraRays::new(&front(), SIZE[0], SIZE[1]);
    for source in all() {
        let expected = labels(*source, &frame, &front());
        if expected.is_empty() {
            continue;
        }
        for camera in lenses() {
            let found = labels(*source, &frame, &camera);
            let bent = CameraRays::new(&camera, SIZE[0], SIZE[1]);
            let (mut same, mut all) = (0, 0u32);
            for (i, label) in found.iter().enumerate() {
                let ray = bent.at(
                    (i % SIZE[0] as usize) as f64 + 0.5,
                    (i / SIZE[0] as usize) as f64 + 0.5,
                );
                if ray.direction == DVec3::ZERO {
                    assert_eq!(*label, 0, "{}: seen outside the lens", source.about().title);
                    continue;
                }
                let Some(px) = straight.seen_at(ray.origin + ray.direction, DVec3::ZERO) else {
                    continue;
                };
                let inside =
                    px.cmpge(DVec2::ZERO).all() && px.x < f64::from(SIZE[0]) && px.y < f64::from(SIZE[1]);
                if inside {
                    all += 1;
                    same += usize::from(expected[px.y as usize * SIZE[0] as usize + px.x as usize] == *label);
                }
            }
            let share = same as f64 / f64::from(all.max(1));
            println!(
                "{} {} {share:.3} of {all}",
                source.about().title,
                camera.lens.name()
            );
            assert!(
                all > 2000 && share > 0.85,
                "{} {}: {share:.3} of {all}",
                source.about().title,
                camera.lens.name()
            );
        }
    }
}
