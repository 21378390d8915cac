//! What the tools draw over the bird's-eye view: outlines in progress, selections, measures, the gizmo.

use egui::{Align2, Color32, Painter, Pos2, Rect, Response, Shape, Stroke, StrokeKind, Ui, vec2};
use glam::{DVec2, DVec3};

use crate::canvas::ScreenMap;
use crate::canvas_draw::{BoxLook, draw_box};
use crate::canvas_tools::Gesture;
use crate::state::{Tool, UiState};
use crate::theme;
use editor::transform::{Axis, Kind};
use editor::{Shape as Area, measure};
use scene::{GridSpec, Scene};

use super::bev::{BevGesture, pull};
use super::gizmo::{Gizmo, Part};
use super::things::drag::Pull as ThingPull;
use super::{PaintShape, RegionShape, gizmo, things};

/// Draws over the finished view.
pub(crate) fn draw(
    ui: &Ui,
    response: &Response,
    map: &ScreenMap,
    scene: &Scene,
    state: &UiState,
    gesture: &Gesture,
) {
    let painter = ui.painter();
    let pointer = response.hover_pos();
    let frame = scene.frame();
    let project = |p: DVec3| Some(map.to_screen(p.truncate()));
    if state.tools.gizmo != Kind::Turn
        && let Some(gizmo) = Gizmo::new(frame, state, &[Axis::X, Axis::Y], DVec3::X, &project)
        && !matches!(gesture, Gesture::Tool(_))
    {
        gizmo.draw(painter, pointer.and_then(|p| gizmo.at(p)));
    }
    if state.tool == Tool::Region || !state.tools.region.is_empty() {
        region(painter, map, state);
    }
    match gesture {
        Gesture::Tool(BevGesture::Region { .. }) if state.tools.region_shape == RegionShape::Brush => {}
        Gesture::Tool(BevGesture::Marquee { from_m, to_m, .. } | BevGesture::Region { from_m, to_m, .. }) => {
            let rect = Rect::from_two_pos(map.to_screen(*from_m), map.to_screen(*to_m));
            marquee(painter, rect);
        }
        Gesture::Tool(BevGesture::Lasso { points_m, .. } | BevGesture::RegionOutline { points_m, .. }) => {
            lasso(painter, points_m.iter().map(|p| map.to_screen(*p)).collect());
        }
        Gesture::Tool(BevGesture::Transform {
            transform,
            from_m,
            to_m,
            moved: true,
        }) => {
            if let Some(axis) = transform.axis {
                let (middle, along) = (transform.middle_m(), transform.axis_in_ego(axis) * 200.0);
                let color = gizmo::COLORS[axis as usize];
                let ends = [middle - along, middle + along].map(|p| map.to_screen(p.truncate()));
                painter.line_segment(ends, Stroke::new(1.0, color.gamma_multiply(0.7)));
            }
            let (shift, ctrl) = ui.input(|i| (i.modifiers.shift, i.modifiers.ctrl));
            let pull = pull(transform, *from_m, *to_m, shift && transform.kind == Kind::Move);
            let text = transform.text(&pull, &state.tools.snap(ctrl));
            tag(painter, map.to_screen(*to_m), &text);
        }
        Gesture::Tool(BevGesture::Things {
            drag,
            from_m,
            moved: true,
        }) if drag.pull() == ThingPull::Place => {
            if let Some(p) = pointer {
                let d = map.to_ego(p) - *from_m;
                tag(painter, p, &format!("{:.1} m", d.length()));
            }
        }
        Gesture::Tool(BevGesture::Paint { from_m, .. }) => {
            if let Some(p) = pointer {
                let d = map.to_ego(p) - *from_m;
                tag(painter, p, &format!("{:.1} × {:.1} m", d.x.abs(), d.y.abs()));
            }
        }
        _ => {}
    }
    let free = ui.input(|i| i.modifiers.alt);
    things::draw::hands(painter, map, scene, state, pointer, free);
    if state.tools.row_open {
        for b in super::dialogs::coming(frame, state) {
            draw_box(ui, map, &b, BoxLook::Ghost);
        }
    }
    if state.tool == Tool::Brush {
        outline(painter, map, state, pointer);
    }
    let brush = state.tools.region_shape == RegionShape::Brush;
    if let (Tool::Region, true, Some(at)) = (state.tool, brush, pointer) {
        let radius = (state.brush_m / 2.0 * map.scale) as f32;
        painter.circle_stroke(at, radius, Stroke::new(3.0, Color32::from_black_alpha(140)));
        painter.circle_stroke(at, radius, Stroke::new(1.5, theme::accent()));
    }
    if state.tool == Tool::Measure {
        let next = pointer.map(|p| measure::snapped(frame, map.to_ego(p), 8.0 / map.scale));
        measured(painter, map, state, next);
    }
}

