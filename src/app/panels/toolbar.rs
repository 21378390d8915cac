//! The bar at the top: menus, tools, history, generation.

use std::path::PathBuf;

use egui::accesskit::Role;
use egui::{Sense, Ui, WidgetInfo, vec2};

use crate::bookmarks::SLOTS;
use crate::command::Command;
use crate::dock::Workspace;
use crate::icons::{self, Icon};
use crate::state::{Pane, UiState};
use crate::theme;
use crate::tools::things::ThingCommand;
use crate::tools::{ToolCommand, ToolId};
use editor::tools::beside::building;
use editor::tools::{Group, ToolDef, all};
use viewport::ViewPreset;

/// What the bar shows of the document and the worker.
pub struct ToolbarInput<'a> {
    /// Name of the scene.
    pub name: &'a str,
    /// There are changes that are in no file.
    pub dirty: bool,
    /// Files opened or saved lately, the last one first.
    pub recent: &'a [PathBuf],
    /// What undo would take back.
    pub undo: Option<&'a str>,
    /// What redo would bring back.
    pub redo: Option<&'a str>,
    /// Generation after each edit is on.
    pub live: bool,
    /// A job is on its way.
    pub busy: bool,
    /// An edit waits for its generation.
    pub waiting: bool,
    /// Numbers of views that are kept.
    pub bookmarks: Vec<u8>,
    /// Voxels that the user painted.
    pub has_paint: bool,
    /// Panes on screen.
    pub shown: Vec<Pane>,
    /// Cameras of the rig.
    pub cameras: usize,
    /// The workspace chosen last.
    pub workspace: Workspace,
    /// Stops of the quality slider, and what they are foretold to cost.
    pub stops: Vec<(String, String)>,
    /// The one in use.
    pub stop: Option<usize>,
}

/// Draws the bar.
pub fn toolbar_ui(ui: &mut Ui, input: &ToolbarInput<'_>, state: &mut UiState, commands: &mut Vec<Command>) {
    ui.horizontal_centered(|ui| {
        ui.spacing_mut().item_spacing.x = 2.0;
        ui.scope(|ui| {
            let widgets = &mut ui.visuals_mut().widgets;
            widgets.inactive.weak_bg_fill = egui::Color32::TRANSPARENT;
            ui.spacing_mut().item_spacing.x = 0.0;
            menus(ui, input, state, commands);
        });
        divider(ui);
        let narrow = ui.max_rect().width() < ROOM_FOR_ALL;
        for tool in all() {
            let folded = narrow && tool.group == Group::Beside;
            let chosen = state.tool == tool.id;
            if !folded
                && icons::button(ui, Icon::named(tool.icon), tool.title, tool.key, chosen, true).clicked()
            {
                commands.push(Command::Tool(tool.id));
            }
        }
        if narrow {
            thing_tools(ui, state.tool, commands);
        }
        divider(ui);
        let hint = |label: Option<&str>, keys: &str| {
            label.map_or_else(|| keys.to_owned(), |label| format!("{label}  ·  {keys}"))
        };
        let undo = icons::button(
            ui,
            Icon::Undo,
            "Undo",
            &hint(input.undo, "Ctrl+Z"),
            false,
            input.undo.is_some(),
        );
        if undo.clicked() {
            commands.push(Command::Undo);
        }
        let keys = "Ctrl+Shift+Z";
        let redo = icons::button(
            ui,
            Icon::Redo,
            "Redo",
            &hint(input.redo, keys),
            false,
            input.redo.is_some(),
        );
        if redo.clicked() {
            commands.push(Command::Redo);
        }
        divider(ui);
        let mut workspace = input.workspace;
        let names = Workspace::ALL.map(|(workspace, name)| (workspace, name, "arranges the panes"));
        if icons::segments(ui, &mut workspace, &names) {
            commands.push(Command::Workspace(workspace));
        }
        let left = ui.min_rect().right();
        let right = ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            generation(ui, input, commands);
            ui.min_rect().left()
        });
        title(ui, input, left, right.inner);
    });
}

