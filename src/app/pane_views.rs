//! What each pane shows: the present state, the one before it, or both.

use std::sync::Arc;

use egui::{Rect, Ui, UiBuilder};

use scene::Scene;

use super::application::{SceneloomApp, cameras_input};
use super::camera_views::Wanted;
use super::canvas::CanvasInput;
use super::command::Command;
use super::compare::{CompareMode, legend, tag, wipe_line};
use super::panels::cameras::CamerasInput;
use super::panels::checks::{ChecksInput, checks_ui};
use super::panels::history::{history_title, history_ui};
use super::panels::layers::layers_ui;
use super::panels::objects::objects_ui;
use super::panels::panes;
use super::panels::trade::trade_ui;
use super::panels::versions::{versions_controls, versions_ui};
use super::state::Pane;
use super::theme;
use super::view3d::{View3d, View3dInput};

impl SceneloomApp {
    /// What the header of a pane offers, from right to left.
    pub(super) fn pane_controls(
        &mut self,
        ui: &mut Ui,
        pane: Pane,
        scene: &Arc<Scene>,
        commands: &mut Vec<Command>,
    ) {
        match pane {
            Pane::Bev => panes::bev_controls(ui, &mut self.state),
            Pane::View3d => panes::view3d_controls(ui, &mut self.view3d.options, &mut self.state, commands),
            Pane::Lidar => panes::lidar_controls(ui, &mut self.state),
            Pane::Versions => versions_controls(ui, &mut self.state),
            Pane::Cameras => {
                let rev = self.document.scene().rev;
                let cameras = cameras_input(scene, rev, &self.sensing);
                ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| {
                    self.strip.controls(ui, &cameras, &mut self.state, commands);
                });
            }
            Pane::Camera(_) => panes::camera_controls(ui, &mut self.state),
            Pane::History => {
                let text = history_title(&self.document);
                ui.label(egui::RichText::new(text).small().color(theme::text_weak()));
            }
            _ => {}
        }
    }

    /// Draws a pane below its header.
    pub(super) fn pane(&mut self, ui: &mut Ui, pane: Pane, scene: &Arc<Scene>, commands: &mut Vec<Command>) {
        let area = ui.available_rect_before_wrap();
        match pane {
            Pane::Bev => self.bev_pane(ui, area, scene, commands),
            Pane::View3d => self.view3d_pane(ui, area, scene, commands),
            Pane::Cameras | Pane::Camera(_) => self.cameras_pane(ui, area, pane, scene, commands),
            Pane::Lidar => self.lidar_pane(ui, area, scene),
            Pane::BoxViews => {
                let sweep = self.sensing.lidar().map(|l| &**l);
                self.box_views.show(ui, scene, sweep, &self.state, commands);
            }
            Pane::Prompt => {
                let prompt = &mut self.prompt;
                let scene = self.document.settled_scene();
                theme::panel_frame().show(ui, |ui| prompt.show(ui, scene, commands));
            }
            Pane::Versions => {
                let shown = self.document.settled_scene().rev;
                let before = self.compare.before.as_ref().map(|s| s.rev);
                let versions = &mut self.versions;
                theme::panel_frame().show(ui, |ui| versions_ui(ui, versions, shown, before, commands));
            }
            Pane::Tools => {
                let frame = self.document.scene().frame();
                theme::panel_frame().show(ui, |ui| layers_ui(ui, frame, &mut self.state, commands));
            }
            Pane::Trade => {
                let (tuning, params) = (&mut self.tuning, self.live.params);
                theme::panel_frame().show(ui, |ui| trade_ui(ui, tuning, &params, commands));
            }
            Pane::History => {
                theme::panel_frame().show(ui, |ui| history_ui(ui, &self.document, commands));
            }
            Pane::Checks => {
                let input = ChecksInput {
                    findings: self.checking.findings().map(|f| f.as_slice()),
                    stale: self.checking.is_stale(self.document.settled_scene().rev),
                    selected: self.state.selected,
                    frame: self.document.settled_scene().frame(),
                };
                let meant = theme::panel_frame()
                    .show(ui, |ui| checks_ui(ui, &input, commands))
                    .inner;
                if self.state.meant.as_deref() != meant.as_ref() {
                    self.state.meant = meant.map(Arc::new);
                    // The views are drawn before this pane or after it.
                    ui.ctx().request_repaint();
                }
            }
            Pane::Objects => {
                theme::panel_frame().show(ui, |ui| objects_ui(ui, &self.document, &mut self.state, commands));
            }
        }
        if self.state.holding_before && is_view(pane) {
            tag(ui, area.left_top() + egui::vec2(8.0, 8.0), "before", false);
        }
        if ui.rect_contains_pointer(area) {
            self.state.hovered_pane = Some(pane);
        }
    }

    /// Decides what the present state is compared with, in this frame.
    pub(super) fn prepare_compare(&mut self, ui: &Ui) {
        // Not in the middle of a drag: the pointer answers to nothing while the state before is shown.
        let held = !ui.ctx().text_edit_focused()
            && ui.input(|i| {
                let down = i.modifiers.is_none() && i.key_down(egui::Key::Backslash);
                down && (self.state.holding_before || !i.pointer.any_down())
            });
        self.state.holding_before = held;
        let rev = self.document.settled_scene().rev;
        let active = held || self.state.compare != CompareMode::Off;
        let chosen = self.compare.chosen.as_ref().filter(|s| s.rev != rev);
        let before = chosen
            .or_else(|| self.versions.before(rev))
            .filter(|_| active)
            .cloned();
        let senses = held || matches!(self.state.compare, CompareMode::Wipe | CompareMode::Side);
        let ctx = ui.ctx().clone();
        self.compare
            .prepare(before, Wanted::of(&self.state), senses, move || {
                ctx.request_repaint()
            });
    }

    /// The state before is shown alone: its key is held.
    fn shows_before(&self, scene: &Arc<Scene>) -> bool {
        self.state.holding_before && state_holds(&self.compare.before, scene)
    }

    /// The way to compare, if there is something to compare with and no key is held that shows it alone.
    fn comparing(&self) -> CompareMode {
        match &self.compare.before {
            Some(_) if !self.state.holding_before => self.state.compare,
            _ => CompareMode::Off,
        }
    }

    fn bev_pane(&mut self, ui: &mut Ui, area: Rect, scene: &Arc<Scene>, commands: &mut Vec<Command>) {
        let mode = self.comparing();
        let (left, right) = halves(area);
        let rect = if mode == CompareMode::Side { right } else { area };
        let input = CanvasInput {
            scene,
            settled: self.document.settled_scene(),
            lidar: self.sensing.lidar().map(|l| &**l),
            unsettled: self.unsettled.clone(),
            generating: self.live.running.is_some(),
        };
        if self.shows_before(scene)
            && let Some(map) = self.canvas.map
        {
            clipped(ui, area, |ui| {
                self.compare.canvas.still(ui, area, &map, scene, &self.state);
            });
            return;
        }
        let (canvas, state) = (&mut self.canvas, &mut self.state);
        in_rect(ui, rect, |ui| {
            canvas.show(ui, &input, state, commands);
        });
        if let (true, Some(last), Some(map)) =
            (self.tuning.show_modelled, &self.tuning.last, &self.canvas.map)
        {
            super::modelled::draw(ui, rect, map, last, self.sensing.sampled());
        }
        let (Some(before), Some(map)) = (self.compare.before.clone(), self.canvas.map) else {
            return;
        };
        match mode {
            CompareMode::Off => {}
            CompareMode::Side => {
                clipped(ui, left, |ui| {
                    self.compare.canvas.still(ui, left, &map, &before, &self.state);
                });
                sides(ui, left, right);
            }
            CompareMode::Wipe => {
                let part = left_part(area, self.state.wipe_at);
                clipped(ui, part, |ui| {
                    self.compare.canvas.still(ui, area, &map, &before, &self.state);
                });
                wipe_line(ui, area, &mut self.state.wipe_at);
            }
            CompareMode::Difference => {
                if let Some((difference, texture)) = self.compare.difference(ui, scene) {
                    let entries = difference.legend();
                    let far = glam::DVec2::splat(scene::GridSpec::MAX_M[0]);
                    let grid = Rect::from_two_pos(map.to_screen(-far), map.to_screen(far));
                    let unit = Rect::from_min_max(egui::pos2(0.0, 0.0), egui::pos2(1.0, 1.0));
                    let painter = ui.painter_at(area);
                    painter.image(texture, grid, unit, egui::Color32::WHITE);
                    legend(ui, area.left_top() + egui::vec2(8.0, 8.0), &entries);
                }
            }
        }
    }

    fn view3d_pane(&mut self, ui: &mut Ui, area: Rect, scene: &Arc<Scene>, commands: &mut Vec<Command>) {
        let mode = self.comparing();
        let (left, right) = halves(area);
        let rect = if mode == CompareMode::Side { right } else { area };
        let shows_before = self.shows_before(scene);
        let difference = match mode {
            CompareMode::Difference => self.compare.difference(ui, scene).map(|(d, _)| d),
            _ => None,
        };
        let entries = difference.map(|d| d.legend());
        let marked = difference.map(|d| d.marked());
        let input = View3dInput {
            scene,
            settled: self.document.settled_scene(),
            lidar: self.sensing.lidar(),
            dragging: self.document.is_dragging(),
            marked: marked.as_ref().map_or(&[], |m| &m[..]),
        };
        let (view, state) = (&mut self.view3d, &mut self.state);
        if shows_before {
            let (camera, options) = (view.camera, view.options.clone());
            clipped(ui, area, |ui| {
                view.still(ui, area, (&camera, &options), &input, state)
            });
            return;
        }
        in_rect(ui, rect, |ui| {
            view.show(ui, &input, state, commands);
        });
        if let Some(entries) = entries {
            legend(ui, rect.left_top() + egui::vec2(8.0, 8.0), &entries);
        }
        let Some(before) = self.compare.before.clone() else {
            return;
        };
        if !matches!(mode, CompareMode::Side | CompareMode::Wipe) {
            return;
        }
        let other = self
            .compare
            .view3d
            .get_or_insert_with(|| View3d::new(self.render_state.clone()));
        let lidar = self.compare.sensing.as_ref().and_then(|s| s.lidar());
        let input = View3dInput {
            scene: &before,
            settled: &before,
            lidar,
            dragging: false,
            marked: &[],
        };
        let looks = (&self.view3d.camera, &self.view3d.options);
        if mode == CompareMode::Side {
            clipped(ui, left, |ui| other.still(ui, left, looks, &input, &self.state));
            sides(ui, left, right);
        } else {
            let part = left_part(area, self.state.wipe_at);
            clipped(ui, part, |ui| other.still(ui, area, looks, &input, &self.state));
            wipe_line(ui, area, &mut self.state.wipe_at);
        }
    }

    fn cameras_pane(
        &mut self,
        ui: &mut Ui,
        area: Rect,
        pane: Pane,
        scene: &Arc<Scene>,
        commands: &mut Vec<Command>,
    ) {
        let mode = self.comparing();
        let area = area.shrink2(egui::vec2(8.0, 2.0));
        let now = cameras_input(scene, self.document.scene().rev, &self.sensing);
        let before = self.compare.before.clone();
        let other = match (&before, &self.compare.sensing) {
            (Some(before), Some(sensing)) => Some(cameras_input(before, before.rev, sensing)),
            _ => None,
        };
        let state = &mut self.state;
        let mut draw = |ui: &mut Ui,
                        rect: Rect,
                        strip: &mut super::panels::cameras::CameraStrip,
                        input: &CamerasInput<'_>| {
            in_rect(ui, rect, |ui| match pane {
                Pane::Camera(i) => strip.single(ui, i, input, state, commands),
                _ => strip.show(ui, input, state, commands),
            });
        };
        match (mode, other) {
            (_, Some(other)) if state_holds(&self.compare.before, scene) => {
                draw(ui, area, &mut self.compare.strip, &other);
            }
            (CompareMode::Side, Some(other)) => {
                let (top, bottom) = match pane {
                    Pane::Camera(_) => halves(area),
                    _ => (
                        Rect::from_min_max(area.min, egui::pos2(area.right(), area.center().y - 1.0)),
                        Rect::from_min_max(egui::pos2(area.left(), area.center().y + 1.0), area.max),
                    ),
                };
                self.strip.wipe(None);
                draw(ui, top, &mut self.compare.strip, &other);
                draw(ui, bottom, &mut self.strip, &now);
            }
            (CompareMode::Wipe, Some(other)) => {
                let textures = self.compare.strip.textures(ui, &other, &self.state);
                self.strip.wipe(Some((textures, self.state.wipe_at)));
                let state = &mut self.state;
                in_rect(ui, area, |ui| match pane {
                    Pane::Camera(i) => self.strip.single(ui, i, &now, state, commands),
                    _ => self.strip.show(ui, &now, state, commands),
                });
            }
            _ => {
                self.strip.wipe(None);
                draw(ui, area, &mut self.strip, &now);
            }
        }
    }

    fn lidar_pane(&mut self, ui: &mut Ui, area: Rect, scene: &Arc<Scene>) {
        let mode = self.comparing();
        let before = self.compare.before.clone();
        let other = self.compare.sensing.as_ref().and_then(|s| s.lidar()).cloned();
        if let (true, Some(before)) = (self.state.holding_before, &before) {
            let sweep = &mut self.compare.sweep;
            sweep.show(ui, before, other.as_ref(), &mut self.state);
            return;
        }
        let (top, bottom) = (
            Rect::from_min_max(area.min, egui::pos2(area.right(), area.center().y - 1.0)),
            Rect::from_min_max(egui::pos2(area.left(), area.center().y + 1.0), area.max),
        );
        let rect = if mode == CompareMode::Side { bottom } else { area };
        in_rect(ui, rect, |ui| {
            self.sweep.show(ui, scene, self.sensing.lidar(), &mut self.state);
        });
        let Some(before) = before else { return };
        match mode {
            CompareMode::Side => in_rect(ui, top, |ui| {
                self.compare
                    .sweep
                    .show(ui, &before, other.as_ref(), &mut self.state);
            }),
            CompareMode::Wipe => {
                let part = left_part(area, self.state.wipe_at);
                clipped(ui, part, |ui| {
                    in_rect(ui, area, |ui| {
                        self.compare
                            .sweep
                            .show(ui, &before, other.as_ref(), &mut self.state);
                    });
                });
                wipe_line(ui, area, &mut self.state.wipe_at);
            }
            _ => {}
        }
    }
}

