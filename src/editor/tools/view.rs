//! Input of the tools: the view under the pointer, the scene, and plain events of pointer and keys.

use glam::{DVec2, DVec3};

use crate::pick::{self, PickHit, PickRay};
use scene::{Extent, Frame, Scene};

use super::Hand;

/// Points that the pointer may move and still click.
pub const CLICK_SLACK: f64 = 4.0;
/// Size of handles under the pointer, points.
pub const HANDLE_REACH: f64 = 8.0;

/// Kind of a large view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ViewKind {
    /// From above.
    Bev,
    /// In perspective, or any other way.
    Space,
}

/// Projection between ego frame and screen. Points of the screen are in the window's points, y down.
pub trait ScreenProjection {
    /// Kind of the view.
    fn kind(&self) -> ViewKind;
    /// Point of the screen at which a point of the ego frame (m) appears; `None` behind the eye.
    fn project(&self, p_m: DVec3) -> Option<DVec2>;
    /// The ray under a point of the screen; from above it falls straight down.
    fn ray(&self, at: DVec2) -> Option<PickRay>;
    /// The direction to the right on the screen, ego frame.
    fn right(&self) -> DVec3;
    /// Points per metre; only from above it is the same everywhere, elsewhere it is 1.
    fn scale(&self) -> f64;
}

/// Farther points of the ground mean nothing to a tool, m from the ego vehicle: the whole map can be reached.
pub fn farthest_m(extent: Extent) -> f64 {
    const LEAST_M: f64 = 400.0;
    let corner = extent.min_m().abs().max(extent.max_m().abs());
    corner.truncate().length().max(LEAST_M)
}

/// Input of a tool, and the options and selection that it changes.
pub struct Context<'a> {
    /// The scene shown, a drag in progress included.
    pub scene: &'a Scene,
    /// The scene without the drag in progress: strokes pick against it.
    pub settled: &'a Scene,
    /// The view under the pointer.
    pub view: &'a dyn ScreenProjection,
    /// Options and selection of the user.
    pub hand: &'a mut Hand,
}

/// Read-only form of [`Context`], for marks, cursors and hints.
#[derive(Clone, Copy)]
pub struct ReadonlyContext<'a> {
    /// The scene shown, a drag in progress included.
    pub scene: &'a Scene,
    /// The scene without the drag in progress.
    pub settled: &'a Scene,
    /// The view that is drawn.
    pub view: &'a dyn ScreenProjection,
    /// Options and selection of the user.
    pub hand: &'a Hand,
    /// The pointer, if it is over the view.
    pub pointer: Option<Pointer>,
}

impl Context<'_> {
    /// True in the view from above.
    pub fn from_above(&self) -> bool {
        self.view.kind() == ViewKind::Bev
    }

    /// The frame without the drag in progress.
    pub fn frame(&self) -> &Frame {
        self.settled.frame()
    }

    /// The point of the ground under a point of the screen, ego frame, m; in space where the ray meets anything.
    pub fn ground_m(&self, at: DVec2) -> Option<DVec2> {
        ground_m(self.view, self.settled, at)
    }
}

impl ReadonlyContext<'_> {
    /// True in the view from above.
    pub fn from_above(&self) -> bool {
        self.view.kind() == ViewKind::Bev
    }

    /// The point of the ground under the pointer, ego frame, m.
    pub fn ground_m(&self) -> Option<DVec2> {
        ground_m(self.view, self.settled, self.pointer?.at)
    }
}

/// The point where the ray under a point of the screen meets ground, voxels or boxes, ego frame, m.
fn ground_m(view: &dyn ScreenProjection, scene: &Scene, at: DVec2) -> Option<DVec2> {
    let ray = view.ray(at)?;
    if view.kind() == ViewKind::Bev {
        return Some(ray.origin_in_ego.truncate());
    }
    let hit = pick::pick(scene.frame(), &ray)?;
    Some(point_of(&hit, &ray).truncate())
}

/// The point that was hit, ego frame, m.
pub fn point_of(hit: &PickHit, ray: &PickRay) -> DVec3 {
    match hit {
        PickHit::Box { distance_m, .. } => ray.at(*distance_m),
        PickHit::Voxel(v) => ray.at(v.distance_m),
        PickHit::Ground { point_in_ego } => *point_in_ego,
    }
}

/// Keys that are held.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Modifiers {
    /// Shift.
    pub shift: bool,
    /// Ctrl, or the command key of a Mac.
    pub ctrl: bool,
    /// Alt.
    pub alt: bool,
}

/// The pointer over a view.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pointer {
    /// Position, points of the window.
    pub at: DVec2,
    /// Keys that are held.
    pub held: Modifiers,
}

/// Keys that a tool may ask for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Key {
    /// Drops a form that is drawn point by point.
    Escape,
    /// Finishes what is drawn or typed.
    Enter,
    /// Takes the last point or digit back.
    Backspace,
    /// X, Y or Z: an axis, 0 to 2.
    Axis(usize),
    /// A digit, a point or a minus.
    Digit(char),
}

/// Event of pointer, keys or wheel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event {
    /// The primary button went down.
    Press(Pointer),
    /// The primary button went down in the 3D view with Alt held, which turns the camera: options can be picked up from
    /// the object there.
    Pick(Pointer),
    /// The pointer moved with the button down.
    Drag(Pointer),
    /// The button came up.
    Release(Pointer),
    /// The drag is cancelled: the press and its preview are dropped.
    Cancel,
    /// A key went down; true for the repetition of one that is held.
    Key(Key, bool, Modifiers),
    /// The wheel turned by so many steps, up positive.
    Scroll(i32),
    /// The second click of two at one place.
    DoubleClick,
}
