//! The road tool: chooses roads and the nodes where they meet, and reshapes them by their points and lanes. A scene
//! whose roads were only painted shows the roads recognised in them.

mod marks;
mod options;
mod part;

use std::cell::RefCell;
use std::sync::Arc;

use glam::DVec2;

use crate::Edit;
use crate::roads::network_of;
use scene::roads::{NodeId, RoadChange, curve};
use scene::{BevLayout, Frame, Road, RoadId, RoadNetwork, Scene};

use super::setting::{ToolOption, Value};
use super::{
    Act, Context, Cursor, Event, HANDLE_REACH, Hand, Hint, Key, Pointer, ReadonlyContext, Response, Shortcut,
    Tool, ToolDef, ToolGroup, ToolId, ToolMark, ViewKind, Wants, When, hint_of,
};
use part::RoadGeometry;
pub use part::{RoadHand, RoadPart};

/// Its name.
pub const ID: ToolId = ToolId("road_tool");

/// Its row of the table.
pub static DEF: ToolDef = ToolDef {
    id: ID,
    title: "Road",
    key: "H: reshape roads, lanes, junctions",
    icon: "road",
    group: ToolGroup::Scene,
    is_brush: false,
    paints: false,
    shortcuts: &[Shortcut {
        id: ID.0,
        title: "Road",
        keys: "H",
        when: When::Always,
        set: |hand| hand.tool = ID,
    }],
    make: || Box::new(RoadTool::default()),
};

/// Distance from another node within which a released node joins it, m.
const MEET_M: f64 = 3.0;

/// Part of the roads that is being dragged.
#[derive(Clone, Debug)]
enum Grip {
    Node(NodeId),
    /// A point of the road.
    Via(Road, usize),
    /// The line itself: it gets a new point there.
    Line(Road, usize),
}

/// A press, and whether the pointer has left its place.
#[derive(Clone, Debug)]
struct RoadDrag {
    grip: Grip,
    from_m: DVec2,
    moved: bool,
    /// True once the scene was asked to recognise its roads as a network.
    asked: bool,
}

/// Inputs of a network; equality is decided by their shared memory.
#[derive(Clone, Debug)]
struct Known {
    roads: Arc<RoadNetwork>,
    layout: BevLayout,
}

impl Known {
    fn is_of(&self, scene: &Scene) -> bool {
        let layout = &scene.canvas().layout;
        let same = self.layout.shares_cells(layout) && Arc::ptr_eq(&self.layout.polylines, &layout.polylines);
        Arc::ptr_eq(&self.roads, &scene.roads) && (same || !scene.roads.is_empty())
    }
}

/// The road tool.
#[derive(Debug, Default)]
pub struct RoadTool {
    /// The network last seen: recognising one takes a moment.
    seen: RefCell<Option<(Known, RoadGeometry)>>,
    drag: Option<RoadDrag>,
}

impl RoadTool {
    fn network(&self, scene: &Scene) -> RoadGeometry {
        let mut seen = self.seen.borrow_mut();
        if let Some((known, net)) = &*seen
            && known.is_of(scene)
        {
            return net.clone();
        }
        let known = Known {
            roads: scene.roads.clone(),
            layout: scene.canvas().layout.clone(),
        };
        let net = RoadGeometry::from_network(network_of(scene));
        *seen = Some((known, net.clone()));
        net
    }

    /// The network of the last scene that was looked at.
    fn last(&self) -> RoadGeometry {
        let seen = self.seen.borrow();
        seen.as_ref().map(|s| s.1.clone()).unwrap_or_default()
    }

    fn press(&mut self, cx: &mut Context<'_>, pointer: &Pointer) -> Response {
        if !cx.from_above() {
            return Response::none();
        }
        let Some(at_m) = cx.ground_m(pointer.at) else {
            return Response::none();
        };
        let change = RoadChange::Recognise {};
        let edits = [Edit::ChangeRoads { change }];
        if let Some(layer) = cx.hand.locked_layer(&cx.frame().layout, &edits) {
            return super::brush::locked(layer);
        }
        let seen = self.network(cx.settled);
        let net = &*seen.net;
        let reach_m = HANDLE_REACH / cx.view.scale();
        let found = part::at(&seen, at_m, reach_m, cx.hand.road.chosen);
        cx.hand.road.chosen = found;
        cx.hand.road.at_m = at_m;
        cx.hand.road.lane = None;
        let grip = match found {
            None => return Response::none(),
            Some(RoadPart::Node(id)) => Some(Grip::Node(id)),
            Some(RoadPart::Via(id, index)) if pointer.held.alt => return self.drop_via(cx, net, id, index),
            Some(RoadPart::Via(id, index)) => net.road(id).map(|road| Grip::Via(road.clone(), index)),
            Some(RoadPart::Road(id)) => {
                cx.hand.road.lane = net.road(id).and_then(|road| part::lane_at(&seen, road, at_m));
                let index = part::on_line(&seen, id, at_m, reach_m);
                index.and_then(|index| Some(Grip::Line(net.road(id)?.clone(), index)))
            }
        };
        self.drag = grip.map(|grip| RoadDrag {
            grip,
            from_m: at_m,
            moved: false,
            asked: false,
        });
        Response::hold()
    }

