//! A sweep as a picture: azimuth from left to right as the driver sees it, beams from top to bottom. A click chooses
//! the box that a return hit.

use std::sync::Arc;

use egui::accesskit::Role;
use egui::{
    Color32, ColorImage, Rect, Sense, Stroke, StrokeKind, TextureHandle, TextureOptions, Ui, WidgetInfo, pos2,
};
use glam::DVec3;

use super::id::PaneId;
use crate::command::Command;
use crate::place_marks;
use crate::state::{UiState, called};
use crate::tools::ToolCommand;
use language::{t, tf};
use scene::{BoxId, LidarPattern, LidarPoint, LidarSweep, Pose, Scene, SceneBox, SceneRev};
use viewport::{LidarColorMode, lidar_colors};
use widgets::theme;

/// Columns of the picture.
pub const COLUMNS: usize = 1080;
/// Margin around a box within which returns count as its own, m: the sides of voxels stick out of it.
const MARGIN_M: f64 = 0.25;
/// Depth below a box to which returns of its class count as its own, m: in labels, the ground and the objects on it are
/// two voxels lower.
const BELOW_M: f64 = 0.8;

/// Pose of a sensor. Azimuths and elevations are relative to the vehicle; returns are in the world frame.
pub struct Mount {
    ego_from_world: Pose,
    at_m: DVec3,
}

impl Mount {
    /// The mount of a sensor on a vehicle at a pose.
    pub fn new(world_from_ego: &Pose, lidar: &LidarPattern) -> Self {
        Self {
            ego_from_world: world_from_ego.inverse(),
            at_m: DVec3::from_array(lidar.translation_m),
        }
    }

    /// Azimuth of a place of the world as seen from the sensor, degrees, counter-clockwise from forward.
    pub fn azimuth_deg(&self, p_m: DVec3) -> f64 {
        let d = self.ego_from_world.apply(p_m) - self.at_m;
        d.y.atan2(d.x).to_degrees()
    }

    /// The place of a point of the world in the picture, 0 to 1 from the left and from the top, at the beam nearest to
    /// its elevation.
    pub fn part_of(&self, p_m: DVec3, elevations_deg: &[f64]) -> [f64; 2] {
        let d = self.ego_from_world.apply(p_m) - self.at_m;
        let up_deg = d.z.atan2(d.truncate().length()).to_degrees();
        let off = |i: &usize| (elevations_deg[*i] - up_deg).abs();
        let ring = (0..elevations_deg.len()).min_by(|a, b| off(a).total_cmp(&off(b)));
        let rings = elevations_deg.len().max(1) as f64;
        let down = 1.0 - (ring.unwrap_or(0) as f64 + 0.5) / rings;
        [(180.0 - self.azimuth_deg(p_m)) / 360.0, down]
    }

    /// The column of a return in the picture.
    pub fn column(&self, point: &LidarPoint) -> usize {
        column(self.azimuth_deg(place_of(point)))
    }
}

fn place_of(point: &LidarPoint) -> DVec3 {
    DVec3::from_array(point.position_in_ego.map(f64::from))
}

fn column(azimuth_deg: f64) -> usize {
    (((180.0 - azimuth_deg) / 360.0 * COLUMNS as f64) as usize).min(COLUMNS - 1)
}

/// The picture and the sweep that it was made from.
#[derive(Default)]
pub struct SweepPicture {
    texture: Option<(Arc<LidarSweep>, LidarColorMode, usize, TextureHandle)>,
    /// Outlines of the chosen boxes, with the key that they were made from.
    outlined: Option<(OutlinesOf, Vec<PictureRectangle>)>,
}

/// Opposite corners of a rectangle, as parts of the picture.
type PictureRectangle = [[f64; 2]; 2];
/// Key of the outlines: the sweep, the state of the scene and the chosen boxes.
type OutlinesOf = (Arc<LidarSweep>, SceneRev, Vec<BoxId>);

fn same(a: &OutlinesOf, b: &OutlinesOf) -> bool {
    Arc::ptr_eq(&a.0, &b.0) && (a.1, &a.2) == (b.1, &b.2)
}

