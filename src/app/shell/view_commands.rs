//! Carries out commands about views, panes and open windows.

use super::app::SceneloomApp;
use super::views::BeforeClean;
use super::workspace::Workspace;
use crate::command::{ViewCommand, Window};
use crate::look::Look;
use crate::panes::compare::CompareMode;
use crate::panes::id::PaneId;
use crate::tools::ToolId;
use editor::tools::{brush, region, select, voxel};
use language::t;
use sensors::cameras::pictures;

impl SceneloomApp {
    /// Carries out one view command.
    pub(crate) fn view_command(&mut self, command: ViewCommand, ctx: &egui::Context) {
        match command {
            ViewCommand::KeepBookmark(slot) => self.keep_bookmark(slot),
            ViewCommand::GoToBookmark(slot) => self.go_to_bookmark(slot),
            ViewCommand::CompareWith(rev) => {
                let version = self
                    .generation
                    .versions
                    .index_of(rev)
                    .map(|i| &self.generation.versions.list()[i]);
                self.views.compare.chosen = version.map(|v| v.scene.clone());
                if self.state.compare.mode == CompareMode::Off {
                    self.state.compare.mode = CompareMode::Wipe;
                }
            }
            ViewCommand::CycleCompare => {
                let rev = self.document.settled_scene().content();
                let other = self
                    .views
                    .compare
                    .chosen
                    .as_ref()
                    .is_some_and(|s| s.content() != rev);
                let off = self.state.compare.mode == CompareMode::Off;
                if off && !other && self.generation.versions.before(rev).is_none() {
                    return self.note(t("Nothing to compare with yet: each generation makes a version"));
                }
                self.state.compare.mode = self.state.compare.mode.next();
            }
            ViewCommand::FrameSelection => self.frame_selection(),
            ViewCommand::FrameAll => match self.state.pointed.pane {
                Some(PaneId::VIEW3D) => self.views.view3d.frame_map(self.extent()),
                Some(PaneId::BEV) => self.views.canvas.frame_all_again(),
                _ => self.views.frame_all(self.extent()),
            },
            ViewCommand::FrameAt(p_in_ego) => self.frame_at(p_in_ego),
            ViewCommand::Preset(preset) => self.views.view3d.preset(preset, self.extent()),
            ViewCommand::ToggleParallel => self.views.view3d.toggle_parallel(),
            ViewCommand::ToggleLook => {
                self.state.shown.look = match self.state.shown.look {
                    Look::Voxels => Look::Pictures,
                    Look::Pictures => Look::Voxels,
                };
            }
            ViewCommand::LookThrough(index) => self.look_through(index),
            ViewCommand::Cameras(view) => self.state.cameras.view = view,
            ViewCommand::ShowLight => {
                if !self.state.cameras.shown_source().about().needs.conditions {
                    self.state.cameras.view = pictures::VIEW.id;
                }
            }
            ViewCommand::PaintAgain => self.threads.sensing.paint_again(),
            ViewCommand::StopPainting => self.threads.sensing.stop_painting(),
            ViewCommand::Inspect(camera) => self.state.cameras.enlarged = camera,
            ViewCommand::SwapPanes => self.views.dock.swap(PaneId::BEV, PaneId::VIEW3D),
            ViewCommand::ShowPane(pane) => self.views.dock.open(pane),
            ViewCommand::TogglePane(pane) => self.views.dock.toggle(pane),
            ViewCommand::MaximizePane => {
                if let Some(tile) = self
                    .state
                    .pointed
                    .pane
                    .and_then(|pane| self.views.dock.find(pane))
                {
                    self.views.dock.toggle_maximized(tile);
                }
            }
            ViewCommand::Workspace(workspace) => {
                let before = std::mem::replace(&mut self.preferences.settings.workspace, workspace);
                // Overlays that belong to one kind of work are switched off with its controls.
                self.state.compare.mode = CompareMode::Off;
                self.generation.tuning.show_modelled &= workspace == Workspace::Trade;
                self.views.change_workspace(before, workspace);
                // The workspace takes its tool, unless a tool of its kind is in hand already.
                self.state.tool = match (workspace, self.state.tool) {
                    (Workspace::Paint, tool) if paints_map(tool) => tool,
                    (Workspace::Paint, _) => brush::ID,
                    (Workspace::Voxels, _) => voxel::ID,
                    (_, tool) if tool == brush::ID || tool == voxel::ID => select::ID,
                    (_, tool) => tool,
                };
            }
            ViewCommand::FocusPrompt => {
                self.views.dock.open(PaneId::PROMPT);
                self.views.prompt.focus();
            }
            ViewCommand::ToggleGrid => self.state.shown.grid = !self.state.shown.grid,
            ViewCommand::ToggleClean => self.toggle_clean(),
            ViewCommand::ToggleFullScreen => {
                let is_full = ctx.input(|i| i.viewport().fullscreen.unwrap_or(false));
                ctx.send_viewport_cmd(egui::ViewportCommand::Fullscreen(!is_full));
            }
        }
    }

    /// Removes all drawings over the scene from both views, or restores them.
    fn toggle_clean(&mut self) {
        let options = &mut self.views.view3d.options;
        let (shown, playback) = (&mut self.state.shown, &mut self.state.playback);
        if let Some(before) = self.views.before_clean.take() {
            shown.clone_from(&before.shown);
            options.clone_from(&before.options);
            playback.paths = before.paths;
            return;
        }
        self.views.before_clean = Some(Box::new(BeforeClean {
            shown: shown.clone(),
            options: options.clone(),
            paths: playback.paths,
        }));
        (shown.boxes, shown.lines, shown.grid) = (false, false, false);
        (shown.lidar_from_above, shown.unobserved) = (false, false);
        (options.lidar, options.frusta) = (false, false);
        playback.paths = false;
    }

    pub(crate) fn frame_selection(&mut self) {
        let Some(b) = self.selected_box() else {
            return self.frame_things();
        };
        if self.state.pointed.pane != Some(PaneId::VIEW3D) {
            self.views.canvas.frame_box(&b);
        }
        if self.state.pointed.pane != Some(PaneId::BEV) {
            self.views.view3d.frame_box(&b);
        }
    }

    pub(crate) fn look_through(&mut self, index: usize) {
        if let Some(camera) = self.document.scene().with_rig_in_world().rig.cameras.get(index) {
            self.views.view3d.camera = viewport::ViewCamera::through(camera);
            self.views.view3d.parallel = false;
        }
    }

    /// Shows or hides a window.
    pub(crate) fn toggle(&mut self, window: Window) {
        match window {
            Window::Export => self.toggle_export(),
            Window::Batches => self.toggle_batches(),
            Window::Capture => {
                let dialog = &mut self.state.windows.capture;
                dialog.open = !dialog.open;
            }
            Window::Palette => self.overlays.palette.toggle(),
            Window::Settings => self.state.windows.settings = !self.state.windows.settings,
            Window::Start => self.state.windows.start = !self.state.windows.start,
            Window::Sensors => self.state.windows.sensors = !self.state.windows.sensors,
            Window::Performance => self.frames.perf.open = !self.frames.perf.open,
            Window::Log => self.state.windows.log = !self.state.windows.log,
            Window::Keys => self.state.windows.keys = !self.state.windows.keys,
        }
    }
}

/// True for a tool that paints the map.
fn paints_map(tool: ToolId) -> bool {
    tool == region::ID || tool.def().paints && tool != voxel::ID
}