/// True while the scene shown is the one compared with: its key is held.
fn state_holds(before: &Option<Arc<Scene>>, shown: &Arc<Scene>) -> bool {
    before.as_ref().is_some_and(|b| Arc::ptr_eq(b, shown))
}

fn is_view(pane: Pane) -> bool {
    matches!(
        pane,
        Pane::Bev | Pane::View3d | Pane::Cameras | Pane::Camera(_) | Pane::Lidar
    )
}

fn halves(area: Rect) -> (Rect, Rect) {
    let (left, right) = area.split_left_right_at_fraction(0.5);
    (
        left.with_max_x(left.right() - 1.0),
        right.with_min_x(right.left() + 1.0),
    )
}

fn left_part(area: Rect, at: f32) -> Rect {
    area.with_max_x(area.left() + area.width() * at)
}

fn sides(ui: &Ui, left: Rect, right: Rect) {
    tag(ui, left.left_top() + egui::vec2(8.0, 8.0), "before", false);
    tag(ui, right.left_top() + egui::vec2(8.0, 8.0), "after", false);
}

fn in_rect(ui: &mut Ui, rect: Rect, add: impl FnOnce(&mut Ui)) {
    ui.scope_builder(UiBuilder::new().max_rect(rect), |ui| {
        ui.set_clip_rect(ui.clip_rect().intersect(rect));
        add(ui);
    });
}

fn clipped(ui: &mut Ui, clip: Rect, add: impl FnOnce(&mut Ui)) {
    ui.scope(|ui| {
        ui.set_clip_rect(ui.clip_rect().intersect(clip));
        add(ui);
    });
}
