//! The tool that places boxes: the press is the place, from above the drag is the heading.

use glam::DVec2;

use crate::arrange::adding;
use language::t;
use scene::{Class, Frame, variants};

use super::setting::{Control, ToolOption, Value};
use super::{
    Act, CLICK_SLACK, Context, Cursor, Event, Hand, Hint, Pointer, ReadonlyContext, Response, Shortcut, Tool,
    ToolDef, ToolGroup, ToolId, ToolMark, ViewKind, When, hint_of, lane_heading,
};

/// Its name.
pub const ID: ToolId = ToolId("add_box_tool");

/// Its row of the table.
pub static DEF: ToolDef = ToolDef {
    id: ID,
    title: "Add box",
    key: "A",
    icon: "add_box",
    group: ToolGroup::Scene,
    is_brush: false,
    paints: false,
    shortcuts: &[Shortcut {
        id: ID.0,
        title: "Add box",
        keys: "A",
        when: When::Always,
        set: |hand| hand.tool = ID,
    }],
    make: || Box::new(AddBox::default()),
};

/// The tool that places boxes.
#[derive(Clone, Debug, Default)]
pub struct AddBox {
    drag: Option<PlacementDrag>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum PlacementDrag {
    /// From above: middle of the footprint, m, and heading, rad.
    Place { at_m: DVec2, yaw_rad: f64 },
    /// In space: where the pointer went down, and whether it has left that place.
    Click { pressed: DVec2, moved: bool },
}

/// With `snap` the nearest multiple of 15 degrees.
fn snapped(yaw_rad: f64, snap: bool) -> f64 {
    let step = 15f64.to_radians();
    if snap {
        (yaw_rad / step).round() * step
    } else {
        yaw_rad
    }
}

fn lane_yaw(frame: &Frame, at_m: DVec2) -> f64 {
    lane_heading(frame, at_m).unwrap_or(0.0)
}

/// Places a box of the class and kind in hand, on the ground.
fn place(cx: &Context<'_>, at_m: DVec2, yaw_rad: f64) -> Response {
    match cx.hand.new_box(cx.frame(), cx.hand.box_class, at_m, yaw_rad) {
        Some(b) => Response::act(Act::AddBoxes("Add box".into(), vec![adding(&b)], vec![b.id])),
        None => Response::none(),
    }
}

impl AddBox {
    fn drag(&mut self, cx: &Context<'_>, pointer: &Pointer) {
        match &mut self.drag {
            Some(PlacementDrag::Place { at_m, yaw_rad }) => {
                let Some(to_m) = cx.ground_m(pointer.at) else {
                    return;
                };
                *yaw_rad = match at_m.distance(to_m) * cx.view.scale() > 3.0 * CLICK_SLACK {
                    true => snapped((to_m - *at_m).to_angle(), pointer.held.shift),
                    false => lane_yaw(cx.frame(), *at_m),
                };
            }
            Some(PlacementDrag::Click { pressed, moved }) => {
                *moved |= pressed.distance(pointer.at) > CLICK_SLACK
            }
            None => {}
        }
    }
}

impl Tool for AddBox {
    fn event(&mut self, cx: &mut Context<'_>, event: &Event) -> Response {
        match event {
            Event::Press(pointer) => {
                self.drag = match (cx.from_above(), cx.ground_m(pointer.at)) {
                    (true, Some(at_m)) => Some(PlacementDrag::Place {
                        at_m,
                        yaw_rad: lane_yaw(cx.frame(), at_m),
                    }),
                    (true, None) => None,
                    (false, _) => Some(PlacementDrag::Click {
                        pressed: pointer.at,
                        moved: false,
                    }),
                };
                Response::hold()
            }
            Event::Drag(pointer) => {
                self.drag(cx, pointer);
                Response::none()
            }
            Event::Release(pointer) => match self.drag.take() {
                Some(PlacementDrag::Place { at_m, yaw_rad }) => place(cx, at_m, yaw_rad),
                Some(PlacementDrag::Click { moved: false, .. }) => match cx.ground_m(pointer.at) {
                    Some(at_m) => place(cx, at_m, lane_yaw(cx.frame(), at_m)),
                    None => Response::none(),
                },
                _ => Response::none(),
            },
            Event::Cancel => {
                self.drag = None;
                Response::none()
            }
            _ => Response::none(),
        }
    }

    fn hint(&self, _: &Hand, view: Option<ViewKind>) -> Hint {
        let _ = view;
        hint_of(&["Click places a box", "drag sets its heading"])
    }

    fn cursor(&self, _: &ReadonlyContext<'_>) -> Cursor {
        Cursor::Crosshair
    }

    fn overlay(&self, sight: &ReadonlyContext<'_>) -> Vec<ToolMark> {
        let (Some(_), frame) = (sight.pointer, sight.scene.frame()) else {
            return Vec::new();
        };
        let (at_m, yaw_rad) = match self.drag {
            Some(PlacementDrag::Place { at_m, yaw_rad }) => (at_m, yaw_rad),
            _ => match sight.ground_m() {
                Some(at_m) => (at_m, lane_yaw(frame, at_m)),
                None => return Vec::new(),
            },
        };
        let ghost = sight.hand.new_box(frame, sight.hand.box_class, at_m, yaw_rad);
        ghost.map(ToolMark::Ghost).into_iter().collect()
    }

    fn options(&self, hand: &Hand) -> Vec<ToolOption> {
        let class = hand.box_class;
        let named =
            |name: &str, [x, y, z]: [f64; 3]| (format!("{}   {x:.2} × {y:.2} × {z:.2} m", t(name)), "");
        let typical = named("Typical", class.typical_size_m().unwrap_or_default());
        let kinds = variants::of_class(class).map(|kind| named(kind.name, kind.size_m));
        vec![
            ToolOption::title("Add box"),
            ToolOption::text("Click to place, drag to set the heading. Boxes follow the nearest lane."),
            ToolOption::gap(),
            ToolOption::new(
                "kind",
                Control::List {
                    title: "",
                    label: "Kind of box",
                    chosen: hand.variants.get(&class).map_or(0, |i| i + 1),
                    choices: std::iter::once(typical).chain(kinds).collect(),
                },
            ),
            ToolOption::gap(),
            ToolOption::new(
                "class",
                Control::Class {
                    chosen: class,
                    classes: Class::OBJECTS.to_vec(),
                    verb: "Add",
                },
            ),
        ]
    }

    fn set(&mut self, hand: &mut Hand, _: &Frame, id: &str, value: Value) -> Vec<Act> {
        match (id, value) {
            ("kind", Value::Index(0)) => drop(hand.variants.remove(&hand.box_class)),
            ("kind", Value::Index(i)) => drop(hand.variants.insert(hand.box_class, i - 1)),
            ("class", Value::Class(class)) => hand.box_class = class,
            _ => {}
        }
        Vec::new()
    }
}
