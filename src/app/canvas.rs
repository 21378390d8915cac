//! The bird's-eye view: a frame from above with forward up, drawn and taken hold of. Gestures are
//! in `canvas_tools.rs`.

use egui::accesskit::Role;
use egui::{
    Align2, Color32, PointerButton, Pos2, Rect, Response, Sense, Shape, Stroke, StrokeKind, TextureHandle,
    TextureOptions, Ui, WidgetInfo, pos2, vec2,
};
use glam::DVec2;

use crate::editor::pick;
use crate::scene::{
    BevLayer, Class, GridSpec, LidarSweep, PolylineKind, Scene, SceneBox, SceneRev, SensorRig,
};

use super::bev_image;
use super::canvas_tools::Gesture;
use super::command::Command;
use super::pointer::{self, Held, Step};
use super::state::{Tool, UiState, Underlay};
use super::theme;

/// From the ego frame to the screen and back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScreenMap {
    /// The pane, points.
    pub rect: Rect,
    /// Point of the ego frame in the middle of the pane, m.
    pub center_m: DVec2,
    /// Points per metre.
    pub scale: f64,
}

impl ScreenMap {
    /// Where a point of the ego frame appears.
    pub fn to_screen(&self, p_m: DVec2) -> Pos2 {
        let d = (p_m - self.center_m) * self.scale;
        self.rect.center() + vec2(-d.y as f32, -d.x as f32)
    }

    /// The point of the ego frame under a point of the screen, m.
    pub fn to_ego(&self, p: Pos2) -> DVec2 {
        let d = p - self.rect.center();
        self.center_m + DVec2::new(-f64::from(d.y), -f64::from(d.x)) / self.scale
    }

    fn rect_of(&self, min_m: DVec2, max_m: DVec2) -> Rect {
        Rect::from_two_pos(self.to_screen(min_m), self.to_screen(max_m))
    }
}

/// The bird's-eye view's own state.
pub struct Canvas {
    center_m: DVec2,
    scale: f64, // points per metre; 0 before the first fit
    held: Held,
    /// What the pointer is doing.
    pub(super) gesture: Gesture,
    /// The last map from ego to screen; tests click with it.
    pub map: Option<ScreenMap>,
    layers: Option<(LayersKey, TextureHandle)>,
    occupancy: Option<(SceneRev, TextureHandle)>,
    unobserved: Option<(SceneRev, TextureHandle)>,
}

type LayersKey = (SceneRev, u32, bool);

/// What the canvas draws.
pub struct CanvasInput<'a> {
    /// The scene shown, a drag in progress included.
    pub scene: &'a Scene,
    /// The newest sweep.
    pub lidar: Option<&'a LidarSweep>,
    /// Lowest and highest column that is still to be generated, both included.
    pub unsettled: Option<([usize; 2], [usize; 2])>,
    /// A job is on its way.
    pub generating: bool,
}

const SCALE: std::ops::RangeInclusive<f64> = 2.0..=120.0;
/// Where nothing is painted.
const GROUND: Color32 = Color32::from_rgb(29, 32, 37);
/// Half the extent of the grid, m.
const HALF_M: f64 = GridSpec::MAX_M[0];

impl Default for Canvas {
    fn default() -> Self {
        Self {
            center_m: DVec2::ZERO,
            scale: 0.0,
            held: Held::default(),
            gesture: Gesture::None,
            map: None,
            layers: None,
            occupancy: None,
            unobserved: None,
        }
    }
}

