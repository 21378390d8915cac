//! The menus of the bar at the top.

use egui::{Rect, Ui, Vec2, pos2};

use super::bookmarks::SLOTS;
use super::toolbar::{ToolbarInput, beside, item, short};
use crate::command::{Command, FileCommand, GenerationCommand, ViewCommand, Window};
use crate::panes;
use crate::panes::id::PaneId;
use crate::tools::things::ThingCommand;
use crate::tools::{Hand, ToolCommand};
use viewport::ViewPreset;
use widgets::theme;

/// Takes a command if its entry was clicked.
type On<'a> = dyn FnMut(bool, Command) + 'a;

/// Draws the menus.
pub(super) fn menus(ui: &mut Ui, input: &ToolbarInput<'_>, hand: &Hand, commands: &mut Vec<Command>) {
    let on = &mut |clicked: bool, command: Command| {
        if clicked {
            commands.push(command);
        }
    };
    ui.menu_button("File", |ui| file_menu(ui, input, on));
    ui.menu_button("Edit", |ui| edit_menu(ui, input, hand, on));
    ui.menu_button("View", |ui| view_menu(ui, input, hand, on));
    ui.menu_button("Generate", |ui| generate_menu(ui, input, on));
    ui.menu_button("Help", |ui| help_menu(ui, on));
}

