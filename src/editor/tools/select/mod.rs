//! The select tool: chooses, moves, turns and resizes boxes and things.

mod above;
mod boxes;
mod gizmo;
mod motion;
mod space;
mod things;

use crate::arrange::Pivot;
use crate::transform::{Orientation, TransformKind};
use scene::{Frame, Members};

use super::corners::{PolygonDraft, Set};
use super::setting::{self, Control, ToolOption, Value};
use super::{
    Act, ChooseBy, Context, Cursor, Event, Hand, Hint, ReadonlyContext, Response, Shortcut, Tool, ToolDef,
    ToolGroup, ToolId, ToolMark, ViewKind, Wants, When, hint_of,
};

pub use things::thing_under;

/// Its name.
pub const ID: ToolId = ToolId::SELECT;

const fn shortcut(
    id: &'static str,
    title: &'static str,
    keys: &'static str,
    when: When,
    set: fn(&mut Hand),
) -> Shortcut {
    Shortcut {
        id,
        title,
        keys,
        when,
        set,
    }
}

fn by(hand: &mut Hand, by: ChooseBy) {
    (hand.tool, hand.choose_by) = (ID, by);
}

fn gizmo(hand: &mut Hand, kind: TransformKind) {
    (hand.tool, hand.gizmo) = (ID, kind);
}

/// Its row of the table.
pub static DEF: ToolDef = ToolDef {
    id: ID,
    title: "Select",
    key: "V",
    icon: "cursor",
    group: ToolGroup::Scene,
    is_brush: false,
    paints: false,
    shortcuts: &[
        shortcut(ID.0, "Select", "V", When::Always, |h| by(h, ChooseBy::Rectangle)),
        shortcut(
            "lasso",
            "Select by lasso; again: by polygon",
            "O",
            When::Always,
            |h| match h.tool == ID && h.choose_by == ChooseBy::Lasso {
                true => by(h, ChooseBy::Polygon),
                false => by(h, ChooseBy::Lasso),
            },
        ),
        shortcut("polygon_select", "Select by polygon", "", When::Always, |h| {
            by(h, ChooseBy::Polygon)
        }),
        shortcut(
            "rectangle_select",
            "Select by rectangle",
            "Shift+V",
            When::Always,
            |h| by(h, ChooseBy::Rectangle),
        ),
        shortcut("gizmo_move", "Dragging moves", "W", When::Chosen, |h| {
            gizmo(h, TransformKind::Move)
        }),
        shortcut("gizmo_turn", "Dragging turns", "E", When::Chosen, |h| {
            gizmo(h, TransformKind::Turn)
        }),
        shortcut("gizmo_scale", "Dragging scales", "R", When::Chosen, |h| {
            gizmo(h, TransformKind::Scale)
        }),
    ],
    make: || Box::new(Select::default()),
};

/// Drag in progress, by the view in which the button went down.
#[derive(Clone, Debug, PartialEq)]
enum SelectionDrag {
    Above(above::TopViewDrag),
    Space(space::SpaceDrag),
}

/// The select tool.
#[derive(Clone, Debug, Default)]
pub struct Select {
    drag: Option<SelectionDrag>,
    /// Corners of an outline.
    corners: PolygonDraft,
    /// Selection when the button went down, or when the first corner was set.
    before: Members,
}

impl Select {
    /// Chooses the objects in an outline that was closed.
    fn closed(&mut self, cx: &mut Context<'_>, set: Set) {
        if let Set::Closed(points, held) = set {
            match cx.from_above() {
                true => above::outline(cx, &points, above::how(held)),
                false => space::chosen_in(cx, &points, above::how(held)),
            }
            self.with_groups(cx);
        }
    }

    /// Extends the selection to whole groups, unless objects were only taken out of it: then a single member can be
    /// taken out of its group.
    fn with_groups(&self, cx: &mut Context<'_>) {
        let now = boxes::members(cx.hand);
        if !now.is_within(&self.before) {
            boxes::choose_groups(cx.settled, cx.hand);
        }
    }
}

