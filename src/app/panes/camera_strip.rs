//! The strip of camera pictures, and one of them enlarged.

use std::sync::Arc;

use egui::accesskit::Role;
use egui::{
    Align2, Color32, Rect, Sense, Stroke, StrokeKind, TextureHandle, TextureOptions, Ui, WidgetInfo, pos2,
    vec2,
};
use glam::DVec3;

use super::box_outlines::{self, drop_m};
use super::camera_difference::Differing;
use super::camera_header::header;
use super::camera_legend;
use super::id::PaneId;
use crate::camera_views::{CameraView, CamerasShown, camera_label, march};
use crate::command::{Command, ViewCommand};
use crate::place_marks;
use crate::sensing::{PaintStage, Sensing};
use crate::state::UiState;
use language::{t, tf};
use numeric::decimal::decimal;
use scene::{Camera, Class, Scene, SceneRev, SensorRig};
use sensors::cameras::ViewId;
use sensors::pictures::march::{MarchHit, MarchScene};
use sensors::raycast::rays::CameraRays;
use widgets::theme;

/// Share of the window's width from which boxes can be chosen in a picture. A click on a smaller picture enlarges it.
const LARGE: f32 = 0.5;

/// True if a picture so wide, points, is large enough to choose boxes in it.
pub(crate) fn is_large(ui: &Ui, width: f32) -> bool {
    width >= LARGE * ui.ctx().content_rect().width()
}

/// Textures of the pictures.
#[derive(Default)]
pub struct CameraStrip {
    /// One for each camera that was shown.
    textures: Vec<Option<TextureHandle>>,
    made_from: Option<(Arc<Vec<CameraView>>, ViewId, f64)>,
    probe: Option<(SceneRev, MarchScene)>,
    stale_since_s: Option<f64>,
    /// Pictures of another state, shown over the left part of each picture, and the width of that part, 0 to 1.
    before: Option<(Vec<Option<TextureHandle>>, f32)>,
    /// Difference pictures, shown in place of the pictures.
    differing: Option<Differing>,
    differs: bool,
    looks_stale: bool,
    legend_of: Option<usize>,
}

/// Input of the strip.
pub struct CamerasInput<'a> {
    /// The scene shown.
    pub scene: &'a Scene,
    /// The sensors where the ego vehicle is, world frame.
    pub rig: Arc<SensorRig>,
    /// The newest pictures, in the rig's order.
    pub views: Option<&'a Arc<Vec<CameraView>>>,
    /// True if the pictures belong to an earlier state.
    pub stale: bool,
    /// Progress of the pictures that are being painted.
    pub paint_stage: Option<PaintStage>,
    /// True if the painting was stopped, or failed.
    pub stopped: bool,
    /// Number of returns of the newest sweep.
    pub lidar_points: Option<usize>,
    /// View of the pictures.
    pub view: ViewId,
    /// Depth of the plane that is shown, m.
    pub plane_m: f64,
}

impl<'a> CamerasInput<'a> {
    /// The input for a scene and the results of its sensors. `rev` is the state that they should show.
    pub(crate) fn from_scene(
        scene: &'a Scene,
        rev: SceneRev,
        sensing: &'a Sensing,
        shown: &CamerasShown,
    ) -> Self {
        Self {
            scene,
            rig: scene.with_rig_in_world().rig.clone(),
            views: sensing.cameras(),
            stale: sensing.cameras_stale(rev),
            paint_stage: sensing.paint_stage(),
            stopped: sensing.is_stopped(),
            lidar_points: sensing.lidar().map(|l| l.points.len()),
            view: shown.view,
            plane_m: shown.plane_m,
        }
    }

    /// The input for another view than the strip's.
    pub(crate) fn of_view(
        self,
        rev: SceneRev,
        sensing: &'a Sensing,
        shown: &CamerasShown,
        view: ViewId,
    ) -> Self {
        if view == self.view {
            return self;
        }
        let source = sensors::cameras::source_of(view, shown.source).id();
        Self {
            views: sensing.pictures_of(source),
            stale: sensing.is_stale(source, rev),
            view,
            ..self
        }
    }
}

