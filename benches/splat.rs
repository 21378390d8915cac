//! Time of the camera maps of a street of some 60,000 voxels: six cameras, shown, preview and issue
//! size; on the processor, and on the graphics adapter there is (a software one is slow).
//! Run: `cargo bench --bench splat`.

use scene::SensorRig;
use sensors::splat::cloud::GaussianCloud;
use sensors::splat::{PREVIEW_SIZE, SplatOptions, VIEW_SIZE, render_rig};
use viewport::{SplatRenderer, headless_device};

#[path = "../tests/it/sensor_scene/mod.rs"]
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
    let (info, device, queue) = match headless_device() {
        Ok(device) => device,
        Err(e) => return println!("{e}"),
    };
    println!("{} ({:?}, {:?})", info.name, info.device_type, info.backend);
    let mut gpu = match SplatRenderer::new(&device, &queue) {
        Ok(gpu) => gpu,
        Err(e) => return println!("{e}"),
    };
    let repeats = if info.device_type == wgpu::DeviceType::Cpu {
        3
    } else {
        101
    };
    for (name, cloud) in &clouds {
        timing::time(&format!("{name}: upload"), repeats, || {
            gpu.set_cloud(cloud.gaussians()).expect("room");
            cloud.len()
        });
        for size in [VIEW_SIZE, [800, 450]] {
            let [w, h] = size;
            let options = SplatOptions::default();
            timing::time(
                &format!("{name}: six cameras {w}x{h}, left there"),
                repeats,
                || {
                    gpu.draw(&rig.cameras, size, &options).expect("drawn");
                    rig.cameras.len()
                },
            );
            timing::time(
                &format!("{name}: six cameras {w}x{h}, read back"),
                repeats,
                || {
                    let maps = gpu.render_rig(&rig, size, &options).expect("maps");
                    maps.iter()
                        .map(|m| m.semantic.iter().filter(|&&s| s > 0).count())
                        .sum()
                },
            );
        }
    }
}