impl SweepPicture {
    /// Draws the sweep, made where the vehicle was at a pose, into all the available space, and answers the pointer.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        scene: &Scene,
        sweep: Option<(&Arc<LidarSweep>, &Pose)>,
        state: &mut UiState,
        commands: &mut Vec<Command>,
    ) {
        let rect = ui.available_rect_before_wrap();
        let response = ui.allocate_rect(rect, Sense::click());
        response.widget_info(|| WidgetInfo::labeled(Role::Canvas, true, t("LiDAR sweep")));
        ui.painter().rect_filled(rect, 0.0, theme::well());
        let (Some((sweep, swept_at)), Some(lidar)) = (sweep, scene.rig.lidars.first()) else {
            let text = match scene.rig.lidars.is_empty() {
                true => t("This vehicle has no LiDAR. Sensors… adds one."),
                false => t("rendering…"),
            };
            let font = egui::TextStyle::Body.resolve(ui.style());
            let painter = ui.painter();
            painter.text(
                rect.center(),
                egui::Align2::CENTER_CENTER,
                text,
                font,
                theme::text_weak(),
            );
            return;
        };
        let (rings, mount) = (lidar.elevations_deg.len().max(1), Mount::new(swept_at, lidar));
        let mode = state.lidar.colors;
        let known = |(of, m, n, _): &(Arc<LidarSweep>, LidarColorMode, usize, _)| {
            Arc::ptr_eq(of, sweep) && *m == mode && *n == rings
        };
        if !self.texture.as_ref().is_some_and(known) {
            let image = picture(sweep, mode, rings, &mount);
            let options = TextureOptions::NEAREST;
            let handle = ui.ctx().load_texture("sweep", image, options);
            self.texture = Some((sweep.clone(), mode, rings, handle));
        }
        let Some((.., handle)) = &self.texture else { return };
        let unit = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
        let painter = ui.painter().with_clip_rect(rect.intersect(ui.clip_rect()));
        painter.image(handle.id(), rect, unit, Color32::WHITE);
        // The outlines are kept: each box is searched for in all returns.
        let of = (sweep.clone(), scene.rev, state.chosen());
        if self.outlined.as_ref().is_none_or(|(known, _)| !same(known, &of)) {
            let boxes = of.2.iter().filter_map(|id| scene.frame().boxes.get(id));
            let found = boxes.flat_map(|b| outlines(sweep, &mount, rings, b)).collect();
            self.outlined = Some((of, found));
        }
        for outline in self.outlined.iter().flat_map(|(_, found)| found) {
            let at = |part: [f64; 2]| rect.min + egui::vec2(part[0] as f32, part[1] as f32) * rect.size();
            let around = Rect::from_two_pos(at(outline[0]), at(outline[1])).expand(2.0);
            let dark = Stroke::new(3.5, Color32::from_black_alpha(150));
            painter.rect_stroke(around, 2.0, dark, StrokeKind::Middle);
            let light = Stroke::new(1.5, Color32::WHITE);
            painter.rect_stroke(around, 2.0, light, StrokeKind::Middle);
        }
        if let Some(place_m) = place_marks::elsewhere(state, PaneId::LIDAR) {
            let [x, y] = mount.part_of(place_m, &lidar.elevations_deg).map(|v| v as f32);
            place_marks::draw(&painter, rect.min + egui::vec2(x, y) * rect.size());
        }
        let Some(p) = response.hover_pos() else {
            return;
        };
        let part = (p - rect.min) / rect.size();
        let azimuth_deg = 180.0 - f64::from(part.x) * 360.0;
        let ring = ((f64::from(1.0 - part.y) * rings as f64) as usize).min(rings - 1);
        let near = nearest(sweep, &mount, ring, azimuth_deg);
        let hit = near.and_then(|point| box_of(scene, point));
        state.pointed.readout = match near {
            Some(point) => tf!(
                "azimuth {azimuth}°  ·  beam {beam}  ·  {range} m  ·  {class}",
                azimuth = format!("{azimuth_deg:.0}"),
                beam = ring,
                range = format!("{:.2}", point.range_m),
                class = match hit {
                    Some(b) => format!("{} #{}", called(b), b.id.0),
                    None => t(&point.class.label()).to_owned(),
                }
            ),
            None => tf!(
                "azimuth {azimuth}°  ·  beam {beam}  ·  no return",
                azimuth = format!("{azimuth_deg:.0}"),
                beam = ring
            ),
        };
        if let Some(point) = near {
            place_marks::point(state, PaneId::LIDAR, place_of(point));
        }
        if response.clicked() {
            let shift = ui.input(|i| i.modifiers.shift);
            let choose = ToolCommand::clicked(hit.map(|b| b.id), shift);
            commands.push(Command::Tools(choose));
        }
    }
}