/// Share of the largest possible width of pictures for which they stand in longer rows.
const LONG_ROWS: f32 = 0.88;
/// Distance between pictures, points.
const GAP: f32 = 6.0;

/// Number of pictures in a row, and their width, points, so that they are about as large as the room allows.
fn rows_of(count: usize, room: egui::Vec2) -> (usize, f32) {
    let width = |columns: usize| {
        let (wide, high) = (columns as f32, count.div_ceil(columns) as f32);
        let by_height = (room.y - GAP * (high - 1.0)) / high * 16.0 / 9.0;
        ((room.x - GAP * (wide - 1.0)) / wide).min(by_height)
    };
    let largest = (1..=count.max(1)).map(width).fold(f32::NEG_INFINITY, f32::max);
    // Long rows are read more easily than high columns.
    let columns = (1..=count.max(1))
        .rev()
        .find(|n| width(*n) >= LONG_ROWS * largest);
    let columns = columns.unwrap_or(1);
    (columns, width(columns).max(40.0))
}

impl CameraStrip {
    /// Draws the pictures, in a row or, where there is room, in several.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        input: &CamerasInput<'_>,
        state: &mut UiState,
        commands: &mut Vec<Command>,
    ) {
        self.refresh(ui, input);
        // Pictures of a playing clip always lag behind; they are not marked as stale.
        self.note_stale(ui, input.stale && !state.playback.playing);
        let cameras = &input.rig.cameras;
        let shown: Vec<usize> = (0..cameras.len())
            .filter(|i| !state.cameras.is_hidden(*i))
            .collect();
        let room = ui.available_size();
        let (columns, width) = rows_of(shown.len(), room);
        let used = width * columns as f32 + GAP * (columns as f32 - 1.0);
        let left = ui.max_rect().left() + ((room.x - used) / 2.0).max(0.0);
        let top = ui.cursor().top();
        for (place, &i) in shown.iter().enumerate() {
            let (column, row) = ((place % columns) as f32, (place / columns) as f32);
            let at = pos2(
                left + column * (width + GAP),
                top + row * (width * 9.0 / 16.0 + GAP),
            );
            let rect = Rect::from_min_size(at, vec2(width, width * 9.0 / 16.0));
            let hovered = self.picture(ui, rect, i, input, state, commands);
            if let Some(part) = hovered {
                state.pointed.readout = self.pixel_text(input.scene, &cameras[i], part, state);
            }
        }
        if shown.is_empty() {
            let text = t("No camera is shown. Sensors… adds and shows them.");
            ui.label(egui::RichText::new(text).color(theme::text_weak()));
        }
    }

    /// The textures of the pictures, updated.
    pub fn textures(&mut self, ui: &Ui, input: &CamerasInput<'_>) -> Vec<Option<TextureHandle>> {
        self.refresh(ui, input);
        self.textures.clone()
    }

    /// Shows the differences from the pictures of another state; `None` shows the pictures.
    pub fn differ(&mut self, ui: &Ui, input: &CamerasInput<'_>, other: Option<&CamerasInput<'_>>) {
        self.differs = match (input.views, other.and_then(|o| o.views)) {
            (Some(now), Some(before)) => {
                let differing = self.differing.get_or_insert_default();
                differing.refresh(ui, now, before, (input.view, input.plane_m));
                true
            }
            _ => false,
        };
    }

    /// Shows pictures of another state over the left part of each picture, up to a share of its width; `None` shows
    /// none.
    pub fn wipe(&mut self, before: Option<(Vec<Option<TextureHandle>>, f32)>) {
        self.before = before;
    }

    /// Draws the controls in the header of the strip.
    pub fn controls(
        &self,
        ui: &mut Ui,
        input: &CamerasInput<'_>,
        shown: &mut CamerasShown,
        commands: &mut Vec<Command>,
    ) {
        header(ui, input, self.looks_stale, shown, commands);
    }

    /// Draws one camera into all the available space.
    pub fn single(
        &mut self,
        ui: &mut Ui,
        index: usize,
        input: &CamerasInput<'_>,
        state: &mut UiState,
        commands: &mut Vec<Command>,
    ) {
        self.refresh(ui, input);
        // Pictures of a playing clip always lag behind; they are not marked as stale.
        self.note_stale(ui, input.stale && !state.playback.playing);
        let area = ui.available_rect_before_wrap();
        let Some(camera) = input.rig.cameras.get(index) else {
            let text = t("The vehicle has no such camera. Sensors… adds one.");
            ui.label(egui::RichText::new(text).color(theme::text_weak()));
            return;
        };
        let aspect = camera.width as f32 / camera.height.max(1) as f32;
        let width = area.width().min(area.height() * aspect).max(40.0);
        let rect = Rect::from_center_size(area.center(), vec2(width, width / aspect));
        if let Some(part) = self.picture(ui, rect, index, input, state, commands) {
            let text = self.pixel_text(input.scene, camera, part, state);
            // The title already shows the name of the camera.
            let short = text.split_once("  ·  ").map_or(&*text, |(_, rest)| rest);
            beside_pointer(ui, rect, rect.min + part * rect.size(), short);
            state.pointed.readout = text;
        }
        if self.legend_of == Some(index) {
            let found = input.views.and_then(|v| v.iter().find(|v| v.camera == index));
            if let Some(view) = found {
                camera_legend::draw(ui, rect, &view.picture, input.view);
            }
        }
    }

    /// Sets the camera whose picture has a legend.
    pub fn set_legend(&mut self, camera: Option<usize>) {
        self.legend_of = camera;
    }

    /// Marks pictures as stale only after a delay, so that pictures that are renewed at once do not flicker.
    fn note_stale(&mut self, ui: &Ui, stale: bool) {
        const AFTER_S: f64 = 0.35;
        let now_s = ui.input(|i| i.time);
        if !stale {
            (self.stale_since_s, self.looks_stale) = (None, false);
            return;
        }
        let since_s = *self.stale_since_s.get_or_insert(now_s);
        self.looks_stale = now_s - since_s >= AFTER_S;
        if !self.looks_stale {
            ui.ctx()
                .request_repaint_after(std::time::Duration::from_secs_f64(AFTER_S));
        }
    }

    fn refresh(&mut self, ui: &Ui, input: &CamerasInput<'_>) {
        let Some(views) = input.views else {
            // The old textures are of another scene.
            (self.made_from, self.textures) = (None, Vec::new());
            return;
        };
        let (view, plane_m) = (input.view, input.plane_m);
        if self
            .made_from
            .as_ref()
            .is_some_and(|(of, shown, at_m)| Arc::ptr_eq(of, views) && *shown == view && *at_m == plane_m)
        {
            return;
        }
        let count = views.iter().map(|v| v.camera + 1).max().unwrap_or(0);
        self.textures.resize(count, None);
        for of_camera in views.iter() {
            let image = of_camera.colors(view, plane_m);
            match &mut self.textures[of_camera.camera] {
                Some(texture) => texture.set(image, TextureOptions::LINEAR),
                empty => *empty = Some(ui.ctx().load_texture("camera", image, TextureOptions::LINEAR)),
            }
        }
        self.made_from = Some((views.clone(), view, plane_m));
    }

    fn hit(&mut self, scene: &Scene, camera: &Camera, part: egui::Vec2) -> Option<MarchHit> {
        if self.probe.as_ref().is_none_or(|(rev, _)| *rev != scene.rev) {
            self.probe = Some((scene.rev, march(scene, true)));
        }
        let (_, march) = self.probe.as_ref()?;
        march.cast(camera.ego_from_camera().translation_m, ray_of(camera, part))
    }

    /// The text for a place of a picture: class, box, distance from the camera, position. `part` runs from 0 to 1
    /// across the picture.
    fn pixel_text(
        &mut self,
        scene: &Scene,
        camera: &Camera,
        part: egui::Vec2,
        state: &mut UiState,
    ) -> String {
        let label = camera_label(&camera.name);
        let Some(hit) = self.hit(scene, camera, part) else {
            let blind = ray_of(camera, part) == DVec3::ZERO;
            let what = if blind { t("outside the lens") } else { t("sky") };
            return format!("{label}  ·  {what}");
        };
        let pose = camera.ego_from_camera();
        let ray = ray_of(camera, part);
        let name = match hit.id {
            17 => t("crossing").to_owned(),
            18 => t("road divider").to_owned(),
            19 => t("lane divider").to_owned(),
            id => {
                Class::from_id(id).map_or_else(|| t("unknown").into(), |class| t(&class.label()).to_owned())
            }
        };
        let name = hit.box_id.map_or(name.clone(), |id| format!("{name} #{}", id.0));
        let p = pose.translation_m + ray * hit.t;
        place_marks::point(state, PaneId::CAMERAS, p);
        let [x, y, z] = p.to_array().map(|v| decimal(v, 1));
        let away = tf!("{distance} m away", distance = format!("{:.1}", hit.t));
        format!("{label}  ·  {name}  ·  {away}  ·  {x}, {y}, {z} m")
    }

    fn picture(
        &mut self,
        ui: &Ui,
        rect: Rect,
        index: usize,
        input: &CamerasInput<'_>,
        state: &UiState,
        commands: &mut Vec<Command>,
    ) -> Option<egui::Vec2> {
        let (scene, camera) = (input.scene, input.rig.cameras.get(index)?);
        let label = camera_label(&camera.name);
        let response = ui.interact(rect, ui.scope_id().with(("camera", index)), Sense::click());
        response.widget_info(|| WidgetInfo::labeled(Role::Button, true, tf!("Camera {name}", name = label)));
        let painter = ui.painter_at(rect.expand(1.0));
        match self.texture(index) {
            Some(texture) => {
                let tint = if self.looks_stale {
                    Color32::from_gray(170)
                } else {
                    Color32::WHITE
                };
                painter.image(texture.id(), rect, unit(), tint);
            }
            None => {
                painter.rect_filled(rect, 3.0, theme::well());
                let font = egui::TextStyle::Small.resolve(ui.style());
                painter.text(
                    rect.center(),
                    Align2::CENTER_CENTER,
                    t("rendering…"),
                    font,
                    theme::text_weak(),
                );
            }
        }
        if let Some((before, part)) = &self.before
            && let Some(texture) = before.get(index).and_then(Option::as_ref)
        {
            let left = Rect::from_min_size(rect.min, vec2(rect.width() * part, rect.height()));
            let uv = Rect::from_min_max(pos2(0.0, 0.0), pos2(*part, 1.0));
            painter.image(texture.id(), left, uv, Color32::WHITE);
            painter.vline(left.right(), rect.y_range(), Stroke::new(1.5, Color32::WHITE));
        }
        if !state.playback.playing {
            box_outlines::draw(&painter, rect, camera, scene, state);
        }
        if let Some(place_m) = place_marks::elsewhere(state, PaneId::CAMERAS)
            && let Some(at) = place_in(camera, place_m, drop_m(&state.cameras))
        {
            place_marks::draw(&painter, rect.min + at * rect.size());
        }
        let chosen = state.cameras.enlarged == Some(index);
        let edge = match (chosen, response.hovered()) {
            (true, _) => Stroke::new(2.0, theme::accent()),
            (_, true) => Stroke::new(1.0, theme::text_weak()),
            _ => Stroke::new(1.0, Color32::from_black_alpha(120)),
        };
        painter.rect_stroke(rect, 2.0, edge, StrokeKind::Inside);
        badge(
            ui,
            &painter,
            rect.left_bottom() + vec2(6.0, -6.0),
            &label,
            theme::ON_CANVAS,
        );
        let part = response.hover_pos().map(|p| (p - rect.min) / rect.size());
        if response.double_clicked() {
            commands.push(Command::View(ViewCommand::Inspect(None)));
            commands.push(Command::View(ViewCommand::LookThrough(index)));
        } else if response.clicked() {
            let is_large = is_large(ui, rect.width());
            commands.push(match part.filter(|_| is_large) {
                Some(part) => Command::Select(self.hit(scene, camera, part).and_then(|hit| hit.box_id)),
                None => Command::View(ViewCommand::Inspect((!chosen).then_some(index))),
            });
        }
        part
    }

    fn texture(&self, camera: usize) -> Option<&TextureHandle> {
        let differing = self.differing.as_ref().filter(|_| self.differs);
        let differing = differing.and_then(|d| d.texture(camera));
        differing.or_else(|| self.textures.get(camera).and_then(Option::as_ref))
    }

    /// Draws one camera large, over the views. Its pixels can be read.
    pub fn enlarged(
        &mut self,
        ui: &Ui,
        over: Rect,
        input: &CamerasInput<'_>,
        state: &mut UiState,
        commands: &mut Vec<Command>,
    ) {
        let Some(index) = state.cameras.enlarged else {
            return;
        };
        // If the strip is not on screen, nothing else updates its pictures.
        self.refresh(ui, input);
        let texture = self.textures.get(index).and_then(Option::as_ref).cloned();
        let (Some(texture), Some(camera)) = (texture, input.rig.cameras.get(index)) else {
            return;
        };
        let aspect = camera.width as f32 / camera.height.max(1) as f32;
        let width = (over.width() * 0.72).min((over.height() * 0.8) * aspect);
        let window = egui::Window::new(tf!("Camera: {name}", name = camera_label(&camera.name)))
            .id(enlarged_id())
            .collapsible(false)
            .resizable(false)
            .default_pos(over.center() - vec2(width, width / aspect + 60.0) / 2.0);
        let mut open = true;
        window.open(&mut open).show(ui.ctx(), |ui| {
            let size = vec2(width, width / aspect);
            let (rect, response) = ui.allocate_exact_size(size, Sense::click());
            response.widget_info(|| WidgetInfo::labeled(Role::Canvas, true, t("Enlarged camera")));
            ui.painter().image(texture.id(), rect, unit(), Color32::WHITE);
            if !state.playback.playing {
                box_outlines::draw(ui.painter(), rect, camera, input.scene, state);
            }
            if let (true, Some(p)) = (response.clicked(), response.interact_pointer_pos()) {
                let part = (p - rect.min) / rect.size();
                let hit = self.hit(input.scene, camera, part).and_then(|hit| hit.box_id);
                commands.push(Command::Select(hit));
            }
            ui.horizontal(|ui| {
                let part = response.hover_pos().map(|p| (p - rect.min) / rect.size());
                let text = part.map(|part| self.pixel_text(input.scene, camera, part, state));
                ui.label(text.unwrap_or_else(|| {
                    t("Move over the picture to read a pixel; a click chooses the box there").into()
                }));
                ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                    if ui.button(t("Look through in 3D")).clicked() {
                        commands.push(Command::View(ViewCommand::LookThrough(index)));
                        commands.push(Command::View(ViewCommand::Inspect(None)));
                    }
                });
            });
        });
        if !open {
            state.cameras.enlarged = None;
        }
    }
}

