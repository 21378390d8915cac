//! Buttons beyond the edges of the map in the bird's-eye view; each makes the map larger on its side.

use egui::accesskit::Role;
use egui::{Align2, Pos2, Rect, Sense, Stroke, TextStyle, Ui, WidgetInfo, pos2, vec2};
use glam::DVec2;

use crate::command::Command;
use crate::screen_map::ScreenMap;
use editor::Edit;
use language::{t, tf};
use scene::Extent;
use widgets::theme;

/// Growth of the map per click, m; the second with Shift, for a long road.
const STEP_M: f64 = 40.0;
const LONG_M: f64 = 200.0;
/// Size of a button and its distance from the edge, points.
const BUTTON_POINTS: f32 = 20.0;
const AWAY_POINTS: f32 = 16.0;

/// The sides of the map: name, and outward direction on the ground.
const SIDES: [(&str, DVec2); 4] = [
    ("ahead", DVec2::X),
    ("behind", DVec2::NEG_X),
    ("to the left", DVec2::Y),
    ("to the right", DVec2::NEG_Y),
];

/// The edit that makes the map larger on the side in the direction `outward`.
pub(crate) fn extend(outward: DVec2, by_m: f64) -> Edit {
    let so_far = |way: DVec2| if outward == way { by_m } else { 0.0 };
    Edit::ExtendMap {
        ahead_m: so_far(DVec2::X),
        behind_m: so_far(DVec2::NEG_X),
        left_m: so_far(DVec2::Y),
        right_m: so_far(DVec2::NEG_Y),
    }
}

/// Draws the buttons, where there is room for them.
pub(crate) fn show(ui: &Ui, map: &ScreenMap, extent: Extent, commands: &mut Vec<Command>) {
    let (low, high) = (extent.min_m().truncate(), extent.max_m().truncate());
    let shown = map.rect_of(low, high).intersect(map.rect);
    for (name, outward) in SIDES {
        let Some(at) = place(map, (low, high), shown, outward) else {
            continue;
        };
        let rect = Rect::from_center_size(at, vec2(BUTTON_POINTS, BUTTON_POINTS));
        let response = ui.interact(rect, ui.scope_id().with(("edge", name)), Sense::click());
        let label = || tf!("More map {side}", side = t(name));
        response.widget_info(|| WidgetInfo::labeled(Role::Button, true, label()));
        let by_m = if ui.input(|i| i.modifiers.shift) {
            LONG_M
        } else {
            STEP_M
        };
        let color = if response.hovered() {
            theme::accent()
        } else {
            theme::text_weak()
        };
        let painter = ui.painter();
        if response.hovered() {
            let more = outward * by_m;
            let new = map.rect_of(low + more.min(DVec2::ZERO), high + more.max(DVec2::ZERO));
            painter.rect_stroke(new, 2.0, Stroke::new(1.0, color), egui::StrokeKind::Inside);
        }
        painter.circle(
            at,
            BUTTON_POINTS / 2.0 - 1.0,
            theme::well(),
            Stroke::new(1.2, color),
        );
        let font = TextStyle::Button.resolve(ui.style());
        painter.text(at, Align2::CENTER_CENTER, "+", font, color);
        let hint = tf!(
            "{step} m more map {side}; with Shift {long} m. Roads go on there.",
            step = format!("{STEP_M:.0}"),
            side = t(name),
            long = format!("{LONG_M:.0}")
        );
        if response.on_hover_text(hint).clicked() {
            commands.push(Command::Apply("Extend the map", vec![extend(outward, by_m)]));
        }
    }
}

/// Centre of the button of a side: beyond the middle of the visible part of the edge. `None` if there is no room for
/// it.
fn place(map: &ScreenMap, (low, high): (DVec2, DVec2), shown: Rect, outward: DVec2) -> Option<Pos2> {
    let edge = map.to_screen(if outward.min_element() < 0.0 { low } else { high });
    let middle = shown.center();
    let at = match outward.x != 0.0 {
        true => pos2(middle.x, edge.y - outward.x as f32 * AWAY_POINTS),
        false => pos2(edge.x - outward.y as f32 * AWAY_POINTS, middle.y),
    };
    // If there is no room beyond a visible edge, the button stands on the edge.
    let room = map.rect.shrink(BUTTON_POINTS / 2.0 + 1.0);
    let inside = room.clamp(at);
    (shown.is_positive() && inside.distance(at) <= AWAY_POINTS).then_some(inside)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_button_stands_beyond_its_edge() {
        let map = ScreenMap {
            rect: Rect::from_min_size(Pos2::ZERO, vec2(600.0, 600.0)),
            center_m: DVec2::ZERO,
            scale: 5.0,
        };
        let (low, high) = (DVec2::splat(-40.0), DVec2::splat(40.0));
        let shown = map.rect_of(low, high);
        for (_, outward) in SIDES {
            let at = map.to_ego(place(&map, (low, high), shown, outward).expect("in sight"));
            assert!((at - outward * 43.2).length() < 0.01, "{outward}: {at}");
        }
        let near = ScreenMap { scale: 20.0, ..map };
        let shown = near.rect_of(low, high).intersect(near.rect);
        assert_eq!(place(&near, (low, high), shown, DVec2::X), None);
    }
}
