//! Tests of the sensing thread: it senses the newest scene, and goes on after a panic.

use std::time::Instant;

use super::*;
use scene::{Frame, draft};
use sensors::cameras;
use world::World;

#[test]
fn the_newest_scene_is_sensed_in_the_end() {
    let world = World::random(3);
    let occupancy = draft::draft(&world.layout, world.boxes.values());
    let frame = Frame::new(world.layout.clone(), world.boxes.clone(), occupancy);
    let mut scene = Scene::single("test", frame, Arc::default(), 3);
    let mut sensing = Sensing::spawn(Duration::ZERO, || {}).expect("a thread");
    for _ in 0..20 {
        scene.rev = SceneRev::fresh();
        sensing.ask(&Arc::new(scene.clone()), Wanted::default(), Haste::Preview);
    }
    let start = Instant::now();
    while sensing.cameras_stale(scene.rev) || sensing.lidar_stale(scene.rev) {
        assert!(start.elapsed() < Duration::from_secs(120), "no news");
        std::thread::sleep(Duration::from_millis(5));
        sensing.drain();
    }
    assert_eq!(sensing.cameras().map(|c| c.len()), Some(6));
    assert!(sensing.lidar().is_some_and(|l| l.points.len() > 1000));
    // The same request again brings no news.
    let version = sensing.version();
    sensing.ask(&Arc::new(scene.clone()), Wanted::default(), Haste::Preview);
    std::thread::sleep(Duration::from_millis(50));
    sensing.drain();
    assert_eq!(sensing.version(), version);
    // Pictures of another source of the same scene are news; hidden cameras are not rendered.
    for source in cameras::all() {
        let wanted = Wanted {
            source: source.id(),
            hidden: 0b101,
            ..Wanted::default()
        };
        // No picture is painted while the user drags.
        let haste = match source.id() {
            learned::ID => Haste::Rest,
            _ => Haste::Preview,
        };
        sensing.ask(&Arc::new(scene.clone()), wanted, haste);
        assert!(sensing.cameras_stale(scene.rev));
        while sensing.cameras_stale(scene.rev) {
            assert!(
                start.elapsed() < Duration::from_secs(120),
                "no news of {}",
                source.about().title
            );
            std::thread::sleep(Duration::from_millis(5));
            sensing.drain();
        }
        let views = sensing.cameras().expect("pictures");
        assert_eq!(views.iter().map(|v| v.camera).collect::<Vec<_>>(), [1, 3, 4, 5]);
        for (of_camera, view) in views
            .iter()
            .flat_map(|v| source.views().iter().map(move |s| (v, s)))
        {
            let ([w, h], rgba) = of_camera.picture.rgba(view.id, 12.0);
            assert_eq!(rgba.len(), w * h * 4);
            assert!(
                rgba.chunks(4).any(|c| c != &rgba[..4]),
                "{}: all of one colour",
                view.title
            );
        }
    }
}

#[test]
fn a_panic_is_told_once_and_the_next_scene_is_sensed() {
    let world = World::random(3);
    let occupancy = draft::draft(&world.layout, world.boxes.values());
    let frame = Frame::new(world.layout.clone(), world.boxes.clone(), occupancy);
    let mut scene = Scene::single("test", frame, Arc::default(), 3);
    let mut sensing = Sensing::spawn(Duration::ZERO, || {}).expect("a thread");
    let patience = |start: Instant| assert!(start.elapsed() < Duration::from_secs(120), "no news");
    runtime::guard::panic_next("sensing");
    sensing.ask(&Arc::new(scene.clone()), Wanted::default(), Haste::Preview);
    let start = Instant::now();
    let problem = loop {
        patience(start);
        sensing.drain();
        if let Some(problem) = sensing.take_problem() {
            break problem;
        }
        std::thread::sleep(Duration::from_millis(5));
    };
    assert_eq!(
        problem,
        "The sensors show an older scene: sensing panicked: asked for by a test"
    );
    assert_eq!((sensing.take_problem(), sensing.version()), (None, 0));
    scene.rev = SceneRev::fresh();
    sensing.ask(&Arc::new(scene.clone()), Wanted::default(), Haste::Preview);
    while sensing.cameras_stale(scene.rev) || sensing.lidar_stale(scene.rev) {
        patience(start);
        std::thread::sleep(Duration::from_millis(5));
        sensing.drain();
    }
    assert_eq!(sensing.take_problem(), None);
}

