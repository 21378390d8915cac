//! Pictures a second of the front camera while a clip plays, 480 x 270: for each moment what the program prepares, then the
//! picture. Every box that can drives on. Run: `cargo bench --bench playing [-- SCENE.loom]`, bundled scene without.

use std::time::Instant;

use scene::{Edit, Scene, Template};
use sensors::cameras::{CameraInput, Detail, PreparedSource, RenderContext, RenderOptions, pictures};
use sensors::pictures::appearance::{AppearanceCache, Quality};

const SIZE: [u32; 2] = [480, 270];
const MOMENTS: usize = 40;

fn main() {
    let path = std::env::args().skip(1).find(|a| !a.starts_with('-'));
    let mut scene: Scene = match &path {
        Some(path) => formats::loom::load(path.as_ref()).expect("a scene"),
        None => app::open::bundled().expect("the bundled scene"),
    };
    let length = Edit::SetLength {
        length_s: 8.0,
        rate_hz: Some(10.0),
    };
    editor::apply_all(&[length], &mut scene).expect("a clip");
    let mut moving = 0;
    for id in scene.frame().boxes.keys().copied().collect::<Vec<_>>() {
        let drive = Edit::LetMove {
            id: Some(id),
            template: Template::Drive,
            mps: None,
            from_s: None,
            gap_m: None,
        };
        let mut tried = scene.clone();
        if editor::apply_all(&[drive], &mut tried).is_ok() {
            (scene, moving) = (tried, moving + 1);
        }
    }
    println!(
        "{} things, {} boxes, {moving} of them move",
        scene.background.iter().count(),
        scene.frame().boxes.len()
    );
    let source = &pictures::PictureSource;
    let cache = AppearanceCache::default();
    for quality in [Quality::Play, Quality::Preview, Quality::Full] {
        let (mut moment_s, mut prepare_s, mut draw_s) = (0.0, 0.0, 0.0);
        let options = RenderOptions { size: SIZE, quality };
        for i in 0..MOMENTS {
            let begun = Instant::now();
            scene.show(0.1 * i as f64 + 0.05);
            let placed = scene.with_rig_in_world();
            moment_s += begun.elapsed().as_secs_f64();
            let begun = Instant::now();
            let input = CameraInput {
                cache: Some(&cache),
                ..app::camera_views::camera_input(&placed, Detail::Live)
            };
            let ready = PreparedSource::new(source, &input);
            prepare_s += begun.elapsed().as_secs_f64();
            let begun = Instant::now();
            let camera = &placed.rig.cameras[0];
            std::hint::black_box(
                ready
                    .render(camera, &options, RenderContext::processor())
                    .expect("a picture"),
            );
            draw_s += begun.elapsed().as_secs_f64();
        }
        let ms = |s: f64| 1e3 * s / MOMENTS as f64;
        let all = MOMENTS as f64 / (moment_s + prepare_s + draw_s);
        println!(
            "{quality:?}: moment {:.1} ms, prepare {:.1} ms, picture {:.1} ms: {all:.1} a second",
            ms(moment_s),
            ms(prepare_s),
            ms(draw_s)
        );
    }
}
