//! The menu of a right click: on the box under the pointer, or on the place.

use egui::{Layout, PointerButton, Popup, PopupKind, Response, SetOpenCommand, Ui};
use glam::DVec2;

use language::{t, tf};

use super::id::PaneId;
use super::motion_menu::motions;
use crate::command::{Command, FileCommand, ViewCommand};
use crate::state::{UiState, called};
use crate::tools::{Choose, ToolCommand};
use editor::Edit;
use editor::tools::{Act, lane_heading};
use scene::{Arrangement, BoxId, Class, Scene, SceneBox};
use widgets::theme;

/// The box and the place under the pointer at a right click.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Under {
    /// The box.
    pub id: Option<BoxId>,
    /// The place on the ground, world frame, m; `None` where the view shows no ground.
    pub at_m: Option<DVec2>,
}

/// Opens the menu of a view at a right click without a drag, and draws it. `under` gives the box and the place at a
/// point.
pub(super) fn of_view(
    ui: &Ui,
    response: &Response,
    (pane, scene, state): (PaneId, &Scene, &mut UiState),
    commands: &mut Vec<Command>,
    under: impl FnOnce(egui::Pos2) -> Under,
) {
    let id = response.id.with("what was under the right button");
    let clicked =
        response.contains_pointer() && ui.input(|i| i.pointer.button_clicked(PointerButton::Secondary));
    if let (true, Some(at)) = (clicked, ui.input(|i| i.pointer.interact_pos())) {
        let under = under(at);
        choose(state, under.id);
        ui.data_mut(|d| d.insert_temp(id, under));
    }
    let set = clicked.then_some(SetOpenCommand::Bool(true));
    let shown = Popup::from_response(response)
        .open_memory(set)
        .at_pointer_fixed()
        .kind(PopupKind::Menu)
        .layout(Layout::top_down_justified(egui::Align::Min))
        .style(egui::containers::menu::menu_style)
        .show(|ui| {
            let under: Under = ui.data(|d| d.get_temp(id)).unwrap_or_default();
            entries(ui, scene, state, under, commands);
        });
    ui.data_mut(|d| d.insert_temp(open_id(pane), shown.is_some()));
}

fn open_id(pane: PaneId) -> egui::Id {
    egui::Id::unique(("a menu is open over", pane))
}

/// Disables a view while its menu is open: the press that closes the menu has no other effect.
pub(super) fn hold(ui: &mut Ui, pane: PaneId) {
    if ui.data(|d| d.get_temp(open_id(pane))).unwrap_or(false) {
        ui.visuals_mut().disabled_alpha = 1.0;
        ui.disable();
    }
}

/// Draws the menu of a row that lists a box.
pub(super) fn of_row(
    response: &Response,
    scene: &Scene,
    state: &mut UiState,
    id: BoxId,
    commands: &mut Vec<Command>,
) {
    if response.secondary_clicked() {
        choose(state, Some(id));
    }
    let under = Under {
        id: Some(id),
        at_m: None,
    };
    response.context_menu(|ui| entries(ui, scene, state, under, commands));
}

/// Chooses the box under the right button, unless it is chosen already.
fn choose(state: &mut UiState, id: Option<BoxId>) {
    if let Some(id) = id.filter(|id| !state.is_chosen(*id)) {
        state.choose(&[id], Choose::Only);
    }
}

fn entries(ui: &mut Ui, scene: &Scene, state: &UiState, under: Under, commands: &mut Vec<Command>) {
    ui.set_min_width(190.0);
    match under.id.and_then(|id| scene.frame().boxes.get(&id)) {
        Some(b) => of_box(ui, scene, state, b, commands),
        None => of_place(ui, scene, state, under.at_m, commands),
    }
}

fn entry(ui: &mut Ui, name: &str, keys: &str, commands: &mut Vec<Command>, command: Command) {
    let keys = egui::RichText::new(keys).color(theme::text_weak());
    if ui.add(egui::Button::new(t(name)).shortcut_text(keys)).clicked() {
        commands.push(command);
        ui.close();
    }
}

