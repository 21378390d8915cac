//! The chosen box from above, from its right and from behind, with the voxels and returns around it. Its faces can be
//! dragged.

use egui::accesskit::Role;
use egui::{Color32, CursorIcon, Pos2, Rect, Sense, Stroke, StrokeKind, Ui, Vec2, WidgetInfo, vec2};
use glam::DVec3;

use super::id::PaneId;
use super::pane::{Pane, PaneContext};
use crate::command::Command;
use crate::tools::Hand;
use editor::Edit;
use language::{t, tf};
use scene::{Class, LidarSweep, Scene, SceneBox};
use widgets::icons::Icon;
use widgets::theme;

/// Margin around the box, m.
const MARGIN_M: f64 = 1.6;
/// Smallest edge that dragging leaves, m.
const MIN_SIZE_M: f64 = 0.2;
/// Distance from a face within which the pointer grabs it, points.
const REACH: f32 = 7.0;

/// A view: its name, and the box axes (0 along the heading, 1 left, 2 up) that run right and up on the screen.
struct AxisView {
    name: &'static str,
    right: (usize, f64),
    up: (usize, f64),
}

const VIEWS: [AxisView; 3] = [
    AxisView {
        name: "From above",
        right: (1, -1.0),
        up: (0, 1.0),
    },
    AxisView {
        name: "From its right",
        right: (0, 1.0),
        up: (2, 1.0),
    },
    AxisView {
        name: "From behind",
        right: (1, -1.0),
        up: (2, 1.0),
    },
];

/// A face that is being dragged.
#[derive(Clone, Copy)]
struct FaceDrag {
    view: usize,
    axis: usize,
    sign: f64,
    start: SceneBox,
    from: Pos2,
    scale: f64,
}

/// The chosen box from three sides, and the face that is dragged.
#[derive(Default)]
pub struct BoxViews {
    held: Option<FaceDrag>,
}

impl Pane for BoxViews {
    fn id(&self) -> PaneId {
        PaneId::BOX_VIEWS
    }

    fn title(&self) -> String {
        "Box views".into()
    }

    fn icon(&self) -> Icon {
        Icon::Sides
    }

    fn ui(&mut self, ui: &mut Ui, cx: &mut PaneContext<'_>, commands: &mut Vec<Command>) {
        let sweep = cx.sensing.lidar().map(|l| &**l);
        self.show(ui, cx.scene, sweep, &cx.state.tools, commands);
    }
}

