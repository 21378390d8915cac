//! The quality checks, with the camera pixels and LiDAR returns of every box.

use std::collections::BTreeMap;

use glam::DVec3;

use crate::camera_views::march;
use editor::checks::{self, Finding, VisibilityCounts};
use formats::physical;
use scene::{BoxId, LidarPoint, Pose, Returns, Scene};
use sensors::lidar::recorded;
use sensors::splat::PREVIEW_SIZE;

/// Counts the camera pixels and LiDAR returns of every box of the current frame. Pixels come from exact rays to voxels
/// and shapes, at the size of the camera strip's previews. Returns are those of the exact sweep on the physical ground,
/// as files have it, that lie in the box. The result does not depend on the frame in which the scene's sensors are
/// given.
pub fn seen(scene: &Scene) -> VisibilityCounts {
    let scene = &*scene.for_sensors();
    let frame = scene.frame();
    // Another check reports numbers that are not finite; rays would fail on them.
    let mut sound = frame.boxes.clone();
    sound.retain(|_, b| b.problem().is_none());
    if scene.rig.problem().is_some() {
        return VisibilityCounts::default();
    }
    let camera_pixels = (!scene.rig.cameras.is_empty()).then(|| {
        let mut tidy = scene.clone();
        tidy.change(scene::Scope::default(), |frame| frame.boxes = sound.clone());
        let marched = march(&tidy, true);
        let [width, height] = PREVIEW_SIZE;
        let mut pixels: BTreeMap<BoxId, u32> = BTreeMap::new();
        for camera in &scene.rig.cameras {
            let maps = marched.render(camera, width, height);
            for id in maps.hits.iter().flatten().filter_map(|hit| hit.box_id) {
                *pixels.entry(id).or_default() += 1;
            }
        }
        pixels
    });
    let lidar_returns = (!scene.rig.lidars.is_empty()).then(|| {
        let mut sweep = recorded::sweep_or_exact(scene);
        sweep.place(&frame.world_from_ego.inverse());
        let lidar = scene.rig.standing_at(&Pose::IDENTITY).lidars[0].ego_from_sensor();
        physical::to_physical_ground(&mut sweep, lidar.translation_m, frame);
        let in_world = |p: &LidarPoint| {
            let p = DVec3::from_array(p.position_in_ego.map(f64::from));
            frame.world_from_ego.apply(p)
        };
        Returns::new(sweep.points.iter().map(in_world)).by_box(sound.values())
    });
    VisibilityCounts {
        camera_pixels,
        lidar_returns,
    }
}

