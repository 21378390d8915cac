//! The 3D pane: the viewport's picture at the size of the pane, its camera, and the readout under the pointer.
//! `canvas_tools.rs` drives the tools.

use std::sync::Arc;

use egui::accesskit::Role;
use egui::{PointerButton, Pos2, Rect, Response, Sense, Ui, WidgetInfo};
use glam::{DVec2, DVec3};

use editor::pick::{self, PickHit, PickRay};
use editor::tools::{ScreenProjection, ToolMark, ViewKind, Wants, point_of, select};
use language::{t, tf};
use scene::{BoxId, Extent, LidarSweep, Scene, SceneBox};
use sensors::pictures::appearance::CameraImage;
use viewport::{
    LayoutPlane, LidarColorMode, LidarView, MarkedVoxels, ViewCamera, ViewOptions, ViewPreset, ViewScene,
    Viewport, lidar_colors,
};

use super::canvas_tools::{Driver, ViewContext};
use super::command::Command;
use super::look::Look;
use super::marks::Board;
use super::pictured::{self, PicturedView};
use super::pointer::{self, PointerEvent, ViewDrag};
use super::readout::readout;
use super::screen_map::{point, pos};
use super::state::UiState;
use super::tools::ToolState;
use super::view_texture::{put, register};
use super::views_shown::ViewsShown;
use super::{detection_marks, fly, no_adapter, place_marks, thing_outlines, track_marks, unsettled_marks};
use crate::panes::id::PaneId;
use crate::shell::live::Bounds;
use widgets::software_ui;

/// Turn per point that the pointer moves, rad.
const ORBIT_RAD: f64 = 0.006;
/// Frame time above which the picture is coarse during motion, s.
const SLOW_FRAME_S: f32 = 0.045;
/// Time without motion after which the picture is fine again, s.
const SETTLE_S: f64 = 0.18;

/// Device objects of the view.
pub(super) struct Gpu {
    pub(super) render_state: egui_wgpu::RenderState,
    pub(super) viewport: Viewport,
    pub(super) texture: Option<(egui::TextureId, [u32; 2], u32)>, // with its registered size and samples
    software: bool,
}

/// The 3D view's own state.
pub struct View3d {
    /// Viewpoint.
    pub camera: ViewCamera,
    /// Options of the picture.
    pub options: ViewOptions,
    /// True if the view stays orthographic when it is turned.
    pub parallel: bool,
    gpu: Option<Gpu>,
    pictured: PicturedView,
    held: ViewDrag,
    driver: Driver,
    /// Rectangle of the pane drawn last; tests click with it.
    pub rect: Rect,
    colors: Option<(Arc<LidarSweep>, LidarColorMode, Vec<[u8; 4]>)>,
    last_motion_s: f64,
    frame_s: f32,
    frames: u32,
    pixels_per_point: f32,
}

/// Input of the view.
pub struct View3dInput<'a> {
    /// The scene shown, a drag in progress included.
    pub scene: &'a Scene,
    /// The scene without the drag in progress; strokes pick against it.
    pub settled: &'a Scene,
    /// The newest sweep.
    pub lidar: Option<&'a Arc<LidarSweep>>,
    /// True if the user drags anything, in any view.
    pub dragging: bool,
    /// Marked voxels, by colour.
    pub marked: &'a [MarkedVoxels<'a>],
    /// Regions still to be generated, and true if a generation runs.
    pub unsettled: (&'a [Bounds], bool),
    /// True if the voxels are predicted by a network; brushes then have no effect on them.
    pub is_told: bool,
}

/// Most marked voxels that are drawn; more would only hide each other.
const MARKED: usize = 40_000;

/// The pointer over the view.
#[derive(Clone, Copy, Debug)]
pub(super) struct ViewPointer {
    /// The ray under the pointer.
    pub ray: PickRay,
}

impl View3d {
    /// The view; without a render state the pane reports that there is no graphics adapter.
    pub fn new(render_state: Option<egui_wgpu::RenderState>) -> Self {
        let gpu = render_state.map(|state| Gpu {
            viewport: Viewport::new(&state.device, &state.queue),
            software: state.adapter.get_info().device_type == wgpu::DeviceType::Cpu,
            texture: None,
            render_state: state,
        });
        Self {
            camera: ViewCamera::default(),
            options: ViewOptions {
                point_px: 1.8,
                ..ViewOptions::default()
            },
            parallel: false,
            gpu,
            pictured: PicturedView::default(),
            held: ViewDrag::default(),
            driver: Driver::default(),
            rect: Rect::NOTHING,
            colors: None,
            last_motion_s: f64::NEG_INFINITY,
            frame_s: 0.0,
            frames: 0,
            pixels_per_point: 1.0,
        }
    }