impl Canvas {
    /// Draws the view into all the space there is, and answers the pointer.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        input: &CanvasInput<'_>,
        state: &mut UiState,
        commands: &mut Vec<Command>,
    ) -> Response {
        let rect = ui.available_rect_before_wrap();
        let response = ui.allocate_rect(rect, Sense::drag());
        response.widget_info(|| WidgetInfo::labeled(Role::Canvas, true, "Bird's-eye view"));
        if self.scale == 0.0 {
            self.frame_all(rect);
        }
        let steps = pointer::steps(ui, &response);
        let map = self.navigate(ui, &response, &steps, state);
        self.interact(ui, &response, &map, input.scene, state, commands);
        let map = ScreenMap {
            center_m: self.center_m,
            ..map
        };
        self.map = Some(map);
        let clip = ui.clip_rect().intersect(rect);
        ui.scope(|ui| {
            ui.set_clip_rect(clip);
            self.draw(ui, &response, &map, input, state);
        });
        response
    }

    /// Fits the whole grid into a pane.
    pub fn frame_all(&mut self, rect: Rect) {
        let side = f64::from(rect.width().min(rect.height()).max(80.0));
        self.center_m = DVec2::ZERO;
        self.scale = side / (2.0 * HALF_M + 4.0);
    }

    /// Brings a box into the middle.
    pub fn frame_box(&mut self, b: &SceneBox) {
        self.center_m = b.center_m.truncate();
        self.scale = self.scale.max(14.0);
    }

    /// Fits the grid again into the pane drawn last.
    pub fn frame_all_again(&mut self) {
        if let Some(map) = self.map {
            self.frame_all(map.rect);
        }
    }

    fn navigate(&mut self, ui: &Ui, response: &Response, steps: &[Step], state: &mut UiState) -> ScreenMap {
        let mut map = ScreenMap {
            rect: response.rect,
            center_m: self.center_m,
            scale: self.scale,
        };
        let (scroll, zoom) = ui.input(|i| (i.smooth_scroll_delta().y, i.zoom_delta()));
        if let Some(pointer) = response.hover_pos() {
            // With Ctrl held egui turns the wheel into a zoom: here it is the brush's size.
            if (zoom - 1.0).abs() > 1e-3 {
                state.brush_m = (state.brush_m * f64::from(zoom))
                    .clamp(*UiState::BRUSH_M.start(), *UiState::BRUSH_M.end());
            } else if scroll != 0.0 {
                let under = map.to_ego(pointer);
                let scale = self.scale * f64::from(scroll / 220.0).exp();
                self.scale = scale.clamp(*SCALE.start(), *SCALE.end());
                // What is under the pointer stays there.
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
        }
        let limit = DVec2::splat(HALF_M * 1.5);
        self.center_m = self.center_m.clamp(-limit, limit);
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
        let grid = map.rect_of(DVec2::splat(-HALF_M), DVec2::splat(HALF_M));
        for strip in around(grid, map.rect) {
            painter.rect_filled(strip, 0.0, theme::BACKGROUND);
        }
        let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
        let scene = input.scene;
        if state.underlay != Underlay::Layout {
            painter.image(self.occupancy_texture(ui, scene), grid, whole, Color32::WHITE);
        }
        if state.underlay != Underlay::Occupancy {
            painter.image(self.layers_texture(ui, scene, state), grid, whole, Color32::WHITE);
        }
        if let (true, Some(mask)) = (state.show_unobserved, &scene.frame().inferred.unobserved) {
            let make = || bev_image::unobserved(mask);
            let veil = texture(ui, &mut self.unobserved, scene.rev, "unobserved", make);
            painter.image(veil, grid, whole, Color32::WHITE);
        }
        if state.show_grid {
            draw_grid(ui, map, grid);
        }
        painter.rect_stroke(
            grid,
            0.0,
            Stroke::new(1.0, Color32::from_white_alpha(34)),
            StrokeKind::Outside,
        );
        if state.show_lines && state.underlay != Underlay::Occupancy {
            draw_lines(
                &painter.with_clip_rect(painter.clip_rect().intersect(grid)),
                map,
                scene,
            );
        }
        if let (true, Some(sweep)) = (state.show_lidar_bev, input.lidar) {
            draw_points(ui, map, sweep, state);
        }
        draw_ego(ui, map, &scene.rig);
        if state.show_boxes {
            draw_boxes(ui, map, response, input.scene, state);
        }
        draw_unsettled(ui, map, input);
        self.draw_tool(ui, response, map, scene, state);
        draw_scale_bar(ui, map);
    }

    fn layers_texture(&mut self, ui: &Ui, scene: &Scene, state: &UiState) -> egui::TextureId {
        let both = state.underlay == Underlay::Both;
        let key = (scene.rev, state.layers_shown, both);
        // Alone the picture covers what is behind it; pixels drawn twice cost on a software rasteriser.
        let (opacity, behind) = if both {
            (0.5, Color32::TRANSPARENT)
        } else {
            (1.0, GROUND)
        };
        let make = || bev_image::layers(&scene.frame().layout, state.layers_shown, opacity, behind);
        texture(ui, &mut self.layers, key, "layers", make)
    }

    fn occupancy_texture(&mut self, ui: &Ui, scene: &Scene) -> egui::TextureId {
        let make = || bev_image::occupancy(&scene.frame().occupancy, GROUND);
        texture(ui, &mut self.occupancy, scene.rev, "occupancy", make)
    }

    fn draw_tool(&self, ui: &Ui, response: &Response, map: &ScreenMap, scene: &Scene, state: &UiState) {
        let painter = ui.painter();
        let shift = ui.input(|i| i.modifiers.shift);
        let Some(pointer) = response.hover_pos() else {
            return;
        };
        match (state.tool, &self.gesture) {
            (Tool::Brush, Gesture::None | Gesture::Stroke { .. }) => {
                let erase = match &self.gesture {
                    Gesture::Stroke { erase, .. } => *erase,
                    _ => state.erase || shift,
                };
                let radius = (state.brush_m / 2.0 * map.scale) as f32;
                let layer = state.layer.color();
                let (color, fill) = match erase {
                    true => (theme::BAD, theme::BAD.gamma_multiply(0.12)),
                    false => (theme::TEXT_STRONG, theme::rgba(layer, 0.35)),
                };
                painter.circle_filled(pointer, radius, fill);
                painter.circle_stroke(pointer, radius, Stroke::new(3.0, Color32::from_black_alpha(140)));
                painter.circle_stroke(pointer, radius, Stroke::new(1.5, color));
                painter.circle_filled(pointer, 1.5, color);
            }
            (Tool::AddBox, Gesture::None | Gesture::Place { .. }) => {
                let (at_m, yaw_rad) = match self.gesture {
                    Gesture::Place { at_m, yaw_rad } => (at_m, yaw_rad),
                    _ => {
                        let at_m = map.to_ego(pointer);
                        (
                            at_m,
                            super::canvas_tools::lane_heading(scene.frame(), at_m).unwrap_or(0.0),
                        )
                    }
                };
                if let Some(ghost) =
                    super::canvas_tools::new_box(scene.frame(), state.box_class, at_m, yaw_rad)
                {
                    draw_box(ui, map, &ghost, BoxLook::Ghost);
                }
            }
            _ => {}
        }
    }
}