impl BoxViews {
    /// Draws the three views side by side, or one below the other in a narrow pane.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        scene: &Scene,
        sweep: Option<&LidarSweep>,
        hand: &Hand,
        commands: &mut Vec<Command>,
    ) {
        let all = ui.available_rect_before_wrap();
        ui.painter().rect_filled(all, 0.0, theme::well());
        let Some(b) = hand.selected.and_then(|id| scene.frame().boxes.get(&id)) else {
            self.held = None;
            hint(ui, all, t("Choose a box to see it from three sides."));
            return;
        };
        let along = if all.height() > all.width() {
            Vec2::Y
        } else {
            Vec2::X
        };
        let across = Vec2::splat(1.0) - along;
        let size = (all.size() - 2.0 * along) * (along / 3.0 + across);
        for (i, view) in VIEWS.iter().enumerate() {
            let rect = Rect::from_min_size(all.min + (size + Vec2::splat(1.0)) * along * i as f32, size);
            self.view(ui, rect, i, view, b, scene, sweep, commands);
        }
    }

    #[expect(
        clippy::too_many_arguments,
        reason = "one view of one box: all of it is needed, once"
    )]
    fn view(
        &mut self,
        ui: &mut Ui,
        rect: Rect,
        index: usize,
        view: &AxisView,
        b: &SceneBox,
        scene: &Scene,
        sweep: Option<&LidarSweep>,
        commands: &mut Vec<Command>,
    ) {
        let response = ui.interact(rect, ui.scope_id().with(("box view", index)), Sense::drag());
        let label = tf!(
            "Box {number} {view}",
            number = b.id.0,
            view = t(view.name).to_lowercase()
        );
        response.widget_info(|| WidgetInfo::labeled(Role::Canvas, true, label.as_str()));
        // While a face is dragged the picture keeps the frame of the box at the start of the drag.
        let frame = self.held.filter(|h| h.start.id == b.id).map_or(*b, |h| h.start);
        let size = |axis: usize| frame.size_m[axis] + 2.0 * MARGIN_M;
        let scale = (f64::from(rect.width()) / size(view.right.0))
            .min(f64::from(rect.height() - 18.0) / size(view.up.0))
            .max(1.0);
        let middle = rect.center() + vec2(0.0, 7.0);
        let to_screen = |local: DVec3| {
            let x = local[view.right.0] * view.right.1 * scale;
            let y = local[view.up.0] * view.up.1 * scale;
            middle + vec2(x as f32, -y as f32)
        };
        let painter = ui.painter_at(rect);
        let reach = frame.size_m / 2.0 + DVec3::splat(MARGIN_M);
        // Far voxels first: painter's algorithm.
        let depth_axis = 3 - view.right.0 - view.up.0;
        let toward = if depth_axis == 2 { 1.0 } else { -1.0 };
        let mut seen: Vec<(f64, Pos2, Color32)> = voxels(scene, &frame, reach)
            .map(|(local, class)| {
                let below = !class.is_ground() && local.z < -frame.center_m.z;
                let color = theme::class_color(class).gamma_multiply(if below { 0.3 } else { 1.0 });
                (local[depth_axis] * toward, to_screen(local), color)
            })
            .collect();
        seen.sort_by(|a, b| a.0.total_cmp(&b.0));
        let extent = scene.frame().extent();
        let lift_m = -extent.lattice().ground_top_m();
        let side = (extent.voxel_m() * scale) as f32;
        for (_, at, color) in seen {
            let square = Rect::from_center_size(at, vec2(side, side));
            painter.rect_filled(square, 0.0, color.gamma_multiply(0.55));
            painter.rect_stroke(
                square,
                0.0,
                Stroke::new(0.5, Color32::from_black_alpha(70)),
                StrokeKind::Inside,
            );
        }
        let physical = sweep.is_some_and(|s| s.physical);
        for point in sweep.map_or(&[][..], |s| &s.points) {
            // The exact sweep meets the ground at the height of the labels; the learned one uses the physical ground.
            let lifted = !physical && point.class.is_ground();
            let lift = DVec3::Z * if lifted { lift_m } else { 0.0 };
            let local = frame.to_local(DVec3::from_array(point.position_in_ego.map(f64::from)) + lift);
            if local.abs().cmple(reach).all() {
                painter.circle_filled(to_screen(local), 2.0, Color32::from_black_alpha(150));
                painter.circle_filled(to_screen(local), 1.3, Color32::WHITE);
            }
        }
        if view.up.0 == 2 {
            // The physical ground.
            let y = to_screen(DVec3::Z * -frame.center_m.z).y;
            painter.hline(
                rect.x_range(),
                y,
                Stroke::new(1.0, theme::text_weak().gamma_multiply(0.6)),
            );
        }
        let (center, half) = (frame.to_local(b.center_m), b.size_m / 2.0);
        let outline = Rect::from_two_pos(to_screen(center - half), to_screen(center + half));
        painter.rect_stroke(
            outline,
            1.0,
            Stroke::new(1.6, theme::accent()),
            StrokeKind::Middle,
        );
        if depth_axis == 2 || view.right.0 == 0 {
            let nose = to_screen(center + DVec3::X * half.x);
            painter.line_segment([to_screen(center), nose], Stroke::new(1.2, theme::accent()));
        }
        let font = egui::TextStyle::Small.resolve(ui.style());
        let meters = format!(
            "{}   {:.2} x {:.2} m",
            t(view.name),
            b.size_m[view.right.0],
            b.size_m[view.up.0]
        );
        painter.text(
            rect.left_top() + vec2(8.0, 3.0),
            egui::Align2::LEFT_TOP,
            meters,
            font,
            theme::text_weak(),
        );
        self.drag(ui, &response, index, view, b, outline, scale, commands);
    }

    #[expect(
        clippy::too_many_arguments,
        reason = "one drag of one face: all of it is needed, once"
    )]
    fn drag(
        &mut self,
        ui: &Ui,
        response: &egui::Response,
        index: usize,
        view: &AxisView,
        b: &SceneBox,
        outline: Rect,
        scale: f64,
        commands: &mut Vec<Command>,
    ) {
        let face = response.hover_pos().and_then(|p| face_at(outline, p, view));
        if let Some((axis, _)) = face {
            let across = axis == view.right.0;
            ui.set_cursor_icon(if across {
                CursorIcon::ResizeHorizontal
            } else {
                CursorIcon::ResizeVertical
            });
        }
        if response.drag_started()
            && let Some(from) = ui.input(|i| i.pointer.press_origin())
            && let Some((axis, sign)) = face_at(outline, from, view)
        {
            self.held = Some(FaceDrag {
                view: index,
                axis,
                sign,
                start: *b,
                from,
                scale,
            });
        }
        let Some(held) = self.held.filter(|h| h.view == index) else {
            return;
        };
        if response.drag_stopped() {
            self.held = None;
            commands.push(Command::Commit("Resize box"));
        } else if let Some(p) = response.interact_pointer_pos() {
            commands.push(Command::Preview(vec![held.edit(view, p)]));
        }
    }
}