/// In a narrower window the tools for things share one button, so that the name of the scene keeps its place, points.
const ROOM_FOR_ALL: f32 = 1360.0;

/// One button for all tools for things; it opens their list.
fn thing_tools(ui: &mut Ui, in_hand: ToolId, commands: &mut Vec<Command>) {
    let selected = in_hand.def().group == Group::Beside;
    let shown = if selected {
        in_hand.def()
    } else {
        building::ID.def()
    };
    let hint = "buildings, trees, hedges, shrubs, posts";
    let icon = Icon::named(shown.icon);
    let button = icons::button(ui, icon, "Beside the road", hint, selected, true);
    egui::Popup::menu(&button).show(|ui| {
        for tool in beside() {
            if item(ui, tool.title, short(tool.key), true) {
                commands.push(Command::Tool(tool.id));
            }
        }
    });
}

fn beside() -> impl Iterator<Item = &'static ToolDef> {
    all().iter().copied().filter(|t| t.group == Group::Beside)
}

/// The chord alone, without what else the hint says.
fn short(key: &str) -> &str {
    key.split(';').next().unwrap_or_default()
}

/// A chord in the second column of a menu.
fn item(ui: &mut Ui, name: &str, keys: &str, enabled: bool) -> bool {
    let keys = egui::RichText::new(keys).color(theme::text_weak());
    let button = egui::Button::new(name).shortcut_text(keys);
    let clicked = ui.add_enabled(enabled, button).clicked();
    if clicked {
        ui.close();
    }
    clicked
}

