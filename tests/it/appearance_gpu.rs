//! Camera pictures of the graphics card against those of the processor, on whatever adapter there is, software included;
//! without any, these tests fail.

use std::collections::HashSet;
use std::sync::{Mutex, MutexGuard, OnceLock};

use scene::appearance::AppearanceData;
use scene::{Background, Camera, Conditions, Frame, SensorRig, TimeOfDay, VoxelGrid, Weather};
use sensors::pictures::appearance::{Appearance, CameraImage, Quality};
use viewport::{AppearanceRenderer, headless_device};
use world::World;
use world::voxelize::{Vertical, complete};

const SIZE: [u32; 2] = [120, 68];

/// One renderer for all tests of this file.
fn gpu() -> MutexGuard<'static, AppearanceRenderer> {
    static RENDERER: OnceLock<Mutex<AppearanceRenderer>> = OnceLock::new();
    let renderer = RENDERER.get_or_init(|| {
        let (info, device, queue) = headless_device().expect("a graphics adapter, software or not");
        println!("{} ({:?}, {:?})", info.name, info.device_type, info.backend);
        Mutex::new(AppearanceRenderer::new(&device, &queue).expect("an adapter that can compute"))
    });
    renderer.lock().unwrap_or_else(|e| e.into_inner())
}

/// A frame of a world without what is known about its scenery, or with it.
fn frame() -> (Frame, Background) {
    let world = World::random(5);
    let grid = complete(&world, Vertical::Occ3d);
    let frame = Frame::new(world.layout.clone(), world.boxes.clone(), grid);
    (frame, world.background)
}

/// Mean absolute difference of the bytes, and the share of pixels of which no channel differs by more than 8.
fn agreement(a: &CameraImage, b: &CameraImage) -> (f64, f64) {
    assert_eq!(
        (a.width, a.height, a.rgba.len()),
        (b.width, b.height, b.rgba.len())
    );
    let (mut sum, mut near) = (0.0, 0usize);
    for (p, q) in a.rgba.chunks_exact(4).zip(b.rgba.chunks_exact(4)) {
        let gaps = [0, 1, 2].map(|c| p[c].abs_diff(q[c]));
        sum += gaps.iter().map(|g| f64::from(*g)).sum::<f64>() / 3.0;
        near += usize::from(gaps.iter().all(|g| *g <= 8));
    }
    let pixels = (a.rgba.len() / 4) as f64;
    (sum / pixels, near as f64 / pixels)
}

/// Where `SCENELOOM_KEEP` names a folder, both pictures are left there to be looked at.
fn keep(name: &str, image: &CameraImage) {
    let Some(folder) = std::env::var_os("SCENELOOM_KEEP") else {
        return;
    };
    let path = std::path::Path::new(&folder).join(format!("{name}.png"));
    let (w, h) = (image.width as u32, image.height as u32);
    image::save_buffer(path, &image.rgba, w, h, image::ColorType::Rgba8).expect("a picture");
}

/// Every time and weather: at most 2/255 apart on average, and 97 % of the pixels within 8/255 in every channel.
#[test]
fn pictures_agree_with_the_processor() {
    let ((frame, background), rig) = (frame(), SensorRig::default());
    assert!(background.len() > 20, "{} things", background.len());
    let mut far = Vec::new();
    let unknown = Background::default();
    let slopes = frame
        .layout
        .relief
        .heights_m()
        .map_or(0.0, |all| all.iter().fold(0.0, |a, h| h.abs().max(a)));
    assert!(slopes > 0.5, "the ground is not level: {slopes} m");
    for (name, time, weather, things) in [
        ("day, things", TimeOfDay::Day, Weather::Clear, &background),
        ("night, things", TimeOfDay::Night, Weather::Clear, &background),
        ("snow, things", TimeOfDay::Day, Weather::Snow, &background),
        ("day", TimeOfDay::Day, Weather::Clear, &unknown),
        ("night", TimeOfDay::Night, Weather::Clear, &unknown),
        ("rain", TimeOfDay::Day, Weather::Rain, &unknown),
        ("night rain", TimeOfDay::Night, Weather::Rain, &unknown),
        ("snow", TimeOfDay::Day, Weather::Snow, &unknown),
        ("fog", TimeOfDay::Day, Weather::Fog, &unknown),
        ("dusk", TimeOfDay::Dusk, Weather::Clear, &unknown),
        ("dawn, overcast", TimeOfDay::Dawn, Weather::Overcast, &unknown),
        ("sandstorm", TimeOfDay::Day, Weather::Sandstorm, &unknown),
    ] {
        let conditions = Conditions::usual(time, weather, 3);
        let appearance = Appearance::with_things(&frame, things, &rig, &conditions);
        let mut gpu = gpu();
        gpu.set_appearance(&appearance.data()).expect("room");
        for camera in [&rig.cameras[0], &rig.cameras[4]] {
            let light = gpu.light(camera, SIZE, true).expect("a picture");
            let here = appearance.picture(camera, SIZE[0], SIZE[1], &light);
            let there = appearance.render(camera, SIZE[0], SIZE[1], Quality::Full);
            let colours: HashSet<&[u8]> = there.rgba.chunks_exact(4).collect();
            assert!(colours.len() > 50, "{name}: there is something to compare");
            let (mean, near) = agreement(&here, &there);
            println!(
                "{name}, {}: mean {mean:.3}/255, within 8/255: {:.2} %",
                camera.name,
                near * 100.0
            );
            keep(&format!("{name} {} gpu", camera.name), &here);
            keep(&format!("{name} {} cpu", camera.name), &there);
            // Written so that NaN counts as far apart.
            if !(mean <= 2.0 && near >= 0.97) {
                far.push(format!("{name}, {}: {mean:.3}, {near:.4}", camera.name));
            }
        }
    }
    assert!(far.is_empty(), "{far:?}");
}

/// An empty scene, no appearance, sizes of nothing, cameras without a place: pictures or errors, and the renderer goes on.
#[test]
fn extremes_are_survived() {
    let rig = SensorRig::default();
    let mut gpu = gpu();
    assert!(
        gpu.set_appearance(&AppearanceData::default()).is_ok(),
        "words may be empty"
    );
    let world = World::random(5);
    let frame = Frame::new(world.layout, Default::default(), VoxelGrid::new());
    let appearance = Appearance::new(&frame, &rig, &Conditions::default());
    gpu.set_appearance(&appearance.data()).expect("room");
    for size in [[0, 0], [0, 5], [1, 1], [7, 3]] {
        let light = gpu.light(&rig.cameras[0], size, true).expect("a picture");
        assert_eq!(light.len(), (size[0] * size[1]) as usize);
        assert!(light.as_flattened().iter().all(|v| v.is_finite() && *v >= 0.0));
    }
    let bad = Camera {
        translation_m: [f64::NAN; 3],
        ..rig.cameras[0].clone()
    };
    let light = gpu.light(&bad, [4, 4], true).expect("a picture");
    assert!(light.as_flattened().iter().all(|v| *v == 0.0));
    assert!(gpu.light(&rig.cameras[0], [1 << 15, 1 << 15], true).is_err());
}
