//! The viewport drawn for real, on whatever adapter there is (Mesa's software one at least); without
//! any adapter these tests fail.

mod map;
mod parts;
mod pixels;
mod street;

use std::time::Instant;

use numeric::quantile::{median, quantile};
use scene::SensorRig;
use viewport::{
    Background, LayoutPlane, LidarColorMode, LidarView, MarkedVoxels, ViewCamera, ViewOptions, ViewPreset,
    ViewScene, Viewport, headless_device, lidar_colors,
};

/// CPU time of this process so far, all threads, ms: steadier than the clock on a busy machine.
fn cpu_ms() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let fields: Vec<&str> = stat.rsplit(')').next().unwrap_or("").split_whitespace().collect();
    let ticks = |i: usize| fields.get(i).and_then(|f| f.parse::<f64>().ok()).unwrap_or(0.0);
    (ticks(11) + ticks(12)) * 10.0
}

/// Writes pictures of a street into the build folder, for looking at, and checks that none is blank.
#[test]
fn pictures_of_a_street() {
    let (info, device, queue) = headless_device().expect("an adapter");
    println!(
        "adapter: {} ({:?}, {:?})",
        info.name, info.backend, info.device_type
    );
    let street = street::street();
    let rig = SensorRig::default();
    let boxes: Vec<_> = street.boxes.iter().collect();
    let options = ViewOptions::default();
    let colors = lidar_colors(&street.sweep, LidarColorMode::Range);
    let lidar = LidarView {
        sweep: &street.sweep,
        colors: &colors,
    };
    let cells: Vec<[usize; 3]> = (0..36).map(|i| [118 + i % 6, 96 + i / 6, 1]).collect();
    let base = ViewScene {
        grid: &street.grid,
        bev: &street.bev,
        boxes: &[],
        selected: &[],
        hovered: None,
        brush: &[],
        lidar: None,
        rig: &rig,
        options: &options,
    };
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("viewport");
    std::fs::create_dir_all(&folder).expect("a writable build folder");
    let mut viewport = Viewport::new(&device, &queue);
    let size = [1200, 700];
    let start = ViewCamera::default();
    let mut near = start;
    near.focus(glam::DVec3::new(13.0, 0.0, 0.0), 9.0);
    let top = ViewCamera::preset(ViewPreset::Top);
    let all = ViewScene {
        boxes: &boxes,
        selected: &[street.boxes[0].id],
        hovered: Some(street.boxes[8].id),
        lidar: Some(lidar),
        brush: &[MarkedVoxels {
            voxels: &cells,
            color: [120, 220, 255],
        }],
        ..base
    };
    let only_boxes = ViewScene {
        lidar: None,
        brush: &[],
        ..all
    };
    let frusta = ViewOptions {
        frusta: true,
        ..options.clone()
    };
    let plane = ViewOptions {
        voxels: false,
        layout_plane: LayoutPlane::Always,
        ..options.clone()
    };
    let light = ViewOptions {
        background: Background::LIGHT,
        ..options.clone()
    };
    let bare = ViewOptions {
        background: Background::Transparent,
        ..options.clone()
    };
    let clip = ViewOptions {
        clip_above_m: Some(1.2),
        ..options.clone()
    };
    fn under<'a>(scene: ViewScene<'a>, options: &'a ViewOptions) -> ViewScene<'a> {
        ViewScene { options, ..scene }
    }
    let ego = ViewCamera::preset(ViewPreset::Ego);
    let mut ego_near = start;
    ego_near.focus(glam::DVec3::new(1.2, 0.0, 0.0), 3.2);
    for (name, camera, scene) in [
        ("perspective", start, base),
        ("boxes", start, only_boxes),
        ("all", start, all),
        ("near", near, all),
        ("top", top, only_boxes),
        ("side", ViewCamera::preset(ViewPreset::Side), base),
        ("front", ViewCamera::preset(ViewPreset::Front), base),
        ("ego", ego, only_boxes),
        ("frusta", ego_near, under(only_boxes, &frusta)),
        ("plane", start, under(only_boxes, &plane)),
        ("light", start, under(only_boxes, &light)),
        ("transparent", start, under(only_boxes, &bare)),
        ("clip", start, under(only_boxes, &clip)),
    ] {
        let picture = viewport
            .render_to_image(&device, &queue, &camera, &scene, size, 1)
            .expect("a picture");
        let colors: std::collections::HashSet<&[u8]> = picture.chunks_exact(4).collect();
        assert!(
            colors.len() > 500,
            "{name} is nearly blank: {} colours",
            colors.len()
        );
        let image: image::RgbaImage =
            image::ImageBuffer::from_raw(size[0], size[1], picture).expect("the right length");
        image.save(folder.join(format!("{name}.png"))).expect("written");
    }
    println!(
        "pictures in {}; {} rectangles",
        folder.display(),
        viewport.voxel_quads()
    );
    costs(&device, &queue, &mut viewport, [base, all], size);
}

/// Prints what pictures of a street cost, first the voxels alone, then everything.
fn costs(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    viewport: &mut Viewport,
    [base, all]: [ViewScene<'_>; 2],
    size: [u32; 2],
) {
    let (start, options) = (ViewCamera::default(), all.options);
    let wait = || device.poll(wgpu::PollType::wait_indefinitely()).expect("drawn");
    for (name, scene) in [("voxels", &base), ("all", &all)] {
        for samples in [1, 4] {
            let options = ViewOptions {
                samples,
                ..options.clone()
            };
            let scene = ViewScene {
                options: &options,
                ..*scene
            };
            let mut camera = start;
            let cpu = cpu_ms();
            let times: Vec<f64> = (0..6)
                .map(|_| {
                    camera.orbit(0.01, 0.0);
                    let begin = Instant::now();
                    assert!(viewport.render(device, queue, &camera, &scene, size[0], size[1]));
                    wait();
                    begin.elapsed().as_secs_f64() * 1e3
                })
                .collect();
            let cpu = (cpu_ms() - cpu) / times.len() as f64;
            println!(
                "{name}, {samples} samples: median {:.0} ms, best {:.0} ms, {cpu:.0} ms of CPU",
                median(&times),
                quantile(&times, 0.0)
            );
        }
    }
    let mut grid = all.grid.clone();
    let mut camera = start;
    let mut times = [0.0; 6];
    for (i, time) in times.iter_mut().enumerate() {
        camera.orbit(0.01, 0.0);
        grid.set(100 + i, 90, 3, 4);
        let begin = Instant::now();
        assert!(viewport.render(
            device,
            queue,
            &start,
            &ViewScene { grid: &grid, ..all },
            size[0],
            size[1]
        ));
        *time = begin.elapsed().as_secs_f64() * 1e3;
        wait();
    }
    println!("CPU side of one edited voxel: {times:.1?} ms");
    let begin = Instant::now();
    let mut fresh = Viewport::new(device, queue);
    let made = begin.elapsed().as_secs_f64() * 1e3;
    fresh.render(device, queue, &start, &all, size[0], size[1]);
    println!(
        "new viewport {made:.0} ms, first upload and pipelines {:.0} ms",
        begin.elapsed().as_secs_f64() * 1e3 - made
    );
    wait();
}