/// The cells that are to be drawn anew.
fn region(painter: &Painter, map: &ScreenMap, state: &UiState) {
    const CELL_M: f64 = 1.6;
    for [i, j] in state.tools.region.cells() {
        let corner_m = DVec2::new(
            GridSpec::MIN_M[0] + i as f64 * CELL_M,
            GridSpec::MIN_M[1] + j as f64 * CELL_M,
        );
        let rect = map.rect_of(corner_m, corner_m + CELL_M);
        painter.rect_filled(rect.shrink(0.5), 0.0, theme::accent().gamma_multiply(0.28));
    }
}

/// A rectangle that chooses.
pub(crate) fn marquee(painter: &Painter, rect: Rect) {
    painter.rect_filled(rect, 0.0, theme::accent().gamma_multiply(0.12));
    painter.rect_stroke(rect, 0.0, Stroke::new(1.2, theme::accent()), StrokeKind::Middle);
}

/// An outline that chooses.
pub(crate) fn lasso(painter: &Painter, mut points: Vec<Pos2>) {
    points.extend(points.first().copied());
    painter.extend(Shape::dashed_line(
        &points,
        Stroke::new(1.5, theme::accent()),
        5.0,
        4.0,
    ));
}

/// A line of text beside a point.
pub(crate) fn tag(painter: &Painter, at: Pos2, text: &str) {
    let font = egui::FontId::proportional(13.0);
    let galley = painter.layout_no_wrap(text.to_owned(), font, theme::ON_CANVAS);
    let rect = Rect::from_min_size(at + vec2(16.0, 14.0), galley.size()).expand2(vec2(6.0, 3.0));
    painter.rect_filled(rect, 3.0, Color32::from_black_alpha(200));
    painter.galley(rect.min + vec2(6.0, 3.0), galley, theme::ON_CANVAS);
}

/// The outline or street that is being drawn, on to the pointer.
fn outline(painter: &Painter, map: &ScreenMap, state: &UiState, pointer: Option<Pos2>) {
    let points: Vec<Pos2> = state
        .tools
        .points_m
        .iter()
        .map(|p| map.to_screen(*p))
        .chain(pointer)
        .collect();
    let drawn = state.tools.points_m.len();
    if drawn == 0 {
        return;
    }
    let color = match state.erase {
        true => theme::bad(),
        false => theme::rgb(state.layer.color()),
    };
    if state.tools.shape == PaintShape::Street {
        let width = (state.tools.street.width_m() * map.scale) as f32;
        painter.add(Shape::line(
            points.clone(),
            Stroke::new(width, color.gamma_multiply(0.35)),
        ));
    } else if points.len() >= 3 {
        let corners_m: Vec<DVec2> = state
            .tools
            .points_m
            .iter()
            .copied()
            .chain(pointer.map(|p| map.to_ego(p)))
            .collect();
        let area = Area::Polygon { points_m: corners_m };
        for [low_m, high_m] in runs(&area.cells().unwrap_or_default()) {
            painter.rect_filled(map.rect_of(low_m, high_m), 0.0, color.gamma_multiply(0.4));
        }
        let mut closed = points.clone();
        closed.push(points[0]);
        painter.extend(Shape::dashed_line(&closed, Stroke::new(1.5, color), 5.0, 4.0));
    }
    for pair in points.windows(2) {
        painter.line_segment([pair[0], pair[1]], Stroke::new(2.0, theme::ON_CANVAS));
    }
    for p in &points[..drawn] {
        painter.circle(*p, 3.5, color, Stroke::new(1.2, theme::ON_CANVAS));
    }
}

