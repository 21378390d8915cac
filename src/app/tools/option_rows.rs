//! The options of a tool as rows of controls. Each kind of option looks the same for all tools.

use egui::Ui;
use egui::accesskit::Role;

use crate::fields::label;
use editor::tools::setting::{Control, NumberSlider};
use editor::tools::{ToolOption, Value};
use language::{t, tf};
use scene::Class;
use widgets::hint::caption;
use widgets::icons::{self, section};
use widgets::theme;

/// Draws options with their English texts translated. Returns the values that the user set, by id.
pub fn show(ui: &mut Ui, settings: &[ToolOption]) -> Vec<(&'static str, Value)> {
    let mut set = Vec::new();
    for setting in settings {
        if let Some(value) = draw(ui, setting, &mut set) {
            set.push((setting.id, value));
        }
    }
    set
}

fn draw(ui: &mut Ui, setting: &ToolOption, set: &mut Vec<(&'static str, Value)>) -> Option<Value> {
    match &setting.control {
        Control::Title(title) => section(ui, t(title)),
        Control::Text(text) => caption(ui, t(text)),
        Control::Result(text) => {
            ui.label(egui::RichText::new(t(text)).color(theme::text_strong()));
        }
        Control::Gap => ui.add_space(3.0),
        Control::Number(number) if number.wide => return wide_slider(ui, number),
        Control::Number(number) => return slider(ui, number),
        Control::Segments {
            chosen,
            choices,
            columns,
        } => {
            let named = choices.iter().enumerate();
            let all: Vec<_> = named.map(|(i, c)| (i, t(c.0), t(c.1))).collect();
            let mut now = *chosen;
            for part in all.chunks((*columns).max(1)) {
                icons::segments(ui, &mut now, part);
                if all.len() > *columns {
                    ui.add_space(2.0);
                }
            }
            return (now != *chosen).then_some(Value::Index(now));
        }
        Control::List {
            title,
            label: name,
            chosen,
            choices,
        } => return list_of(ui, title, name, *chosen, choices),
        Control::Rows { chosen, names, verb } => {
            let mut now = None;
            for (i, name) in names.iter().enumerate() {
                let label = tf!("{verb} {name}", verb = t(verb), name = t(name));
                let (color, title) = (theme::text_weak(), theme::sentence(t(name)));
                if icons::row(ui, color, &title, "", i == *chosen, &label).clicked() {
                    now = Some(Value::Index(i));
                }
            }
            return now;
        }
        Control::Toggle { on, title, hint } => {
            let mut now = *on;
            ui.checkbox(&mut now, t(title)).on_hover_text(t(hint));
            return (now != *on).then_some(Value::On(now));
        }
        Control::Class {
            chosen,
            classes,
            verb,
        } => return class(ui, classes, *chosen, verb).map(Value::Class),
        Control::Button { title, hint, enabled } => {
            let response = ui.add_enabled(*enabled, egui::Button::new(t(title)));
            return response
                .on_hover_text(t(hint))
                .clicked()
                .then_some(Value::Pressed);
        }
        Control::Line(settings) => {
            ui.horizontal(|ui| set.extend(show(ui, settings)));
        }
        Control::Row(settings) => {
            ui.horizontal_wrapped(|ui| {
                ui.spacing_mut().item_spacing = egui::vec2(3.0, 3.0);
                set.extend(show(ui, settings));
            });
        }
    }
    None
}

fn changed(number: &NumberSlider, now: f64, response: &egui::Response) -> Option<Value> {
    (response.changed() && now != number.value).then_some(Value::Number(now))
}

fn slider(ui: &mut Ui, number: &NumberSlider) -> Option<Value> {
    let row = ui.horizontal(|ui| {
        label(ui, t(number.title), 80.0);
        ui.spacing_mut().slider_width = 60.0;
        let mut now = number.value;
        let [low, high] = number.range;
        let slider = egui::Slider::new(&mut now, low..=high).max_decimals(number.decimals);
        let slider = if number.decimals == 0 {
            slider.integer()
        } else {
            slider
        };
        let response = ui.add(slider).accessible_name(t(number.label));
        changed(number, now, &response)
    });
    row.inner
}

fn wide_slider(ui: &mut Ui, number: &NumberSlider) -> Option<Value> {
    let row = ui.horizontal(|ui| {
        ui.label(egui::RichText::new(t(number.title)).color(theme::text_weak()));
        let mut now = number.value;
        let [low, high] = number.range;
        let slider = egui::Slider::new(&mut now, low..=high)
            .logarithmic(number.logarithmic)
            .suffix(number.unit);
        let slider = match number.decimals {
            0 => slider.integer(),
            decimals => slider.fixed_decimals(decimals),
        };
        let response = ui
            .add(slider)
            .on_hover_text(t(number.hint))
            .accessible_name(t(number.label));
        changed(number, now, &response)
    });
    row.inner
}

/// Choices in a drop-down list, on a line of their own if they have no title.
fn list_of(ui: &mut Ui, title: &str, name: &str, chosen: usize, choices: &[(String, &str)]) -> Option<Value> {
    let shown = choices.get(chosen).map_or("", |c| t(&c.0));
    let mut now = chosen;
    let mut combo = |ui: &mut Ui, width: f32| {
        egui::ComboBox::from_id_salt(name)
            .width(width)
            .selected_text(shown)
            .show_ui(ui, |ui| {
                for (i, (text, hint)) in choices.iter().enumerate() {
                    let row = ui.selectable_value(&mut now, i, t(text));
                    if !hint.is_empty() {
                        row.on_hover_text(t(hint));
                    }
                }
            })
            .response
            .widget_info(|| egui::WidgetInfo::labeled(Role::ComboBox, true, t(name)));
    };
    if title.is_empty() {
        let width = ui.available_width() - 8.0;
        combo(ui, width);
    } else {
        ui.horizontal(|ui| {
            label(ui, t(title), 52.0);
            combo(ui, 120.0);
        });
    }
    (now != chosen).then_some(Value::Index(now))
}

/// Choices in a drop-down list with a caption; returns true if another was chosen.
pub fn list<T: Copy + PartialEq>(
    ui: &mut Ui,
    title: &str,
    chosen: &mut T,
    choices: &[(T, &str, &str)],
) -> bool {
    let index = choices.iter().position(|c| c.0 == *chosen).unwrap_or(0);
    let names: Vec<(String, &str)> = choices.iter().map(|c| (c.1.to_owned(), c.2)).collect();
    let now = list_of(ui, title, title, index, &names).and_then(Value::index);
    if let Some(choice) = now.and_then(|i| choices.get(i)) {
        *chosen = choice.0;
    }
    now.is_some()
}

/// Classes in two columns, one of them chosen. Returns the class that was clicked.
fn class(ui: &mut Ui, shown: &[Class], chosen: Class, verb: &str) -> Option<Class> {
    let gap = 4.0;
    let width = (ui.available_width() - gap) / 2.0;
    let mut taken = None;
    ui.spacing_mut().item_spacing = egui::vec2(gap, 2.0);
    for pair in shown.chunks(2) {
        ui.horizontal(|ui| {
            for class in pair {
                let label = class.label();
                let short = match class {
                    Class::ConstructionVehicle => t("Digger, crane").to_owned(),
                    Class::DriveableSurface => t("Driveable").to_owned(),
                    _ => theme::sentence(t(&label)),
                };
                let size = egui::vec2(width, theme::ROW);
                ui.allocate_ui(size, |ui| {
                    let color = theme::class_color(*class);
                    let name = tf!("{verb} {name}", verb = t(verb), name = t(&label));
                    if icons::row(ui, color, &short, "", chosen == *class, &name).clicked() {
                        taken = Some(*class);
                    }
                });
            }
        });
    }
    taken
}
