//! Requests that do not fit a model, each refused in one line before anything is computed.

use super::behaviour::{go_on, request, some_picture};
use super::opened;
use crate::{Control, PictureBatch, PictureRequest, SemanticPlanes, StartPictures};

/// What is wrong with a request.
type Spoil<'a> = fn(&mut PictureRequest<'a>, &'a PictureBatch);

const NUMBERS: [f32; 9] = [0.0; 9];

fn start<'a>(
    pictures: &'a PictureBatch,
    strength: f64,
    mask: Option<&'a [bool]>,
) -> Option<StartPictures<'a>> {
    Some(StartPictures {
        pictures,
        strength,
        mask,
    })
}

#[test]
fn requests_that_do_not_fit_are_refused_in_one_line() {
    let pipeline = opened("sd15");
    let picture = some_picture(1, [16, 24]);
    let wrong: [(&str, Spoil<'_>); 19] = [
        ("side of a picture is 23", |r, _| r.size = [16, 23]),
        ("side of a picture is 0", |r, _| r.size = [0, 16]),
        ("side of a picture is 65536", |r, _| r.size = [16, 65536]),
        ("number of pictures is 0", |r, _| r.views = 0),
        ("number of pictures is 18446744073709551615", |r, _| {
            (r.views, r.frames) = (usize::MAX, 3);
        }),
        ("prompts has 0 values", |r, _| r.prompts.clear()),
        ("steps is 0", |r, _| r.steps = 0),
        ("steps is 1001", |r, _| r.steps = 1001),
        ("guidance is NaN", |r, _| r.guidance.weight = f64::NAN),
        ("guidance is 7.5 and 2", |r, _| r.guidance.rescale = 2.0),
        ("noise has 3 values, expected 384", |r, _| {
            r.noise = Some(vec![0.0; 3])
        }),
        ("noise: value 0 is NaN", |r, _| {
            r.noise = Some(vec![f32::NAN; 384])
        }),
        ("strength is 2", |r, p| r.start = start(p, 2.0, None)),
        ("strength is NaN", |r, p| r.start = start(p, f64::NAN, None)),
        ("mask has 1 values, expected 384", |r, p| {
            r.start = start(p, 1.0, Some(&[true]));
        }),
        ("size of the pictures to go out from", |r, p| {
            (r.start, r.size) = (start(p, 1.0, None), [16, 16]);
        }),
        ("ControlNet is 3", |r, _| {
            r.controls = vec![Control::new(3, &NUMBERS)]
        }),
        ("picture of a ControlNet has 9 values", |r, _| {
            r.controls = vec![Control::new(0, &NUMBERS)];
        }),
        ("multi-plane images is 9", |r, _| {
            r.planes = Some(SemanticPlanes {
                ids: &NUMBERS,
                scale: 1.0,
            });
        }),
    ];
    for (begins, spoil) in wrong {
        let mut asked = request(1);
        spoil(&mut asked, &picture);
        let error = pipeline.draw(&asked, go_on).expect_err(begins).to_string();
        assert!(error.starts_with(begins) && !error.contains('\n'), "{error}");
    }
}

#[test]
fn a_ring_wants_all_its_views_and_planes() {
    let pipeline = opened("ring");
    let error = pipeline
        .draw(&request(1), go_on)
        .expect_err("one view")
        .to_string();
    assert_eq!(error, "number of views is 1, expected 6, those of the UNet");
    let asked = PictureRequest {
        views: 6,
        controls: vec![Control::new(0, &NUMBERS)],
        ..request(1)
    };
    let error = pipeline.draw(&asked, go_on).expect_err("a picture").to_string();
    assert_eq!(
        error,
        "condition of a ControlNet that takes planes is a picture, expected planes"
    );
}
