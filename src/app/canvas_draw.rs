//! Drawings over the pictures of the bird's-eye view: grid, lanes, sensors, boxes.

use egui::{Align2, Color32, Pos2, Rect, Response, Shape, Stroke, StrokeKind, Ui, pos2, vec2};
use glam::{DVec2, DVec3};

use editor::pick;
use editor::tools::{HANDLE_REACH, select};
use scene::{BevLayer, LidarSweep, PolylineKind, Pose, Scene, SceneBox, SensorRig};

use super::camera_views::LidarShown;
use super::screen_map::ScreenMap;
use super::state::UiState;
use viewport::track_color;
use widgets::theme;

/// The parts of `outer` that `inner` does not cover.
pub(super) fn around(inner: Rect, outer: Rect) -> [Rect; 4] {
    let inner = inner.intersect(outer);
    if !inner.is_positive() {
        return [outer, Rect::NOTHING, Rect::NOTHING, Rect::NOTHING];
    }
    let middle =
        |left: f32, right: f32| Rect::from_min_max(pos2(left, inner.top()), pos2(right, inner.bottom()));
    [
        Rect::from_min_max(outer.min, pos2(outer.right(), inner.top())),
        Rect::from_min_max(pos2(outer.left(), inner.bottom()), outer.max),
        middle(outer.left(), inner.left()),
        middle(inner.right(), outer.right()),
    ]
}

pub(super) fn draw_grid(ui: &Ui, map: &ScreenMap, grid: Rect) {
    let painter = ui.painter();
    for i in -4..=4 {
        let at = map.to_screen(DVec2::splat(f64::from(i) * 10.0));
        let alpha = if i == 0 { 44 } else { 18 };
        let stroke = Stroke::new(1.0, Color32::from_white_alpha(alpha));
        painter.vline(painter.round_to_pixel_center(at.x), grid.y_range(), stroke);
        painter.hline(grid.x_range(), painter.round_to_pixel_center(at.y), stroke);
    }
}

pub(super) fn draw_lines(painter: &egui::Painter, map: &ScreenMap, scene: &Scene) {
    for line in scene.frame().layout.polylines.iter() {
        let mut points: Vec<Pos2> = line.points_m.iter().map(|p| map.to_screen(*p)).collect();
        match line.kind {
            PolylineKind::LaneCenter => {
                let stroke = Stroke::new(1.0, Color32::from_rgba_unmultiplied(120, 190, 255, 90));
                painter.extend(Shape::dashed_line(&points, stroke, 5.0, 5.0));
                draw_direction(painter, &points, stroke.color);
            }
            PolylineKind::RoadDivider => {
                painter.line(
                    points,
                    Stroke::new(1.5, theme::rgb(BevLayer::RoadDivider.color())),
                );
            }
            PolylineKind::LaneDivider => {
                painter.line(
                    points,
                    Stroke::new(1.2, theme::rgba(BevLayer::LaneDivider.color(), 0.9)),
                );
            }
            PolylineKind::StopLine => {
                painter.line(points, Stroke::new(2.0, theme::rgb(BevLayer::StopLine.color())));
            }
            PolylineKind::PedCrossing => {
                points.extend(points.first().copied());
                painter.line(
                    points,
                    Stroke::new(1.0, theme::rgba(BevLayer::PedCrossing.color(), 0.8)),
                );
            }
            PolylineKind::SpeedLimit { .. } => {}
        }
    }
}

/// A small arrow head half way along a lane.
fn draw_direction(painter: &egui::Painter, points: &[Pos2], color: Color32) {
    let Some(pair) = points.get(points.len() / 2..).and_then(|p| p.first_chunk::<2>()) else {
        return;
    };
    let along = (pair[1] - pair[0]).normalized();
    if !along.is_finite() || along == egui::Vec2::ZERO {
        return;
    }
    let side = along.rot90();
    let tip = pair[0] + along * 4.0;
    let wings = [tip - along * 6.0 + side * 3.0, tip - along * 6.0 - side * 3.0];
    let head = vec![tip, wings[0], wings[1]];
    painter.add(Shape::convex_polygon(
        head,
        color.gamma_multiply(1.6),
        Stroke::NONE,
    ));
}

