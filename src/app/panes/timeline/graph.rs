//! Curves of speed and distance over time, for the selection or the ego vehicle.

use egui::{Align2, Pos2, Rect, Shape, Stroke, TextStyle, Ui, pos2, vec2};

use scene::{BoxId, Moving, Scene};

use super::rows::TimeAxis;
use language::tf;
use widgets::theme;

/// Time between two points of a curve, s.
const STEP_S: f64 = 0.1;

/// Draws the curves on the time axis of the rows.
pub(super) fn show(ui: &mut Ui, scene: &Scene, id: Option<BoxId>, track: TimeAxis) {
    let clip = scene.clip();
    let id = id.filter(|id| clip.tracks.contains_key(id));
    let size = vec2(ui.available_width(), ui.available_height().max(30.0));
    let (area, _) = ui.allocate_exact_size(size, egui::Sense::hover());
    let (left, right) = track.ends();
    let rect = Rect::from_x_y_ranges(left..=right, area.top() + 4.0..=area.bottom() - 2.0);
    ui.painter().rect_filled(rect, 2.0, theme::well());
    let at = |time_s: f64| -> Option<Moving> {
        match id {
            Some(id) => clip.moving(id, time_s),
            None => clip.ego_moving(time_s),
        }
    };
    let steps = (clip.length_s / STEP_S).ceil() as usize;
    let times = (0..=steps).map(|i| (i as f64 * STEP_S).min(clip.length_s));
    let places: Vec<(f64, Moving)> = times.filter_map(|t| at(t).map(|m| (t, m))).collect();
    let mut way_m = 0.0;
    let mut distances = Vec::with_capacity(places.len());
    for (i, (t, m)) in places.iter().enumerate() {
        if i > 0 {
            way_m += m.at_m.distance(places[i - 1].1.at_m);
        }
        distances.push((*t, way_m));
    }
    let speeds: Vec<(f64, f64)> = places
        .iter()
        .map(|(t, m)| (*t, m.velocity_mps.length() * 3.6))
        .collect();
    let most_kmh = speeds.iter().map(|s| s.1).fold(1.0, f64::max);
    let curve = |values: &[(f64, f64)], most: f64| -> Vec<Pos2> {
        let y = |v: f64| rect.bottom() - 2.0 - (v / most) as f32 * (rect.height() - 6.0);
        values.iter().map(|(t, v)| pos2(track.x(*t), y(*v))).collect()
    };
    let painter = ui.painter_at(area);
    painter.add(Shape::line(
        curve(&distances, way_m.max(1.0)),
        Stroke::new(1.2, theme::text_weak()),
    ));
    painter.add(Shape::line(
        curve(&speeds, most_kmh),
        Stroke::new(1.8, theme::accent()),
    ));
    let font = TextStyle::Small.resolve(ui.style());
    let now = at(scene.time_s()).map_or(0.0, |m| m.velocity_mps.length() * 3.6);
    for (i, (text, color)) in [
        (
            tf!(
                "{now} km/h (to {most})",
                now = format!("{now:.0}"),
                most = format!("{most_kmh:.0}")
            ),
            theme::accent(),
        ),
        (
            tf!("{way} m in all", way = format!("{way_m:.0}")),
            theme::text_weak(),
        ),
    ]
    .into_iter()
    .enumerate()
    {
        let at = pos2(area.left() + 20.0, rect.top() + 4.0 + 15.0 * i as f32);
        painter.text(at, Align2::LEFT_TOP, text, font.clone(), color);
    }
    let x = track.x(scene.time_s());
    painter.vline(x, rect.y_range(), Stroke::new(1.0, theme::accent()));
}
