//! Name and paint of the chosen boxes.

use egui::{Color32, Ui};

use crate::command::Command;
use crate::fields::caption;
use editor::Edit;
use language::t;
use scene::{BoxLabel, BoxName, Paint, SceneBox};
use widgets::icons;
use widgets::theme;

/// A field for the name and a list of paints. A change applies to all of the boxes.
pub fn label_ui(ui: &mut Ui, boxes: &[SceneBox], commands: &mut Vec<Command>) {
    let Some(first) = boxes.first() else {
        return;
    };
    let same = |of: &dyn Fn(&SceneBox) -> BoxLabel| boxes.iter().all(|b| of(b) == of(first));
    let one_name = same(&|b| BoxLabel {
        paint: None,
        ..b.label
    });
    let one_paint = same(&|b| BoxLabel {
        name: BoxName::default(),
        ..b.label
    });
    let apply = |step, new: &dyn Fn(BoxLabel) -> BoxLabel| {
        let edits = boxes.iter().filter(|b| new(b.label) != b.label);
        let edits: Vec<Edit> = edits
            .map(|b| Edit::LabelBox {
                id: b.id,
                label: new(b.label),
            })
            .collect();
        (!edits.is_empty()).then_some(Command::Apply(step, edits))
    };
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 3.0;
        caption(ui, t("Name"));
        let room = ui.available_width();
        let name = if one_name { first.label.name.as_str() } else { "" };
        if let Some(name) = name_field(ui, first, name, (room * 0.56).clamp(60.0, 150.0)) {
            commands.extend(apply("Name box", &|label| BoxLabel { name, ..label }));
        }
        let mut paint = first.label.paint;
        let shown = match (one_paint, paint) {
            (false, _) => t("Several").to_owned(),
            (true, None) => t("Any paint").to_owned(),
            (true, Some(paint)) => theme::sentence(t(paint.name())),
        };
        if one_paint && let Some(paint) = paint {
            let (rect, _) = ui.allocate_exact_size(egui::vec2(14.0, theme::ROW), egui::Sense::hover());
            icons::swatch(ui, rect.center(), 12.0, color(paint));
        }
        let before = paint;
        let combo = egui::ComboBox::from_id_salt("paint")
            .width(ui.available_width().clamp(48.0, 110.0))
            .height(400.0)
            .truncate()
            .selected_text(shown);
        let mut picked = false;
        combo
            .show_ui(ui, |ui| {
                picked |= ui.selectable_value(&mut paint, None, t("Any paint")).clicked();
                for other in Paint::ALL {
                    ui.horizontal(|ui| {
                        let (rect, _) =
                            ui.allocate_exact_size(egui::vec2(14.0, theme::ROW), egui::Sense::hover());
                        icons::swatch(ui, rect.center(), 12.0, color(other));
                        let name = theme::sentence(t(other.name()));
                        picked |= ui.selectable_value(&mut paint, Some(other), name).clicked();
                    });
                }
            })
            .response
            .on_hover_text(t("Colour in camera pictures; words find the box by it"))
            .accessible_name(t("Paint"));
        if paint != before || picked && !one_paint {
            commands.extend(apply("Paint box", &|label| BoxLabel { paint, ..label }));
        }
    });
}

/// Field for a name. Returns the name when typing ends: with Enter or when the focus leaves.
fn name_field(ui: &mut Ui, b: &SceneBox, name: &str, width: f32) -> Option<BoxName> {
    let memory = egui::Id::unique(("name of a box", b.id));
    let typed: Option<String> = ui.data(|d| d.get_temp(memory));
    let mut text = typed.clone().unwrap_or_else(|| name.to_owned());
    let field = egui::TextEdit::singleline(&mut text)
        .hint_text(t(&b.class.label()).to_owned())
        .char_limit(BoxName::MOST_BYTES)
        .desired_width(width);
    let field = ui
        .add_sized([width, theme::ROW], field)
        .on_hover_text(t("What words call it: “taxi”, “the crashed van”"))
        .accessible_name(t("Name"));
    if field.changed() {
        ui.data_mut(|d| d.insert_temp(memory, text));
        return None;
    }
    let left = field.lost_focus() && typed.is_some();
    if left {
        ui.data_mut(|d| d.remove_temp::<String>(memory));
    }
    let dropped = left && ui.input(|i| i.key_pressed(egui::Key::Escape));
    (left && !dropped).then(|| BoxName::new(&text))
}

fn color(paint: Paint) -> Color32 {
    let [r, g, b] = paint.srgb();
    Color32::from_rgb(r, g, b)
}
