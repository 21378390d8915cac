//! The gizmo of the chosen boxes: arrows, a ring or knobs, on either view; what of it lies under the pointer.

use egui::{Color32, Painter, Pos2, Stroke, vec2};
use glam::{DVec2, DVec3};

use crate::canvas::ScreenMap;
use crate::state::{Tool, UiState};
use crate::theme;
use editor::arrange::{boxes_of, middle_m};
use editor::transform::{Axis, Kind, Transform};
use scene::Frame;

use super::bev::transform;

/// Length of an arrow, radius of the ring, points.
const LENGTH: f64 = 62.0;
/// Where an arrow begins to be one, points: nearer to the middle the box itself is taken hold of.
const HOLLOW: f64 = 26.0;
/// How near the pointer has to be, points.
const REACH: f32 = 7.0;
const RING_STEPS: usize = 48;

/// Colours of x, y and z, as everywhere in the field.
pub(crate) const COLORS: [Color32; 3] = [
    Color32::from_rgb(235, 92, 92),
    Color32::from_rgb(120, 200, 90),
    Color32::from_rgb(96, 150, 245),
];

/// A part of the gizmo.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Part {
    /// An arrow, or the knob of a size.
    Axis(Axis),
    /// The ring.
    Ring,
}

/// The gizmo of the chosen boxes on a view that `project` describes.
pub(crate) struct Gizmo<'a> {
    transform: Transform,
    middle_m: DVec3,
    length_m: f64,
    project: &'a dyn Fn(DVec3) -> Option<Pos2>,
    axes: &'static [Axis],
}

impl<'a> Gizmo<'a> {
    /// `None` if no box is chosen or the middle is not in view; `axes` are those that the view can show.
    pub fn new(
        frame: &Frame,
        state: &UiState,
        axes: &'static [Axis],
        right: DVec3,
        project: &'a dyn Fn(DVec3) -> Option<Pos2>,
    ) -> Option<Self> {
        if state.tool != Tool::Select {
            return None;
        }
        let chosen = state.chosen();
        let middle_m = middle_m(&boxes_of(frame, &chosen))?;
        let per_m = f64::from(project(middle_m)?.distance(project(middle_m + right * 0.5)?)) * 2.0;
        (per_m.is_finite() && per_m > 1e-3).then(|| Self {
            transform: transform(frame, state, &chosen, state.tools.gizmo),
            middle_m,
            length_m: LENGTH / per_m,
            project,
            axes,
        })
    }

    /// Begin and tip of the arrow of an axis, on the screen. Sizes are of the box's own axes.
    fn arrow(&self, axis: Axis) -> Option<[Pos2; 2]> {
        let mut turned = self.transform.clone();
        if turned.kind == Kind::Scale {
            turned.orientation = editor::transform::Orientation::Local;
        }
        let along = turned.axis_in_ego(axis) * self.length_m;
        let from = (self.project)(self.middle_m + along * (HOLLOW / LENGTH))?;
        let to = (self.project)(self.middle_m + along)?;
        // Seen from its end an arrow is no handle.
        (from.distance(to) > 6.0).then_some([from, to])
    }

    fn ring(&self) -> Vec<Pos2> {
        let point = |i: usize| {
            let angle = i as f64 / RING_STEPS as f64 * std::f64::consts::TAU;
            (self.project)(self.middle_m + (DVec2::from_angle(angle) * self.length_m).extend(0.0))
        };
        (0..=RING_STEPS).filter_map(point).collect()
    }

    /// The part under the pointer.
    pub fn at(&self, pointer: Pos2) -> Option<Part> {
        if self.transform.kind == Kind::Turn {
            let near = self
                .ring()
                .windows(2)
                .any(|p| distance(pointer, p[0], p[1]) < REACH);
            return near.then_some(Part::Ring);
        }
        let near = |axis: &&Axis| {
            self.arrow(**axis)
                .is_some_and(|[a, b]| distance(pointer, a, b) < REACH)
        };
        self.axes.iter().find(near).map(|a| Part::Axis(*a))
    }

    /// Draws it; `hot` is under the pointer or held.
    pub fn draw(&self, painter: &Painter, hot: Option<Part>) {
        if self.transform.kind == Kind::Turn {
            let width = if hot == Some(Part::Ring) { 3.5 } else { 2.0 };
            painter.line(self.ring(), Stroke::new(width, COLORS[2]));
            return;
        }
        for &axis in self.axes {
            let Some([from, to]) = self.arrow(axis) else {
                continue;
            };
            let is_hot = hot == Some(Part::Axis(axis));
            let color = match is_hot {
                true => theme::ON_CANVAS,
                false => COLORS[axis as usize],
            };
            painter.line_segment([from, to], Stroke::new(if is_hot { 3.5 } else { 2.2 }, color));
            let along = (to - from).normalized();
            if self.transform.kind == Kind::Scale {
                let square = egui::Rect::from_center_size(to, vec2(8.0, 8.0));
                painter.rect_filled(square, 1.0, color);
            } else {
                let side = along.rot90() * 4.5;
                let head = vec![to + along * 9.0, to + side, to - side];
                painter.add(egui::Shape::convex_polygon(head, color, Stroke::NONE));
            }
        }
    }
}

/// Distance of a point from a segment.
fn distance(p: Pos2, a: Pos2, b: Pos2) -> f32 {
    let d = b - a;
    let t = ((p - a).dot(d) / d.length_sq().max(1e-6)).clamp(0.0, 1.0);
    p.distance(a + d * t)
}

/// The arrow of the bird's-eye view under a point of the ground.
pub(crate) fn bev_axis_at(map: &ScreenMap, frame: &Frame, state: &UiState, at_m: DVec2) -> Option<Axis> {
    let project = |p: DVec3| Some(map.to_screen(p.truncate()));
    let gizmo = Gizmo::new(frame, state, &[Axis::X, Axis::Y], DVec3::X, &project)?;
    if state.tools.gizmo == Kind::Turn {
        return None; // the knob turns there
    }
    match gizmo.at(map.to_screen(at_m))? {
        Part::Axis(axis) => Some(axis),
        Part::Ring => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn segments_are_near_where_they_run() {
        let [a, b] = [egui::pos2(0.0, 0.0), egui::pos2(10.0, 0.0)];
        assert_eq!(distance(egui::pos2(4.0, 3.0), a, b), 3.0);
        assert_eq!(distance(egui::pos2(13.0, 4.0), a, b), 5.0);
        assert_eq!(distance(egui::pos2(3.0, 4.0), a, a), 5.0);
    }
}
