//! The quality checks with what cameras and LiDAR return of every box.

use std::collections::BTreeMap;

use glam::DVec3;

use crate::camera_views::march;
use editor::checks::{self, Finding, Seen};
use scene::raster::box_cells;
use scene::{BoxId, Extent, Scene, SceneBox};
use sensors::lidar;
use sensors::splat::PREVIEW_SIZE;

/// LiDAR returns this far outside a box still come from it, m; below it two bins more, as labels are.
const MARGIN_M: f64 = 0.3;
const SMEAR_M: f64 = 0.8;

/// What cameras and LiDAR return of every box of the current frame: exact rays to voxels and shapes, at the size of
/// the camera strip's previews.
pub fn seen(scene: &Scene) -> Seen {
    let scene = &*scene.with_rig_in_world();
    let frame = scene.frame();
    // Numbers that are not finite are for another check, and for no ray.
    let mut sound = frame.boxes.clone();
    sound.retain(|_, b| b.problem().is_none());
    if scene.rig.problem().is_some() {
        return Seen::default();
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
    let lidar_returns = lidar::rig_sweep(&frame.occupancy, &scene.rig).map(|sweep| {
        let extent = frame.extent();
        let mut near: Vec<Vec<&SceneBox>> = vec![Vec::new(); extent.columns()];
        for b in sound.values() {
            box_cells(extent, b, MARGIN_M + Extent::VOXEL_M, |x, y| {
                near[extent.index(x, y)].push(b)
            });
        }
        let mut returns: BTreeMap<BoxId, u32> = BTreeMap::new();
        for point in &sweep.points {
            let p = DVec3::from_array(point.position_in_ego.map(f64::from));
            let Some([x, y]) = extent.column_at(p.x, p.y) else {
                continue;
            };
            for b in near[extent.index(x, y)].iter().filter(|b| b.class == point.class) {
                let (local, half) = (b.to_local(p), b.size_m / 2.0 + DVec3::splat(MARGIN_M));
                if local.truncate().abs().cmple(half.truncate()).all()
                    && (-half.z - SMEAR_M..=half.z).contains(&local.z)
                {
                    *returns.entry(b.id).or_default() += 1;
                }
            }
        }
        returns
    });
    Seen {
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
    use scene::{BoxLabel, Class};

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
        // A bunker around the second one.
        let [x, y] = Extent::WINDOW.column_at(-30.0, 30.0).expect("inside");
        let ring = |i: usize, j: usize| i.abs_diff(x).max(j.abs_diff(y));
        let mut cells = Vec::new();
        for (i, j) in (x - 5..=x + 5).flat_map(|i| (y - 5..=y + 5).map(move |j| (i, j))) {
            match ring(i, j) {
                5 => cells.extend((0..Extent::NZ).map(|z| [i, j, z])),
                _ => cells.push([i, j, Extent::NZ - 1]),
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
        // A rig without sensors sees nothing and blames nobody; one that is not sound neither.
        let mut blind = scene.clone();
        let rig = Arc::make_mut(&mut blind.rig);
        (rig.cameras, rig.lidars) = (Vec::new(), Vec::new());
        assert_eq!(super::seen(&blind), Seen::default());
        Arc::make_mut(&mut scene.rig).cameras[0].focal_px[0] = f64::NAN;
        assert_eq!(super::seen(&scene), Seen::default());
    }
}
