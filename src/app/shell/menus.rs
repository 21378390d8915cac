//! The menus in the bar at the top.

use egui::{Rect, Ui, Vec2, pos2};

use super::bookmarks::SLOTS;
use super::toolbar::{ToolbarInput, beside, item, short};
use crate::command::{Command, FileCommand, GenerationCommand, ViewCommand, Window};
use crate::panes;
use crate::panes::id::PaneId;
use crate::tools::things::ThingCommand;
use crate::tools::{Hand, ToolCommand};
use language::{t, tf};
use scene::Arrangement;
use viewport::ViewPreset;
use widgets::theme;

/// Function that pushes a command if its entry was clicked.
type On<'a> = dyn FnMut(bool, Command) + 'a;

/// Draws the menus, side by side or folded into one.
pub(super) fn menus(
    ui: &mut Ui,
    input: &ToolbarInput<'_>,
    hand: &Hand,
    folded: bool,
    commands: &mut Vec<Command>,
) {
    if folded {
        ui.menu_button(t("Menu"), |ui| menus(ui, input, hand, false, commands));
        return;
    }
    let on = &mut |clicked: bool, command: Command| {
        if clicked {
            commands.push(command);
        }
    };
    ui.menu_button(t("File"), |ui| file_menu(ui, input, on));
    ui.menu_button(t("Edit"), |ui| edit_menu(ui, input, hand, on));
    ui.menu_button(t("View"), |ui| view_menu(ui, input, hand, on));
    ui.menu_button(t("Generate"), |ui| generate_menu(ui, input, on));
    ui.menu_button(t("Help"), |ui| help_menu(ui, on));
}

fn file_menu(ui: &mut Ui, input: &ToolbarInput<'_>, on: &mut On<'_>) {
    on(
        item(ui, t("New scene"), "Ctrl+N", true),
        Command::File(FileCommand::New),
    );
    on(
        item(ui, t("Open…"), "Ctrl+O", true),
        Command::File(FileCommand::Open),
    );
    ui.add_enabled_ui(!input.recent.is_empty(), |ui| {
        ui.menu_button(t("Open recent"), |ui| {
            for path in input.recent {
                let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
                let clicked = ui
                    .button(name)
                    .on_hover_text(path.display().to_string())
                    .clicked();
                on(clicked, Command::File(FileCommand::OpenPath(path.clone())));
            }
        });
    });
    ui.separator();
    on(
        item(ui, t("Save"), "Ctrl+S", true),
        Command::File(FileCommand::Save),
    );
    on(
        item(ui, t("Save as…"), "Ctrl+Shift+S", true),
        Command::File(FileCommand::SaveAs),
    );
    ui.separator();
    on(
        item(ui, t("Place a model…"), "", true),
        Command::File(FileCommand::PlaceModel),
    );
    ui.separator();
    on(
        item(ui, t("Export…"), "Ctrl+E", true),
        Command::Toggle(Window::Export),
    );
    on(
        item(ui, t("Batches…"), "Ctrl+B", true),
        Command::Toggle(Window::Batches),
    );
    on(
        item(ui, t("Quick screenshot"), "F12", true),
        Command::File(FileCommand::QuickShot),
    );
    on(
        item(ui, t("Pictures…"), "Ctrl+Shift+P", true),
        Command::Toggle(Window::Capture),
    );
    on(
        item(ui, t("Save clip…"), "", true),
        Command::File(FileCommand::SaveClip),
    );
    ui.separator();
    on(
        item(ui, t("Quit"), "Ctrl+Q", true),
        Command::File(FileCommand::Quit),
    );
}