fn texture<K: PartialEq>(
    ui: &Ui,
    slot: &mut Option<(K, TextureHandle)>,
    key: K,
    name: &str,
    make: impl FnOnce() -> egui::ColorImage,
) -> egui::TextureId {
    // Large cells stay crisp; small ones are averaged, or thin lines would flicker.
    let options = TextureOptions {
        magnification: egui::TextureFilter::Nearest,
        ..TextureOptions::LINEAR
    };
    match slot {
        Some((old, _)) if *old == key => {}
        Some((old, handle)) => {
            handle.set(make(), options);
            *old = key;
        }
        None => *slot = Some((key, ui.ctx().load_texture(name, make(), options))),
    }
    slot.as_ref()
        .map_or(egui::TextureId::default(), |(_, handle)| handle.id())
}

/// What of `outer` is not covered by `inner`.
fn around(inner: Rect, outer: Rect) -> [Rect; 4] {
    let inner = inner.intersect(outer);
    if !inner.is_positive() {
        return [outer, Rect::NOTHING, Rect::NOTHING, Rect::NOTHING];
    }
    let middle =
        |left: f32, right: f32| Rect::from_min_max(pos2(left, inner.top()), pos2(right, inner.bottom()));
    [
        Rect::from_min_max(outer.min, pos2(outer.right(), inner.top())),
        Rect::from_min_max(pos2(outer.left(), inner.bottom()), outer.max),
        middle(outer.left(), inner.left()),
        middle(inner.right(), outer.right()),
    ]
}

