//! The scene lifted to 3D Gaussians and drawn like in a splat viewer. Flight starts at the viewpoint of the 3D view.

use std::sync::Arc;

use egui::accesskit::Role;
use egui::{
    Color32, Painter, PointerButton, Pos2, Rect, Response, Sense, Stroke, TextureHandle, TextureOptions, Ui,
    WidgetInfo, pos2,
};
use glam::{DVec2, DVec3};

use super::id::PaneId;
use super::pane::{Pane, PaneContext};
use crate::baking::{Baking, SplatViewpoint};
use crate::command::Command;
use crate::fly;
use crate::place_marks;
use crate::state::{UiState, called};
use crate::tools::ToolCommand;
use editor::pick::{self, PickHit, PickRay};
use editor::tools::point_of;
use language::{t, tf};
use scene::Scene;
use sensors::pictures::perspective::EDGES;
use viewport::ViewCamera;
use widgets::icons::Icon;
use widgets::theme;

/// Turn per point that the pointer moves, rad.
const ORBIT_RAD: f64 = 0.006;
/// Width of the picture while the view moves, and at rest, px.
const MOVING_PX: f32 = 320.0;
const STILL_PX: f32 = 960.0;
/// Time without motion after which the fine picture is drawn, s.
const SETTLE_S: f64 = 0.25;

/// The pane.
#[derive(Default)]
pub struct Splats {
    /// Last number of opened scenes; when it changes, the Gaussians of the other scene are dropped.
    opened: u64,
    baking: Option<Baking>,
    texture: Option<TextureHandle>,
    shown: Option<SplatViewpoint>,
    asked: Option<SplatViewpoint>,
    moved_s: f64,
    camera: Option<ViewCamera>,
}

impl Pane for Splats {
    fn id(&self) -> PaneId {
        PaneId::SPLATS
    }

    fn title(&self) -> String {
        "Gaussian splats".into()
    }

    fn icon(&self) -> Icon {
        Icon::Stack
    }

    fn controls(&mut self, ui: &mut Ui, cx: &mut PaneContext<'_>, _commands: &mut Vec<Command>) {
        let Some(baking) = &mut self.baking else {
            return;
        };
        if baking.busy.is_some() {
            if ui.button(t("Cancel baking")).clicked() {
                baking.cancel();
            }
            return;
        }
        let Some(baked) = &baking.baked else {
            return;
        };
        if baked.of != cx.document.settled_scene().rev {
            let button = egui::Button::new(t("Bake again")).fill(theme::accent_fill());
            if ui
                .add(button)
                .on_hover_text(t("the scene has changed since"))
                .clicked()
            {
                baking.bake(cx.document.settled_scene());
            }
        }
    }

    fn ui(&mut self, ui: &mut Ui, cx: &mut PaneContext<'_>, commands: &mut Vec<Command>) {
        if self.opened != cx.state.opened {
            *self = Self {
                opened: cx.state.opened,
                ..Self::default()
            };
        }
        let rect = ui.available_rect_before_wrap();
        let has = self.baking.as_ref().is_some_and(|b| b.baked.is_some());
        if !has {
            self.before(ui, rect, cx);
            return;
        }
        let response = ui.allocate_rect(rect, Sense::click_and_drag());
        response.widget_info(|| WidgetInfo::labeled(Role::Canvas, true, t("Splats")));
        navigate(ui, &response, &mut cx.view3d.camera);
        self.look(ui, rect, &cx.view3d.camera);
        let unit = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
        let painter = ui.painter().with_clip_rect(rect);
        match &self.texture {
            Some(texture) => painter.image(texture.id(), rect, unit, Color32::WHITE),
            None => painter.rect_filled(rect, 0.0, theme::well()),
        };
        let looks = Looks {
            // Splats are always drawn in perspective.
            camera: ViewCamera {
                ortho: false,
                ..cx.view3d.camera
            },
            rect,
        };
        looks.outline_chosen(&painter, cx.scene, cx.state);
        looks.answer(ui, &response, cx, commands);
        let busy = self.baking.as_ref().is_some_and(|b| b.busy.is_some());
        let text = match busy {
            true => self.progress(),
            false => {
                let count = self
                    .baking
                    .as_ref()
                    .and_then(|b| b.baked.as_ref())
                    .map_or(0, |b| b.count);
                tf!("{n} Gaussians", n = count)
            }
        };
        let font = egui::TextStyle::Small.resolve(ui.style());
        let at = rect.left_bottom() + egui::vec2(8.0, -8.0);
        let galley = painter.layout_no_wrap(text, font, theme::ON_CANVAS);
        let place = egui::Align2::LEFT_BOTTOM.anchor_size(at, galley.size());
        painter.rect_filled(place.expand(3.0), 3.0, Color32::from_black_alpha(150));
        painter.galley(place.min, galley, theme::ON_CANVAS);
        if busy {
            ui.ctx()
                .request_repaint_after(std::time::Duration::from_millis(500));
        }
    }
}

