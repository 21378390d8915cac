//! The region tool: marks areas to inpaint, by rectangles, outlines or a brush.

use glam::DVec2;

use language::tf;
use scene::Frame;

use super::corners::{PolygonDraft, Set};
use super::setting::{self, ToolOption, Value};
use super::{
    Act, Context, Cursor, Event, Hand, Hint, InpaintArea, Modifiers, Pointer, ReadonlyContext, RegionShape,
    Response, Role, Shortcut, Tool, ToolDef, ToolGroup, ToolId, ToolMark, ViewKind, Wants, When, hint_of,
};

/// Its name.
pub const ID: ToolId = ToolId("region_tool");

/// Its row of the table.
pub static DEF: ToolDef = ToolDef {
    id: ID,
    title: "Region",
    key: "N: inpaint",
    icon: "region",
    group: ToolGroup::Scene,
    is_brush: true,
    paints: false,
    shortcuts: &[Shortcut {
        id: ID.0,
        title: "Region to inpaint",
        keys: "N",
        when: When::Always,
        set: |hand| hand.tool = ID,
    }],
    make: || Box::new(Marker::default()),
};

/// Ways to mark.
const WAYS: [(RegionShape, &str, &str); 4] = [
    (RegionShape::Rectangle, "Rectangle", "drag from corner to corner"),
    (RegionShape::Lasso, "Lasso", "draw around it"),
    (
        RegionShape::Polygon,
        "Polygon",
        "click corners around it, Enter ends",
    ),
    (
        RegionShape::Brush,
        "Brush",
        "paint the mark; [ and ] change the size",
    ),
];

/// Mark that is being drawn, ego frame, m.
#[derive(Clone, Debug, PartialEq)]
enum RegionDrag {
    Rectangle { from_m: DVec2, to_m: DVec2 },
    Outline(Vec<DVec2>),
    Stroke(DVec2),
}

/// The region tool.
#[derive(Clone, Debug, Default)]
pub struct Marker {
    /// Mark that is being drawn; true if it marks, false if it takes the mark away.
    drag: Option<(RegionDrag, bool)>,
    /// Corners of an outline.
    corners: PolygonDraft,
}

impl Marker {
    fn drag(&mut self, cx: &Context<'_>, pointer: &Pointer) -> Response {
        let (Some((drag, on)), Some(at_m)) = (&mut self.drag, cx.ground_m(pointer.at)) else {
            return Response::none();
        };
        match drag {
            RegionDrag::Rectangle { to_m, .. } => *to_m = at_m,
            RegionDrag::Outline(points_m) => {
                let apart_m = 2.0 / cx.view.scale();
                if points_m.last().is_none_or(|p| p.distance(at_m) > apart_m) {
                    points_m.push(at_m);
                }
            }
            RegionDrag::Stroke(from_m) => {
                let area = InpaintArea::Stroke(*from_m, at_m, cx.hand.brush_m);
                *from_m = at_m;
                return Response::act(Act::Mark(area, *on));
            }
        }
        Response::none()
    }

    fn release(&mut self, cx: &Context<'_>) -> Response {
        let Some((drag, on)) = self.drag.take() else {
            return Response::none();
        };
        let area = match drag {
            RegionDrag::Rectangle { from_m, to_m } => {
                // A click marks the cell under it.
                let around = DVec2::splat(cx.frame().extent().voxel_m() / 2.0);
                InpaintArea::Rect(from_m.min(to_m) - around, from_m.max(to_m) + around)
            }
            RegionDrag::Outline(points_m) => InpaintArea::Outline(points_m),
            // A brush has marked on its way.
            RegionDrag::Stroke(_) => return Response::none(),
        };
        Response::act(Act::Mark(area, on))
    }
}

/// True if the drawn area is marked. With Shift or Ctrl (as in the selection of boxes) the mark is taken away.
fn marks(held: Modifiers) -> bool {
    !(held.shift || held.ctrl)
}

impl Tool for Marker {
    fn event(&mut self, cx: &mut Context<'_>, event: &Event) -> Response {
        match self.corners.event(event) {
            Set::Not => {}
            Set::Taken => return Response::taken(),
            Set::Closed(points_m, held) => {
                let area = InpaintArea::Outline(points_m);
                return Response::taken().and(Act::Mark(area, marks(held)));
            }
        }
        match event {
            Event::Press(pointer) if cx.from_above() => {
                let Some(at_m) = cx.ground_m(pointer.at) else {
                    return Response::none();
                };
                let drag = match cx.hand.region_shape {
                    RegionShape::Rectangle => RegionDrag::Rectangle {
                        from_m: at_m,
                        to_m: at_m,
                    },
                    RegionShape::Lasso => RegionDrag::Outline(vec![at_m]),
                    RegionShape::Brush => RegionDrag::Stroke(at_m),
                    RegionShape::Polygon => {
                        return match self.corners.add(cx, pointer) {
                            Set::Closed(points_m, held) => {
                                Response::act(Act::Mark(InpaintArea::Outline(points_m), marks(held)))
                            }
                            _ => Response::none(),
                        };
                    }
                };
                self.drag = Some((drag, marks(pointer.held)));
                Response::hold()
            }
            Event::Drag(pointer) => self.drag(cx, pointer),
            Event::Release(_) => self.release(cx),
            Event::Cancel => {
                self.drag = None;
                Response::none()
            }
            _ => Response::none(),
        }
    }