fn edit_menu(ui: &mut Ui, input: &ToolbarInput<'_>, hand: &Hand, on: &mut On<'_>) {
    on(item(ui, t("Undo"), "Ctrl+Z", input.undo.is_some()), Command::Undo);
    on(
        item(ui, t("Redo"), "Ctrl+Shift+Z", input.redo.is_some()),
        Command::Redo,
    );
    ui.separator();
    let some = hand.any_chosen();
    let (duplicate, delete) = match (hand.selected.is_some(), hand.things.chosen.len()) {
        (true, 0) | (false, 0) => (t("Duplicate box"), t("Delete box")),
        (false, 1) => (t("Duplicate thing"), t("Delete thing")),
        (false, _) => (t("Duplicate things"), t("Delete things")),
        (true, _) => (t("Duplicate selection"), t("Delete selection")),
    };
    on(
        item(ui, duplicate, "Ctrl+D", some),
        Command::Tools(ToolCommand::Duplicate),
    );
    on(item(ui, delete, "Del", some), Command::Tools(ToolCommand::Delete));
    ui.separator();
    let boxes = hand.selected.is_some();
    let tool = |command| Command::Tools(command);
    let has_copied = !hand.clipboard.boxes.is_empty() || !hand.things.clipboard.is_empty();
    on(item(ui, t("Cut"), "Ctrl+X", some), tool(ToolCommand::Cut));
    on(item(ui, t("Copy"), "Ctrl+C", some), tool(ToolCommand::Copy));
    on(
        item(ui, t("Paste"), "Ctrl+V", has_copied),
        tool(ToolCommand::Paste),
    );
    on(
        item(ui, t("Row of copies"), "Ctrl+Shift+D", boxes),
        tool(ToolCommand::AskRow),
    );
    on(
        item(ui, t("Mirror about the ego axis"), "Ctrl+M", boxes),
        tool(ToolCommand::Mirror(false)),
    );
    on(
        item(ui, t("Mirrored copies"), "", boxes),
        tool(ToolCommand::Mirror(true)),
    );
    ui.separator();
    on(
        item(ui, t("Select all boxes"), "Ctrl+A", true),
        tool(ToolCommand::ChooseAll),
    );
    on(
        item(ui, t("Invert the selection"), "Ctrl+I", true),
        tool(ToolCommand::ChooseOthers),
    );
    let arrangements = [
        (
            "Group",
            "Ctrl+G",
            Arrangement::Group {
                name: Default::default(),
            },
        ),
        ("Ungroup", "Ctrl+Shift+G", Arrangement::Ungroup),
        ("Hide what is chosen", "Ctrl+H", Arrangement::Hide),
        ("Lock what is chosen", "Ctrl+L", Arrangement::Lock),
    ];
    for (name, keys, how) in arrangements {
        on(item(ui, t(name), keys, some), tool(ToolCommand::Arrange(how)));
    }
    on(
        item(ui, t("Show all that is hidden"), "Ctrl+Shift+H", true),
        tool(ToolCommand::ShowAll),
    );
    on(
        item(ui, t("Unlock everything"), "Ctrl+Shift+L", true),
        tool(ToolCommand::UnlockAll),
    );
    ui.separator();
    on(
        item(ui, t("Shape from a model…"), "", hand.selected.is_some()),
        Command::File(FileCommand::ShapeOfChosen),
    );
    let thing = |command| Command::Tools(ToolCommand::Thing(command));
    let things = !hand.things.chosen.is_empty();
    on(
        item(ui, t("Raise things"), "]", things),
        thing(ThingCommand::Raise(1)),
    );
    on(
        item(ui, t("Lower things"), "[", things),
        thing(ThingCommand::Raise(-1)),
    );
    on(
        item(ui, t("Things to the kerb"), "D", things),
        Command::Tools(ToolCommand::ToLane),
    );
    ui.menu_button(t("Add beside the road"), |ui| {
        for tool in beside() {
            on(
                item(ui, t(tool.title), short(tool.key), true),
                Command::Tool(tool.id),
            );
        }
    });
    ui.separator();
    on(
        item(ui, t("Unlock painted voxels"), "", input.has_paint),
        Command::ClearPaint,
    );
}

