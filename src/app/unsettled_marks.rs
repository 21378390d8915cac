//! Dashed frames around the regions that are still to be generated, in both large views.

use egui::{Color32, Painter, Pos2, Shape, Stroke};
use glam::{DVec2, DVec3};

use scene::{Extent, Frame};

use crate::screen_map::ScreenMap;
use crate::shell::live::Bounds;
use widgets::theme;

/// Length of the pieces of a frame in 3D, m, short enough to follow the ground.
const PIECE_M: f64 = 4.0;

fn color(generating: bool) -> Color32 {
    match generating {
        true => theme::accent(),
        false => theme::warn(),
    }
}

/// Lowest and highest corner of a region, m.
fn corners_m(extent: Extent, (low, high): &Bounds) -> [DVec2; 2] {
    let at = |c: &[usize; 2]| extent.center(c[0], c[1], 0).truncate();
    let half = DVec2::splat(extent.voxel_m() / 2.0);
    [at(low) - half, at(high) + half]
}

/// Draws the frames over the bird's-eye view.
pub(super) fn from_above(
    painter: &Painter,
    map: &ScreenMap,
    extent: Extent,
    parts: &[Bounds],
    generating: bool,
) {
    let color = color(generating);
    for part in parts {
        let [low, high] = corners_m(extent, part);
        let rect = map.rect_of(low, high).expand(2.0);
        painter.rect_filled(rect, 2.0, color.gamma_multiply(0.07));
        let [a, b, c, d] = [
            rect.left_top(),
            rect.right_top(),
            rect.right_bottom(),
            rect.left_bottom(),
        ];
        let stroke = Stroke::new(1.3, color);
        painter.extend(Shape::dashed_line(&[a, b, c, d, a], stroke, 6.0, 4.0));
    }
}

/// Draws the frames over the 3D view, on the ground.
pub(super) fn in_3d(
    painter: &Painter,
    project: &dyn Fn(DVec3) -> Option<Pos2>,
    frame: &Frame,
    parts: &[Bounds],
    generating: bool,
) {
    let stroke = Stroke::new(1.3, color(generating));
    let relief = &frame.layout.relief;
    let on_screen = |p: DVec2| project(p.extend(relief.height_m(p) + 0.1));
    for part in parts {
        let [low, high] = corners_m(frame.extent(), part);
        let corners = [
            low,
            DVec2::new(high.x, low.y),
            high,
            DVec2::new(low.x, high.y),
            low,
        ];
        for side in corners.windows(2) {
            let pieces = (side[0].distance(side[1]) / PIECE_M).ceil().max(1.0) as usize;
            let place = |i: usize| on_screen(side[0].lerp(side[1], i as f64 / pieces as f64));
            let places: Vec<Option<Pos2>> = (0..=pieces).map(place).collect();
            for seen in places.split(Option::is_none) {
                let line: Vec<Pos2> = seen.iter().flatten().copied().collect();
                painter.extend(Shape::dashed_line(&line, stroke, 6.0, 4.0));
            }
        }
    }
}
