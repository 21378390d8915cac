//! One frame of the window: its bars, its panes, and windows over them.

use std::sync::Arc;

use egui::{Rect, Ui};

use super::app::SceneloomApp;
use super::files::Next;
use crate::camera_views::Wanted;
use crate::command::{Command, FileCommand};
use crate::fly;
use crate::panes;
use crate::panes::camera_strip::{self, CamerasInput};
use crate::panes::compare::CompareMode;
use crate::panes::id::PaneId;
use crate::shell::keys;
use crate::shell::keys::Hands;
use crate::shell::status::{StatusInput, status_ui};
use crate::shell::toolbar::{ToolbarInput, toolbar_ui};
use crate::state::UiState;
use crate::windows::capture::capture_ui;
use crate::windows::palette::Known;
use crate::windows::performance::performance_ui;
use crate::windows::repairs::repairs_ui;
use crate::windows::sensors::sensors_ui;
use crate::windows::settings::{Choices, settings_ui};
use crate::windows::start::start_ui;
use crate::windows::tour::tour_ui;
use crate::windows::unsaved::{self, Unsaved};
use editor::checks::{SeverityCounts, waive};
use language::t;
use scene::Scene;
use widgets::theme;

impl SceneloomApp {
    /// Draws the window and carries out the user's commands.
    pub fn draw(&mut self, ui: &mut Ui) {
        self.frames.passes = self.frames.passes.saturating_add(1);
        let mut commands = Vec::new();
        fly::note(ui.ctx());
        // Checked before drawing: the key that closes a menu or a list is no shortcut.
        let popup = egui::Popup::is_any_open(ui.ctx());
        let over_window = is_over_window(ui.ctx());
        self.take_window_events(ui.ctx(), &mut commands);
        self.tidy_staging();
        self.prepare_compare(ui);
        let scene = self.shown_scene();
        // Widgets below a dialog are disabled, and keep no tooltip open over it.
        let mut below = ui.new_child(egui::UiBuilder::new().max_rect(ui.max_rect()));
        if self.has_dialog() {
            below.visuals_mut().disabled_alpha = 1.0;
            below.disable();
        }
        self.bars(&mut below, &scene, &mut commands);
        self.views(&mut below, &scene, &mut commands);
        // Checked before drawing: the key that closes a dialog is no shortcut.
        let dialog = self.has_dialog();
        self.overlays(ui, &scene, &mut commands);
        // While the reference state is shown, keys would change another state than the visible one.
        if !dialog && !popup && !self.state.compare.holding_reference {
            let (primary, secondary) = ui.input(|i| (i.pointer.primary_down(), i.pointer.secondary_down()));
            let hands = Hands {
                flying: secondary && matches!(self.state.pointed.pane, Some(PaneId::VIEW3D | PaneId::SPLATS)),
                dragging: primary && (self.views.canvas.is_dragging() || self.views.view3d.is_dragging()),
                over_window,
                staged: self.staged().is_some(),
            };
            keys::commands(
                ui.ctx(),
                &self.preferences.keymap,
                &self.state,
                hands,
                &mut commands,
            );
        }
        let any = !commands.is_empty();
        let before = self.document.scene().rev;
        for command in commands {
            self.execute(command, ui.ctx());
        }
        let edited = self.document.scene().rev != before;
        self.frame_drawn(ui.ctx(), edited);
        let at_once = edited && self.show_at_once(ui.ctx());
        if any && !at_once || self.frames.passes < 3 {
            ui.ctx().request_repaint();
        }
    }

    /// True while a dialog lies over all panes.
    pub(crate) fn has_dialog(&self) -> bool {
        self.files.unsaved.is_some()
            || self.files.dialogs.is_open()
            || self.state.windows.keys
            || self.state.windows.start
            || self.overlays.palette.open
            || self.asks_to_recover()
            || self.state.tools.row_open
    }

    pub(crate) fn take_window_events(&mut self, ctx: &egui::Context, commands: &mut Vec<Command>) {
        let dropped = ctx.input(|i| i.raw.dropped_files.first().map(|f| f.path().to_path_buf()));
        commands.extend(dropped.map(|path| Command::File(FileCommand::OpenPath(path))));
        if ctx.input(|i| i.viewport().close_requested()) && !self.files.may_close && self.document.is_dirty()
        {
            ctx.send_viewport_cmd(egui::ViewportCommand::CancelClose);
            self.files.unsaved = Some(Next::Quit);
        }
    }

