//! Rows of the list of objects: groups that fold, the boxes in them, and the boxes without a group.

use std::collections::BTreeSet;

use egui::Ui;

use language::{t, tf};

use super::tools::{eye, lock};
use crate::arranging;
use crate::command::{Command, ViewCommand};
use crate::state::UiState;
use crate::tools::{Choose, ToolCommand};
use scene::{Arranged, Arrangement, Members, ObjectGroup, Scene, SceneBox};
use widgets::icons;
use widgets::theme;

/// A row of the list.
pub(super) enum ObjectListRow<'a> {
    /// A group with its index.
    Group(usize, &'a ObjectGroup),
    /// A box; true if it belongs to the group above.
    Box(&'a SceneBox, bool),
}

fn folded_id() -> egui::Id {
    egui::Id::unique("folded groups")
}

/// Rows of the list: first the groups, each with its listed boxes, then the other boxes.
pub(super) fn rows<'a>(ui: &Ui, arranged: &'a Arranged, boxes: &[&'a SceneBox]) -> Vec<ObjectListRow<'a>> {
    let folded: BTreeSet<usize> = ui.data(|d| d.get_temp(folded_id())).unwrap_or_default();
    let mut out = Vec::with_capacity(boxes.len() + arranged.groups.len());
    for (i, group) in arranged.groups.iter().enumerate() {
        let inside: Vec<_> = boxes
            .iter()
            .filter(|b| group.members.boxes.contains(&b.id))
            .collect();
        if inside.is_empty() && !group.members.boxes.is_empty() {
            continue;
        }
        out.push(ObjectListRow::Group(i, group));
        if !folded.contains(&i) {
            out.extend(inside.into_iter().map(|b| ObjectListRow::Box(b, true)));
        }
    }
    let free = boxes.iter().filter(|b| arranged.group_of_box(b.id).is_none());
    out.extend(free.map(|b| ObjectListRow::Box(b, false)));
    out
}

/// Draws the eye and the lock of a row, at its right end; `name` is the name of the row's object.
pub(super) fn switches(
    ui: &mut Ui,
    members: &Members,
    arranged: &Arranged,
    name: &str,
    commands: &mut Vec<Command>,
) {
    let (shown, locked) = (
        !members.is_within(&arranged.hidden),
        members.is_within(&arranged.locked),
    );
    let mut send = |how: Arrangement| {
        let edits = vec![arranging::arranging(members, how.clone())];
        commands.push(Command::Apply(arranging::label(&how), edits));
    };
    let lock_hint = match locked {
        true => t("Locked: edits leave it as it is. Click unlocks it."),
        false => t("Lock: edits leave it as it is"),
    };
    if lock(ui, locked, &tf!("Lock {name}", name = name))
        .on_hover_text(lock_hint)
        .clicked()
    {
        send(if locked {
            Arrangement::Unlock
        } else {
            Arrangement::Lock
        });
    }
    let eye_hint = match shown {
        true => t("Hide in the large views; sensors go on seeing it"),
        false => t("Hidden in the large views. Click shows it."),
    };
    if eye(ui, shown, &tf!("Show {name}", name = name))
        .on_hover_text(eye_hint)
        .clicked()
    {
        send(if shown {
            Arrangement::Hide
        } else {
            Arrangement::Show
        });
    }
}

/// Width of the eye and the lock of a row, points.
pub(super) const SWITCHES: f32 = 16.0 + theme::ROW;

/// The name of a group: its own, or one with the number of its members.
pub(super) fn title(group: &ObjectGroup) -> String {
    match group.name.is_empty() {
        true => tf!("Group of {n}", n = group.members.len()),
        false => group.name.as_str().to_owned(),
    }
}

/// Draws the row of a group.
pub(super) fn group_ui(
    ui: &mut Ui,
    (i, group): (usize, &ObjectGroup),
    scene: &Scene,
    state: &UiState,
    commands: &mut Vec<Command>,
) {
    let name = title(group);
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 0.0;
        let mut folded: BTreeSet<usize> = ui.data(|d| d.get_temp(folded_id())).unwrap_or_default();
        if super::thing_list::fold(ui, !folded.contains(&i), &name).clicked() {
            if !folded.remove(&i) {
                folded.insert(i);
            }
            ui.data_mut(|d| d.insert_temp(folded_id(), folded));
        }
        let chosen = Members::of(state.chosen(), state.tools.things.chosen.iter().copied());
        let count = group.members.len().to_string();
        let room = (ui.available_width() - SWITCHES).max(40.0);
        let label = tf!("Group {name}", name = &name);
        let row = ui
            .allocate_ui(egui::vec2(room, theme::ROW), |ui| {
                icons::row(
                    ui,
                    theme::text_weak(),
                    &name,
                    &count,
                    group.members.is_within(&chosen),
                    &label,
                )
            })
            .inner;
        if row.clicked() {
            let boxes = group.members.boxes.iter().copied().collect();
            let how = match ui.input(|i| i.modifiers.shift || i.modifiers.command) {
                true => Choose::Add,
                false => Choose::Only,
            };
            let things = group.members.things.iter().copied().collect();
            let things = crate::tools::things::ThingCommand::Choose(things, Choose::Add);
            commands.push(Command::Tools(ToolCommand::Choose(boxes, how)));
            commands.push(Command::Tools(ToolCommand::Thing(things)));
        }
        if row.double_clicked() {
            commands.push(Command::View(ViewCommand::FrameSelection));
        }
        menu(&row, group, commands);
        switches(ui, &group.members, &scene.arranged, &name, commands);
    });
}

/// Draws the menu of a right click on a group.
fn menu(row: &egui::Response, group: &ObjectGroup, commands: &mut Vec<Command>) {
    widgets::menu::on_right_click(row, |ui| {
        let memory = row.id.with("name of the group");
        let mut text: String = ui
            .data(|d| d.get_temp(memory))
            .unwrap_or_else(|| group.name.as_str().to_owned());
        ui.horizontal(|ui| {
            ui.label(t("Name"));
            let field = egui::TextEdit::singleline(&mut text).char_limit(scene::BoxName::MOST_BYTES);
            let field = ui.add(field.desired_width(120.0)).accessible_name(t("Name"));
            ui.data_mut(|d| d.insert_temp(memory, text.clone()));
            if field.lost_focus() && ui.input(|i| i.key_pressed(egui::Key::Enter)) {
                let name = scene::BoxName::new(&text);
                let edits = vec![arranging::arranging(&group.members, Arrangement::Group { name })];
                commands.push(Command::Apply("Name group", edits));
                ui.data_mut(|d| d.remove_temp::<String>(memory));
                ui.close();
            }
        });
        if ui.button(t("Ungroup")).clicked() {
            let edits = vec![arranging::arranging(&group.members, Arrangement::Ungroup)];
            commands.push(Command::Apply("Ungroup", edits));
            ui.close();
        }
    });
}
