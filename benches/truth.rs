//! Pictures of the six cameras alone beside the same pictures with the truth about each pixel, in turns in one run.
//! Run: `cargo bench --bench truth`.

use std::time::Instant;

use scene::TimeOfDay;
use sensors::pictures::appearance::{Appearance, Quality};

const SIZE: [u32; 2] = [800, 450];
const TURNS: usize = 7;

fn main() {
    let scene = app::open::bundled().expect("the bundled scene");
    let scene = scene.with_rig_in_world();
    for time in [TimeOfDay::Day, TimeOfDay::Night] {
        let conditions = scene.conditions.at(time);
        let appearance = Appearance::new(scene.frame(), &scene.rig, &conditions);
        let (mut alone, mut told) = (Vec::new(), Vec::new());
        for _ in 0..TURNS {
            let start = Instant::now();
            for camera in &scene.rig.cameras {
                std::hint::black_box(appearance.render(camera, SIZE[0], SIZE[1], Quality::Full));
            }
            alone.push(start.elapsed().as_secs_f64());
            let start = Instant::now();
            for camera in &scene.rig.cameras {
                let boxes = &scene.frame().boxes;
                std::hint::black_box(appearance.render_truth(camera, SIZE, Quality::Full, boxes, None));
            }
            told.push(start.elapsed().as_secs_f64());
        }
        let median = |mut v: Vec<f64>| {
            v.sort_by(f64::total_cmp);
            v[v.len() / 2]
        };
        let (alone, told) = (median(alone), median(told));
        println!(
            "{}: six pictures of {} x {} {alone:.3} s, with truth {told:.3} s, {:+.1} %",
            time.name(),
            SIZE[0],
            SIZE[1],
            100.0 * (told / alone - 1.0)
        );
    }
}