impl FaceDrag {
    /// The box with the dragged face at the pointer; the opposite face stays.
    fn edit(&self, view: &AxisView, p: Pos2) -> Edit {
        let travel = p - self.from;
        let moved_m = if self.axis == view.right.0 {
            f64::from(travel.x) * view.right.1
        } else {
            -f64::from(travel.y) * view.up.1
        } / self.scale;
        resized(&self.start, self.axis, self.sign, moved_m)
    }
}

/// A box with one face moved along its own axis, m; its opposite face stays.
fn resized(b: &SceneBox, axis: usize, sign: f64, moved_m: f64) -> Edit {
    let mut size_m = b.size_m;
    size_m[axis] = (size_m[axis] + sign * moved_m).max(MIN_SIZE_M);
    let mut shift = DVec3::ZERO;
    shift[axis] = sign * (size_m[axis] - b.size_m[axis]) / 2.0;
    Edit::MoveBox {
        id: b.id,
        center_m: Some(b.to_ego(shift)),
        yaw_deg: None,
        size_m: Some(size_m),
    }
}

/// The face whose edge is under the pointer: axis of the box and sign.
fn face_at(outline: Rect, p: Pos2, view: &AxisView) -> Option<(usize, f64)> {
    let inside = outline.expand(REACH).contains(p);
    let near = |a: f32, b: f32| inside && (a - b).abs() <= REACH;
    if near(p.x, outline.right()) {
        Some((view.right.0, view.right.1))
    } else if near(p.x, outline.left()) {
        Some((view.right.0, -view.right.1))
    } else if near(p.y, outline.top()) {
        Some((view.up.0, view.up.1))
    } else if near(p.y, outline.bottom()) {
        Some((view.up.0, -view.up.1))
    } else {
        None
    }
}

/// Occupied voxels around a box: centre in box coordinates, class. The ground of the labels lies below the physical one, on
/// which boxes stand, and is lifted to it. Objects reach down to the lower ground, but their tops are at the true height; the
/// part of an object below the physical ground is drawn faintly.
fn voxels<'a>(
    scene: &'a Scene,
    b: &SceneBox,
    reach: DVec3,
) -> impl Iterator<Item = (DVec3, Class)> + use<'a> {
    let (b, frame) = (*b, scene.frame());
    let far = reach.length();
    let extent = frame.extent();
    let (min_m, lift_m) = (extent.min_m(), -extent.lattice().ground_top_m());
    let cells = |center: f64, axis: usize, count: usize| {
        let at = |v: f64| (v - min_m[axis]) / extent.voxel_m();
        let low = at(center - far).floor().clamp(0.0, count as f64) as usize;
        let high = at(center + far).ceil().clamp(0.0, count as f64) as usize;
        low..high
    };
    let (xs, ys) = (
        cells(b.center_m.x, 0, extent.nx()),
        cells(b.center_m.y, 1, extent.ny()),
    );
    xs.flat_map(move |x| ys.clone().map(move |y| (x, y)))
        .flat_map(move |(x, y)| (0..extent.nz()).map(move |z| (x, y, z)))
        .filter_map(move |(x, y, z)| {
            let class = Class::from_id(frame.occupancy.get(x, y, z)).filter(|c| *c != Class::Free)?;
            let center = |i: usize, axis: usize| min_m[axis] + (i as f64 + 0.5) * extent.voxel_m();
            let lift = if class.is_ground() { lift_m } else { 0.0 };
            let local = b.to_local(DVec3::new(center(x, 0), center(y, 1), center(z, 2) + lift));
            local.abs().cmple(reach).all().then_some((local, class))
        })
}

