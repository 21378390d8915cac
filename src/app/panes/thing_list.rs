//! Rows for things beside the road in the list of objects: kinds with their counts, each of which unfolds.

use std::collections::BTreeMap;

use egui::Ui;

use language::{t, tf};

use super::group_list::{SWITCHES, switches};
use crate::command::{Command, ViewCommand};
use crate::tools::things::{ThingCommand, words};
use crate::tools::{Choose, Hand, ToolCommand};
use editor::tools::Act;
use scene::{Background, Members, Scene, Thing, ThingId};
use widgets::icons;
use widgets::theme;

/// A row of the list.
pub enum ThingRow<'a> {
    /// A kind with its things.
    Kind(&'static str, Vec<&'a Thing>),
    /// A thing of an unfolded kind.
    Thing(&'a Thing),
}

/// Rows for all things: kinds in the order of their names, each followed by its things if it is unfolded.
pub fn rows<'a>(background: &'a Background, hand: &Hand) -> Vec<ThingRow<'a>> {
    let mut kinds: BTreeMap<&'static str, Vec<&Thing>> = BTreeMap::new();
    for thing in background.iter() {
        kinds.entry(thing.form.name()).or_default().push(thing);
    }
    let mut out = Vec::new();
    for (name, things) in kinds {
        let unfolded = hand.things.unfolded.contains(name);
        let listed: Vec<&Thing> = if unfolded { things.clone() } else { Vec::new() };
        out.push(ThingRow::Kind(name, things));
        out.extend(listed.into_iter().map(ThingRow::Thing));
    }
    out
}

/// Draws a row.
pub fn row_ui(ui: &mut Ui, row: &ThingRow<'_>, scene: &Scene, hand: &mut Hand, commands: &mut Vec<Command>) {
    let adds = ui.input(|i| i.modifiers.shift || i.modifiers.command);
    let how = match (row, adds) {
        (_, false) => Choose::Only,
        (ThingRow::Kind(..), true) => Choose::Add,
        (ThingRow::Thing(_), true) => Choose::Toggle,
    };
    let (clicked, framed, ids): (bool, bool, Vec<ThingId>) = match row {
        ThingRow::Kind(name, things) => {
            let chosen = &hand.things.chosen;
            let all = things.iter().all(|t| chosen.contains(&t.id));
            let unfolded = hand.things.unfolded.contains(name);
            let response = ui
                .horizontal(|ui| {
                    ui.spacing_mut().item_spacing.x = 0.0;
                    if fold(ui, unfolded, t(&words::plural(name))).clicked() {
                        let kinds = &mut hand.things.unfolded;
                        if !kinds.remove(name) {
                            kinds.insert(name);
                        }
                    }
                    let title = theme::sentence(t(&words::plural(name)));
                    let count = things.len().to_string();
                    let label = tf!("All {things}", things = t(&words::plural(name)));
                    let color = theme::class_color(things[0].form.class());
                    let room = (ui.available_width() - SWITCHES).max(40.0);
                    let row = ui
                        .allocate_ui(egui::vec2(room, theme::ROW), |ui| {
                            icons::row(ui, color, &title, &count, all, &label)
                        })
                        .inner;
                    let them = Members::of([], things.iter().map(|t| t.id));
                    switches(ui, &them, &scene.arranged, &label, commands);
                    row
                })
                .inner
                .on_hover_text(t("Click chooses all of them"));
            let ids = things.iter().map(|t| t.id).collect();
            (response.clicked(), response.double_clicked(), ids)
        }
        ThingRow::Thing(thing) => {
            let at_m = thing.form.middle_m() - scene.frame().world_from_ego.translation_m.truncate();
            let chosen = hand.things.chosen.contains(&thing.id);
            let name = format!("{} #{}", theme::sentence(t(thing.form.name())), thing.id.0);
            let right = tf!(
                "{height} m high   {away} m",
                height = format!("{:.1}", thing.form.height_m()),
                away = format!("{:.0}", at_m.length())
            );
            let label = tf!("Thing {id} {name}", id = thing.id.0, name = t(thing.form.name()));
            let response = ui
                .horizontal(|ui| {
                    ui.add_space(theme::ROW);
                    let color = theme::class_color(thing.form.class());
                    let room = (ui.available_width() - SWITCHES).max(40.0);
                    ui.spacing_mut().item_spacing.x = 0.0;
                    let row = ui
                        .allocate_ui(egui::vec2(room, theme::ROW), |ui| {
                            icons::row(ui, color, &name, &right, chosen, &label)
                        })
                        .inner;
                    let it = Members::of([], [thing.id]);
                    switches(ui, &it, &scene.arranged, &label, commands);
                    row
                })
                .inner;
            (response.clicked(), response.double_clicked(), vec![thing.id])
        }
    };
    if clicked && !hand.things.is_open() {
        let why = t("Scenery is locked or hidden: see the list of layers").to_owned();
        commands.push(Command::Tools(ToolCommand::Act(Act::Note(why))));
    } else if clicked {
        let choose = ThingCommand::Choose(ids, how);
        commands.push(Command::Tools(ToolCommand::Thing(choose)));
    }
    if framed {
        commands.push(Command::View(ViewCommand::FrameSelection));
    }
}

/// A triangle: down if unfolded, else to the right. Returns the response.
pub(super) fn fold(ui: &mut Ui, unfolded: bool, name: &str) -> egui::Response {
    let size = egui::vec2(theme::ROW * 0.8, theme::ROW);
    let (rect, response) = ui.allocate_exact_size(size, egui::Sense::click());
    let label = tf!("List {things}", things = name);
    response.widget_info(|| {
        egui::WidgetInfo::selected(egui::accesskit::Role::CheckBox, true, unfolded, label.as_str())
    });
    let color = match response.hovered() {
        true => theme::text_strong(),
        false => theme::text_weak(),
    };
    let along = if unfolded {
        egui::Vec2::DOWN
    } else {
        egui::Vec2::RIGHT
    } * 4.0;
    let (middle, side) = (rect.center(), along.rot90());
    let points = vec![
        middle + along,
        middle - along * 0.6 + side,
        middle - along * 0.6 - side,
    ];
    ui.painter()
        .add(egui::Shape::convex_polygon(points, color, egui::Stroke::NONE));
    icons::focus_ring(ui, &response, rect);
    response
}