fn menus(ui: &mut Ui, input: &ToolbarInput<'_>, state: &mut UiState, commands: &mut Vec<Command>) {
    let mut on = |clicked: bool, command: Command| {
        if clicked {
            commands.push(command);
        }
    };
    ui.menu_button("File", |ui| {
        on(item(ui, "New scene", "Ctrl+N", true), Command::New);
        on(item(ui, "Open…", "Ctrl+O", true), Command::Open);
        ui.add_enabled_ui(!input.recent.is_empty(), |ui| {
            ui.menu_button("Open recent", |ui| {
                for path in input.recent {
                    let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
                    let clicked = ui
                        .button(name)
                        .on_hover_text(path.display().to_string())
                        .clicked();
                    on(clicked, Command::OpenPath(path.clone()));
                }
            });
        });
        ui.separator();
        on(item(ui, "Save", "Ctrl+S", true), Command::Save);
        on(item(ui, "Save as…", "Ctrl+Shift+S", true), Command::SaveAs);
        ui.separator();
        on(item(ui, "Export…", "", true), Command::ToggleExport);
        on(item(ui, "Quick screenshot", "F12", true), Command::QuickShot);
        on(
            item(ui, "Export screenshot…", "", true),
            Command::ExportScreenshot,
        );
        ui.separator();
        on(item(ui, "Quit", "Ctrl+Q", true), Command::Quit);
    });
    ui.menu_button("Edit", |ui| {
        on(item(ui, "Undo", "Ctrl+Z", input.undo.is_some()), Command::Undo);
        on(
            item(ui, "Redo", "Ctrl+Shift+Z", input.redo.is_some()),
            Command::Redo,
        );
        ui.separator();
        let some = state.any_chosen();
        let what = match (state.selected.is_some(), state.tools.things.chosen.len()) {
            (true, 0) | (false, 0) => "box",
            (false, 1) => "thing",
            (false, _) => "things",
            (true, _) => "selection",
        };
        on(
            item(ui, &format!("Duplicate {what}"), "Ctrl+D", some),
            Command::DuplicateSelected,
        );
        on(
            item(ui, &format!("Delete {what}"), "Del", some),
            Command::DeleteSelected,
        );
        let thing = |command| Command::Tools(ToolCommand::Thing(command));
        let things = !state.tools.things.chosen.is_empty();
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
    });
    ui.menu_button("View", |ui| {
        on(item(ui, "Frame all", "Home", true), Command::FrameAll);
        on(
            item(ui, "Frame selection", "F", state.any_chosen()),
            Command::FrameSelection,
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
            on(item(ui, &name, key, true), Command::View(preset));
        }
        ui.separator();
        ui.menu_button("Panes", |ui| {
            for pane in Pane::CHOICES {
                if matches!(pane, Pane::Camera(i) if i >= input.cameras) {
                    continue;
                }
                let mut shown = input.shown.contains(&pane);
                let tick = ui.checkbox(&mut shown, pane.name());
                on(tick.changed(), Command::TogglePane(pane));
            }
        });
        ui.menu_button("Kept views", |ui| {
            for slot in SLOTS {
                let kept = input.bookmarks.contains(&slot);
                let (name, keys) = (format!("Go to view {slot}"), format!("F{slot}"));
                on(item(ui, &name, &keys, kept), Command::GoToBookmark(slot));
            }
            ui.separator();
            for slot in SLOTS {
                let (name, keys) = (format!("Keep as view {slot}"), format!("Ctrl+F{slot}"));
                on(item(ui, &name, &keys, true), Command::KeepBookmark(slot));
            }
        });
        on(item(ui, "Swap views", "Tab", true), Command::SwapPanes);
        on(item(ui, "Grid", "G", true), Command::ToggleGrid);
        on(item(ui, "Sensors…", "", true), Command::ToggleSensors);
        on(item(ui, "Checks", "", true), Command::ToggleChecks);
        on(item(ui, "Log", "", true), Command::ToggleLog);
        on(item(ui, "Performance", "F10", true), Command::TogglePerformance);
    });
    ui.menu_button("Generate", |ui| {
        on(
            item(ui, "Generate everything", "Ctrl+Enter", true),
            Command::Generate { full: true },
        );
        on(
            item(ui, "Generate edited region", "", true),
            Command::Generate { full: false },
        );
        on(item(ui, "Draw scenery anew", "", true), Command::DrawScenery);
        on(
            item(ui, "Cancel", "Ctrl+Backspace", input.busy),
            Command::CancelGeneration,
        );
        on(
            item(ui, "Drop the edit that waits", "", input.waiting),
            Command::CancelWaiting,
        );
        on(
            item(
                ui,
                "Cancel all",
                "Ctrl+Shift+Backspace",
                input.busy || input.waiting,
            ),
            Command::CancelAll,
        );
        ui.separator();
        let live = if input.live {
            "Switch live off"
        } else {
            "Switch live on"
        };
        on(item(ui, live, "Ctrl+Space", true), Command::ToggleLive);
    });
    ui.menu_button("Help", |ui| {
        on(
            item(ui, "Find a command…", "Ctrl+K", true),
            Command::TogglePalette,
        );
        on(item(ui, "Keys", "?", true), Command::ToggleKeys);
        on(item(ui, "Start screen", "", true), Command::ToggleStart);
        ui.separator();
        on(item(ui, "Settings…", "Ctrl+,", true), Command::ToggleSettings);
    });
}

fn divider(ui: &mut Ui) {
    ui.add_space(6.0);
    let (rect, _) = ui.allocate_exact_size(vec2(1.0, 18.0), Sense::hover());
    ui.painter().rect_filled(rect, 0.0, theme::field_hover());
    ui.add_space(6.0);
}

/// From right to left: the button that generates, the live switch.
fn generation(ui: &mut Ui, input: &ToolbarInput<'_>, commands: &mut Vec<Command>) {
    ui.spacing_mut().item_spacing.x = theme::GAP;
    let (name, label, hint, fill, icon, command) = if input.busy {
        (
            "Cancel",
            "Cancel job",
            "Ctrl+Backspace",
            theme::field(),
            Icon::Stop,
            Command::CancelGeneration,
        )
    } else {
        let command = Command::Generate { full: true };
        (
            "Generate",
            "Generate everything",
            "all of it, Ctrl+Enter",
            theme::accent_fill(),
            Icon::Play,
            command,
        )
    };
    if wide_button(ui, icon, name, hint, fill, label).clicked() {
        commands.push(command);
    }
    let fill = if input.live {
        theme::field()
    } else {
        egui::Color32::TRANSPARENT
    };
    let hint = if input.live {
        "on: generates after each edit, Ctrl+Space"
    } else {
        "off, Ctrl+Space"
    };
    let live = wide_button(ui, Icon::Live, "Live", hint, fill, "Live");
    if input.live {
        let dot = live.rect.right_top() + vec2(-6.0, 6.0);
        ui.painter().circle_filled(dot, 3.0, theme::good());
    }
    live.widget_info(|| WidgetInfo::selected(Role::Button, true, input.live, "Live"));
    if live.clicked() {
        commands.push(Command::ToggleLive);
    }
    if !input.stops.is_empty() {
        quality(ui, input, commands);
    }
}