    pub(crate) fn bars(&mut self, ui: &mut Ui, scene: &Scene, commands: &mut Vec<Command>) {
        let input = ToolbarInput {
            name: &self.files.called(&scene.name),
            dirty: self.document.is_dirty(),
            recent: &self.preferences.settings.recent,
            undo: self.undo_step(),
            redo: self.document.redo_own_label(),
            live: self.generation.live.on,
            busy: self.generation.live.running.is_some(),
            marked: !self.state.tools.region.is_empty(),
            waiting: self
                .generation
                .live
                .has_waiting(self.document.settled_scene().content()),
            bookmarks: self.preferences.settings.bookmarks.keys().copied().collect(),
            has_paint: scene.frame().painted.iter_set().next().is_some(),
            workspace: self.preferences.settings.workspace,
            shown: panes::infos()
                .iter()
                .map(|p| p.id)
                .filter(|id| self.views.dock.is_shown(*id))
                .collect(),
            cameras: scene.rig.cameras.len(),
            presets: self.generation.tuning.predicted(),
            preset: self.generation.tuning.current(&self.generation.live.params),
        };
        egui::Panel::top("toolbar")
            .exact_size(42.0)
            .frame(theme::bar_frame())
            .show_separator_line(false)
            .show(ui, |ui| toolbar_ui(ui, &input, &self.state.tools, commands));
        let now_s = self.now_s();
        let settled = self.document.settled_scene().clone();
        let touched = self.generation.live.touched_by(&settled, now_s);
        self.generation.unsettled = self.generation.live.parts();
        let unsettled = !touched.is_empty;
        let findings = self
            .threads
            .checking
            .findings()
            .map(|all| SeverityCounts::from_findings(waive::open(settled.frame(), all)));
        if let Some(counts) = findings.filter(|_| !self.threads.checking.is_stale(settled.rev)) {
            self.generation.versions.note_findings(settled.content(), counts);
        }
        let status = StatusInput {
            findings,
            running: self.generation.live.running.as_ref(),
            shows_what_comes: self.generation.shows_what_comes(settled.content()),
            now_s,
            receipt: self.generation.receipt.as_ref(),
            live: self.generation.live.on,
            unsettled,
            busy_with: self.files.opening.as_ref().map(|o| o.what.as_str()),
            exporting: self.files.exporting.under_way(),
            unread: self.toasts.unread(),
            paused: self.generation.live.paused.as_ref(),
            waiting: self.generation.live.has_waiting(settled.content()),
            dragging: self.document.is_dragging(),
            hint: &crate::shell::hints::hint(&self.state),
        };
        egui::Panel::bottom("status")
            .exact_size(28.0)
            .frame(theme::bar_frame())
            .show_separator_line(false)
            .show(ui, |ui| status_ui(ui, &status, &self.state.pointed, commands));
        // The status bar has shown the readout of the last frame.
        self.state.pointed.readout.clear();
        let place = self.state.pointed.place_now.take();
        if place != self.state.pointed.place {
            // Panes that were drawn before the one under the pointer show the mark in the next frame.
            ui.ctx().request_repaint();
        }
        self.state.pointed.place = place;
    }

    pub(crate) fn views(&mut self, ui: &mut Ui, scene: &Arc<Scene>, commands: &mut Vec<Command>) {
        self.state.pointed.pane = None;
        self.views.center = ui.available_rect_before_wrap();
        self.dock_ui(ui, scene, commands);
        // Without the list of checks on screen, no finding is marked.
        if !self.views.dock.is_shown(PaneId::CHECKS) {
            self.state.shown.finding_marks = None;
        }
        // (a maximized view keeps the marks of the list behind it)
        let dock = &self.views.dock;
        if dock.maximized.is_none() && !dock.is_shown(PaneId::named("perception")) {
            self.state.shown.detection_marks = None;
        }
        self.generation.live.named = self.state.named;
        self.generation.live.seed = self.state.seed.value;
    }

    /// Sets the state that the present one is compared with in this frame.
    pub(crate) fn prepare_compare(&mut self, ui: &Ui) {
        // The key has no effect during a drag, because the pointer does not act while the reference state is shown.
        let held = !ui.ctx().text_edit_focused()
            && ui.input(|i| {
                let down = i.modifiers.is_none() && i.key_down(egui::Key::Backslash);
                down && (self.state.compare.holding_reference || !i.pointer.any_down())
            });
        self.state.compare.holding_reference = held;
        let rev = self.document.settled_scene().content();
        let active = held || self.state.compare.mode != CompareMode::Off;
        let chosen = self.views.compare.chosen.as_ref().filter(|s| s.content() != rev);
        let versions = &self.generation.versions;
        let version = chosen.and_then(|s| versions.index_of(s.content()));
        self.state.compare.with = version.map(|i| versions.list()[i].title().to_owned());
        let reference = chosen
            .or_else(|| self.generation.versions.before(rev))
            .filter(|_| active)
            .cloned();
        let senses = active;
        let ctx = ui.ctx().clone();
        self.views.compare.prepare(
            reference,
            Wanted::from_settings(
                &self.state.cameras,
                &self.state.lidar,
                &Default::default(),
                self.document.scene().rig.cameras.len(),
            ),
            senses,
            &self.preferences.settings.painting,
            move || ctx.request_repaint(),
        );
    }

