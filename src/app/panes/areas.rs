//! Division of a view when two states are compared.

use egui::{Rect, Ui, UiBuilder, pos2, vec2};

use super::compare::tag;

/// The left and the right half of an area, with a line between them.
pub(crate) fn halves(area: Rect) -> (Rect, Rect) {
    let (left, right) = area.split_left_right_at_fraction(0.5);
    (
        left.with_max_x(left.right() - 1.0),
        right.with_min_x(right.left() + 1.0),
    )
}

/// The part of an area to the left of the wipe line; `at` is the line's place, 0 to 1.
pub(crate) fn left_part(area: Rect, at: f32) -> Rect {
    area.with_max_x(area.left() + area.width() * at)
}

/// Writes the names of the two states into the two halves.
pub(crate) fn sides(ui: &Ui, left: Rect, right: Rect, [other, now]: [&str; 2]) {
    tag(ui, left.left_top() + vec2(8.0, 8.0), other, false);
    tag(ui, right.left_top() + vec2(8.0, 8.0), now, false);
}

/// Draws within a rectangle, clipped to it.
pub(crate) fn in_rect(ui: &mut Ui, rect: Rect, add: impl FnOnce(&mut Ui)) {
    ui.scope_builder(UiBuilder::new().max_rect(rect), |ui| {
        ui.set_clip_rect(ui.clip_rect().intersect(rect));
        add(ui);
    });
}

/// Draws at the present place, clipped to a rectangle.
pub(crate) fn clipped(ui: &mut Ui, clip: Rect, add: impl FnOnce(&mut Ui)) {
    ui.scope(|ui| {
        ui.set_clip_rect(ui.clip_rect().intersect(clip));
        add(ui);
    });
}

/// The upper and the lower half of an area, with a line between them.
pub(crate) fn upper_and_lower(area: Rect) -> (Rect, Rect) {
    let middle = area.center().y;
    (
        Rect::from_min_max(area.min, pos2(area.right(), middle - 1.0)),
        Rect::from_min_max(pos2(area.left(), middle + 1.0), area.max),
    )
}
