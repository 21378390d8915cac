//! Time of the camera maps of a street of some 60,000 voxels: six cameras, shown and preview size.
//! Run: `cargo bench --bench splat`.

use std::time::Instant;

use sceneloom::generation::sensors::cloud::GaussianCloud;
use sceneloom::generation::sensors::splat::{PREVIEW_SIZE, SplatOptions, VIEW_SIZE, render_rig};
use sceneloom::scene::SensorRig;

#[path = "../tests/sensor_scene/mod.rs"]
mod sensor_scene;

fn time_ms(what: &str, mut run: impl FnMut() -> usize) {
    run();
    run();
    let mut times = Vec::new();
    let mut count = 0;
    for _ in 0..15 {
        let start = Instant::now();
        count = run();
        times.push(start.elapsed().as_secs_f64() * 1e3);
    }
    times.sort_by(f64::total_cmp);
    println!(
        "{what}: median {:.1} ms, least {:.1} ms ({count})",
        times[times.len() / 2],
        times[0]
    );
}

fn main() {
    let (grid, bev) = sensor_scene::street();
    let rig = SensorRig::default();
    time_ms("cloud of all voxels", || {
        GaussianCloud::from_grid(&grid, &bev).len()
    });
    let clouds = [
        ("all", GaussianCloud::from_grid(&grid, &bev)),
        ("shell of 2", GaussianCloud::from_grid_shell(&grid, &bev, 2)),
    ];
    for (name, cloud) in &clouds {
        for [w, h] in [VIEW_SIZE, PREVIEW_SIZE, [800, 450]] {
            time_ms(&format!("{name}: six cameras {w}x{h}"), || {
                let maps = render_rig(cloud, &rig, w, h, &SplatOptions::default());
                maps.iter()
                    .map(|m| m.semantic.iter().filter(|&&s| s > 0).count())
                    .sum()
            });
        }
    }
}