    fn hint(&self, hand: &Hand, view: Option<ViewKind>) -> Hint {
        if view == Some(ViewKind::Space) {
            return hint_of(&["The region is marked in the bird's-eye view"]);
        }
        let drag = match hand.region_shape {
            RegionShape::Polygon => {
                return hint_of(&["Click sets corners", "Enter closes", "Shift takes away"]);
            }
            RegionShape::Brush => "Drag paints the mark",
            RegionShape::Lasso => "Drag marks what it goes around",
            RegionShape::Rectangle => "Drag marks a rectangle",
        };
        hint_of(&[drag, "Shift takes away"])
    }

    fn cursor(&self, sight: &ReadonlyContext<'_>) -> Cursor {
        match sight.from_above() {
            true => Cursor::Crosshair,
            false => Cursor::Forbidden,
        }
    }

    fn overlay(&self, sight: &ReadonlyContext<'_>) -> Vec<ToolMark> {
        if !sight.from_above() {
            return Vec::new();
        }
        let mut out = Vec::new();
        match &self.drag {
            Some((RegionDrag::Rectangle { from_m, to_m }, _)) => {
                out.push(ToolMark::Rect((*from_m).into(), (*to_m).into(), Role::Choose));
            }
            Some((RegionDrag::Outline(points_m), _)) => {
                let first = points_m.first();
                let closed = points_m.iter().chain(first).map(|p| (*p).into());
                out.push(ToolMark::Dashed(closed.collect(), Role::Choose));
            }
            _ => {}
        }
        out.extend(self.corners.marks(sight));
        if let (RegionShape::Brush, Some(at_m)) = (sight.hand.region_shape, sight.ground_m()) {
            out.push(ToolMark::Disc(at_m, sight.hand.brush_m / 2.0, Role::Choose));
        }
        out
    }

    fn options(&self, hand: &Hand) -> Vec<ToolOption> {
        let any = hand.region_m2 > 0.0;
        let mut out = vec![
            ToolOption::title("Region to inpaint"),
            ToolOption::text(
                "Mark it in the bird's-eye view, Shift takes away. All else, and boxes in it, stay as they are.",
            ),
            ToolOption::segments("way", hand.region_shape, &WAYS, 2),
        ];
        if hand.region_shape == RegionShape::Brush {
            let range = [*Hand::BRUSH_M.start(), *Hand::BRUSH_M.end()];
            out.push(ToolOption::number("size", "Brush, m", hand.brush_m, range, 1));
        }
        out.extend([
            ToolOption::text(tf!("{area} m² marked", area = format!("{:.0}", hand.region_m2))),
            ToolOption::number("strength", "Strength", hand.region_strength, [0.05, 1.0], 1),
            ToolOption::text("1: all of it new. Less is a variation of what is there."),
            ToolOption::new(
                "",
                setting::Control::Line(vec![
                    ToolOption::button("draw", "Inpaint", "each time from other noise", any),
                    ToolOption::button("clear", "Clear region", "", any),
                ]),
            ),
        ]);
        out
    }

    fn set(&mut self, hand: &mut Hand, _: &Frame, id: &str, value: Value) -> Vec<Act> {
        match id {
            "way" => setting::take(&mut hand.region_shape, value, &WAYS),
            "size" => setting::take_number(&mut hand.brush_m, value),
            "strength" => setting::take_number(&mut hand.region_strength, value),
            "draw" => return vec![Act::Ask("generate_edited")],
            "clear" => return vec![Act::Mark(InpaintArea::All, false)],
            _ => {}
        }
        if id == "way" {
            self.corners.clear();
        }
        Vec::new()
    }

    fn wants(&self) -> Wants {
        match self.corners.is_empty() {
            true => Wants::Nothing,
            false => Wants::Points,
        }
    }

    fn draws_in(&self) -> Option<ViewKind> {
        self.corners.view()
    }

    fn put_down(&mut self) {
        self.corners.clear();
    }

    fn restart(&mut self) {
        self.corners.clear();
    }
}
