//! The bar at the top: menus, tools, history, generation.

use std::path::PathBuf;

use egui::accesskit::Role;
use egui::{Sense, Ui, WidgetInfo, vec2};

use super::menus::menus;
use crate::command::{Command, GenerationCommand, ViewCommand};
use crate::panes::id::PaneId;
use crate::shell::workspace::Workspace;
use crate::tools::Hand;
use crate::tools::ToolId;
use editor::tools::beside::building;
use editor::tools::{ToolDef, ToolGroup, all};
use language::{t, tf};
use widgets::icons::{self, Icon};
use widgets::theme;

/// State of the document and the worker for the bar.
pub struct ToolbarInput<'a> {
    /// Name of the scene.
    pub name: &'a str,
    /// True if there are changes that are in no file.
    pub dirty: bool,
    /// Files opened or saved recently, the newest first.
    pub recent: &'a [PathBuf],
    /// Label of the step that undo reverts.
    pub undo: Option<&'a str>,
    /// Label of the step that redo restores.
    pub redo: Option<&'a str>,
    /// True if generation after each edit is on.
    pub live: bool,
    /// True if a job is running.
    pub busy: bool,
    /// True if cells are marked to be inpainted.
    pub marked: bool,
    /// True if an edit waits for its generation.
    pub waiting: bool,
    /// Numbers of the kept views.
    pub bookmarks: Vec<u8>,
    /// True if there are voxels painted by the user.
    pub has_paint: bool,
    /// Panes on screen.
    pub shown: Vec<PaneId>,
    /// Number of cameras of the rig.
    pub cameras: usize,
    /// The workspace chosen last.
    pub workspace: Workspace,
    /// Presets of the quality slider, each with its predicted cost.
    pub presets: Vec<(String, String)>,
    /// Index of the preset in use.
    pub preset: Option<usize>,
}

/// Draws the bar. Parts that do not fit are folded into menus.
pub fn toolbar_ui(ui: &mut Ui, input: &ToolbarInput<'_>, hand: &Hand, commands: &mut Vec<Command>) {
    let room = ui.max_rect().width();
    let mut needs = Needs::load(ui);
    let fold = needs.fold(room);
    ui.horizontal_centered(|ui| {
        ui.spacing_mut().item_spacing.x = 2.0;
        ui.scope(|ui| {
            let widgets = &mut ui.visuals_mut().widgets;
            widgets.inactive.weak_bg_fill = egui::Color32::TRANSPARENT;
            ui.spacing_mut().item_spacing.x = 0.0;
            menus(ui, input, hand, fold >= Fold::Menus, commands);
        });
        divider(ui);
        tools(ui, fold, hand.tool, commands);
        divider(ui);
        let hint = |label: Option<&str>, keys: &str| {
            label.map_or_else(|| keys.to_owned(), |label| format!("{}  ·  {keys}", t(label)))
        };
        let undo = icons::button(
            ui,
            Icon::Undo,
            t("Undo"),
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
            t("Redo"),
            &hint(input.redo, keys),
            false,
            input.redo.is_some(),
        );
        if redo.clicked() {
            commands.push(Command::Redo);
        }
        divider(ui);
        workspaces(ui, input.workspace, fold, commands);
        let left = ui.min_rect().right();
        let right = ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            generation(ui, input, fold, commands);
            ui.min_rect().left()
        });
        title(ui, input, left, right.inner);
        let taken = left - ui.max_rect().left() + ui.max_rect().right() - right.inner;
        needs.learn(ui, fold, taken, room);
    });
}

/// Degree of folding of the bar. Each step also folds the parts of the steps before it.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
enum Fold {
    /// No part is folded.
    Nothing,
    /// The tools for things share one button.
    Things,
    /// The workspaces are a menu.
    Workspaces,
    /// All tools share one button, and the buttons of generation show icons only.
    Tools,
    /// The menus are one menu.
    Menus,
}

