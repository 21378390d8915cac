//! Draws the dock: each pane with a header to name it, move it, divide it and replace it.

use std::collections::HashSet;
use std::sync::Arc;

use egui::{Sense, Ui, WidgetText, vec2};
use egui_tiles::{Behavior, TileId, Tiles, UiResponse};

use scene::Scene;

use super::app::SceneloomApp;
use super::dock::Split;
use crate::command::Command;
use crate::panes;
use crate::panes::compare::tag;
use crate::panes::id::PaneId;
use crate::panes::pane::{Pane, PaneContext};
use language::{t, tf};
use widgets::icons::{self, Icon};
use widgets::theme;

/// Height of a pane's header, points.
pub const HEADER: f32 = 30.0;

/// Width that a panel may lack before it is scrolled, points.
const NEARLY: f32 = 12.0;

/// Width of the controls beside tabs, where choices fold into a list, points.
const BESIDE_TABS: f32 = 104.0;
/// Margin beside the title of a tab, and width of the pane's menu with its distance to the next control, points.
const TAB_SPACING: f32 = 10.0;
const MENU: f32 = 40.0;

/// Change of the dock that the user asked for, made after drawing.
#[derive(Clone, Copy, Debug, PartialEq)]
enum DockAction {
    Put(TileId, PaneId),
    Split(TileId, Split),
    Maximize(TileId),
    Close(TileId),
}

/// Draws the panes of the tree.
struct DockPainter<'a> {
    panes: &'a mut [Box<dyn Pane>],
    cx: PaneContext<'a>,
    commands: &'a mut Vec<Command>,
    actions: Vec<DockAction>,
    maximized: bool,
    tabbed: HashSet<TileId>,
    /// Panes on a tab whose controls do not fit beside the tabs.
    below_tabs: HashSet<PaneId>,
}

impl Behavior<PaneId> for DockPainter<'_> {
    fn pane_ui(&mut self, ui: &mut Ui, tile: TileId, pane: &mut PaneId) -> UiResponse {
        let rect = ui.max_rect();
        ui.set_clip_rect(ui.clip_rect().intersect(rect));
        ui.spacing_mut().item_spacing.y = 0.0;
        // The tab shows the pane's name, and the tab bar its controls.
        let on_a_tab = !self.maximized && self.tabbed.contains(&tile);
        let dragged = !on_a_tab && self.header(ui, tile, *pane);
        if on_a_tab && self.below_tabs.contains(pane) {
            self.row(ui, *pane);
        }
        ui.spacing_mut().item_spacing.y = 4.0;
        self.pane(ui, *pane);
        if dragged {
            UiResponse::DragStarted
        } else {
            UiResponse::None
        }
    }

    fn tab_title_for_pane(&mut self, pane: &PaneId) -> WidgetText {
        self.title(*pane).into()
    }

    fn top_bar_right_ui(
        &mut self,
        tiles: &Tiles<PaneId>,
        ui: &mut Ui,
        _tile: TileId,
        tabs: &egui_tiles::Tabs,
        _scroll: &mut f32,
    ) {
        let active = tabs.active.and_then(|tile| Some((tile, *tiles.get_pane(&tile)?)));
        if let Some((tile, pane)) = active {
            ui.spacing_mut().item_spacing.x = 4.0;
            ui.add_space(4.0);
            let titles: f32 = tabs
                .children
                .iter()
                .filter_map(|tile| tiles.get_pane(tile))
                .map(|pane| self.tab_width(ui, *pane))
                .sum();
            let room = ui.available_width() - MENU - titles;
            self.menu(ui, tile, pane, "");
            self.beside_tabs(ui, pane, room);
        }
    }

    fn tab_title_spacing(&self, _visuals: &egui::Visuals) -> f32 {
        TAB_SPACING
    }

    fn tab_bar_height(&self, _style: &egui::Style) -> f32 {
        HEADER
    }

    fn gap_width(&self, _style: &egui::Style) -> f32 {
        3.0
    }

    fn min_size(&self) -> f32 {
        72.0
    }

    fn tab_bar_color(&self, _visuals: &egui::Visuals) -> egui::Color32 {
        theme::background()
    }
}

