//! Public weights paint through the same door as the program's own; a tiny model with random weights stands for a real one.

use std::path::{Path, PathBuf};

use super::surfaces::{pixels_before, shared_cells};
use super::tests::{input, with_and_without_a_car};
use super::*;
use scene::{Pose, SensorRig};

fn folder(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("../../../tests/reference/stable")
        .join(name)
}

fn painter(name: &str, strength: f64) -> Box<dyn CameraPainter> {
    painter_of(&folder(name), strength)
}

fn painter_of(folder: &Path, strength: f64) -> Box<dyn CameraPainter> {
    let with = PaintWith {
        model: PaintModel::open(folder).expect("tiny weights"),
        options: PaintOptions {
            steps: 3,
            width_px: 64,
            strength,
            ..PaintOptions::public()
        },
    };
    with.painter(true)
}

fn go_on(_: PaintProgress<'_>) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

#[test]
fn pictures_are_painted_and_after_an_edit_only_what_it_touches() {
    let (with, without, _) = with_and_without_a_car();
    let rig = SensorRig::default();
    let mut painter = painter("sd15", 0.9);
    let (mut news, mut last, mut steps) = (Vec::new(), None, Vec::new());
    let old = painter.paint(&input(&with, &rig), &mut |progress| {
        steps.push((progress.step, progress.steps));
        if let Some((camera, image)) = progress.news {
            news.push(camera);
            last = Some((camera, image.rgba.clone()));
        }
        ControlFlow::Continue(())
    });
    let old = old.expect("pictures");
    // How many steps there will be is known before the first: three calls for each of six pictures.
    assert_eq!((steps[0], steps[1]), ((0, 18), (1, 18)));
    assert_eq!(steps.last(), Some(&(18, 18)));
    let last = last.expect("news");
    assert!(
        old[last.0].rgba == last.1,
        "the last of the news is the picture itself"
    );
    assert_eq!(old.len(), 6);
    assert!(
        old.iter()
            .zip(&rig.cameras)
            .all(|(image, camera)| image.camera == camera.name && image.width == 64)
    );
    // The front camera comes first, and each once.
    assert_eq!(rig.cameras[news[0]].name, "CAM_FRONT");
    // Of three steps a share of .9 is done, two, in three calls of PNDM: two are shown before the picture.
    let calls = news.iter().filter(|camera| **camera == news[0]).count();
    assert!(calls == 3 && news.len() == 6 * calls, "{news:?}");
    news.dedup();
    assert_eq!(news.len(), 6);
    // What was painted is there again at once.
    let again = painter
        .paint(&input(&with, &rig), &mut |_| panic!("painted again"))
        .expect("pictures");
    assert!(old.iter().zip(&again).all(|(a, b)| Arc::ptr_eq(a, b)));

    let new = painter
        .paint(&input(&without, &rig), &mut go_on)
        .expect("pictures");
    let same = old.iter().zip(&new).filter(|(a, b)| Arc::ptr_eq(a, b)).count();
    assert!((1..6).contains(&same), "{same} views stayed");
    let pixels = |image: &CameraImage| image.rgba.len() / 4;
    let differ: usize = old
        .iter()
        .zip(&new)
        .map(|(a, b)| {
            a.rgba
                .chunks_exact(4)
                .zip(b.rgba.chunks_exact(4))
                .filter(|(a, b)| a != b)
                .count()
        })
        .sum();
    let all: usize = old.iter().map(|i| pixels(i)).sum();
    assert!(differ > 0 && differ < all / 2, "{differ} of {all} pixels");
    // Where neither the scene nor its render changed nor the rim around does, not a bit differs.
    let ring = Ring::sized(&rig.cameras, [old[0].height, old[0].width])
        .expect("a size")
        .expect("cameras");
    let seen = [&with, &without].map(|frame| RingFrame::from_input(&input(frame, &rig), &ring));
    let changed = mask::changed(&seen[0], &seen[1], ring.size);
    for (view, changed) in changed.iter().enumerate() {
        let shares = mask::shares(changed, old[0].width);
        let camera = ring.camera(view);
        let pairs = old[camera]
            .rgba
            .chunks_exact(4)
            .zip(new[camera].rgba.chunks_exact(4));
        let stays = pairs.zip(&shares).filter(|(_, share)| **share == 0.0);
        assert!(
            stays.clone().count() > 0 && stays.clone().all(|((a, b), _)| a == b),
            "camera {camera}"
        );
    }
    // Painted by another painter the first state is the same to the bit.
    let other = self::painter("sd15", 0.9)
        .paint(&input(&with, &rig), &mut go_on)
        .expect("pictures");
    assert!(old.iter().zip(&other).all(|(a, b)| a.rgba == b.rgba));
}

/// A ControlNet is shown what the name of its folder says.
#[test]
fn a_folder_says_what_its_network_is_shown() {
    let (with, ..) = with_and_without_a_car();
    let mut rig = SensorRig::default();
    rig.cameras.truncate(2);
    let place = std::env::temp_dir().join(format!("sceneloom-controls-{}", std::process::id()));
    let mut pictures = Vec::new();
    for name in ["controlnet", "controlnet_depth", "controlnet_boxes"] {
        let to = place.join(name);
        copy(&folder("sd15"), &to);
        std::fs::rename(to.join("controlnet"), to.join(name)).expect("renamed");
        let images = painter_of(&to, 0.6).paint(&input(&with, &rig), &mut go_on);
        pictures.push(
            images
                .expect("pictures")
                .iter()
                .map(|i| i.rgba.clone())
                .collect::<Vec<_>>(),
        );
    }
    std::fs::remove_dir_all(&place).expect("removed");
    assert!(pictures[0] != pictures[1] && pictures[1] != pictures[2] && pictures[0] != pictures[2]);
}

fn copy(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).expect("a folder");
    for entry in std::fs::read_dir(from).expect("a folder") {
        let path = entry.expect("an entry").path();
        let there = to.join(path.file_name().expect("a name"));
        match path.is_dir() {
            true => copy(&path, &there),
            false => drop(std::fs::copy(&path, &there).expect("copied")),
        }
    }
}

