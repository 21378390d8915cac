//! The bird's-eye view: a frame from above with forward up, drawn and edited with the pointer. `canvas_tools.rs` drives
//! the tools.

use std::sync::Arc;

use egui::accesskit::Role;
use egui::{
    Color32, ColorImage, PointerButton, Rect, Response, Sense, Stroke, StrokeKind, TextureHandle,
    TextureOptions, Ui, WidgetInfo, pos2,
};
use glam::DVec2;

use editor::pick;
use editor::pick_things;
use editor::tools::{Hand, region, select};
use language::{t, tf};
use scene::{BevLayer, Class, LidarSweep, Scene, SceneBox, SceneRev, Thing};

use super::bev_image::{self, LayerStyle};
use super::canvas_access;
use super::canvas_draw::{
    BoxStyle, around, draw_box, draw_boxes, draw_ego, draw_fields_of_view, draw_grid, draw_lines,
    draw_points, draw_scale_bar,
};
use super::canvas_tools::{Driver, ViewContext};
use super::command::Command;
use super::marks::{self, Board};
use super::place_marks;
use super::pointer::{self, PointerEvent, ViewDrag};
pub use super::screen_map::ScreenMap;
use super::state::{UiState, called, position_text};
use super::thing_outlines;
use super::tools::ToolState;
use super::track_marks;
use super::unsettled_marks;
use super::views_shown::Underlay;
use crate::panes::id::PaneId;
use crate::shell::live::Bounds;
use crate::windows::open::SensorChoice;
use crate::windows::row;
use widgets::theme;

/// The bird's-eye view's own state.
pub struct BevCanvas {
    /// Extent of the map drawn last.
    extent: scene::Extent,
    center_m: DVec2,
    scale: f64,                 // points per metre; 0 before the first fit
    fitted: Option<egui::Vec2>, // the pane that all of the grid was fitted into, until the user moves the map
    held: ViewDrag,
    driver: Driver,
    /// The last map from ego to screen; tests click with it.
    pub map: Option<ScreenMap>,
    layers: Option<CanvasTexture<LayersKey>>,
    occupancy: Option<CanvasTexture<SceneRev>>,
    unobserved: Option<CanvasTexture<SceneRev>>,
}

type LayersKey = (SceneRev, LayerStyle, Color32);

/// A picture on the device: what it was made from, and what it holds.
struct CanvasTexture<K> {
    key: K,
    image: Arc<ColorImage>,
    handle: TextureHandle,
}

/// Input of the canvas.
pub struct CanvasInput<'a> {
    /// The scene shown, a drag in progress included.
    pub scene: &'a Scene,
    /// The scene without the drag in progress.
    pub settled: &'a Scene,
    /// The newest sweep.
    pub lidar: Option<&'a LidarSweep>,
    /// Regions still to be generated: lowest and highest column of each, both included.
    pub unsettled: Arc<[Bounds]>,
    /// True while a job runs or waits.
    pub generating: bool,
}

const SCALE: std::ops::RangeInclusive<f64> = 2.0..=120.0;
/// Colour where no layer is painted.
const GROUND: Color32 = Color32::from_rgb(29, 32, 37);
/// Margin around the map when all of it is shown, m.
const MARGIN_M: f64 = 2.0;

impl BevCanvas {
    /// True while the pointer draws, moves or marks something.
    pub fn is_dragging(&self) -> bool {
        self.driver.is_dragging()
    }
}

impl Default for BevCanvas {
    fn default() -> Self {
        Self {
            extent: scene::Extent::WINDOW,
            center_m: DVec2::ZERO,
            scale: 0.0,
            fitted: None,
            held: ViewDrag::default(),
            driver: Driver::default(),
            map: None,
            layers: None,
            occupancy: None,
            unobserved: None,
        }
    }
}

