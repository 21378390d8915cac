//! Brushes saved by the user, below the options of the brush in hand.

use egui::Ui;

use editor::tools::saved::{BrushSettings, SavedBrush};
use editor::tools::{Hand, PaintShape, VoxelMode, VoxelVerb};
use language::{t, tf};
use widgets::icons::section;
use widgets::theme;

/// Longest name of a brush, letters.
const LONGEST: usize = 24;

/// The default name of a brush: its settings in words.
fn named(held: &BrushSettings) -> String {
    fn display_name<T: PartialEq>(all: &[(T, &'static str, &'static str)], value: &T) -> &'static str {
        all.iter()
            .find(|(v, ..)| v == value)
            .map_or("", |(_, name, _)| *name)
    }
    match held {
        BrushSettings::Map {
            layer,
            shape,
            size_m,
            erase,
        } => {
            let layer = theme::sentence(t(&layer.label()));
            let shape = t(display_name(&PaintShape::ALL, shape)).to_lowercase();
            match erase {
                true => tf!(
                    "Erase {layer}, {shape}, {size} m",
                    layer = layer,
                    shape = shape,
                    size = size_m
                ),
                false => tf!(
                    "{layer}, {shape}, {size} m",
                    layer = layer,
                    shape = shape,
                    size = size_m
                ),
            }
        }
        BrushSettings::Voxels {
            mode, verb, class, ..
        } => {
            let (mode, verb) = (
                t(display_name(&VoxelMode::ALL, mode)),
                t(display_name(&VoxelVerb::ALL, verb)),
            );
            tf!(
                "{verb} {class}, {mode}",
                verb = verb,
                class = t(&class.label()),
                mode = mode.to_lowercase()
            )
        }
        BrushSettings::Stamp(stamp) => tf!("Stamp of {n} voxels", n = stamp.len()),
    }
}

/// Draws the saved brushes while a brush is in hand.
pub(super) fn saved_brushes_ui(ui: &mut Ui, hand: &mut Hand, saved: &mut Vec<SavedBrush>) {
    let now = hand.brush_in_hand();
    if now.is_none() {
        return;
    }
    ui.add_space(theme::GAP);
    section(ui, t("Saved brushes"));
    let mut gone = None;
    ui.horizontal_wrapped(|ui| {
        for (i, brush) in saved.iter_mut().enumerate() {
            let chosen = now.as_ref() == Some(&brush.held);
            let button = ui
                .selectable_label(chosen, &brush.name)
                .on_hover_text(named(&brush.held));
            if button.clicked() {
                hand.take_brush(&brush.held);
            }
            widgets::menu::on_right_click(&button, |ui| {
                ui.horizontal(|ui| {
                    ui.label(t("Name"));
                    let field = egui::TextEdit::singleline(&mut brush.name).char_limit(LONGEST);
                    let field = ui.add(field.desired_width(140.0)).accessible_name(t("Name"));
                    if field.lost_focus() && ui.input(|i| i.key_pressed(egui::Key::Enter)) {
                        ui.close();
                    }
                });
                if ui.button(t("Delete")).clicked() {
                    gone = Some(i);
                    ui.close();
                }
            });
        }
        let known = saved.iter().any(|b| now.as_ref() == Some(&b.held));
        let room = !known && saved.len() < SavedBrush::MOST;
        let keep = ui
            .add_enabled(room, egui::Button::new(t("Keep this one")))
            .on_hover_text(t(
                "Keeps the brush as it is set now; a right click on it names or deletes it",
            ));
        if let (true, Some(held)) = (keep.clicked(), now) {
            saved.push(SavedBrush {
                name: named(&held).chars().take(LONGEST).collect(),
                held,
            });
        }
    });
    if let Some(i) = gone {
        saved.remove(i);
    }
}