pub(super) fn draw_points(ui: &Ui, map: &ScreenMap, sweep: &LidarSweep, shown: &LidarShown) {
    let colors = viewport::lidar_colors(sweep, shown.colors);
    let mut mesh = egui::Mesh::default();
    for (point, [r, g, b, _]) in sweep.points.iter().zip(colors) {
        let [x, y, _] = point.position_in_ego;
        let at = map.to_screen(DVec2::new(f64::from(x), f64::from(y)));
        if map.rect.contains(at) {
            let dot = Rect::from_center_size(at, egui::Vec2::splat(1.5));
            mesh.add_colored_rect(dot, Color32::from_rgb(r, g, b));
        }
    }
    ui.painter().add(Shape::mesh(mesh));
}

pub(super) fn draw_ego(ui: &Ui, map: &ScreenMap, rig: &SensorRig, world_from_ego: &Pose) {
    let (c, half) = (
        rig.ego_center_m,
        [rig.ego_size_m[0] / 2.0, rig.ego_size_m[1] / 2.0],
    );
    let at = |x: f64, y: f64| {
        let p = DVec3::new(c[0] + x * half[0], c[1] + y * half[1], 0.0);
        map.to_screen(world_from_ego.apply(p).truncate())
    };
    let body = vec![
        at(1.0, 0.55),
        at(0.8, 1.0),
        at(-1.0, 1.0),
        at(-1.0, -1.0),
        at(0.8, -1.0),
        at(1.0, -0.55),
    ];
    let fill = Color32::from_rgb(228, 232, 238);
    let edge = Stroke::new(1.0, Color32::from_rgb(20, 22, 26));
    ui.painter().add(Shape::convex_polygon(body, fill, edge));
    let glass = vec![at(0.45, 0.72), at(0.45, -0.72), at(0.12, -0.62), at(0.12, 0.62)];
    ui.painter().add(Shape::convex_polygon(
        glass,
        Color32::from_rgb(70, 80, 95),
        Stroke::NONE,
    ));
}

/// Length of the drawn fields of view, m.
const VIEW_M: f64 = 14.0;
/// Segments of the arc of a field of view.
const ARC_STEPS: usize = 16;

/// Draws the fields of view of the rig's cameras, the chosen one over the others.
pub(super) fn draw_fields_of_view(
    ui: &Ui,
    map: &ScreenMap,
    rig: &SensorRig,
    world_from_ego: &Pose,
    chosen: Option<usize>,
) {
    let others = (0..rig.cameras.len()).filter(|i| Some(*i) != chosen);
    for i in others.chain(chosen) {
        let Some(camera) = rig.cameras.get(i) else {
            continue;
        };
        let pose = *world_from_ego * camera.ego_from_camera();
        let ahead = (pose.rotation * DVec3::Z).truncate().normalize_or(DVec2::X);
        let (from_m, half_rad) = (pose.translation_m.truncate(), camera.fov_deg().to_radians() / 2.0);
        let arc = (0..=ARC_STEPS).map(|k| {
            let turn = half_rad * (2.0 * k as f64 / ARC_STEPS as f64 - 1.0);
            map.to_screen(from_m + DVec2::from_angle(turn).rotate(ahead) * VIEW_M)
        });
        let mut outline: Vec<_> = std::iter::once(map.to_screen(from_m)).chain(arc).collect();
        outline.push(outline[0]);
        let (color, width) = match Some(i) == chosen {
            true => (theme::accent(), 2.0),
            false => (Color32::from_white_alpha(110), 1.0),
        };
        ui.painter().add(Shape::line(outline, Stroke::new(width, color)));
    }
}

/// Style of a box.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum BoxStyle {
    Plain,
    Hovered,
    Selected,
    Chosen,
    Ghost,
}

/// The colour of a box: that of its class, or of its track.
pub(super) fn box_color(b: &SceneBox, by_track: bool) -> [u8; 3] {
    match by_track {
        true => track_color(b.id),
        false => b.class.color(),
    }
}

pub(super) fn draw_boxes(ui: &Ui, map: &ScreenMap, response: &Response, scene: &Scene, state: &UiState) {
    let (hand, by_track) = (&state.tools.hand, state.shown.by_track);
    let frame = scene.frame();
    let hovered = response
        .hover_pos()
        .filter(|_| hand.tool == select::ID)
        .and_then(|p| pick::box_at(frame, map.to_ego(p)));
    for b in frame.boxes.values() {
        if Some(b.id) != hand.selected {
            let style = if hand.is_chosen(b.id) {
                BoxStyle::Chosen
            } else if Some(b.id) == hovered {
                BoxStyle::Hovered
            } else {
                BoxStyle::Plain
            };
            draw_box(ui, map, b, box_color(b, by_track), style);
        }
    }
    if let Some(b) = hand.selected.and_then(|id| frame.boxes.get(&id)) {
        draw_box(ui, map, b, box_color(b, by_track), BoxStyle::Selected);
        if hand.tool == select::ID && !scene.arranged.locked.boxes.contains(&b.id) {
            draw_handles(ui, map, b);
        }
    }
}