/// The stops of the quality slider as a menu.
fn quality(ui: &mut Ui, input: &ToolbarInput<'_>, commands: &mut Vec<Command>) {
    let current = input.stop.and_then(|i| input.stops.get(i));
    let name = current.map_or("own settings", |(name, _)| name);
    let menu = ui.menu_button(theme::sentence(name), |ui| {
        for (i, (name, foretold)) in input.stops.iter().enumerate() {
            let text = egui::RichText::new(format!("{}   {foretold}", theme::sentence(name)));
            if ui.selectable_label(input.stop == Some(i), text).clicked() {
                commands.push(Command::Quality(i));
                ui.close();
            }
        }
        ui.separator();
        if ui.button("Speed and accuracy…").clicked() {
            commands.push(Command::Workspace(Workspace::Trade));
            ui.close();
        }
    });
    let label = format!("Quality: {name} menu");
    menu.response
        .widget_info(|| WidgetInfo::labeled(Role::Button, true, &label));
    let cost = current.map_or(String::new(), |(_, foretold)| format!("\n{foretold}"));
    menu.response
        .on_hover_text(format!("How exactly edits are generated{cost}"));
}

/// A button with an icon and a name, of one height with the others.
fn wide_button(
    ui: &mut Ui,
    icon: Icon,
    name: &str,
    hint: &str,
    fill: egui::Color32,
    label: &str,
) -> egui::Response {
    let font = egui::TextStyle::Button.resolve(ui.style());
    let galley = ui
        .painter()
        .layout_no_wrap(name.to_owned(), font, theme::text_strong());
    let size = vec2(galley.size().x + 42.0, theme::ROW + 4.0);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, label));
    let fill = if response.hovered() {
        fill.lerp_to_gamma(theme::text_strong(), 0.12)
    } else {
        fill
    };
    ui.painter().rect_filled(rect, theme::RADIUS, fill);
    let icon_rect = egui::Rect::from_center_size(rect.left_center() + vec2(17.0, 0.0), vec2(14.0, 14.0));
    icon.paint(ui, icon_rect, theme::text_strong());
    let at = rect.left_center() + vec2(30.0, -galley.size().y / 2.0);
    ui.painter().galley(at, galley, theme::text_strong());
    icons::focus_ring(ui, &response, rect);
    response.on_hover_ui(|ui| icons::tip(ui, name, hint))
}

/// Name of the scene in the middle of what is left free.
fn title(ui: &Ui, input: &ToolbarInput<'_>, left: f32, right: f32) {
    if right - left < 120.0 {
        return;
    }
    let font = egui::TextStyle::Body.resolve(ui.style());
    let middle = egui::pos2((left + right) / 2.0, ui.max_rect().center().y);
    let painter = ui.painter();
    let mut job = egui::text::LayoutJob::simple_singleline(input.name.to_owned(), font, theme::text());
    // Room for the mark of unsaved changes on both sides.
    job.wrap = egui::text::TextWrapping::truncate_at_width(right - left - 40.0);
    let galley = painter.layout_job(job);
    let drawn = egui::Rect::from_center_size(middle, galley.size());
    painter.galley(drawn.min, galley, theme::text());
    if input.dirty {
        painter.circle_filled(drawn.right_center() + vec2(9.0, 1.0), 3.0, theme::warn());
    }
}