fn draw_grid(ui: &Ui, map: &ScreenMap, grid: Rect) {
    let painter = ui.painter();
    for i in -4..=4 {
        let at = map.to_screen(DVec2::splat(f64::from(i) * 10.0));
        let alpha = if i == 0 { 44 } else { 18 };
        let stroke = Stroke::new(1.0, Color32::from_white_alpha(alpha));
        painter.vline(painter.round_to_pixel_center(at.x), grid.y_range(), stroke);
        painter.hline(grid.x_range(), painter.round_to_pixel_center(at.y), stroke);
    }
}

fn draw_lines(painter: &egui::Painter, map: &ScreenMap, scene: &Scene) {
    for line in scene.frame().layout.polylines.iter() {
        let mut points: Vec<Pos2> = line.points_m.iter().map(|p| map.to_screen(*p)).collect();
        match line.kind {
            PolylineKind::LaneCenter => {
                let stroke = Stroke::new(1.0, Color32::from_rgba_unmultiplied(120, 190, 255, 90));
                painter.extend(Shape::dashed_line(&points, stroke, 5.0, 5.0));
                draw_direction(painter, &points, stroke.color);
            }
            PolylineKind::RoadDivider => {
                painter.line(
                    points,
                    Stroke::new(1.5, theme::rgb(BevLayer::RoadDivider.color())),
                );
            }
            PolylineKind::LaneDivider => {
                painter.line(
                    points,
                    Stroke::new(1.2, theme::rgba(BevLayer::LaneDivider.color(), 0.9)),
                );
            }
            PolylineKind::StopLine => {
                painter.line(points, Stroke::new(2.0, theme::rgb(BevLayer::StopLine.color())));
            }
            PolylineKind::PedCrossing => {
                points.extend(points.first().copied());
                painter.line(
                    points,
                    Stroke::new(1.0, theme::rgba(BevLayer::PedCrossing.color(), 0.8)),
                );
            }
        }
    }
}

/// A small arrow head half way along a lane.
fn draw_direction(painter: &egui::Painter, points: &[Pos2], color: Color32) {
    let Some(pair) = points.get(points.len() / 2..).and_then(|p| p.first_chunk::<2>()) else {
        return;
    };
    let along = (pair[1] - pair[0]).normalized();
    if !along.is_finite() || along == egui::Vec2::ZERO {
        return;
    }
    let side = along.rot90();
    let tip = pair[0] + along * 4.0;
    let wings = [tip - along * 6.0 + side * 3.0, tip - along * 6.0 - side * 3.0];
    let head = vec![tip, wings[0], wings[1]];
    painter.add(Shape::convex_polygon(
        head,
        color.gamma_multiply(1.6),
        Stroke::NONE,
    ));
}

fn draw_points(ui: &Ui, map: &ScreenMap, sweep: &LidarSweep, state: &UiState) {
    let colors = crate::viewport::lidar_colors(sweep, state.lidar_colors);
    let mut mesh = egui::Mesh::default();
    for (point, [r, g, b, _]) in sweep.points.iter().zip(colors) {
        let [x, y, _] = point.position_in_ego;
        let at = map.to_screen(DVec2::new(f64::from(x), f64::from(y)));
        if map.rect.contains(at) {
            let dot = Rect::from_center_size(at, egui::Vec2::splat(1.5));
            mesh.add_colored_rect(dot, Color32::from_rgb(r, g, b));
        }
    }
    ui.painter().add(Shape::mesh(mesh));
}