impl Tool for Select {
    fn event(&mut self, cx: &mut Context<'_>, event: &Event) -> Response {
        match self.corners.event(event) {
            Set::Not => {}
            set => {
                self.closed(cx, set);
                return Response::taken();
            }
        }
        match event {
            Event::Press(pointer) => {
                if !self.corners.is_empty() {
                    // An outline that is begun goes on, over handles and arrows too.
                    let set = self.corners.add(cx, pointer);
                    self.closed(cx, set);
                    return Response::none();
                }
                self.before = boxes::members(cx.hand);
                self.drag = match cx.from_above() {
                    true => above::press(cx, pointer).map(SelectionDrag::Above),
                    false => space::press(cx, pointer).map(SelectionDrag::Space),
                };
                if self.drag.is_some() {
                    return Response::hold();
                }
                if cx.hand.choose_by == ChooseBy::Polygon {
                    self.corners.add(cx, pointer);
                }
                Response::none()
            }
            Event::Drag(pointer) => match &mut self.drag {
                Some(SelectionDrag::Above(drag)) => above::drag(drag, cx, pointer),
                Some(SelectionDrag::Space(drag)) => space::drag(drag, cx, pointer),
                None => Response::none(),
            },
            Event::Release(pointer) => {
                let response = match self.drag.take() {
                    Some(SelectionDrag::Above(drag)) => above::release(drag, cx),
                    Some(SelectionDrag::Space(drag)) => space::release(drag, cx, pointer.at),
                    None => Response::none(),
                };
                self.with_groups(cx);
                response
            }
            Event::Key(key, repeat, held) => {
                let response = match &mut self.drag {
                    Some(SelectionDrag::Above(drag)) => above::key(drag, cx, *key, *repeat, *held),
                    Some(SelectionDrag::Space(drag)) => space::key(drag, cx, *key, *repeat, *held),
                    None => Response::none(),
                };
                if response.done {
                    self.drag = None;
                }
                response
            }
            Event::Cancel => {
                self.drag = None;
                Response::none()
            }
            Event::Pick(_) | Event::Scroll(_) | Event::DoubleClick => Response::none(),
        }
    }

    fn hint(&self, hand: &Hand, view: Option<ViewKind>) -> Hint {
        let over_space = view == Some(ViewKind::Space);
        let more = "Shift adds, Ctrl takes out";
        let mut parts = match hand.choose_by {
            ChooseBy::Lasso => vec!["Drag draws around boxes", more],
            ChooseBy::Polygon => vec!["Click sets corners", "Enter chooses", more],
            ChooseBy::Rectangle => vec!["Click chooses", "drag over ground marks", more],
        };
        if hand.selected.is_none() && !hand.things.chosen.is_empty() {
            parts.push("Drag moves");
            parts.push(if over_space {
                "the knob raises"
            } else {
                "[ ] raise"
            });
            parts.push("D to the kerb");
        }
        if hand.selected.is_some() {
            parts.push(match hand.gizmo {
                TransformKind::Move => "Drag moves, X Y Z keep an axis, digits type",
                TransformKind::Turn => "Drag turns, Shift in steps",
                TransformKind::Scale => "Drag scales",
            });
            if !over_space {
                parts.push("Ctrl snaps to the grid");
            }
        }
        hint_of(&parts)
    }

    fn cursor(&self, sight: &ReadonlyContext<'_>) -> Cursor {
        match sight.from_above() {
            true => above::cursor(sight),
            false => Cursor::Default,
        }
    }

    fn overlay(&self, sight: &ReadonlyContext<'_>) -> Vec<ToolMark> {
        let (above, space) = match &self.drag {
            Some(SelectionDrag::Above(drag)) => (Some(drag), None),
            Some(SelectionDrag::Space(drag)) => (None, Some(drag)),
            None => (None, None),
        };
        let mut out = match sight.from_above() {
            true => above::overlay(above, sight),
            false => space::overlay(space, sight),
        };
        out.extend(self.corners.marks(sight));
        out
    }