#[test]
fn schedulers_and_words_change_the_pictures() {
    let (frame, ..) = with_and_without_a_car();
    let mut rig = SensorRig::default();
    rig.cameras.truncate(1);
    let model = PaintModel::open(&folder("sd15")).expect("tiny weights");
    let again = PaintModel::open(&folder("sd15")).expect("tiny weights");
    assert_eq!(model, again, "the same in memory");
    let usual = PaintOptions {
        steps: 4,
        strength: 0.9,
        width_px: 64,
        ..PaintOptions::public()
    };
    let paint = |options| {
        let with = PaintWith {
            model: model.clone(),
            options,
        };
        let mut all = 0;
        let images = with.painter(false).paint(&input(&frame, &rig), &mut |progress| {
            all = progress.steps;
            go_on(progress)
        });
        (all, images.expect("pictures")[0].rgba.clone())
    };
    let by = |scheduler| {
        paint(PaintOptions {
            scheduler: Some(scheduler),
            ..usual.clone()
        })
    };
    let (calls, image) = paint(usual.clone());
    // The folder's is PNDM, which takes a call more than it has steps. Of four steps a share of .9 is done, three.
    assert_eq!((calls, &image), (4, &by(SchedulerKind::Pndm).1));
    let mut seen = vec![image];
    for kind in SchedulerKind::ALL
        .into_iter()
        .filter(|k| *k != SchedulerKind::Pndm)
    {
        let (calls, image) = by(kind);
        assert_eq!(calls, 3, "{kind:?}");
        seen.push(image);
    }
    let negative = "rain, people".to_owned();
    let without = PaintOptions {
        negative,
        ..usual.clone()
    };
    seen.push(paint(without).1);
    // However few steps there are, one is done.
    let calls = |steps, strength| {
        paint(PaintOptions {
            steps,
            strength,
            ..usual.clone()
        })
        .0
    };
    assert_eq!(calls(1, 0.6), calls(9, 0.1));
    assert!(calls(1, 0.6) > 0 && calls(49, 0.01) > 0 && calls(4, 0.0) == 0);
    for (i, image) in seen.iter().enumerate() {
        assert!(!seen[..i].contains(image), "the same as another: {i}");
    }
}

#[test]
fn a_ring_is_painted_together_and_another_number_of_cameras_is_one_line() {
    let (with, ..) = with_and_without_a_car();
    let rig = SensorRig::default();
    let images = painter("ring", 0.6)
        .paint(&input(&with, &rig), &mut go_on)
        .expect("pictures");
    assert_eq!(images.len(), 6);
    let mut fewer = rig.clone();
    fewer.cameras.truncate(5);
    let error = painter("ring", 0.6)
        .paint(&input(&with, &fewer), &mut go_on)
        .expect_err("five cameras");
    assert_eq!(
        error.to_string(),
        "picture networks: the weights draw 6 cameras together, the rig has 5"
    );
}

#[test]
fn a_painting_is_stopped_and_folders_without_weights_are_one_line() {
    let (with, ..) = with_and_without_a_car();
    let rig = SensorRig::default();
    let stopped = painter("sd15", 0.6).paint(&input(&with, &rig), &mut |_| ControlFlow::Break(()));
    assert_eq!(stopped.err(), Some(PaintError::Stopped));
    for name in ["", "no such folder", "sd15/unet"] {
        let error = PaintModel::open(&folder(name))
            .expect_err("no weights")
            .to_string();
        assert!(
            error.starts_with("picture networks: ") && !error.contains('\n'),
            "{error}"
        );
    }
    let nobody = SensorRig {
        cameras: Vec::new(),
        ..rig
    };
    assert!(
        painter("sd15", 0.6)
            .paint(&input(&with, &nobody), &mut go_on)
            .expect("nothing")
            .is_empty()
    );
}