/// Sorted cells as few rectangles, corner to corner, ego frame, m.
fn runs(cells: &[[usize; 2]]) -> Vec<[DVec2; 2]> {
    let corner = |x: usize, y: usize| {
        DVec2::new(
            GridSpec::MIN_M[0] + x as f64 * GridSpec::VOXEL_M,
            GridSpec::MIN_M[1] + y as f64 * GridSpec::VOXEL_M,
        )
    };
    let joined = cells.chunk_by(|a, b| a[0] == b[0] && a[1] + 1 == b[1]);
    let run = |cells: &[[usize; 2]]| {
        let ([x, from], [_, to]) = (cells[0], cells[cells.len() - 1]);
        [corner(x, from), corner(x + 1, to + 1)]
    };
    joined.map(run).collect()
}

fn measured(painter: &Painter, map: &ScreenMap, state: &UiState, next_m: Option<DVec2>) {
    let measure = &state.tools.measure;
    let open = measure.points_m.len() < 3;
    let points: Vec<DVec2> = measure
        .points_m
        .iter()
        .copied()
        .chain(next_m.filter(|_| open))
        .collect();
    let on_screen: Vec<Pos2> = points.iter().map(|p| map.to_screen(*p)).collect();
    for pair in on_screen.windows(2) {
        painter.line_segment(
            [pair[0], pair[1]],
            Stroke::new(3.5, Color32::from_black_alpha(160)),
        );
        painter.line_segment([pair[0], pair[1]], Stroke::new(1.6, theme::warn()));
    }
    for (p, m) in on_screen.windows(2).zip(points.windows(2)) {
        let middle = p[0].lerp(p[1], 0.5);
        let font = egui::FontId::proportional(12.0);
        let text = format!("{:.2} m", m[0].distance(m[1]));
        let galley = painter.layout_no_wrap(text, font, theme::ON_CANVAS);
        let rect = Align2::CENTER_CENTER
            .anchor_size(middle, galley.size())
            .expand(3.0);
        painter.rect_filled(rect, 3.0, Color32::from_black_alpha(200));
        painter.galley(rect.min + vec2(3.0, 3.0), galley, theme::ON_CANVAS);
    }
    for p in &on_screen {
        painter.circle(*p, 3.5, theme::warn(), Stroke::new(1.2, theme::CANVAS));
    }
    if let (Some(text), Some(last)) = (measure.text(next_m), on_screen.last()) {
        tag(painter, *last, &text);
    }
}

/// Part of the gizmo that a drag holds.
pub(crate) fn held_part(axis: Option<Axis>, kind: Kind) -> Option<Part> {
    match (kind, axis) {
        (Kind::Turn, _) => Some(Part::Ring),
        (_, axis) => axis.map(Part::Axis),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_become_rectangles_that_cover_them() {
        let cells = [[3, 5], [3, 6], [3, 8], [4, 5]];
        let rects = runs(&cells);
        assert_eq!(rects.len(), 3);
        let area: f64 = rects.iter().map(|[a, b]| (*b - *a).element_product()).sum();
        assert!((area - 4.0 * 0.16).abs() < 1e-9);
        assert!(
            (rects[0][0] - DVec2::new(-38.8, -38.0)).length() < 1e-9,
            "{rects:?}"
        );
        assert!(runs(&[]).is_empty());
    }
}
