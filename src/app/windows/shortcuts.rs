//! The sheet of keys: it can be searched, a click and a press change a chord, and presets can be chosen.

use egui::accesskit::Role;
use egui::{Id, Key, Modal, Ui, WidgetInfo, vec2};

use crate::shell::actions::{ACTIONS, ActionDef, ActionGroup, When};
use crate::shell::keymap::{Chord, Chords, Keymap, PRESETS};
use language::{t, tf};
use widgets::theme;

/// Inputs that no preset changes: the pointer, and keys that go with it.
const FIXED: [(&str, &str); 9] = [
    ("Hold \\", "Show the version before, in every view"),
    ("Middle drag", "Orbit; pan in the bird's-eye view"),
    ("Shift+middle, Space+left", "Pan"),
    ("Wheel", "Zoom to the pointer"),
    ("Ctrl+wheel", "Brush size"),
    ("Hold right + WASD QE", "Fly (Shift fast, Alt slow)"),
    ("Arrows, PgUp PgDn", "Nudge 0.1 m (Shift 1 m, Ctrl 0.01 m)"),
    ("Ctrl + − 0", "Larger, smaller, normal size of everything"),
    ("Double click on a header", "Maximize the pane"),
];

/// True for keys that are only modifiers of a chord.
fn is_modifier(key: Key) -> bool {
    matches!(
        key,
        Key::ShiftLeft
            | Key::ShiftRight
            | Key::ControlLeft
            | Key::ControlRight
            | Key::AltLeft
            | Key::AltRight
            | Key::SuperLeft
            | Key::SuperRight
    )
}

/// The search text, and the action that waits for a chord.
#[derive(Clone, Debug, Default)]
pub struct Shortcuts {
    query: String,
    awaiting: Option<&'static str>,
    said: String, // actions that lost a chord in the last change
}

impl Shortcuts {
    /// Draws the sheet while it is open.
    pub fn show(&mut self, ui: &Ui, keymap: &mut Keymap, open: &mut bool) {
        if !*open {
            return;
        }
        self.take_chord(ui, keymap);
        let modal = Modal::new(Id::unique("keys")).frame(theme::dialog_frame(ui.style()));
        let shown = modal.show(ui.ctx(), |ui| {
            let room = ui.ctx().content_rect().size();
            ui.set_width((room.x - 80.0).min(940.0));
            self.head(ui, keymap);
            ui.add_space(theme::GAP);
            egui::ScrollArea::vertical()
                .min_scrolled_height(room.y - 190.0)
                .max_height(room.y - 190.0)
                .show(ui, |ui| {
                    ui.columns_const(|[left, right]: &mut [Ui; 2]| {
                        for (i, (group, title)) in ActionGroup::ALL.into_iter().enumerate() {
                            let column = if i == 0 || i == 2 { &mut *left } else { &mut *right };
                            self.group(column, group, title, keymap);
                        }
                        self.fixed(right);
                    });
                });
        });
        if self.awaiting.is_none() && shown.should_close() {
            *open = false;
        }
    }