fn file_menu(ui: &mut Ui, input: &ToolbarInput<'_>, on: &mut On<'_>) {
    on(
        item(ui, "New scene", "Ctrl+N", true),
        Command::File(FileCommand::New),
    );
    on(
        item(ui, "Open…", "Ctrl+O", true),
        Command::File(FileCommand::Open),
    );
    ui.add_enabled_ui(!input.recent.is_empty(), |ui| {
        ui.menu_button("Open recent", |ui| {
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
    on(item(ui, "Save", "Ctrl+S", true), Command::File(FileCommand::Save));
    on(
        item(ui, "Save as…", "Ctrl+Shift+S", true),
        Command::File(FileCommand::SaveAs),
    );
    ui.separator();
    on(
        item(ui, "Place a model…", "", true),
        Command::File(FileCommand::PlaceModel),
    );
    ui.separator();
    on(
        item(ui, "Export…", "Ctrl+E", true),
        Command::Toggle(Window::Export),
    );
    on(
        item(ui, "Batches…", "Ctrl+B", true),
        Command::Toggle(Window::Batches),
    );
    on(
        item(ui, "Quick screenshot", "F12", true),
        Command::File(FileCommand::QuickShot),
    );
    on(
        item(ui, "Export screenshot…", "", true),
        Command::File(FileCommand::ExportScreenshot),
    );
    on(
        item(ui, "Save clip…", "", true),
        Command::File(FileCommand::SaveClip),
    );
    ui.separator();
    on(item(ui, "Quit", "Ctrl+Q", true), Command::File(FileCommand::Quit));
}

fn edit_menu(ui: &mut Ui, input: &ToolbarInput<'_>, hand: &Hand, on: &mut On<'_>) {
    on(item(ui, "Undo", "Ctrl+Z", input.undo.is_some()), Command::Undo);
    on(
        item(ui, "Redo", "Ctrl+Shift+Z", input.redo.is_some()),
        Command::Redo,
    );
    ui.separator();
    let some = hand.any_chosen();
    let what = match (hand.selected.is_some(), hand.things.chosen.len()) {
        (true, 0) | (false, 0) => "box",
        (false, 1) => "thing",
        (false, _) => "things",
        (true, _) => "selection",
    };
    on(
        item(ui, &format!("Duplicate {what}"), "Ctrl+D", some),
        Command::Tools(ToolCommand::Duplicate),
    );
    on(
        item(ui, &format!("Delete {what}"), "Del", some),
        Command::Tools(ToolCommand::Delete),
    );
    on(
        item(ui, "Shape from a model…", "", hand.selected.is_some()),
        Command::File(FileCommand::ShapeOfChosen),
    );
    let thing = |command| Command::Tools(ToolCommand::Thing(command));
    let things = !hand.things.chosen.is_empty();
    on(
        item(ui, "Raise things", "]", things),
        thing(ThingCommand::Raise(1)),
    );
    on(
        item(ui, "Lower things", "[", things),
        thing(ThingCommand::Raise(-1)),
    );
    on(
        item(ui, "Things to the kerb", "D", things),
        Command::Tools(ToolCommand::ToLane),
    );
    ui.menu_button("Add beside the road", |ui| {
        for tool in beside() {
            on(
                item(ui, tool.title, short(tool.key), true),
                Command::Tool(tool.id),
            );
        }
    });
    ui.separator();
    on(
        item(ui, "Unlock painted voxels", "", input.has_paint),
        Command::ClearPaint,
    );
}

fn view_menu(ui: &mut Ui, input: &ToolbarInput<'_>, hand: &Hand, on: &mut On<'_>) {
    on(
        item(ui, "Frame all", "Home", true),
        Command::View(ViewCommand::FrameAll),
    );
    on(
        item(ui, "Frame selection", "F", hand.any_chosen()),
        Command::View(ViewCommand::FrameSelection),
    );
    ui.separator();
    for preset in ViewPreset::ALL {
        let name = format!("3D: {}", theme::sentence(preset.name()));
        let key = match preset {
            ViewPreset::Perspective => "5",
            ViewPreset::Top => "7",
            ViewPreset::Front => "1",
            ViewPreset::Side => "3",
            ViewPreset::Ego => "0",
        };
        on(
            item(ui, &name, key, true),
            Command::View(ViewCommand::Preset(preset)),
        );
    }
    ui.separator();
    on(
        item(ui, "Compare: off, wipe, side, difference", "Shift+\\", true),
        Command::View(ViewCommand::CycleCompare),
    );
    ui.separator();
    ui.menu_button("Panes", |ui| {
        ui.set_min_width(190.0);
        for pane in panes::infos() {
            if pane.id.camera().is_some_and(|i| i >= input.cameras) {
                continue;
            }
            let mut shown = input.shown.contains(&pane.id);
            let tick = ui.checkbox(&mut shown, &pane.title);
            let right = ui.max_rect().right();
            let square = Rect::from_center_size(pos2(right - 10.0, tick.rect.center().y), Vec2::splat(16.0));
            pane.icon.paint(ui, square, theme::text_weak());
            on(tick.changed(), Command::View(ViewCommand::TogglePane(pane.id)));
        }
    });
    ui.menu_button("Kept views", |ui| {
        for slot in SLOTS {
            let kept = input.bookmarks.contains(&slot);
            let (name, keys) = (format!("Go to view {slot}"), format!("F{slot}"));
            on(
                item(ui, &name, &keys, kept),
                Command::View(ViewCommand::GoToBookmark(slot)),
            );
        }
        ui.separator();
        for slot in SLOTS {
            let (name, keys) = (format!("Keep as view {slot}"), format!("Ctrl+F{slot}"));
            on(
                item(ui, &name, &keys, true),
                Command::View(ViewCommand::KeepBookmark(slot)),
            );
        }
    });
    on(
        item(ui, "Swap views", "Ctrl+Tab", true),
        Command::View(ViewCommand::SwapPanes),
    );
    on(
        item(ui, "Grid", "G", true),
        Command::View(ViewCommand::ToggleGrid),
    );
    on(item(ui, "Sensors…", "", true), Command::Toggle(Window::Sensors));
    on(
        item(ui, "Checks", "", true),
        Command::View(ViewCommand::TogglePane(PaneId::CHECKS)),
    );
    on(item(ui, "Log", "", true), Command::Toggle(Window::Log));
    on(
        item(ui, "Performance", "F10", true),
        Command::Toggle(Window::Performance),
    );
}

fn generate_menu(ui: &mut Ui, input: &ToolbarInput<'_>, on: &mut On<'_>) {
    on(
        item(ui, "Generate everything", "Ctrl+Enter", true),
        Command::Generation(GenerationCommand::Generate { full: true }),
    );
    on(
        item(ui, "Generate edited region", "", true),
        Command::Generation(GenerationCommand::Generate { full: false }),
    );
    on(
        item(ui, "Regenerate scenery", "", true),
        Command::Generation(GenerationCommand::DrawScenery),
    );
    on(
        item(ui, "Cancel", "Ctrl+Backspace", input.busy),
        Command::Generation(GenerationCommand::Cancel {
            running: true,
            waiting: false,
        }),
    );
    on(
        item(ui, "Drop the edit that waits", "", input.waiting),
        Command::Generation(GenerationCommand::Cancel {
            running: false,
            waiting: true,
        }),
    );
    on(
        item(
            ui,
            "Cancel all",
            "Ctrl+Shift+Backspace",
            input.busy || input.waiting,
        ),
        Command::Generation(GenerationCommand::Cancel {
            running: true,
            waiting: true,
        }),
    );
    ui.separator();
    let live = if input.live {
        "Switch live off"
    } else {
        "Switch live on"
    };
    on(
        item(ui, live, "Ctrl+Space", true),
        Command::Generation(GenerationCommand::ToggleLive),
    );
}

fn help_menu(ui: &mut Ui, on: &mut On<'_>) {
    on(
        item(ui, "Find a command…", "Ctrl+K", true),
        Command::Toggle(Window::Palette),
    );
    on(item(ui, "Keys", "?", true), Command::Toggle(Window::Keys));
    on(item(ui, "Start screen", "", true), Command::Toggle(Window::Start));
    on(item(ui, "Tour in three steps", "", true), Command::BeginTour);
    ui.separator();
    on(
        item(ui, "Settings…", "Ctrl+,", true),
        Command::Toggle(Window::Settings),
    );
}
