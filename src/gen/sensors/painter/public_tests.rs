//! Public weights paint through the same door as the program's own; a tiny model with random weights stands for a real one.

use std::path::PathBuf;

use super::tests::{input, with_and_without_a_car};
use super::*;
use scene::SensorRig;

fn folder(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("../../../tests/reference/stable")
        .join(name)
}

fn painter(name: &str) -> Box<dyn Paint> {
    let with = PaintWith {
        model: PaintModel::open(&folder(name)).expect("tiny weights"),
        options: PaintOptions {
            steps: 3,
            width_px: 64,
            ..PaintOptions::public()
        },
    };
    with.painter(true)
}

fn go_on(_: Progress<'_>) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

#[test]
fn pictures_are_painted_and_after_an_edit_only_what_it_touches() {
    let (with, without, _) = with_and_without_a_car();
    let rig = SensorRig::default();
    let mut painter = painter("sd15");
    let mut news = Vec::new();
    let old = painter.paint(&input(&with, &rig), &mut |progress| {
        assert!(progress.step <= progress.steps);
        news.extend(progress.news.map(|(camera, _)| camera));
        ControlFlow::Continue(())
    });
    let old = old.expect("pictures");
    assert_eq!(old.len(), 6);
    assert!(
        old.iter()
            .zip(&rig.cameras)
            .all(|(image, camera)| image.camera == camera.name && image.width == 64)
    );
    // The front camera comes first, and each once.
    assert_eq!(rig.cameras[news[0]].name, "CAM_FRONT");
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
    // Painted by another painter the first state is the same to the bit.
    let other = self::painter("sd15")
        .paint(&input(&with, &rig), &mut go_on)
        .expect("pictures");
    assert!(old.iter().zip(&other).all(|(a, b)| a.rgba == b.rgba));
}

#[test]
fn a_ring_is_painted_together_and_another_number_of_cameras_is_one_line() {
    let (with, ..) = with_and_without_a_car();
    let rig = SensorRig::default();
    let images = painter("ring")
        .paint(&input(&with, &rig), &mut go_on)
        .expect("pictures");
    assert_eq!(images.len(), 6);
    let mut fewer = rig.clone();
    fewer.cameras.truncate(5);
    let error = painter("ring")
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
    let stopped = painter("sd15").paint(&input(&with, &rig), &mut |_| ControlFlow::Break(()));
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
        painter("sd15")
            .paint(&input(&with, &nobody), &mut go_on)
            .expect("nothing")
            .is_empty()
    );
}