/// All findings of a scene, sensors included.
pub fn check(scene: &Scene) -> Vec<Finding> {
    checks::run_checks(scene, Some(&seen(scene)))
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::open;
    use editor::{Apply, Edit};
    use scene::{BoxLabel, Class, Extent, Key, Motion, Window};
    use sensors::lidar::rolling;

    #[test]
    fn sensors_see_near_boxes_and_not_those_inside_a_wall() {
        let mut scene = open::from_template("straight", 3).expect("a template");
        let add = |x: f64, y: f64| Edit::AddBox {
            class: Class::Pedestrian,
            center_m: DVec3::new(x, y, 0.9),
            size_m: DVec3::new(0.7, 0.7, 1.8),
            yaw_deg: 0.0,
            velocity_mps: None,
            id: Some(BoxId(if x > 0.0 { 901 } else { 902 })),
            label: BoxLabel::default(),
        };
        add(6.0, -0.5).apply(&mut scene).expect("sound");
        add(-30.0, 30.0).apply(&mut scene).expect("sound");
        // Walls enclose the second box.
        let [x, y] = Extent::WINDOW.column_at(-30.0, 30.0).expect("inside");
        let ring = |i: usize, j: usize| i.abs_diff(x).max(j.abs_diff(y));
        let mut cells = Vec::new();
        for (i, j) in (x - 5..=x + 5).flat_map(|i| (y - 5..=y + 5).map(move |j| (i, j))) {
            match ring(i, j) {
                5 => cells.extend((0..Window::NZ).map(|z| [i, j, z])),
                _ => cells.push([i, j, Window::NZ - 1]),
            }
        }
        let class = Class::Manmade;
        Edit::PaintVoxels { cells, class }
            .apply(&mut scene)
            .expect("sound");
        let seen = seen(&scene);
        let (pixels, returns) = (
            seen.camera_pixels.expect("cameras"),
            seen.lidar_returns.expect("a LiDAR"),
        );
        assert!(
            pixels[&BoxId(901)] > 100 && returns[&BoxId(901)] > 10,
            "{pixels:?} {returns:?}"
        );
        assert_eq!((pixels.get(&BoxId(902)), returns.get(&BoxId(902))), (None, None));
        let findings = check(&scene);
        let of = |id: u32| {
            findings
                .iter()
                .filter(move |f| f.box_id == Some(BoxId(id)))
                .map(|f| f.check)
        };
        assert_eq!(
            of(902).collect::<Vec<_>>(),
            ["unseen_by_cameras", "no_lidar_returns"]
        );
        assert_eq!(of(901).count(), 0);
        // With a rig without sensors, or with an invalid one, no box is reported as unseen.
        let mut blind = scene.clone();
        let rig = Arc::make_mut(&mut blind.rig);
        (rig.cameras, rig.lidars) = (Vec::new(), Vec::new());
        assert_eq!(super::seen(&blind), VisibilityCounts::default());
        Arc::make_mut(&mut scene.rig).cameras[0].focal_px[0] = f64::NAN;
        assert_eq!(super::seen(&scene), VisibilityCounts::default());
    }

    /// A drive of 8 m in 2 s.
    fn driven() -> Scene {
        let mut scene = open::from_template("straight", 3).expect("a template");
        let key = |time_s: f64, x: f64| Key {
            time_s,
            at_m: glam::DVec2::new(x, 0.5),
            yaw_deg: 4.0 * x,
        };
        scene.change_clip(|clip| {
            clip.length_s = 2.0;
            clip.ego = Some(Motion::Keys(vec![key(0.0, 0.0), key(2.0, 8.0)]));
        });
        scene
    }

    #[test]
    fn a_rig_that_stands_in_the_world_is_not_put_there_again() {
        let scene = driven().at(2.0);
        let once = scene.with_rig_in_world();
        assert_ne!(once.rig, scene.rig);
        assert_eq!(once.with_rig_in_world().rig, once.rig);
        let seen = super::seen(&scene);
        assert_eq!(super::seen(&once), seen);
        // The returns are those of the sweep in files.
        let returns = seen.lidar_returns.expect("a LiDAR");
        assert!(returns.values().sum::<u32>() > 100, "{returns:?}");
        let at = scene.frame().world_from_ego.translation_m;
        let near = scene
            .frame()
            .boxes
            .values()
            .filter(|b| b.center_m.distance(at) < 12.0);
        let near: Vec<_> = near.filter(|b| b.size_m.z > 1.2).collect();
        assert!(near.iter().any(|b| returns.contains_key(&b.id)), "{near:?}");
    }

    /// Returns of objects above the ground and under their box, and returns of objects in no box of their class.
    fn outside(scene: &Scene, sweep: &scene::LidarSweep) -> [usize; 2] {
        let boxes = &scene.frame().boxes;
        let of_things = sweep.points.iter().filter_map(|p| {
            let at = DVec3::from_array(p.position_in_ego.map(f64::from));
            let mut near = boxes.values().filter(|b| {
                let over = at.z > b.center_m.z - b.size_m.z / 2.0;
                b.class == p.class && over && b.contains(at, 1.0)
            });
            near.next()?;
            Some(boxes.values().any(|b| b.class == p.class && b.contains(at, 0.0)))
        });
        of_things.fold([0, 0], |[out, all], inside| [out + usize::from(!inside), all + 1])
    }

    #[test]
    fn returns_of_things_are_in_their_boxes() {
        let templates = ["straight", "t-junction", "intersection", "parking"]
            .map(|name| (name, open::from_template(name, 5).expect("a template")));
        for (name, scene) in templates.into_iter().chain([("drive", driven().at(1.5))]) {
            let scene = scene.with_rig_in_world();
            let [before, after] =
                [rolling::of_voxels(&scene), rolling::exact(&scene)].map(|sweep| outside(&scene, &sweep));
            println!("{name}: outside of their boxes {before:?} as voxels, {after:?} on shapes");
            assert!(
                before[0] * 10 > before[1] && after[1] > 100,
                "{name}: {before:?} {after:?}"
            );
            assert_eq!(after[0], 0, "{name} of {after:?}");
        }
    }
}