    fn drop_via(&mut self, cx: &mut Context<'_>, net: &RoadNetwork, id: RoadId, index: usize) -> Response {
        let Some(mut road) = net.road(id).cloned().filter(|r| index < r.via_m.len()) else {
            return Response::none();
        };
        road.via_m.remove(index);
        cx.hand.road.chosen = Some(RoadPart::Road(id));
        Response::act(apply("Remove road point", RoadChange::Put { road }))
    }

    fn drag(&mut self, cx: &Context<'_>, pointer: &Pointer) -> Response {
        let Some(at_m) = cx.ground_m(pointer.at) else {
            return Response::none();
        };
        let at_m = match pointer.held.ctrl {
            true => (at_m / cx.hand.grid_m).round() * cx.hand.grid_m,
            false => at_m,
        };
        let net = self.network(cx.settled).net;
        let Some(drag) = &mut self.drag else {
            return Response::none();
        };
        if !drag.moved && drag.from_m.distance(at_m) * cx.view.scale() < super::CLICK_SLACK {
            return Response::none();
        }
        // A scene gets its network as a step of its own, so that a drag need not recognise it at every move.
        if cx.settled.roads.is_empty() {
            if std::mem::replace(&mut drag.asked, true) {
                self.drag = None;
                return Response::none();
            }
            return Response::act(recognised());
        }
        let first = !std::mem::replace(&mut drag.moved, true);
        match &mut drag.grip {
            Grip::Node(id) => {
                let Some(node) = net.node(*id) else {
                    return Response::none();
                };
                let node = scene::RoadNode { at_m, ..*node };
                Response::act(preview(RoadChange::PutNode { node }))
            }
            Grip::Line(road, index) if first => {
                *index = (*index).min(road.via_m.len());
                road.via_m.insert(*index, at_m);
                Response::act(preview(RoadChange::Put { road: road.clone() }))
            }
            Grip::Via(road, index) | Grip::Line(road, index) => {
                if let Some(p) = road.via_m.get_mut(*index) {
                    *p = at_m;
                }
                Response::act(preview(RoadChange::Put { road: road.clone() }))
            }
        }
    }

    fn release(&mut self, cx: &mut Context<'_>, pointer: &Pointer) -> Response {
        let Some(drag) = self.drag.take().filter(|d| d.moved) else {
            return Response::none();
        };
        match drag.grip {
            Grip::Node(id) => {
                let at_m = cx.ground_m(pointer.at);
                let met = at_m.and_then(|at_m| self.meeting(&self.network(cx.settled).net, id, at_m));
                match met {
                    Some(edits) => Response::act(Act::Cancel).and(Act::Apply("Join roads".into(), edits)),
                    None => Response::act(Act::Commit("Move road node".into())),
                }
            }
            Grip::Via(..) => Response::act(Act::Commit("Move road point".into())),
            Grip::Line(road, index) => {
                cx.hand.road.chosen = Some(RoadPart::Via(road.id, index));
                Response::act(Act::Commit("Bend road".into()))
            }
        }
    }

    /// The edits by which a node that is released at a place joins the node or road there.
    fn meeting(&self, net: &RoadNetwork, id: NodeId, at_m: DVec2) -> Option<Vec<Edit>> {
        let others = net
            .nodes
            .iter()
            .filter(|n| n.id != id && n.at_m.distance(at_m) < MEET_M);
        if let Some(to) = others.min_by(|a, b| a.at_m.distance(at_m).total_cmp(&b.at_m.distance(at_m))) {
            let change = RoadChange::Connect { node: id, to: to.id };
            return Some(vec![Edit::ChangeRoads { change }]);
        }
        // A free end in the middle of another road makes a junction there.
        let arms = net.arms(id);
        let [arm] = arms.as_slice() else { return None };
        let mut rest = net.clone();
        rest.roads.retain(|r| r.id != arm.road);
        let road = rest.road_at(at_m, 0.0)?;
        let line = &net.lines()[&road];
        let (along_m, _) = curve::project(line, at_m)?;
        let at_m = curve::at(line, along_m).0;
        let split = RoadChange::Split { id: road, at_m };
        // The number that the new node will have.
        let next = net.nodes.iter().map(|n| n.id.0 + 1).max()?;
        let connect = RoadChange::Connect {
            node: id,
            to: NodeId(next),
        };
        Some(vec![
            Edit::ChangeRoads { change: split },
            Edit::ChangeRoads { change: connect },
        ])
    }
}

