//! The gizmo of the chosen boxes: arrows, a ring or knobs, on either view; finds its part under the pointer.

use glam::{DVec2, DVec3};

use crate::arrange::{boxes_of, middle_m};
use crate::transform::{Axis, Orientation, Transform, TransformKind};
use scene::Scene;

use super::ID;
use super::boxes::transform;
use crate::tools::{At, Hand, Role, ScreenProjection, ToolMark, ViewKind};

/// Length of an arrow, radius of the ring, points.
const LENGTH: f64 = 62.0;
/// Distance from the middle at which an arrow begins, points: nearer to the middle the box itself is dragged.
const HOLLOW: f64 = 26.0;
/// How near the pointer has to be, points.
const REACH: f64 = 7.0;
const RING_STEPS: usize = 48;

/// A part of the gizmo.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GizmoPart {
    /// An arrow, or the knob of a size.
    Axis(Axis),
    /// The ring.
    Ring,
}

/// The gizmo of the chosen boxes on a view.
pub struct Gizmo<'a> {
    transform: Transform,
    middle_m: DVec3,
    length_m: f64,
    view: &'a dyn ScreenProjection,
}

impl<'a> Gizmo<'a> {
    /// `None` if no box is chosen that may be changed, the middle is not in view, or the knob of the box turns it there.
    pub fn new(scene: &Scene, hand: &Hand, view: &'a dyn ScreenProjection) -> Option<Self> {
        let from_above = view.kind() == ViewKind::Bev;
        if hand.tool != ID || from_above && hand.gizmo == TransformKind::Turn {
            return None;
        }
        let (frame, mut chosen) = (scene.frame(), hand.chosen());
        chosen.retain(|id| !scene.arranged.locked.boxes.contains(id));
        let middle_m = middle_m(&boxes_of(frame, &chosen))?;
        let beside = view.project(middle_m + view.right() * 0.5)?;
        let per_m = view.project(middle_m)?.distance(beside) * 2.0;
        (per_m.is_finite() && per_m > 1e-3).then(|| Self {
            transform: transform(frame, hand, &chosen, hand.gizmo),
            middle_m,
            length_m: LENGTH / per_m,
            view,
        })
    }

    /// The axes that the view can show.
    fn axes(&self) -> &'static [Axis] {
        match self.view.kind() {
            ViewKind::Bev => &[Axis::X, Axis::Y],
            ViewKind::Space => &Axis::ALL,
        }
    }

    /// Begin and tip of the arrow of an axis, on the screen. Sizes are of the box's own axes.
    fn arrow(&self, axis: Axis) -> Option<[DVec2; 2]> {
        let mut turned = self.transform.clone();
        if turned.kind == TransformKind::Scale {
            turned.orientation = Orientation::Local;
        }
        let along = turned.axis_in_ego(axis) * self.length_m;
        let from = self.view.project(self.middle_m + along * (HOLLOW / LENGTH))?;
        let to = self.view.project(self.middle_m + along)?;
        // Seen from its end an arrow is no handle.
        (from.distance(to) > 6.0).then_some([from, to])
    }

    fn ring(&self) -> Vec<DVec2> {
        let point = |i: usize| {
            let angle = i as f64 / RING_STEPS as f64 * std::f64::consts::TAU;
            self.view
                .project(self.middle_m + (DVec2::from_angle(angle) * self.length_m).extend(0.0))
        };
        (0..=RING_STEPS).filter_map(point).collect()
    }

    /// The part under the pointer.
    pub fn at(&self, pointer: DVec2) -> Option<GizmoPart> {
        if self.transform.kind == TransformKind::Turn {
            let near = self
                .ring()
                .windows(2)
                .any(|p| distance(pointer, p[0], p[1]) < REACH);
            return near.then_some(GizmoPart::Ring);
        }
        let near = |axis: &&Axis| {
            self.arrow(**axis)
                .is_some_and(|[a, b]| distance(pointer, a, b) < REACH)
        };
        self.axes().iter().find(near).map(|a| GizmoPart::Axis(*a))
    }

    /// The marks of the gizmo; `hot` is under the pointer or held.
    pub fn marks(&self, hot: Option<GizmoPart>) -> Vec<ToolMark> {
        let screen = |p: DVec2| At::Screen(p);
        if self.transform.kind == TransformKind::Turn {
            let ring = self.ring().into_iter().map(screen).collect();
            return vec![ToolMark::Ring(ring, hot == Some(GizmoPart::Ring))];
        }
        let arrow = |axis: &Axis| {
            Some(ToolMark::Arrow {
                ends: self.arrow(*axis)?.map(screen),
                role: Role::Axis(*axis as usize),
                hot: hot == Some(GizmoPart::Axis(*axis)),
                square: self.transform.kind == TransformKind::Scale,
            })
        };
        self.axes().iter().filter_map(arrow).collect()
    }
}

/// Distance of a point from a segment.
fn distance(p: DVec2, a: DVec2, b: DVec2) -> f64 {
    let d = b - a;
    let t = ((p - a).dot(d) / d.length_squared().max(1e-6)).clamp(0.0, 1.0);
    p.distance(a + d * t)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn segments_are_near_where_they_run() {
        let [a, b] = [DVec2::ZERO, DVec2::new(10.0, 0.0)];
        assert_eq!(distance(DVec2::new(4.0, 3.0), a, b), 3.0);
        assert_eq!(distance(DVec2::new(13.0, 4.0), a, b), 5.0);
        assert_eq!(distance(DVec2::new(3.0, 4.0), a, a), 5.0);
    }
}
