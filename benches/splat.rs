//! Time of the camera maps of a street of some 60,000 voxels: six cameras, shown and preview size.
//! Run: `cargo bench --bench splat`.

use sceneloom::generation::sensors::cloud::GaussianCloud;
use sceneloom::generation::sensors::splat::{PREVIEW_SIZE, SplatOptions, VIEW_SIZE, render_rig};
use sceneloom::scene::SensorRig;

#[path = "../tests/sensor_scene/mod.rs"]
mod sensor_scene;
#[path = "timing.rs"]
mod timing;

fn main() {
    let (grid, bev) = sensor_scene::street();
    let rig = SensorRig::default();
    timing::time("cloud of all voxels", 9, || {
        GaussianCloud::from_grid(&grid, &bev).len()
    });
    let clouds = [
        ("all", GaussianCloud::from_grid(&grid, &bev)),
        ("shell of 2", GaussianCloud::from_grid_shell(&grid, &bev, 2)),
    ];
    for (name, cloud) in &clouds {
        for [w, h] in [VIEW_SIZE, PREVIEW_SIZE, [800, 450]] {
            timing::time(&format!("{name}: six cameras {w}x{h}"), 9, || {
                let maps = render_rig(cloud, &rig, w, h, &SplatOptions::default());
                maps.iter()
                    .map(|m| m.semantic.iter().filter(|&&s| s > 0).count())
                    .sum()
            });
        }
    }
}
