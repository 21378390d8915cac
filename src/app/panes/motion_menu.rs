//! The menu that gives the chosen object, or the ego vehicle, a motion.

use egui::{DragValue, Ui};

use scene::{BoxId, Class, Scene};

use crate::command::{Command, TimeCommand};
use crate::state::UiState;
use crate::state::called;
use editor::Edit;
use editor::traffic::{Template, Wish};
use language::{t, tf};
use widgets::theme;

/// The button and its menu.
pub(super) fn menu(ui: &mut Ui, scene: &Scene, state: &UiState, commands: &mut Vec<Command>) {
    let id = state.selected.filter(|id| scene.frame().boxes.contains_key(id));
    let chosen = id.and_then(|id| scene.frame().boxes.get(&id));
    let title = match chosen {
        Some(b) => tf!("Motion of {object} {number}", object = called(b), number = b.id.0),
        None => t("Motion of the ego vehicle").to_owned(),
    };
    let button = widgets::menu::with_fields(ui, format!("{title}…"), |ui| {
        ui.set_min_width(240.0);
        motions(ui, scene, (id, chosen.map(|b| b.class)), commands);
    });
    button.on_hover_text(t("How it moves from now on; choose an object for its motion"));
}

/// The motions that a box, or the ego vehicle (`None`), can be given.
pub(super) fn motions(
    ui: &mut Ui,
    scene: &Scene,
    (id, class): (Option<BoxId>, Option<Class>),
    commands: &mut Vec<Command>,
) {
    let wish_id = ui.scope_id().with("wish");
    let usual = Wish::usual(Template::Drive, class);
    let kept: Option<(Option<Class>, [f64; 2])> = ui.data(|d| d.get_temp(wish_id));
    let [mut kmh, mut at_s] = kept.filter(|(of, _)| *of == class).map_or(
        [usual.mps * 3.6, scene.time_s().max(usual.at_s)],
        |(_, values)| values,
    );
    egui::Grid::new("wish").num_columns(2).show(ui, |ui| {
        ui.label(t("Speed"));
        ui.add(
            DragValue::new(&mut kmh)
                .range(0.0..=360.0)
                .speed(0.5)
                .suffix(" km/h"),
        );
        ui.end_row();
    });
    let (timed, steady): (Vec<_>, Vec<_>) = Template::ALL.iter().partition(|t| t.has_a_moment());
    let mut chosen = None;
    let mut choices = |ui: &mut Ui, templates: Vec<Template>| {
        for template in templates {
            let button = ui.button(t(template.title())).on_hover_text(t(template.hint()));
            if button.clicked() {
                chosen = Some(template);
            }
        }
    };
    choices(ui, steady);
    ui.separator();
    ui.horizontal(|ui| {
        ui.label(t("At second"));
        let value = DragValue::new(&mut at_s)
            .range(0.0..=600.0)
            .speed(0.1)
            .fixed_decimals(1);
        ui.add(value).on_hover_text(t("When the motions below begin"));
    });
    choices(ui, timed);
    ui.data_mut(|d| d.insert_temp(wish_id, (class, [kmh, at_s])));
    if let Some(template) = chosen {
        let wish = Wish {
            template,
            mps: kmh / 3.6,
            at_s,
            ..usual
        };
        commands.push(Command::Time(TimeCommand::Motion(id, wish)));
        ui.close();
    }
    ui.separator();
    let moves = scene.clip().motion(id).is_some();
    let still = ui
        .add_enabled(moves, egui::Button::new(t("Stand still here")))
        .on_hover_text(t("It stands where it is at this moment, for the whole scene"));
    if still.clicked() {
        let edit = Edit::SetMotion {
            id,
            motion: None,
            from_s: None,
            to_s: None,
        };
        commands.push(Command::Apply("Stand still", vec![edit]));
        ui.close();
    }
    ui.label(
        egui::RichText::new(t("Undo takes it back."))
            .small()
            .color(theme::text_weak()),
    );
}