impl BevCanvas {
    /// Draws the view into all the available space, and answers the pointer.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        input: &CanvasInput<'_>,
        state: &mut UiState,
        commands: &mut Vec<Command>,
    ) -> Response {
        let rect = ui.available_rect_before_wrap();
        let response = ui.allocate_rect(rect, Sense::drag());
        response.widget_info(|| WidgetInfo::labeled(Role::Canvas, true, t("Bird's-eye view")));
        let extent = input.scene.frame().extent();
        if extent != self.extent {
            (self.extent, self.fitted) = (extent, Some(egui::Vec2::ZERO));
        }
        if self.scale == 0.0 || self.fitted.is_some_and(|size| size != rect.size()) {
            self.frame_all(rect);
        }
        let steps = pointer::steps(ui, &response);
        let map = self.navigate(ui, &response, &steps, &mut state.tools);
        state.tools.pointer_m = response.hover_pos().map(|p| map.to_ego(p));
        if let Some(at_m) = state.tools.pointer_m {
            state.pointed.readout = readout(input.scene, at_m);
            let height_m = input.scene.frame().layout.relief.height_m(at_m);
            place_marks::point(state, PaneId::BEV, at_m.extend(height_m));
        }
        self.driver.drive(
            ui,
            &response,
            &steps,
            &seen(input, &map),
            &mut state.tools,
            commands,
        );
        let map = ScreenMap {
            center_m: self.center_m,
            ..map
        };
        self.map = Some(map);
        let clip = ui.clip_rect().intersect(rect);
        ui.scope(|ui| {
            ui.set_clip_rect(clip);
            self.draw(ui, &response, &map, input, state);
            if let Some(place_m) = place_marks::elsewhere(state, PaneId::BEV) {
                place_marks::draw(ui.painter(), map.to_screen(place_m.truncate()));
            }
        });
        canvas_access::boxes(ui, &map, input.scene, state, commands);
        response
    }

    /// Draws the view into `rect` as `map` places it, without answering the pointer.
    pub(super) fn still(&mut self, ui: &Ui, rect: Rect, map: &ScreenMap, scene: &Scene, state: &UiState) {
        let response = ui.interact(rect, ui.scope_id().with("still"), Sense::empty());
        let input = CanvasInput {
            scene,
            settled: scene,
            lidar: None,
            unsettled: Arc::default(),
            generating: false,
        };
        let mut state = state.clone();
        state.tool = select::ID;
        let map = ScreenMap { rect, ..*map };
        self.extent = scene.frame().extent();
        self.draw(ui, &response, &map, &input, &state);
    }

    /// Fits the whole map into a pane.
    pub fn frame_all(&mut self, rect: Rect) {
        let (low, high) = self.corners_m();
        let size = high - low + 2.0 * MARGIN_M;
        let along = |points: f32, m: f64| f64::from(points.max(80.0)) / m;
        self.center_m = (low + high) / 2.0;
        self.scale = along(rect.height(), size.x).min(along(rect.width(), size.y));
        self.fitted = Some(rect.size());
    }

    /// Lower and upper corner of the map, ego frame, m.
    fn corners_m(&self) -> (DVec2, DVec2) {
        (self.extent.min_m().truncate(), self.extent.max_m().truncate())
    }

    /// Centres a box.
    pub fn frame_box(&mut self, b: &SceneBox) {
        self.center_m = b.center_m.truncate();
        self.scale = self.scale.max(14.0);
        self.fitted = None;
    }

    /// The centre of the view, ego frame, m, and points per metre; 0 before the first picture.
    pub fn place(&self) -> (DVec2, f64) {
        (self.center_m, self.scale)
    }

    /// Goes to a centre and a scale, points per metre. The scale is clamped; values that are not finite change nothing.
    pub fn go_to(&mut self, center_m: DVec2, scale: f64) {
        if center_m.is_finite() && scale.is_finite() && scale > 0.0 {
            self.center_m = center_m;
            self.scale = scale.clamp(*SCALE.start(), *SCALE.end());
            self.fitted = None;
        }
    }

    /// Forgets the cached pictures, which were made with other colours.
    pub fn forget_pictures(&mut self) {
        (self.layers, self.occupancy, self.unobserved) = (None, None, None);
    }

    /// Fits the grid again into the pane drawn last.
    pub fn frame_all_again(&mut self) {
        if let Some(map) = self.map {
            self.frame_all(map.rect);
        }
    }

    fn navigate(
        &mut self,
        ui: &Ui,
        response: &Response,
        steps: &[PointerEvent],
        hand: &mut Hand,
    ) -> ScreenMap {
        let mut map = ScreenMap {
            rect: response.rect,
            center_m: self.center_m,
            scale: self.scale,
        };
        let (scroll, zoom) = ui.input(|i| (i.smooth_scroll_delta().y, i.zoom_delta()));
        if let Some(pointer) = response.hover_pos() {
            // With Ctrl held egui turns the wheel into a zoom; here it sets the size of the brush.
            if (zoom - 1.0).abs() > 1e-3 {
                hand.scale_brush(f64::from(zoom));
            } else if scroll != 0.0 {
                let under = map.to_ego(pointer);
                let scale = self.scale * f64::from(scroll / 220.0).exp();
                self.scale = scale.clamp(*SCALE.start(), *SCALE.end());
                self.fitted = None;
                // The point under the pointer stays in place.
                self.center_m = under + (self.center_m - under) * (map.scale / self.scale);
            }
        }
        let space = ui.input(|i| i.key_down(egui::Key::Space));
        let wants = |button, _| match button {
            PointerButton::Middle => true,
            PointerButton::Primary => space,
            _ => false,
        };
        if let Some((_, d)) = self.held.travel(steps, wants) {
            self.center_m += DVec2::new(f64::from(d.y), f64::from(d.x)) / self.scale;
            self.fitted = None;
        }
        let (low, high) = self.corners_m();
        let beyond = (high - low) / 4.0;
        self.center_m = self.center_m.clamp(low - beyond, high + beyond);
        (map.center_m, map.scale) = (self.center_m, self.scale);
        map
    }

    fn draw(
        &mut self,
        ui: &Ui,
        response: &Response,
        map: &ScreenMap,
        input: &CanvasInput<'_>,
        state: &UiState,
    ) {
        let painter = ui.painter();
        let grid = {
            let (low, high) = self.corners_m();
            map.rect_of(low, high)
        };
        for strip in around(grid, map.rect) {
            painter.rect_filled(strip, 0.0, theme::CANVAS);
        }
        let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
        let scene = input.scene;
        if state.shown.underlay != Underlay::Layout {
            painter.image(self.occupancy_texture(ui, scene), grid, whole, Color32::WHITE);
        }
        if state.shown.underlay != Underlay::Occupancy {
            let over_voxels = state.shown.underlay == Underlay::Both;
            let layers = self.layers_texture(ui, scene, &state.tools, over_voxels);
            painter.image(layers, grid, whole, Color32::WHITE);
        }
        if let (true, Some(mask)) = (state.shown.unobserved, &scene.frame().inferred.unobserved) {
            let make = || bev_image::unobserved(mask);
            let veil = texture(ui, &mut self.unobserved, scene.content(), "unobserved", make);
            painter.image(veil, grid, whole, Color32::WHITE);
        }
        if state.shown.grid {
            draw_grid(ui, map, grid);
        }
        painter.rect_stroke(
            grid,
            0.0,
            Stroke::new(1.0, Color32::from_white_alpha(34)),
            StrokeKind::Outside,
        );
        if state.shown.lines && state.shown.underlay != Underlay::Occupancy {
            draw_lines(
                &painter.with_clip_rect(painter.clip_rect().intersect(grid)),
                map,
                scene,
            );
        }
        if let (true, Some(sweep)) = (state.shown.lidar_from_above, input.lidar) {
            draw_points(ui, map, sweep, &state.lidar);
        }
        let hovered = response
            .hover_pos()
            .filter(|_| state.tool == select::ID && !self.driver.is_held())
            .map(|p| map.to_ego(p))
            .filter(|p| pick::box_at(scene.frame(), *p).is_none())
            .and_then(|p| select::thing_under(scene, state, p, 8.0 / map.scale));
        let inside = painter.with_clip_rect(painter.clip_rect().intersect(map.rect));
        thing_outlines::outlines(&inside, map, scene, &state.things, hovered);
        track_marks::from_above(&inside, map, scene, state);
        let pose = &scene.frame().world_from_ego;
        draw_ego(ui, map, &scene.rig, pose);
        if state.windows.sensors {
            let chosen = match state.windows.sensor {
                SensorChoice::Camera(i) => Some(i),
                SensorChoice::Lidar(_) | SensorChoice::Radar(_) => None,
            };
            draw_fields_of_view(ui, map, &scene.rig, pose, chosen);
        }
        if state.shown.boxes {
            draw_boxes(ui, map, response, input.scene, state);
        }
        unsettled_marks::from_above(ui.painter(), map, self.extent, &input.unsettled, input.generating);
        if let Some(marks) = &state.shown.detection_marks {
            marks.on_map(
                &painter.with_clip_rect(painter.clip_rect().intersect(map.rect)),
                map,
                scene.frame(),
            );
        }
        if let Some(marks) = &state.shown.finding_marks {
            let inside = painter.with_clip_rect(painter.clip_rect().intersect(map.rect));
            marks.draw(&inside, map, scene.frame());
        }
        draw_scale_bar(ui, map);
        self.draw_tool(ui, response, map, input, &state.tools);
    }

    fn layers_texture(
        &mut self,
        ui: &Ui,
        scene: &Scene,
        tools: &ToolState,
        over_voxels: bool,
    ) -> egui::TextureId {
        // Alone the picture covers what is behind it. Pixels drawn twice are slow on a software rasteriser.
        let (veil, behind) = match over_voxels {
            true => (tools.layers_opacity, Color32::TRANSPARENT),
            false => (1.0, GROUND),
        };
        let byte = |share: f32| (share.clamp(0.0, 1.0) * 255.0).round() as u8;
        let style = LayerStyle {
            shown: tools.layers_shown,
            opacity: tools.layer_opacity.map(byte),
            veil: byte(veil),
        };
        let key = (scene.content(), style, behind);
        let make = || bev_image::layers(&scene.frame().layout, &style, behind);
        texture(ui, &mut self.layers, key, "layers", make)
    }

    fn occupancy_texture(&mut self, ui: &Ui, scene: &Scene) -> egui::TextureId {
        let make = || bev_image::occupancy(&scene.frame().occupancy, GROUND);
        texture(ui, &mut self.occupancy, scene.rev, "occupancy", make)
    }

    /// Draws the marks of the tools and sets the cursor.
    fn draw_tool(
        &self,
        ui: &Ui,
        response: &Response,
        map: &ScreenMap,
        input: &CanvasInput<'_>,
        tools: &ToolState,
    ) {
        let painter = ui.painter();
        if tools.tool == region::ID || !tools.region.is_empty() {
            marks::region(painter, map, tools.region.cells());
        }
        if tools.row_open {
            let (boxes, things) = row::coming(input.scene, tools);
            for b in boxes {
                draw_box(ui, map, &b, b.class.color(), BoxStyle::Ghost);
            }
            thing_outlines::copies(painter, map, input.scene, &things);
        }
        let (marks, cursor) = self
            .driver
            .sight(ui, response.hover_pos(), &seen(input, map), tools);
        let board = Board {
            painter,
            view: map,
            map: Some(map),
            extent: self.extent,
        };
        board.paint(ui, &marks);
        // A still view does not react to the pointer.
        if response.hover_pos().is_some() && response.sense.senses_drag() {
            let pans = ui.input(|i| i.key_down(egui::Key::Space) || i.pointer.middle_down());
            let cursor = if pans { egui::CursorIcon::Grab } else { cursor };
            ui.ctx().set_cursor_icon(cursor);
        }
    }
}

