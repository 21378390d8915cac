//! The circle brush: press at the middle, drag the radius, release. It paints a disc of the layer in hand.

use glam::DVec2;

use crate::Shape;
use scene::{BevLayer, Frame};

use super::setting::{self, Setting, Value};
use super::{
    Act, Context, Cursor, Event, Group, Hand, Hint, Mark, Pointer, Response, Role, Shortcut, Sight, Tool,
    ToolDef, ToolId, ViewKind, When, brush, hint_of,
};

/// Its name.
pub const ID: ToolId = ToolId("circle_tool");

/// Its row of the table.
pub static DEF: ToolDef = ToolDef {
    id: ID,
    title: "Circle brush",
    key: "Shift+U: press at the middle, drag the radius",
    icon: "circle",
    group: Group::Scene,
    is_brush: true,
    paints: true,
    shortcuts: &[Shortcut {
        id: ID.0,
        title: "Circle brush",
        keys: "Shift+U",
        when: When::Always,
        set: |hand| hand.tool = ID,
    }],
    make: || Box::new(Circle::default()),
};

/// Smaller discs than this are a slip of the hand, m.
const LEAST_M: f64 = 0.2;

/// A disc that is being drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Disc {
    middle_m: DVec2,
    radius_m: f64,
    layer: BevLayer,
    erase: bool,
}

impl Disc {
    fn shape(&self) -> Shape {
        Shape::Disc {
            center_m: self.middle_m,
            radius_m: self.radius_m,
        }
    }

    fn role(&self) -> Role {
        match self.erase {
            true => Role::Erase,
            false => Role::Paint(self.layer),
        }
    }
}

/// The circle brush.
#[derive(Clone, Debug, Default)]
pub struct Circle {
    disc: Option<Disc>,
}

impl Circle {
    fn press(&mut self, cx: &Context<'_>, pointer: &Pointer) -> Response {
        let layer = cx.hand.layer;
        if cx.hand.is_locked(layer) {
            return brush::locked(layer);
        }
        let Some(middle_m) = cx.ground_m(pointer.at) else {
            return Response::none();
        };
        self.disc = Some(Disc {
            middle_m,
            radius_m: 0.0,
            layer,
            erase: cx.hand.erase || pointer.held.shift,
        });
        Response::hold()
    }

    fn drag(&mut self, cx: &Context<'_>, pointer: &Pointer) -> Response {
        let (Some(disc), Some(at_m)) = (&mut self.disc, cx.ground_m(pointer.at)) else {
            return Response::none();
        };
        disc.radius_m = disc.middle_m.distance(at_m);
        if disc.radius_m < LEAST_M {
            return Response::act(Act::Cancel);
        }
        brush::show(disc.layer, disc.shape(), !disc.erase)
    }

    fn release(&mut self) -> Response {
        match self.disc.take() {
            Some(disc) if disc.radius_m >= LEAST_M => {
                let label = if disc.erase {
                    "Erase circle"
                } else {
                    "Paint circle"
                };
                Response::act(Act::Commit(label.into()))
            }
            _ => Response::none(),
        }
    }
}

impl Tool for Circle {
    fn event(&mut self, cx: &mut Context<'_>, event: &Event) -> Response {
        match event {
            Event::Press(pointer) => self.press(cx, pointer),
            Event::Drag(pointer) => self.drag(cx, pointer),
            Event::Release(_) => self.release(),
            Event::Cancel => {
                self.disc = None;
                Response::none()
            }
            Event::Pick(_) | Event::Key(..) | Event::Scroll(_) | Event::DoubleClick => Response::none(),
        }
    }

    fn hint(&self, hand: &Hand, _: Option<ViewKind>) -> Hint {
        let Some(disc) = self.disc else {
            let drag = if hand.erase {
                "Drag erases a disc"
            } else {
                "Drag paints a disc"
            };
            return hint_of(&["Press at the middle", drag, "Shift erases"]);
        };
        let what = if disc.erase { "Erases" } else { "Paints" };
        let radius = format!("{what} a disc of {:.1} m radius", disc.radius_m);
        vec![radius.into(), "Release: done".into(), "Esc cancels".into()]
    }

    fn cursor(&self, sight: &Sight<'_>) -> Cursor {
        match sight.hand.is_locked(sight.hand.layer) {
            true => Cursor::Forbidden,
            false => Cursor::Crosshair,
        }
    }

    fn overlay(&self, sight: &Sight<'_>) -> Vec<Mark> {
        let Some(disc) = self.disc else {
            return Vec::new();
        };
        let mut out = vec![Mark::Disc(disc.middle_m, disc.radius_m, disc.role())];
        if let Some(at_m) = sight.ground_m() {
            out.push(Mark::Tag(at_m.into(), format!("{:.1} m", disc.radius_m)));
        }
        out
    }

    fn options(&self, hand: &Hand) -> Vec<Setting> {
        vec![
            Setting::title("Circle brush"),
            Setting::text("Press at the middle, drag the radius: a disc of the layer in hand."),
            Setting::segments("erase", hand.erase, &brush::ERASE, 2),
        ]
    }

    fn set(&mut self, hand: &mut Hand, _: &Frame, id: &str, value: Value) -> Vec<Act> {
        if id == "erase" {
            setting::take(&mut hand.erase, value, &brush::ERASE);
        }
        Vec::new()
    }
}