impl Splats {
    fn progress(&self) -> String {
        let share = self.baking.as_ref().map_or(0.0, |b| b.share);
        tf!(
            "Baking again: {percent} %",
            percent = format!("{:.0}", 100.0 * share)
        )
    }

    /// Draws the pane before anything was baked: a progress bar, or an explanation with the button that bakes.
    fn before(&mut self, ui: &mut Ui, rect: Rect, cx: &PaneContext<'_>) {
        if let Some(baking) = &mut self.baking {
            baking.update();
            if baking.baked.is_some() {
                ui.ctx().request_repaint();
            }
        }
        let mut within = ui.new_child(egui::UiBuilder::new().max_rect(rect.shrink(16.0)));
        within.vertical_centered(|ui| {
            ui.add_space((rect.height() / 2.0 - 60.0).max(8.0));
            if self.baking.as_ref().is_some_and(|b| b.busy.is_some()) {
                let share = self.baking.as_ref().map_or(0.0, |b| b.share);
                ui.label(t("Baking from pictures of many places…"));
                ui.add_space(theme::GAP);
                let bar = egui::ProgressBar::new(share).desired_width((rect.width() - 40.0).min(260.0));
                ui.add(bar.desired_height(14.0).text(format!("{:.0} %", 100.0 * share)));
                return;
            }
            let text = t(
                "The scene as 3-D Gaussians, with the colours of the camera pictures, as viewers of splats show it. It is baked in the background, a minute or two.",
            );
            ui.label(egui::RichText::new(text).color(theme::text_weak()));
            ui.add_space(theme::GAP);
            let button = egui::Button::new(t("Bake the scene")).fill(theme::accent_fill());
            if ui.add(button).clicked() {
                self.bake(ui, cx);
            }
            if let Some(problem) = self.baking.as_ref().and_then(|b| b.problem.as_ref()) {
                ui.colored_label(theme::bad(), problem);
            }
        });
    }

    fn bake(&mut self, ui: &Ui, cx: &PaneContext<'_>) {
        if self.baking.is_none() {
            let wake = ui.ctx().clone();
            // Without a thread the button has no effect.
            self.baking = Baking::spawn(Arc::new(move || wake.request_repaint())).ok();
        }
        if let Some(baking) = &mut self.baking {
            baking.bake(cx.document.settled_scene());
        }
    }

    /// Requests a picture for the camera, coarse while it moves.
    fn look(&mut self, ui: &Ui, rect: Rect, camera: &ViewCamera) {
        let now_s = ui.input(|i| i.time);
        if self.camera != Some(*camera) {
            (self.camera, self.moved_s) = (Some(*camera), now_s);
        }
        let moving = now_s - self.moved_s < SETTLE_S;
        if moving {
            let rest = std::time::Duration::from_secs_f64(SETTLE_S);
            ui.ctx().request_repaint_after(rest);
        }
        let px = rect.size() * ui.ctx().pixels_per_point();
        let width = px.x.min(if moving { MOVING_PX } else { STILL_PX }).max(16.0);
        let size = [width, width * px.y / px.x.max(1.0)].map(|v| (v.round() as u32).max(9));
        let seen = SplatViewpoint {
            camera: *camera,
            size,
        };
        let Some(baking) = &mut self.baking else {
            return;
        };
        let was_baked = baking.baked.as_ref().map(|b| b.of);
        let drawn = baking.update();
        if baking.baked.as_ref().map(|b| b.of) != was_baked {
            self.asked = None;
        }
        if let Some((of, image)) = drawn {
            self.shown = Some(of);
            match &mut self.texture {
                Some(texture) => texture.set(image, TextureOptions::LINEAR),
                None => self.texture = Some(ui.ctx().load_texture("splats", image, TextureOptions::LINEAR)),
            }
        }
        if self.asked != Some(seen) {
            self.asked = Some(seen);
            baking.look(seen);
        }
    }
}