/// Id of the window of an enlarged camera.
pub(crate) fn enlarged_id() -> egui::Id {
    egui::Id::unique("enlarged camera")
}

/// The place of a point of the world in a picture, from 0 to 1 across it; `None` if it is outside the picture.
fn place_in(camera: &Camera, place_m: DVec3, drop_m: f64) -> Option<egui::Vec2> {
    let px = CameraRays::new(camera, camera.width, camera.height).project(place_m - DVec3::Z * drop_m);
    let part = vec2(
        (px.x / f64::from(camera.width)) as f32,
        (px.y / f64::from(camera.height)) as f32,
    );
    let within = |v: f32| (0.0..=1.0).contains(&v);
    (px.z > 0.0 && within(part.x) && within(part.y)).then_some(part)
}

/// Direction of the ray through a place of a picture, in the frame of the camera's pose; zero where the lens has no
/// ray. `part` runs from 0 to 1 across the picture.
fn ray_of(camera: &Camera, part: egui::Vec2) -> DVec3 {
    let at = |size: u32, part: f32| f64::from(part) * f64::from(size);
    let (u, v) = (at(camera.width, part.x), at(camera.height, part.y));
    CameraRays::new(camera, camera.width, camera.height)
        .at(u, v)
        .direction
        .normalize_or_zero()
}

