//! Marks the place under the pointer in the other panes.

use egui::{Color32, Painter, Pos2, Stroke, vec2};
use glam::DVec3;

use crate::panes::id::PaneId;
use crate::state::UiState;

/// Half the length of a cross, points.
const ARM: f32 = 7.0;

/// Notes the place under the pointer in a pane, world frame, m.
pub(crate) fn point(state: &mut UiState, pane: PaneId, place_m: DVec3) {
    state.pointed.place_now = Some((pane, place_m));
}

/// The place under the pointer in another pane than this one, world frame, m.
pub(crate) fn elsewhere(state: &UiState, pane: PaneId) -> Option<DVec3> {
    let (by, place_m) = state.pointed.place?;
    (by != pane).then_some(place_m)
}

/// Draws the mark: an open cross.
pub(crate) fn draw(painter: &Painter, at: Pos2) {
    for stroke in [
        Stroke::new(3.5, Color32::from_black_alpha(150)),
        Stroke::new(1.5, Color32::from_rgb(255, 225, 90)),
    ] {
        for way in [vec2(1.0, 0.0), vec2(-1.0, 0.0), vec2(0.0, 1.0), vec2(0.0, -1.0)] {
            painter.line_segment([at + way * 3.0, at + way * ARM], stroke);
        }
    }
}
