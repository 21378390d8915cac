//! One frame of the window: its bars, panes and what lies over them.

use std::sync::Arc;

use egui::{Rect, Ui};

use super::{Next, SceneloomApp, cameras_input};
use crate::command::Command;
use crate::keys;
use crate::keys::Hands;
use crate::panels::dialogs::{self, Unsaved};
use crate::panels::performance::performance_ui;
use crate::panels::sensors::sensors_ui;
use crate::panels::settings::settings_ui;
use crate::panels::start::start_ui;
use crate::panels::status::{StatusInput, status_ui};
use crate::panels::toolbar::{ToolbarInput, toolbar_ui};
use crate::state::Pane;
use crate::theme;
use editor::checks::{Severity, waive};
use scene::Scene;

impl SceneloomApp {
    /// Draws the window and carries out what the user asked for.
    pub fn draw(&mut self, ui: &mut Ui) {
        self.passes = self.passes.saturating_add(1);
        let mut commands = Vec::new();
        self.take_window_events(ui.ctx(), &mut commands);
        self.tidy_staging();
        self.prepare_compare(ui);
        let scene = self.shown_scene();
        // What a dialog covers answers nothing, and keeps no tooltip open over it.
        let mut below = ui.new_child(egui::UiBuilder::new().max_rect(ui.max_rect()));
        if self.has_dialog() {
            below.visuals_mut().disabled_alpha = 1.0;
            below.disable();
        }
        self.bars(&mut below, &scene, &mut commands);
        self.views(&mut below, &scene, &mut commands);
        // Asked before: the key that closes a dialog is no shortcut.
        let dialog = self.has_dialog();
        self.overlays(ui, &scene, &mut commands);
        // What is shown is not what a key would change.
        if !dialog && !self.state.holding_before {
            let (primary, secondary) = ui.input(|i| (i.pointer.primary_down(), i.pointer.secondary_down()));
            let hands = Hands {
                flying: secondary && self.state.hovered_pane == Some(Pane::View3d),
                dragging: primary && (self.canvas.is_dragging() || self.view3d.is_dragging()),
            };
            keys::commands(ui.ctx(), &self.keymap, &mut self.state, hands, &mut commands);
        }
        let any = !commands.is_empty();
        let before = self.document.scene().rev;
        for command in commands {
            self.execute(command, ui.ctx());
        }
        let edited = self.document.scene().rev != before;
        self.frame_drawn(ui.ctx(), edited);
        let at_once = edited && self.show_at_once(ui.ctx());
        if any && !at_once || self.passes < 3 {
            ui.ctx().request_repaint();
        }
    }

    /// True while a dialog lies over everything.
    pub(super) fn has_dialog(&self) -> bool {
        self.unsaved.is_some()
            || self.dialogs.is_open()
            || self.state.keys_open
            || self.state.start_open
            || self.palette.open
            || self.asks_to_recover()
            || self.state.tools.row_open
    }

    pub(super) fn take_window_events(&mut self, ctx: &egui::Context, commands: &mut Vec<Command>) {
        let dropped = ctx.input(|i| i.raw.dropped_files.first().map(|f| f.path().to_path_buf()));
        commands.extend(dropped.map(Command::OpenPath));
        if ctx.input(|i| i.viewport().close_requested()) && !self.may_close && self.document.is_dirty() {
            ctx.send_viewport_cmd(egui::ViewportCommand::CancelClose);
            self.unsaved = Some(Next::Quit);
        }
    }