pub(super) fn draw_box(ui: &Ui, map: &ScreenMap, b: &SceneBox, color: [u8; 3], style: BoxStyle) {
    let painter = ui.painter();
    let corners: Vec<Pos2> = b.footprint().iter().map(|p| map.to_screen(*p)).collect();
    let (opacity, edge) = match style {
        BoxStyle::Plain => (0.42, Stroke::new(1.3, theme::rgb(color))),
        BoxStyle::Hovered => (
            0.62,
            Stroke::new(1.8, theme::rgb(color.map(|c| c.saturating_add(40)))),
        ),
        BoxStyle::Selected => (0.62, Stroke::new(2.0, Color32::WHITE)),
        BoxStyle::Chosen => (0.8, Stroke::new(2.0, Color32::WHITE)),
        BoxStyle::Ghost => (0.28, Stroke::new(1.3, theme::rgba(color, 0.8))),
    };
    painter.add(Shape::convex_polygon(corners, theme::rgba(color, opacity), edge));
    // The heading: from the middle to the front.
    let middle = map.to_screen(b.center_m.truncate());
    let front = map.to_screen(b.center_m.truncate() + b.heading() * (b.size_m.x / 2.0));
    painter.line_segment([middle, front], edge);
}

fn draw_handles(ui: &Ui, map: &ScreenMap, b: &SceneBox) {
    let painter = ui.painter();
    let front = map.to_screen(b.center_m.truncate() + b.heading() * (b.size_m.x / 2.0));
    let knob = map.to_screen(pick::rotate_knob(b));
    painter.line_segment([front, knob], Stroke::new(1.0, Color32::from_white_alpha(150)));
    painter.circle(knob, 5.0, theme::accent(), Stroke::new(1.5, Color32::WHITE));
    let reach_m = HANDLE_REACH / map.scale;
    let corners = if pick::has_corner_handles(b, reach_m) {
        b.footprint().to_vec()
    } else {
        Vec::new()
    };
    for corner in corners {
        let square = Rect::from_center_size(map.to_screen(corner), egui::Vec2::splat(6.0));
        painter.rect(
            square,
            1.0,
            Color32::WHITE,
            Stroke::new(1.0, theme::CANVAS),
            StrokeKind::Outside,
        );
    }
}

pub(super) fn draw_scale_bar(ui: &Ui, map: &ScreenMap) {
    let painter = ui.painter();
    let length_m = [1.0, 2.0, 5.0, 10.0, 20.0]
        .into_iter()
        .rfind(|m| m * map.scale <= 110.0)
        .unwrap_or(1.0);
    let length = (length_m * map.scale) as f32;
    let left = pos2(map.rect.left() + 14.0, map.rect.bottom() - 14.0);
    let right = left + vec2(length, 0.0);
    let stroke = Stroke::new(1.5, Color32::from_white_alpha(200));
    painter.line_segment([left, right], stroke);
    for end in [left, right] {
        painter.line_segment([end - vec2(0.0, 4.0), end], stroke);
    }
    let font = egui::TextStyle::Small.resolve(ui.style());
    let text_at = left + vec2(length / 2.0, -5.0);
    painter.text(
        text_at,
        Align2::CENTER_BOTTOM,
        format!("{length_m} m"),
        font,
        theme::ON_CANVAS,
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_cover_what_is_around() {
        let outer = Rect::from_min_max(pos2(0.0, 0.0), pos2(100.0, 60.0));
        let area = |strips: [Rect; 4]| strips.iter().map(|r| r.area()).sum::<f32>();
        let inner = Rect::from_min_max(pos2(20.0, 10.0), pos2(70.0, 80.0));
        assert_eq!(area(around(inner, outer)), 6000.0 - 50.0 * 50.0);
        assert_eq!(area(around(outer, outer)), 0.0);
        let apart = Rect::from_min_max(pos2(200.0, 0.0), pos2(300.0, 60.0));
        assert_eq!(around(apart, outer)[0], outer);
    }
}
