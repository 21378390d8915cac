//! Inputs of public networks for a view: classes in their colours, depths, boxes and lanes in perspective, and planes
//! of classes.

use super::seen::RingFrame;
use crate::pictures::color::perspective_rgba;
use crate::pictures::mpi::{self, RenderIds};
use crate::pictures::perspective;
use crate::pictures::picture_hints::PictureHints;
use scene::sensor_data::PlaneDepths;
use scene::{Camera, Frame, truth};
use stable::StableError;
use stable::planes::{PlaneSpan, of_runs};

/// Depths up to this are brightest, m.
const NEAREST_M: f32 = 2.0;
/// Distance between planes of classes, m.
const STEP_M: f64 = 0.2;
/// Most planes; SyntheOcc has 256.
const MOST_PLANES: usize = 4096;

/// Picture of the classes, `[channel][row][column]` from 0 to 1: the colour of each pixel's class; black where there is
/// nothing.
pub(super) fn classes(hints: &PictureHints, channels: usize) -> Vec<f32> {
    let color = |class: u8| match class {
        0 => [0; 3],
        class => truth::color(class),
    };
    let plane = |c: usize| {
        hints
            .class
            .iter()
            .map(move |class| f32::from(color(*class)[c % 3]) / 255.0)
    };
    (0..channels).flat_map(plane).collect()
}

/// Picture of the depths, `[channel][row][column]` from 0 to 1: the inverse of each pixel's depth, 1 at 2 m and nearer;
/// 0 where there is nothing.
pub(super) fn depths(hints: &PictureHints, channels: usize) -> Vec<f32> {
    let near = |depth_m: &f32| match *depth_m > 0.0 {
        true => (NEAREST_M / depth_m).min(1.0),
        false => 0.0,
    };
    let plane: Vec<f32> = hints.depth_m.iter().map(near).collect();
    plane.repeat(channels)
}

/// Picture of the layout, `[channel][row][column]` from 0 to 1: road, lanes, crossings and boxes in perspective, hidden
/// or not, in their colours.
pub(super) fn boxes_and_lanes(frame: &Frame, camera: &Camera, channels: usize) -> Vec<f32> {
    let map = perspective::render(
        &frame.layout,
        frame.boxes.values(),
        camera,
        camera.width,
        camera.height,
    );
    let rgba = perspective_rgba(&map);
    let plane = |c: usize| rgba.chunks_exact(4).map(move |p| f32::from(p[c % 3]) / 255.0);
    (0..channels).flat_map(plane).collect()
}

/// Input of [`stable::SemanticPlanes`] for some views: the label on each plane, at the size of latents.
pub(super) fn planes(
    frame: &Frame,
    seen: &RingFrame,
    views: &[usize],
    [rows, columns]: [usize; 2],
    channels: usize,
) -> Result<Vec<f32>, StableError> {
    let ids = RenderIds::new(&frame.occupancy, &[]);
    let count = channels.saturating_sub(1).min(MOST_PLANES) as u16;
    // Spacing of SyntheOcc's code: every 0.2 m.
    let layout = PlaneDepths {
        count,
        near_m: STEP_M,
        far_m: STEP_M * f64::from(count + 1),
    };
    let cells = rows * columns;
    let mut runs = Vec::new();
    for (view, place) in views.iter().enumerate() {
        let image = mpi::render(&ids, seen.camera(*place), columns as u32, rows as u32, layout);
        for cell in 0..cells {
            runs.extend(image.pixel(cell).iter().map(|run| PlaneSpan {
                cell: view * cells + cell,
                first: run.first.into(),
                end: run.end.into(),
                id: run.id,
            }));
        }
    }
    of_runs(views.len(), cells, channels, runs)
}

#[cfg(test)]
mod tests {
    use scene::{BoxId, Class, SceneBox, SensorRig};

    use super::*;

    #[test]
    fn pictures_of_conditions_are_within_their_range() {
        let hints = PictureHints {
            class: vec![0, 4, 11, 17],
            depth_m: vec![0.0, 1.0, 4.0, 80.0],
            facing: vec![0; 4],
        };
        let shown = classes(&hints, 3);
        assert_eq!(shown.len(), 12);
        assert!(shown.iter().all(|v| (0.0..=1.0).contains(v)) && shown[0] == 0.0 && shown[4] == 0.0);
        assert!([1, 5, 9].iter().any(|i| shown[*i] > 0.0));
        assert_eq!(depths(&hints, 2), [0.0, 1.0, 0.5, 0.025, 0.0, 1.0, 0.5, 0.025]);
    }

    #[test]
    fn a_box_is_shown_where_it_stands_and_nowhere_else() {
        let camera = SensorRig::default().cameras[1].resized(64, 36);
        let mut frame = Frame::new(Default::default(), Default::default(), Default::default());
        let empty = boxes_and_lanes(&frame, &camera, 3);
        let car = SceneBox {
            id: BoxId(1),
            class: Class::Car,
            center_m: glam::DVec3::new(12.0, 0.0, 0.8),
            size_m: glam::DVec3::new(4.5, 1.9, 1.6),
            yaw_rad: 0.0,
            velocity_mps: glam::DVec2::ZERO,
            label: Default::default(),
        };
        frame.boxes.insert(car.id, car);
        let shown = boxes_and_lanes(&frame, &camera, 3);
        assert_eq!(shown.len(), 3 * 64 * 36);
        assert!(shown.iter().all(|v| (0.0..=1.0).contains(v)));
        let differs: Vec<usize> = (0..64 * 36)
            .filter(|i| (0..3).any(|c| shown[c * 64 * 36 + i] != empty[c * 64 * 36 + i]))
            .collect();
        let middle = differs.iter().all(|i| (20..44).contains(&(i % 64)));
        assert!(
            (10..400).contains(&differs.len()) && middle,
            "{} pixels",
            differs.len()
        );
    }
}