fn unit() -> Rect {
    Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0))
}

/// Draws text beside the pointer, within a picture.
fn beside_pointer(ui: &Ui, within: Rect, at: egui::Pos2, text: &str) {
    let font = egui::TextStyle::Small.resolve(ui.style());
    let galley = ui
        .painter()
        .layout_no_wrap(text.to_owned(), font, theme::ON_CANVAS);
    let size = galley.size() + vec2(10.0, 4.0);
    let left = (at.x + 14.0).min(within.right() - size.x).max(within.left());
    let below = at.y + 14.0;
    let top = if below + size.y > within.bottom() {
        at.y - 8.0 - size.y
    } else {
        below
    };
    let rect = Rect::from_min_size(pos2(left, top), size);
    ui.painter()
        .rect_filled(rect, 3.0, Color32::from_black_alpha(190));
    ui.painter()
        .galley(rect.min + vec2(5.0, 2.0), galley, theme::ON_CANVAS);
}

fn badge(ui: &Ui, painter: &egui::Painter, left_bottom: egui::Pos2, text: &str, color: Color32) {
    let font = egui::TextStyle::Small.resolve(ui.style());
    let galley = painter.layout_no_wrap(text.to_owned(), font, color);
    let size = galley.size() + vec2(10.0, 4.0);
    let rect = Rect::from_min_size(left_bottom - vec2(0.0, size.y), size);
    painter.rect_filled(rect, 3.0, Color32::from_black_alpha(150));
    painter.galley(rect.min + vec2(5.0, 2.0), galley, color);
}