fn seen<'a>(input: &CanvasInput<'a>, map: &'a ScreenMap) -> ViewContext<'a> {
    ViewContext {
        scene: input.scene,
        settled: input.settled,
        view: map,
    }
}

fn texture<K: PartialEq>(
    ui: &Ui,
    slot: &mut Option<CanvasTexture<K>>,
    key: K,
    name: &str,
    make: impl FnOnce() -> ColorImage,
) -> egui::TextureId {
    // Large cells stay crisp. Small ones are averaged, or thin lines would flicker.
    let options = TextureOptions {
        magnification: egui::TextureFilter::Nearest,
        ..TextureOptions::LINEAR
    };
    match slot {
        Some(shown) if shown.key == key => {}
        Some(shown) => {
            let image = Arc::new(make());
            // Only the pixels that differ go to the device.
            match bev_image::differing(&image, &shown.image) {
                None => shown.handle.set(image.clone(), options),
                Some(rect) if rect.is_positive() => {
                    let part = image.region_by_pixels(rect.min, rect.size);
                    shown.handle.set_partial(rect.min, part, options);
                }
                Some(_) => {}
            }
            (shown.key, shown.image) = (key, image);
        }
        None => {
            let image = Arc::new(make());
            let handle = ui.ctx().load_texture(name, image.clone(), options);
            *slot = Some(CanvasTexture { key, image, handle });
        }
    }
    slot.as_ref()
        .map_or(egui::TextureId::default(), |shown| shown.handle.id())
}