/// Painted pictures come step by step. A stopped painting is reported, and goes on when requested.
#[test]
fn a_painting_is_told_step_by_step_and_can_be_stopped() {
    let world = World::random(3);
    let occupancy = draft::draft(&world.layout, world.boxes.values());
    let frame = Frame::new(world.layout.clone(), world.boxes.clone(), occupancy);
    let scene = Arc::new(Scene::single("test", frame, Arc::default(), 3));
    let mut sensing = Sensing::spawn(Duration::ZERO, || {}).expect("a thread");
    sensing.paint_with(&PaintWish {
        steps: Some(30),
        ..PaintWish::default()
    });
    let wanted = Wanted {
        source: learned::ID,
        ..Wanted::default()
    };
    let wait = |sensing: &mut Sensing, until: &dyn Fn(&Sensing) -> bool| {
        let start = Instant::now();
        while !until(sensing) {
            assert!(start.elapsed() < Duration::from_secs(120), "no news");
            sensing.ask(&scene, wanted, Haste::Rest);
            std::thread::sleep(Duration::from_millis(2));
            sensing.drain();
        }
    };
    wait(
        &mut sensing,
        &|s| matches!(s.paint_stage(), Some(PaintStage::Step(step, 30)) if step >= 1),
    );
    assert!(sensing.cameras_stale(scene.rev));
    sensing.stop_painting();
    wait(&mut sensing, &|s| s.is_stopped());
    assert!(sensing.paint_stage().is_none() && sensing.cameras_stale(scene.rev));
    // With fewer steps set, it paints again to the end.
    sensing.paint_with(&PaintWish {
        steps: Some(1),
        ..PaintWish::default()
    });
    wait(&mut sensing, &|s| !s.cameras_stale(scene.rev));
    assert_eq!(sensing.cameras().map(|c| c.len()), Some(6));
    assert!(!sensing.is_stopped());
    // A folder without weights gives an error in one line.
    sensing.paint_with(&PaintWish {
        weights: Some("nowhere".into()),
        ..PaintWish::default()
    });
    sensing.ask(&scene, wanted, Haste::Rest);
    // Pictures painted with other weights are stale.
    assert!(sensing.cameras_stale(scene.rev));
    wait(&mut sensing, &|s| s.is_stopped());
    assert!(sensing.cameras_stale(scene.rev));
    let problem = sensing.take_problem().expect("a problem");
    assert!(
        problem.starts_with("No learned pictures: nowhere") && problem.lines().count() == 1,
        "{problem}"
    );
}

/// The scene as a clip of 2 s.
fn clip_of(mut scene: Scene) -> Scene {
    let length = scene::Edit::SetLength {
        length_s: 2.0,
        rate_hz: Some(10.0),
    };
    editor::apply_all(&[length], &mut scene).expect("a clip");
    scene
}

#[test]
fn while_a_clip_plays_all_cameras_come_in_turns_and_none_of_another_scene() {
    let scene_of = |seed| {
        let world = World::random(seed);
        let occupancy = draft::draft(&world.layout, world.boxes.values());
        let frame = Frame::new(world.layout.clone(), world.boxes.clone(), occupancy);
        clip_of(Scene::single("test", frame, Arc::default(), seed))
    };
    let (first, second) = (scene_of(3), scene_of(4));
    let mut sensing = Sensing::spawn(Duration::ZERO, || {}).expect("a thread");
    let start = Instant::now();
    let sense = |sensing: &mut Sensing, scene: &Scene| {
        sensing.ask(
            &Arc::new(scene.clone()),
            Wanted::default(),
            Haste::Play { every_ms: 100 },
        );
        while !sensing.is_idle() {
            assert!(start.elapsed() < Duration::from_secs(120), "no news");
            std::thread::sleep(Duration::from_millis(2));
            sensing.drain();
        }
        sensing.cameras().expect("pictures").clone()
    };
    // After as many moments as there are cameras all were shown.
    let mut shown = sense(&mut sensing, &first);
    for i in 1..=6 {
        shown = sense(&mut sensing, &first.at(0.1 * f64::from(i)));
    }
    let cameras: Vec<usize> = shown.iter().map(|v| v.camera).collect();
    assert_eq!(cameras, [0, 1, 2, 3, 4, 5]);
    let others = sense(&mut sensing, &second);
    let from_before = |view: &CameraView| shown.iter().any(|v| Arc::ptr_eq(&v.picture, &view.picture));
    assert!(!others.is_empty() && !others.iter().any(from_before));
}