    fn head(&mut self, ui: &mut Ui, keymap: &mut Keymap) {
        ui.horizontal(|ui| {
            ui.heading(t("Keys"));
            ui.add_space(theme::GAP);
            let search = egui::TextEdit::singleline(&mut self.query)
                .hint_text(t("Search"))
                .desired_width(200.0);
            ui.add(search);
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                let changed = !keymap.own.is_empty();
                if ui
                    .add_enabled(changed, egui::Button::new(t("Reset mine")))
                    .clicked()
                {
                    keymap.reset();
                }
                let mut preset = keymap.preset.clone();
                egui::ComboBox::from_id_salt("key preset")
                    .selected_text(t(&preset))
                    .show_ui(ui, |ui| {
                        for (name, _) in PRESETS {
                            ui.selectable_value(&mut preset, name.to_owned(), t(name));
                        }
                    });
                ui.label(egui::RichText::new(t("Preset")).color(theme::text_weak()));
                if preset != keymap.preset {
                    *keymap = Keymap::new(&preset, Chords::new());
                }
            });
        });
        let (text, color) = match self.awaiting {
            Some(_) => (
                t("Press the new chord. Esc leaves it as it was."),
                theme::text_weak(),
            ),
            None if !self.said.is_empty() => (self.said.as_str(), theme::warn()),
            None => (t("Click a chord to change it."), theme::text_weak()),
        };
        ui.label(egui::RichText::new(text).small().color(color));
    }

    fn group(&mut self, ui: &mut Ui, group: ActionGroup, title: &str, keymap: &mut Keymap) {
        let wanted = self.query.to_lowercase();
        let fits = |a: &&ActionDef| {
            let text = format!("{} {} {}", a.title, keymap.text(a.id), t(a.title)).to_lowercase();
            a.group == group && text.contains(&wanted)
        };
        let actions: Vec<&'static ActionDef> = ACTIONS.iter().filter(fits).collect();
        if actions.is_empty() {
            return;
        }
        widgets::icons::section(ui, t(title));
        for action in actions {
            ui.horizontal(|ui| {
                let chords = keymap.text(action.id);
                let text = match (self.awaiting == Some(action.id), chords.is_empty()) {
                    (true, _) => t("press…").to_owned(),
                    (false, true) => "–".to_owned(),
                    (false, false) => chords,
                };
                let color = if self.awaiting == Some(action.id) {
                    theme::accent()
                } else {
                    theme::text_strong()
                };
                let button =
                    egui::Button::new(egui::RichText::new(text).color(color)).min_size(vec2(150.0, 20.0));
                if ui.add(button).clicked() {
                    self.awaiting = Some(action.id);
                }
                let own = t(action.title);
                let title = match action.when {
                    When::Always => own.to_owned(),
                    When::Over3d => tf!("{title}  (3D)", title = own),
                    When::Chosen => tf!("{title}  (chosen)", title = own),
                    When::Things => tf!("{title}  (thing chosen)", title = own),
                    When::Painting => tf!("{title}  (painting)", title = own),
                    When::Staged => tf!("{title}  (new result)", title = own),
                };
                ui.label(egui::RichText::new(title).color(theme::text_weak()));
                if keymap.is_changed(action.id) {
                    let back = ui
                        .small_button(t("Reset"))
                        .on_hover_text(t("The chord of the preset again"));
                    let name = tf!("Reset the chord of {action}", action = own);
                    back.widget_info(|| WidgetInfo::labeled(Role::Button, true, &name));
                    if back.clicked() {
                        keymap.reset_one(action.id);
                        self.said.clear();
                    }
                }
            });
        }
    }

    fn fixed(&self, ui: &mut Ui) {
        let wanted = self.query.to_lowercase();
        let fits = |(keys, what): &&(&str, &str)| {
            let text = format!("{keys} {what} {} {}", t(keys), t(what)).to_lowercase();
            text.contains(&wanted)
        };
        let rows: Vec<_> = FIXED.iter().filter(fits).collect();
        if rows.is_empty() {
            return;
        }
        widgets::icons::section(ui, t("Pointer"));
        for (keys, what) in rows {
            ui.horizontal(|ui| {
                ui.scope(|ui| {
                    ui.set_width(158.0);
                    ui.label(egui::RichText::new(t(keys)).color(theme::text_strong()));
                });
                ui.label(egui::RichText::new(t(what)).color(theme::text_weak()));
            });
        }
    }

    fn take_chord(&mut self, ui: &Ui, keymap: &mut Keymap) {
        let Some(id) = self.awaiting else { return };
        let pressed = ui.input_mut(|i| {
            let at = i.events.iter().position(
                |e| matches!(e, egui::Event::Key { pressed: true, key, .. } if !is_modifier(*key)),
            )?;
            match i.events.remove(at) {
                egui::Event::Key { key, modifiers, .. } => Some((key, modifiers)),
                _ => None,
            }
        });
        let Some((key, modifiers)) = pressed else { return };
        self.awaiting = None;
        if key != Key::Escape {
            let chord = Chord::pressed(key, modifiers);
            let losers = keymap.rebind(id, chord);
            self.said = match losers.is_empty() {
                true => String::new(),
                false => {
                    let losers: Vec<&str> = losers.into_iter().map(t).collect();
                    tf!(
                        "{chord} was the chord of {actions}: it is not any more.",
                        chord = chord,
                        actions = losers.join(", ")
                    )
                }
            };
        }
    }
}
