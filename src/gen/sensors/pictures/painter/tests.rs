//! Edits change only what they touch; what was painted is found again; odd rigs are painted or refused in one line.

use std::sync::LazyLock;

use super::*;
use mask::RIM_PX;
use scene::{BoxId, Camera, Conditions, Frame, Lens, Pose, SensorRig, TimeOfDay, Weather};
use world::World;
use world::voxelize::{Vertical, complete};

fn frame(world: &World) -> Frame {
    Frame::new(
        world.layout.clone(),
        world.boxes.clone(),
        complete(world, Vertical::Occ3d),
    )
}

fn painter() -> Painter {
    let nets = PictureNets::bundled().expect("the shipped weights");
    let options = PaintOptions {
        steps: 2,
        ..PaintOptions::default()
    };
    Painter::new(nets, options)
}

pub(super) fn input<'a>(frame: &'a Frame, rig: &'a SensorRig) -> PaintInput<'a> {
    static NOTHING: LazyLock<Background> = LazyLock::new(Background::default);
    PaintInput {
        frame,
        rig,
        background: &NOTHING,
        conditions: Conditions::usual(TimeOfDay::Day, Weather::Clear, 3),
    }
}

fn go_on(_: PaintProgress<'_>) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// A world, the same without one of its cars that a camera sees, and that car.
pub(super) fn with_and_without_a_car() -> (Frame, Frame, BoxId) {
    let mut world = World::random(3);
    let with = frame(&world);
    let near = |b: &&scene::SceneBox| {
        let away_m = b.center_m.truncate().length();
        b.class == scene::Class::Car && (6.0..25.0).contains(&away_m)
    };
    let id = world.boxes.values().find(near).expect("a car near by").id;
    world.boxes.remove(&id);
    (with, frame(&world), id)
}

#[test]
fn an_edit_changes_what_it_touches_and_nothing_else() {
    let (with, without, id) = with_and_without_a_car();
    let rig = SensorRig::default();
    let (before, after) = (input(&with, &rig), input(&without, &rig));
    let mut painter = painter();
    let old = painter.paint(&before, go_on).expect("pictures");
    let mut news = Vec::new();
    let new = painter.paint(&after, |progress| {
        news.push((progress.step, progress.news.map(|(camera, _)| camera)));
        ControlFlow::Continue(())
    });
    let new = new.expect("pictures");

    let ring = Ring::of(&rig.cameras).expect("a ring").expect("cameras");
    let (then, now) = (
        RingFrame::from_input(&before, &ring),
        RingFrame::from_input(&after, &ring),
    );
    let changed = mask::changed(&then, &now, ring.size);
    let [_, width] = ring.size.pixels();
    let (mut painted, mut touched_views) = (0, 0);
    for (view, changed) in changed.iter().enumerate() {
        let camera = ring.camera(view);
        let (old, new) = (&old[camera], &new[camera]);
        assert_eq!(old.camera, rig.cameras[camera].name);
        let touched = changed.contains(&true);
        touched_views += usize::from(touched);
        // A view without changes is the very same picture.
        assert_eq!(touched, !Arc::ptr_eq(old, new), "{}", old.camera);
        let near = |at: usize| {
            let (x, y) = ((at % width) as i64, (at / width) as i64);
            let mut all = changed.iter().enumerate().filter(|(_, c)| **c);
            all.any(|(i, _)| {
                let (u, v) = ((i % width) as i64, (i / width) as i64);
                (u - x).abs().max((v - y).abs()) < RIM_PX as i64
            })
        };
        let pixels = old.rgba.chunks_exact(4).zip(new.rgba.chunks_exact(4)).enumerate();
        for (at, _) in pixels.filter(|(_, (a, b))| a != b) {
            painted += 1;
            assert!(near(at), "pixel {at} of {} changed", old.camera);
        }
    }
    let all = ring.size.views() * changed[0].len();
    assert!(
        painted > 50 && painted < all / 3,
        "{painted} of {all} pixels painted"
    );
    assert!(
        (1..6).contains(&touched_views),
        "box {id:?} is in {touched_views} views"
    );
    // That it begins; then news of a camera that is touched, with every step, and once more when the picture is there.
    assert_eq!(
        news.iter().map(|(step, _)| *step).collect::<Vec<_>>(),
        [0, 1, 2, 2]
    );
    assert!(news[0].1.is_none() && news[1].1.is_some() && news[3].1 == news[1].1);

    // Undone, the pictures are those of before; they were kept.
    let again = painter
        .paint(&before, |_| panic!("painted again"))
        .expect("pictures");
    assert!(again.iter().zip(&old).all(|(a, b)| Arc::ptr_eq(a, b)));
    // Another painter makes the same ones.
    let other = self::painter()
        .without_previews()
        .paint(&before, |progress| {
            // The last piece of news is a picture itself.
            assert!(progress.news.is_none() || progress.step == progress.steps);
            ControlFlow::Continue(())
        })
        .expect("pictures");
    assert!(other.iter().zip(&old).all(|(a, b)| a == b));
}

#[test]
fn a_stopped_painting_leaves_nothing_behind() {
    let frame = frame(&World::random(3));
    let rig = SensorRig::default();
    let input = input(&frame, &rig);
    let mut painter = painter();
    let stopped = painter.paint(&input, |_| ControlFlow::Break(()));
    assert_eq!(stopped, Err(PaintError::Stopped));
    assert!(painter.kept.is_empty());
    assert_eq!(painter.paint(&input, go_on).expect("pictures").len(), 6);
}

/// Other light, or another place far away, is another picture; a step ahead goes on from the last one.
#[test]
fn a_drive_goes_on_from_the_frame_before() {
    let frame = frame(&World::random(3));
    let rig = SensorRig::default();
    let here = input(&frame, &rig);
    let ring = Ring::of(&rig.cameras).expect("a ring").expect("cameras");
    let seen = |input: &PaintInput<'_>| RingFrame::from_input(input, &ring);
    let then = seen(&here);
    let moved = |ahead_m: f64, turn_rad: f64| rig.standing_at(&Pose::planar(ahead_m, 0.0, turn_rad));
    let known = |ahead_m: f64, turn_rad: f64| {
        let rig = moved(ahead_m, turn_rad);
        seen(&input(&frame, &rig))
            .motion_since(&then, ring.size)
            .is_some()
    };
    assert!(known(1.0, 0.1) && !known(9.0, 0.0) && !known(0.5, 1.0));
    let rig_ahead = moved(1.0, 0.0);
    let ahead = input(&frame, &rig_ahead);
    let motions = seen(&ahead).motion_since(&then, ring.size).expect("near");
    // What is 10 m before the front camera now was 11 m before it then.
    let front = (0..6).find(|view| rig.cameras[ring.camera(*view)].name == "CAM_FRONT");
    let [_, _, z] = motions[front.expect("a front camera")].then_from_now;
    assert!((z[2] * 10.0 + z[3] - 11.0).abs() < 0.01, "{z:?}");
    let night = PaintInput {
        conditions: Conditions::usual(TimeOfDay::Night, Weather::Clear, 3),
        ..ahead
    };
    assert!(seen(&night).motion_since(&then, ring.size).is_none());

    let mut painter = painter();
    let first = painter.paint(&here, go_on).expect("pictures");
    let next = painter.paint(&ahead, go_on).expect("pictures");
    let alone = self::painter().paint(&ahead, go_on).expect("pictures");
    assert!(next != alone && next != first);
    let dark = painter.paint(&night, go_on).expect("pictures");
    let light = |images: &[Arc<CameraImage>]| {
        let bytes = images.iter().flat_map(|i| &i.rgba);
        bytes.map(|b| u64::from(*b)).sum::<u64>()
    };
    assert!(light(&dark) < light(&next) * 9 / 10, "night is dark");
}

#[test]
fn odd_rigs_are_painted_or_refused() {
    let frame = frame(&World::random(3));
    let paint = |cameras: Vec<Camera>| {
        let rig = SensorRig {
            cameras,
            ..SensorRig::default()
        };
        painter().paint(&input(&frame, &rig), go_on)
    };
    assert_eq!(paint(Vec::new()), Ok(Vec::new()));
    let mut tall = Camera::new("TALL", 40.0);
    (tall.width, tall.height) = (100, 1600);
    let mut fish = Camera::new("FISH", 150.0);
    fish.lens = Lens::Fisheye {
        k: [0.0; 4],
        max_angle_deg: 100.0,
    };
    for camera in [tall, fish] {
        let images = paint(vec![camera]).expect("a picture");
        assert_eq!(images[0].rgba.len(), images[0].width * images[0].height * 4);
    }
    let many = (0..65).map(|i| Camera::new(&format!("C{i}"), 60.0)).collect();
    let error = paint(many).expect_err("too many").to_string();
    assert_eq!(
        error,
        "picture networks: number of cameras is 65, expected 1 to 64"
    );
}

#[test]
fn the_ring_runs_clockwise_and_begins_in_front() {
    // Wherever the vehicle heads: a camera keeps its view of the ring while it turns.
    for yaw_rad in [0.0, 0.003, 1.5, 3.0, -3.0, -0.003] {
        let rig = SensorRig::default().standing_at(&Pose::planar(20.0, -5.0, yaw_rad));
        let ring = Ring::of(&rig.cameras).expect("a ring").expect("cameras");
        assert_eq!(ring.size.pixels(), [144, 256]);
        let names = ring
            .views()
            .into_iter()
            .map(|view| &rig.cameras[ring.camera(view)].name[4..]);
        assert_eq!(
            names.collect::<Vec<_>>(),
            [
                "FRONT",
                "FRONT_RIGHT",
                "BACK_RIGHT",
                "BACK",
                "BACK_LEFT",
                "FRONT_LEFT"
            ],
            "{yaw_rad}"
        );
    }
}

#[test]
fn new_paint_fades_out() {
    const SIDE: usize = 31;
    let mut changed = vec![false; SIDE * SIDE];
    let middle = 15 * SIDE + 15;
    changed[middle] = true;
    let shares = mask::shares(&changed, SIDE);
    assert_eq!(shares[middle..middle + 7], [1.0; 7]);
    assert_eq!(shares[middle + 7..middle + 12], [0.75, 0.5, 0.25, 0.0, 0.0]);
    assert_eq!(shares[middle + 9 + 9 * SIDE], 0.25);
    let mut new = vec![200; SIDE * SIDE * 4];
    mask::blend(&vec![100; SIDE * SIDE * 4], &mut new, &shares);
    assert_eq!([middle, middle + 8, 0].map(|at| new[at * 4]), [200, 150, 100]);
}

/// Seconds of a painting: run with `--ignored --nocapture`.
#[test]
#[ignore = "takes seconds; prints times"]
fn seconds_of_a_painting() {
    let (with, without, _) = with_and_without_a_car();
    let rig = SensorRig::default();
    let ring = Ring::of(&rig.cameras).expect("a ring").expect("cameras");
    let nets = PictureNets::bundled().expect("the shipped weights");
    for _ in 0..3 {
        let timed = |what: &str, start: std::time::Instant| {
            println!("{what}: {:.2} s", start.elapsed().as_secs_f64());
            std::time::Instant::now()
        };
        let start = std::time::Instant::now();
        drop(RingFrame::from_input(&input(&with, &rig), &ring));
        let start = timed("look", start);
        let mut painter = Painter::new(nets.clone(), PaintOptions::default());
        painter.paint(&input(&with, &rig), go_on).expect("pictures");
        let start = timed("look and paint all", start);
        painter.paint(&input(&without, &rig), go_on).expect("pictures");
        timed("look and paint an edit", start);
    }
}

/// Noise that belongs to surfaces is that of another place in the next frame, and unlike noise of its own each time where surfaces are
/// found again; what is told the frame before differs from what is not.
#[test]
fn noise_goes_along_with_surfaces() {
    let world = World::random(3);
    let frame = frame(&world);
    let [here, ahead] = [0.0, 1.0].map(|x| SensorRig::default().standing_at(&Pose::planar(x, 0.0, 0.0)));
    let run = |noise, hears_before| {
        let options = PaintOptions {
            noise,
            hears_before,
            steps: 1,
            ..PaintOptions::default()
        };
        let mut painter = Painter::new(PictureNets::bundled().expect("the shipped weights"), options);
        let go_on = |_: PaintProgress<'_>| ControlFlow::Continue(());
        let last = [&here, &ahead].map(|rig| painter.paint(&input(&frame, rig), go_on).expect("painted"));
        let noise: Vec<Vec<f32>> = painter.kept.iter().map(|p| p.noise.clone()).collect();
        (noise, last)
    };
    let same = |noise: &[Vec<f32>]| {
        let cells = noise[0].as_chunks::<8>().0;
        let known: std::collections::BTreeSet<[u32; 8]> = cells.iter().map(|c| c.map(f32::to_bits)).collect();
        let then = noise[1].as_chunks::<8>().0.iter().map(|c| c.map(f32::to_bits));
        then.filter(|c| known.contains(c)).count() as f64 / cells.len() as f64
    };
    let (places, painted) = run(NoisePrior::Places, true);
    assert_eq!(places[0], places[1]);
    let (frames, _) = run(NoisePrior::Frames, true);
    assert!(frames[0] == places[0] && same(&frames) == 0.0);
    let (surfaces, _) = run(NoisePrior::Surfaces, true);
    let share = same(&surfaces);
    assert!(
        surfaces[0] != surfaces[1] && (0.4..0.99).contains(&share),
        "{share}"
    );
    let mean = surfaces[1].iter().map(|v| f64::from(*v)).sum::<f64>() / surfaces[1].len() as f64;
    let square = surfaces[1].iter().map(|v| f64::from(v * v)).sum::<f64>() / surfaces[1].len() as f64;
    assert!(
        mean.abs() < 0.05 && (square - 1.0).abs() < 0.05,
        "{mean} {square}"
    );
    let (_, silent) = run(NoisePrior::Places, false);
    assert!(silent[0][0].rgba == painted[0][0].rgba && silent[1][0].rgba != painted[1][0].rgba);
}