/// What was drawn of a moment is shown again when the clip comes back to it, and at no other moment.
#[test]
fn a_clip_that_plays_again_shows_the_pictures_and_sweeps_of_before() {
    let world = World::random(3);
    let occupancy = draft::draft(&world.layout, world.boxes.values());
    let frame = Frame::new(world.layout.clone(), world.boxes.clone(), occupancy);
    let scene = clip_of(Scene::single("test", frame, Arc::default(), 3));
    let mut sensing = Sensing::spawn(Duration::ZERO, || {}).expect("a thread");
    let wanted = Wanted {
        source: cameras::pictures::ID,
        large: Some((cameras::pictures::ID, 2)),
        ..Wanted::default()
    };
    let start = Instant::now();
    let mut sense = |time_s: f64, haste: Haste| {
        sensing.ask(&Arc::new(scene.at(time_s)), wanted, haste);
        while !sensing.is_idle() {
            assert!(start.elapsed() < Duration::from_secs(120), "no news");
            std::thread::sleep(Duration::from_millis(2));
            sensing.drain();
        }
        let views = sensing.cameras().expect("pictures").clone();
        let large = views
            .iter()
            .find(|v| v.camera == 2)
            .expect("the large one")
            .clone();
        (large, sensing.lidar().expect("a sweep").clone())
    };
    let plays = Haste::Play { every_ms: 100 };
    let (first, swept) = sense(0.52, plays);
    assert!(first.is_wide(playing::PLAYING_SIZE[0]));
    let (later, _) = sense(0.61, plays);
    assert!(!Arc::ptr_eq(&first.picture, &later.picture));
    let (again, swept_again) = sense(0.48, plays);
    assert!(Arc::ptr_eq(&first.picture, &again.picture) && Arc::ptr_eq(&swept, &swept_again));
    // At rest the pictures are full ones.
    let (rest, _) = sense(0.5, Haste::Rest);
    assert!(!Arc::ptr_eq(&first.picture, &rest.picture));
}

/// Sweeps that are shown again take none of the time for new ones, or the gaps between them would stay.
#[test]
fn sweeps_between_those_of_before_are_made_the_next_time_round() {
    let world = World::random(3);
    let occupancy = draft::draft(&world.layout, world.boxes.values());
    let frame = Frame::new(world.layout.clone(), world.boxes.clone(), occupancy);
    let scene = clip_of(Scene::single("test", frame, Arc::default(), 3));
    let mut sensing = Sensing::spawn(Duration::ZERO, || {}).expect("a thread");
    let start = Instant::now();
    let mut sweep_of = |time_s: f64| {
        let plays = Haste::Play { every_ms: 100 };
        sensing.ask(&Arc::new(scene.at(time_s)), Wanted::default(), plays);
        while !sensing.is_idle() {
            assert!(start.elapsed() < Duration::from_secs(120), "no news");
            std::thread::sleep(Duration::from_millis(2));
            sensing.drain();
        }
        sensing.lidar().expect("a sweep").clone()
    };
    let first = sweep_of(0.5);
    std::thread::sleep(Duration::from_secs_f64(1.2 * senses::SWEEPS_EVERY_S));
    assert!(Arc::ptr_eq(&first, &sweep_of(0.5)));
    sweep_of(0.7);
    std::thread::sleep(Duration::from_secs_f64(1.2 * senses::SWEEPS_EVERY_S));
    assert!(Arc::ptr_eq(&first, &sweep_of(0.5)));
    assert!(!Arc::ptr_eq(&first, &sweep_of(0.6)));
}