    /// The newest picture, if the view was shown as one.
    pub fn picture(&self) -> Option<&CameraImage> {
        self.pictured.image()
    }

    /// True if there is a device to draw with.
    pub fn has_gpu(&self) -> bool {
        self.gpu.is_some()
    }

    /// Forgets the colours of returns, which were made with another palette.
    pub fn forget_pictures(&mut self) {
        self.colors = None;
    }

    /// Forgets the picture of the scene that was open before.
    pub fn forget_scene(&mut self) {
        self.pictured.forget();
    }

    /// Takes a standard viewpoint over a map.
    pub fn preset(&mut self, preset: ViewPreset, extent: Extent) {
        self.camera = ViewCamera::preset_over(preset, extent);
        self.parallel = false;
    }

    /// Changes between perspective and orthographic, from the same viewpoint.
    pub fn toggle_parallel(&mut self) {
        self.parallel = !self.camera.ortho;
        self.camera.ortho = self.parallel;
    }

    /// Centres a box.
    pub fn frame_box(&mut self, b: &SceneBox) {
        self.camera.focus(b.center_m, b.size_m.length() * 0.9);
        self.step_back();
    }

    /// Fits a whole map into the view.
    pub fn frame_map(&mut self, extent: Extent) {
        self.camera
            .focus_map(extent, f64::from(self.rect.width() / self.rect.height()));
    }

    /// Moves the camera back in a narrow pane, so that contents that fit by height also fit by width.
    fn step_back(&mut self) {
        let aspect = f64::from(self.rect.width() / self.rect.height());
        if (0.05..1.0).contains(&aspect) {
            self.camera.distance_m /= aspect;
            self.camera = self.camera.sane();
        }
    }