impl DockPainter<'_> {
    /// Title of a pane; for cameras with the names from the rig.
    fn title(&self, id: PaneId) -> String {
        let pane = self.panes.iter().find(|p| p.id() == id);
        pane.map_or_else(
            || id.name().to_owned(),
            |p| t(&p.title_in(self.cx.scene)).to_owned(),
        )
    }

    fn controls(&mut self, ui: &mut Ui, id: PaneId) {
        if let Some(pane) = self.panes.iter_mut().find(|p| p.id() == id) {
            pane.controls(ui, &mut self.cx, self.commands);
        }
    }

    /// Width of the tab of a pane, points.
    fn tab_width(&self, ui: &Ui, pane: PaneId) -> f32 {
        let font = egui::TextStyle::Button.resolve(ui.style());
        let galley = ui.painter().layout_no_wrap(self.title(pane), font, theme::text());
        galley.size().x + 2.0 * TAB_SPACING
    }

    /// Draws the controls of a pane beside the tabs if they fit into `room`, points; else they go into a row below, so
    /// that no tab is covered.
    fn beside_tabs(&mut self, ui: &mut Ui, pane: PaneId, room: f32) {
        // The width is that of the last time they were drawn here.
        let language = language::chosen().map_or("en", |l| &l.code);
        let id = egui::Id::unique(("controls beside tabs", pane, language));
        let needed: Option<f32> = ui.data(|d| d.get_temp(id));
        if needed.is_some_and(|needed| needed > room) {
            self.below_tabs.insert(pane);
            return;
        }
        let drawn = ui.scope(|ui| {
            ui.set_max_width(BESIDE_TABS);
            self.controls(ui, pane);
            ui.min_rect().width()
        });
        ui.data_mut(|d| d.insert_temp(id, drawn.inner));
        if drawn.inner > room {
            ui.ctx().request_discard("the controls go below the tabs");
        }
    }

    /// Draws the controls of a pane in a row of its own.
    fn row(&mut self, ui: &mut Ui, pane: PaneId) {
        let size = vec2(ui.available_width(), HEADER);
        let (rect, _) = ui.allocate_exact_size(size, Sense::hover());
        self.controls_within(ui, rect.shrink2(vec2(8.0, 2.0)), pane);
    }

    /// Draws the controls of a pane from right to left; those that do not fit are cut off.
    fn controls_within(&mut self, ui: &mut Ui, room: egui::Rect, pane: PaneId) {
        if !room.is_positive() {
            return;
        }
        let layout = egui::Layout::right_to_left(egui::Align::Center);
        let mut ui = ui.new_child(egui::UiBuilder::new().max_rect(room).layout(layout));
        ui.set_clip_rect(ui.clip_rect().intersect(room.expand2(vec2(0.0, 2.0))));
        ui.spacing_mut().item_spacing.x = 4.0;
        self.controls(&mut ui, pane);
    }

    /// Draws a pane below its header.
    fn pane(&mut self, ui: &mut Ui, id: PaneId) {
        let Some(pane) = self.panes.iter_mut().find(|p| p.id() == id) else {
            return;
        };
        let area = ui.available_rect_before_wrap();
        let needs = panes::info(id).map_or(0.0, |p| p.column_points);
        if area.width() < needs - NEARLY {
            let scroll = egui::ScrollArea::horizontal().id_salt(("narrow", id));
            scroll.auto_shrink(false).show(ui, |ui| {
                ui.set_width(needs);
                pane.ui(ui, &mut self.cx, self.commands);
            });
        } else {
            pane.ui(ui, &mut self.cx, self.commands);
        }
        if self.cx.state.compare.holding_reference && pane.shows_before() {
            tag(
                ui,
                area.left_top() + vec2(8.0, 8.0),
                self.cx.state.compare.names()[0],
                false,
            );
        }
        if ui.rect_contains_pointer(area) {
            self.cx.state.pointed.pane = Some(id);
        }
    }

    /// Draws the header: title with its menu on the left, controls on the right. Returns true if the user begins to
    /// drag the pane away.
    fn header(&mut self, ui: &mut Ui, tile: TileId, pane: PaneId) -> bool {
        let size = vec2(ui.available_width(), HEADER);
        let (rect, response) = ui.allocate_exact_size(size, Sense::click_and_drag());
        ui.scope_builder(
            egui::UiBuilder::new().max_rect(rect.shrink2(vec2(8.0, 2.0))),
            |ui| {
                ui.set_clip_rect(ui.clip_rect().intersect(rect));
                ui.horizontal_centered(|ui| {
                    ui.spacing_mut().item_spacing.x = 4.0;
                    let title = self.title(pane);
                    self.menu(ui, tile, pane, &title);
                    // The controls may not cover the title, nor be wider than the pane, or the pane would shift.
                    let room = ui.available_rect_before_wrap();
                    self.controls_within(ui, room, pane);
                });
            },
        );
        if response.double_clicked() {
            self.actions.push(DockAction::Maximize(tile));
        }
        response.drag_started() && !self.maximized
    }

    fn menu(&mut self, ui: &mut Ui, tile: TileId, pane: PaneId, name: &str) {
        let text = egui::RichText::new(format!("{name}     ")).color(theme::text());
        let button = egui::Button::new(text).fill(egui::Color32::TRANSPARENT);
        let cameras = self.cx.scene.rig.cameras.len();
        let is_there = |p: &PaneId| p.camera().is_none_or(|i| i < cameras);
        let others: Vec<(PaneId, String)> = panes::infos()
            .iter()
            .map(|info| info.id)
            .filter(|id| *id != pane && is_there(id))
            .map(|id| (id, self.title(id)))
            .collect();
        let (opened, _) = egui::containers::menu::MenuButton::from_button(button).ui(ui, |ui| {
            ui.set_min_width(190.0);
            let mut act = |ui: &mut Ui, name: &str, action: DockAction| {
                if ui.button(name).clicked() {
                    self.actions.push(action);
                    ui.close();
                }
            };
            let large = if self.maximized {
                t("Show all panes")
            } else {
                t("Maximize")
            };
            act(ui, large, DockAction::Maximize(tile));
            act(ui, t("Split to the right"), DockAction::Split(tile, Split::Right));
            act(ui, t("Split downward"), DockAction::Split(tile, Split::Down));
            act(ui, t("Close"), DockAction::Close(tile));
            ui.separator();
            ui.label(
                egui::RichText::new(t("Show here"))
                    .small()
                    .color(theme::text_weak()),
            );
            for (choice, title) in others {
                act(ui, &title, DockAction::Put(tile, choice));
            }
        });
        if name.is_empty() {
            let label = tf!("Menu of {pane}", pane = self.title(pane));
            opened.widget_info(|| egui::WidgetInfo::labeled(egui::accesskit::Role::Button, true, &label));
        }
        // The fonts have no small triangle.
        let tip = opened.rect.right_center() + vec2(-13.0, 2.5);
        let points = vec![tip, tip + vec2(-4.0, -5.0), tip + vec2(4.0, -5.0)];
        let shape = egui::Shape::convex_polygon(points, theme::text_weak(), egui::Stroke::NONE);
        ui.painter().add(shape);
        if self.maximized && icons::button(ui, Icon::Close, t("Show all panes"), "", false, true).clicked() {
            self.actions.push(DockAction::Maximize(tile));
        }
    }
}

