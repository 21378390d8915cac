//! Time of a picture of the 3D view of the bundled scene, by what is in it: on the graphics adapter there is, which is
//! the processor where a software one is. Run: `cargo bench --bench view`.

use std::path::Path;

use editor::{Document, Edit};
use formats::loom;
use scene::{Class, LidarSweep, Scene, SceneBox};
use sensors::lidar::caster::Caster;
use viewport::{
    LayoutPlane, LidarColorMode, LidarView, ViewCamera, ViewOptions, ViewScene, Viewport, headless_device,
    lidar_colors,
};

#[path = "timing.rs"]
mod timing;

/// The pane in a window of 1600 x 950 pixels.
const PANE: [u32; 2] = [880, 520];

fn main() {
    let (info, device, queue) = match headless_device() {
        Ok(device) => device,
        Err(e) => return println!("{e}"),
    };
    println!("{} ({:?}, {:?})", info.name, info.device_type, info.backend);
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/scenes/first_light.loom");
    let scene = loom::load(&path).expect("the bundled scene");
    let frame = scene.frame();
    let sweep: LidarSweep = scene
        .rig
        .lidars
        .first()
        .map(|pattern| Caster::new(&frame.occupancy, pattern, glam::DVec3::ZERO, None).sweep())
        .unwrap_or_default();
    let colors = lidar_colors(&sweep, LidarColorMode::Range);
    let boxes: Vec<&SceneBox> = frame.boxes.values().collect();
    let mut viewport = Viewport::new(&device, &queue);
    let mut camera = ViewCamera::default();
    let mut draw = |what: &str, options: ViewOptions, [w, h]: [u32; 2]| {
        timing::time(&format!("{what}, {w}x{h}"), 15, || {
            camera.orbit(1e-5, 0.0);
            let view = ViewScene {
                grid: &frame.occupancy,
                bev: frame.layout.cells(),
                boxes: &boxes,
                selected: &[],
                hovered: None,
                brush: &[],
                lidar: Some(LidarView {
                    sweep: &sweep,
                    colors: &colors,
                }),
                rig: &scene.rig,
                options: &options,
            };
            viewport.render(&device, &queue, &camera, &view, w, h);
            device
                .poll(wgpu::PollType::wait_indefinitely())
                .expect("the device answers");
            1
        });
    };
    let all = ViewOptions {
        samples: 1,
        ..ViewOptions::default()
    };
    let nothing = ViewOptions {
        voxels: false,
        layout_plane: LayoutPlane::Off,
        boxes: false,
        lidar: false,
        ego: false,
        grid_lines: false,
        ..all.clone()
    };
    let half = PANE.map(|s| s / 2);
    for size in [PANE, half] {
        draw("all", all.clone(), size);
        draw("background", nothing.clone(), size);
        let voxels = ViewOptions {
            voxels: true,
            ..nothing.clone()
        };
        draw("voxels", voxels.clone(), size);
        let plain = ViewOptions {
            voxel_edges: false,
            shadows: false,
            markings: false,
            ..voxels
        };
        draw("voxels without lines, shadows, markings", plain, size);
        let without = |change: fn(&mut ViewOptions)| {
            let mut options = all.clone();
            change(&mut options);
            options
        };
        draw("all but the returns", without(|o| o.lidar = false), size);
        draw("all but boxes", without(|o| o.boxes = false), size);
        draw("all but the ego vehicle", without(|o| o.ego = false), size);
        draw("all but grid lines", without(|o| o.grid_lines = false), size);
        draw(
            "all but the layout",
            without(|o| o.layout_plane = LayoutPlane::Off),
            size,
        );
    }
    let smooth = ViewOptions {
        samples: 4,
        ..all.clone()
    };
    draw("all, four samples a pixel", smooth, PANE);

    nudged(
        &scene,
        (&sweep, &colors),
        &all,
        (&device, &queue),
        &mut viewport,
        &camera,
    );
}

/// A car that is nudged to and fro: only what that touches is drawn again.
fn nudged(
    scene: &Scene,
    (sweep, colors): (&LidarSweep, &[[u8; 4]]),
    all: &ViewOptions,
    (device, queue): (&wgpu::Device, &wgpu::Queue),
    viewport: &mut Viewport,
    camera: &ViewCamera,
) {
    let car = scene
        .frame()
        .boxes
        .values()
        .find(|b| b.class == Class::Car)
        .copied()
        .expect("a car");
    let moved = |along_m: f64| {
        let mut document = Document::new(Scene::clone(scene));
        let edit = Edit::MoveBox {
            id: car.id,
            center_m: Some(car.center_m + glam::DVec3::X * along_m),
            yaw_deg: None,
            size_m: None,
        };
        document.apply("Move", &edit).expect("an edit");
        document.scene().clone()
    };
    let places = [moved(0.2), moved(0.6)];
    let mut turn = 0;
    timing::time(
        &format!("after a car was nudged, {}x{}", PANE[0], PANE[1]),
        15,
        || {
            turn += 1;
            let frame = places[turn % 2].frame();
            let boxes: Vec<&SceneBox> = frame.boxes.values().collect();
            let view = ViewScene {
                grid: &frame.occupancy,
                bev: frame.layout.cells(),
                boxes: &boxes,
                selected: &[car.id],
                hovered: None,
                brush: &[],
                lidar: Some(LidarView { sweep, colors }),
                rig: &scene.rig,
                options: all,
            };
            viewport.render(device, queue, camera, &view, PANE[0], PANE[1]);
            device
                .poll(wgpu::PollType::wait_indefinitely())
                .expect("the device answers");
            1
        },
    );
    let [_, _, w, h] = viewport.drawn_rect();
    println!("of {} pixels {} were drawn", PANE[0] * PANE[1], w * h);
}
