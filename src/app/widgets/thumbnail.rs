//! Small maps: lanes, crossings and boxes as in the bird's-eye view, ahead of the ego vehicle is up.

use egui::{Color32, Pos2, Rect, Shape, Stroke, Ui, pos2};
use glam::DVec2;

use crate::theme;
use place::holds::ego;
use scene::{BevLayout, PolylineKind, SceneBox};

/// Length that the shorter side of a map shows, m: a little more than the width of the grid.
const SIDE_M: f32 = 84.0;
/// Width of a lane, m.
const LANE_M: f32 = 3.6;

/// Side of an enlarged map, points.
const LARGE: f32 = 380.0;

/// An enlarged map as the tooltip of a widget, above the text `says`.
pub fn enlarged(over: &egui::Response, layout: &BevLayout, boxes: &[SceneBox], says: &str) {
    let tip = egui::Tooltip::for_enabled(over).width(LARGE);
    tip.show(|ui| {
        let (rect, _) = ui.allocate_exact_size(egui::Vec2::splat(LARGE), egui::Sense::hover());
        ui.painter().rect_filled(rect, theme::RADIUS, theme::well());
        scene(ui, rect, layout, boxes);
        ui.label(says);
    });
}

/// Draws the road, the boxes on it, and the ego vehicle.
pub fn scene(ui: &Ui, rect: Rect, layout: &BevLayout, boxes: &[SceneBox]) {
    let painter = ui.painter().with_clip_rect(rect);
    let scale = rect.width().min(rect.height()) / SIDE_M;
    // Ego x is up, ego y to the left.
    let at = |p: DVec2| -> Pos2 {
        pos2(
            rect.center().x - p.y as f32 * scale,
            rect.center().y - p.x as f32 * scale,
        )
    };
    let gray = theme::text_weak().gamma_multiply(0.4);
    for line in layout.polylines.iter() {
        let points: Vec<Pos2> = line.points_m.iter().map(|p| at(*p)).collect();
        match line.kind {
            PolylineKind::LaneCenter => {
                painter.add(Shape::line(points, Stroke::new(LANE_M * scale, gray)));
            }
            PolylineKind::PedCrossing => {
                painter.add(Shape::closed_line(points, Stroke::new(1.0, theme::text())));
            }
            _ => {}
        }
    }
    let quad = |b: &SceneBox, color: Color32| {
        let points: Vec<Pos2> = b.footprint().iter().map(|p| at(*p)).collect();
        let edge = Stroke::new(0.8, theme::text_strong());
        painter.add(Shape::convex_polygon(points, color, edge));
    };
    quad(&ego(), theme::accent());
    for b in boxes {
        quad(b, theme::class_color(b.class));
        // A dot keeps small boxes visible.
        painter.circle_filled(at(b.center_m.truncate()), 1.2, theme::class_color(b.class));
    }
}