fn of_box(ui: &mut Ui, scene: &Scene, state: &UiState, b: &SceneBox, commands: &mut Vec<Command>) {
    let several = state.chosen().len();
    let title = match several {
        0 | 1 => format!("{} #{}", theme::sentence(&called(b)), b.id.0),
        n => tf!("{n} boxes", n = n),
    };
    ui.label(egui::RichText::new(title).color(theme::text_weak()));
    let tools = Command::Tools;
    entry(
        ui,
        "Bring into view",
        "F",
        commands,
        Command::View(ViewCommand::FrameSelection),
    );
    entry(ui, "Duplicate", "Ctrl+D", commands, tools(ToolCommand::Duplicate));
    entry(ui, "Copy", "Ctrl+C", commands, tools(ToolCommand::Copy));
    entry(ui, "Cut", "Ctrl+X", commands, tools(ToolCommand::Cut));
    entry(ui, "Delete", "Del", commands, tools(ToolCommand::Delete));
    ui.separator();
    entry(ui, "Turn around", "Q", commands, tools(ToolCommand::Turn(180.0)));
    entry(ui, "Onto its lane", "D", commands, tools(ToolCommand::ToLane));
    entry(
        ui,
        "Onto the ground",
        "",
        commands,
        tools(ToolCommand::DropToGround),
    );
    entry(ui, "Row of copies…", "", commands, tools(ToolCommand::AskRow));
    ui.separator();
    arranging(ui, scene, state, b, commands);
    if several > 1 {
        return;
    }
    ui.separator();
    widgets::menu::with_fields(ui, t("Let it move"), |ui| {
        ui.set_min_width(220.0);
        motions(ui, scene, (Some(b.id), Some(b.class)), commands);
    });
    ui.menu_button(t("Make it another class"), |ui| {
        for class in Class::OBJECTS.into_iter().filter(|class| *class != b.class) {
            let edits = vec![Edit::SetBoxClass { id: b.id, class }];
            let name = theme::sentence(t(&class.label()));
            entry(ui, &name, "", commands, Command::Apply("Change class", edits));
        }
    });
    entry(
        ui,
        "Shape from a model…",
        "",
        commands,
        Command::File(FileCommand::ShapeOfChosen),
    );
}

/// Entries to group, hide and lock the selection.
fn arranging(ui: &mut Ui, scene: &Scene, state: &UiState, b: &SceneBox, commands: &mut Vec<Command>) {
    let arrange = |how| Command::Tools(ToolCommand::Arrange(how));
    let chosen = state.chosen().len() + state.tools.things.chosen.len();
    if chosen > 1 {
        let name = Default::default();
        entry(
            ui,
            "Group",
            "Ctrl+G",
            commands,
            arrange(Arrangement::Group { name }),
        );
    }
    if scene.arranged.group_of_box(b.id).is_some() {
        entry(
            ui,
            "Ungroup",
            "Ctrl+Shift+G",
            commands,
            arrange(Arrangement::Ungroup),
        );
    }
    entry(ui, "Hide", "Ctrl+H", commands, arrange(Arrangement::Hide));
    match scene.arranged.locked.boxes.contains(&b.id) {
        true => entry(ui, "Unlock", "Ctrl+L", commands, arrange(Arrangement::Unlock)),
        false => entry(ui, "Lock", "Ctrl+L", commands, arrange(Arrangement::Lock)),
    }
}

fn of_place(ui: &mut Ui, scene: &Scene, state: &UiState, at_m: Option<DVec2>, commands: &mut Vec<Command>) {
    let on_map = at_m.filter(|p| scene.frame().extent().column_at(p.x, p.y).is_some());
    if let Some(at_m) = on_map {
        ui.menu_button(t("Add here"), |ui| {
            for class in Class::OBJECTS {
                let yaw_rad = lane_heading(scene.frame(), at_m).unwrap_or(0.0);
                let Some(b) = state.new_box(scene.frame(), class, at_m, yaw_rad) else {
                    continue;
                };
                let name = theme::sentence(t(&class.label()));
                let act = Act::AddBoxes("Add box".into(), vec![b.into()], vec![b.id]);
                entry(ui, &name, "", commands, Command::Tools(ToolCommand::Act(act)));
            }
        });
    }
    if !state.tools.clipboard.boxes.is_empty() || !state.tools.things.clipboard.is_empty() {
        let command = on_map.map_or(ToolCommand::Paste, ToolCommand::PasteAt);
        entry(ui, "Paste", "Ctrl+V", commands, Command::Tools(command));
    }
    entry(
        ui,
        "Place a model…",
        "",
        commands,
        Command::File(FileCommand::PlaceModel),
    );
    ui.separator();
    entry(
        ui,
        "Choose all boxes",
        "Ctrl+A",
        commands,
        Command::Tools(ToolCommand::ChooseAll),
    );
    if let Some(at_m) = at_m {
        let place = at_m.extend(scene.frame().layout.relief.height_m(at_m));
        entry(
            ui,
            "Bring this place into view",
            "",
            commands,
            Command::View(ViewCommand::FrameAt(place)),
        );
    }
    entry(
        ui,
        "Bring everything into view",
        "Home",
        commands,
        Command::View(ViewCommand::FrameAll),
    );
}