    pub(crate) fn overlays(&mut self, ui: &mut Ui, scene: &Scene, commands: &mut Vec<Command>) {
        let now_s = self.now_s();
        let rev = self.document.scene().rev;
        let cameras = CamerasInput::from_scene(scene, rev, &self.threads.sensing, &self.state.cameras);
        self.views
            .strip
            .enlarged(ui, self.views.center, &cameras, &mut self.state, commands);
        self.toasts
            .log_window(ui, self.views.center, &mut self.state.windows.log);
        if self.state.windows.sensors {
            let UiState { windows, cameras, .. } = &mut self.state;
            sensors_ui(ui, &scene.rig, windows, cameras, commands);
        }
        if let Some(shown) = self.threads.planning.shown() {
            repairs_ui(ui, shown, self.document.settled_scene().rev, commands);
        }
        crate::windows::row::show(ui, scene, &mut self.state.tools, commands);
        let known = Known {
            keymap: &self.preferences.keymap,
            recent: &self.preferences.settings.recent,
            scene,
            learned: self.preferences.settings.learned_pictures,
        };
        self.overlays.palette.show(ui, &known, commands);
        self.overlays
            .shortcuts
            .show(ui, &mut self.preferences.keymap, &mut self.state.windows.keys);
        let choices = Choices {
            settings: &mut self.preferences.settings,
            keymap: &mut self.preferences.keymap,
            guests: &self.guests,
        };
        settings_ui(ui, choices, &mut self.state.windows, commands);
        let learned = self.preferences.settings.learned_pictures;
        capture_ui(ui, &mut self.state.windows.capture, (scene, learned), commands);
        start_ui(
            ui,
            &mut self.preferences.settings,
            &mut self.state.windows.start,
            commands,
        );
        // The bar stands over the 3D view, where it hides no list.
        let over = match self.views.view3d.rect.is_positive() {
            true => self.views.view3d.rect,
            false => self.views.center,
        };
        self.staged_ui(ui, over, commands);
        performance_ui(ui, over, &mut self.frames.perf);
        self.toasts.show(ui, over, now_s);
        let mut tour = self.state.windows.tour.take();
        // The tour stands over the map, on which its steps begin.
        let map = self.views.canvas.map.map_or(self.views.center, |map| map.rect);
        tour_ui(ui, map, &mut tour, &self.document);
        self.state.windows.tour = tour;
        if ui.input(|i| !i.raw.hovered_files.is_empty()) {
            drop_hint(ui, self.views.center);
        }
        self.export_dialog(ui);
        self.batches_ui(ui);
        self.picking_ui(ui);
        self.take_model();
        self.recovery_dialog(ui);
        if self.files.unsaved.is_some()
            && let Some(answer) = unsaved::unsaved_ui(ui, &scene.name, self.waits_to_be_shown().as_deref())
        {
            self.answer_unsaved(answer, ui.ctx());
        }
        if let Some((purpose, path)) = self.files.dialogs.show(ui) {
            let ctx = ui.ctx().clone();
            self.file_chosen(purpose, path, &ctx);
        }
    }

    pub(crate) fn answer_unsaved(&mut self, answer: Unsaved, ctx: &egui::Context) {
        let Some(next) = self.files.unsaved.take() else {
            return;
        };
        match answer {
            Unsaved::Stay => {}
            Unsaved::Discard => self.go_on(next, ctx),
            Unsaved::Save => {
                self.files.after_save = Some(next);
                self.execute(Command::File(FileCommand::Save), ctx);
            }
        }
    }
}

fn drop_hint(ui: &Ui, over: Rect) {
    let layer = egui::LayerId::new(egui::Order::Foreground, egui::Id::unique("drop"));
    let painter = ui.ctx().layer_painter(layer);
    painter.rect_filled(over, 0.0, egui::Color32::from_black_alpha(170));
    let font = egui::TextStyle::Heading.resolve(ui.style());
    painter.text(
        over.center(),
        egui::Align2::CENTER_CENTER,
        t("Drop to open"),
        font,
        theme::ON_CANVAS,
    );
}
/// True if the pointer is over a window that shows no part of the scene: not over the panes, the bar of a staged
/// result, or an enlarged camera, in which a click chooses boxes as in a pane.
fn is_over_window(ctx: &egui::Context) -> bool {
    let layer = ctx.pointer_latest_pos().and_then(|at| ctx.layer_id_at(at));
    let of_the_scene = [super::staged::bar_id(), camera_strip::enlarged_id()];
    layer.is_some_and(|layer| layer.order == egui::Order::Middle && !of_the_scene.contains(&layer.id))
}