/// True if a return belongs to a box.
fn is_of(b: &SceneBox, point: &LidarPoint) -> bool {
    let p_m = place_of(point);
    b.contains(p_m, MARGIN_M) || point.class == b.class && b.contains(p_m + DVec3::Z * BELOW_M, MARGIN_M)
}

/// The box that a return belongs to; the smallest of several.
fn box_of<'a>(scene: &'a Scene, point: &LidarPoint) -> Option<&'a SceneBox> {
    let hidden = &scene.arranged.hidden.boxes;
    let holds = |b: &&SceneBox| !hidden.contains(&b.id) && is_of(b, point);
    let volume = |b: &SceneBox| b.size_m.element_product();
    let all = scene.frame().boxes.values().filter(holds);
    all.min_by(|a, b| volume(a).total_cmp(&volume(b)))
}

/// Rectangles around the returns of a box, each with two opposite corners as parts of the picture: none without
/// returns, two if the box crosses the edge of the picture.
fn outlines(sweep: &LidarSweep, mount: &Mount, rings: usize, b: &SceneBox) -> Vec<PictureRectangle> {
    let middle_deg = mount.azimuth_deg(b.center_m);
    let mut low = [f64::INFINITY; 2];
    let mut high = [f64::NEG_INFINITY; 2];
    for point in sweep.points.iter().filter(|p| is_of(b, p)) {
        let turn = mount.azimuth_deg(place_of(point)) - middle_deg;
        let off_deg = (turn + 180.0).rem_euclid(360.0) - 180.0;
        let down = 1.0 - (f64::from(point.ring) + 0.5) / rings as f64;
        let at = [(180.0 - middle_deg - off_deg) / 360.0, down];
        for axis in 0..2 {
            low[axis] = low[axis].min(at[axis]);
            high[axis] = high[axis].max(at[axis]);
        }
    }
    if low[0] > high[0] {
        return Vec::new();
    }
    let moved = |by: f64| [[low[0] + by, low[1]], [high[0] + by, high[1]]];
    let mut out = vec![moved(0.0)];
    if low[0] < 0.0 {
        out.push(moved(1.0));
    }
    if high[0] > 1.0 {
        out.push(moved(-1.0));
    }
    out
}

fn picture(sweep: &LidarSweep, mode: LidarColorMode, rings: usize, mount: &Mount) -> ColorImage {
    let mut image = ColorImage::filled([COLUMNS, rings], theme::well());
    for (point, [r, g, b, _]) in sweep.points.iter().zip(lidar_colors(sweep, mode)) {
        let ring = usize::from(point.ring);
        if ring < rings {
            image[(mount.column(point), rings - 1 - ring)] = Color32::from_rgb(r, g, b);
        }
    }
    image
}