fn draw_ego(ui: &Ui, map: &ScreenMap, rig: &SensorRig) {
    let (c, half) = (
        rig.ego_center_m,
        [rig.ego_size_m[0] / 2.0, rig.ego_size_m[1] / 2.0],
    );
    let at = |x: f64, y: f64| map.to_screen(DVec2::new(c[0] + x * half[0], c[1] + y * half[1]));
    let body = vec![
        at(1.0, 0.55),
        at(0.8, 1.0),
        at(-1.0, 1.0),
        at(-1.0, -1.0),
        at(0.8, -1.0),
        at(1.0, -0.55),
    ];
    let fill = Color32::from_rgb(228, 232, 238);
    let edge = Stroke::new(1.0, Color32::from_rgb(20, 22, 26));
    ui.painter().add(Shape::convex_polygon(body, fill, edge));
    let glass = vec![at(0.45, 0.72), at(0.45, -0.72), at(0.12, -0.62), at(0.12, 0.62)];
    ui.painter().add(Shape::convex_polygon(
        glass,
        Color32::from_rgb(70, 80, 95),
        Stroke::NONE,
    ));
}

/// How a box is drawn.
#[derive(Clone, Copy, PartialEq, Eq)]
enum BoxLook {
    Plain,
    Hovered,
    Selected,
    Ghost,
}

fn draw_boxes(ui: &Ui, map: &ScreenMap, response: &Response, scene: &Scene, state: &UiState) {
    let frame = scene.frame();
    let hovered = response
        .hover_pos()
        .filter(|_| state.tool == Tool::Select)
        .and_then(|p| pick::box_at(frame, map.to_ego(p)));
    for b in frame.boxes.values() {
        if Some(b.id) != state.selected {
            let look = if Some(b.id) == hovered {
                BoxLook::Hovered
            } else {
                BoxLook::Plain
            };
            draw_box(ui, map, b, look);
        }
    }
    if let Some(b) = state.selected.and_then(|id| frame.boxes.get(&id)) {
        draw_box(ui, map, b, BoxLook::Selected);
        if state.tool == Tool::Select {
            draw_handles(ui, map, b);
        }
    }
}

fn draw_box(ui: &Ui, map: &ScreenMap, b: &SceneBox, look: BoxLook) {
    let painter = ui.painter();
    let color = b.class.color();
    let corners: Vec<Pos2> = b.footprint().iter().map(|p| map.to_screen(*p)).collect();
    let (opacity, edge) = match look {
        BoxLook::Plain => (0.42, Stroke::new(1.3, theme::rgb(color))),
        BoxLook::Hovered => (
            0.62,
            Stroke::new(1.8, theme::rgb(color.map(|c| c.saturating_add(40)))),
        ),
        BoxLook::Selected => (0.62, Stroke::new(2.0, Color32::WHITE)),
        BoxLook::Ghost => (0.28, Stroke::new(1.3, theme::rgba(color, 0.8))),
    };
    painter.add(Shape::convex_polygon(corners, theme::rgba(color, opacity), edge));
    // The heading: from the middle to the front.
    let middle = map.to_screen(b.center_m.truncate());
    let front = map.to_screen(b.center_m.truncate() + b.heading() * (b.size_m.x / 2.0));
    painter.line_segment([middle, front], edge);
}

fn draw_handles(ui: &Ui, map: &ScreenMap, b: &SceneBox) {
    let painter = ui.painter();
    let front = map.to_screen(b.center_m.truncate() + b.heading() * (b.size_m.x / 2.0));
    let knob = map.to_screen(pick::rotate_knob(b));
    painter.line_segment([front, knob], Stroke::new(1.0, Color32::from_white_alpha(150)));
    painter.circle(knob, 5.0, theme::ACCENT, Stroke::new(1.5, Color32::WHITE));
    for corner in b.footprint() {
        let square = Rect::from_center_size(map.to_screen(corner), egui::Vec2::splat(6.0));
        painter.rect(
            square,
            1.0,
            Color32::WHITE,
            Stroke::new(1.0, theme::BACKGROUND),
            StrokeKind::Outside,
        );
    }
}