/// The step that gives a scene its network.
fn recognised() -> Act {
    apply("Recognise roads", RoadChange::Recognise {})
}

fn apply(label: &'static str, change: RoadChange) -> Act {
    Act::Apply(label.into(), vec![Edit::ChangeRoads { change }])
}

fn preview(change: RoadChange) -> Act {
    Act::Try(vec![Edit::ChangeRoads { change }])
}

impl Tool for RoadTool {
    fn event(&mut self, cx: &mut Context<'_>, event: &Event) -> Response {
        match event {
            Event::Press(pointer) => self.press(cx, pointer),
            Event::Drag(pointer) => self.drag(cx, pointer),
            Event::Release(pointer) => self.release(cx, pointer),
            Event::Cancel => {
                self.drag = None;
                Response::none()
            }
            Event::Key(Key::Escape, ..) => {
                self.drag = None;
                cx.hand.road.chosen = None;
                Response::taken().and(Act::Cancel)
            }
            _ => Response::none(),
        }
    }

    fn hint(&self, hand: &Hand, view: Option<ViewKind>) -> Hint {
        if view == Some(ViewKind::Space) {
            return hint_of(&["Roads are reshaped in the bird's-eye view"]);
        }
        match hand.road.chosen {
            None => hint_of(&["Click chooses a road or a junction"]),
            Some(RoadPart::Node(_)) => hint_of(&[
                "Drag moves it",
                "let go on another one to join",
                "Del deletes a joint",
            ]),
            Some(_) => hint_of(&[
                "Drag the line to bend it",
                "points to move them",
                "Alt+click removes a point",
                "Ctrl snaps",
                "Del deletes",
            ]),
        }
    }

    fn cursor(&self, sight: &ReadonlyContext<'_>) -> Cursor {
        if !sight.from_above() {
            return Cursor::Forbidden;
        }
        if self.drag.is_some() {
            return Cursor::Move;
        }
        let Some(at_m) = sight.ground_m() else {
            return Cursor::Default;
        };
        let seen = self.network(sight.settled);
        let reach_m = HANDLE_REACH / sight.view.scale();
        match part::at(&seen, at_m, reach_m, sight.hand.road.chosen) {
            Some(RoadPart::Node(_) | RoadPart::Via(..)) => Cursor::Move,
            Some(RoadPart::Road(_)) => Cursor::Pointing,
            None => Cursor::Default,
        }
    }

    fn overlay(&self, sight: &ReadonlyContext<'_>) -> Vec<ToolMark> {
        if !sight.from_above() {
            return Vec::new();
        }
        let shown = match self.drag.is_some() && !sight.scene.roads.is_empty() {
            true => RoadGeometry::from_network(sight.scene.roads.clone()),
            false => self.network(sight.settled),
        };
        marks::over_map(&shown, sight)
    }

    fn options(&self, hand: &Hand) -> Vec<ToolOption> {
        options::of(&self.last(), &hand.road)
    }

    fn set(&mut self, hand: &mut Hand, _: &Frame, id: &str, value: Value) -> Vec<Act> {
        options::set(&self.last(), &mut hand.road, id, value)
    }

    fn wants(&self) -> Wants {
        Wants::Escape
    }

    fn put_down(&mut self) {
        self.drag = None;
    }
}

/// The edits that delete a part of the roads; `None` for a point of a road that does not exist.
pub fn deletion(scene: &Scene, part: RoadPart) -> Option<Vec<Edit>> {
    let change = match part {
        RoadPart::Road(id) => RoadChange::Remove { id },
        RoadPart::Node(node) => RoadChange::Join { node },
        RoadPart::Via(id, index) => {
            let mut road = network_of(scene).road(id)?.clone();
            (index < road.via_m.len()).then(|| road.via_m.remove(index))?;
            RoadChange::Put { road }
        }
    };
    Some(vec![Edit::ChangeRoads { change }])
}

#[cfg(test)]
mod tests;