/// The return of a beam that is nearest to an azimuth; `None` if none is within a degree.
fn nearest<'a>(sweep: &'a LidarSweep, mount: &Mount, ring: usize, at_deg: f64) -> Option<&'a LidarPoint> {
    let off = |p: &LidarPoint| (mount.azimuth_deg(place_of(p)) - at_deg).abs();
    let found = sweep
        .points
        .iter()
        .filter(|p| usize::from(p.ring) == ring)
        .min_by(|a, b| off(a).total_cmp(&off(b)))?;
    (off(found) <= 1.0).then_some(found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::Class;

    fn mount(at_m: DVec3, world_from_ego: Pose) -> Mount {
        Mount {
            ego_from_world: world_from_ego.inverse(),
            at_m,
        }
    }

    #[test]
    fn the_sweep_is_unrolled_as_the_driver_sees_it() {
        let here = mount(DVec3::new(1.0, 0.0, 1.8), Pose::IDENTITY);
        let at = |mount: &Mount, x: f64, y: f64| column(mount.azimuth_deg(DVec3::new(x, y, 0.0)));
        assert_eq!(at(&here, 11.0, 0.0), COLUMNS / 2, "forward is in the middle");
        assert_eq!(at(&here, 1.0, 10.0), COLUMNS / 4, "left is left");
        assert_eq!(at(&here, 1.0, -10.0), COLUMNS * 3 / 4, "right is right");
        // The vehicle has driven on and turned to the left.
        let turned = Pose {
            translation_m: DVec3::new(20.0, 5.0, 0.0),
            rotation: glam::DQuat::from_rotation_z(std::f64::consts::FRAC_PI_2),
        };
        let later = mount(DVec3::ZERO, turned);
        assert!(
            at(&later, 20.0, 15.0).abs_diff(COLUMNS / 2) < 2,
            "forward is in the middle"
        );
        assert!(
            at(&later, 25.0, 5.1) > COLUMNS * 7 / 10,
            "world x lies on its right"
        );
    }

    #[test]
    fn places_are_where_a_beam_looks() {
        let here = mount(DVec3::new(0.0, 0.0, 2.0), Pose::IDENTITY);
        let beams = [-20.0, -10.0, 0.0, 10.0];
        // 10 m to the left and 1.8 m lower: ten degrees down, the second beam from below.
        let [x, y] = here.part_of(DVec3::new(0.0, 10.0, 0.2), &beams);
        assert!(
            (x - 0.25).abs() < 1e-9 && (y - (1.0 - 1.5 / 4.0)).abs() < 1e-9,
            "{x} {y}"
        );
        let above = here.part_of(DVec3::new(1.0, 0.0, 30.0), &beams);
        assert_eq!(above, [0.5, 1.0 - 3.5 / 4.0]);
        assert!(here.part_of(DVec3::ONE, &[]).iter().all(|v| v.is_finite()));
    }

    #[test]
    fn a_box_behind_is_outlined_at_both_edges() {
        let here = mount(DVec3::ZERO, Pose::IDENTITY);
        let b = SceneBox {
            id: BoxId(1),
            class: Class::Car,
            center_m: DVec3::new(-10.0, 0.0, 0.0),
            size_m: DVec3::new(4.0, 2.0, 2.0),
            yaw_rad: 0.0,
            velocity_mps: glam::DVec2::ZERO,
            label: Default::default(),
        };
        let point = |x: f32, y: f32, ring: u16| LidarPoint {
            position_in_ego: [x, y, 0.0],
            range_m: x.hypot(y),
            ring,
            azimuth: 0,
            class: Class::Car,
            intensity: 0.0,
            drop_probability: 0.0,
            time_s: 0.0,
            velocity_mps: [0.0; 2],
        };
        let mut sweep = LidarSweep {
            points: vec![point(-8.0, 1.0, 3), point(-8.0, -1.0, 5), point(9.0, 0.0, 0)],
            rays: 3,
            physical: true,
            provenance: Vec::new(),
        };
        let found = outlines(&sweep, &here, 10, &b);
        assert_eq!(found.len(), 2, "{found:?}");
        let wide = found.iter().map(|[a, b]| b[0] - a[0]);
        assert!(wide.into_iter().all(|w| w < 0.1), "{found:?}");
        assert!(
            found
                .iter()
                .all(|[a, b]| a[1] == 1.0 - 0.55 && b[1] == 1.0 - 0.35)
        );
        sweep.points.truncate(0);
        assert!(outlines(&sweep, &here, 10, &b).is_empty());
    }
}