/// A dashed frame around what is still to be generated.
fn draw_unsettled(ui: &Ui, map: &ScreenMap, input: &CanvasInput<'_>) {
    let Some((low, high)) = input.unsettled else {
        return;
    };
    let color = if input.generating {
        theme::ACCENT
    } else {
        theme::WARN
    };
    let corner = |c: [usize; 2]| GridSpec::center(c[0], c[1], 0).truncate();
    let half = DVec2::splat(GridSpec::VOXEL_M / 2.0);
    let rect = map.rect_of(corner(low) - half, corner(high) + half).expand(2.0);
    ui.painter().rect_filled(rect, 2.0, color.gamma_multiply(0.07));
    let [a, b, c, d] = [
        rect.left_top(),
        rect.right_top(),
        rect.right_bottom(),
        rect.left_bottom(),
    ];
    let stroke = Stroke::new(1.3, color);
    ui.painter()
        .extend(Shape::dashed_line(&[a, b, c, d, a], stroke, 6.0, 4.0));
}

fn draw_scale_bar(ui: &Ui, map: &ScreenMap) {
    let painter = ui.painter();
    let length_m = [1.0, 2.0, 5.0, 10.0, 20.0]
        .into_iter()
        .rfind(|m| m * map.scale <= 110.0)
        .unwrap_or(1.0);
    let length = (length_m * map.scale) as f32;
    let left = pos2(map.rect.left() + 14.0, map.rect.bottom() - 14.0);
    let right = left + vec2(length, 0.0);
    let stroke = Stroke::new(1.5, Color32::from_white_alpha(200));
    painter.line_segment([left, right], stroke);
    for end in [left, right] {
        painter.line_segment([end - vec2(0.0, 4.0), end], stroke);
    }
    let font = egui::TextStyle::Small.resolve(ui.style());
    let text_at = left + vec2(length / 2.0, -5.0);
    painter.text(
        text_at,
        Align2::CENTER_BOTTOM,
        format!("{length_m} m"),
        font,
        theme::TEXT,
    );
}

/// What is under a point of the view, for the status bar.
pub(super) fn readout(scene: &Scene, p_m: DVec2) -> String {
    let mut parts = vec![super::state::position_text(p_m)];
    let frame = scene.frame();
    let Some([x, y]) = GridSpec::column_at(p_m.x, p_m.y) else {
        parts.push("outside the grid".into());
        return parts.join("  ·  ");
    };
    let cell = frame.layout.cell(x, y);
    let names: Vec<String> = BevLayer::MAP
        .iter()
        .filter(|l| cell & l.bit() != 0)
        .map(|l| l.label())
        .collect();
    if !names.is_empty() {
        parts.push(names.join(", "));
    }
    let column = frame.occupancy.column(x, y);
    let top = column.iter().rposition(|v| *v != Class::FREE);
    parts.push(match top.and_then(|z| Class::from_id(column[z])) {
        Some(class) => format!("on top {}", class.label()),
        None => "nothing seen".into(),
    });
    if let Some(id) = pick::box_at(frame, p_m) {
        parts.push(format!("{} #{}", frame.boxes[&id].class.label(), id.0));
    }
    parts.join("  ·  ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_cover_what_is_around() {
        let outer = Rect::from_min_max(pos2(0.0, 0.0), pos2(100.0, 60.0));
        let area = |strips: [Rect; 4]| strips.iter().map(|r| r.area()).sum::<f32>();
        let inner = Rect::from_min_max(pos2(20.0, 10.0), pos2(70.0, 80.0));
        assert_eq!(area(around(inner, outer)), 6000.0 - 50.0 * 50.0);
        assert_eq!(area(around(outer, outer)), 0.0);
        let apart = Rect::from_min_max(pos2(200.0, 0.0), pos2(300.0, 60.0));
        assert_eq!(around(apart, outer)[0], outer);
    }

    #[test]
    fn the_map_goes_both_ways() {
        let map = ScreenMap {
            rect: Rect::from_min_size(pos2(100.0, 50.0), vec2(400.0, 300.0)),
            center_m: DVec2::new(3.0, -2.0),
            scale: 7.5,
        };
        let p = DVec2::new(11.25, 4.5);
        assert!(map.to_ego(map.to_screen(p)).distance(p) < 1e-4);
        // Forward is up, left is left.
        assert!(map.to_screen(DVec2::new(10.0, -2.0)).y < map.rect.center().y);
        assert!(map.to_screen(DVec2::new(3.0, 5.0)).x < map.rect.center().x);
    }
}