/// The thing whose footprint holds a point of the ego frame, m.
fn thing_under(scene: &Scene, p_m: DVec2) -> Option<&Thing> {
    let id = pick_things::thing_at(&scene.background, p_m, 0.0)?;
    scene.background.get(id)
}

/// A voxel's class, and the name that its data set has for it where that says more.
pub(super) fn label_text(scene: &Scene, class: Class, voxel: [usize; 3]) -> String {
    let name = t(&class.label()).to_owned();
    let labels = scene.frame().inferred.data_labels.as_ref();
    let told = labels.and_then(|labels| labels.set().name(labels.label(voxel, class)));
    match told.filter(|told| *told != class.name()) {
        Some(told) => format!("{name} ({told})"),
        None => name,
    }
}

/// The status bar's text for a point of the view: position, layers, voxels, box or thing.
pub(super) fn readout(scene: &Scene, p_m: DVec2) -> String {
    let mut parts = vec![position_text(p_m)];
    let frame = scene.frame();
    parts.push(tf!(
        "{distance} m away",
        distance = format!("{:.1}", p_m.length())
    ));
    let Some([x, y]) = frame.extent().column_at(p_m.x, p_m.y) else {
        parts.push(t("outside the map").into());
        return parts.join("  ·  ");
    };
    let cell = frame.layout.cell(x, y);
    let names: Vec<String> = BevLayer::MAP
        .iter()
        .filter(|l| cell & l.bit() != 0)
        .map(|l| t(&l.label()).to_owned())
        .collect();
    if !names.is_empty() {
        parts.push(names.join(", "));
    }
    let column = frame.occupancy.column(x, y);
    let top = column.iter().rposition(|v| *v != Class::FREE);
    parts.push(match top.and_then(|z| Class::from_id(column[z]).zip(Some(z))) {
        Some((class, z)) => tf!("on top {class}", class = label_text(scene, class, [x, y, z])),
        None => t("nothing seen").into(),
    });
    if let Some(id) = pick::box_at(frame, p_m) {
        parts.push(format!("{} #{}", called(&frame.boxes[&id]), id.0));
    } else if let Some(thing) = thing_under(scene, p_m) {
        parts.push(tf!(
            "{name} #{id}, {height} m high",
            name = t(thing.form.name()),
            id = thing.id.0,
            height = format!("{:.1}", thing.form.height_m())
        ));
    }
    parts.join("  ·  ")
}