    /// Draws the view into all the available space, and answers the pointer.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        input: &View3dInput<'_>,
        state: &mut UiState,
        commands: &mut Vec<Command>,
    ) -> Response {
        let rect = ui.available_rect_before_wrap();
        let response = ui.allocate_rect(rect, Sense::drag());
        response.widget_info(|| WidgetInfo::labeled(Role::Canvas, true, t("3D view")));
        self.rect = rect;
        self.pixels_per_point = ui.ctx().pixels_per_point();
        if self.gpu.is_none() {
            no_adapter::show(ui, rect);
            return response;
        }
        let steps = pointer::steps(ui, &response);
        let moved = self.navigate(ui, &response, &steps, input, &mut state.tools);
        let pointer = response.hover_pos().and_then(|p| self.pointer(p));
        let is_blocked = input.is_told && state.tool != select::ID;
        if !is_blocked {
            let mut driver = self.driver;
            driver.drive(
                ui,
                &response,
                &steps,
                &self.seen(input),
                &mut state.tools,
                commands,
            );
            self.driver = driver;
        }
        let hit = pointer.and_then(|p| pick::pick(input.scene.frame(), &p.ray));
        if let (Some(hit), Some(pointer)) = (&hit, &pointer) {
            state.pointed.readout = readout(input.scene, hit, &pointer.ray);
            place_marks::point(state, PaneId::VIEW3D, point_of(hit, &pointer.ray));
        }
        let now_s = ui.input(|i| i.time);
        // On a software rasteriser only the part that a drag or a brush touches is drawn again, which is quick enough.
        let brushes = state.tool != select::ID && response.hovered() && ui.input(|i| i.pointer.is_moving());
        if moved || (input.dragging || brushes) && !self.is_software() {
            self.last_motion_s = now_s;
        }
        let over = response.hover_pos().filter(|_| !is_blocked);
        let (marks, mut cursor) = self.driver.sight(ui, over, &self.seen(input), &state.tools);
        if is_blocked {
            cursor = egui::CursorIcon::NotAllowed;
        }
        if response.hovered() && !self.driver.is_held() {
            ui.ctx().set_cursor_icon(cursor);
        }
        self.paint(ui, input, state, (hit.as_ref(), &marks), now_s);
        let painter = ui.painter().with_clip_rect(rect);
        let project = |p_m: DVec3| View3d::project(self, p_m);
        thing_outlines::in_3d(&painter, &project, input.scene, &state.things);
        track_marks::in_3d(&painter, &project, input.scene, state);
        detection_marks::in_3d(&painter, &project, input.scene, state);
        let (parts, generating) = input.unsettled;
        unsettled_marks::in_3d(&painter, &project, input.scene.frame(), parts, generating);
        let elsewhere = place_marks::elsewhere(state, PaneId::VIEW3D);
        if let Some(at) = elsewhere.and_then(project) {
            place_marks::draw(&painter, at);
        }
        let board = Board {
            painter: &painter,
            view: self,
            map: None,
            extent: input.scene.frame().extent(),
        };
        board.paint(ui, &marks);
        response
    }

    /// Draws the view as a picture into `rect`, from the viewpoint `camera`, without answering the pointer.
    pub(super) fn still(
        &mut self,
        ui: &Ui,
        rect: Rect,
        (camera, options): (&ViewCamera, &ViewOptions),
        input: &View3dInput<'_>,
        state: &UiState,
    ) {
        self.rect = rect;
        self.pixels_per_point = ui.ctx().pixels_per_point();
        self.camera = *camera;
        self.options = options.clone();
        if self.gpu.is_some() {
            let now_s = ui.input(|i| i.time);
            let (marks, _) = self.driver.sight(ui, None, &self.seen(input), &state.tools);
            self.paint(ui, input, state, (None, &marks), now_s);
        }
    }

    /// True while the pointer draws, moves or marks something.
    pub fn is_dragging(&self) -> bool {
        self.driver.is_dragging()
    }

    /// True if the processor draws the pictures.
    pub fn is_software(&self) -> bool {
        self.gpu.as_ref().is_some_and(|g| g.software)
    }

    /// The size of the picture, physical pixels.
    fn size_px(&self) -> [u32; 2] {
        let size = self.rect.size() * self.pixels_per_point;
        [size.x.round().max(1.0) as u32, size.y.round().max(1.0) as u32]
    }

    /// The ray under a point of the screen.
    pub(super) fn pointer(&self, at: Pos2) -> Option<ViewPointer> {
        let size = self.size_px();
        let part = (at - self.rect.min) / self.rect.size();
        let pixel = DVec2::new(
            f64::from(part.x) * f64::from(size[0]),
            f64::from(part.y) * f64::from(size[1]),
        );
        let (origin, direction) = self.camera.ray_in_world(pixel, size);
        PickRay::new(origin, direction).map(|ray| ViewPointer { ray })
    }

    /// Screen position of a point of the ego frame; `None` behind the camera.
    pub(super) fn project(&self, p_m: DVec3) -> Option<Pos2> {
        let size = self.size_px();
        let pixel = self.camera.project(p_m, size)?;
        let part = egui::vec2(
            (pixel.x / f64::from(size[0])) as f32,
            (pixel.y / f64::from(size[1])) as f32,
        );
        Some(self.rect.min + part * self.rect.size())
    }

    /// Moves the camera by pointer and keys; returns true if the view changed.
    fn navigate(
        &mut self,
        ui: &Ui,
        response: &Response,
        steps: &[PointerEvent],
        input: &View3dInput<'_>,
        tools: &mut ToolState,
    ) -> bool {
        let before = self.camera;
        let (shift, space) = ui.input(|i| (i.modifiers.shift, i.key_down(egui::Key::Space)));
        let wants = |button, modifiers: egui::Modifiers| match button {
            PointerButton::Middle | PointerButton::Secondary => true,
            PointerButton::Primary => modifiers.alt || space,
            _ => false,
        };
        if let Some((button, delta)) = self.held.travel(steps, wants) {
            let (dx, dy) = (f64::from(delta.x), f64::from(delta.y));
            let px = f64::from(self.pixels_per_point);
            let pans = match button {
                PointerButton::Middle => shift,
                _ => space,
            };
            if button == PointerButton::Secondary {
                fly::fly(ui, &mut self.camera, dx, dy);
            } else if pans {
                self.camera.pan(DVec2::new(dx, dy) * px, self.size_px());
            } else {
                // A turned standard view becomes perspective again, unless the user chose orthographic.
                self.camera.ortho &= self.parallel || delta == egui::Vec2::ZERO;
                self.camera.orbit(dx * ORBIT_RAD, dy * ORBIT_RAD);
            }
        }
        // While a block is drawn, the wheel sets its height.
        let wheel_taken = self.driver.is_dragging() && tools.toolbox.tool(tools.tool).wants() == Wants::Wheel;
        if let Some(at) = response.hover_pos().filter(|_| !wheel_taken) {
            let (scroll, zoom) = ui.input(|i| (i.smooth_scroll_delta().y, i.zoom_delta()));
            let mut factor = f64::from((scroll / 260.0).exp() * zoom);
            // With Ctrl held egui turns the wheel into a zoom; with a brush in hand it sets the size of the brush.
            if tools.tool.def().is_brush && (zoom - 1.0).abs() > 1e-4 {
                tools.scale_brush(f64::from(zoom));
                factor = 1.0;
            }
            if (factor - 1.0).abs() > 1e-4 {
                let toward = self.pointer(at).map(|p| {
                    let hit_m = pick::pick(input.scene.frame(), &p.ray).map(|hit| match hit {
                        PickHit::Box { distance_m, .. } => distance_m,
                        PickHit::Voxel(v) => v.distance_m,
                        PickHit::Ground { point_in_ego } => p.ray.origin_in_ego.distance(point_in_ego),
                    });
                    let (from_m, way) = (p.ray.origin_in_ego, p.ray.direction_in_ego);
                    self.camera.zoom_point_m(from_m, way, hit_m)
                });
                self.camera.zoom(factor, toward);
            }
        }
        self.camera != before
    }

    fn paint(
        &mut self,
        ui: &Ui,
        input: &View3dInput<'_>,
        state: &UiState,
        (hit, marks): (Option<&PickHit>, &[ToolMark]),
        now_s: f64,
    ) {
        self.frames += 1;
        let rect = self.rect;
        if self.frames < 3 {
            // The first frames leave the picture out, so that the window appears before the pipelines are built.
            no_adapter::hint(ui, rect, t("Preparing the 3D view…"), "");
            ui.ctx().request_repaint();
            return;
        }
        let moving = now_s - self.last_motion_s < SETTLE_S;
        if moving {
            let dt = ui.input(|i| i.unstable_dt).min(0.5);
            self.frame_s = if self.frame_s == 0.0 {
                dt
            } else {
                0.8 * self.frame_s + 0.2 * dt
            };
            ui.ctx()
                .request_repaint_after(std::time::Duration::from_secs_f64(SETTLE_S));
        }
        let size = self.size_px();
        let frame = input.scene.frame();
        self.refresh_colors(input.lidar, state.lidar.colors);
        let brushed = marks.iter().find_map(|mark| match mark {
            ToolMark::Voxels(voxels, color) => Some((&voxels[..], *color)),
            _ => None,
        });
        let (voxels, color) = brushed.unwrap_or((&[], [0; 3]));
        let finding = state.shown.finding_marks.as_deref();
        let mut brush = vec![MarkedVoxels { voxels, color }];
        if voxels.is_empty() {
            brush.extend_from_slice(input.marked);
        }
        brush.extend(finding.map(|m| m.brush()));
        for part in &mut brush {
            part.voxels = &part.voxels[..part.voxels.len().min(MARKED)];
        }
        let ghost = marks.iter().find_map(|mark| match mark {
            ToolMark::Ghost(b) => Some(*b),
            _ => None,
        });
        let shown = frame.boxes.values().chain(ghost.as_ref());
        let boxes: Vec<&SceneBox> = shown.chain(finding.map_or(&[][..], |m| &m.becomes)).collect();
        let selected: Vec<BoxId> = state.chosen().into_iter().chain(ghost.map(|b| b.id)).collect();
        let hovered = match hit {
            Some(PickHit::Box { id, .. }) if state.tool == select::ID => Some(*id),
            _ => finding.and_then(|m| m.box_id),
        };
        let picture = match state.shown.look {
            Look::Voxels => None,
            Look::Pictures => {
                let moves = moving || input.dragging || state.playback.playing;
                let of = (size, self.options.ego);
                self.pictured
                    .picture(ui.ctx(), input.scene, &self.camera, of, moves)
            }
        };
        let marked = |b: &&&SceneBox| selected.contains(&b.id) || hovered == Some(b.id);
        let boxes: Vec<&SceneBox> = match picture {
            // Frames of all boxes would hide them.
            Some(_) => boxes.iter().filter(marked).copied().collect(),
            None => boxes,
        };
        let Some(gpu) = &mut self.gpu else { return };
        let coarse = moving && (gpu.software || self.frame_s > SLOW_FRAME_S);
        let options = ViewOptions {
            grid_lines: state.shown.grid,
            boxes: state.shown.boxes,
            by_track: state.shown.by_track,
            frusta: self.options.frusta || state.windows.sensors,
            samples: if coarse || gpu.software { 1 } else { 4 },
            point_px: self.options.point_px * self.pixels_per_point * if coarse { 0.5 } else { 1.0 },
            pixels_per_point: self.pixels_per_point * if coarse { 0.5 } else { 1.0 },
            ..self.options.clone()
        };
        // Over a picture there are only marks.
        let options = match picture {
            Some(_) => ViewOptions {
                voxels: false,
                ego: false,
                layout_plane: LayoutPlane::Off,
                grid_lines: false,
                lidar: false,
                background: viewport::Background::Transparent,
                ..options
            },
            None => options,
        };
        let lidar = self
            .colors
            .as_ref()
            .map(|(sweep, _, colors)| LidarView { sweep, colors });
        let view = ViewScene {
            grid: &frame.occupancy,
            bev: frame.layout.cells(),
            boxes: &boxes,
            selected: &selected,
            hovered,
            brush: &brush,
            lidar,
            rig: &input.scene.with_rig_in_world().rig,
            options: &options,
        };
        let [w, h] = if coarse { size.map(|s| s.div_ceil(2)) } else { size };
        let wgpu = &gpu.render_state;
        let drawn = gpu
            .viewport
            .render(&wgpu.device, &wgpu.queue, &self.camera, &view, w, h);
        let texture = register(gpu, options.samples);
        if drawn && gpu.software {
            let share = software_ui::share(gpu.viewport.drawn_rect(), gpu.viewport.size());
            software_ui::picture_changed(ui.ctx(), texture, Some(share));
        }
        let note = match self.pictured.problem(input.scene.rev) {
            _ if state.shown.look == Look::Voxels => None,
            Some(problem) => Some(tf!("The picture was not made: {problem}", problem = problem)),
            None if pictured::can_show(input.scene, &self.camera) => None,
            None => Some(
                t("Pictures are in perspective, and not from this far away: voxels are shown").to_owned(),
            ),
        };
        put(ui, rect, picture.into_iter().chain([texture]), note.as_deref());
    }

    fn refresh_colors(&mut self, lidar: Option<&Arc<LidarSweep>>, mode: LidarColorMode) {
        self.colors = match (lidar, self.colors.take()) {
            (None, _) => None,
            (Some(sweep), Some(old)) if Arc::ptr_eq(sweep, &old.0) && old.1 == mode => Some(old),
            (Some(sweep), _) => Some((sweep.clone(), mode, lidar_colors(sweep, mode))),
        };
    }

    /// The view as an image, `width` x `height` pixels, RGBA. Errors without a graphics adapter.
    pub fn screenshot(
        &mut self,
        scene: &Scene,
        shown: &ViewsShown,
        size: Option<[u32; 2]>,
    ) -> anyhow::Result<([u32; 2], Vec<u8>)> {
        if shown.look == Look::Pictures && size.is_none() && pictured::can_show(scene, &self.camera) {
            let Some(image) = self.pictured.whole(scene.rev, &self.camera) else {
                anyhow::bail!(t("the picture is still being drawn"));
            };
            return Ok(([image.width as u32, image.height as u32], image.rgba.clone()));
        }
        let size = size.unwrap_or_else(|| self.size_px());
        let Some(gpu) = &mut self.gpu else {
            anyhow::bail!("there is no graphics adapter to draw the 3D view with");
        };
        let frame = scene.frame();
        let boxes: Vec<&SceneBox> = frame.boxes.values().collect();
        let options = ViewOptions {
            grid_lines: shown.grid,
            boxes: shown.boxes,
            by_track: shown.by_track,
            pixels_per_point: self.pixels_per_point,
            ..self.options.clone()
        };
        let lidar = self
            .colors
            .as_ref()
            .map(|(sweep, _, colors)| LidarView { sweep, colors });
        let view = ViewScene {
            grid: &frame.occupancy,
            bev: frame.layout.cells(),
            boxes: &boxes,
            selected: &[],
            hovered: None,
            brush: &[],
            lidar,
            rig: &scene.with_rig_in_world().rig,
            options: &options,
        };
        let wgpu = &gpu.render_state;
        let supersample = if gpu.software { 2 } else { 4 };
        let pixels = gpu.viewport.render_to_image(
            &wgpu.device,
            &wgpu.queue,
            &self.camera,
            &view,
            size,
            supersample,
        )?;
        Ok((size, pixels))
    }
}

impl ScreenProjection for View3d {
    fn kind(&self) -> ViewKind {
        ViewKind::Space
    }

    fn project(&self, p_m: DVec3) -> Option<DVec2> {
        View3d::project(self, p_m).map(point)
    }

    fn ray(&self, at: DVec2) -> Option<PickRay> {
        self.pointer(pos(at)).map(|p| p.ray)
    }

    fn right(&self) -> DVec3 {
        self.camera.axes()[0]
    }

    fn scale(&self) -> f64 {
        1.0
    }
}

impl View3d {
    /// Context of the view for the tools.
    fn seen<'a>(&'a self, input: &View3dInput<'a>) -> ViewContext<'a> {
        ViewContext {
            scene: input.scene,
            settled: input.settled,
            view: self,
        }
    }
}