    fn options(&self, hand: &Hand) -> Vec<ToolOption> {
        let any = hand.selected.is_some();
        let snaps = vec![
            ToolOption::toggle(
                "snap_grid",
                hand.snap_grid,
                "Grid",
                "Moves snap to this step; hold Ctrl for the same",
            ),
            ToolOption::segments("grid", hand.grid_m, &GRIDS, 3),
        ];
        let more_snaps = vec![
            ToolOption::toggle(
                "snap_lane",
                hand.snap_lane,
                "Lanes",
                "Moves snap to lane centre and heading",
            ),
            ToolOption::toggle(
                "snap_ground",
                hand.snap_ground,
                "Ground",
                "Moves set boxes on the ground",
            ),
            ToolOption::toggle(
                "snap_kerb",
                hand.things.snap_kerb,
                "Kerb",
                "Moves set things beside the kerb",
            ),
        ];
        let to_lane = match !hand.things.chosen.is_empty() && !any {
            true => ToolOption::button("to_lane", "To kerb", "D: beside the nearest kerb", true),
            false => ToolOption::button("to_lane", "To lane", "D: lane centre, heading and ground", any),
        };
        let buttons = vec![
            to_lane,
            ToolOption::button("to_ground", "To ground", "Shift+D", any),
            ToolOption::button("row", "Row…", "Ctrl+Shift+D: copies at a spacing", any),
            ToolOption::button("mirror", "Mirror", "Ctrl+M: about the ego x axis", any),
            ToolOption::button("mirror_copies", "Mirrored copy", "", any),
        ];
        vec![
            ToolOption::title("Select"),
            ToolOption::segments("lasso", hand.choose_by, &WAYS, 3),
            ToolOption::gap(),
            ToolOption::segments("gizmo", hand.gizmo, &KINDS, 3),
            ToolOption::gap(),
            ToolOption::segments("orientation", hand.orientation, &ORIENTATIONS, 2),
            ToolOption::gap(),
            ToolOption::segments("pivot", hand.pivot, &PIVOTS, 2),
            ToolOption::gap(),
            ToolOption::new("", Control::Line(snaps)),
            ToolOption::new("", Control::Line(more_snaps)),
            ToolOption::gap(),
            ToolOption::new("", Control::Row(buttons)),
            ToolOption::toggle(
                "keep_direction",
                hand.mirror_keeps_direction,
                "Mirrored ones keep to traffic",
                "A box that changes sides is turned by 180°",
            ),
        ]
    }

    fn set(&mut self, hand: &mut Hand, _: &Frame, id: &str, value: Value) -> Vec<Act> {
        match id {
            "lasso" => {
                setting::take(&mut hand.choose_by, value, &WAYS);
                self.corners.clear();
            }
            "gizmo" => setting::take(&mut hand.gizmo, value, &KINDS),
            "orientation" => setting::take(&mut hand.orientation, value, &ORIENTATIONS),
            "pivot" => setting::take(&mut hand.pivot, value, &PIVOTS),
            "grid" => setting::take(&mut hand.grid_m, value, &GRIDS),
            "snap_grid" => setting::take_on(&mut hand.snap_grid, value),
            "snap_lane" => setting::take_on(&mut hand.snap_lane, value),
            "snap_ground" => setting::take_on(&mut hand.snap_ground, value),
            "snap_kerb" => setting::take_on(&mut hand.things.snap_kerb, value),
            "keep_direction" => setting::take_on(&mut hand.mirror_keeps_direction, value),
            "to_lane" => return vec![Act::Ask("to_lane")],
            "to_ground" => return vec![Act::Ask("to_ground")],
            "row" => return vec![Act::Ask("row")],
            "mirror" => return vec![Act::Ask("mirror")],
            "mirror_copies" => return vec![Act::Ask("mirror_copies")],
            _ => {}
        }
        Vec::new()
    }

    fn wants(&self) -> Wants {
        match &self.drag {
            Some(
                SelectionDrag::Above(above::TopViewDrag::Boxes { .. })
                | SelectionDrag::Space(space::SpaceDrag::Boxes { .. }),
            ) => Wants::Drag,
            _ if !self.corners.is_empty() => Wants::Points,
            _ => Wants::Nothing,
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

const WAYS: [(ChooseBy, &str, &str); 3] = [
    (
        ChooseBy::Rectangle,
        "Marquee",
        "V: click, or drag over empty ground; Shift adds, Ctrl takes out",
    ),
    (
        ChooseBy::Lasso,
        "Lasso",
        "O: drag around boxes; Shift adds, Ctrl takes out",
    ),
    (
        ChooseBy::Polygon,
        "Polygon",
        "O again: click corners around boxes, Enter ends; Shift adds, Ctrl takes out",
    ),
];

const KINDS: [(TransformKind, &str, &str); 3] = [
    (
        TransformKind::Move,
        "Move",
        "W; X, Y, Z keep to an axis, digits set the way",
    ),
    (TransformKind::Turn, "Turn", "E; digits set the angle"),
    (TransformKind::Scale, "Scale", "R; digits set the factor"),
];

const ORIENTATIONS: [(Orientation, &str, &str); 2] = [
    (Orientation::World, "World", "axes of the ego vehicle"),
    (Orientation::Local, "Local", "axes of the box chosen last"),
];

const PIVOTS: [(Pivot, &str, &str); 2] = [
    (Pivot::Own, "Own centres", "the keys turn each box about itself"),
    (
        Pivot::Middle,
        "Middle",
        "the keys turn all about the middle between them",
    ),
];

const GRIDS: [(f64, &str, &str); 3] = [(0.1, "0.1", "m"), (0.4, "0.4", "m, a voxel"), (1.0, "1 m", "")];
