//! Rows of number fields with their captions, at the same places on every pane.

use egui::{DragValue, Ui};
use glam::DVec3;

use crate::command::Command;
use editor::Edit;
use numeric::decimal::decimal;
use widgets::theme;

/// The caption at the left of a row of fields.
pub fn caption(ui: &mut Ui, text: &str) {
    label(ui, text, 52.0);
}

/// The caption at the left of a widget, `width_points` wide.
pub fn label(ui: &mut Ui, text: &str, width_points: f32) {
    let (rect, _) = ui.allocate_exact_size(egui::vec2(width_points, theme::ROW), egui::Sense::hover());
    let font = egui::TextStyle::Body.resolve(ui.style());
    let at = rect.left_center();
    ui.painter()
        .text(at, egui::Align2::LEFT_CENTER, text, font, theme::text_weak());
}

/// A field for a number, displayed as `shown`. A typed number takes effect at the end: with Enter or when the focus
/// leaves. Otherwise a number that the scene normalizes (a heading, a place along turned axes) would replace the text
/// while it is typed, and each digit would be an undo step. A text that is left unchanged stands for the exact number
/// behind it.
pub fn typed<'a>(value: &'a mut f64, shown: impl Fn(f64) -> String + Copy + 'a) -> DragValue<'a> {
    let exact = *value;
    DragValue::new(value)
        .update_while_editing(false)
        .custom_formatter(move |v, _| shown(v))
        .custom_parser(move |text| read(text, exact, shown))
}

fn read(text: &str, exact: f64, shown: impl Fn(f64) -> String) -> Option<f64> {
    let text: String = text.split_whitespace().collect::<String>().replace('−', "-");
    match text == shown(exact) {
        true => Some(exact),
        false => text.parse().ok(),
    }
}

/// A number with at most so many decimals.
pub fn short(value: f64, decimals: usize) -> String {
    let text = decimal(value, decimals);
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

/// Three numbers in a row; returns the response of all of them.
pub fn numbers(
    ui: &mut Ui,
    title: &str,
    names: [&str; 3],
    value: &mut DVec3,
    range: std::ops::RangeInclusive<f64>,
    speed: f64,
) -> egui::Response {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 3.0;
        caption(ui, title);
        let width = ((ui.available_width() - 6.0) / 3.0).clamp(40.0, 90.0);
        let mut fields = names.into_iter().enumerate().map(|(axis, name)| {
            let drag = typed(&mut value[axis], |v| decimal(v, 2))
                .speed(speed)
                .range(range.clone())
                .fixed_decimals(2);
            ui.add_sized([width, theme::ROW], drag)
                .on_hover_text(format!("{name}, m"))
                .accessible_name(name)
        });
        let first = fields.next().expect("three names");
        fields.fold(first, |all, one| all.union(one))
    })
    .inner
}

/// Turns the response of a field into commands: dragging previews the edit, releasing commits it, typing applies it.
pub fn field(response: &egui::Response, label: &'static str, edit: Edit, commands: &mut Vec<Command>) {
    fields(response, label, vec![edit], commands);
}

/// Turns the response of a field into commands for several edits; see [`field`].
pub fn fields(response: &egui::Response, label: &'static str, edits: Vec<Edit>, commands: &mut Vec<Command>) {
    if response.dragged() {
        if response.changed() {
            commands.push(Command::Preview(edits));
        }
    } else if response.drag_stopped() {
        commands.push(Command::Commit(label));
    } else if response.changed() {
        commands.push(Command::Apply(label, edits));
    }
}

/// One number with its caption.
pub fn number(
    ui: &mut Ui,
    title: &str,
    name: &str,
    value: &mut f64,
    range: std::ops::RangeInclusive<f64>,
    suffix: &str,
    decimals: usize,
) -> egui::Response {
    ui.horizontal(|ui| {
        caption(ui, title);
        let drag = typed(value, move |v| decimal(v, decimals))
            .speed(0.5 * 10f64.powi(-(decimals as i32)).max(0.02))
            .range(range)
            .fixed_decimals(decimals)
            .suffix(suffix);
        ui.add_sized([86.0, theme::ROW], drag).accessible_name(name)
    })
    .inner
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_left_as_it_was_shown_is_the_number_behind_it() {
        let two = |v| decimal(v, 2);
        assert_eq!(read("-22.78", -22.7834, two), Some(-22.7834));
        assert_eq!(read(" −22.78 ", -22.7834, two), Some(-22.7834));
        assert_eq!(read("-22.79", -22.7834, two), Some(-22.79));
        assert_eq!(read("0.00", -0.001, two), Some(-0.001));
        assert_eq!(read("two", 2.0, two), None);
        assert_eq!(
            (short(30.0, 1), short(0.12, 1), short(-0.04, 1)),
            ("30".into(), "0.1".into(), "0".into())
        );
    }
}
