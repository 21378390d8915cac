//! Options of the tools for things, at the top of the left panel.

use egui::Ui;

use crate::state::UiState;
use crate::theme;
use crate::tools::panel::slider;
use crate::widgets::hint::caption;
use crate::widgets::icons::{self, section};
use scene::background::{Facade, LineKind, PostKind, Roof, TreeKind};

use super::{ThingState, ThingTool};

/// Names of roofs.
pub const ROOFS: [(Roof, &str, &str); 3] = [
    (Roof::Flat, "Flat", ""),
    (Roof::Gabled, "Gabled", "four corners only"),
    (Roof::Hipped, "Hipped", "four corners only"),
];
/// Names of facades.
pub const FACADES: [(Facade, &str, &str); 5] = [
    (Facade::Plain, "Plain", ""),
    (Facade::Balconies, "Balconies", ""),
    (Facade::Bays, "Bays", ""),
    (
        Facade::Arcade,
        "Arcade",
        "a ground floor behind columns; four corners only",
    ),
    (Facade::Glass, "Glass", "mirrors a LiDAR's pulses at a slant"),
];
/// Names of trees.
pub const TREES: [(TreeKind, &str, &str); 4] = [
    (TreeKind::Broadleaf, "Broadleaf", ""),
    (TreeKind::Conifer, "Conifer", ""),
    (TreeKind::Columnar, "Columnar", ""),
    (TreeKind::Bare, "Bare", "without leaves"),
];

/// Draws the options of a tool.
pub fn options(ui: &mut Ui, tool: ThingTool, state: &mut UiState) {
    let things = &mut state.tools.things;
    match tool {
        ThingTool::Building => {
            section(ui, "Building");
            caption(
                ui,
                "Drag a rectangle along the road, or click corners: Enter or a double click closes.",
            );
            slider(ui, "Storeys", &mut things.storeys, 1..=25);
            ui.add_space(2.0);
            icons::segments(ui, &mut things.roof, &ROOFS);
            ui.add_space(2.0);
            list(ui, "Facade", &mut things.facade, &FACADES);
        }
        ThingTool::Tree => {
            section(ui, "Tree");
            caption(ui, "Click stamps one, a drag scatters them beside the road.");
            segments_by_two(ui, &mut things.tree, &TREES);
            slider(ui, "Height, m", &mut things.tree_m, 1.0..=25.0);
            slider(ui, "Spacing, m", &mut things.spacing_m, 1.5..=20.0);
        }
        ThingTool::Line => line(ui, things),
        ThingTool::Shrubs => {
            section(ui, "Shrubs");
            caption(ui, "A stroke becomes an area of shrubs.");
            slider(ui, "Height, m", &mut things.shrubs_m, 0.3..=4.0);
            slider(ui, "Brush, m", &mut state.brush_m, UiState::BRUSH_M);
        }
        ThingTool::Post => {
            section(ui, "Post");
            caption(ui, "Click puts one down facing the road, a drag turns it.");
            for kind in PostKind::ALL {
                kind_row(ui, &mut things.post, kind, kind.name(), "Place");
            }
        }
    }
}

fn line(ui: &mut Ui, things: &mut ThingState) {
    section(ui, "Line");
    caption(
        ui,
        "Click points; Enter or a double click ends. Points near a kerb come to lie beside it, with Alt they do not.",
    );
    let before = things.line;
    for kind in LineKind::ALL {
        kind_row(ui, &mut things.line, kind, kind.name(), "Draw");
    }
    if things.line != before {
        things.take_line(things.line);
    }
    slider(ui, "Height, m", &mut things.line_m, 0.3..=8.0);
}

fn kind_row<T: Copy + PartialEq>(ui: &mut Ui, chosen: &mut T, kind: T, name: &str, verb: &str) {
    let response = icons::row(
        ui,
        theme::text_weak(),
        &theme::sentence(name),
        "",
        *chosen == kind,
        &format!("{verb} {name}"),
    );
    if response.clicked() {
        *chosen = kind;
    }
}

fn segments_by_two<T: Copy + PartialEq>(ui: &mut Ui, chosen: &mut T, choices: &[(T, &str, &str)]) {
    for part in choices.chunks(2) {
        icons::segments(ui, chosen, part);
        ui.add_space(2.0);
    }
}

/// Choices in a list that opens, with a caption; true if another was chosen.
pub fn list<T: Copy + PartialEq>(
    ui: &mut Ui,
    title: &str,
    chosen: &mut T,
    choices: &[(T, &str, &str)],
) -> bool {
    let before = *chosen;
    ui.horizontal(|ui| {
        crate::widgets::fields::caption(ui, title);
        let name = choices.iter().find(|c| c.0 == before).map_or("", |c| c.1);
        egui::ComboBox::from_id_salt(title)
            .selected_text(name)
            .width(120.0)
            .show_ui(ui, |ui| {
                for (value, name, hint) in choices {
                    ui.selectable_value(chosen, *value, *name).on_hover_text(*hint);
                }
            })
            .response
            .widget_info(|| egui::WidgetInfo::labeled(egui::accesskit::Role::ComboBox, true, title));
    });
    *chosen != before
}