/// Viewpoint of the picture in a rectangle.
struct Looks {
    camera: ViewCamera,
    rect: Rect,
}

impl Looks {
    fn size(&self) -> [u32; 2] {
        let size = self.rect.size();
        [size.x, size.y].map(|v| v.round().max(1.0) as u32)
    }

    /// Screen position of a point; `None` behind the camera.
    fn project(&self, p_m: DVec3) -> Option<Pos2> {
        let at = self.camera.project(p_m, self.size())?;
        Some(self.rect.min + egui::vec2(at.x as f32, at.y as f32))
    }

    /// Draws the edges of the chosen boxes.
    fn outline_chosen(&self, painter: &Painter, scene: &Scene, state: &UiState) {
        for id in state.chosen() {
            let Some(b) = scene.frame().boxes.get(&id).filter(|b| b.problem().is_none()) else {
                continue;
            };
            let corner = |i: usize| {
                let sign = |bit: usize| if i >> bit & 1 == 1 { 0.5 } else { -0.5 };
                self.project(b.to_ego(DVec3::new(sign(0), sign(1), sign(2)) * b.size_m))
            };
            let ends = EDGES.iter().filter_map(|[i, j]| Some([corner(*i)?, corner(*j)?]));
            let ends: Vec<[Pos2; 2]> = ends.collect();
            for (width, color) in [(3.0, Color32::from_black_alpha(130)), (1.4, theme::ON_CANVAS)] {
                for line in &ends {
                    painter.line_segment(*line, Stroke::new(width, color));
                }
            }
        }
    }

    /// Reports the place under the pointer to the status bar and to the other panes; a click chooses the box there.
    fn answer(&self, ui: &Ui, response: &Response, cx: &mut PaneContext<'_>, commands: &mut Vec<Command>) {
        if let Some(place_m) = place_marks::elsewhere(cx.state, PaneId::SPLATS)
            && let Some(at) = self.project(place_m)
        {
            place_marks::draw(&ui.painter().with_clip_rect(self.rect), at);
        }
        let Some(pointer) = response.hover_pos() else {
            return;
        };
        let at = (pointer - self.rect.min).to_pos2();
        let (from_m, way) = self
            .camera
            .ray_in_world(DVec2::new(at.x.into(), at.y.into()), self.size());
        let Some(ray) = PickRay::new(from_m, way) else {
            return;
        };
        let Some(hit) = pick::pick(cx.seen.scene.frame(), &ray) else {
            return;
        };
        place_marks::point(cx.state, PaneId::SPLATS, point_of(&hit, &ray));
        let found = match hit {
            PickHit::Box { id, .. } => cx.scene.frame().boxes.get(&id),
            _ => None,
        };
        if let Some(b) = found {
            cx.state.pointed.readout = format!("{} #{}", called(b), b.id.0);
        }
        if response.clicked() {
            let shift = ui.input(|i| i.modifiers.shift);
            let choose = ToolCommand::clicked(found.map(|b| b.id), shift);
            commands.push(Command::Tools(choose));
        }
    }
}

/// Navigation as in the 3D view: a drag orbits, with Shift it pans; the right button looks around while W A S D Q E
/// fly; the wheel moves nearer.
fn navigate(ui: &Ui, response: &Response, camera: &mut ViewCamera) {
    let delta = response.drag_delta();
    let (dx, dy) = (f64::from(delta.x), f64::from(delta.y));
    let shift = ui.input(|i| i.modifiers.shift);
    if response.dragged_by(PointerButton::Secondary) {
        fly::fly(ui, camera, dx, dy);
    } else if delta != egui::Vec2::ZERO {
        let pans = shift && response.dragged();
        if pans {
            let size = response.rect.size();
            camera.pan(
                DVec2::new(dx, dy),
                [size.x, size.y].map(|v| v.round().max(1.0) as u32),
            );
        } else {
            camera.ortho = false;
            camera.orbit(dx * ORBIT_RAD, dy * ORBIT_RAD);
        }
    }
    if response.hovered() {
        let (scroll, zoom) = ui.input(|i| (i.smooth_scroll_delta().y, i.zoom_delta()));
        let factor = f64::from((scroll / 260.0).exp() * zoom);
        if (factor - 1.0).abs() > 1e-4 {
            camera.zoom(factor, None);
        }
    }
}