    pub(super) fn bars(&mut self, ui: &mut Ui, scene: &Scene, commands: &mut Vec<Command>) {
        let input = ToolbarInput {
            name: &scene.name,
            dirty: self.document.is_dirty(),
            recent: &self.settings.recent,
            undo: self.document.undo_label(),
            redo: self.document.redo_label(),
            live: self.live.on,
            busy: self.live.running.is_some(),
            waiting: self.live.has_waiting(self.document.settled_scene().rev),
            bookmarks: self.settings.bookmarks.keys().copied().collect(),
            has_paint: scene.frame().painted.iter_set().next().is_some(),
            workspace: self.settings.workspace,
            shown: Pane::CHOICES
                .into_iter()
                .filter(|p| self.dock.is_shown(*p))
                .collect(),
            cameras: scene.rig.cameras.len(),
            stops: self.tuning.foretold(),
            stop: self.tuning.current(&self.live.params),
        };
        egui::Panel::top("toolbar")
            .exact_size(42.0)
            .frame(theme::bar_frame())
            .show_separator_line(false)
            .show(ui, |ui| toolbar_ui(ui, &input, &mut self.state, commands));
        let now_s = self.now_s();
        let settled = self.document.settled_scene().clone();
        let touched = self.live.look(&settled, now_s);
        self.unsettled = self.live.parts();
        let unsettled = !touched.is_empty;
        let findings = self.checking.findings().map(|all| {
            let open = waive::open(settled.frame(), all);
            let (errors, warnings): (Vec<_>, Vec<_>) = open.partition(|f| f.severity == Severity::Error);
            (errors.len(), warnings.len())
        });
        let status = StatusInput {
            findings,
            running: self.live.running.as_ref(),
            shows_what_comes: self.shows_what_comes(),
            now_s,
            receipt: self.receipt.as_ref(),
            live: self.live.on,
            unsettled,
            busy_with: self.opening.as_ref().map(|o| o.what.as_str()),
            unread: self.toasts.unread(),
            paused: self.live.paused.as_ref(),
            waiting: self.live.has_waiting(settled.rev),
            dragging: self.document.is_dragging(),
            hint: &crate::hints::hint(&self.state),
        };
        egui::Panel::bottom("status")
            .exact_size(28.0)
            .frame(theme::bar_frame())
            .show_separator_line(false)
            .show(ui, |ui| status_ui(ui, &status, &self.state, commands));
        // The status bar has shown what the last frame found under the pointer.
        self.state.readout.clear();
    }

    pub(super) fn views(&mut self, ui: &mut Ui, scene: &Arc<Scene>, commands: &mut Vec<Command>) {
        self.state.hovered_pane = None;
        self.center = ui.available_rect_before_wrap();
        self.dock_ui(ui, scene, commands);
        // What nobody lists is not pointed at.
        if !self.dock.is_shown(Pane::Checks) {
            self.state.meant = None;
        }
        self.live.named = self.state.named;
    }

    pub(super) fn overlays(&mut self, ui: &mut Ui, scene: &Scene, commands: &mut Vec<Command>) {
        let now_s = self.now_s();
        let cameras = cameras_input(scene, self.document.scene().rev, &self.sensing);
        self.strip
            .enlarged(ui, self.center, &cameras, &mut self.state, commands);
        self.toasts.log_window(ui, self.center, &mut self.state.log_open);
        if self.state.sensors_open {
            sensors_ui(ui, &scene.rig, &mut self.state, commands);
        }
        crate::panels::row::show(ui, scene.frame(), &mut self.state, commands);
        let recent = &self.settings.recent;
        self.palette
            .show(ui, &self.keymap, recent, &mut self.state, commands);
        self.shortcuts
            .show(ui, &mut self.keymap, &mut self.state.keys_open);
        settings_ui(ui, &mut self.settings, &mut self.state.settings_open);
        start_ui(ui, &mut self.settings, &mut self.state.start_open, commands);
        // Over the 3D view, where it hides no list.
        let over = match self.view3d.rect.is_positive() {
            true => self.view3d.rect,
            false => self.center,
        };
        self.staged_ui(ui, over, commands);
        performance_ui(ui, over, &mut self.perf);
        self.toasts.show(ui, self.center, now_s);
        if ui.input(|i| !i.raw.hovered_files.is_empty()) {
            drop_hint(ui, self.center);
        }
        self.export_dialog(ui);
        self.recovery_dialog(ui);
        if self.unsaved.is_some()
            && let Some(answer) = dialogs::unsaved_ui(ui, &scene.name)
        {
            self.answer_unsaved(answer, ui.ctx());
        }
        if let Some((purpose, path)) = self.dialogs.show(ui) {
            let ctx = ui.ctx().clone();
            self.file_chosen(purpose, path, &ctx);
        }
    }

    pub(super) fn answer_unsaved(&mut self, answer: Unsaved, ctx: &egui::Context) {
        let Some(next) = self.unsaved.take() else { return };
        match answer {
            Unsaved::Stay => {}
            Unsaved::Discard => self.go_on(next, ctx),
            Unsaved::Save => {
                self.after_save = Some(next);
                self.execute(Command::Save, ctx);
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
        "Drop to open",
        font,
        theme::ON_CANVAS,
    );
}