fn view_menu(ui: &mut Ui, input: &ToolbarInput<'_>, hand: &Hand, on: &mut On<'_>) {
    on(
        item(ui, t("Frame all"), "Home", true),
        Command::View(ViewCommand::FrameAll),
    );
    on(
        item(ui, t("Frame selection"), "F", hand.any_chosen()),
        Command::View(ViewCommand::FrameSelection),
    );
    ui.separator();
    for preset in ViewPreset::ALL {
        let name = tf!("3D: {view}", view = theme::sentence(t(preset.name())));
        let key = match preset {
            ViewPreset::Perspective => "5",
            ViewPreset::Top => "7",
            ViewPreset::Front => "1",
            ViewPreset::Side => "3",
            ViewPreset::Back | ViewPreset::Left => "",
            ViewPreset::Ego => "0",
        };
        on(
            item(ui, &name, key, true),
            Command::View(ViewCommand::Preset(preset)),
        );
    }
    on(
        item(ui, t("3D: Orthographic from here"), "9", true),
        Command::View(ViewCommand::ToggleParallel),
    );
    on(
        item(ui, t("3D: Voxels or pictures"), "8", true),
        Command::View(ViewCommand::ToggleLook),
    );
    ui.separator();
    on(
        item(ui, t("Compare: off, wipe, side, difference"), "Shift+\\", true),
        Command::View(ViewCommand::CycleCompare),
    );
    ui.separator();
    ui.menu_button(t("Panes"), |ui| {
        ui.set_min_width(190.0);
        for pane in panes::infos() {
            if pane.id.camera().is_some_and(|i| i >= input.cameras) {
                continue;
            }
            let mut shown = input.shown.contains(&pane.id);
            let title = match pane.id.camera() {
                Some(i) => tf!("Camera {n}", n = i + 1),
                None => t(&pane.title).to_owned(),
            };
            let tick = ui.checkbox(&mut shown, title);
            let right = ui.max_rect().right();
            let square = Rect::from_center_size(pos2(right - 10.0, tick.rect.center().y), Vec2::splat(16.0));
            pane.icon.paint(ui, square, theme::text_weak());
            on(tick.changed(), Command::View(ViewCommand::TogglePane(pane.id)));
        }
    });
    ui.menu_button(t("Kept views"), |ui| {
        for slot in SLOTS {
            let kept = input.bookmarks.contains(&slot);
            let (name, keys) = (tf!("Go to view {n}", n = slot), format!("F{slot}"));
            on(
                item(ui, &name, &keys, kept),
                Command::View(ViewCommand::GoToBookmark(slot)),
            );
        }
        ui.separator();
        for slot in SLOTS {
            let (name, keys) = (tf!("Keep as view {n}", n = slot), format!("Ctrl+F{slot}"));
            on(
                item(ui, &name, &keys, true),
                Command::View(ViewCommand::KeepBookmark(slot)),
            );
        }
    });
    on(
        item(ui, t("Swap views"), "Ctrl+Tab", true),
        Command::View(ViewCommand::SwapPanes),
    );
    on(
        item(ui, t("Nothing but the scene in the views"), "`", true),
        Command::View(ViewCommand::ToggleClean),
    );
    on(
        item(ui, t("Full screen"), "F11", true),
        Command::View(ViewCommand::ToggleFullScreen),
    );
    on(
        item(ui, t("Grid"), "G", true),
        Command::View(ViewCommand::ToggleGrid),
    );
    on(
        item(ui, t("Sensors…"), "", true),
        Command::Toggle(Window::Sensors),
    );
    on(
        item(ui, t("Checks"), "", true),
        Command::View(ViewCommand::TogglePane(PaneId::CHECKS)),
    );
    on(item(ui, t("Log"), "", true), Command::Toggle(Window::Log));
    on(
        item(ui, t("Performance"), "F10", true),
        Command::Toggle(Window::Performance),
    );
}

fn generate_menu(ui: &mut Ui, input: &ToolbarInput<'_>, on: &mut On<'_>) {
    on(
        item(ui, t("Generate everything"), "Ctrl+Enter", true),
        Command::Generation(GenerationCommand::Generate { full: true }),
    );
    on(
        item(ui, t("Generate edited region"), "", true),
        Command::Generation(GenerationCommand::Generate { full: false }),
    );
    on(
        item(ui, t("Regenerate scenery"), "", true),
        Command::Generation(GenerationCommand::DrawScenery),
    );
    on(
        item(ui, t("Cancel"), "Ctrl+Backspace", input.busy),
        Command::Generation(GenerationCommand::Cancel {
            running: true,
            waiting: false,
        }),
    );
    on(
        item(ui, t("Drop the edit that waits"), "", input.waiting),
        Command::Generation(GenerationCommand::Cancel {
            running: false,
            waiting: true,
        }),
    );
    on(
        item(
            ui,
            t("Cancel all"),
            "Ctrl+Shift+Backspace",
            input.busy || input.waiting,
        ),
        Command::Generation(GenerationCommand::Cancel {
            running: true,
            waiting: true,
        }),
    );
    ui.separator();
    on(
        item(ui, t("Keep this state as a version"), "", true),
        Command::Generation(GenerationCommand::KeepVersion),
    );
    let live = if input.live {
        t("Switch live off")
    } else {
        t("Switch live on")
    };
    on(
        item(ui, live, "Ctrl+Space", true),
        Command::Generation(GenerationCommand::ToggleLive),
    );
}

fn help_menu(ui: &mut Ui, on: &mut On<'_>) {
    on(
        item(ui, t("Find a command…"), "Ctrl+K", true),
        Command::Toggle(Window::Palette),
    );
    on(item(ui, t("Keys"), "?", true), Command::Toggle(Window::Keys));
    on(
        item(ui, t("Start screen"), "", true),
        Command::Toggle(Window::Start),
    );
    on(item(ui, t("Tour in three steps"), "", true), Command::BeginTour);
    ui.separator();
    on(
        item(ui, t("Settings…"), "Ctrl+,", true),
        Command::Toggle(Window::Settings),
    );
}