/// A number with commas between thousands: 34567 as `34,567`.
pub fn thousands(n: usize) -> String {
    let digits = n.to_string();
    let mut out = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            out.push(',');
        }
        out.push(digit);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_stand_in_as_many_rows_as_make_them_large() {
        assert_eq!(rows_of(6, vec2(1500.0, 160.0)).0, 6, "a strip");
        assert_eq!(
            rows_of(6, vec2(1400.0, 850.0)).0,
            3,
            "a pane that fills the window"
        );
        assert_eq!(rows_of(6, vec2(300.0, 900.0)).0, 1, "a narrow column");
        assert_eq!(rows_of(1, vec2(800.0, 450.0)), (1, 800.0));
        for room in [vec2(0.0, 0.0), vec2(-5.0, 300.0), vec2(f32::NAN, 10.0)] {
            let (columns, width) = rows_of(6, room);
            assert!(columns >= 1 && width >= 40.0, "{room}: {columns} {width}");
        }
    }

    #[test]
    fn names_and_numbers_for_people() {
        assert_eq!(camera_label("CAM_FRONT_LEFT"), "Front left");
        assert_eq!(thousands(999), "999");
        assert_eq!(thousands(34_720), "34,720");
        assert_eq!(thousands(1_234_567), "1,234,567");
    }
}
