//! Hands for the tests of the tools: a view from above of 10 points a metre, and a pointer that moves over it.

use glam::{DVec2, DVec3};

use crate::pick::PickRay;
use scene::{BevLayout, Extent, Frame, Scene, VoxelGrid};

use super::{
    Context, Event, Hand, Key, Modifiers, Pointer, ReadonlyContext, Response, ScreenProjection, Tool,
    ViewKind,
};

const SCALE: f64 = 10.0;

/// The ground from above, x to the right.
struct Above;

impl ScreenProjection for Above {
    fn kind(&self) -> ViewKind {
        ViewKind::Bev
    }

    fn project(&self, p_m: DVec3) -> Option<DVec2> {
        Some(p_m.truncate() * SCALE)
    }

    fn ray(&self, at: DVec2) -> Option<PickRay> {
        PickRay::new((at / SCALE).extend(100.0), -DVec3::Z)
    }

    fn right(&self) -> DVec3 {
        DVec3::X
    }

    fn scale(&self) -> f64 {
        SCALE
    }
}

pub const NONE: Modifiers = Modifiers {
    shift: false,
    ctrl: false,
    alt: false,
};
pub const SHIFT: Modifiers = Modifiers { shift: true, ..NONE };

/// A scene and what the user holds over it.
pub struct Table {
    pub scene: Scene,
    pub hand: Hand,
}

impl Table {
    pub fn new() -> Self {
        Self::over(Extent::WINDOW)
    }

    /// The same on a map.
    pub fn over(extent: Extent) -> Self {
        let layout = BevLayout::over(extent);
        let frame = Frame::new(layout, Default::default(), VoxelGrid::over(extent));
        Self {
            scene: Scene::single("test", frame, Default::default(), 0),
            hand: Hand::default(),
        }
    }

    pub fn tell(&mut self, tool: &mut dyn Tool, event: Event) -> Response {
        let mut cx = Context {
            scene: &self.scene,
            settled: &self.scene,
            view: &Above,
            hand: &mut self.hand,
        };
        tool.event(&mut cx, &event)
    }

    pub fn press(&mut self, tool: &mut dyn Tool, x_m: f64, y_m: f64, held: Modifiers) -> Response {
        self.tell(tool, Event::Press(at(x_m, y_m, held)))
    }

    pub fn drag(&mut self, tool: &mut dyn Tool, x_m: f64, y_m: f64) -> Response {
        self.tell(tool, Event::Drag(at(x_m, y_m, NONE)))
    }

    pub fn release(&mut self, tool: &mut dyn Tool, x_m: f64, y_m: f64) -> Response {
        self.tell(tool, Event::Release(at(x_m, y_m, NONE)))
    }

    /// A press and a release; what both answered.
    pub fn click(&mut self, tool: &mut dyn Tool, x_m: f64, y_m: f64, held: Modifiers) -> Response {
        let pressed = self.press(tool, x_m, y_m, held);
        let released = self.release(tool, x_m, y_m);
        pressed.with(released.acts)
    }

    pub fn key(&mut self, tool: &mut dyn Tool, key: Key) -> Response {
        self.tell(tool, Event::Key(key, false, NONE))
    }

    /// What the tool sees with the pointer at a place.
    pub fn sight(&self, x_m: f64, y_m: f64) -> ReadonlyContext<'_> {
        ReadonlyContext {
            scene: &self.scene,
            settled: &self.scene,
            view: &Above,
            hand: &self.hand,
            pointer: Some(at(x_m, y_m, NONE)),
        }
    }
}

fn at(x_m: f64, y_m: f64, held: Modifiers) -> Pointer {
    Pointer {
        at: DVec2::new(x_m, y_m) * SCALE,
        held,
    }
}