fn hint(ui: &Ui, rect: Rect, text: &str) {
    let font = egui::TextStyle::Body.resolve(ui.style());
    ui.painter().text(
        rect.center(),
        egui::Align2::CENTER_CENTER,
        text,
        font,
        theme::text_weak(),
    );
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::BoxId;

    /// The voxels of a car end at its roof, and the ground around it at the height on which it stands.
    #[test]
    fn voxels_lie_in_their_box() {
        use scene::draft::draft;
        use scene::{BevLayout, Frame};
        let b = SceneBox {
            id: BoxId(1),
            class: Class::Car,
            center_m: DVec3::new(5.0, 2.0, 0.85),
            size_m: DVec3::new(4.6, 2.0, 1.7),
            yaw_rad: 0.3,
            velocity_mps: glam::DVec2::ZERO,
            label: Default::default(),
        };
        let layout = BevLayout::default();
        let occupancy = draft(&layout, [b].iter());
        let frame = Frame::new(layout, [(b.id, b)].into(), occupancy);
        let scene = Scene::single("test", frame, std::sync::Arc::default(), 0);
        let top = |wanted: fn(Class) -> bool| {
            let heights = voxels(&scene, &b, b.size_m).filter(|(_, class)| wanted(*class));
            heights.map(|(local, _)| local.z).fold(f64::MIN, f64::max) + scene::Window::VOXEL_M / 2.0
        };
        let roof = top(|class| class == Class::Car);
        assert!((roof - 0.85).abs() <= scene::Window::VOXEL_M, "{roof}");
        let ground = top(Class::is_ground);
        assert!((ground + 0.85).abs() < 1e-9, "{ground}");
    }

    #[test]
    fn a_face_moves_and_the_opposite_one_stays() {
        let b = SceneBox {
            id: BoxId(1),
            class: Class::Car,
            center_m: DVec3::new(5.0, 2.0, 0.8),
            size_m: DVec3::new(4.0, 2.0, 1.6),
            yaw_rad: 0.7,
            velocity_mps: glam::DVec2::ZERO,
            label: Default::default(),
        };
        for (axis, sign) in [(0, 1.0), (0, -1.0), (1, 1.0), (2, -1.0)] {
            // The face moves by half a metre along the axis; with sign -1 the box becomes smaller.
            let Edit::MoveBox {
                center_m: Some(center_m),
                size_m: Some(size_m),
                ..
            } = resized(&b, axis, sign, 0.5)
            else {
                panic!("a move");
            };
            let new = SceneBox {
                center_m,
                size_m,
                ..b
            };
            assert!((size_m[axis] - b.size_m[axis] - sign * 0.5).abs() < 1e-12);
            let mut face = DVec3::ZERO;
            face[axis] = -sign * b.size_m[axis] / 2.0;
            let mut same = DVec3::ZERO;
            same[axis] = -sign * size_m[axis] / 2.0;
            assert!(b.to_ego(face).distance(new.to_ego(same)) < 1e-9);
        }
        let Edit::MoveBox { size_m, .. } = resized(&b, 0, 1.0, -100.0) else {
            panic!("a move");
        };
        assert_eq!(size_m.map(|s| s.x), Some(MIN_SIZE_M));
    }
}