impl Fold {
    const ALL: [Self; 5] = [
        Self::Nothing,
        Self::Things,
        Self::Workspaces,
        Self::Tools,
        Self::Menus,
    ];
}

/// Width of the bar at each step of folding, points, if it was drawn so before. Names differ in length between
/// languages.
#[derive(Clone, Copy, Debug, Default)]
struct Needs([Option<f32>; Fold::ALL.len()]);

impl Needs {
    fn id() -> egui::Id {
        let language = language::chosen().map_or("en", |l| &l.code);
        egui::Id::unique(("toolbar", language))
    }

    fn load(ui: &Ui) -> Self {
        ui.data(|d| d.get_temp(Self::id())).unwrap_or_default()
    }

    /// The first step that fits, as far as widths are known.
    fn fold(&self, room: f32) -> Fold {
        let fits = |need: &Option<f32>| need.is_none_or(|need| need <= room);
        Fold::ALL[self.0.iter().position(fits).unwrap_or(Fold::ALL.len() - 1)]
    }

    /// Notes the width of the bar. If another step fits, the bar is drawn again.
    fn learn(&mut self, ui: &Ui, fold: Fold, taken: f32, room: f32) {
        self.0[fold as usize] = Some(taken);
        let needs = *self;
        ui.data_mut(|d| d.insert_temp(Self::id(), needs));
        if self.fold(room) != fold {
            ui.ctx().request_discard("the bar is folded");
        }
    }
}

/// Draws the tools; folded ones are in the list of one button.
fn tools(ui: &mut Ui, fold: Fold, in_hand: ToolId, commands: &mut Vec<Command>) {
    if fold >= Fold::Tools {
        let hint = t("Which tool is in hand");
        let (tool, list) = (in_hand.def(), all().iter().copied());
        return tool_list(ui, tool, (t(tool.title), hint), true, list, commands);
    }
    for tool in all() {
        let folded = fold >= Fold::Things && tool.group == ToolGroup::Beside;
        let (icon, chosen) = (Icon::named(tool.icon), in_hand == tool.id);
        if !folded && icons::button(ui, icon, t(tool.title), t(tool.key), chosen, true).clicked() {
            commands.push(Command::Tool(tool.id));
        }
    }
    if fold >= Fold::Things {
        let selected = in_hand.def().group == ToolGroup::Beside;
        let shown = if selected { in_hand } else { building::ID };
        let hint = t("buildings, trees, hedges, shrubs, posts");
        tool_list(
            ui,
            shown.def(),
            (t("Beside the road"), hint),
            selected,
            beside(),
            commands,
        );
    }
}

/// A button for several tools. It opens their list, and looks chosen while one of them is in hand.
fn tool_list(
    ui: &mut Ui,
    shown: &ToolDef,
    (name, hint): (&str, &str),
    chosen: bool,
    list: impl Iterator<Item = &'static ToolDef>,
    commands: &mut Vec<Command>,
) {
    let button = icons::button(ui, Icon::named(shown.icon), name, hint, chosen, true);
    // A small triangle marks that a list opens.
    let corner = button.rect.right_bottom() - vec2(4.0, 4.0);
    let points = vec![corner, corner - vec2(6.0, 0.0), corner - vec2(0.0, 6.0)];
    let more = egui::Shape::convex_polygon(points, theme::text_weak(), egui::Stroke::NONE);
    ui.painter().add(more);
    egui::Popup::menu(&button).show(|ui| {
        for tool in list {
            if item(ui, t(tool.title), short(tool.key), true) {
                commands.push(Command::Tool(tool.id));
            }
        }
    });
}

