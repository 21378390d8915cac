//! The circle brush: press at the middle, drag the radius, release. It paints a disc of the layer in hand.

use glam::DVec2;

use crate::Shape;
use language::{filled, t};
use scene::{BevLayer, Frame};

use super::setting::{self, ToolOption, Value};
use super::{
    Act, Context, Cursor, Event, Hand, Hint, Pointer, ReadonlyContext, Response, Role, Shortcut, Tool,
    ToolDef, ToolGroup, ToolId, ToolMark, ViewKind, When, brush, hint_of,
};

/// Its name.
pub const ID: ToolId = ToolId("circle_tool");

/// Its row of the table.
pub static DEF: ToolDef = ToolDef {
    id: ID,
    title: "Circle brush",
    key: "Shift+U: press at the middle, drag the radius",
    icon: "circle",
    group: ToolGroup::Scene,
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
    /// True if it is large enough, and some of it lies on the map.
    shown: bool,
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
            shown: false,
        });
        Response::hold()
    }

    fn drag(&mut self, cx: &Context<'_>, pointer: &Pointer) -> Response {
        let (Some(disc), Some(at_m)) = (&mut self.disc, cx.ground_m(pointer.at)) else {
            return Response::none();
        };
        disc.radius_m = disc.middle_m.distance(at_m);
        let extent = cx.frame().extent();
        disc.shown = disc.radius_m >= LEAST_M && disc.shape().cells(extent).is_ok();
        match disc.shown {
            true => brush::show(cx, disc.layer, disc.shape(), !disc.erase),
            false => Response::act(Act::Cancel),
        }
    }

    fn release(&mut self) -> Response {
        match self.disc.take() {
            Some(disc) if disc.shown => {
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
        let what = match disc.erase {
            true => "Erases a disc of {radius} m radius",
            false => "Paints a disc of {radius} m radius",
        };
        let radius = filled(t(what), &[("radius", &format!("{:.1}", disc.radius_m))]);
        vec![radius.into(), "Release: done".into(), "Esc cancels".into()]
    }

    fn cursor(&self, sight: &ReadonlyContext<'_>) -> Cursor {
        match sight.hand.is_locked(sight.hand.layer) {
            true => Cursor::Forbidden,
            false => Cursor::Crosshair,
        }
    }

    fn overlay(&self, sight: &ReadonlyContext<'_>) -> Vec<ToolMark> {
        let Some(disc) = self.disc else {
            return Vec::new();
        };
        let mut out = vec![ToolMark::Disc(disc.middle_m, disc.radius_m, disc.role())];
        if let Some(at_m) = sight.ground_m() {
            out.push(ToolMark::Tag(at_m.into(), format!("{:.1} m", disc.radius_m)));
        }
        out
    }

    fn options(&self, hand: &Hand) -> Vec<ToolOption> {
        vec![
            ToolOption::title("Circle brush"),
            ToolOption::text("Press at the middle, drag the radius: a disc of the layer in hand."),
            ToolOption::segments("erase", hand.erase, &brush::ERASE, 2),
        ]
    }

    fn set(&mut self, hand: &mut Hand, _: &Frame, id: &str, value: Value) -> Vec<Act> {
        if id == "erase" {
            setting::take(&mut hand.erase, value, &brush::ERASE);
        }
        Vec::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Edit;
    use crate::tools::Wants;
    use crate::tools::testing::{NONE, SHIFT, Table};

    fn previewed(response: &Response) -> (DVec2, f64, bool) {
        match &response.acts[..] {
            [Act::Preview(edits)] => match &edits[..] {
                [
                    Edit::PaintBev {
                        layer: BevLayer::Walkway,
                        shape: Shape::Disc { center_m, radius_m },
                        value,
                    },
                ] => (*center_m, *radius_m, *value),
                other => panic!("{other:?}"),
            },
            other => panic!("{other:?}"),
        }
    }

    fn table() -> Table {
        let mut table = Table::new();
        table.hand.layer = BevLayer::Walkway;
        table
    }

    #[test]
    fn a_drag_from_the_middle_paints_a_disc() {
        let (mut table, mut tool) = (table(), Circle::default());
        let pressed = table.press(&mut tool, 4.0, -2.0, NONE);
        assert!(pressed.holds && pressed.acts.is_empty());
        let shown = previewed(&table.drag(&mut tool, 7.0, 2.0));
        assert_eq!(shown, (DVec2::new(4.0, -2.0), 5.0, true));
        let hint = tool.hint(&table.hand, Some(ViewKind::Bev));
        assert_eq!(hint[0], "Paints a disc of 5.0 m radius");
        let marks = tool.overlay(&table.sight(7.0, 2.0));
        let role = Role::Paint(BevLayer::Walkway);
        assert_eq!(marks[0], ToolMark::Disc(DVec2::new(4.0, -2.0), 5.0, role));
        assert!(matches!(&marks[1], ToolMark::Tag(_, text) if text == "5.0 m"));
        let released = table.release(&mut tool, 7.0, 2.0);
        assert_eq!(released, Response::act(Act::Commit("Paint circle".into())));
        // It is over: moving on changes nothing.
        assert_eq!(table.drag(&mut tool, 9.0, 9.0), Response::none());
        assert_eq!(table.release(&mut tool, 9.0, 9.0), Response::none());
        assert!(tool.overlay(&table.sight(9.0, 9.0)).is_empty());
        assert_eq!(tool.wants(), Wants::Nothing);
    }

    #[test]
    fn shift_or_the_eraser_erases() {
        let (mut table, mut tool) = (table(), Circle::default());
        table.press(&mut tool, 0.0, 0.0, SHIFT);
        // Shift counts when the button goes down.
        assert_eq!(
            previewed(&table.drag(&mut tool, 2.0, 0.0)),
            (DVec2::ZERO, 2.0, false)
        );
        let released = table.release(&mut tool, 2.0, 0.0);
        assert_eq!(released.acts, [Act::Commit("Erase circle".into())]);
        tool.set(&mut table.hand, table.scene.frame(), "erase", Value::Index(1));
        assert!(table.hand.erase);
        table.press(&mut tool, 0.0, 0.0, NONE);
        assert!(!previewed(&table.drag(&mut tool, 2.0, 0.0)).2);
    }

    #[test]
    fn what_is_cancelled_too_small_outside_or_locked_paints_nothing() {
        let (mut table, mut tool) = (table(), Circle::default());
        table.press(&mut tool, 0.0, 0.0, NONE);
        table.drag(&mut tool, 3.0, 0.0);
        assert_eq!(table.tell(&mut tool, Event::Cancel), Response::none());
        assert_eq!(table.release(&mut tool, 3.0, 0.0), Response::none());
        // A click, or a drag back to where it began.
        assert_eq!(table.click(&mut tool, 5.0, 5.0, NONE).acts, []);
        table.press(&mut tool, 0.0, 0.0, NONE);
        table.drag(&mut tool, 3.0, 0.0);
        assert_eq!(table.drag(&mut tool, 0.1, 0.0).acts, [Act::Cancel]);
        assert_eq!(table.release(&mut tool, 0.1, 0.0).acts, []);
        // Beside the map there is nothing to show, and what was shown before goes.
        table.press(&mut tool, 300.0, 0.0, NONE);
        assert_eq!(table.drag(&mut tool, 302.0, 0.0).acts, [Act::Cancel]);
        assert_eq!(table.release(&mut tool, 302.0, 0.0).acts, []);
        table.hand.layers_locked = BevLayer::Walkway.bit();
        let pressed = table.press(&mut tool, 0.0, 0.0, NONE);
        assert!(!pressed.holds && matches!(&pressed.acts[..], [Act::Note(text)] if text.contains("locked")));
        assert_eq!(tool.cursor(&table.sight(0.0, 0.0)), Cursor::Forbidden);
    }
}