/// Mean difference between bytes.
fn apart(a: &[u8], b: &[u8]) -> f64 {
    let sum: u64 = a.iter().zip(b).map(|(a, b)| u64::from(a.abs_diff(*b))).sum();
    sum as f64 / a.len().max(1) as f64
}

#[test]
fn surfaces_are_found_again_in_the_frame_before_and_in_the_camera_beside() {
    let (frame, ..) = with_and_without_a_car();
    let rig = SensorRig::default();
    let ring = Ring::sized(&rig.cameras, [80, 128])
        .expect("a ring")
        .expect("cameras");
    let then = RingFrame::from_input(&input(&frame, &rig), &ring);
    let same = pixels_before(&then, &then, 6);
    let still = same
        .iter()
        .enumerate()
        .filter(|(i, from)| **from == Some(*i as u32));
    assert!(still.count() * 1000 >= same.len() * 999, "nothing moved");

    let ahead_rig = rig.standing_at(&Pose::planar(1.0, 0.0, 0.02));
    let now = RingFrame::from_input(&input(&frame, &ahead_rig), &ring);
    let from = pixels_before(&now, &then, 6);
    let known = from.iter().flatten().count();
    assert!(known * 10 > from.len() * 7, "{known} of {}", from.len());
    // Moved along, the colours of then are nearer to those of now than where they were.
    let colors =
        |seen: &RingFrame| -> Vec<[u8; 3]> { (0..6).flat_map(|v| seen.pixels(v).1.to_vec()).collect() };
    let (old, new) = (colors(&then), colors(&now));
    let pairs: Vec<(usize, usize)> = from
        .iter()
        .enumerate()
        .filter_map(|(i, f)| Some((i, (*f)? as usize)))
        .collect();
    let bytes = |of: &dyn Fn(&(usize, usize)) -> [u8; 3]| -> Vec<u8> { pairs.iter().flat_map(of).collect() };
    let here = bytes(&|(i, _)| new[*i]);
    let (moved, left) = (bytes(&|(_, f)| old[*f]), bytes(&|(i, _)| old[*i]));
    let (a, b) = (apart(&here, &moved), apart(&here, &left));
    assert!(a < b * 0.6, "{a} {b}");

    // Cameras overlap: their cells share noise, and within one view no noise comes twice.
    let shared = shared_cells(&then, &ring.views(), 8);
    assert_eq!(shared.len(), 6 * 10 * 16);
    let found = shared.iter().flatten().count();
    assert!(found > 20, "{found}");
    let first = ring.views()[0];
    assert!(shared[first * 160..][..160].iter().all(Option::is_none));
    for (to, from) in shared.iter().enumerate() {
        let other = from.map_or(usize::MAX, |from| from as usize / 160);
        assert_ne!(other, to / 160, "not from its own view");
    }
}

#[test]
fn a_drive_goes_on_from_what_was_painted() {
    let (frame, ..) = with_and_without_a_car();
    let rig = SensorRig::default();
    let ahead = rig.standing_at(&Pose::planar(0.5, 0.0, 0.0));
    let paint = |painter: &mut dyn CameraPainter, rig: &SensorRig| {
        let images = painter.paint(&input(&frame, rig), &mut go_on);
        images.expect("pictures")
    };
    let mut painter = painter("sd15", PaintOptions::public().strength);
    let first = paint(&mut *painter, &rig);
    let next = paint(&mut *painter, &ahead);
    let mut again = self::painter("sd15", PaintOptions::public().strength);
    assert_eq!(paint(&mut *again, &rig), first);
    assert_eq!(
        paint(&mut *again, &ahead),
        next,
        "the same drive, the same pictures"
    );
    let alone = paint(&mut *self::painter("sd15", 0.6), &ahead);
    assert_ne!(next, alone);

    // Where nothing is painted anew the second frame is the first one, moved, and else as it is rendered.
    let mut idle = self::painter("sd15", 0.0);
    let (first, next) = (paint(&mut *idle, &rig), paint(&mut *idle, &ahead));
    let size @ [height, width] = [first[0].height, first[0].width];
    let ring = Ring::sized(&rig.cameras, size).expect("a ring").expect("cameras");
    let [then, now] = [&rig, &ahead].map(|rig| RingFrame::from_input(&input(&frame, rig), &ring));
    let rgb = |images: &[Arc<CameraImage>], i: usize| {
        let (view, at) = (i / (height * width), i % (height * width));
        let image = &images[ring.camera(view)].rgba;
        [image[at * 4], image[at * 4 + 1], image[at * 4 + 2]]
    };
    let from = pixels_before(&now, &then, 6);
    assert!(from.iter().flatten().count() * 10 > from.len() * 7);
    for (i, from) in from.iter().enumerate() {
        let expected = match from {
            Some(from) => rgb(&first, *from as usize),
            None => now.pixels(i / (height * width)).1[i % (height * width)],
        };
        assert_eq!(rgb(&next, i), expected);
    }
}