/// Draws the workspaces side by side, or as a menu.
fn workspaces(ui: &mut Ui, current: Workspace, fold: Fold, commands: &mut Vec<Command>) {
    let mut chosen = current;
    let names = Workspace::ALL.map(|(workspace, name)| {
        (
            workspace,
            t(name),
            t("its panes as they were left; by its key or the menu once more, as they came"),
        )
    });
    if fold >= Fold::Workspaces {
        let name = names.iter().find(|n| n.0 == current).map_or("", |n| n.1);
        let menu = ui.menu_button(name, |ui| {
            for (workspace, name, _) in names {
                if ui.selectable_label(current == workspace, name).clicked() {
                    chosen = workspace;
                    ui.close();
                }
            }
        });
        menu.response.on_hover_ui(|ui| {
            icons::tip(
                ui,
                name,
                t("its panes as they were left; by its key or the menu once more, as they came"),
            )
        });
    } else {
        icons::segments(ui, &mut chosen, &names);
    }
    if chosen != current {
        commands.push(Command::View(ViewCommand::Workspace(chosen)));
    }
}

/// The tools for things beside the road.
pub(super) fn beside() -> impl Iterator<Item = &'static ToolDef> {
    all().iter().copied().filter(|t| t.group == ToolGroup::Beside)
}

/// The chord of a hint, without the rest of the hint.
pub(super) fn short(key: &str) -> &str {
    key.split(';').next().unwrap_or_default()
}

/// A menu entry with its chord in the second column; returns true if it was clicked.
pub(super) fn item(ui: &mut Ui, name: &str, keys: &str, enabled: bool) -> bool {
    let keys = egui::RichText::new(keys).color(theme::text_weak());
    let button = egui::Button::new(name).shortcut_text(keys);
    let clicked = ui.add_enabled(enabled, button).clicked();
    if clicked {
        ui.close();
    }
    clicked
}

fn divider(ui: &mut Ui) {
    ui.add_space(6.0);
    let (rect, _) = ui.allocate_exact_size(vec2(1.0, 18.0), Sense::hover());
    ui.painter().rect_filled(rect, 0.0, theme::field_hover());
    ui.add_space(6.0);
}

/// Draws, from right to left, the button that generates and the live switch.
fn generation(ui: &mut Ui, input: &ToolbarInput<'_>, fold: Fold, commands: &mut Vec<Command>) {
    let named = fold < Fold::Tools;
    ui.spacing_mut().item_spacing.x = theme::GAP;
    let (name, label, hint, fill, icon, command) = if input.busy {
        (
            t("Cancel"),
            t("Cancel job"),
            "Ctrl+Backspace",
            theme::field(),
            Icon::Stop,
            Command::Generation(GenerationCommand::Cancel {
                running: true,
                waiting: false,
            }),
        )
    } else if input.marked {
        (
            t("Inpaint"),
            t("Generate what is marked"),
            t("fresh content where the region is marked, and nowhere else"),
            theme::accent_fill(),
            Icon::Play,
            Command::Generation(GenerationCommand::Generate { full: false }),
        )
    } else {
        let command = Command::Generation(GenerationCommand::Generate { full: true });
        (
            t("Generate"),
            t("Generate everything"),
            t("all of it, Ctrl+Enter"),
            theme::accent_fill(),
            Icon::Play,
            command,
        )
    };
    // The width fits all texts, so the neighbours of the button stay under the pointer.
    let widest = [t("Cancel"), t("Inpaint"), t("Generate")];
    if wide_button(ui, icon, (name, named), &widest, (hint, label), fill).clicked() {
        commands.push(command);
    }
    let fill = if input.live {
        theme::field()
    } else {
        egui::Color32::TRANSPARENT
    };
    let hint = if input.live {
        t("on: generates after each edit, Ctrl+Space")
    } else {
        t("off, Ctrl+Space")
    };
    let live = wide_button(
        ui,
        Icon::Live,
        (t("Live"), named),
        &[t("Live")],
        (hint, t("Live")),
        fill,
    );
    if input.live {
        let dot = live.rect.right_top() + vec2(-6.0, 6.0);
        ui.painter().circle_filled(dot, 3.0, theme::good());
    }
    live.widget_info(|| WidgetInfo::selected(Role::Button, true, input.live, t("Live")));
    if live.clicked() {
        commands.push(Command::Generation(GenerationCommand::ToggleLive));
    }
    if !input.presets.is_empty() {
        quality(ui, input, commands);
    }
}