impl SceneloomApp {
    /// Draws all panes and carries out the changes of the dock that the user asked for.
    pub(crate) fn dock_ui(&mut self, ui: &mut Ui, scene: &Arc<Scene>, commands: &mut Vec<Command>) {
        let views = &mut self.views;
        let dock = &mut views.dock;
        dock.fit(ui.available_width());
        let maximized = dock.maximized;
        let generation = &mut self.generation;
        let mut drawer = DockPainter {
            panes: &mut views.panes,
            cx: PaneContext {
                scene,
                seen: views.seen.update(scene, self.document.settled_scene()),
                document: &self.document,
                state: &mut self.state,
                canvas: &mut views.canvas,
                view3d: &mut views.view3d,
                strip: &mut views.strip,
                prompt: &mut views.prompt,
                compare: &mut views.compare,
                versions: &mut generation.versions,
                tuning: &mut generation.tuning,
                sensing: &self.threads.sensing,
                checking: &self.threads.checking,
                params: &generation.live.params,
                unsettled: &generation.unsettled,
                generating: generation.live.running.is_some(),
                render_state: views.render_state.as_ref(),
            },
            commands,
            actions: Vec::new(),
            maximized: maximized.is_some(),
            tabbed: dock.tabbed(),
            below_tabs: HashSet::new(),
        };
        match maximized.and_then(|tile| Some((tile, *dock.tree.tiles.get_pane(&tile)?))) {
            Some((tile, mut pane)) => drop(drawer.pane_ui(ui, tile, &mut pane)),
            None => dock.tree.ui(&mut drawer, ui),
        }
        let actions = drawer.actions;
        for action in actions {
            match action {
                DockAction::Put(tile, pane) => dock.put(tile, pane),
                DockAction::Split(tile, split) => {
                    if let Some(pane) = dock.first_absent() {
                        dock.split(tile, split, pane);
                    }
                }
                DockAction::Maximize(tile) => dock.toggle_maximized(tile),
                DockAction::Close(tile) => dock.close(tile),
            }
            ui.ctx().request_repaint();
        }
    }
}