/// Draws the presets of the quality slider as a menu.
fn quality(ui: &mut Ui, input: &ToolbarInput<'_>, commands: &mut Vec<Command>) {
    let current = input.preset.and_then(|i| input.presets.get(i));
    let name = t(current.map_or("own settings", |(name, _)| name));
    let menu = ui.menu_button(theme::sentence(name), |ui| {
        for (i, (name, predicted)) in input.presets.iter().enumerate() {
            let text = egui::RichText::new(format!("{}   {predicted}", theme::sentence(t(name))));
            if ui.selectable_label(input.preset == Some(i), text).clicked() {
                commands.push(Command::Generation(GenerationCommand::Quality(i)));
                ui.close();
            }
        }
        ui.separator();
        if ui.button(t("Speed and accuracy…")).clicked() {
            commands.push(Command::View(ViewCommand::Workspace(Workspace::Trade)));
            ui.close();
        }
    });
    let label = tf!("Quality: {name} menu", name = name);
    menu.response
        .widget_info(|| WidgetInfo::labeled(Role::Button, true, &label));
    let cost = current.map_or(String::new(), |(_, predicted)| format!("\n{predicted}"));
    menu.response.on_hover_text(format!(
        "{}{cost}",
        t("How edits are generated: fast, or like the reference")
    ));
}

/// A button with an icon and, if `named`, a name beside it. It has the height of the other buttons, and is wide enough
/// for each of `names`, which it shows at other times.
fn wide_button(
    ui: &mut Ui,
    icon: Icon,
    (name, named): (&str, bool),
    names: &[&str],
    (hint, label): (&str, &str),
    fill: egui::Color32,
) -> egui::Response {
    let font = egui::TextStyle::Button.resolve(ui.style());
    let written = |name: &str| {
        let text = if named { name.to_owned() } else { String::new() };
        ui.painter()
            .layout_no_wrap(text, font.clone(), theme::text_strong())
    };
    let widths = names.iter().map(|name| written(name).size().x);
    let width = if named {
        widths.fold(0.0, f32::max) + 42.0
    } else {
        34.0
    };
    let galley = written(name);
    let size = vec2(width, theme::ROW + 4.0);
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

/// Draws the name of the scene in the middle of the free space.
fn title(ui: &Ui, input: &ToolbarInput<'_>, left: f32, right: f32) {
    if right - left < 120.0 {
        return;
    }
    let font = egui::TextStyle::Body.resolve(ui.style());
    let middle = egui::pos2((left + right) / 2.0, ui.max_rect().center().y);
    let painter = ui.painter();
    let mut job = egui::text::LayoutJob::simple_singleline(input.name.to_owned(), font, theme::text());
    // The margin on both sides leaves room for the mark of unsaved changes.
    job.wrap = egui::text::TextWrapping::truncate_at_width(right - left - 40.0);
    let galley = painter.layout_job(job);
    let drawn = egui::Rect::from_center_size(middle, galley.size());
    painter.galley(drawn.min, galley, theme::text());
    if input.dirty {
        painter.circle_filled(drawn.right_center() + vec2(9.0, 1.0), 3.0, theme::warn());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bar_folds_no_more_than_it_must() {
        let mut needs = Needs::default();
        assert_eq!(needs.fold(300.0), Fold::Nothing, "nothing is known yet");
        needs.0[0] = Some(1330.0);
        assert_eq!(
            (needs.fold(1400.0), needs.fold(1200.0)),
            (Fold::Nothing, Fold::Things)
        );
        for (at, need) in [(1, 1210.0), (2, 930.0), (3, 700.0), (4, 560.0)] {
            needs.0[at] = Some(need);
        }
        let folds = [1210.0, 1000.0, 800.0, 600.0, 300.0].map(|room| needs.fold(room));
        assert_eq!(
            folds,
            [
                Fold::Things,
                Fold::Workspaces,
                Fold::Tools,
                Fold::Menus,
                Fold::Menus
            ]
        );
    }
}
